//! Runs that are played while they are computed: what the server says, over a socket.

use crate::{code, isosheet, run, stderr, with_scene};
use base64::Engine;
use base64::engine::general_purpose::STANDARD;
use isosheet_formats::Trajectory;
use isosheet_scenes::StartingPoint;
use serde_json::{Value, json};
use std::cell::Cell;
use std::fs;
use std::io::{BufRead, BufReader, Read, Write};
use std::net::TcpStream;
use std::path::Path;
use std::process::{Child, Stdio};
use std::time::{Duration, Instant};

/// A state that has not come by then never comes: some milliseconds suffice on an idle machine.
const PATIENCE: Duration = Duration::from_secs(600);

/// The command, which serves a page.
pub(crate) struct Served {
    child: Child,
    pub(crate) address: String,
    port: u16,
    token: String,
}

impl Served {
    /// Serves the scene in a folder.
    pub(crate) fn start(folder: &Path, arguments: &[&str]) -> Self {
        Self::of("scene.toml", folder, arguments)
    }

    /// Serves a file in a folder.
    pub(crate) fn of(file: &str, folder: &Path, arguments: &[&str]) -> Self {
        let mut child = isosheet(folder)
            .args(["live", file, "--no-open"])
            .args(arguments)
            .stdout(Stdio::piped())
            .stderr(Stdio::null())
            .spawn()
            .unwrap();
        let mut line = String::new();
        let mut stdout = BufReader::new(child.stdout.take().unwrap());
        stdout.read_line(&mut line).unwrap();
        let address = line
            .trim()
            .strip_prefix("page: ")
            .expect("the address")
            .to_owned();
        let rest = address
            .strip_prefix("http://127.0.0.1:")
            .expect("the loopback address");
        let (port, token) = rest.trim_end_matches('/').split_once('/').unwrap();
        Self {
            port: port.parse().unwrap(),
            token: token.to_owned(),
            child,
            address,
        }
    }

    fn connect(&self) -> TcpStream {
        let connection = TcpStream::connect(("127.0.0.1", self.port)).unwrap();
        connection.set_read_timeout(Some(PATIENCE)).unwrap();
        connection
    }

    /// Sends a request as it is. The whole answer.
    fn raw(&self, request: &str) -> String {
        let mut connection = self.connect();
        connection.write_all(request.as_bytes()).unwrap();
        let mut answer = Vec::new();
        // A server that refuses a request may not read all of it.
        let _ = connection.read_to_end(&mut answer);
        String::from_utf8(answer).unwrap()
    }

    /// The status of the answer to a request, with fields of its head besides `Host`.
    fn status(&self, method: &str, path: &str, fields: &str, body: &str) -> u16 {
        let host = format!("Host: 127.0.0.1:{}\r\n", self.port);
        let answer = self.raw(&format!(
            "{method} {path} HTTP/1.1\r\n{host}{fields}\r\n{body}"
        ));
        status_of(&answer)
    }

    fn path(&self, name: &str) -> String {
        format!("/{}/{name}", self.token)
    }

    /// Posts a command as a page does.
    fn order(&self, viewer: u64, command: Value) -> u16 {
        let body = json!({ "viewer": viewer, "command": command }).to_string();
        let fields = format!(
            "Origin: http://127.0.0.1:{}\r\nContent-Length: {}\r\n",
            self.port,
            body.len()
        );
        self.status("POST", &self.path("command"), &fields, &body)
    }

    /// A page that follows the run.
    pub(crate) fn watch(&self) -> Viewer {
        let mut connection = self.connect();
        let (path, port) = (self.path("events"), self.port);
        write!(
            connection,
            "GET {path} HTTP/1.1\r\nHost: localhost:{port}\r\n\r\n"
        )
        .unwrap();
        let mut viewer = Viewer {
            lines: BufReader::new(connection),
            number: 0,
        };
        assert!(viewer.line().starts_with("HTTP/1.1 200"));
        while !viewer.line().is_empty() {}
        let role = viewer.until("role", |_| true);
        viewer.number = role["viewer"].as_u64().unwrap();
        viewer
    }

