//! Measures of a scene in what a run leaves.

use crate::{assert_same, code, killed, run, stderr, summary, with_scene};
use isosheet_formats::read_measures;
use isosheet_runs::{EnergySummary, Measured, Recording};
use isosheet_scenes::StartingPoint;
use std::fs;

/// A triangle that falls freely: its motion by RATTLE is exact.
const SCENE: &str = "version = 1
[sheet]
mesh = { triangles = { vertices = [[0, 0, 0], [0.3, 0, 0], [0, 0.4, 0]], faces = [[0, 1, 2]] } }
mass = 0.1
[forces]
gravity = [0, 0, -10]
[method]
integrator = 'rattle'
step = 0.01
[stop]
time = 0.4
[[measure]]
name = 'height'
at = 'all'
quantity = 'z'
[[measure]]
name = 'x'
at = { vertices = [0, 1] }
quantity = 'x'
[[measure]]
name = 'fallen'
at = { vertices = [2] }
quantity = 'displacement'
[[measure]]
name = 'side'
at = { vertices = [1] }
quantity = { distance_to = { vertices = [2] } }
[[measure]]
name = 'away'
at = { vertices = [1] }
quantity = { distance_to_point = [0.3, 0.4, 0] }
";

#[test]
fn measures_of_a_fall_are_those_of_the_closed_form() {
    let dir = tempfile::tempdir().unwrap();
    let dir = dir.path();
    fs::write(dir.join("fall.toml"), SCENE).unwrap();
    let done = run(dir, &["simulate", "fall.toml", "--out", "run"]);
    assert_eq!(code(&done), Some(0), "{}", stderr(&done));
    let rows = read_measures(&dir.join("run/measures.csv")).unwrap();
    assert_eq!(rows.len(), 41 * 5);
    for row in &rows {
        let depth = 5.0 * row.t * row.t;
        let exact = match row.name.as_str() {
            "height" => -depth,
            "x" => 0.15,
            "fallen" => depth,
            "side" => 0.5,
            "away" => depth.hypot(0.4),
            name => panic!("{name}"),
        };
        assert!((row.value - exact).abs() < 1e-12, "{row:?}: {exact}");
    }
    // The page plots each of them.
    let recording = Recording::read(&dir.join("run")).unwrap();
    assert_eq!(recording.measures, rows);
    let series = recording.replay().unwrap().series;
    let height = series.iter().find(|s| s.name == "height").unwrap();
    let of_height = rows.iter().filter(|row| row.name == "height");
    let expected: Vec<(f64, f64)> = of_height.map(|row| (row.t, row.value)).collect();
    let shown = height
        .times
        .iter()
        .copied()
        .zip(height.values.iter().copied());
    assert_eq!(shown.collect::<Vec<_>>(), expected);
    assert_eq!((height.unit.as_str(), expected.len()), ("m", 41));
    let measured = summary(&dir.join("run")).measures;
    assert_eq!(measured.len(), 5);
    let Measured {
        last,
        least,
        largest,
    } = measured["height"];
    assert!((last + 0.8).abs() < 1e-12 && (least, largest) == (last, 0.0));
    // The table of several runs has them, and a scene that names none has no table.
    let done = run(dir, &["collect", "run", "--out", "runs.csv"]);
    assert_eq!(code(&done), Some(0), "{}", stderr(&done));
    let table = fs::read_to_string(dir.join("runs.csv")).unwrap();
    let head = table.lines().next().unwrap();
    assert!(head.contains(",measures.height.last,measures.height.least,"));
    let set = ["--set", "measure=[]"];
    let done = run(
        dir,
        &["simulate", "fall.toml", "--out", "none", set[0], set[1]],
    );
    assert_eq!(code(&done), Some(0), "{}", stderr(&done));
    assert!(!dir.join("none/measures.csv").exists());
    assert!(summary(&dir.join("none")).measures.is_empty());
}

