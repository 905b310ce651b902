//! Runs that are stopped and continued.

use crate::{assert_same, code, killed, run, started, stderr, with_scene};
use isosheet_formats::{Trajectory, read_history};
use isosheet_runs::{Outcome, Recording, StepPart, Tick, Watch, simulate};
use isosheet_scenes::{SceneFile, StartingPoint};
use std::ops::ControlFlow;
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
    assert_eq!(recording.poses(0.0)[0].translation.z, -0.11);
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
    // The interval of ten seconds would have lost all of these. (The run may be stopped in the step after the
    // last row that was waited for.)
    let partial = Recording::read(&dir.join("stopped")).unwrap();
    assert!(rows >= 100, "{rows}");
    // One row and one frame are from the start; a frame is taken after every 17th step.
    assert_eq!(partial.trajectory.len(), 1 + (rows - 1) / 17);
    let written = Trajectory::read(&dir.join("stopped/trajectory.npz")).unwrap();
    assert_eq!(written, partial.trajectory);
    let done = run(dir, &["resume", "stopped", "--threads", "2"]);
    assert_eq!(code(&done), Some(0), "{}", stderr(&done));
    assert_same(&dir.join("whole"), &dir.join("stopped"));
}

/// Gives a run up within a step, as soon as a condition holds.
struct GiveUp<F> {
    when: F,
    /// How far the step had come then.
    at: Option<StepPart>,
}

impl<F: FnMut(&StepPart) -> bool> Watch for GiveUp<F> {
    fn within_step(&mut self, part: &StepPart) -> ControlFlow<()> {
        if !(self.when)(part) {
            return ControlFlow::Continue(());
        }
        self.at = Some(*part);
        ControlFlow::Break(())
    }

    fn step(&mut self, _: &Tick) -> ControlFlow<()> {
        ControlFlow::Continue(())
    }
}

/// Steps of 0.3 s of a strip of rods are divided into sub-steps; the run is given up before, between and
/// after them.
#[test]
fn a_run_that_is_stopped_within_steps_continues_to_the_same_bits() {
    let dir = with_scene(StartingPoint::Feed);
    let dir = dir.path();
    let edits = [
        "stop.time=0.6",
        "method.step=0.3",
        "sheet.isometry=\"rods\"",
        "sheet.bending={ hinges = { rigidity = 5e-4 } }",
        "method.rod_stiffness=1e5",
    ];
    let edits = edits.map(String::from);
    let scene = SceneFile::read(&dir.join("scene.toml"), &edits).unwrap();
    let go_on = |_: &Tick| ControlFlow::Continue(());
    let whole = simulate(&scene, &dir.join("whole"), &mut { go_on }).unwrap();
    assert!(matches!(whole, Outcome::Complete(_)));
    let stopped = |when: fn(&StepPart) -> bool| {
        let mut watch = GiveUp { when, at: None };
        let outcome = simulate(&scene, &dir.join("stopped"), &mut watch).unwrap();
        assert_eq!(outcome, Outcome::Interrupted);
        watch.at.unwrap()
    };
    let at = stopped(|_| true);
    assert_eq!((at.step, at.of, at.substeps), (1, 2, 0));
    assert_eq!((at.part, at.factorisations), (0.0, 0));
    let at = stopped(|part| part.factorisations >= 200);
    assert_eq!(at.factorisations, 200);
    let at = stopped(|part| part.substeps > 0);
    assert!(at.part > 0.0 && at.part < 1.0, "{at:?}");
    let done = simulate(&scene, &dir.join("stopped"), &mut { go_on }).unwrap();
    assert!(matches!(done, Outcome::Complete(_)));
    assert_same(&dir.join("whole"), &dir.join("stopped"));
}