    /// Waits for the process. Its exit code.
    fn wait(mut self) -> Option<i32> {
        let begun = Instant::now();
        loop {
            if let Some(status) = self.child.try_wait().unwrap() {
                return status.code();
            }
            assert!(begun.elapsed() < PATIENCE, "it does not end");
            std::thread::sleep(Duration::from_millis(5));
        }
    }
}

impl Drop for Served {
    fn drop(&mut self) {
        // It may have ended by itself.
        let _ = self.child.kill();
        let _ = self.child.wait();
    }
}

fn status_of(answer: &str) -> u16 {
    let line = answer.lines().next().unwrap_or_default();
    let status = line.split(' ').nth(1).and_then(|s| s.parse().ok());
    status.unwrap_or_else(|| panic!("no status: {answer:?}"))
}

/// A page that follows a run.
pub(crate) struct Viewer {
    lines: BufReader<TcpStream>,
    pub(crate) number: u64,
}

impl Viewer {
    fn line(&mut self) -> String {
        let mut line = String::new();
        self.lines.read_line(&mut line).expect("a line in time");
        line.trim_end().to_owned()
    }

    /// The next event, and its data.
    fn event(&mut self) -> (String, Value) {
        loop {
            let line = self.line();
            if let Some(name) = line.strip_prefix("event: ") {
                let data = self.line();
                let data = data.strip_prefix("data:").expect("data").trim();
                return (
                    name.to_owned(),
                    serde_json::from_str(data).unwrap_or(Value::Null),
                );
            }
        }
    }

    /// The next event of a name for which something holds.
    fn until(&mut self, name: &str, holds: impl Fn(&Value) -> bool) -> Value {
        let begun = Instant::now();
        loop {
            let (found, data) = self.event();
            if found == name && holds(&data) {
                return data;
            }
            assert!(
                begun.elapsed() < PATIENCE,
                "no such {name}: the last was {data}"
            );
        }
    }

    pub(crate) fn frame(&mut self, holds: impl Fn(&Value) -> bool) -> Value {
        self.until("frame", holds)
    }
}

pub(crate) fn time(frame: &Value) -> f64 {
    frame["t"].as_f64().unwrap()
}

fn positions(frame: &Value) -> Vec<f64> {
    let bytes = STANDARD.decode(frame["x"].as_str().unwrap()).unwrap();
    let numbers = bytes.as_chunks::<8>().0.iter();
    numbers.map(|b| f64::from_le_bytes(*b)).collect()
}

pub(crate) fn vertex(frame: &Value, number: usize) -> [f64; 3] {
    positions(frame).as_chunks::<3>().0[number]
}

fn distance(a: [f64; 3], b: [f64; 3]) -> f64 {
    (0..3).map(|k| (a[k] - b[k]).powi(2)).sum::<f64>().sqrt()
}

#[test]
fn strangers_get_nothing() {
    let folder = with_scene(StartingPoint::Hanging);
    let served = Served::start(folder.path(), &[]);
    let get = |path: &str, fields: &str| served.status("GET", path, fields, "");
    let page = served.path("");
    assert_eq!(get(&page, ""), 200);
    let wrong: String = served
        .token
        .chars()
        .map(|c| if c == '0' { '1' } else { '0' })
        .collect();
    for path in ["/", "/events", &format!("/{wrong}/"), "/favicon.ico", "*"] {
        assert_eq!(get(path, ""), 403, "{path}");
    }
    let port = served.port;
    for origin in [
        "http://example.org".to_owned(),
        format!("http://example.org:{port}"),
        "null".into(),
    ] {
        let fields = format!("Origin: {origin}\r\n");
        for path in ["", "events", "command"] {
            assert_eq!(get(&served.path(path), &fields), 403, "{origin}");
        }
    }
    // A name of another site that leads to this machine, and none.
    for host in [
        format!("Host: example.org:{port}\r\n"),
        "Host: 127.0.0.1\r\n".into(),
        String::new(),
    ] {
        let answer = served.raw(&format!("GET {page} HTTP/1.1\r\n{host}\r\n"));
        assert_eq!(status_of(&answer), 403, "{host}");
    }
    for path in ["x", "events/", "../", "index.html"] {
        assert_eq!(get(&served.path(path), ""), 404, "{path}");
    }
    for (method, path) in [
        ("POST", ""),
        ("PUT", "command"),
        ("GET", "command"),
        ("HEAD", ""),
        ("DELETE", "events"),
    ] {
        let status = served.status(method, &served.path(path), "Content-Length: 0\r\n", "");
        assert_eq!(status, 405, "{method} {path}");
    }
    let post =
        |fields: &str, body: &str| served.status("POST", &served.path("command"), fields, body);
    assert_eq!(post("", ""), 411);
    assert_eq!(post("Content-Length: 5000\r\n", ""), 413);
    assert_eq!(post("Content-Length: 2\r\n", "{}"), 400);
    assert_eq!(status_of(&served.raw("nonsense\r\n\r\n")), 400);
    // Nobody watches, so nobody steers.
    assert_eq!(served.order(1, json!("play")), 409);
}

