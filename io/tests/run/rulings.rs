//! Rulings and Gauss curvature of runs: in files of other programs, pictures and pages.

use crate::{code, run, stderr, summary};
use isosheet_formats::Trajectory;
use isosheet_runs::Recording;
use std::fs;

/// A strip of office paper, clamped at its left end, that a moment rolls up to the curvature
/// `M / (D w) = 8 / m` towards its front.
const SCENE: &str = "version = 1
[sheet]
mesh = { rectangle = { width = 0.1, height = 0.05, columns = 20, rows = 10, diagonals = \"rising\" } }
material = \"office paper\"
bending = { plate = { rigidity = 5e-4, poisson = 0 } }
damping = 10
[[support]]
at = { half_space = { point = [1e-6, 0, 0], normal = [-1, 0, 0] } }
hold = \"clamp\"
[[forces.moment]]
at = { half_space = { point = [0.0999, 0, 0], normal = [1, 0, 0] } }
axis = [0, -1, 0]
size = { smooth_step = { to = 2e-4, end = 1 } }
[stop]
time = 2
[output]
curvature = true
";

#[test]
fn a_strip_under_a_moment_is_ruled_along_the_axis_of_the_moment() {
    let dir = tempfile::tempdir().unwrap();
    let dir = dir.path();
    fs::write(dir.join("strip.toml"), SCENE).unwrap();
    for words in [
        &["simulate", "strip.toml", "--out", "run"][..],
        &["convert", "run", "all.npz"],
        &["convert", "run", "all.pvd"],
        &["convert", "run", "end.png", "--colour", "curvature"],
        &["convert", "run", "gauss.png", "--colour", "Gauss curvature"],
    ] {
        let done = run(dir, words);
        assert_eq!(code(&done), Some(0), "{words:?}: {}", stderr(&done));
    }
    let frames = Trajectory::read(&dir.join("all.npz")).unwrap();
    let own = Trajectory::read(&dir.join("run/trajectory.npz")).unwrap();
    assert_eq!(own, frames);
    let last = frames.len() - 1;
    assert!(frames.rulings(0).unwrap().iter().all(|c| *c == 0.0));
    assert!(
        frames
            .ruling_curvatures(0)
            .unwrap()
            .iter()
            .all(|c| *c == 0.0)
    );
    let recording = Recording::read(&dir.join("run")).unwrap();
    let t = recording.sheet.topology();
    let rulings = frames.rulings(last).unwrap().as_chunks::<3>().0;
    let curvatures = frames.ruling_curvatures(last).unwrap();
    for (f, corners) in t.faces().iter().enumerate() {
        // The middle half: loads and clamps act at the rim, where fits reach to one side.
        let [x, y] = [0, 1].map(|k| {
            corners
                .iter()
                .map(|v| recording.sheet.position(*v)[k])
                .sum::<f64>()
                / 3.0
        });
        if (x - 0.05).abs() > 0.025 || (y - 0.025).abs() > 0.0125 {
            continue;
        }
        let (d, curvature) = (rulings[f], curvatures[f]);
        assert!(d[1] > 0.999, "{f}: {d:?}");
        assert!((curvature / 8.0 - 1.0).abs() < 0.02, "{f}: {curvature}");
    }
    // What is left of the Gauss curvature is stretching. Lengths that change by the part `e` change the angle
    // between the sides `b` and `c` of a face by at most `2 e (cot B + cot C)`: 4 e at the right angles of
    // these faces and 2 e at the others, 16 e at a vertex, whose share of the area is a square.
    let strain = summary(&dir.join("run")).elastic.unwrap().strain;
    let gauss = frames.gauss_curvatures(last).unwrap();
    let largest = gauss.iter().fold(0.0_f64, |m, k| m.max(k.abs()));
    assert!(
        largest > 0.0 && largest < 16.0 * strain / 5e-3_f64.powi(2),
        "{largest} {strain}"
    );
    let file = fs::read_dir(dir.join("all"))
        .unwrap()
        .next()
        .unwrap()
        .unwrap();
    let text = String::from_utf8_lossy(&fs::read(file.path()).unwrap()).into_owned();
    for name in ["ruling", "ruling_curvature", "gauss_curvature"] {
        assert!(text.contains(&format!("Name=\"{name}\"")), "{name}");
    }
    let replay = recording.replay().unwrap();
    let field = replay
        .fields
        .iter()
        .find(|f| f.name == "curvature (valley +)")
        .unwrap();
    assert_eq!(field.values[last], curvatures);
    assert!(
        recording
            .quantities()
            .iter()
            .filter(|q| q.contains("urvature"))
            .count()
            == 2
    );
}
