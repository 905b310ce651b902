//! Forces of the rods in what a run leaves.

use crate::{code, killed, run, stderr};
use isosheet_page::Scale;
use isosheet_runs::Recording;
use std::fs;
use std::path::Path;

/// A strip of 0.1 m by 0.6 m and 80 g/m2 that hangs by its upper corners, in the plane x z.
const SCENE: &str = "version = 1
[sheet]
mesh = { rectangle = { width = 0.1, height = 0.6, columns = 1, rows = 6 } }
placement = { turn = { axis = [1, 0, 0], angle = 90 } }
[[support]]
at = { vertices = [12, 13] }
[forces]
gravity = [0, 0, -9.81]
[stop]
time = 0.2
";

fn simulated(folder: &Path, out: &str, edits: &[&str]) -> Recording {
    fs::write(folder.join("strip.toml"), SCENE).unwrap();
    let mut arguments = vec!["simulate", "strip.toml", "--out", out];
    arguments.extend(edits.iter().flat_map(|edit| ["--set", edit]));
    let done = run(folder, &arguments);
    assert_eq!(code(&done), Some(0), "{}", stderr(&done));
    Recording::read(&folder.join(out)).unwrap()
}

/// Statics: across each horizontal cut the rods carry the weight of what is below.
#[test]
fn rods_of_a_strip_at_rest_carry_what_hangs_below() {
    let dir = tempfile::tempdir().unwrap();
    let recording = simulated(dir.path(), "run", &[]);
    let trajectory = &recording.trajectory;
    let last = trajectory.len() - 1;
    let x = trajectory.frame(last).unwrap().as_chunks::<3>().0;
    let forces = trajectory.rod_forces(last).unwrap();
    let first = trajectory.rod_forces(0).unwrap();
    assert!(
        first.iter().all(|f| *f == 0.0),
        "no step has ended there yet"
    );
    let top = x.iter().map(|p| p[2]).fold(f64::MIN, f64::max);
    for row in 0..6 {
        let cut = top - 0.1 * (f64::from(row) + 0.5);
        let mut carried = 0.0;
        for (ends, force) in trajectory.edges().iter().zip(forces) {
            let [a, b] = ends.map(|v| x[v as usize]);
            if (a[2] < cut) != (b[2] < cut) {
                let length = (0..3).map(|k| (a[k] - b[k]).powi(2)).sum::<f64>().sqrt();
                carried += force * (a[2] - b[2]).abs() / length;
            }
        }
        // Each cell gives half of its mass to the vertices below it: what is below a cut through the middle
        // of a cell has the mass of the area there.
        let area = 0.1 * (0.6 - 0.1 * (f64::from(row) + 0.5));
        let weight = 0.08 * area * 9.81;
        assert!(
            (carried - weight).abs() < 1e-6 * weight,
            "row {row}: {carried} N for {weight} N"
        );
    }
    let field = recording.replay().unwrap().fields;
    let field = field
        .iter()
        .find(|f| f.name.starts_with("rod force"))
        .unwrap();
    assert_eq!((field.scale, field.values.len()), (Scale::Signed, last + 1));
    assert_eq!(field.values[last], forces);
    let page = fs::read_to_string(dir.path().join("run/index.html")).unwrap();
    assert!(page.contains("\"name\":\"rod force (tension +)\",\"unit\":\"N\""));
    let converted = run(dir.path(), &["convert", "run", "strip.pvd"]);
    assert_eq!(code(&converted), Some(0), "{}", stderr(&converted));
    let frame = fs::read(dir.path().join(format!("strip/frame_{last:05}.vtp"))).unwrap();
    let text = String::from_utf8_lossy(&frame);
    assert!(text.contains("Name=\"rod_force\""), "{}", &text[..800]);
}

#[test]
fn runs_without_rods_or_their_multipliers_have_no_forces() {
    let dir = tempfile::tempdir().unwrap();
    for (out, edits) in [
        (
            "elastic",
            vec!["sheet.isometry={ elastic = { stiffness = 1e4 } }"],
        ),
        ("chart", vec!["method.integrator=chart", "stop.time=0.02"]),
    ] {
        let recording = simulated(dir.path(), out, &edits);
        assert!(recording.trajectory.len() > 1, "{out}");
        assert_eq!(recording.trajectory.rod_forces(1), None, "{out}");
        let names: Vec<String> = recording
            .replay()
            .unwrap()
            .fields
            .into_iter()
            .map(|f| f.name)
            .collect();
        let expected: &[&str] = match out {
            "elastic" => &["strain", "strain of faces", "share of stretching"],
            _ => &["strain"],
        };
        assert_eq!(names, expected, "{out}");
    }
}

/// The frames of a run that was stopped have the forces, too.
#[test]
fn a_run_that_was_stopped_has_forces_up_to_there() {
    let dir = tempfile::tempdir().unwrap();
    let folder = dir.path();
    fs::write(folder.join("strip.toml"), SCENE).unwrap();
    let simulate = [
        "simulate",
        "strip.toml",
        "--out",
        "run",
        "--set",
        "stop.time=60",
    ];
    killed(folder, &simulate, "run", 30);
    assert!(!folder.join("run/summary.json").exists());
    let recording = Recording::read(&folder.join("run")).unwrap();
    let forces = recording
        .trajectory
        .rod_forces(recording.trajectory.len() - 1);
    let largest = forces.unwrap().iter().copied().fold(0.0, f64::max);
    let weight = 0.08 * 0.06 * 9.81;
    assert!((0.3 * weight..weight).contains(&largest), "{largest} N");
}

/// Masses that differ by twelve powers of ten are too far apart for a least-squares solution: the frames have
/// the forces of the step instead, and can be read.
#[test]
fn frames_have_rod_forces_whatever_the_masses_of_bodies_are() {
    let dir = tempfile::tempdir().unwrap();
    let scene = "version = 1
[sheet]
mesh = { square = { side = 0.1, level = 0 } }
density = 0.1
placement = { position = [5, 5, 5] }
[[support]]
at = \"boundary\"
[[body]]
shape = { box = { size = [0.1, 0.1, 0.1] } }
mass = 1e-6
pose = { position = [0, 0, 0.1] }
[[body]]
shape = { box = { size = [0.1, 0.1, 0.1] } }
mass = 1e6
pose = { position = [0.01, 0.01, 0.25] }
[[obstacle]]
shape = \"half_space\"
[forces]
gravity = [0, 0, -9.81]
[stop]
time = 0.05
";
    fs::write(dir.path().join("far.toml"), scene).unwrap();
    let done = run(dir.path(), &["simulate", "far.toml", "--out", "run"]);
    assert_eq!(code(&done), Some(0), "{}", stderr(&done));
    let recording = Recording::read(&dir.path().join("run")).unwrap();
    for frame in 0..recording.trajectory.len() {
        let forces = recording.trajectory.rod_forces(frame).unwrap();
        assert_eq!(forces.len(), recording.trajectory.edges().len());
        assert!(forces.iter().all(|f| f.is_finite()));
    }
}
