//! What a scene asks for and its sheet cannot do is told: where, by what, how much.

use crate::{code, run, stderr, stdout, summary};
use isosheet_formats::{Trajectory, read_history};
use isosheet_runs::EndReason;
use nalgebra::Vector3;
use serde_json::Value;
use std::f64::consts::TAU;
use std::fmt::Write;
use std::fs;
use std::path::Path;

fn folder_with(scene: &str) -> tempfile::TempDir {
    let dir = tempfile::tempdir().unwrap();
    fs::write(dir.path().join("scene.toml"), scene).unwrap();
    dir
}

/// The problem that ends the run of the scene in a folder.
fn problem(dir: &Path) -> Value {
    let failed = run(dir, &["simulate", "scene.toml", "--json"]);
    assert_eq!(code(&failed), Some(1), "{}", stderr(&failed));
    let said = stdout(&failed);
    let last: Value = serde_json::from_str(said.lines().last().unwrap()).unwrap();
    last["problems"][0].clone()
}

fn text<'a>(problem: &'a Value, field: &str) -> &'a str {
    problem[field]
        .as_str()
        .unwrap_or_else(|| panic!("{problem}"))
}

/// A strip of a limit of 1 % whose end is drawn out by 2 %: Green's strain of 1 % is an elongation of
/// `sqrt(1 + 2 * 0.01) - 1`, at 0.4975 s.
const PULLED: &str = "version = 1
[sheet]
mesh = { rectangle = { width = 0.1, height = 0.02, columns = 4, rows = 1 } }
material = \"office paper\"
isometry = { elastic = { limit = 0.01 } }
[[support]]
at = { half_space = { point = [0, 0, 0], normal = [-1, 0, 0] } }
[[support]]
at = { half_space = { point = [0.1, 0, 0], normal = [1, 0, 0] } }
hold = { moving_pin = { x = { ramp = { to = 0.002, end = 1 } } } }
[method]
step = 0.01
[stop]
time = 1
";

#[test]
fn elastic_sheets_name_the_support_that_pulls_beyond_their_limit() {
    let dir = folder_with(PULLED);
    let problem = problem(dir.path());
    assert_eq!(problem["key"], "support[1].hold");
    let message = text(&problem, "message");
    let asked = message
        .split("asks for ")
        .nth(1)
        .unwrap_or_else(|| panic!("{message}"));
    let asked: f64 = asked.split(' ').next().unwrap().parse().unwrap();
    let allowed = 0.1 * (1.02_f64.sqrt() - 1.0);
    // At the end of the step from 0.49 s. (The message has three digits.)
    assert!(
        (asked / (0.5 * 0.002 - allowed) - 1.0).abs() < 0.02,
        "{message}"
    );
    assert!(
        message.contains("than the strain limit of 0.01 allows at t = 0.5 s"),
        "{message}"
    );
    let stop = [
        "simulate",
        "scene.toml",
        "--set",
        "method.taut=stop",
        "--out",
        "stopped",
    ];
    let stopped = run(dir.path(), &stop);
    assert_eq!(code(&stopped), Some(0), "{}", stderr(&stopped));
    assert!(
        stdout(&stopped).contains("ended since the pin at vertex"),
        "{}",
        stdout(&stopped)
    );
    let ending = summary(&dir.path().join("stopped")).ending;
    assert_eq!(ending.reason, EndReason::Taut);
    // (A step is divided down to a thousandth.)
    let taut = allowed / 0.002;
    assert!(ending.t < taut && ending.t > taut - 0.01, "{ending:?}");
}

