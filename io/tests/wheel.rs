//! The wheel for Python: built, installed into an environment of its own, and used.
//!
//! This takes minutes, and runs if `ISOSHEET_WHEEL` is set and `python3` and `maturin` are installed.

#[path = "shared/skip.rs"]
mod skip;

use skip::{runs, skipped};
use std::path::Path;
use std::process::Command;

/// The output of a command that has to succeed.
fn output(command: &mut Command) -> String {
    let output = command.output().expect("the command starts");
    let said = String::from_utf8_lossy(&output.stderr).into_owned();
    assert!(output.status.success(), "{command:?}: {said}");
    String::from_utf8_lossy(&output.stdout).into_owned()
}

#[test]
fn the_wheel_installs_the_command() {
    if std::env::var_os("ISOSHEET_WHEEL").is_none() {
        skipped("wheel", "ISOSHEET_WHEEL is not set");
        return;
    }
    for program in ["python3", "maturin"] {
        if !runs(program, &["--version"]) {
            skipped("wheel", &format!("{program} is not installed"));
            return;
        }
    }
    let crate_folder = Path::new(env!("CARGO_MANIFEST_DIR"));
    let dir = tempfile::tempdir().unwrap();
    let wheels = dir.path().join("wheels");
    // The development profile is that of the tests, so that dependencies are not built again.
    output(
        Command::new("maturin")
            .args(["build", "--profile", "dev", "--locked", "--out"])
            .arg(&wheels)
            .current_dir(crate_folder),
    );
    let mut found = std::fs::read_dir(&wheels).unwrap();
    let wheel = found.next().expect("a wheel").unwrap().path();
    let name = wheel.file_name().unwrap().to_string_lossy().into_owned();
    let version = env!("CARGO_PKG_VERSION");
    assert!(
        name.starts_with(&format!("isosheet-{version}-py3-none-")),
        "{name}"
    );

    let venv = dir.path().join("venv");
    output(Command::new("python3").args(["-m", "venv"]).arg(&venv));
    let programs = venv.join(if cfg!(windows) { "Scripts" } else { "bin" });
    output(
        Command::new(programs.join("python"))
            .args(["-m", "pip", "install", "--no-index", "--quiet"])
            .arg(&wheel),
    );
    let isosheet = programs.join("isosheet");
    let said = output(Command::new(&isosheet).arg("--version"));
    assert!(said.contains(version), "{said}");
    let in_folder = |arguments: &[&str]| {
        output(
            Command::new(&isosheet)
                .args(arguments)
                .current_dir(dir.path()),
        )
    };
    in_folder(&["new", "cloth", "--kind", "hanging"]);
    in_folder(&["simulate", "cloth.toml", "--set", "stop.time=0.05"]);
    let run = dir.path().join("cloth-run");
    assert!(run.join("summary.json").is_file() && run.join("index.html").is_file());
}
