//! Scenes whose numbers are in range and whose products are not.

use crate::{code, run, stderr, stdout};
use std::fs;
use std::path::Path;
use std::process::{Command, Output};

fn write(dir: &Path, scene: &str) {
    fs::write(dir.join("s.toml"), format!("version = 1\n{scene}")).unwrap();
}

/// What a scene is refused with, before anything is written.
fn refused(scene: &str) -> String {
    let dir = tempfile::tempdir().unwrap();
    write(dir.path(), scene);
    for arguments in [&["check", "s.toml"][..], &["simulate", "s.toml"]] {
        let refused = run(dir.path(), arguments);
        assert_eq!(code(&refused), Some(3), "{}", stderr(&refused));
        assert!(!dir.path().join("s-run").exists());
    }
    stderr(&run(dir.path(), &["check", "s.toml"]))
}

/// The command with so many kilobytes of memory.
#[cfg(unix)]
fn limited(dir: &Path, kilobytes: u64, arguments: &[&str]) -> Output {
    let script = format!("ulimit -v {kilobytes}; exec \"$@\"");
    let mut shell = Command::new("sh");
    shell.args(["-c", &script, "sh", env!("CARGO_BIN_EXE_isosheet")]);
    shell.args(arguments).current_dir(dir).output().unwrap()
}

#[test]
fn faces_that_are_too_narrow_are_refused_at_the_mesh() {
    let said = refused(
        "sheet.mesh.rectangle = { width = 0.3, height = 1e9, columns = 1, rows = 1 }\n\
         sheet.material = \"polycarbonate film\"\n",
    );
    assert!(
        said.contains("too narrow") && said.contains("s.toml:2"),
        "{said}"
    );
}

#[test]
fn a_sheet_that_is_too_far_away_is_refused() {
    let said = refused(
        "sheet.mesh.square = { side = 0.1, level = 1 }\nsheet.placement.position = [1e11, 0, 0]\n",
    );
    assert!(said.contains("lost in round-off"), "{said}");
}

#[test]
fn a_scene_of_pins_has_no_degree_of_freedom_and_runs() {
    let dir = tempfile::tempdir().unwrap();
    let dir = dir.path();
    write(
        dir,
        "sheet.mesh.square = { side = 0.2, level = 0 }\n[[support]]\nat = \"all\"\n",
    );
    let checked = run(dir, &["check", "s.toml"]);
    assert_eq!(code(&checked), Some(0), "{}", stderr(&checked));
    assert!(
        stdout(&checked).contains("rank 0 of 0 rods"),
        "{}",
        stdout(&checked)
    );
    let done = run(dir, &["simulate", "s.toml"]);
    assert_eq!(code(&done), Some(0), "{}", stderr(&done));
}

#[cfg(unix)]
#[test]
fn meshes_that_memory_cannot_hold_are_refused_before_they_are_made() {
    let dir = tempfile::tempdir().unwrap();
    let dir = dir.path();
    for (scene, key) in [
        (
            "sheet.refine = 12\nsheet.mesh.square = { side = 1, level = 4 }\n",
            "refine = 12",
        ),
        (
            "sheet.mesh.rectangle = { width = 1, height = 1000, columns = 1, rows = 3000000 }\n",
            "6e6 faces",
        ),
        (
            "sheet.mesh.disk = { radius = 1, rings = 100000 }\n",
            "rings = 100000",
        ),
        (
            "sheet.mesh.polygon = { outline = [[0, 0], [1, 0], [0, 1]], spacing = 1e-6 }\n",
            "spacing = 1e-6",
        ),
        (
            "sheet.refine = 12\nsheet.mesh.file.path = \"a.off\"\n",
            "refine = 12",
        ),
    ] {
        fs::write(
            dir.join("a.off"),
            "OFF\n3 1 0\n0 0 0\n1 0 0\n0 1 0\n3 0 1 2\n",
        )
        .unwrap();
        write(dir, scene);
        let refused = limited(dir, 1_000_000, &["check", "s.toml"]);
        assert_eq!(code(&refused), Some(3), "{}", stderr(&refused));
        let said = stderr(&refused);
        assert!(said.contains(key) && said.contains("faces"), "{said}");
    }
}

