//! The command: runs that are killed and continued, folders in use, exit codes.

use isosheet_io::run::{EndReason, Recording, Summary};
use isosheet_io::scene::StartingPoint;
use isosheet_io::{frame_path, read_history, read_json, read_sheet};
use serde_json::Value;
use std::fs;
use std::path::{Path, PathBuf};
use std::process::{Child, Command, Output, Stdio};
use std::thread::sleep;
use std::time::{Duration, Instant};

fn isosheet(folder: &Path) -> Command {
    let mut command = Command::new(env!("CARGO_BIN_EXE_isosheet"));
    command.current_dir(folder);
    command
}

fn run(folder: &Path, arguments: &[&str]) -> Output {
    let output = isosheet(folder).args(arguments).output();
    output.expect("the command starts")
}

fn code(output: &Output) -> Option<i32> {
    output.status.code()
}

fn stderr(output: &Output) -> String {
    String::from_utf8_lossy(&output.stderr).into_owned()
}

/// A folder with one of the scenes to start from.
fn with_scene(kind: StartingPoint) -> tempfile::TempDir {
    let folder = tempfile::tempdir().unwrap();
    fs::write(folder.path().join("scene.toml"), kind.text()).unwrap();
    folder
}

/// Starts a run and waits until its history has so many rows.
fn started(folder: &Path, arguments: &[&str], out: &str, rows: usize) -> Child {
    let mut child = isosheet(folder)
        .args(arguments)
        .stderr(Stdio::null())
        .spawn()
        .unwrap();
    let history = folder.join(out).join("history.csv");
    let begun = Instant::now();
    loop {
        let text = fs::read_to_string(&history).unwrap_or_default();
        if text.lines().count() > rows || child.try_wait().unwrap().is_some() {
            return child;
        }
        assert!(begun.elapsed() < Duration::from_secs(60), "no progress");
        sleep(Duration::from_millis(1));
    }
}

/// The simulation in a checkpoint of a run: after eight bytes and the progress with its length, before the
/// sum.
fn simulation_bytes(folder: &Path) -> Vec<u8> {
    let bytes = fs::read(folder.join("checkpoint.bin")).unwrap();
    let length = u64::from_le_bytes(bytes[8..16].try_into().unwrap()) as usize;
    bytes[16 + length..bytes.len() - 8].to_vec()
}

fn summary(folder: &Path) -> Summary {
    read_json(&folder.join("summary.json")).unwrap()
}

/// Everything but the wall time is the same, to the bit.
fn assert_same(one: &Path, other: &Path) {
    for file in ["history.csv", "trajectory.npz", "scene.toml"] {
        let [a, b] = [one, other].map(|folder| fs::read(folder.join(file)).unwrap());
        assert!(a == b, "{file} differs in {}", other.display());
    }
    assert!(
        simulation_bytes(one) == simulation_bytes(other),
        "checkpoint"
    );
    let mut changed = summary(other);
    changed.wall_time = summary(one).wall_time;
    assert_eq!(changed, summary(one));
    assert!(!other.join("frames.bin").exists());
}

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
    for (interval, whole, killed) in [
        ("output.checkpoint_interval=0", "whole-0", "killed-0"),
        ("output.checkpoint_interval=0.05", "whole-1", "killed-1"),
    ] {
        let done = run(dir, &arguments(whole, interval));
        assert_eq!(code(&done), Some(0), "{}", stderr(&done));
        // Rows of the history at which the process is killed: before the first step, and wherever it comes to
        // be then. Kills that lose steps go back behind the row before.
        for rows in [1, 5, 23, 48, 49, 75, 100] {
            let mut child = started(dir, &arguments(killed, interval), killed, rows);
            child.kill().unwrap();
            child.wait().unwrap();
            assert!(
                !dir.join(killed).join("summary.json").exists(),
                "killed too late"
            );
        }
        let done = run(dir, &arguments(killed, interval));
        assert_eq!(code(&done), Some(0), "{}", stderr(&done));
        assert_same(&dir.join(whole), &dir.join(killed));
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
            let mut child = started(dir, &with_out("killed"), "killed", rows);
            child.kill().unwrap();
            child.wait().unwrap();
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
    assert!(rows > 100 && partial.trajectory.len() > rows / 17);
    let done = run(dir, &["resume", "stopped", "--threads", "2"]);
    assert_eq!(code(&done), Some(0), "{}", stderr(&done));
    assert_same(&dir.join("whole"), &dir.join("stopped"));
}

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
    fs::create_dir_all(dir.join("run")).unwrap();
    fs::write(dir.join("run/run.lock"), "").unwrap();
    // The device takes no byte.
    std::os::unix::fs::symlink("/dev/full", dir.join("run/frames.bin")).unwrap();
    let full = run(dir, &["simulate", "scene.toml", "--out", "run"]);
    assert_eq!(code(&full), Some(6), "{}", stderr(&full));
    assert!(stderr(&full).contains("free space"), "{}", stderr(&full));
    assert!(!dir.join("run/summary.json").exists());
    fs::remove_file(dir.join("run/frames.bin")).unwrap();
    let done = run(dir, &["simulate", "scene.toml", "--out", "run"]);
    assert_eq!(code(&done), Some(0), "{}", stderr(&done));
    let whole = run(dir, &["simulate", "scene.toml", "--out", "whole"]);
    assert_eq!(code(&whole), Some(0), "{}", stderr(&whole));
    assert_same(&dir.join("whole"), &dir.join("run"));
}

