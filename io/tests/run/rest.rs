//! `isosheet rest`.

use crate::{code, run, stderr, stdout, summary};
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
