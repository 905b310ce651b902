//! `isosheet fit`.

use crate::{code, run, stderr, stdout};
use isosheet_runs::{Fit, FitError, FitRuns};
use isosheet_scenes::{Key, SceneFile};
use std::fs;
use std::num::NonZero;
use std::ops::ControlFlow;
use std::path::Path;
use std::sync::atomic::{AtomicBool, Ordering};

/// A strip that hangs out of a clamp under its weight.
const STRIP: &str = "version = 1
[sheet]
mesh = { rectangle = { width = 0.15, height = 0.015, columns = 60, rows = 2 } }
density = 0.08
bending = { plate = { rigidity = 3e-4, poisson = 0 } }
isometry = { elastic = { stiffness = 3e5, poisson = 0 } }
[[support]]
at = { box = { min = [-1, -1, -1], max = [1e-9, 1, 1] } }
hold = \"clamp\"
[forces]
gravity = [0, 0, -9.81]
[[measure]]
name = \"tip\"
at = { box = { min = [0.1499, -1, -1], max = [1, 1, 1] } }
quantity = \"z\"
[[measure]]
name = \"slope\"
at = { box = { min = [0.1, -1, -1], max = [1, 1, 1] } }
quantity = { angle_to = { box = { min = [-1, -1, -1], max = [0.01, 1, 1] } } }
[stop]
time = 1
";

const RIGIDITY: &str = "sheet.bending.plate.rigidity";

/// The numbers behind the keys in the lines of a result.
fn value(said: &str, key: &str) -> f64 {
    let line = said.lines().find_map(|line| line.strip_prefix(key));
    let (_, rest) = line
        .unwrap_or_else(|| panic!("{key}: {said}"))
        .split_once("= ")
        .unwrap();
    let number = rest.split([' ', ',']).next().unwrap();
    number.parse().unwrap()
}

fn fit(dir: &Path, arguments: &[&str]) -> String {
    let done = run(dir, &[&["fit", "strip.toml", "--rest"], arguments].concat());
    assert_eq!(code(&done), Some(0), "{}", stderr(&done));
    stdout(&done)
}

fn refused(dir: &Path, arguments: &[&str], exit: i32) -> String {
    let done = run(dir, &[&["fit", "strip.toml"], arguments].concat());
    let said = stderr(&done);
    assert_eq!(code(&done), Some(exit), "{said}");
    said
}

/// A sag that is small gives the rigidity `q L^4 / (8 w)`, up to the square of the slope and of the height of
/// a face; the scene that is written ends there.
#[test]
fn the_rigidity_follows_from_the_sag() {
    let dir = tempfile::tempdir().unwrap();
    let dir = dir.path();
    fs::write(dir.join("strip.toml"), STRIP).unwrap();
    let range = format!("{RIGIDITY}=1e-4..1");
    let said = fit(dir, &["--vary", &range, "--to", "tip=-0.002"]);
    assert!(
        said.lines().last().unwrap().starts_with("fitted: "),
        "{said}"
    );
    let exact = 0.08 * 9.81 * 0.15_f64.powi(4) / (8.0 * 0.002);
    let found = value(&said, RIGIDITY);
    assert!((found / exact - 1.0).abs() < 2e-3, "{found} {exact}");
    let written = SceneFile::read(&dir.join("strip-fit.toml"), &[]).unwrap();
    let text = &written.text().text;
    assert!(text.contains("rigidity = 0.02"), "{text}");
    // A file that is there is not replaced unless that is asked for.
    let said = refused(dir, &["--vary", &range, "--to", "tip=-0.002"], 2);
    assert!(said.contains("--force"), "{said}");
}

/// The shape of a run gives back the values of its scene, to the tolerance of the searches for equilibria.
#[test]
fn a_shape_gives_the_values_that_it_was_made_with() {
    let dir = tempfile::tempdir().unwrap();
    let dir = dir.path();
    fs::write(dir.join("strip.toml"), STRIP).unwrap();
    let made = run(dir, &["rest", "strip.toml", "--out", "made"]);
    assert_eq!(code(&made), Some(0), "{}", stderr(&made));
    let saved = run(dir, &["convert", "made", "made.obj", "--frame", "last"]);
    assert_eq!(code(&saved), Some(0), "{}", stderr(&saved));
    let other = format!("{RIGIDITY}=2e-3");
    let range = format!("{RIGIDITY}=1e-5..1e-2");
    let vary = ["--set", &other, "--vary", &range, "--to", "made.obj"];
    let said = fit(dir, &[&vary[..], &["-o", "one.toml", "-j", "1"]].concat());
    let found = value(&said, RIGIDITY);
    assert!((found / 3e-4 - 1.0).abs() < 1e-4, "{said}");
    // The number of runs at a time does not matter.
    let two = fit(dir, &[&vary[..], &["-o", "two.toml", "-j", "2"]].concat());
    let [one, two] = [&said, &two].map(|said| said.replace("two.toml", "one.toml"));
    assert_eq!(one, two);
}

