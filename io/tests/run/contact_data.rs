//! Forces of contact and gaps of the vertices in what a run leaves.

use crate::headless::self_test;
use crate::{code, killed, run, stderr};
use isosheet_formats::{LoadKind, read_loads};
use isosheet_page::{Field, Scale};
use isosheet_runs::Recording;
use std::fs;
use std::path::Path;

/// A cloth of 0.3 m by 0.3 m and 0.018 kg that falls onto a box of half its size.
const SCENE: &str = "version = 1
[sheet]
mesh = { square = { side = 0.3, level = 1 } }
density = 0.2
damping = 10
placement = { position = [-0.15, -0.15, 0] }
[[obstacle]]
shape = { box = { size = [0.15, 0.15, 0.1] } }
pose = { position = [0, 0, -0.06] }
friction = 0.3
[contact]
self_contact = true
activation = 1e-3
[forces]
gravity = [0, 0, -9.81]
[stop]
time = 1.5
";
const WEIGHT: f64 = 0.2 * 0.09 * 9.81;

fn simulated(folder: &Path, out: &str, edits: &[&str]) -> Recording {
    fs::write(folder.join("cloth.toml"), SCENE).unwrap();
    let mut arguments = vec!["simulate", "cloth.toml", "--out", out];
    arguments.extend(edits.iter().flat_map(|edit| ["--set", edit]));
    let done = run(folder, &arguments);
    assert_eq!(code(&done), Some(0), "{}", stderr(&done));
    Recording::read(&folder.join(out)).unwrap()
}

fn total(forces: &[f64]) -> [f64; 3] {
    let vectors = forces.as_chunks::<3>().0.iter();
    vectors.fold([0.0; 3], |sum, f| [0, 1, 2].map(|k| sum[k] + f[k]))
}

#[test]
fn contact_is_in_the_trajectory_and_carries_the_sheet() {
    let dir = tempfile::tempdir().unwrap();
    let recording = simulated(dir.path(), "run", &[]);
    let trajectory = &recording.trajectory;
    let last = trajectory.len() - 1;
    // Nothing is within reach in the first frame: 10 mm above the box, no force, and the gap is the reach.
    assert!(
        trajectory
            .contact_forces(0)
            .unwrap()
            .iter()
            .all(|f| *f == 0.0)
    );
    assert!(trajectory.gaps(0).unwrap().iter().all(|gap| *gap == 1e-3));
    // At rest the box carries the weight, up to what is left of the motion and the projection of a step.
    let sum = total(trajectory.contact_forces(last).unwrap());
    assert!(
        (sum[2] / WEIGHT - 1.0).abs() < 0.01,
        "{sum:?} for {WEIGHT} N"
    );
    assert!(sum[0].hypot(sum[1]) < 0.01 * WEIGHT, "{sum:?}");
    // The summary has the force on the box.
    let loads = &recording.summary.as_ref().unwrap().ending.obstacles;
    for k in 0..3 {
        assert!((sum[k] + loads[0][k]).abs() < 1e-12 * WEIGHT, "{loads:?}");
    }
    // The history has the smallest gap.
    let mut compared = 0;
    for (k, t) in trajectory.times().iter().enumerate() {
        let row = recording.history.iter().find(|row| row.t == *t).unwrap();
        let least = trajectory
            .gaps(k)
            .unwrap()
            .iter()
            .copied()
            .fold(1e-3, f64::min);
        if k > 0 {
            assert_eq!(least, row.gap.unwrap_or(1e-3), "frame {k}");
            compared += usize::from(least < 1e-3);
        }
    }
    assert!(compared > 30, "{compared}");
}

#[test]
fn contact_is_on_the_page_and_in_converted_files() {
    let dir = tempfile::tempdir().unwrap();
    let dir = dir.path();
    let recording = simulated(dir, "run", &["stop.time=0.3"]);
    let trajectory = &recording.trajectory;
    let (last, replay) = (trajectory.len() - 1, recording.replay().unwrap());
    let field = |name: &str| -> &Field { replay.fields.iter().find(|f| f.name == name).unwrap() };
    let (forces, gaps) = (field("contact force"), field("gap"));
    assert_eq!((forces.scale, &*forces.unit), (Scale::Magnitude, "N"));
    assert_eq!((gaps.scale, &*gaps.unit), (Scale::Linear, "m"));
    let expected = trajectory.contact_forces(last).unwrap().as_chunks::<3>().0;
    for (size, f) in forces.values[last].iter().zip(expected) {
        let expected = (f[0] * f[0] + f[1] * f[1] + f[2] * f[2]).sqrt();
        assert!((size - expected).abs() <= 1e-15 * expected);
    }
    assert_eq!(gaps.values[last], trajectory.gaps(last).unwrap());
    let all_recorded = replay
        .summary
        .iter()
        .all(|(name, _)| name != "not recorded");
    assert!(all_recorded, "{:?}", replay.summary);

    let convert = |out: &str| {
        let done = run(dir, &["convert", "run", out]);
        assert_eq!(code(&done), Some(0), "{}", stderr(&done));
    };
    convert("cloth.csv");
    let table = fs::read_to_string(dir.join("cloth.csv")).unwrap();
    let header = "frame,t,vertex,x,y,z,contact_force_x,contact_force_y,contact_force_z,gap";
    assert_eq!(table.lines().next(), Some(header));
    let row: Vec<f64> = table
        .lines()
        .last()
        .unwrap()
        .split(',')
        .map(|c| c.parse().unwrap())
        .collect();
    let v = trajectory.vertex_count() - 1;
    assert_eq!(row[6..9], expected[v]);
    assert_eq!(row[9], trajectory.gaps(last).unwrap()[v]);
    convert("cloth.pvd");
    let frame = fs::read(dir.join(format!("cloth/frame_{last:05}.vtp"))).unwrap();
    let text = String::from_utf8_lossy(&frame);
    let (points, _) = text.split_once("</PointData>").unwrap();
    assert!(
        points.contains("Name=\"contact_force\" NumberOfComponents=\"3\""),
        "{points}"
    );
    assert!(points.contains("Name=\"gap\""), "{points}");

    let page = fs::read_to_string(dir.join("run/index.html")).unwrap();
    let Some(result) = self_test(&page, "1200,800") else {
        return;
    };
    let index = |name: &str| replay.fields.iter().position(|f| f.name == name).unwrap();
    for (name, within) in [("contact force", 3e-4), ("gap", 1e-4)] {
        // The self-test names the values of the first vertex, edge or face in the last frame that it shows.
        let value = result["values"][index(name)].as_f64();
        let shown = value.unwrap_or_else(|| panic!("{result}"));
        let frame = replay.fields[index(name)].values.iter();
        let known = frame
            .map(|values| values[0])
            .any(|v| (v - shown).abs() <= within * v.abs());
        assert!(known, "{name}: {shown}");
    }
}

