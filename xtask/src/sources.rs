//! The fingerprint of the sources that the numbers of a report depend on: those of the solver and of the
//! report.
//!
//! It is a checksum of the lines of code and of scenes, without indentation, lines of comments and documentation,
//! tests and pages of text: those may change without making a number out of date. Tests stand at the end of a file
//! or in files and folders of their own, `tests` or `..._tests`. Versions of dependencies and of the compiler are
//! not part of it.

use anyhow::{Context, Result};
use crc::{CRC_64_XZ, Crc};
use std::fs;
use std::path::{Path, PathBuf};
use std::process::Command;

/// The charts: what a bent sheet's coordinates are.
const CHARTS: &[&str] = &["mesh/src", "coords/src", "coords/linalg/src"];

/// The crates of the solver, how scenes become simulations, and the mechanical problems.
const SOLVER: &[&str] = &[
    "mesh/src",
    "coords/src",
    "coords/linalg/src",
    "dynamics/motion/src",
    "dynamics/materials/src",
    "dynamics/model/src",
    "dynamics/src",
    "dynamics/attached-flow/src",
    "dynamics/charts/src",
    "collide/geometry/src",
    "collide/src",
    "io/scenes/src",
    "tests/models",
];

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

/// The state of a working copy.
#[derive(Clone, Debug)]
pub(crate) struct Origin {
    /// The commit, marked where files differ from it.
    pub(crate) commit: String,
    /// The fingerprint of a report's sources.
    pub(crate) sources: String,
}

impl Origin {
    /// The state of this working copy, for a report.
    pub(crate) fn here(report: &str) -> Result<Self> {
        Ok(Self {
            commit: commit(),
            sources: fingerprint(&root(), report)?,
        })
    }
}

/// The folder of the workspace.
pub(crate) fn root() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("..")
}

fn commit() -> String {
    let mut git = Command::new("git");
    git.arg("-C").arg(root());
    git.args(["describe", "--always", "--abbrev=9", "--dirty"]);
    let said = git.output().ok().filter(|o| o.status.success());
    let name = said.map(|o| String::from_utf8_lossy(&o.stdout).trim().to_owned());
    name.unwrap_or_else(|| "unknown".to_owned())
}

/// The fingerprint of the sources in a workspace that the numbers of a report depend on.
pub(crate) fn fingerprint(root: &Path, report: &str) -> Result<String> {
    let mut files = Vec::new();
    for of in REPORTS.iter().filter(|of| of.name == report) {
        let own = of.own.iter().map(|file| Path::new("xtask").join(file));
        for file in of.solver.iter().map(PathBuf::from).chain(own) {
            collect(&root.join(file), &mut files)?;
        }
    }
    files.sort();
    let crc = Crc::<u64>::new(&CRC_64_XZ);
    let mut digest = crc.digest();
    for path in files {
        let text = fs::read_to_string(&path).with_context(|| path.display().to_string())?;
        let is_code = path.extension().is_some_and(|e| e == "rs");
        let mark = if is_code { "//" } else { "#" };
        let lines = text.lines().map(str::trim);
        let lines = lines.take_while(|line| !is_code || *line != "#[cfg(test)]");
        for line in lines.filter(|line| !line.is_empty() && !line.starts_with(mark)) {
            digest.update(line.as_bytes());
        }
    }
    Ok(format!("{:016x}", digest.finalize()))
}

/// Whether a file or a folder has tests alone, or text for people.
fn is_beside(path: &Path) -> bool {
    let name = path.file_name().and_then(|name| name.to_str());
    let name = name.unwrap_or_default();
    let stem = name.trim_end_matches(".rs");
    stem == "tests" || stem.ends_with("_tests") || name.ends_with(".md")
}

/// The files in and beneath a folder, or a file.
fn collect(path: &Path, files: &mut Vec<PathBuf>) -> Result<()> {
    let name = || path.display().to_string();
    if path.is_dir() {
        for entry in fs::read_dir(path).with_context(name)? {
            let path = entry?.path();
            if !is_beside(&path) {
                collect(&path, files)?;
            }
        }
    } else {
        files.push(path.to_owned());
    }
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The fingerprint of a workspace in which the file of a report says `code` and a scene `values`.
    fn of(code: &str, values: &str) -> String {
        let root = tempfile::tempdir().unwrap();
        for folder in SOLVER {
            fs::create_dir_all(root.path().join(folder)).unwrap();
        }
        let xtask = root.path().join("xtask");
        for folder in ["src/runs", "src/figures", "scenes"] {
            fs::create_dir_all(xtask.join(folder)).unwrap();
        }
        fs::write(xtask.join("src/figures.rs"), code).unwrap();
        fs::write(xtask.join("scenes/a.toml"), values).unwrap();
        fs::write(root.path().join("mesh/src/b.rs"), code).unwrap();
        // They would change with the code if they counted.
        for folder in ["tests", "b_tests"] {
            fs::create_dir(root.path().join("mesh/src").join(folder)).unwrap();
        }
        for file in [
            "tests.rs",
            "b_tests.rs",
            "tests/more.rs",
            "b_tests/more.rs",
            "NOTES.md",
        ] {
            let length = format!("const LENGTH: usize = {};", code.len());
            fs::write(root.path().join("mesh/src").join(file), length).unwrap();
        }
        fingerprint(root.path(), "reproduce-figures").unwrap()
    }

    #[test]
    fn comments_documentation_and_tests_do_not_count() {
        let before = of("fn a() -> f64 {\n1.0\n}", "a = 1");
        let same = "//! About.\n\n/// More.\nfn a() -> f64 {\n    // Why.\n    1.0\n}\n\n\
            #[cfg(test)]\nmod tests {\n    fn b() {}\n}\n";
        assert_eq!(of(same, "# Why.\na = 1\n"), before);
    }

    #[test]
    fn code_attributes_and_values_count() {
        let before = of("fn a() -> f64 { 1.0 }", "a = 1");
        for code in [
            "fn a() -> f64 { 1.5 }",
            "#[inline] fn a() -> f64 { 1.0 }",
            "fn a() -> f64 { 1.0 } fn b() {}",
        ] {
            assert_ne!(of(code, "a = 1"), before, "{code}");
        }
        assert_ne!(of("fn a() -> f64 { 1.0 }", "a = 2"), before);
    }

    #[test]
    fn every_report_has_sources() {
        let all: std::collections::BTreeSet<_> = REPORTS
            .iter()
            .map(|report| fingerprint(&root(), report.name).unwrap())
            .collect();
        assert_eq!(all.len(), REPORTS.len());
        assert!(!commit().is_empty());
    }
}
