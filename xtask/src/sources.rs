//! The sources that the numbers of a report depend on, of the solver and of the report, and which of them
//! have changed since a commit.
//!
//! Lines of comments do not count, nor do files of tests and pages of text: those may change without making a
//! number out of date. Versions of dependencies and of the compiler are not part of it.

use anyhow::{Context, Result, ensure};
use std::path::{Path, PathBuf};
use std::process::Command;

/// The charts: what a bent sheet's coordinates are.
const CHARTS: &[&str] = &["mesh", "coords"];

/// The crates of the solver, how scenes become simulations, and the mechanical problems.
const SOLVER: &[&str] = &[
    "mesh",
    "coords",
    "dynamics",
    "collide",
    "io/scenes/src",
    "tests/models",
];

/// What stands in these folders and does not count, as patterns of paths.
const BESIDE: [&str; 7] = [
    "*/tests/*",
    "*/tests.rs",
    "*_tests/*",
    "*_tests.rs",
    "*/benches/*",
    "*.md",
    "*Cargo.toml",
];

/// A line that is not blank and no comment of Rust or TOML.
const CODE: &str = r"-G^[[:space:]]*([^[:space:]/#]|/[^/]|#!?\[)";

/// A report that writes what it measured, with its sources.
#[derive(Debug)]
pub(crate) struct MeasuredReport {
    pub(crate) name: &'static str,
    /// Files and folders of other crates.
    solver: &'static [&'static str],
    /// Files and folders in `xtask`.
    own: &'static [&'static str],
}

/// All of them.
pub(crate) const REPORTS: [MeasuredReport; 6] = [
    MeasuredReport {
        name: "condition-table",
        solver: CHARTS,
        own: &["src/condition.rs"],
    },
    MeasuredReport {
        name: "cost",
        solver: SOLVER,
        own: &["src/cost.rs", "src/cost", "src/runs", "scenes"],
    },
    MeasuredReport {
        name: "hard-cases",
        solver: SOLVER,
        own: &["src/hard_cases.rs", "src/hard_cases", "src/runs", "cases"],
    },
    MeasuredReport {
        name: "locking",
        solver: SOLVER,
        own: &["src/locking.rs", "src/locking", "src/runs"],
    },
    MeasuredReport {
        name: "reproduce-figures",
        solver: SOLVER,
        own: &["src/figures.rs", "src/figures", "src/runs", "scenes"],
    },
    MeasuredReport {
        name: "validation",
        solver: SOLVER,
        own: &["src/validation.rs", "src/validation", "src/runs"],
    },
];

/// The folder of the workspace.
pub(crate) fn root() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("..")
}

/// The commit of this working copy, marked where files differ from it.
pub(crate) fn commit() -> String {
    let words = ["describe", "--always", "--abbrev=9", "--dirty"];
    git(&root(), &words).unwrap_or_else(|_| "unknown".to_owned())
}

/// The files of a workspace that the numbers of a report depend on, and that differ from a commit in more
/// than comments.
///
/// # Errors
/// There is no such commit.
pub(crate) fn changed(root: &Path, report: &str, commit: &str) -> Result<Vec<String>> {
    let mut words = vec!["diff", "--name-only", CODE, commit, "--"];
    let of = REPORTS.iter().find(|of| of.name == report);
    let of = of.context("no report writes what it measured by this name")?;
    words.extend(of.solver);
    let own: Vec<String> = of.own.iter().map(|file| format!("xtask/{file}")).collect();
    let beside = BESIDE.map(|pattern| format!(":!{pattern}"));
    words.extend(own.iter().chain(&beside).map(String::as_str));
    let said = git(root, &words)?;
    Ok(said.lines().map(str::to_owned).collect())
}

/// What git says in a folder.
fn git(folder: &Path, words: &[&str]) -> Result<String> {
    let output = Command::new("git")
        .arg("-C")
        .arg(folder)
        .args(words)
        .output()?;
    let said = |bytes: &[u8]| String::from_utf8_lossy(bytes).trim().to_owned();
    ensure!(output.status.success(), "git: {}", said(&output.stderr));
    Ok(said(&output.stdout))
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::fs;

    #[test]
    fn code_and_values_count_and_comments_and_tests_do_not() {
        let folder = tempfile::tempdir().unwrap();
        let root = folder.path();
        let write = |file: &str, text: &str| {
            fs::create_dir_all(root.join(file).parent().unwrap()).unwrap();
            fs::write(root.join(file), text).unwrap();
        };
        let changed = || changed(root, "cost", "HEAD").unwrap();
        let (code, scene) = ("mesh/src/a.rs", "xtask/scenes/a.toml");
        for file in [code, scene, "mesh/src/a/tests.rs", "mesh/README.md"] {
            write(file, "first = 1;\n");
        }
        git(root, &["init", "-q"]).unwrap();
        git(root, &["add", "."]).unwrap();
        let name = ["-c", "user.name=a", "-c", "user.email=a@b.c"];
        git(root, &[&name[..], &["commit", "-qm", "a"]].concat()).unwrap();
        write(code, "//! About.\n\nfirst = 1;\n    // Why.\n");
        write(scene, "# Why.\nfirst = 1;\n");
        write("mesh/src/a/tests.rs", "second\n");
        write("mesh/README.md", "second\n");
        assert!(changed().is_empty(), "{:?}", changed());
        write(code, "#[inline]\nfirst = 1;\n");
        write(scene, "first = 2;\n");
        assert_eq!(changed(), [code, scene]);
    }

    #[test]
    fn a_commit_that_is_not_there_is_an_error() {
        assert!(changed(&root(), "cost", "v0.0.0-dirty").is_err());
    }
}
