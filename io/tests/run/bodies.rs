//! Rigid bodies that respond in what a run leaves.

use crate::{assert_same, code, killed, run, stderr, stdout};
use isosheet_formats::{LoadKind, read_mesh};
use isosheet_runs::Recording;
use std::fs;
use std::path::Path;

/// A ball falls into a cloth beside an arm on a hinge.
const SCENE: &str = "version = 1
[sheet]
name = \"cloth\"
mesh = { square = { side = 0.2, level = 2 } }
material = { youngs = 3e9, thickness = 1e-4, density = 800, poisson = 0.3 }
damping = 8
[[support]]
at = { half_space = { point = [1e-6, 0, 0], normal = [-1, 0, 0] } }
[[support]]
at = { half_space = { point = [0.199999, 0, 0], normal = [1, 0, 0] } }
[[body]]
name = \"ball\"
shape = { sphere = { radius = 0.025 } }
sides = 16
mass = 0.03
pose = { position = [0.1, 0.1, 0.04] }
[[body]]
name = \"arm\"
shape = { box = { size = [0.1, 0.02, 0.02] } }
mass = 0.03
pose = { position = [0.1, 0.25, 0.05] }
guide = { hinge = { point = [0.05, 0.25, 0.05], axis = [0, 1, 0], stiffness = 0.05, damping = 1e-3 } }
[forces]
gravity = [0, 0, -9.81]
[contact]
friction = 0.3
[[measure]]
name = \"ball\"
sheet = \"ball\"
at = \"all\"
quantity = \"z\"
[stop]
time = 0.5
[output]
obj = true
";

fn with_bodies(edits: &[&str], out: &str, folder: &Path) {
    fs::write(folder.join("bodies.toml"), SCENE).unwrap();
    let mut arguments = vec!["simulate", "bodies.toml", "--out", out];
    arguments.extend(edits.iter().flat_map(|edit| ["--set", edit]));
    let done = run(folder, &arguments);
    assert_eq!(code(&done), Some(0), "{}", stderr(&done));
}

/// Without bodies the sheet is alone, in files and in pictures.
#[test]
fn bodies_that_respond_are_left_out_too() {
    let folder = tempfile::tempdir().unwrap();
    let dir = folder.path();
    with_bodies(&["stop.time=0.05"], "out", dir);
    for (options, vertices) in [(&["--no-bodies"][..], 81), (&[], 81 + 16 * 7 + 2 + 8)] {
        for file in ["x.obj", "x.png"] {
            let arguments = [&["convert", "out", file, "--frame", "1"], options].concat();
            let done = run(dir, &arguments);
            assert_eq!(code(&done), Some(0), "{}", stderr(&done));
        }
        let mesh = read_mesh(&dir.join("x.obj")).unwrap();
        assert_eq!(mesh.positions.len(), 3 * vertices);
    }
}