#[test]
fn the_page_keeps_to_itself() {
    let folder = with_scene(StartingPoint::Hanging);
    let served = Served::start(folder.path(), &[]);
    let host = format!("Host: 127.0.0.1:{}\r\n", served.port);
    let answer = served.raw(&format!("GET {} HTTP/1.1\r\n{host}\r\n", served.path("")));
    let (head, page) = answer.split_once("\r\n\r\n").unwrap();
    for field in [
        "Cache-Control: no-store",
        "Referrer-Policy: no-referrer",
        "X-Content-Type-Options: nosniff",
    ] {
        assert!(head.contains(field), "{field}: {head}");
    }
    let (_, policy) = head.split_once("Content-Security-Policy: ").unwrap();
    let policy = policy.lines().next().unwrap();
    assert!(policy.starts_with("default-src 'none'"), "{policy}");
    let (_, nonce) = policy.split_once("'nonce-").unwrap();
    let (nonce, _) = nonce.split_once('\'').unwrap();
    assert!(page.contains(&format!("<script nonce=\"{nonce}\">")));
    assert_ne!(nonce, served.token);
    assert!(!page.contains("{nonce}") && !page.contains(&served.token));
}

/// The first page steers, the second one watches, and takes over when the first one leaves.
#[test]
fn a_second_page_watches() {
    let folder = with_scene(StartingPoint::Hanging);
    let served = Served::start(folder.path(), &[]);
    let (mut first, mut second) = (served.watch(), served.watch());
    let role = first.until("role", |role| role["pages"] == 2);
    assert_eq!(role["steers"], true);
    let begin = second.frame(|_| true);
    assert_eq!((time(&begin), &begin["playing"]), (0.0, &json!(false)));

    assert_eq!(served.order(second.number, json!("step")), 409);
    assert_eq!(served.order(first.number, json!("step")), 204);
    let [one, other] = [&mut first, &mut second].map(|v| v.frame(|f| time(f) > 0.0));
    assert_eq!(one, other);
    assert_ne!(positions(&one), positions(&begin));

    // What it held is let go, and it may not be played on without a command.
    assert_eq!(
        served.order(first.number, json!({ "grab": { "vertex": 0 } })),
        204
    );
    second.frame(|f| f["hand"]["vertex"] == 0);
    assert_eq!(served.order(first.number, json!("play")), 204);
    drop(first);
    second.until("role", |role| role["steers"] == true);
    second.frame(|f| f["hand"].is_null());
    assert_eq!(served.order(second.number, json!("pause")), 204);
    second.frame(|f| f["playing"] == false);
    assert_eq!(served.order(second.number, json!("end")), 204);
    second.until("end", |_| true);
    assert_eq!(served.wait(), Some(0));
}

