//! The trajectory of a run: written however the run ends, and again when it is lost; damage is noticed.

use crate::{code, killed, run, stderr, summary, with_scene, with_short_run};
use isosheet_formats::Trajectory;
use isosheet_runs::Recording;
use isosheet_scenes::StartingPoint;
use std::fs;

/// Moving pins ask for more than the lengths allow after some steps.
const TAUT: &str = "version = 1
[sheet]
mesh = { rectangle = { width = 0.2, height = 0.1, columns = 2, rows = 1 } }
placement = { turn = { axis = [1, 0, 0], angle = 20 } }
[[support]]
at = { vertices = [0, 3] }
[[support]]
at = { vertices = [2, 5] }
hold = { moving_pin = { x = { keyframes = { keys = [[0, 0], [0.5, 0], [1, 0.1]] } } } }
[output]
frames_per_second = 60
";

#[test]
fn a_run_that_fails_leaves_its_trajectory() {
    let dir = tempfile::tempdir().unwrap();
    let dir = dir.path();
    fs::write(dir.join("taut.toml"), TAUT).unwrap();
    let failed = run(dir, &["simulate", "taut.toml", "--out", "run"]);
    assert_eq!(code(&failed), Some(1), "{}", stderr(&failed));
    let trajectory = Trajectory::read(&dir.join("run/trajectory.npz")).unwrap();
    assert!(trajectory.len() > 20, "{} frames", trajectory.len());
    let recording = Recording::read(&dir.join("run")).unwrap();
    assert_eq!(recording.trajectory, trajectory);
    assert!(recording.summary.is_none());
    let converted = run(dir, &["convert", "run", "copy.npz"]);
    assert_eq!(code(&converted), Some(0), "{}", stderr(&converted));
    assert_eq!(Trajectory::read(&dir.join("copy.npz")).unwrap(), trajectory);
}

#[test]
fn a_lost_trajectory_comes_back_from_the_frames() {
    let dir = with_scene(StartingPoint::Drape);
    let dir = dir.path();
    let simulate = [
        "simulate",
        "scene.toml",
        "--out",
        "run",
        "--set",
        "stop.time=0.2",
    ];
    let done = run(dir, &simulate);
    assert_eq!(code(&done), Some(0), "{}", stderr(&done));
    let lost = dir.join("run/trajectory.npz");
    let bytes = fs::read(&lost).unwrap();
    // A trajectory that is there is not replaced by a part of it.
    let replaced = run(
        dir,
        &["convert", "run", "run/trajectory.npz", "--every", "2"],
    );
    assert_eq!(code(&replaced), Some(2), "{}", stderr(&replaced));
    let commands: [&[&str]; 3] = [
        &simulate,
        &["resume", "run"],
        &["convert", "run", "run/trajectory.npz"],
    ];
    for command in commands {
        fs::remove_file(&lost).unwrap();
        let done = run(dir, command);
        assert_eq!(code(&done), Some(0), "{command:?}: {}", stderr(&done));
        assert!(fs::read(&lost).unwrap() == bytes, "{command:?}");
    }
    let some = run(dir, &["convert", "run", "some.npz", "--every", "3"]);
    assert_eq!(code(&some), Some(0), "{}", stderr(&some));
    let [all, some] = [lost.clone(), dir.join("some.npz")].map(|p| Trajectory::read(&p).unwrap());
    assert_eq!(some.len(), all.len().div_ceil(3));
    assert_eq!(some.frame(1), all.frame(3));
    assert_eq!(some.gaps(1), all.gaps(3));
    // Without both there is nothing that could come back.
    fs::remove_file(&lost).unwrap();
    fs::remove_file(dir.join("run/frames.bin")).unwrap();
    for command in commands {
        let gone = run(dir, command);
        assert_eq!(code(&gone), Some(3), "{command:?}: {}", stderr(&gone));
        assert!(
            stderr(&gone).contains("frames.bin: it is missing"),
            "{}",
            stderr(&gone)
        );
    }
}

