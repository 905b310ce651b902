//! Finds git's log of HEAD, if the crate is built in a repository: the last line names the commit.
//!
//! The command reads the log when it is compiled (`src/bin/isosheet/commit.rs`). So a commit makes the
//! command anew and nothing else: this script runs again only where the repository itself has changed its
//! place.

use std::path::Path;
use std::process::Command;

pub(crate) fn main() {
    println!("cargo::rerun-if-changed=build.rs");
    println!("cargo::rustc-check-cfg=cfg(isosheet_log_of_head)");
    let git = |arguments: &[&str]| {
        let output = Command::new("git").args(arguments).output().ok()?;
        let text = String::from_utf8(output.stdout).ok()?;
        output.status.success().then(|| text.trim().to_owned())
    };
    let file = |name: &str| {
        let path = git(&["rev-parse", "--path-format=absolute", "--git-path", name])?;
        Path::new(&path).is_file().then_some(path)
    };
    // A repository around a copy of the crate says nothing of the crate.
    if git(&["ls-files", "--error-unmatch", "build.rs"]).is_none() {
        return;
    }
    if let (Some(log), Some(config)) = (file("logs/HEAD"), file("config")) {
        println!("cargo::rustc-cfg=isosheet_log_of_head");
        println!("cargo::rustc-env=ISOSHEET_LOG_OF_HEAD={log}");
        println!("cargo::rerun-if-changed={config}");
    }
}
