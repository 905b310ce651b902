//! What runs of sheets that yield leave.

use crate::{code, killed, run, stderr};
use isosheet_formats::{Series, SeriesOptions, read_history};
use isosheet_page::{Centering, Scale};
use isosheet_runs::Recording;
use std::fs;
use std::path::Path;

/// A strip that is held at one end and falls.
const SCENE: &str = "version = 1
[sheet]
mesh = { rectangle = { width = 0.2, height = 0.02, columns = 8, rows = 1 } }
material = \"office paper\"
damping = 5
[[support]]
at = { box = { min = [-0.01, -0.01, -1], max = [0.03, 0.03, 1] } }
[forces]
gravity = [0, 0, -9.81]
[stop]
time = 0.3
";

/// The history says what has been dissipated where something can yield, and there alone; it ends with what
/// the summary says.
#[test]
fn a_history_says_what_yielding_has_dissipated() {
    let dir = tempfile::tempdir().unwrap();
    fs::write(dir.path().join("strip.toml"), SCENE).unwrap();
    let simulated = |out: &str, edits: &[&str]| {
        let mut arguments = vec!["simulate", "strip.toml", "--out", out];
        arguments.extend(edits.iter().flat_map(|edit| ["--set", edit]));
        let done = run(dir.path(), &arguments);
        assert_eq!(code(&done), Some(0), "{}", stderr(&done));
        let out = dir.path().join(out);
        let summary = fs::read_to_string(out.join("summary.json")).unwrap();
        let summary: serde_json::Value = serde_json::from_str(&summary).unwrap();
        (read_history(&out.join("history.csv")).unwrap(), summary)
    };
    let (elastic, _) = simulated("elastic", &[]);
    assert!(elastic.iter().all(|row| row.plastic.is_none()));
    let (rows, summary) = simulated("yields", &["sheet.yield={moment=1e-3,layers=3}"]);
    let plastic: Vec<f64> = rows.iter().map(|row| row.plastic.unwrap()).collect();
    assert_eq!(plastic[0], 0.0);
    assert!(
        plastic.is_sorted() && plastic[plastic.len() - 1] > 0.0,
        "{plastic:?}"
    );
    let end = summary["ending"]["plastic"].as_f64();
    assert_eq!(end, plastic.last().copied());
}