/// A pin that is driven through the floor, and two plates that close on a sheet.
#[test]
fn pins_and_plates_that_are_driven_into_bodies_are_named() {
    let pin = "version = 1
        [sheet]
        mesh = { square = { side = 0.1, level = 1 } }
        material = \"office paper\"
        placement = { position = [0, 0, 0.02] }
        [[support]]
        at = { vertices = [0] }
        hold = { moving_pin = { z = { ramp = { to = -0.04, end = 1 } } } }
        [[obstacle]]
        shape = \"half_space\"
        [stop]
        time = 1";
    let pin = problem(folder_with(pin).path());
    assert_eq!(pin["key"], "support[0].hold");
    let message = text(&pin, "message");
    assert!(
        message.contains("the pin at vertex 0 asks at vertex 0 for "),
        "{message}"
    );
    assert!(message.contains("and `obstacle[0]` allow"), "{message}");
    let plates = "version = 1
        [sheet]
        mesh = { square = { side = 0.1, level = 1 } }
        material = \"office paper\"
        placement = { position = [0, 0, 0.001] }
        [[obstacle]]
        shape = \"half_space\"
        [[obstacle]]
        name = \"plate\"
        shape = { box = { size = [0.3, 0.3, 0.01] } }
        pose = { position = [0.05, 0.05, 0.007] }
        motion = { z = { ramp = { to = -0.0103, end = 1 } } }
        [stop]
        time = 1";
    let plates = problem(folder_with(plates).path());
    assert_eq!(plates["key"], "obstacle[1].motion");
    let message = text(&plates, "message");
    assert!(message.contains("`plate` asks at vertex "), "{message}");
    assert!(message.contains("and `obstacle[0]` allow"), "{message}");
}

/// A sheet of rods that a punch draws into an opening that is too narrow.
#[test]
fn stamped_rods_name_what_presses_them() {
    let scene = "version = 1
        [sheet]
        mesh = { square = { side = 0.1, level = 1 } }
        placement = { position = [-0.05, -0.05, 0] }
        [[obstacle]]
        shape = { frame = { outer = 0.2, opening = 0.035, bottom = -0.02, top = -0.002 } }
        [[obstacle]]
        shape = { sphere = { radius = 0.006 } }
        pose = { position = [0, 0, 0.008] }
        motion = { z = { ramp = { to = -0.03, end = 1 } } }
        [forces]
        gravity = [0, 0, -9.81]
        [stop]
        time = 1";
    let problem = problem(folder_with(scene).path());
    assert_eq!(problem["key"], "obstacle[1].motion");
    let message = text(&problem, "message");
    assert!(
        message.starts_with("`obstacle[1]` asks at vertex 12"),
        "{message}"
    );
    assert!(
        message.contains("the rods and `obstacle[0]` allow"),
        "{message}"
    );
}

