//! The parts of the program of the page that need no browser: their tests run where Node.js is installed,
//! and the test says so where it is not.

use crate::skip::{runs, skipped};
use std::path::Path;
use std::process::Command;

#[test]
fn numbers_framing_and_plots_are_right() {
    if !runs("node", &["--version"]) {
        return skipped("node", "node is not installed");
    }
    let view = Path::new(env!("CARGO_MANIFEST_DIR")).join("view");
    let tests = ["against", "format", "framing", "start"];
    let tests = tests.map(|name| format!("tests/{name}.test.js"));
    let mut command = Command::new("node");
    let run = command.arg("--test").args(tests).current_dir(view).output();
    let run = run.expect("node starts");
    let said = String::from_utf8_lossy(&run.stdout);
    assert!(run.status.success(), "{said}");
}