/// Every state that is played is that of a run, to the bit.
#[test]
fn play_gives_the_bits_of_a_run() {
    let folder = with_scene(StartingPoint::Hanging);
    let edits = [
        "--set",
        "stop.time=0.5",
        "--set",
        "output.frames_per_second=120",
    ];
    let done = run(
        folder.path(),
        &[&["simulate", "scene.toml"], &edits[..]].concat(),
    );
    assert_eq!(code(&done), Some(0), "{}", stderr(&done));
    let trajectory = Trajectory::read(&folder.path().join("scene-run/trajectory.npz")).unwrap();
    let served = Served::start(folder.path(), &edits);
    let mut viewer = served.watch();
    assert_eq!(served.order(viewer.number, json!("step")), 204);
    assert_eq!(served.order(viewer.number, json!("play")), 204);
    let seen = Cell::new(0);
    let last = viewer.frame(|frame| {
        let times = trajectory.times();
        let k = times.iter().position(|t| *t == time(frame));
        let k = k.expect("a time of the run");
        assert_eq!(trajectory.frame(k).unwrap(), positions(frame), "frame {k}");
        seen.set(seen.get() + 1);
        frame["notice"]["kind"] == "note"
    });
    assert!(seen.get() > 2);
    assert_eq!(last["playing"], false);
    assert_eq!(trajectory.times().last(), Some(&time(&last)));
    // Play goes on beyond the end of the scene.
    assert_eq!(served.order(viewer.number, json!("play")), 204);
    let next = viewer.frame(|f| time(f) > time(&last));
    assert!(next["notice"].is_null());
}

/// A hand pulls a free corner sidewards and up: the corner follows, the lengths stay, and the hand is gone
/// after.
#[test]
fn a_dragged_corner_follows() {
    let folder = with_scene(StartingPoint::Hanging);
    let served = Served::start(folder.path(), &["--set", "stop.time=1000"]);
    let mut viewer = served.watch();
    let begin = viewer.frame(|_| true);
    let corner = 0;
    let from = vertex(&begin, corner);
    let order = |command: Value| assert_eq!(served.order(viewer.number, command), 204);
    order(json!({ "grab": { "vertex": corner } }));
    order(json!("play"));
    let mut to = from;
    // Towards the corner that is held, so that the sheet reaches it in whatever time this takes.
    for part in 1..=10 {
        to = [
            from[0] + 0.002 * f64::from(part),
            from[1] + 0.002 * f64::from(part),
            from[2] + 0.003 * f64::from(part),
        ];
        order(json!({ "drag": { "to": to } }));
    }
    let shown = viewer.frame(|f| f["hand"]["to"] == json!(to));
    assert_eq!(shown["hand"]["vertex"], corner);
    let followed = viewer.frame(|f| distance(vertex(f, corner), to) < 0.003);
    assert!(distance(vertex(&followed, corner), from) > 0.03);
    assert_eq!(served.order(viewer.number, json!("release")), 204);
    viewer.frame(|f| f["hand"].is_null());
    // It falls back.
    viewer.frame(|f| distance(vertex(f, corner), to) > 0.02);
}

#[test]
fn what_a_support_holds_is_not_pulled_at() {
    let folder = with_scene(StartingPoint::Hanging);
    let served = Served::start(folder.path(), &[]);
    let host = format!("Host: 127.0.0.1:{}\r\n", served.port);
    let page = served.raw(&format!("GET {} HTTP/1.1\r\n{host}\r\n", served.path("")));
    let (_, data) = page.split_once("id=\"replay\">").unwrap();
    let (data, _) = data.split_once("</script>").unwrap();
    let data: Value = serde_json::from_str(data).unwrap();
    assert_eq!(
        data["live"]["sliders"],
        json!([]),
        "the scene drives nothing"
    );
    let mut viewer = served.watch();
    let pin = &data["pins"][0];
    assert_eq!(
        served.order(viewer.number, json!({ "grab": { "vertex": pin } })),
        204
    );
    let refused = viewer.frame(|f| f["notice"]["kind"] == "problem");
    let text = refused["notice"]["text"].as_str().unwrap();
    assert!(text.contains("a support holds it"), "{text}");
    assert!(refused["hand"].is_null());
    assert_eq!(
        served.order(viewer.number, json!({ "grab": { "vertex": 99_999 } })),
        204
    );
    let refused = viewer.frame(|f| f["notice"]["text"] != text);
    let text = refused["notice"]["text"].as_str().unwrap();
    assert!(text.contains("99999"), "{text}");
}