/// A tube of nine faces, glued along a seam, between a floor and a plate that come as close as a tenth of its
/// perimeter.
fn pressed_tube(dir: &Path, friction: f64) {
    let (columns, rows, radius) = (9, 3, 0.0028);
    let side = 2.0 * radius * (TAU / 18.0).sin();
    let (mut flat, mut round, mut faces) = (String::new(), String::new(), String::new());
    for j in 0..rows {
        let y = 0.0026 * f64::from(j);
        for i in 0..=columns {
            let turn = TAU * f64::from(i % columns) / f64::from(columns);
            let (x, z) = (radius * turn.cos(), radius * turn.sin());
            writeln!(flat, "v {} {y} 0", side * f64::from(i)).unwrap();
            writeln!(round, "v {x} {y} {z}").unwrap();
            let a = 1 + j * (columns + 1) + i;
            let (b, c, d) = (a + 1, a + columns + 2, a + columns + 1);
            if i < columns && j + 1 < rows {
                writeln!(faces, "f {a} {b} {c}\nf {a} {c} {d}").unwrap();
            }
        }
    }
    fs::write(dir.join("flat.obj"), flat + &faces).unwrap();
    fs::write(dir.join("round.obj"), round + &faces).unwrap();
    let scene = format!(
        "version = 1
        [sheet]
        mesh = {{ file = {{ path = \"flat.obj\" }} }}
        mass = 5.0
        isometry = {{ elastic = {{ stiffness = 2.4e7, poisson = 0.3, limit = 0.01 }} }}
        bending = {{ plate = {{ rigidity = 3.3e-5 }} }}
        start = {{ file = {{ path = \"round.obj\" }} }}
        [[glue]]
        first = {{ vertices = [0, 10, 20] }}
        second = {{ vertices = [9, 19, 29] }}
        [[obstacle]]
        shape = \"half_space\"
        pose = {{ position = [0, 0, -0.00286] }}
        friction = {friction}
        [[obstacle]]
        shape = {{ box = {{ size = [0.0084, 0.0105, 0.0028] }} }}
        pose = {{ position = [0, 0.0026, 0.00426] }}
        friction = {friction}
        motion = {{ z = {{ smooth_step = {{ to = -0.0047, end = 0.31 }} }} }}
        [contact]
        self_contact = true
        friction = {friction}
        [forces]
        gravity = [0, 0, -0.18]
        [method]
        integrator = \"implicit_euler\"
        step = 0.005
        [stop]
        time = 0.345"
    );
    fs::write(dir.join("scene.toml"), scene).unwrap();
}

/// With friction it jams between the plates; without it folds flat, and stores some joules (its nine faces
/// are strained to the limit).
#[test]
fn friction_that_does_not_settle_is_no_step() {
    let dir = tempfile::tempdir().unwrap();
    let dir = dir.path();
    pressed_tube(dir, 0.8);
    let jam = problem(dir);
    assert_eq!(jam["key"], "obstacle[1].motion");
    let message = text(&jam, "message");
    assert!(
        message.contains("`obstacle[1]` presses the sheet with"),
        "{message}"
    );
    assert!(message.contains("against `obstacle[0]`"), "{message}");
    let history = read_history(&dir.join("scene-run/history.csv")).unwrap();
    let exchanged = |work: f64| history.iter().all(|row| row.work.abs() < work);
    // (What was accepted with unsettled friction worked 27 203 J.)
    assert!(history.len() > 20 && exchanged(2.0), "{:?}", history.last());
    pressed_tube(dir, 0.0);
    let folds = run(dir, &["simulate", "scene.toml", "--force"]);
    assert_eq!(code(&folds), Some(0), "{}", stderr(&folds));
    let energy = summary(&dir.join("scene-run")).energy;
    assert!(
        energy.largest_gain < 0.02 * energy.largest_exchange,
        "{energy:?}"
    );
    assert!(energy.largest_exchange < 100.0, "{energy:?}");
}

/// Two pins that are glued to each other, and a crease between vertices that are held.
#[test]
fn seams_and_creases_that_do_not_close_stand_in_the_last_line() {
    let scene = "version = 1
        [sheet]
        mesh = { rectangle = { width = 0.1, height = 0.02, columns = 10, rows = 2 } }
        material = \"office paper\"
        damping = 5
        [[support]]
        at = { vertices = [0, 10] }
        [[glue]]
        first = { vertices = [0] }
        second = { vertices = [10] }
        closing = { smooth_step = { to = 1, end = 0.05 } }
        [stop]
        time = 0.1";
    let dir = folder_with(scene);
    let done = run(dir.path(), &["simulate", "scene.toml"]);
    assert_eq!(code(&done), Some(0), "{}", stderr(&done));
    let said = stdout(&done);
    assert!(
        said.contains("seams are open by 1.0e-1 m at most, at `glue[0]`"),
        "{said}"
    );
    let ending = summary(&dir.path().join("scene-run")).ending;
    assert_eq!(ending.residuals.seams, [0.1]);
    let page = fs::read_to_string(dir.path().join("scene-run/index.html")).unwrap();
    assert!(page.contains("seams are open by 1.0e-1 m"));
    let scene = "version = 1
        [sheet]
        mesh = { rectangle = { width = 0.2, height = 0.1, columns = 2, rows = 1 } }
        [[support]]
        at = \"all\"
        [[crease]]
        at = { line = { from = [0.1, 0, 0], to = [0.1, 0.1, 0] } }
        stiffness = 0.01
        angle = { ramp = { to = 90, end = 0.05 } }
        [stop]
        time = 0.1";
    let dir = folder_with(scene);
    let done = run(dir.path(), &["simulate", "scene.toml"]);
    assert_eq!(code(&done), Some(0), "{}", stderr(&done));
    let said = stdout(&done);
    let told = "driven creases differ from their angles by 90.00 degrees at most, at `crease[0]`";
    assert!(said.contains(told), "{said}");
}

/// A sheet that starts stretched by 0.2 % and draws together.
#[test]
fn extremes_of_a_run_include_its_start() {
    let corners =
        |size: f64| format!("v 0 0 0\nv {size} 0 0\nv {size} 0.1 0\nv 0 0.1 0\nf 1 2 3\nf 1 3 4\n");
    let scene = "version = 1
        [sheet]
        mesh = { file = { path = \"rest.obj\" } }
        material = \"office paper\"
        damping = 200
        start = { file = { path = \"start.obj\" } }
        placement = { position = [0, 0, 0.0001] }
        [[obstacle]]
        shape = \"half_space\"
        [stop]
        time = 0.2";
    let dir = folder_with(scene);
    fs::write(dir.path().join("rest.obj"), corners(0.1)).unwrap();
    fs::write(dir.path().join("start.obj"), corners(0.1002)).unwrap();
    let done = run(dir.path(), &["simulate", "scene.toml"]);
    assert_eq!(code(&done), Some(0), "{}", stderr(&done));
    let summary = summary(&dir.path().join("scene-run"));
    assert!(
        (summary.largest_strain / 0.002 - 1.0).abs() < 1e-9,
        "{}",
        summary.largest_strain
    );
    let history = read_history(&dir.path().join("scene-run/history.csv")).unwrap();
    let gaps = history.iter().filter_map(|row| row.gap);
    assert!(history[0].gap.is_some(), "{:?}", history[0]);
    assert_eq!(summary.smallest_gap, gaps.reduce(f64::min));
}

/// A square sheet with a slit, drawn as a cut edge, whose sides touch at the start: with self-contact it
/// hangs by one side, and the slit opens.
#[test]
fn sides_of_a_slit_start_together_and_part() {
    let dir = tempfile::tempdir().unwrap();
    let dir = dir.path();
    let slit = serde_json::json!({
        "file_spec": 1.2, "frame_classes": ["creasePattern"], "frame_unit": "m",
        "vertices_coords": [[0, 0], [0.1, 0], [0.1, 0.1], [0, 0.1], [0.02, 0.05], [0.05, 0.05], [0.08, 0.05]],
        "edges_vertices": [[4, 5], [5, 6]],
        "edges_assignment": ["C", "C"],
        "faces_vertices": [[0, 1, 5], [0, 5, 4], [0, 4, 3], [1, 6, 5], [1, 2, 6], [2, 5, 6], [2, 3, 5], [3, 4, 5]],
    });
    fs::write(dir.join("slit.fold"), slit.to_string()).unwrap();
    let scene = "version = 1
        [sheet]
        mesh = { file = { path = \"slit.fold\" } }
        refine = 2
        material = \"office paper\"
        damping = 5
        [[support]]
        at = { half_space = { point = [0, 0.001, 0], normal = [0, -1, 0] } }
        [[support]]
        at = { half_space = { point = [0, 0.099, 0], normal = [0, 1, 0] } }
        hold = { moving_pin = { y = { smooth_step = { to = -0.01, end = 0.3 } } } }
        [forces]
        gravity = [0, 0, -9.81]
        [contact]
        self_contact = true
        [stop]
        time = 0.4";
    fs::write(dir.join("scene.toml"), scene).unwrap();
    let done = run(dir, &["simulate", "scene.toml"]);
    assert_eq!(code(&done), Some(0), "{}", stderr(&done));
    let trajectory = Trajectory::read(&dir.join("scene-run/trajectory.npz")).unwrap();
    let [first, last] = [0, trajectory.times().len() - 1].map(|k| trajectory.frame(k).unwrap());
    let place = |x: &[f64], v: usize| Vector3::new(x[3 * v], x[3 * v + 1], x[3 * v + 2]);
    let count = first.len() / 3;
    let pairs = (0..count).flat_map(|a| (a + 1..count).map(move |b| [a, b]));
    let together = pairs.filter(|&[a, b]| place(first, a) == place(first, b));
    let parted: Vec<f64> = together
        .map(|[a, b]| (place(last, a) - place(last, b)).norm())
        .collect();
    // Seven vertices of the two cut edges, divided in four, lie between the ends of the slit.
    assert_eq!(parted.len(), 7, "{parted:?}");
    assert!(parted.iter().all(|d| *d > 1e-6), "{parted:?}");
}