#[test]
fn damaged_checkpoints_are_refused() {
    let dir = with_scene(StartingPoint::Drape);
    let dir = dir.path();
    let simulate = ["simulate", "scene.toml", "--out", "run"];
    let mut child = started(dir, &simulate, "run", 3);
    child.kill().unwrap();
    child.wait().unwrap();
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

#[test]
fn conditions_to_stop_end_a_run() {
    let dir = with_scene(StartingPoint::Feed);
    let dir = dir.path();
    let limit = [
        "simulate",
        "scene.toml",
        "--out",
        "slip",
        "--set",
        "stop.support_force=0.003",
    ];
    let done = run(dir, &limit);
    assert_eq!(code(&done), Some(0), "{}", stderr(&done));
    let slip = summary(&dir.join("slip")).ending;
    assert_eq!(slip.reason, EndReason::SupportForce);
    let size = slip.supports[0].iter().map(|f| f * f).sum::<f64>().sqrt();
    assert!(slip.t < 0.9 && size > 0.003, "{slip:?}");
    let scene = "version = 1
        [sheet]
        mesh = { rectangle = { width = 0.1, height = 0.1, columns = 1, rows = 1 } }
        damping = 40
        [[support]]
        at = { vertices = [2, 3] }
        [forces]
        gravity = [0, 0, -9.81]
        [stop]
        time = 10
        rest = { speed = 1e-4, duration = 0.1 }
        [output]
        obj = true
        trajectory = false";
    fs::write(dir.join("rest.toml"), scene).unwrap();
    let done = run(dir, &["simulate", "rest.toml", "--json"]);
    assert_eq!(code(&done), Some(0), "{}", stderr(&done));
    let rest = summary(&dir.join("rest-run"));
    assert_eq!(rest.ending.reason, EndReason::Rest);
    assert!(rest.ending.t < 10.0 && rest.ending.largest_speed <= 1e-4);
    // Half the weight of the faces is at the two vertices that are pinned, all of it is carried by them.
    let weight = 0.08 * 0.01 * 9.81;
    assert!(
        (rest.ending.supports[0][2] - weight).abs() < 1e-3 * weight,
        "{rest:?}"
    );
    assert!(!dir.join("rest-run/trajectory.npz").exists());
    let last = frame_path(&dir.join("rest-run/obj"), rest.frames as usize - 1);
    let hanging = read_sheet(&last).unwrap();
    assert!(
        (hanging.positions()[2] + 0.1).abs() < 1e-4,
        "it hangs straight down"
    );
}

#[test]
fn steps_that_fail_are_told_at_the_scene() {
    let dir = with_scene(StartingPoint::Fold);
    let dir = dir.path();
    let scene = "version = 1
[sheet]
mesh = { rectangle = { width = 0.2, height = 0.1, columns = 2, rows = 1 } }
[[support]]
at = { vertices = [0, 3] }
[[support]]
at = { vertices = [2, 5] }
hold = { moving_pin = { x = { ramp = { to = 0.1, end = 1 } } } }
";
    fs::write(dir.join("taut.toml"), scene).unwrap();
    let failed = run(dir, &["simulate", "taut.toml"]);
    assert_eq!(code(&failed), Some(1), "{}", stderr(&failed));
    assert!(
        stderr(&failed).contains("--> taut.toml:8:8"),
        "{}",
        stderr(&failed)
    );
    let json = run(dir, &["simulate", "taut.toml", "--json"]);
    let last = String::from_utf8_lossy(&json.stdout);
    let error: Value = serde_json::from_str(last.lines().last().unwrap()).unwrap();
    assert_eq!(
        (&error["event"], &error["code"]),
        (&"error".into(), &1.into())
    );
    assert_eq!(error["problems"][0]["key"], "support[1].hold");
    let stop = [
        "simulate",
        "taut.toml",
        "--set",
        "method.taut=stop",
        "--out",
        "stop",
    ];
    let stopped = run(dir, &stop);
    assert_eq!(code(&stopped), Some(0), "{}", stderr(&stopped));
    assert_eq!(summary(&dir.join("stop")).ending.reason, EndReason::Taut);
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

#[test]
fn new_check_info_and_completions() {
    let dir = tempfile::tempdir().unwrap();
    let dir = dir.path();
    for kind in StartingPoint::ALL {
        let name = kind.name();
        assert_eq!(code(&run(dir, &["new", name, "--kind", name])), Some(0));
        let check = run(dir, &["check", &format!("{name}.toml")]);
        assert_eq!(code(&check), Some(0), "{}", stderr(&check));
        assert_eq!(
            code(&run(dir, &["new", name, "--kind", name])),
            Some(6),
            "not overwritten"
        );
    }
    let info = run(dir, &["info", "fold.toml"]);
    let text = String::from_utf8_lossy(&info.stdout).into_owned();
    // 25 vertices, 4 x 4 panels of two triangles: 56 edges, 75 - 56 = 19 degrees of freedom, 9 interior
    // vertices with one dependent rod each.
    for part in [
        "25, of these 16 on the boundary",
        "56,",
        "freedom 19",
        "rods   9 in a flat state, 9 as given",
    ] {
        assert!(text.contains(part), "{part}: {text}");
    }
    let script = run(dir, &["completions", "bash"]);
    assert!(String::from_utf8_lossy(&script.stdout).contains("simulate"));
    let help = run(dir, &["--help"]);
    let help = String::from_utf8_lossy(&help.stdout).into_owned();
    let codes = help.split("Exit codes:").nth(1).unwrap().lines().skip(1);
    let page = Path::new(env!("CARGO_MANIFEST_DIR")).join("../docs/scene.md");
    let page = fs::read_to_string(page).unwrap();
    let rows = codes.map(|line| line.trim().split_once(' ').unwrap());
    let rows: Vec<String> = rows
        .map(|(n, text)| format!("| {n} | {} |", text.trim()))
        .collect();
    assert!(
        rows.len() == 8 && rows.iter().all(|row| page.contains(row)),
        "{rows:?}"
    );
    assert_eq!(code(&run(dir, &["simulate"])), Some(2));
}

#[test]
fn meshes_are_checked_and_repaired() {
    let dir = tempfile::tempdir().unwrap();
    let dir = dir.path();
    let soup = "v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 0 0\nv 1 1 0\nv 0 1 0\nv 5 5 5\nf 1 2 3\nf 4 6 5\n";
    fs::write(dir.join("soup.obj"), soup).unwrap();
    let check = run(dir, &["check", "soup.obj"]);
    assert_eq!(code(&check), Some(3));
    assert!(
        stderr(&check).contains("--fix FILE2` repairs this"),
        "{}",
        stderr(&check)
    );
    let fix = run(dir, &["check", "soup.obj", "--fix", "sheet.obj"]);
    assert_eq!(code(&fix), Some(0), "{}", stderr(&fix));
    let sheet = read_sheet(&dir.join("sheet.obj")).unwrap();
    assert_eq!((sheet.topology().vertex_count(), sheet.area()), (4, 1.0));
    assert_eq!(code(&run(dir, &["check", "sheet.obj"])), Some(0));
    let quad = "v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\nf 1 2 3 4\n";
    fs::write(dir.join("quad.obj"), quad).unwrap();
    let refused = run(dir, &["check", "quad.obj"]);
    assert!(
        stderr(&refused).contains("cuts polygons"),
        "{}",
        stderr(&refused)
    );
    assert_eq!(
        code(&run(dir, &["check", "quad.obj", "--fix", "cut.obj"])),
        Some(0)
    );
    // Two triangles that touch along a side are a sheet of two parts; merging joins them. Three that touch along
    // one side cannot be joined, and stay as they are.
    let touching = "v 0 0 0\nv 1 0 0\nv 0 1 0\nv 1 0 0\nv 0 0 0\nv 0 -1 0\nf 1 2 3\nf 4 5 6\n";
    fs::write(dir.join("touch.obj"), touching).unwrap();
    let check = run(dir, &["check", "touch.obj"]);
    let text = String::from_utf8_lossy(&check.stdout).into_owned();
    assert!(
        text.contains("in 2 parts") && text.contains("2 coincident"),
        "{text}"
    );
    assert_eq!(
        code(&run(dir, &["check", "touch.obj", "--fix", "one.obj"])),
        Some(0)
    );
    assert_eq!(
        read_sheet(&dir.join("one.obj"))
            .unwrap()
            .topology()
            .component_count(),
        1
    );
    let up = "v 0 0 0\nv 1 0 0\nv 0 0 1\nf 7 8 9\n";
    fs::write(dir.join("three.obj"), format!("{touching}{up}")).unwrap();
    let kept = run(dir, &["check", "three.obj", "--fix", "kept.obj"]);
    assert_eq!(code(&kept), Some(0), "{}", stderr(&kept));
    assert_eq!(
        read_sheet(&dir.join("kept.obj"))
            .unwrap()
            .topology()
            .component_count(),
        3
    );
    let fan = "v 0 0 0\nv 1 0 0\nv 0 1 0\nv 0 -1 0\nv 0 0 1\nf 1 2 3\nf 1 2 4\nf 1 2 5\n";
    fs::write(dir.join("fan.obj"), fan).unwrap();
    let refused = run(dir, &["check", "fan.obj", "--fix", "no.obj"]);
    assert_eq!(code(&refused), Some(3));
    assert!(!PathBuf::from("no.obj").exists());
}
