//! Runs whose obstacles and supports follow meshes in motion.

use crate::{assert_same, code, killed, run, stderr, stdout};
use isosheet_formats::{LoadKind, Trajectory, read_loads};
use std::fs;

/// A run whose trajectory is the obstacle of a second one, and leads its supports, beside a fixed obstacle:
/// it is killed and continued, its folder has a copy of the file, and its loads and files name the obstacle.
#[test]
fn the_trajectory_of_a_run_drives_another_that_continues_to_the_same_bits() {
    let dir = tempfile::tempdir().unwrap();
    let dir = dir.path();
    let sheet = |side: f64, z: f64| {
        format!(
            "version = 1\n[sheet]\nmaterial = \"cotton\"\ndamping = 1\n\
             mesh = {{ square = {{ side = {side}, level = 1 }} }}\n\
             placement = {{ position = [{0}, {0}, {z}] }}\n[stop]\ntime = 0.3\n[output]\nframes_per_second = 60\n\
             checkpoint_interval = 0\n",
            -0.5 * side
        )
    };
    let held = "[[support]]\nat = { vertices = [0, 4, 20, 24] }\n\
                hold = { moving_pin = { z = { smooth_step = { to = 0.03, end = 0.3 } } } }\n\
                [forces]\ngravity = [0, 0, -9.81]\n";
    fs::write(dir.join("body.toml"), format!("{}{held}", sheet(0.2, 0.0))).unwrap();
    let done = run(dir, &["simulate", "body.toml"]);
    assert_eq!(code(&done), Some(0), "{}", stderr(&done));
    let worn = format!(
        "{}[forces]\ngravity = [0, 0, -9.81]\n\
         [[obstacle]]\nshape = {{ sequence = {{ path = \"body-run/trajectory.npz\" }} }}\n\
         [[obstacle]]\nshape = \"half_space\"\npose = {{ position = [0, 0, -0.02] }}\n\
         [[support]]\nat = {{ vertices = [0] }}\n\
         hold = {{ follow = {{ sequence = {{ path = \"body-run/trajectory.npz\" }} }} }}\n",
        sheet(0.1, 0.006)
    );
    fs::write(dir.join("worn.toml"), worn).unwrap();
    let with_out = |out| ["simulate", "worn.toml", "--out", out];
    let done = run(dir, &with_out("whole"));
    assert_eq!(code(&done), Some(0), "{}", stderr(&done));
    for rows in [2, 6, 11] {
        killed(dir, &with_out("killed"), "killed", rows);
        assert!(!dir.join("killed/summary.json").exists(), "killed too late");
    }
    let done = run(dir, &with_out("killed"));
    assert_eq!(code(&done), Some(0), "{}", stderr(&done));
    assert_same(&dir.join("whole"), &dir.join("killed"));
    // The obstacle that deforms bears the cloth, and the floor below it nothing.
    let loads = read_loads(&dir.join("whole/loads.csv")).unwrap();
    let last = loads.iter().rev().take(3).rev();
    let last: Vec<_> = last.map(|row| (row.on, row.number, row.force[2])).collect();
    assert!(
        matches!(
            last[..],
            [(LoadKind::Support, 0, _), (LoadKind::Obstacle, 0, on_mesh), (LoadKind::Obstacle, 1, 0.0)] if on_mesh < 0.0
        ),
        "{last:?}"
    );
    let trajectory = Trajectory::read(&dir.join("whole/trajectory.npz")).unwrap();
    assert_eq!(trajectory.vertex_count(), 50);
    let info = run(dir, &["info", "whole"]);
    let text = stdout(&info);
    assert!(
        text.contains("obstacle         obstacle_0: vertices 25 to 49"),
        "{text}"
    );
    assert!(text.contains("pinned vertices  1"), "{text}");
    // The folder is complete in itself.
    fs::remove_dir_all(dir.join("body-run")).unwrap();
    let done = run(dir, &["convert", "whole", "worn.pvd"]);
    assert_eq!(code(&done), Some(0), "{}", stderr(&done));
    let done = run(dir, &["resume", "whole"]);
    assert_eq!(code(&done), Some(0), "{}", stderr(&done));
    let done = run(dir, &with_out("other"));
    assert!(
        stderr(&done).contains("trajectory.npz"),
        "{}",
        stderr(&done)
    );
    assert_ne!(code(&done), Some(0));
}

/// `--force` does not delete what the scene reads: the run that is its body, or a file in it.
#[test]
fn force_keeps_what_the_scene_reads() {
    let dir = tempfile::tempdir().unwrap();
    let dir = dir.path();
    let sheet =
        "version = 1\n[sheet]\nmesh = { square = { side = 0.1, level = 1 } }\n[stop]\ntime = 0.1\n";
    fs::write(
        dir.join("body.toml"),
        format!("{sheet}[output]\nobj = true\n"),
    )
    .unwrap();
    let done = run(dir, &["simulate", "body.toml"]);
    assert_eq!(code(&done), Some(0), "{}", stderr(&done));
    let trajectory = fs::read(dir.join("body-run/trajectory.npz")).unwrap();
    let list = "<VTKFile><Collection><DataSet timestep=\"0\" file=\"body-run/obj/frame_00000.obj\"/></Collection></VTKFile>";
    fs::write(dir.join("list.pvd"), list).unwrap();
    for shape in [
        "sequence = { path = \"body-run\" }",
        "sequence = { path = \"body-run/trajectory.npz\" }",
        "sequence = { path = \"body-run/obj/frame_*.obj\", rate = 60, outside = \"rest\" }",
        "sequence = { path = \"list.pvd\", outside = \"rest\" }",
    ] {
        let worn = format!(
            "{sheet}[[obstacle]]\nshape = {{ {shape} }}\npose = {{ position = [0, 0, -1] }}\n"
        );
        fs::write(dir.join("worn.toml"), worn).unwrap();
        let done = run(
            dir,
            &["simulate", "worn.toml", "--out", "./body-run/", "--force"],
        );
        let said = stderr(&done);
        assert_eq!(code(&done), Some(4), "{shape}: {said}");
        assert!(
            said.contains("the scene reads") && said.contains("--out"),
            "{said}"
        );
        assert_eq!(
            fs::read(dir.join("body-run/trajectory.npz")).unwrap(),
            trajectory
        );
    }
    let done = run(dir, &["simulate", "worn.toml", "--force"]);
    assert_eq!(code(&done), Some(0), "{}", stderr(&done));
}
