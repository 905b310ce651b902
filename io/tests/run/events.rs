//! Supports, seams and contacts that are taken up and released in the course of a run.

use crate::{assert_same, code, killed, run, stderr, summary};
use isosheet_formats::{
    EventChange, EventKind, EventRow, LoadKind, read_events, read_history, read_loads,
};
use std::fs;
use std::path::Path;

pub(crate) fn with_text(text: &str) -> tempfile::TempDir {
    let folder = tempfile::tempdir().unwrap();
    fs::write(folder.path().join("scene.toml"), text).unwrap();
    folder
}

fn simulated(folder: &Path, arguments: &[&str]) {
    let done = run(folder, &[&["simulate", "scene.toml"], arguments].concat());
    assert_eq!(code(&done), Some(0), "{}", stderr(&done));
}

/// A square that hangs by two corners, of which one lets go at 0.2 s, and is caught again at 0.3 s.
pub(crate) const LETS_GO: &str = r#"
    version = 1
    [sheet]
    mesh = { square = { side = 0.2, level = 2 } }
    damping = 0.5
    [[support]]
    at = { vertices = [0] }
    [[support]]
    at = { vertices = [8] }
    until = 0.2
    [[support]]
    at = { vertices = [80] }
    from = 0.3
    [forces]
    gravity = [0, 0, -9.81]
    [method]
    step = 0.01
    [stop]
    time = 0.5
    [output]
    checkpoint_interval = 0.0
    "#;

#[test]
fn supports_are_released_and_taken_up_in_time() {
    let dir = with_text(LETS_GO);
    let dir = dir.path();
    simulated(dir, &["--out", "whole"]);
    let events = read_events(&dir.join("whole/events.csv")).unwrap();
    let loads = read_loads(&dir.join("whole/loads.csv")).unwrap();
    let force = |number: usize, step: usize| {
        let of =
            |row: &&isosheet_formats::LoadRow| row.on == LoadKind::Support && row.number == number;
        let [x, y, z] = loads.iter().filter(of).nth(step - 1).unwrap().force;
        (x * x + y * y + z * z).sqrt()
    };
    let [released, taken_up] = events[..] else {
        panic!("{events:?}");
    };
    // Of the step at whose end it is released a support has its force, and none afterwards.
    assert_eq!(released.force, Some(force(1, 20)));
    assert!(force(1, 20) > 1e-3);
    assert!((21..=50).all(|step| force(1, step) == 0.0));
    assert!((1..=30).all(|step| force(2, step) == 0.0) && force(2, 31) > 0.0);
    let event = |t, number, change, force| EventRow {
        t,
        on: EventKind::Support,
        number,
        change,
        pairs: None,
        force,
    };
    assert!((released.t - 0.2).abs() < 1e-12 && (taken_up.t - 0.3).abs() < 1e-12);
    let expected = [
        event(released.t, 1, EventChange::Released, released.force),
        event(taken_up.t, 2, EventChange::TakenUp, None),
    ];
    assert_eq!(events, expected);
    // The energy balance goes on across both, where kinetic energy goes into the support that catches.
    let history = read_history(&dir.join("whole/history.csv")).unwrap();
    let scale = history.iter().map(|row| row.kinetic).fold(0.0, f64::max);
    let balance = |step: usize| {
        let row = &history[step];
        row.total + row.damped - row.work
    };
    let error = |step: usize| balance(step) - balance(step - 1);
    assert!(error(21).abs() < 0.05 * scale, "{}, {scale}", error(21));
    // The rods at a vertex that is caught lose their kinetic energy too, as in an impact.
    let kinetic = history[30].kinetic;
    assert!(
        (-kinetic..0.0).contains(&error(31)),
        "{}, {kinetic}",
        error(31)
    );
}

#[test]
fn a_run_that_is_killed_around_a_release_continues_to_the_same_bits() {
    let dir = with_text(LETS_GO);
    let dir = dir.path();
    simulated(dir, &["--out", "whole"]);
    let arguments = ["simulate", "scene.toml", "--out", "cut"];
    for rows in [20, 21, 22, 25, 31, 32, 40] {
        killed(dir, &arguments, "cut", rows);
        assert!(!dir.join("cut/summary.json").exists(), "killed too late");
    }
    simulated(dir, &["--out", "cut"]);
    assert_same(&dir.join("whole"), &dir.join("cut"));
    assert_eq!(summary(&dir.join("cut")).steps, 50);
}

/// A sheet that lies still until a support lets go comes to its end after that.
#[test]
fn a_run_does_not_end_at_rest_before_a_release() {
    let scene = "version = 1
        [sheet]
        mesh = { square = { side = 0.2, level = 1 } }
        [[support]]
        at = \"all\"
        until = 0.5
        [method]
        step = 0.05
        [stop]
        time = 1
        rest = { speed = 1e-3, duration = 0.2 }";
    let dir = with_text(scene);
    simulated(dir.path(), &[]);
    let events = fs::read_to_string(dir.path().join("scene-run/events.csv")).unwrap();
    assert_eq!(events.lines().count(), 2, "{events}");
}
