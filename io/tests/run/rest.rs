//! `isosheet rest`.

use crate::{code, run, stderr, stdout, summary};
use isosheet_formats::read_loads;
use std::fs;

/// A strip that hangs out of a clamp: the search is one step, and tells the lowest frequency.
#[test]
fn a_strip_comes_to_rest_in_one_step() {
    let folder = tempfile::tempdir().unwrap();
    let folder = folder.path();
    assert_eq!(
        code(&run(folder, &["new", "strip", "--kind", "clamp"])),
        Some(0)
    );
    let output = run(folder, &["rest", "strip.toml"]);
    assert_eq!(code(&output), Some(0), "{}", stderr(&output));
    let said = stdout(&output);
    assert!(said.contains("lowest frequency"), "{said}");
    let summary = summary(&folder.join("strip-rest"));
    assert_eq!(summary.steps, 1);
    assert_eq!(summary.ending.largest_speed, 0.0);
    // It is complete.
    let again = run(folder, &["rest", "strip.toml"]);
    assert_eq!(code(&again), Some(0), "{}", stderr(&again));
}

/// Where a support moves each step ends at an equilibrium, and the table of loads has a row for each.
#[test]
fn a_path_of_loads_has_a_row_for_each_step() {
    let folder = tempfile::tempdir().unwrap();
    let folder = folder.path();
    let scene = "version = 1
sheet.mesh.rectangle = { width = 0.1, height = 0.02, columns = 20, rows = 4 }
sheet.material = \"office paper\"
stop.time = 1
method.step = 0.25
output.frames_per_second = 4
[[support]]
at = { box = { min = [-1, -1, -1], max = [0.006, 1, 1] } }
[[support]]
at = { box = { min = [0.094, -1, -1], max = [2, 1, 1] } }
hold = { moving_pin = { x = { ramp = { to = -0.02, end = 1 } } } }
";
    fs::write(folder.join("pushed.toml"), scene).unwrap();
    let output = run(folder, &["rest", "pushed.toml", "-o", "path"]);
    assert_eq!(code(&output), Some(0), "{}", stderr(&output));
    assert_eq!(summary(&folder.join("path")).steps, 4);
    let loads = fs::read_to_string(folder.join("path/loads.csv")).unwrap();
    assert!(loads.lines().count() > 4, "{loads}");
}

/// Nothing holds the sheet: the error says so, and what helps.
#[test]
fn a_sheet_that_falls_has_no_equilibrium() {
    let folder = tempfile::tempdir().unwrap();
    let folder = folder.path();
    let scene = "version = 1
sheet.mesh.square = { side = 0.1, level = 2 }
sheet.material = \"newsprint\"
forces.gravity = [0, 0, -9.81]
stop.time = 1
";
    fs::write(folder.join("falling.toml"), scene).unwrap();
    let output = run(folder, &["rest", "falling.toml"]);
    assert_eq!(code(&output), Some(1));
    let said = stderr(&output);
    assert!(
        said.contains("nothing stops it") && said.contains("hold the sheet"),
        "{said}"
    );
}

/// A strip whose hinged ends are moved together, and whose middle is pushed down through the snap.
const SNAP: &str = "version = 1
[sheet]
mesh = { rectangle = { width = 0.2, height = 0.02, columns = 40, rows = 2 } }
density = 0.08
bending = { plate = { rigidity = 5e-4, poisson = 0 } }
isometry = { elastic = { stiffness = 3e5 } }
[[support]]
at = { box = { min = [-0.001, -1, -1], max = [0.001, 1, 1] } }
[[support]]
at = { box = { min = [0.199, -1, -1], max = [0.201, 1, 1] } }
hold = { moving_pin = { x = { keyframes = { interpolation = \"linear\", keys = [[0, 0], [1, -0.002], [3, -0.002]] } } } }
[[support]]
at = { box = { min = [0.099, -1, -1], max = [0.101, 1, 1] } }
[support.hold.surface]
shape = { plane = { point = [0, 0, 0], normal = [0, 0, 1] } }
motion = { z = { keyframes = { interpolation = \"linear\", keys = [[0, 0], [1, 0.0127], [3, -0.0127]] } } }
[method]
integrator = \"static\"
step = 0.05
[stop]
time = 3
";

/// A buckled strip is followed through its snap where its middle is moved. With the length `L`, the rigidity
/// `B` of its whole width and the middle at the height `w`, it bends to both sides at the end force
/// `P = 4 pi^2 B / L^2` of the second mode, and the middle takes the force `-4 P w / L`
/// (`B w'''' + P w'' = 0` with hinged ends, a deflection that is small).
#[test]
fn a_snap_is_followed_by_the_displacement() {
    let dir = tempfile::tempdir().unwrap();
    fs::write(dir.path().join("snap.toml"), SNAP).unwrap();
    let done = run(dir.path(), &["simulate", "snap.toml", "--out", "run"]);
    assert_eq!(code(&done), Some(0), "{}", stderr(&done));
    let loads = read_loads(&dir.path().join("run/loads.csv")).unwrap();
    let (length, rigidity) = (0.2_f64, 5e-4 * 0.02);
    let second = 4.0 * (std::f64::consts::PI / length).powi(2) * rigidity;
    // Deflections are small to the shortening of the ends, 1 %; the mesh errs by less.
    let bound = 0.01;
    let mut count = 0;
    for row in loads.iter().filter(|row| (1.12..2.88).contains(&row.t)) {
        let middle = 0.0127 * (2.0 - row.t);
        let force = -4.0 * second * middle / length;
        let largest = 4.0 * second * 0.0127 / length;
        let (found, exact, size) = match row.number {
            1 => (-row.force[0], second, second),
            2 => (row.force[2], force, largest),
            _ => continue,
        };
        let error = (found - exact) / size;
        assert!(error.abs() < bound, "{row:?}: {exact}");
        count += 1;
    }
    assert_eq!(count, 2 * 35);
}
