//! Folders that are in use, complete, foreign, damaged, full or not to be written.

use crate::{assert_same, code, killed, run, started, stderr, summary, with_scene};
use isosheet_runs::{EndReason, Recording};
use isosheet_scenes::StartingPoint;
use serde_json::Value;
use std::fs;
use std::path::Path;
use std::process::Command;

#[test]
fn a_folder_in_use_a_foreign_one_and_one_of_another_scene_are_refused() {
    let dir = with_scene(StartingPoint::Stamp);
    let dir = dir.path();
    let simulate = ["simulate", "scene.toml", "--out", "run"];
    let mut child = started(dir, &simulate, "run", 2);
    let second = run(dir, &simulate);
    assert_eq!(code(&second), Some(5), "{}", stderr(&second));
    assert!(
        stderr(&second).contains("another process"),
        "{}",
        stderr(&second)
    );
    child.kill().unwrap();
    child.wait().unwrap();
    let other = run(dir, &[&simulate[..], &["--set", "stop.time=0.1"]].concat());
    assert_eq!(code(&other), Some(4), "{}", stderr(&other));
    assert!(
        stderr(&other).contains("another scene"),
        "{}",
        stderr(&other)
    );
    fs::create_dir(dir.join("mine")).unwrap();
    fs::write(dir.join("mine/letter.txt"), "dear").unwrap();
    let foreign = run(dir, &["simulate", "scene.toml", "--out", "mine"]);
    assert_eq!(code(&foreign), Some(4), "{}", stderr(&foreign));
    assert_eq!(
        stderr(&foreign),
        "error: mine holds files and is not the folder of a run\n  \
         = help: choose an empty or a new folder for the run\n"
    );
    let foreign = run(dir, &["simulate", "scene.toml", "--out", "mine", "--json"]);
    let line: Value = serde_json::from_slice(&foreign.stdout).unwrap();
    let problem = &line["problems"][0];
    assert_eq!(
        problem["message"],
        "mine holds files and is not the folder of a run"
    );
    assert_eq!(
        problem["remedy"],
        "choose an empty or a new folder for the run"
    );
    assert_eq!(fs::read_dir(dir.join("mine")).unwrap().count(), 1);
}

#[test]
fn a_complete_folder_ends_at_once_and_is_not_touched() {
    let dir = with_scene(StartingPoint::Fold);
    let dir = dir.path();
    let done = run(dir, &["simulate", "scene.toml"]);
    assert_eq!(code(&done), Some(0), "{}", stderr(&done));
    let out = dir.join("scene-run");
    let times = || -> Vec<_> {
        let files = fs::read_dir(&out).unwrap().map(|e| e.unwrap().path());
        files
            .map(|f| fs::metadata(f).unwrap().modified().unwrap())
            .collect()
    };
    let before = times();
    // Comments and the form of the file are not the scene.
    let text = fs::read_to_string(dir.join("scene.toml")).unwrap();
    fs::write(dir.join("scene.toml"), format!("# another comment\n{text}")).unwrap();
    let again = run(dir, &["simulate", "scene.toml", "--json"]);
    assert_eq!(code(&again), Some(0), "{}", stderr(&again));
    let line: Value = serde_json::from_slice(&again.stdout).unwrap();
    assert_eq!(line["event"], "already complete");
    assert_eq!(line["summary"]["steps"], 90);
    let of_folder = run(dir, &["resume", "scene-run"]);
    assert_eq!(code(&of_folder), Some(0), "{}", stderr(&of_folder));
    assert_eq!(times(), before);
    // A scene that was changed in the folder is not the one of the results.
    let stored = out.join("scene.toml");
    let text = fs::read_to_string(&stored).unwrap();
    fs::write(&stored, text.replace("time = 1.5", "time = 1.6")).unwrap();
    assert_eq!(code(&run(dir, &["resume", "scene-run"])), Some(4));
    fs::write(&stored, text).unwrap();
    let summary = summary(&out);
    assert_eq!(summary.ending.reason, EndReason::Time);
    assert_eq!(
        summary.modelled,
        ["velocity damping", "2 creases", "rigid rods"]
    );
    assert!(summary.largest_strain < 2e-12);
}