/// What cannot be reached is told, with the value at the end of its range.
#[test]
fn what_is_not_met_is_told_in_the_last_line() {
    let dir = tempfile::tempdir().unwrap();
    let dir = dir.path();
    fs::write(dir.join("strip.toml"), STRIP).unwrap();
    let range = format!("{RIGIDITY}=1e-4..1e-2");
    let far = [
        "fit",
        "strip.toml",
        "--rest",
        "--vary",
        &range,
        "--to",
        "tip=-0.2",
    ];
    let done = run(dir, &far);
    assert_eq!(code(&done), Some(1));
    let said = stdout(&done);
    assert_eq!(value(&said, RIGIDITY), 1e-4);
    assert!(said.contains("an end of its range"), "{said}");
    let said = stderr(&done);
    assert!(
        said.contains("error: not met, and as near as it gets: `tip=-0.2`"),
        "{said}"
    );
    // The search leaves an end of the range at which it begins, and says where that is not the scene's value.
    for start in ["1e-2", "1"] {
        let start = format!("{RIGIDITY}={start}");
        let leaving = [
            "--vary",
            &range,
            "--to",
            "tip=-0.06",
            "--set",
            &start,
            "--force",
        ];
        let said = fit(dir, &leaving);
        let found = value(&said, RIGIDITY);
        assert!(found > 1e-4 && found < 1e-2, "{said}");
    }
    // Two keys for one number.
    let many = [
        "--vary",
        &range,
        "--vary",
        "sheet.density=0.04..0.2",
        "--to",
        "tip=-0.05",
        "--force",
    ];
    let said = fit(dir, &many);
    assert_eq!(said.matches("not determined").count(), 2, "{said}");
    assert!(!said.contains("+-"), "{said}");
    // Two numbers of different units, with their standard deviations.
    let both = [
        "--vary",
        &range,
        "--to",
        "tip=-0.05+-0.001",
        "--to",
        "slope=25+-2",
        "--force",
    ];
    let said = fit(dir, &both);
    assert!(said.contains(" +- "), "{said}");
}

#[test]
fn wrong_fits_are_refused() {
    let dir = tempfile::tempdir().unwrap();
    let dir = dir.path();
    fs::write(dir.join("strip.toml"), STRIP).unwrap();
    let tip = ["--to", "tip=-0.05"];
    for (arguments, exit, says) in [
        (
            ["--vary", "sheet.density=0.1"],
            2,
            "not of the form key=from..to",
        ),
        (["--vary", "sheet.density=2..1"], 2, "the smaller end first"),
        (["--vary", "sheet.densty=1..2"], 3, "did you mean `density`"),
        (
            ["--vary", "sheet.mesh.rectangle.columns=10..80"],
            3,
            "takes whole numbers",
        ),
        (
            ["--vary", "sheet.damping=0..1"],
            1,
            "changes nothing of the targets",
        ),
    ] {
        let said = refused(dir, &[&arguments[..], &tip[..], &["--rest"]].concat(), exit);
        assert!(said.contains(says), "{says}: {said}");
    }
    let vary = ["--vary", "sheet.density=0.04..0.2"];
    let twice = [
        "--vary",
        "sheet.density=0.04..0.2",
        "--vary",
        "sheet.density=0.1..1",
    ];
    let said = refused(dir, &[&twice[..], &tip[..]].concat(), 2);
    assert!(said.contains("change one value"), "{said}");
    for (to, exit, says) in [
        (
            &["tp=1"][..],
            3,
            "the scene has no measure `tp`, but `tip`, `slope`",
        ),
        (&["tip=deep"], 2, "\"deep\" is no number"),
        (&["tip=-0.05", "slope=20"], 2, "the units m and degrees"),
        (&["tip=-0.05+-0"], 2, "give a positive number"),
        (&["no.obj"], 3, "no.obj"),
    ] {
        let to = to.iter().flat_map(|to| ["--to", to]);
        let said = refused(dir, &vary.into_iter().chain(to).collect::<Vec<_>>(), exit);
        assert!(said.contains(says), "{says}: {said}");
    }
    assert!(!dir.join("strip-fit.toml").exists());
}

/// A search that is ended hands out its best scene; at its start there is none.
#[test]
fn a_search_that_is_ended_has_its_best_scene() {
    let dir = tempfile::tempdir().unwrap();
    let path = dir.path().join("strip.toml");
    fs::write(&path, STRIP).unwrap();
    let ranges = vec![format!("{RIGIDITY}=1e-5..1e-2").parse().unwrap()];
    let targets = vec!["tip=-0.042".parse().unwrap()];
    let fit = Fit::new(&path, Vec::new(), ranges, targets, FitRuns::Rest).unwrap();
    let ends = AtomicBool::new(false);
    let watch = || match ends.load(Ordering::Relaxed) {
        true => ControlFlow::Break(()),
        false => ControlFlow::Continue(()),
    };
    let mut seen = Vec::new();
    let ended = fit.run(dir.path(), NonZero::<usize>::MIN, &watch, &mut |step| {
        seen.push(step.clone());
        ends.store(seen.len() >= 3, Ordering::Relaxed);
    });
    assert!(matches!(ended, Err(FitError::Interrupted)));
    let [start, _, last] = &seen[..] else {
        panic!("{} steps", seen.len());
    };
    assert!(start.scene.is_none() && last.rms < start.rms);
    let scene = last.scene.as_ref().expect("a scene");
    let key: Key = RIGIDITY.parse().unwrap();
    assert_eq!(scene.number(&key), Some(last.values[0].1));
}