#[test]
fn runs_without_contact_have_no_such_data() {
    let dir = tempfile::tempdir().unwrap();
    let dir = dir.path();
    let scene = SCENE.split("[[obstacle]]").next().unwrap().to_owned()
        + "[forces]\ngravity = [0, 0, -9.81]\n[stop]\ntime = 0.1\n";
    fs::write(dir.join("free.toml"), scene).unwrap();
    let done = run(dir, &["simulate", "free.toml", "--out", "run"]);
    assert_eq!(code(&done), Some(0), "{}", stderr(&done));
    let recording = Recording::read(&dir.join("run")).unwrap();
    assert_eq!(recording.trajectory.contact_forces(1), None);
    assert_eq!(recording.trajectory.gaps(1), None);
    let replay = recording.replay().unwrap();
    let names: Vec<&str> = replay.fields.iter().map(|f| &*f.name).collect();
    assert_eq!(names, ["strain", "rod force (tension +)"]);
    let converted = run(dir, &["convert", "run", "free.csv"]);
    assert_eq!(code(&converted), Some(0), "{}", stderr(&converted));
    let table = fs::read_to_string(dir.join("free.csv")).unwrap();
    assert_eq!(table.lines().next(), Some("frame,t,vertex,x,y,z"));
}

/// The frames of a run that was stopped have forces and gaps, too.
#[test]
fn a_run_that_was_stopped_has_contact_up_to_there() {
    let dir = tempfile::tempdir().unwrap();
    let folder = dir.path();
    fs::write(folder.join("cloth.toml"), SCENE).unwrap();
    let simulate = [
        "simulate",
        "cloth.toml",
        "--out",
        "run",
        "--set",
        "stop.time=600",
    ];
    killed(folder, &simulate, "run", 60);
    assert!(!folder.join("run/summary.json").exists());
    let trajectory = Recording::read(&folder.join("run")).unwrap().trajectory;
    let last = trajectory.len() - 1;
    let sum = total(trajectory.contact_forces(last).unwrap());
    assert!(sum[2] > 0.3 * WEIGHT, "{sum:?}");
    let least = trajectory
        .gaps(last)
        .unwrap()
        .iter()
        .copied()
        .fold(1.0, f64::min);
    assert!(least > 0.0 && least < 1e-3, "{least}");
}

/// Loads are in a table for each step: at rest the box carries the weight, and its torque about the middle of
/// the box is zero by symmetry; a sheet without supports and obstacles has no table.
#[test]
fn loads_are_in_a_table() {
    let dir = tempfile::tempdir().unwrap();
    let dir = dir.path();
    let recording = simulated(dir, "run", &[]);
    let loads = read_loads(&dir.join("run/loads.csv")).unwrap();
    assert_eq!(loads.len(), recording.history.len() - 1);
    for (load, row) in loads.iter().zip(&recording.history[1..]) {
        assert_eq!(
            (load.t, load.on, load.number),
            (row.t, LoadKind::Obstacle, 0)
        );
    }
    let last = loads.last().unwrap();
    assert!((last.force[2] + WEIGHT).abs() < 1e-3 * WEIGHT, "{last:?}");
    for torque in last.torque {
        // A hundredth of the weight at the edge of the box.
        assert!(torque.abs() < 0.01 * WEIGHT * 0.075, "{last:?}");
    }
    // Held at two corners and hanging clear of the box.
    let held =
        "support=[{ at = { nearest = [[0, 0, 0]] } }, { at = { nearest = [[0.15, 0.15, 0]] } }]";
    simulated(dir, "held", &[held, "obstacle=[]", "stop.time=6"]);
    let loads = read_loads(&dir.join("held/loads.csv")).unwrap();
    let [first, second] = [0, 1].map(|k| loads[loads.len() - 2 + k]);
    assert_eq!((first.on, first.number), (LoadKind::Support, 0));
    // A single vertex has no torque about itself.
    assert_eq!(second.number, 1);
    let largest = second.torque.map(f64::abs).into_iter().fold(0.0, f64::max);
    assert!(largest < 1e-15, "{second:?}");
    let up = first.force[2] + second.force[2];
    assert!((up - WEIGHT).abs() < 0.02 * WEIGHT, "{first:?}, {second:?}");
    simulated(dir, "free", &["obstacle=[]", "stop.time=0.1"]);
    assert!(!dir.join("free/loads.csv").exists());
}
