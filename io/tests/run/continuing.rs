//! Runs that are stopped and continued.

use crate::{assert_same, code, killed, run, started, stderr, with_scene};
use isosheet_io::run::Recording;
use isosheet_io::scene::StartingPoint;
use isosheet_io::{Trajectory, read_history};
#[cfg(unix)]
use std::process::Command;

#[test]
fn a_run_that_is_killed_at_any_moment_continues_to_the_same_bits() {
    let dir = with_scene(StartingPoint::Drape);
    let dir = dir.path();
    let edits = ["--set", "stop.time=0.6", "--set", "method.step=0.004"];
    let arguments = |out: &'static str, interval: &'static str| {
        let mut all = vec!["simulate", "scene.toml", "--out", out];
        all.extend(edits);
        all.extend(["--set", interval]);
        all
    };
    for (interval, whole, cut) in [
        ("output.checkpoint_interval=0", "whole-0", "killed-0"),
        ("output.checkpoint_interval=0.05", "whole-1", "killed-1"),
    ] {
        let done = run(dir, &arguments(whole, interval));
        assert_eq!(code(&done), Some(0), "{}", stderr(&done));
        // Rows of the history at which the process is killed: before the first step, and wherever it comes to
        // be then. Kills that lose steps go back behind the row before.
        for rows in [1, 5, 23, 48, 49, 75, 100] {
            killed(dir, &arguments(cut, interval), cut, rows);
            assert!(
                !dir.join(cut).join("summary.json").exists(),
                "killed too late"
            );
        }
        let done = run(dir, &arguments(cut, interval));
        assert_eq!(code(&done), Some(0), "{}", stderr(&done));
        assert_same(&dir.join(whole), &dir.join(cut));
    }
    let history = read_history(&dir.join("whole-0/history.csv")).unwrap();
    assert_eq!(history.len(), 151);
    let recording = Recording::read(&dir.join("whole-0")).unwrap();
    // A frame every eighth step of 0.004 s, that of the start, and the last.
    assert_eq!(recording.trajectory.len(), 1 + 150 / 8 + 1);
    assert_eq!(recording.poses(0.0)[0].translation.z, -0.16);
}

/// Moving pins, moving bodies and friction continue as well.
#[test]
fn scenes_with_motions_continue_to_the_same_bits() {
    for (kind, time) in [
        (StartingPoint::Feed, "0.12"),
        (StartingPoint::Stamp, "0.08"),
    ] {
        let dir = with_scene(kind);
        let dir = dir.path();
        let time = format!("stop.time={time}");
        let scene = ["simulate", "scene.toml", "--set", &time];
        let scene = [&scene[..], &["--set", "output.checkpoint_interval=0.1"]].concat();
        let with_out = |out| [&scene[..], &["--out", out]].concat();
        let done = run(dir, &with_out("whole"));
        assert_eq!(code(&done), Some(0), "{}", stderr(&done));
        for rows in [3, 8, 14] {
            killed(dir, &with_out("killed"), "killed", rows);
            assert!(!dir.join("killed/summary.json").exists(), "killed too late");
        }
        let done = run(dir, &with_out("killed"));
        assert_eq!(code(&done), Some(0), "{}", stderr(&done));
        assert_same(&dir.join("whole"), &dir.join("killed"));
    }
}

#[cfg(unix)]
#[test]
fn ctrl_c_writes_a_checkpoint_and_the_same_command_continues() {
    let dir = with_scene(StartingPoint::Fold);
    let dir = dir.path();
    let scene = [
        "simulate",
        "scene.toml",
        "--set",
        "stop.time=8",
        "--set",
        "method.step=0.002",
    ];
    let with_out = |out| [&scene[..], &["--out", out]].concat();
    let done = run(dir, &with_out("whole"));
    assert_eq!(code(&done), Some(0), "{}", stderr(&done));
    let mut child = started(dir, &with_out("stopped"), "stopped", 100);
    let interrupt = Command::new("kill")
        .args(["-INT", &child.id().to_string()])
        .status();
    assert!(interrupt.unwrap().success());
    assert_eq!(child.wait().unwrap().code(), Some(130));
    assert!(!dir.join("stopped/summary.json").exists());
    let rows = read_history(&dir.join("stopped/history.csv"))
        .unwrap()
        .len();
    // The interval of ten seconds would have lost all of these.
    let partial = Recording::read(&dir.join("stopped")).unwrap();
    assert!(rows > 100);
    // One row and one frame are those of the start; a frame is taken after every 17th step.
    assert_eq!(partial.trajectory.len(), 1 + (rows - 1) / 17);
    let written = Trajectory::read(&dir.join("stopped/trajectory.npz")).unwrap();
    assert_eq!(written, partial.trajectory);
    let done = run(dir, &["resume", "stopped", "--threads", "2"]);
    assert_eq!(code(&done), Some(0), "{}", stderr(&done));
    assert_same(&dir.join("whole"), &dir.join("stopped"));
}