/// The extremes of a fall by 0.8 m agree with the closed form. Implicit Euler falls by `g t h / 2` farther,
/// whose potential energy is lost.
#[test]
fn the_extremes_of_a_fall_are_those_of_the_closed_form() {
    let dir = tempfile::tempdir().unwrap();
    let dir = dir.path();
    fs::write(dir.join("fall.toml"), SCENE).unwrap();
    for (integrator, loss) in [("rattle", 0.0), ("implicit_euler", 0.02)] {
        let set = format!("method.integrator={integrator}");
        let done = run(
            dir,
            &["simulate", "fall.toml", "--out", integrator, "--set", &set],
        );
        assert_eq!(code(&done), Some(0), "{}", stderr(&done));
        let found = summary(&dir.join(integrator));
        let energy = found.energy;
        for (value, exact) in [
            (found.largest_displacement, 0.8 + loss),
            (energy.largest_kinetic, 0.8),
            (energy.least_potential, -0.8 - loss),
            (energy.largest_error, loss),
            (energy.largest_gain, 0.0),
            (energy.relative_error.unwrap(), loss / 0.8),
            (energy.relative_gain.unwrap(), 0.0),
        ] {
            assert!(
                (value - exact).abs() < 1e-12,
                "{integrator}: {value}, {exact}"
            );
        }
    }
    let set = "forces={}";
    let done = run(
        dir,
        &["simulate", "fall.toml", "--out", "still", "--set", set],
    );
    assert_eq!(code(&done), Some(0), "{}", stderr(&done));
    let still = summary(&dir.join("still"));
    assert_eq!(still.largest_displacement, 0.0);
    let round_off = still.energy.round_off;
    let nothing = EnergySummary {
        round_off,
        ..EnergySummary::default()
    };
    assert_eq!(still.energy, nothing);
    let done = run(dir, &["collect", "rattle", "still", "--out", "runs.csv"]);
    assert_eq!(code(&done), Some(0), "{}", stderr(&done));
    let table = fs::read_to_string(dir.join("runs.csv")).unwrap();
    assert!(
        table
            .lines()
            .next()
            .unwrap()
            .contains(",largest_displacement,energy.largest_kinetic,")
    );
}

/// The extremes before a kill count as well.
#[test]
fn a_run_that_was_killed_goes_on_with_its_measures() {
    let dir = with_scene(StartingPoint::Hanging);
    let dir = dir.path();
    let set = "measure=[{ name = 'corner', at = { vertices = [0] }, quantity = 'displacement' }]";
    let often = "output.checkpoint_interval=0";
    let arguments = |out| {
        let scene = ["simulate", "scene.toml", "--out", out];
        [&scene[..], &["--set", set, "--set", often]].concat()
    };
    let done = run(dir, &arguments("whole"));
    assert_eq!(code(&done), Some(0), "{}", stderr(&done));
    killed(dir, &arguments("cut"), "cut", 20);
    let done = run(dir, &arguments("cut"));
    assert_eq!(code(&done), Some(0), "{}", stderr(&done));
    assert_same(&dir.join("whole"), &dir.join("cut"));
    let corner = summary(&dir.join("cut")).measures["corner"];
    assert!(corner.least == 0.0 && corner.largest >= corner.last && corner.last > 0.0);
}

/// Names that files cannot have, names that stand twice, and vertices that are not there are refused at their
/// keys.
#[test]
fn wrong_measures_are_refused() {
    let dir = tempfile::tempdir().unwrap();
    let dir = dir.path();
    fs::write(dir.join("fall.toml"), SCENE).unwrap();
    for (set, said) in [
        ("measure[0].name=a b", "`a b` cannot be the name"),
        (
            "measure[1].name=height",
            "another measure has the name `height`",
        ),
        (
            "measure[3].quantity.distance_to.vertices=[3]",
            "no vertex 3",
        ),
    ] {
        let done = run(dir, &["check", "fall.toml", "--set", set]);
        let text = stderr(&done);
        assert!(code(&done) != Some(0) && text.contains(said), "{text}");
    }
}
