//! The file of `simulate --trace`.

use crate::{code, run, stderr};
use serde_json::Value;
use std::fs;

/// A sheet that is dropped on a ball.
const SCENE: &str = "version = 1
[sheet]
mesh = { square = { side = 0.2, level = 1 } }
[[obstacle]]
shape = { sphere = { radius = 0.05 } }
pose = { position = [0.1, 0.1, -0.06] }
[forces]
gravity = [0, 0, -9.81]
[stop]
time = 0.1
";

/// Every accepted step and the factorisations of the history are in the trace, and the run is the one without
/// it.
#[test]
fn a_trace_tells_the_steps_and_changes_nothing() {
    let dir = tempfile::tempdir().unwrap();
    fs::write(dir.path().join("ball.toml"), SCENE).unwrap();
    let simulate = |out: &str, more: &[&str]| {
        let arguments = [&["simulate", "ball.toml", "--out", out][..], more].concat();
        let done = run(dir.path(), &arguments);
        assert_eq!(code(&done), Some(0), "{}", stderr(&done));
        fs::read_to_string(dir.path().join(out).join("history.csv")).unwrap()
    };
    let plain = simulate("plain", &[]);
    let traced = simulate("traced", &["--trace", "trace.jsonl"]);
    assert_eq!(plain, traced);
    let text = fs::read_to_string(dir.path().join("trace.jsonl")).unwrap();
    let events: Vec<Value> = text
        .lines()
        .map(|line| serde_json::from_str(line).unwrap())
        .collect();
    assert_eq!(events[0]["event"], "tuning");
    let of = |name: &'static str| events.iter().filter(move |e| e["event"] == name);
    let steps = plain.lines().count() - 2;
    assert_eq!(of("accepted").count(), steps, "{text}");
    assert!(of("phase").count() >= steps);
    assert!(of("iteration").any(|e| e["contacts"].as_u64() > Some(0)));
    // The same line again leaves it as it is, and a run that goes on adds to it.
    let read = || fs::read_to_string(dir.path().join("trace.jsonl")).unwrap();
    simulate("traced", &["--trace", "trace.jsonl"]);
    assert_eq!(read(), text);
    let longer = [
        "resume",
        "traced",
        "--until",
        "0.2",
        "--trace",
        "trace.jsonl",
    ];
    let done = run(dir.path(), &longer);
    assert_eq!(code(&done), Some(0), "{}", stderr(&done));
    let longer = read();
    assert!(longer.starts_with(&text) && longer.len() > text.len());
    assert_eq!(longer.matches("\"tuning\"").count(), 1);
}

/// A trace that cannot be written is refused before the run.
#[test]
fn a_trace_in_no_folder_is_refused() {
    let dir = tempfile::tempdir().unwrap();
    fs::write(dir.path().join("ball.toml"), SCENE).unwrap();
    let done = run(
        dir.path(),
        &["simulate", "ball.toml", "--trace", "nowhere/trace.jsonl"],
    );
    assert_eq!(code(&done), Some(6), "{}", stderr(&done));
    assert!(stderr(&done).contains("nowhere/trace.jsonl"));
    assert!(!dir.path().join("ball-run").exists());
}