/// A panel is folded by 90 degrees at a crease of a sheet without bending stiffness, and turned back to 70.
const FOLDED: &str = "version = 1
[sheet]
mesh = { rectangle = { width = 0.2, height = 0.1, columns = 5, rows = 1 } }
isometry = \"rods\"
bending = \"none\"
density = 0.08
damping = 20
[[crease]]
name = \"lid\"
at = { line = { from = [0.08, 0, 0], to = [0.08, 0.1, 0] } }
stiffness = 0.02
yield = { moment = 0.01 }
[[support]]
at = { box = { min = [0.03, -1, -1], max = [0.09, 1, 1] } }
[[support]]
at = { box = { min = [0.11, -1, -1], max = [1, 1, 1] } }
[support.hold.moving_pin.rotation]
centre = [0.08, 0, 0]
axis = [0, 1, 0]
angle = { keyframes = { interpolation = \"linear\", keys = [[0, 0], [1, -90], [2, -70]] } }
[[measure]]
name = \"opening\"
at = { box = { min = [0.03, -1, -1], max = [0.09, 1, 1] } }
quantity = { angle_to = { box = { min = [0.11, -1, -1], max = [1, 1, 1] } } }
[stop]
time = 2.0
";

/// A crease without hardening keeps its angle under load less its moment over its stiffness.
#[test]
fn the_last_line_tells_what_a_crease_keeps() {
    let dir = tempfile::tempdir().unwrap();
    fs::write(dir.path().join("lid.toml"), FOLDED).unwrap();
    let simulated = run(dir.path(), &["simulate", "lid.toml", "--out", "run"]);
    assert_eq!(code(&simulated), Some(0), "{}", stderr(&simulated));
    let said = String::from_utf8(simulated.stdout).unwrap();
    let summary = fs::read_to_string(dir.path().join("run/summary.json")).unwrap();
    let summary: serde_json::Value = serde_json::from_str(&summary).unwrap();
    // The angle between the two panels is the one by which the support has turned.
    let opening = &summary["measures"]["opening"];
    let last = opening["last"].as_f64().unwrap();
    assert!((last - 70.0).abs() < 1e-9, "{opening}");
    let kept = &summary["ending"]["kept"]["creases"][0];
    let springback = (0.01_f64 / 0.02).to_degrees();
    for (key, expected) in [
        ("loaded", 90.0),
        ("kept", 90.0 - springback),
        ("springback", springback),
    ] {
        let found = kept[key].as_f64().unwrap();
        // Steps need not end at the very time of the largest angle.
        assert!(
            (found - expected).abs() < 1.0,
            "{key} {found} of {expected}"
        );
    }
    let words =
        "`crease[0]` (\"lid\") keeps 61.4 of 90.0 degrees under load, a springback of 28.6 degrees";
    assert!(said.contains(words), "{said}");
    let info = run(dir.path(), &["info", "run"]);
    assert!(String::from_utf8(info.stdout).unwrap().contains(words));
    // Without yielding there is nothing to tell.
    let elastic = [
        "simulate",
        "lid.toml",
        "--out",
        "elastic",
        "--set",
        "crease[0].yield.moment=10",
    ];
    let elastic = run(dir.path(), &elastic);
    assert_eq!(code(&elastic), Some(0), "{}", stderr(&elastic));
    assert!(!String::from_utf8(elastic.stdout).unwrap().contains("keeps"));
}

/// Rigidity (N m), yield moment (N) and hardening (N m) of [`bent`].
const D: f64 = 5e-4;
const MOMENT: f64 = 1e-3;
const HARDENING: f64 = 1e-4;

/// Clamped at both ends, the free part of a strip, 0.2 m long, is bent upwards to an arc of the curvature 5 /
/// m, within a second, and back to the curvature `p` at which its moment is zero. It is light, so that no
/// waves bend it further. (Without a Poisson's ratio its sides do not curl.)
fn bent(p: f64) -> String {
    let arc = |k: f64| {
        [
            (0.2 * k).sin() / k - 0.2,
            (1.0 - (0.2 * k).cos()) / k,
            -(0.2 * k).to_degrees(),
        ]
    };
    let steps = 20;
    let curvatures: Vec<f64> = (0..=2 * steps)
        .map(|i| match f64::from(i) / f64::from(steps) {
            s if s <= 1.0 => 5.0 * s,
            s => p + (5.0 - p) * (2.0 - s),
        })
        .collect();
    let keys = |axis: usize| -> String {
        let key = |(i, &k): (usize, &f64)| {
            let value = if k == 0.0 { 0.0 } else { arc(k)[axis] };
            format!("[{}, {value}], ", i as f64 / f64::from(steps))
        };
        let all: String = curvatures.iter().enumerate().map(key).collect();
        format!("{{ keyframes = {{ keys = [{all}] }} }}")
    };
    format!(
        "version = 1
[sheet]
mesh = {{ rectangle = {{ width = 0.22, height = 0.02, columns = 22, rows = 2 }} }}
material = \"office paper\"
bending = {{ plate = {{ rigidity = {D}, poisson = 0 }} }}
density = 0.0008
yield = {{ moment = {MOMENT}, hardening = {HARDENING}, layers = 1 }}
damping = 20
[[support]]
at = {{ box = {{ min = [-1, -1, -1], max = [0.0101, 1, 1] }} }}
[[support]]
at = {{ box = {{ min = [0.2099, -1, -1], max = [1, 1, 1] }} }}
[support.hold.moving_pin]
x = {x}
z = {z}
rotation = {{ centre = [0.21, 0, 0], axis = [0, 1, 0], angle = {angle} }}
[stop]
time = 2.0
",
        x = keys(0),
        z = keys(1),
        angle = keys(2)
    )
}

fn recorded(dir: &Path, scene: &str) -> Recording {
    fs::write(dir.join("scene.toml"), scene).unwrap();
    let done = run(dir, &["simulate", "scene.toml", "--out", "run"]);
    assert_eq!(code(&done), Some(0), "{}", stderr(&done));
    Recording::read(&dir.join("run")).unwrap()
}

/// A strip that is bent and let go keeps `(D k - M) / (D + H)`, in the frames, on the page and in converted
/// files.
#[test]
fn the_curvature_that_stays_is_in_the_frames() {
    let dir = tempfile::tempdir().unwrap();
    let dir = dir.path();
    let expected = (D * 5.0 - MOMENT) / (D + HARDENING);
    let recording = recorded(dir, &bent(expected));
    let trajectory = &recording.trajectory;
    let (last, t) = (trajectory.len() - 1, recording.sheet.topology());
    assert_eq!(trajectory.plastic_angles(last), None);
    let start = trajectory.plastic_curvatures(0).unwrap();
    assert!(start.iter().all(|p| *p == 0.0));
    let values = trajectory
        .plastic_curvatures(last)
        .unwrap()
        .as_chunks::<2>()
        .0;
    let x = recording.sheet.positions().as_chunks::<3>().0;
    let mut compared = 0;
    for (corners, [first, second]) in t.faces().iter().zip(values) {
        let middle = corners.iter().map(|v| x[v.index()][0]).sum::<f64>() / 3.0;
        if (0.04..0.18).contains(&middle) {
            // Bent upwards, it is a valley as seen from above.
            assert!(
                (first - expected).abs() < 0.02 * expected,
                "{first} {expected}"
            );
            assert!(second.abs() < 0.02 * expected, "{second}");
            compared += 1;
        }
    }
    assert_eq!(compared, 2 * 2 * 14);
    let replay = recording.replay().unwrap();
    let field = |f: &&isosheet_page::Field| f.name == "curvature that stays (valley +)";
    let field = replay.fields.iter().find(field).unwrap();
    assert_eq!((field.place, field.scale), (Centering::Face, Scale::Signed));
    assert_eq!(field.values[last][40], values[40][0]);
    let converted = run(dir, &["convert", "run", "strip.pvd"]);
    assert_eq!(code(&converted), Some(0), "{}", stderr(&converted));
    let frame = fs::read(dir.join(format!("strip/frame_{last:05}.vtp"))).unwrap();
    let text = String::from_utf8_lossy(&frame);
    let (_, cells) = text.split_once("<CellData").unwrap();
    for name in ["plastic_curvature_1", "plastic_curvature_2"] {
        assert!(cells.contains(&format!("Name=\"{name}\"")), "{name}");
    }
}

/// A run that was killed and continued has the same plastic curvatures as one without a stop.
#[test]
fn a_continued_run_keeps_what_stays() {
    let dir = tempfile::tempdir().unwrap();
    let dir = dir.path();
    let whole = recorded(dir, &bent(2.5));
    let again = ["simulate", "scene.toml", "--out", "cut"];
    let cut = [&again[..], &["--set", "output.checkpoint_interval=0"]].concat();
    killed(dir, &cut, "cut", 40);
    let done = run(dir, &cut);
    assert_eq!(code(&done), Some(0), "{}", stderr(&done));
    let continued = Recording::read(&dir.join("cut")).unwrap();
    assert_eq!(continued.trajectory, whole.trajectory);
}

/// A crease that is folded beyond its yield keeps its angle less that of the moment; other edges have none.
/// The angle of a moment `M` is that of the crease, `M / 0.01 N`, and of the sheet over the faces beside it,
/// whose middles are as far apart as the edges are long, `M l / D`: both are 0.2 rad.
#[test]
fn the_angle_that_stays_is_in_the_frames() {
    let dir = tempfile::tempdir().unwrap();
    let recording = recorded(
        dir.path(),
        "version = 1
[sheet]
mesh = { rectangle = { width = 0.2, height = 0.1, columns = 4, rows = 2 } }
material = \"office paper\"
damping = 10
[[crease]]
at = { line = { from = [0.1, 0, 0], to = [0.1, 0.1, 0] } }
stiffness = 0.01
yield = { moment = 0.002 }
[[support]]
at = { box = { min = [-1, -1, -1], max = [0.1001, 1, 1] } }
[[support]]
at = { box = { min = [0.1999, -1, -1], max = [1, 1, 1] } }
[support.hold.moving_pin.rotation]
centre = [0.1, 0, 0]
axis = [0, 1, 0]
angle = { ramp = { to = -60, end = 1 } }
[stop]
time = 1
",
    );
    let trajectory = &recording.trajectory;
    let (last, t) = (trajectory.len() - 1, recording.sheet.topology());
    assert_eq!(trajectory.plastic_curvatures(last), None);
    let stays = trajectory.plastic_angles(last).unwrap();
    let series = Series::new(trajectory, &SeriesOptions::default()).unwrap();
    let folds = series.fold_angles(last);
    let x = recording.sheet.positions().as_chunks::<3>().0;
    let mut creases = 0;
    for e in t.edge_ids() {
        let on_crease = t.edges()[e.index()]
            .iter()
            .all(|v| (x[v.index()][0] - 0.1).abs() < 1e-9);
        let (p, fold) = (stays[e.index()], folds[e.index()]);
        if on_crease {
            // The kink has the elastic part `M_y / k` besides.
            assert!((p - (fold - 0.2)).abs() < 1e-9, "{p} of {fold}");
            creases += 1;
        } else {
            assert_eq!(p, 0.0);
        }
    }
    assert_eq!(creases, 2);
    let replay = recording.replay().unwrap();
    let field = replay
        .fields
        .iter()
        .find(|f| f.name == "angle that stays (valley +)")
        .unwrap();
    assert_eq!((field.place, &*field.unit), (Centering::Crease, "°"));
}