#[test]
fn polygons_of_a_billion_sides_are_refused() {
    let said = refused(
        "sheet.mesh.polygon_rings = { outline = { regular = { sides = 1000000000, radius = 1 } }, rings = 1 }\n",
    );
    assert!(said.contains("sides"), "{said}");
}

const SQUARE: &str =
    "sheet.mesh.square = { side = 0.1, level = 1 }\nforces.gravity = [0, 0, -9.81]\n";

#[test]
fn steps_in_which_the_sheet_leaves_all_digits_behind_are_refused() {
    let said = refused(&format!("{SQUARE}method.step = 1e10\nstop.time = 1e12\n"));
    assert!(
        said.contains("step = 1e10") && said.contains("round-off"),
        "{said}"
    );
}

/// A sheet falls freely for four months: `g t^2 / 2` are 5e14 m.
#[test]
fn a_run_ends_where_the_coordinates_resolve_its_edges_no_more() {
    let dir = tempfile::tempdir().unwrap();
    let dir = dir.path();
    write(
        dir,
        &format!("{SQUARE}method.step = 1e3\nstop.time = 1e7\n"),
    );
    let failed = run(dir, &["simulate", "s.toml"]);
    assert_eq!(code(&failed), Some(1), "{}", stderr(&failed));
    assert!(
        stderr(&failed).contains("lost in round-off"),
        "{}",
        stderr(&failed)
    );
}

#[test]
fn frames_for_which_the_disk_has_no_room_are_refused() {
    let many = "sheet.mesh.square = { side = 1, level = 5 }\nmethod.step = 1e-3\nstop.time = 1e6\n\
                output.frames_per_second = 1000\n";
    let said = refused(many);
    assert!(
        said.contains("frames_per_second") && said.contains("on the disk"),
        "{said}"
    );
    // Where the run may end early it is a warning.
    let dir = tempfile::tempdir().unwrap();
    let dir = dir.path();
    write(
        dir,
        &format!("{many}stop.rest = {{ speed = 1e-3, duration = 1 }}\n"),
    );
    let checked = run(dir, &["check", "s.toml"]);
    assert_eq!(code(&checked), Some(0), "{}", stderr(&checked));
    let said = stderr(&checked);
    assert!(
        said.contains("warning: the files of the run need about"),
        "{said}"
    );
    assert!(
        stdout(&checked).contains("at most 1000000000 steps"),
        "{}",
        stdout(&checked)
    );
}

/// The archive and the page of a run are made with one frame in memory at a time: the program with its
/// threads and two copies of the frames, of which there were four before, do not fit in the memory that it
/// gets.
#[cfg(unix)]
#[test]
fn the_end_of_a_long_run_needs_no_copies_of_its_frames() {
    let dir = tempfile::tempdir().unwrap();
    let dir = dir.path();
    // All vertices are pinned, so that steps take no time.
    write(
        dir,
        "sheet.mesh.rectangle = { width = 1, height = 1, columns = 60, rows = 60 }\n\
         method.step = 0.01\nstop.time = 10\noutput.frames_per_second = 100\n\
         [[support]]\nat = \"all\"\n",
    );
    let arguments = ["simulate", "s.toml"];
    let done = run(dir, &arguments);
    assert_eq!(code(&done), Some(0), "{}", stderr(&done));
    let frames = fs::metadata(dir.join("s-run/frames.bin")).unwrap().len();
    let trajectory = fs::read(dir.join("s-run/trajectory.npz")).unwrap();
    for name in ["summary.json", "trajectory.npz", "index.html"] {
        fs::remove_file(dir.join("s-run").join(name)).unwrap();
    }
    let again = limited(dir, 2 * frames / 1024, &arguments);
    assert_eq!(code(&again), Some(0), "{frames}: {}", stderr(&again));
    assert_eq!(
        fs::read(dir.join("s-run/trajectory.npz")).unwrap(),
        trajectory
    );
    assert!(dir.join("s-run/index.html").is_file());
}
