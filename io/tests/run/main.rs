//! The command: runs that are killed and continued, folders in use, exit codes.

mod acting;
mod asked_too_much;
mod bodies;
mod command_line;
mod contact_data;
mod continuing;
mod convert;
mod crease_measures;
#[path = "../shared/devtools.rs"]
mod devtools;
mod drawings;
mod ends;
mod events;
mod extending;
mod fit;
mod fold;
mod fold_sides;
mod fold_verdicts;
mod folders;
mod folding;
mod gallery;
mod gases;
#[path = "../shared/headless.rs"]
mod headless;
mod live;
mod live_page;
mod measures;
mod pages;
mod recording;
mod rest;
mod rod_forces;
mod rulings;
mod sequences;
mod sizes;
#[path = "../shared/skip.rs"]
mod skip;
#[cfg(unix)]
mod strangers;
mod sweeps;
mod time_error;
mod tools;
mod traces;
mod trajectories;
mod unroll;
mod what_drawings_say;
mod yielding;

use isosheet_files::read_json;
use isosheet_runs::Summary;
use isosheet_scenes::StartingPoint;
use std::fs;
use std::path::Path;
use std::process::{Child, Command, Output, Stdio};
use std::thread::sleep;
use std::time::Duration;

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

fn stdout(output: &Output) -> String {
    String::from_utf8_lossy(&output.stdout).into_owned()
}

/// A folder with one of the scenes to start from.
fn with_scene(kind: StartingPoint) -> tempfile::TempDir {
    let folder = tempfile::tempdir().unwrap();
    fs::write(folder.path().join("scene.toml"), kind.text()).unwrap();
    folder
}

/// A folder with one of the scenes to start from, and with the run of its first fifth of a second, `run`.
fn with_short_run(kind: StartingPoint) -> tempfile::TempDir {
    let folder = with_scene(kind);
    let arguments = ["scene.toml", "--out", "run", "--set", "stop.time=0.2"];
    let done = run(folder.path(), &[&["simulate"][..], &arguments].concat());
    assert_eq!(code(&done), Some(0), "{}", stderr(&done));
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
    loop {
        let text = fs::read_to_string(&history).unwrap_or_default();
        if text.lines().count() > rows || child.try_wait().unwrap().is_some() {
            return child;
        }
        sleep(Duration::from_millis(1));
    }
}

/// Starts a run and kills it once its history has so many rows.
fn killed(folder: &Path, arguments: &[&str], out: &str, rows: usize) {
    let mut child = started(folder, arguments, out, rows);
    child.kill().unwrap();
    child.wait().unwrap();
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
    // Only scenes with supports or obstacles have loads, and only scenes that name measures have measures.
    for file in ["loads.csv", "measures.csv", "events.csv"] {
        let [a, b] = [one, other].map(|folder| fs::read(folder.join(file)).ok());
        assert!(a == b, "{file} differs in {}", other.display());
    }
    for file in ["history.csv", "trajectory.npz", "frames.bin", "scene.toml"] {
        let [a, b] = [one, other].map(|folder| fs::read(folder.join(file)).unwrap());
        assert!(a == b, "{file} differs in {}", other.display());
    }
    assert!(
        simulation_bytes(one) == simulation_bytes(other),
        "checkpoint"
    );
    let [a, b] = [one, other].map(page_without_name);
    assert!(a == b, "the page of {} differs", other.display());
    let mut changed = summary(other);
    changed.wall_time = summary(one).wall_time;
    assert_eq!(changed, summary(one));
}

/// The page of a run without the two things that differ between two folders: their name and the wall time.
fn page_without_name(folder: &Path) -> String {
    let page = fs::read_to_string(folder.join("index.html")).unwrap();
    let name = folder.file_name().unwrap().to_string_lossy();
    let name = name.trim_end_matches("-run");
    let page = page.replace(&format!("<title>{name}</title>"), "");
    let page = page.replace(&format!("\"title\":\"{name}\""), "");
    let (before, rest) = page
        .split_once("[\"wall time\",")
        .expect("the page has the wall time");
    let (_, after) = rest.split_once(']').unwrap();
    format!("{before}{after}")
}