/// The wind of a flag and the angle of a crease go where the sliders are put.
#[test]
fn sliders_drive_what_the_scene_names() {
    let folder = with_scene(StartingPoint::Flag);
    let served = Served::start(folder.path(), &["--set", "stop.time=1000"]);
    let mut viewer = served.watch();
    let begin = viewer.frame(|_| true);
    let before = begin["sliders"][0].as_f64().unwrap();
    let set = json!({ "set": { "slider": 0, "value": before + 1.0 } });
    assert_eq!(served.order(viewer.number, set), 204);
    assert_eq!(served.order(viewer.number, json!("play")), 204);
    let on_the_way = |f: &Value| {
        let value = f["sliders"][0].as_f64().unwrap();
        value > before + 0.2 && value < before + 0.8
    };
    viewer.frame(on_the_way);
    viewer.frame(|f| f["sliders"][0] == json!(before + 1.0));
    // A slider that there is not, and a value beyond its end.
    assert_eq!(
        served.order(
            viewer.number,
            json!({ "set": { "slider": 77, "value": 1.0 } })
        ),
        204
    );
    assert_eq!(
        served.order(
            viewer.number,
            json!({ "set": { "slider": 0, "value": 1e9 } })
        ),
        204
    );
    viewer.frame(|f| f["sliders"][0].as_f64().unwrap() < 1e3);
}

/// A step that fails while a corner is pulled: the run pauses with the reason, and goes on when it is let go.
#[test]
fn a_failed_step_pauses_and_says_why() {
    let folder = with_scene(StartingPoint::Hanging);
    let served = Served::start(folder.path(), &["--set", "stop.time=1000"]);
    let mut viewer = served.watch();
    let order = |command: Value| assert_eq!(served.order(viewer.number, command), 204);
    order(json!({ "grab": { "vertex": 0 } }));
    order(json!("play"));
    // So far away that the numbers of the step have no meaning any more.
    order(json!({ "drag": { "to": [1e200, 0.0, 0.0] } }));
    let failed = viewer.frame(|f| f["notice"]["kind"] == "problem");
    assert_eq!(failed["playing"], false);
    assert!(positions(&failed).iter().all(|c| c.is_finite()));
    assert_eq!(served.order(viewer.number, json!("release")), 204);
    assert_eq!(served.order(viewer.number, json!("play")), 204);
    viewer.frame(|f| time(f) > time(&failed) + 0.05 && f["playing"] == true);
}

#[test]
fn a_scene_that_is_wrong_and_a_port_that_is_taken_are_refused() {
    let folder = with_scene(StartingPoint::Hanging);
    let arguments = ["live", "scene.toml", "--no-open"];
    let wrong = [&arguments[..], &["--set", "stop.time=-1"]].concat();
    assert_eq!(code(&run(folder.path(), &wrong)), Some(3));
    let served = Served::start(folder.path(), &[]);
    let port = served.port.to_string();
    let taken = run(
        folder.path(),
        &[&arguments[..], &["--port", &port]].concat(),
    );
    assert_eq!(code(&taken), Some(6), "{}", stderr(&taken));
    assert!(stderr(&taken).contains("--port"), "{}", stderr(&taken));
    assert!(
        fs::read_dir(folder.path()).unwrap().count() == 1,
        "no folder is written"
    );
}

/// Connections that say nothing, or a byte now and then, keep no page away.
#[test]
fn strangers_who_are_slow_take_no_place_of_a_page() {
    let dir = with_scene(StartingPoint::Drape);
    let served = Served::start(dir.path(), &[]);
    let mut slow: Vec<TcpStream> = (0..200)
        .map(|_| {
            let mut connection = served.connect();
            let _ = connection.write_all(b"GET /");
            connection
        })
        .collect();
    assert_eq!(served.status("GET", &served.path(""), "", ""), 200);
    let viewer = served.watch();
    assert_eq!(served.order(viewer.number, json!("end")), 204);
    for connection in &mut slow {
        // Each of them is closed, the ones that were left in time.
        let mut answer = Vec::new();
        let _ = connection.read_to_end(&mut answer);
    }
    assert_eq!(served.wait(), Some(0));
}

