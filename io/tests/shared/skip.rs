//! Tests that need what not every machine has, and what they say where it is missing.

use std::fs::OpenOptions;
use std::io::Write;
use std::path::PathBuf;
use std::process::{Command, Stdio};

/// Says that the present test is skipped for want of something: on the terminal, and as a line of the file
/// that `ISOSHEET_SKIPPED` names. `.ci/run` lists these lines, and fails where it knows that the thing is
/// there.
pub(crate) fn skipped(need: &str, reason: &str) {
    // The harness names the thread of a test after it.
    let thread = std::thread::current();
    let test = thread.name().unwrap_or("a test");
    let line = format!("{need}: {}::{test}: {reason}\n", env!("CARGO_CRATE_NAME"));
    // The harness keeps what `println!` and `eprintln!` write to itself.
    let _ = std::io::stderr().write_all(format!("skipped for want of {line}").as_bytes());
    if let Some(path) = std::env::var_os("ISOSHEET_SKIPPED") {
        let file = OpenOptions::new().create(true).append(true).open(path);
        let written = file.and_then(|mut file| file.write_all(line.as_bytes()));
        written.expect("the file that ISOSHEET_SKIPPED names can be written");
    }
}

/// The folder with files of other people, which are not part of the repository. Without it the test is
/// skipped.
#[allow(
    dead_code,
    reason = "not every test binary reads the files of other people"
)]
pub(crate) fn data_folder() -> Option<PathBuf> {
    let folder = std::env::var_os("ISOSHEET_DATA");
    if folder.is_none() {
        skipped("data", "ISOSHEET_DATA is not set");
    }
    folder.map(PathBuf::from)
}

/// Whether a program starts and ends well.
#[allow(dead_code, reason = "not every test binary starts programs of others")]
pub(crate) fn runs(program: &str, arguments: &[&str]) -> bool {
    let mut command = Command::new(program);
    command
        .args(arguments)
        .stdout(Stdio::null())
        .stderr(Stdio::null());
    command.status().is_ok_and(|status| status.success())
}