#[test]
fn damaged_frames_are_told() {
    let dir = with_scene(StartingPoint::Drape);
    let dir = dir.path();
    let simulate = [
        "simulate",
        "scene.toml",
        "--out",
        "run",
        "--set",
        "output.checkpoint_interval=0",
    ];
    killed(dir, &simulate, "run", 12);
    let path = dir.join("run/frames.bin");
    let whole = fs::read(&path).unwrap();
    let mut damaged = whole.clone();
    damaged[100] ^= 1;
    fs::write(&path, damaged).unwrap();
    for command in [
        &simulate[..],
        &["convert", "run", "x.csv"],
        &["page", "run"],
    ] {
        let refused = run(dir, command);
        assert_eq!(code(&refused), Some(3), "{command:?}: {}", stderr(&refused));
        assert!(
            stderr(&refused).contains("frame 0 is damaged"),
            "{}",
            stderr(&refused)
        );
        assert!(
            stderr(&refused).contains("= help: "),
            "{}",
            stderr(&refused)
        );
    }
    fs::write(&path, whole).unwrap();
    let done = run(dir, &[&simulate[..], &["--set", "stop.time=1.0"]].concat());
    assert_eq!(code(&done), Some(0), "{}", stderr(&done));
}

/// What is missing at the end of a file of a complete run is told, and nothing is made of what is left.
#[test]
fn files_that_are_cut_off_are_no_shorter_run() {
    let dir = with_short_run(StartingPoint::Drape);
    let dir = dir.path();
    let file = |name: &str| dir.join("run").join(name);
    let [frames, trajectory, history, page] =
        ["frames.bin", "trajectory.npz", "history.csv", "index.html"].map(file);
    let [whole, archive, rows, shown] =
        [&frames, &trajectory, &history, &page].map(|path| fs::read(path).unwrap());
    let count = summary(&dir.join("run")).frames;
    assert!(count > 3);
    let told = |command: &[&str], says: &str| {
        let refused = run(dir, command);
        let said = stderr(&refused);
        assert_eq!(code(&refused), Some(3), "{command:?}: {said}");
        assert!(said.contains(says), "{command:?}: {said}");
        assert!(said.contains("= help: copy the file again"), "{said}");
    };
    let record = (whole.len() - 8) / count as usize;
    fs::write(&frames, &whole[..8 + 2 * record + 5]).unwrap();
    let says = format!("frames.bin: it ends after 2 frames, and the complete run has {count} by");
    told(&["page", "run"], &says);
    assert!(
        fs::read(&page).unwrap() == shown,
        "the page is not replaced"
    );
    // The trajectory is whole, and then it is lost, too.
    let done = run(dir, &["convert", "run", "x.csv"]);
    assert_eq!(code(&done), Some(0), "{}", stderr(&done));
    fs::remove_file(&trajectory).unwrap();
    for command in [
        &["convert", "run", "y.csv"][..],
        &["info", "run"],
        &[
            "simulate",
            "scene.toml",
            "--out",
            "run",
            "--set",
            "stop.time=0.2",
        ],
        &["resume", "run"],
    ] {
        told(command, &says);
    }
    assert!(!dir.join("y.csv").exists() && !trajectory.exists());

    fs::write(&frames, &whole).unwrap();
    let short = run(dir, &["convert", "run", "short.npz", "--frames", "..1"]);
    assert_eq!(code(&short), Some(0), "{}", stderr(&short));
    fs::rename(dir.join("short.npz"), &trajectory).unwrap();
    let says =
        format!("trajectory.npz: it ends after 2 frames, and the complete run has {count} by");
    told(&["convert", "run", "y.csv"], &says);
    fs::remove_file(&frames).unwrap();
    told(&["page", "run"], &says);
    fs::write(&trajectory, archive).unwrap();
    let done = run(dir, &["page", "run"]);
    assert_eq!(code(&done), Some(0), "{}", stderr(&done));

    let text = String::from_utf8(rows).unwrap();
    let head: String = text.split_inclusive('\n').take(4).collect();
    fs::write(&history, head).unwrap();
    told(&["page", "run"], "history.csv: it ends after 3 rows, and");

    // A run that is not complete has what it has.
    fs::write(&history, text).unwrap();
    fs::write(&frames, &whole[..8 + 2 * record + 5]).unwrap();
    fs::remove_file(file("summary.json")).unwrap();
    let done = run(dir, &["convert", "run", "y.csv"]);
    assert_eq!(code(&done), Some(0), "{}", stderr(&done));
    let said = String::from_utf8_lossy(&done.stdout).into_owned();
    assert!(said.contains(": 2 frames"), "{said}");
}