/// While nothing is close there is no gap: none is not the number 0.
#[test]
fn gaps_are_absent_while_nothing_is_close() {
    let folder = tempfile::tempdir().unwrap();
    let text = "version = 1
        [sheet]
        mesh = { square = { side = 0.2, level = 1 } }
        placement = { position = [0, 0, 0.05] }
        [forces]
        gravity = [0, 0, -9.81]
        [[obstacle]]
        shape = \"half_space\"";
    fs::write(folder.path().join("scene.toml"), text).unwrap();
    let served = Served::start(folder.path(), &[]);
    let mut viewer = served.watch();
    let first = viewer.frame(|_| true);
    let series = first["series"].as_array().unwrap();
    let absent: Vec<usize> = (0..series.len()).filter(|&k| series[k].is_null()).collect();
    let [place] = absent[..] else {
        panic!("one series has no value: {first}")
    };
    let gap = |frame: &Value| frame["series"][place].clone();
    assert_eq!(served.order(viewer.number, json!("play")), 204);
    // Contact begins somewhere above the floor.
    let close = viewer.frame(|frame| !gap(frame).is_null());
    assert!(
        gap(&close).as_f64().unwrap() > 0.0 && time(&close) > 0.05,
        "{close}"
    );
}

/// A pattern is folded by a part of its angles, and the slider is the part of the way there.
#[test]
fn a_slider_folds_a_pattern() {
    let dir = tempfile::tempdir().unwrap();
    let square = "1 0 0 1 0\n1 1 0 1 1\n1 1 1 0 1\n1 0 1 0 0\n3 0 0 1 1\n";
    fs::write(dir.path().join("square.cp"), square).unwrap();
    let served = Served::of("square.cp", dir.path(), &["--part", "0.5", "--contact"]);
    let host = format!("Host: 127.0.0.1:{}\r\n", served.port);
    let page = served.raw(&format!("GET {} HTTP/1.1\r\n{host}\r\n", served.path("")));
    let (_, data) = page.split_once("id=\"replay\">").unwrap();
    let data: Value = serde_json::from_str(data.split_once("</script>").unwrap().0).unwrap();
    let slider = &data["live"]["sliders"][0];
    assert_eq!(slider["name"], "part of the folding", "{slider}");
    assert_eq!(
        [&slider["low"], &slider["high"]],
        [&json!(0.0), &json!(1.0)]
    );
    let mut viewer = served.watch();
    let set = json!({ "set": { "slider": 0, "value": 0.5 } });
    assert_eq!(served.order(viewer.number, set), 204);
    assert_eq!(served.order(viewer.number, json!("play")), 204);
    // A half of half of 180 degrees: the corners beside the diagonal of a square of 0.2 m come nearer to each
    // other.
    let expected = 0.2 * 2.0_f64.sqrt() * 22.5_f64.to_radians().cos();
    viewer.frame(|f| {
        let corners = [0, 1, 2, 3].map(|k| vertex(f, k));
        let pairs = (0..4).flat_map(|a| (0..a).map(move |b| (a, b)));
        let apart = pairs.map(|(a, b)| distance(corners[a], corners[b]));
        // The other diagonal is longer, and keeps its length.
        let mut apart: Vec<f64> = apart.collect();
        apart.sort_by(f64::total_cmp);
        f["sliders"][0] == json!(0.5) && (apart[4] - expected).abs() < 1e-3
    });
    let folder = with_scene(StartingPoint::Flag);
    let refused = run(
        folder.path(),
        &["live", "scene.toml", "--no-open", "--part", "0.5"],
    );
    assert_eq!(code(&refused), Some(2), "{}", stderr(&refused));
    assert!(
        stderr(&refused).contains("--part is for crease patterns"),
        "{}",
        stderr(&refused)
    );
}