/// `--force` replaces the run of a scene that was edited, and a complete one, and leaves alone what no run
/// wrote.
#[test]
fn force_replaces_a_run_and_nothing_else() {
    let dir = with_scene(StartingPoint::Fold);
    let dir = dir.path();
    let short = ["simulate", "scene.toml", "--set", "stop.time=0.2"];
    let done = run(dir, &[&short[..], &["--set", "output.obj=true"]].concat());
    assert_eq!(code(&done), Some(0), "{}", stderr(&done));
    let out = dir.join("scene-run");
    assert!(out.join("obj").is_dir());
    fs::write(out.join("notes.txt"), "mine").unwrap();
    let refused = run(dir, &short);
    assert_eq!(code(&refused), Some(4), "{}", stderr(&refused));
    assert!(stderr(&refused).contains("--force"), "{}", stderr(&refused));
    let replaced = run(dir, &[&short[..], &["--force"]].concat());
    assert_eq!(code(&replaced), Some(0), "{}", stderr(&replaced));
    let whole = run(dir, &[&short[..], &["--out", "whole"]].concat());
    assert_eq!(code(&whole), Some(0), "{}", stderr(&whole));
    assert_same(&dir.join("whole"), &out);
    assert!(!out.join("obj").exists(), "files of the run before");
    assert_eq!(fs::read_to_string(out.join("notes.txt")).unwrap(), "mine");
    // A complete run of the same scene is run again.
    let again = run(dir, &[&short[..], &["--force", "--json"]].concat());
    let lines = String::from_utf8(again.stdout).unwrap();
    assert!(lines.contains("\"event\":\"complete\""), "{lines}");
    fs::create_dir(dir.join("mine")).unwrap();
    fs::write(dir.join("mine/scene.toml"), "dear").unwrap();
    let foreign = run(dir, &[&short[..], &["--force", "--out", "mine"]].concat());
    assert_eq!(code(&foreign), Some(4), "{}", stderr(&foreign));
    assert_eq!(fs::read_dir(dir.join("mine")).unwrap().count(), 1);
}

/// A run that failed, and one in use: the first is replaced, the second is not.
#[test]
fn force_replaces_a_run_that_failed_and_none_in_use() {
    let dir = with_scene(StartingPoint::Stamp);
    let dir = dir.path();
    let scene = "version = 1
sheet.mesh = { rectangle = { width = 0.2, height = 0.1, columns = 2, rows = 1 } }
support = [
    { at = { vertices = [0, 3] } },
    { at = { vertices = [2, 5] }, hold = { moving_pin = { x = { ramp = { to = 0.1, end = 1 } } } } },
]
stop.time = 0.1
";
    fs::write(dir.join("taut.toml"), scene).unwrap();
    assert_eq!(code(&run(dir, &["simulate", "taut.toml"])), Some(1));
    fs::write(dir.join("taut.toml"), scene.replace("to = 0.1", "to = 0")).unwrap();
    assert_eq!(code(&run(dir, &["simulate", "taut.toml"])), Some(4));
    let mended = run(dir, &["simulate", "taut.toml", "--force"]);
    assert_eq!(code(&mended), Some(0), "{}", stderr(&mended));
    let simulate = ["simulate", "scene.toml", "-o", "run"];
    let mut child = started(dir, &simulate, "run", 2);
    let second = run(dir, &[&simulate[..], &["--force"]].concat());
    assert_eq!(code(&second), Some(5), "{}", stderr(&second));
    child.kill().unwrap();
    child.wait().unwrap();
    assert!(dir.join("run/scene.toml").is_file());
}

#[test]
fn folders_that_cannot_be_written_are_told() {
    let dir = with_scene(StartingPoint::Fold);
    let dir = dir.path();
    fs::write(dir.join("file"), "").unwrap();
    let refused = run(dir, &["simulate", "scene.toml", "--out", "file/run"]);
    assert_eq!(code(&refused), Some(6), "{}", stderr(&refused));
    assert!(stderr(&refused).contains("cannot write to the folder"));
    // Not even the superuser creates folders there.
    if Path::new("/proc/self").exists() {
        let refused = run(dir, &["simulate", "scene.toml", "--out", "/proc/run"]);
        assert_eq!(code(&refused), Some(6), "{}", stderr(&refused));
    }
    let none = run(dir, &["resume", "file"]);
    assert_eq!(code(&none), Some(3), "{}", stderr(&none));
}

/// A file system without room for the frames leaves a folder that can be continued with more room.
#[cfg(target_os = "linux")]
#[test]
fn a_full_disk_is_told_and_nothing_is_half_written() {
    let dir = with_scene(StartingPoint::Fold);
    let dir = dir.path();
    // No file takes more than so many blocks, as on a disk that is full.
    let limited = |arguments: &[&str]| {
        let script = "trap '' XFSZ; ulimit -f 8; exec \"$@\"";
        let mut shell = Command::new("sh");
        shell.args(["-c", script, "sh", env!("CARGO_BIN_EXE_isosheet")]);
        shell.args(arguments).current_dir(dir).output().unwrap()
    };
    let full = limited(&["simulate", "scene.toml", "--out", "run"]);
    assert_eq!(code(&full), Some(6), "{}", stderr(&full));
    assert!(stderr(&full).contains("free space"), "{}", stderr(&full));
    assert!(!dir.join("run/summary.json").exists());
    let done = run(dir, &["simulate", "scene.toml", "--out", "run"]);
    assert_eq!(code(&done), Some(0), "{}", stderr(&done));
    let whole = run(dir, &["simulate", "scene.toml", "--out", "whole"]);
    assert_eq!(code(&whole), Some(0), "{}", stderr(&whole));
    assert_same(&dir.join("whole"), &dir.join("run"));
    // Nothing but the command itself says what is wrong.
    let full = limited(&["convert", "whole", "a.npz"]);
    let said = stderr(&full);
    assert!(said.starts_with("error: cannot write a.npz: "), "{said}");
    assert!(
        said.ends_with("\n  = help: check the free space\n"),
        "{said}"
    );
    assert_eq!((said.lines().count(), code(&full)), (2, Some(6)), "{said}");
}

