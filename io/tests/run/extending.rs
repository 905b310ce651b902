//! Runs that go on beyond their end.

use crate::events::{LETS_GO, with_text};
use crate::{assert_same, code, run, stderr, stdout, summary};
use isosheet_formats::read_events;
use isosheet_runs::{Outcome, Tick, extend_folder, simulate};
use isosheet_scenes::SceneFile;
use std::fs;
use std::ops::ControlFlow;

/// A run ends at the moment at which a support is released, and goes on in two parts.
#[test]
fn a_run_that_goes_on_beyond_its_end_has_the_bits_of_a_longer_one() {
    let dir = with_text(LETS_GO);
    let dir = dir.path();
    let succeeds = |arguments: &[&str]| {
        let done = run(dir, arguments);
        assert_eq!(code(&done), Some(0), "{}", stderr(&done));
    };
    succeeds(&["simulate", "scene.toml", "--out", "whole"]);
    succeeds(&[
        "simulate",
        "scene.toml",
        "--out",
        "part",
        "--set",
        "stop.time=0.2",
    ]);
    assert_eq!(summary(&dir.join("part")).steps, 20);
    assert!(
        read_events(&dir.join("part/events.csv"))
            .unwrap()
            .is_empty()
    );
    for (until, steps) in [("0.29", 29), ("0.5", 50)] {
        succeeds(&["resume", "part", "--until", until]);
        assert_eq!(summary(&dir.join("part")).steps, steps);
    }
    assert_same(&dir.join("whole"), &dir.join("part"));
    // The scene in the folder is that of the longer run, so that there is nothing left to do.
    let done = run(dir, &["resume", "part"]);
    assert!(
        stdout(&done).contains("already complete"),
        "{}",
        stdout(&done)
    );
}

/// A run that is stopped on its way to a later end goes on by the same call.
#[test]
fn a_longer_run_that_is_stopped_goes_on() {
    let dir = with_text(LETS_GO);
    let dir = dir.path();
    for (out, end) in [("whole", "stop.time=0.4"), ("part", "stop.time=0.2")] {
        let scene = SceneFile::read(&dir.join("scene.toml"), &[end.to_owned()]).unwrap();
        let run = simulate(&scene, &dir.join(out), &mut |_: &Tick| {
            ControlFlow::Continue(())
        });
        assert!(matches!(run.unwrap(), Outcome::Complete(_)));
    }
    let part = dir.join("part");
    let stopped = extend_folder(&part, 0.4, &mut |_: &Tick| ControlFlow::Break(()));
    assert_eq!(stopped.unwrap(), Outcome::Interrupted);
    let ended = extend_folder(&part, 0.4, &mut |_: &Tick| ControlFlow::Continue(()));
    assert!(matches!(ended.unwrap(), Outcome::Complete(_)));
    assert_same(&dir.join("whole"), &part);
}

/// Files of a complete run that may be deleted to save space are needed to go on.
#[test]
fn a_run_without_its_frames_does_not_go_on_and_stays_whole() {
    let dir = with_text(LETS_GO);
    let dir = dir.path();
    let arguments = [
        "simulate",
        "scene.toml",
        "--out",
        "run",
        "--set",
        "stop.time=0.1",
    ];
    assert_eq!(code(&run(dir, &arguments)), Some(0));
    for file in ["frames.bin", "checkpoint.bin"] {
        fs::remove_file(dir.join("run").join(file)).unwrap();
        let refused = run(dir, &["resume", "run", "--until", "0.2"]);
        let said = stderr(&refused);
        assert_eq!(code(&refused), Some(2), "{said}");
        assert!(said.contains(&format!("its {file} was deleted")), "{said}");
        let info = run(dir, &["info", "run"]);
        assert_eq!(code(&info), Some(0), "{}", stderr(&info));
    }
}

#[test]
fn a_run_does_not_go_on_where_that_makes_no_sense() {
    let dir = with_text(LETS_GO);
    let dir = dir.path();
    for (out, edits, until, cause) in [
        (
            "earlier",
            vec!["stop.time=0.1"],
            "0.1",
            "it goes until 0.1 s already",
        ),
        (
            "odd",
            vec!["stop.time=0.105"],
            "0.2",
            "shorter than `method.step`",
        ),
        (
            "rest",
            vec![
                "stop.time=0.1",
                "stop.rest={ speed = 100, duration = 0.02 }",
            ],
            "0.2",
            "the sheet was at rest",
        ),
        ("nan", vec!["stop.time=0.1"], "nan", "that is no time"),
        ("far", vec!["stop.time=0.1"], "1e300", "is 1e300 s"),
    ] {
        let mut arguments = vec!["simulate", "scene.toml", "--out", out];
        arguments.extend(edits.iter().flat_map(|edit| ["--set", edit]));
        assert_eq!(code(&run(dir, &arguments)), Some(0));
        let kept = |name: &str| fs::read(dir.join(out).join(name)).unwrap();
        let files = ["summary.json", "scene.toml", "checkpoint.bin", "frames.bin"];
        let before = files.map(kept);
        let refused = run(dir, &["resume", out, "--until", until]);
        assert_ne!(code(&refused), Some(0));
        assert!(stderr(&refused).contains(cause), "{}", stderr(&refused));
        assert!(before == files.map(kept), "{out}");
    }
}