/// A single step of minutes says how far it has come, and Ctrl-C ends it before it is complete.
#[cfg(unix)]
#[test]
fn ctrl_c_is_heard_within_a_step() {
    use std::io::{BufRead, BufReader};
    use std::process::Stdio;
    let dir = tempfile::tempdir().unwrap();
    let dir = dir.path();
    let scene = "version = 1
        [sheet]
        mesh = { square = { side = 1.0, level = 4 } }
        damping = 0.1
        [[support]]
        at = { vertices = [0] }
        [forces]
        gravity = [0, 0, -9.81]
        [method]
        step = 60
        [stop]
        time = 60";
    std::fs::write(dir.join("long.toml"), scene).unwrap();
    for command in [&["simulate", "long.toml"][..], &["resume", "long-run"]] {
        let mut child = crate::isosheet(dir)
            .args(command)
            .arg("--json")
            .stdout(Stdio::piped())
            .stderr(Stdio::null())
            .spawn()
            .unwrap();
        let lines = BufReader::new(child.stdout.take().unwrap()).lines();
        let mut events =
            lines.map(|l| serde_json::from_str::<serde_json::Value>(&l.unwrap()).unwrap());
        let within = events
            .find(|e| e["event"] == "within step")
            .expect("an event within the step");
        assert!(within["factorisations"].as_u64().unwrap() > 0, "{within}");
        assert!(within["part"].as_f64().unwrap() < 1.0, "{within}");
        let interrupt = Command::new("kill")
            .args(["-INT", &child.id().to_string()])
            .status();
        assert!(interrupt.unwrap().success());
        assert_eq!(child.wait().unwrap().code(), Some(130));
        // The head of the table, and the state at the start.
        let history = std::fs::read_to_string(dir.join("long-run/history.csv")).unwrap();
        assert_eq!(history.lines().count(), 2, "{history}");
    }
}

/// The folder of one run is the obstacle of another, which keeps a copy of the motion and continues without
/// that folder.
#[test]
fn the_folder_of_a_run_is_the_obstacle_of_another() {
    let dir = tempfile::tempdir().unwrap();
    let dir = dir.path();
    let cloth = |side: f64, z: f64, time: f64, more: &str| {
        format!(
            "version = 1\n[sheet]\nmaterial = \"cotton\"\ndamping = 4\n\
             mesh = {{ rectangle = {{ width = {side}, height = {side}, columns = 4, rows = 4 }} }}\n\
             placement = {{ position = [{0}, {0}, {z}] }}\n[forces]\ngravity = [0, 0, -9.81]\n\
             [stop]\ntime = {time}\n{more}",
            -0.5 * side
        )
    };
    let held = "[[support]]\nat = { vertices = [0, 4, 20, 24] }\n";
    let lies = "[[obstacle]]\nshape = { sequence = { path = \"hammock-run\" } }\nfriction = 0.5\n";
    std::fs::write(dir.join("hammock.toml"), cloth(0.2, 0.0, 0.2, held)).unwrap();
    std::fs::write(dir.join("on.toml"), cloth(0.1, 0.01, 0.2, lies)).unwrap();
    let runs = |arguments: &[&str]| {
        let done = run(dir, arguments);
        assert_eq!(code(&done), Some(0), "{}", stderr(&done));
    };
    runs(&["simulate", "hammock.toml", "-o", "hammock-run"]);
    runs(&["simulate", "on.toml", "-o", "whole"]);
    runs(&[
        "simulate",
        "on.toml",
        "-o",
        "part",
        "--set",
        "stop.time=0.1",
    ]);
    std::fs::rename(dir.join("hammock-run"), dir.join("away")).unwrap();
    runs(&["resume", "part", "--until", "0.2"]);
    let last = |folder: &str| Trajectory::read(&dir.join(folder).join("trajectory.npz")).unwrap();
    let (whole, part) = (last("whole"), last("part"));
    assert_eq!(
        whole.frame(whole.len() - 1).unwrap(),
        part.frame(part.len() - 1).unwrap()
    );
    let done = run(dir, &["resume", "part", "--until", "0.3"]);
    assert_ne!(code(&done), Some(0));
    let said = stderr(&done);
    assert!(
        said.contains("the mesh in motion goes from 0 s to 0.2 s"),
        "{said}"
    );
}