#[test]
fn damaged_checkpoints_are_refused() {
    let dir = with_scene(StartingPoint::Drape);
    let dir = dir.path();
    let simulate = ["simulate", "scene.toml", "--out", "run"];
    killed(dir, &simulate, "run", 3);
    let stored = dir.join("run/scene.toml");
    let text = fs::read_to_string(&stored).unwrap();
    fs::write(&stored, text.replace("time = 1.0", "time = 0.9")).unwrap();
    let changed = run(dir, &["resume", "run"]);
    assert_eq!(code(&changed), Some(4), "{}", stderr(&changed));
    fs::write(&stored, text).unwrap();
    let path = dir.join("run/checkpoint.bin");
    let mut bytes = fs::read(&path).unwrap();
    let middle = bytes.len() / 2;
    bytes[middle] ^= 1;
    fs::write(&path, bytes).unwrap();
    let refused = run(dir, &simulate);
    assert_eq!(code(&refused), Some(3), "{}", stderr(&refused));
    assert!(
        stderr(&refused).contains("checkpoint.bin"),
        "{}",
        stderr(&refused)
    );
}

/// The mesh file of the only entry of a list of sheets is found as that of a table is.
#[test]
fn a_list_of_one_sheet_may_have_a_mesh_file() {
    let dir = tempfile::tempdir().unwrap();
    let dir = dir.path();
    fs::write(dir.join("a.obj"), "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n").unwrap();
    let scene =
        "version = 1\n[[sheet]]\nmesh = { file = { path = \"a.obj\" } }\n[stop]\ntime = 0.1\n";
    fs::write(dir.join("s.toml"), scene).unwrap();
    let done = run(dir, &["simulate", "s.toml", "--set", "sheet.mass=2"]);
    assert_eq!(code(&done), Some(0), "{}", stderr(&done));
    let wrong = run(dir, &["check", "s.toml", "--set", "sheet.mass=-2"]);
    assert!(stderr(&wrong).contains("mass = -2"), "{}", stderr(&wrong));
}

/// A scene with a mesh file can be continued from its folder alone.
#[test]
fn mesh_files_travel_with_the_run() {
    let dir = tempfile::tempdir().unwrap();
    let dir = dir.path();
    fs::create_dir(dir.join("parts")).unwrap();
    fs::write(
        dir.join("parts/a.obj"),
        "v 0 0 0\nv 100 0 0\nv 0 0 -100\nv 100 0 -100\nf 1 2 3\nf 2 4 3\n",
    )
    .unwrap();
    let scene = "version = 1
        sheet.mesh.file = { path = \"parts/a.obj\", scale = 0.001, up = \"y\" }
        forces.gravity = [0, 0, -9.81]";
    fs::write(dir.join("s.toml"), scene).unwrap();
    let done = run(dir, &["simulate", "s.toml"]);
    assert_eq!(code(&done), Some(0), "{}", stderr(&done));
    let recording = Recording::read(&dir.join("s-run")).unwrap();
    let first = recording.trajectory.frame(0).unwrap();
    // (0, 0, -100) mm with y upwards is (0, 0.1, 0) m.
    assert!(
        first[6..9]
            .iter()
            .zip([0.0, 0.1, 0.0])
            .all(|(a, b)| (a - b).abs() < 1e-15)
    );
    // It falls as every body does; implicit steps of 1/60 s are off by a part of v h.
    let last = recording
        .trajectory
        .frame(recording.trajectory.len() - 1)
        .unwrap();
    assert!((last[2] + 0.5 * 9.81).abs() < 0.09, "{}", last[2]);
    let before = summary(&dir.join("s-run")).scene;
    fs::rename(dir.join("parts"), dir.join("moved")).unwrap();
    let again = run(dir, &["resume", "s-run"]);
    assert_eq!(code(&again), Some(0), "{}", stderr(&again));
    // The same scene from another place; another mesh under the same name is another scene.
    fs::write(
        dir.join("s.toml"),
        scene.replace("parts/a.obj", "moved/a.obj"),
    )
    .unwrap();
    assert_eq!(code(&run(dir, &["simulate", "s.toml"])), Some(0));
    let mesh = fs::read_to_string(dir.join("moved/a.obj")).unwrap();
    fs::write(dir.join("moved/a.obj"), mesh.replace("-100", "-90")).unwrap();
    assert_eq!(code(&run(dir, &["simulate", "s.toml"])), Some(4));
    assert_eq!(summary(&dir.join("s-run")).scene, before);
}