/// Frames have the surfaces of the bodies, which move as rigid bodies, and tables what acts on them.
#[test]
fn frames_and_tables_have_bodies() {
    for edits in [
        &[][..],
        // Rods, and angles that yield, are of the sheets alone.
        &[
            "sheet.isometry=\"rods\"",
            "sheet.bending={hinges={rigidity=2e-4}}",
            "sheet.yield={moment=1e-3}",
        ],
    ] {
        let dir = tempfile::tempdir().unwrap();
        let dir = dir.path();
        with_bodies(edits, "run", dir);
        let recording = Recording::read(&dir.join("run")).unwrap();
        let parts: Vec<(&str, usize)> = recording
            .parts
            .iter()
            .map(|(name, part)| (&name[..], part.vertices.len()))
            .collect();
        assert_eq!(parts[0], ("cloth", 81));
        assert_eq!(parts[2], ("arm", 8));
        let trajectory = &recording.trajectory;
        let (first, last) = (
            trajectory.frame(0).unwrap(),
            trajectory.frame(trajectory.len() - 1).unwrap(),
        );
        assert_eq!(
            trajectory.faces().len(),
            recording.sheet.topology().face_count()
        );
        let distance = |x: &[f64], [a, b]: [u32; 2]| {
            let [p, q] = [a, b].map(|v| &x[3 * v as usize..3 * v as usize + 3]);
            (0..3).map(|k| (p[k] - q[k]).powi(2)).sum::<f64>().sqrt()
        };
        let mut fell = false;
        for (name, part) in &recording.parts[1..] {
            for edge in &trajectory.edges()[part.edges.clone()] {
                let [before, after] = [first, last].map(|x| distance(x, *edge));
                assert!((after / before - 1.0).abs() < 1e-9, "{name}");
            }
            let z = |x: &[f64]| x[3 * part.vertices.start + 2];
            fell |= z(last) < z(first) - 0.01;
        }
        assert!(fell);
        // The force of contact on the surface of the ball is its load.
        let forces = trajectory.contact_forces(trajectory.len() - 1).unwrap();
        let ball = &recording.parts[1].1;
        let load = recording.loads.iter().rev();
        let load = load
            .clone()
            .find(|row| row.on == LoadKind::Body && row.number == 0)
            .unwrap();
        for k in 0..3 {
            let own = forces[ball.coordinates()].as_chunks::<3>().0.iter();
            let sum: f64 = own.map(|f| f[k]).sum();
            assert!(
                (sum - load.force[k]).abs() < 1e-9 * (1.0 + sum.abs()),
                "{sum} {load:?}"
            );
        }
        let guide = recording
            .loads
            .iter()
            .filter(|row| row.on == LoadKind::Guide);
        assert!(guide.clone().count() > 0 && guide.clone().all(|row| row.number == 1));
        let summary = recording.summary.as_ref().unwrap();
        assert_eq!(summary.ending.bodies.len(), 2);
        assert_eq!(summary.ending.bodies[0], load.force);
        let z = summary.measures["ball"];
        assert!(z.largest == recording.measures[0].value && z.last < z.largest - 0.01);
        if let Some(forces) = trajectory.rod_forces(1) {
            assert!(forces[ball.edges.clone()].iter().all(|f| *f == 0.0));
        }
        // Programs get them as parts of the mesh; pages show them.
        let obj = dir.join("run/obj/frame_00002.obj");
        assert_eq!(read_mesh(&obj).unwrap().faces, trajectory.faces());
        for name in ["a.glb", "a.usda", "a.pvd", "a.obj"] {
            let done = run(dir, &["convert", "run", name]);
            assert_eq!(code(&done), Some(0), "{name}: {}", stderr(&done));
        }
        let text = fs::read_to_string(dir.join("a.usda")).unwrap();
        assert!(
            ["cloth", "ball", "arm"]
                .iter()
                .all(|name| text.contains(&format!("\"{name}\"")))
        );
        let page = fs::read_to_string(dir.join("run/index.html")).unwrap();
        assert!(page.contains("force of contact on ball at the end"));
        let info = stdout(&run(dir, &["info", "bodies.toml"]));
        assert!(
            info.contains("body             ball: vertices 81"),
            "{info}"
        );
    }
}

#[test]
fn a_run_with_bodies_that_was_killed_goes_on_to_the_same_bits() {
    let dir = tempfile::tempdir().unwrap();
    let dir = dir.path();
    let edits = [
        "method.step=0.005",
        "output.checkpoint_interval=0.01",
        "output.obj=false",
    ];
    with_bodies(&edits, "whole", dir);
    let mut arguments = vec!["simulate", "bodies.toml", "--out", "cut"];
    arguments.extend(edits.iter().flat_map(|edit| ["--set", edit]));
    for rows in [3, 17, 40] {
        killed(dir, &arguments, "cut", rows);
    }
    let done = run(dir, &arguments);
    assert_eq!(code(&done), Some(0), "{}", stderr(&done));
    assert_same(&dir.join("whole"), &dir.join("cut"));
    // A scene whose bodies have changed is another one.
    arguments.extend(["--set", "body[0].mass=0.04"]);
    let refused = run(dir, &arguments);
    assert_eq!(code(&refused), Some(4), "{}", stderr(&refused));
}
