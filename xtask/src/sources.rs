//! The fingerprint of the sources that the numbers of a report depend on: those of the solver and of the
//! report.
//!
//! It is a checksum of what is compiled: the tokens of Rust files without comments, documentation and tests,
//! and the values of TOML files. Other text than that may change without making a number out of date.
//! Versions of dependencies and of the compiler are not part of it.

use anyhow::{Context, Result, anyhow};
use crc::{CRC_64_XZ, Crc};
use proc_macro2::{Delimiter, LexError, TokenStream, TokenTree};
use std::collections::{BTreeMap, BTreeSet};
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
    "dynamics/src",
    "collide/src",
    "io/src/scene",
    "tests/models",
];

/// A report that writes what it measured, with its sources.
#[derive(Debug)]
pub(crate) struct Report {
    pub(crate) name: &'static str,
    /// Files and folders of other crates.
    solver: &'static [&'static str],
    /// Files and folders in `xtask`.
    own: &'static [&'static str],
}

/// All of them.
pub(crate) const REPORTS: [Report; 6] = [
    Report {
        name: "condition-table",
        solver: CHARTS,
        own: &["src/condition.rs"],
    },
    Report {
        name: "cost",
        solver: SOLVER,
        own: &["src/cost.rs", "src/cost", "src/runs", "scenes"],
    },
    Report {
        name: "hard-cases",
        solver: SOLVER,
        own: &["src/hard_cases.rs", "src/hard_cases", "src/runs", "cases"],
    },
    Report {
        name: "locking",
        solver: SOLVER,
        own: &["src/locking.rs", "src/locking", "src/runs"],
    },
    Report {
        name: "reproduce-figures",
        solver: SOLVER,
        own: &["src/figures.rs", "src/figures", "src/runs", "scenes"],
    },
    Report {
        name: "tuning",
        solver: SOLVER,
        own: &["src/tuning.rs", "src/runs", "scenes"],
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
    /// That of this working copy, for a report.
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
    let mut files = BTreeMap::new();
    for of in REPORTS.iter().filter(|of| of.name == report) {
        let own = of.own.iter().map(|file| Path::new("xtask").join(file));
        for file in of.solver.iter().map(PathBuf::from).chain(own) {
            collect(&root.join(file), &mut files)?;
        }
    }
    let mut text = BTreeMap::new();
    let mut tests = BTreeSet::new();
    for (path, bytes) in files {
        let of_file = match path.extension().and_then(|e| e.to_str()) {
            Some("md") => continue,
            Some("rs") => {
                let code = String::from_utf8(bytes).map_err(anyhow::Error::from);
                let code = code.and_then(|code| code.parse().map_err(|e: LexError| anyhow!("{e}")));
                let mut tokens = Tokens::default();
                tokens.add(code.with_context(|| path.display().to_string())?);
                tests.extend(tokens.tests.iter().map(|name| beneath(&path).join(name)));
                tokens.text.into_bytes()
            }
            Some("toml") => match toml::from_slice::<toml::Table>(&bytes) {
                Ok(values) => values.to_string().into_bytes(),
                // A scene that is wrong on purpose.
                Err(_) => bytes,
            },
            _ => bytes,
        };
        text.insert(path, of_file);
    }
    let is_test = |path: &Path| {
        path.ancestors()
            .any(|p| tests.contains(&p.with_extension("")))
    };
    let crc = Crc::<u64>::new(&CRC_64_XZ);
    let mut digest = crc.digest();
    for (_, text) in text.iter().filter(|(path, _)| !is_test(path)) {
        digest.update(text);
    }
    Ok(format!("{:016x}", digest.finalize()))
}

/// The files in and beneath a folder, or a file, in the order of their paths.
fn collect(path: &Path, files: &mut BTreeMap<PathBuf, Vec<u8>>) -> Result<()> {
    let name = || path.display().to_string();
    if path.is_dir() {
        for entry in fs::read_dir(path).with_context(name)? {
            collect(&entry?.path(), files)?;
        }
    } else {
        files.insert(path.to_owned(), fs::read(path).with_context(name)?);
    }
    Ok(())
}

/// The folder of the modules that a file declares.
fn beneath(file: &Path) -> PathBuf {
    match file.file_stem().and_then(|name| name.to_str()) {
        Some("lib" | "main" | "mod") => file.with_file_name(""),
        _ => file.with_extension(""),
    }
}

/// What is compiled of a file.
#[derive(Debug, Default)]
struct Tokens {
    text: String,
    /// Modules in files of their own that are compiled for tests alone.
    tests: Vec<String>,
}

impl Tokens {
    /// Adds tokens without comments and documentation, and without items that are compiled for tests alone.
    fn add(&mut self, tokens: TokenStream) {
        let mut tokens = tokens.into_iter().peekable();
        while let Some(token) = tokens.next() {
            match token {
                TokenTree::Punct(mark) if mark.as_char() == '#' => {
                    let inner = tokens.next_if(|t| t.to_string() == "!");
                    let attribute = tokens.next_if(|t| matches!(t, TokenTree::Group(_)));
                    let attribute = attribute.map(|a| a.to_string().replace(' ', ""));
                    match attribute.as_deref() {
                        Some("[cfg(test)]") => self.tests.extend(skip_item(&mut tokens)),
                        Some(text) if text.starts_with("[doc") => {}
                        other => {
                            self.text.push('#');
                            self.text.extend(inner.map(|_| '!'));
                            self.text.extend(other);
                        }
                    }
                }
                TokenTree::Group(group) => {
                    let [open, close] = match group.delimiter() {
                        Delimiter::Parenthesis => ["(", ")"],
                        Delimiter::Brace => ["{", "}"],
                        Delimiter::Bracket => ["[", "]"],
                        Delimiter::None => ["", ""],
                    };
                    self.text += open;
                    self.add(group.stream());
                    self.text += close;
                }
                other => {
                    self.text += &other.to_string();
                    self.text.push(' ');
                }
            }
        }
    }
}

/// Passes over an item, which ends with a semicolon or a block. Returns the name of a module in a file of its
/// own.
fn skip_item(tokens: &mut impl Iterator<Item = TokenTree>) -> Option<String> {
    let mut words = Vec::new();
    for token in tokens {
        match token {
            TokenTree::Group(group) if group.delimiter() == Delimiter::Brace => return None,
            TokenTree::Punct(mark) if mark.as_char() == ';' => break,
            TokenTree::Ident(word) => words.push(word.to_string()),
            _ => {}
        }
    }
    let name = words.pop();
    name.filter(|_| words.last().is_some_and(|word| word == "mod"))
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
        for folder in ["src/runs", "src/tuning", "scenes"] {
            fs::create_dir_all(xtask.join(folder)).unwrap();
        }
        fs::write(xtask.join("src/tuning.rs"), code).unwrap();
        fs::write(xtask.join("scenes/a.toml"), values).unwrap();
        fs::write(
            root.path().join("mesh/src/lib.rs"),
            "#[cfg(test)] pub(crate) mod probes;\nmod b;",
        )
        .unwrap();
        fs::write(root.path().join("mesh/src/b.rs"), code).unwrap();
        // It would change with the code if it counted.
        fs::create_dir(root.path().join("mesh/src/probes")).unwrap();
        for file in ["probes.rs", "probes/more.rs"] {
            let code = format!("const LENGTH: usize = {};", code.len());
            fs::write(root.path().join("mesh/src").join(file), code).unwrap();
        }
        fingerprint(root.path(), "tuning").unwrap()
    }

    #[test]
    fn comments_documentation_and_tests_do_not_count() {
        let before = of("fn a() -> f64 { 1.0 }", "a = 1");
        let same = "//! About.\n\n/// More.\nfn a() -> f64 {\n    // Why.\n    1.0\n}\n\n\
            #[cfg(test)]\nmod tests {\n    fn b() {}\n}\n#[cfg(test)]\nmod others;";
        assert_eq!(of(same, "# Why.\na = 1 # kg\n"), before);
    }

    #[test]
    fn code_attributes_and_values_count() {
        let before = of("fn a() -> f64 { 1.0 }", "a = 1");
        for code in [
            "fn a() -> f64 { 1.5 }",
            "fn a() -> f64 { -1.0 }",
            "#[inline] fn a() -> f64 { 1.0 }",
            "fn a() -> f64 { 1.0 } fn b() {}",
            "fn a() -> f64 { 1.0 } #[cfg(test)] mod tests {} fn b() {}",
            "fn a() -> f64 { [1.0] }",
        ] {
            assert_ne!(of(code, "a = 1"), before, "{code}");
        }
        assert_ne!(of("fn a() -> f64 { 1.0 }", "a = 2"), before);
    }

    #[test]
    fn every_report_has_sources() {
        let all: BTreeSet<_> = REPORTS
            .iter()
            .map(|report| fingerprint(&root(), report.name).unwrap())
            .collect();
        assert_eq!(all.len(), REPORTS.len());
        assert!(!commit().is_empty());
    }
}
