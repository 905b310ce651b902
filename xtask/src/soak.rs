//! `soak`: the random tests with new seeds, which `cargo test` never draws.

use crate::failure::ReportError;
use crate::{interrupt, progress};
use anyhow::{Context, Result, ensure};
use clap::Args;
use std::fs;
use std::num::{NonZeroU32, NonZeroU64};
use std::path::Path;
use std::process::Command;

/// Arguments of `soak`.
#[derive(Debug, Args)]
pub(crate) struct SoakArgs {
    /// How many seeds
    #[arg(long, value_name = "N", default_value = "10")]
    seeds: NonZeroU64,

    /// The first seed; the others follow it. Drawn by chance where it is not given
    #[arg(long, value_name = "SEED")]
    from: Option<u64>,

    /// How many times as many cases as in `cargo test` each test tries with each seed
    #[arg(long, value_name = "N", default_value = "4")]
    times: NonZeroU32,
}

/// Runs the command.
pub(crate) fn run(args: &SoakArgs) -> Result<()> {
    let root = Path::new(env!("CARGO_MANIFEST_DIR")).join("..");
    let tests = random_tests(&root)?;
    // (Seeds that people can type.)
    let first = args
        .from
        .unwrap_or_else(|| u64::from(rand::random::<u32>()));
    let mut failed = Vec::new();
    for seed in first..first + args.seeds.get() {
        interrupt::check()?;
        let passes = Command::new(env!("CARGO"))
            .args(["test", "--workspace", "--quiet", "--no-fail-fast", "--"])
            .args(&tests)
            .current_dir(&root)
            .env(isosheet_random::SEED, seed.to_string())
            .env(isosheet_random::TIMES, args.times.to_string())
            .status()
            .context("cargo cannot be started")?
            .success();
        progress::note(
            &format!("seed {seed}"),
            if passes { "passed" } else { "failed" },
        );
        if !passes {
            failed.push(seed.to_string());
        }
    }
    ensure!(
        failed.is_empty(),
        ReportError::Seeds {
            seeds: failed.join(", ")
        }
    );
    Ok(())
}

/// The names of the tests of the workspace that draw random cases by `isosheet_random`.
fn random_tests(root: &Path) -> Result<Vec<String>> {
    let mut names = Vec::new();
    for folder in ["mesh", "coords", "dynamics", "collide", "io", "tests"] {
        add_tests_below(&root.join(folder), &mut names)?;
    }
    names.sort();
    names.dedup();
    Ok(names)
}

fn add_tests_below(folder: &Path, names: &mut Vec<String>) -> Result<()> {
    let name = || format!("cannot read {}", folder.display());
    for entry in fs::read_dir(folder).with_context(name)? {
        let path = entry?.path();
        if path.is_dir() {
            add_tests_below(&path, names)?;
        } else if path.extension().is_some_and(|extension| extension == "rs") {
            add_tests(&fs::read_to_string(&path).with_context(name)?, names);
        }
    }
    Ok(())
}

/// Adds the functions with the attribute `test` that name `isosheet_random` in their bodies, or stand in a block
/// of `proptest!` that names it: both end where a line begins with a brace that closes a block of the same
/// indentation.
fn add_tests(text: &str, names: &mut Vec<String>) {
    let indentation = |line: &str| line.len() - line.trim_start().len();
    // The indentation of the block of `proptest!`, and the test with that of its function.
    let (mut block, mut is_test, mut test) = (None, false, None::<(String, usize)>);
    for line in text.lines() {
        let (code, indent) = (line.trim(), indentation(line));
        if code.starts_with("proptest! {") {
            block = Some(indent);
        } else if code == "#[test]" {
            is_test = true;
        } else if let Some(rest) = code.strip_prefix("fn ").filter(|_| is_test) {
            let name = rest.split('(').next().unwrap_or_default();
            (is_test, test) = (false, Some((name.to_owned(), indent)));
        }
        let is_random = block.is_some() || code.contains("isosheet_random::");
        if let Some((name, _)) = test.take_if(|_| is_random) {
            names.push(name);
        }
        if code == "}" {
            block = block.filter(|of| *of != indent);
            test = test.filter(|(_, of)| *of != indent);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn random_tests_are_found_by_what_they_name() {
        let text = "
#[test]
fn always() {
    assert!(true);
}

#[test]
fn by_a_runner() {
    run(isosheet_random::cases(10));
}

fn helper() {
    isosheet_random::seed();
}

mod tests {
    proptest! {
        #![proptest_config(isosheet_random::cases(24))]
        /// Says something.
        #[test]
        fn by_proptest(x in 0..1) {
            prop_assert!(x == 0);
        }
    }

    #[test]
    fn at_last() {}
}";
        let mut names = Vec::new();
        add_tests(text, &mut names);
        assert_eq!(names, ["by_a_runner", "by_proptest"]);
    }

    /// Every test of proptest draws its cases by `isosheet_random`.
    #[test]
    fn no_test_draws_seeds_by_itself() {
        let root = Path::new(env!("CARGO_MANIFEST_DIR")).join("..");
        let names = random_tests(&root).unwrap();
        assert!(names.len() > 40, "{}", names.len());
        let mut without = Vec::new();
        for folder in ["mesh", "coords", "dynamics", "collide", "io", "tests"] {
            find_own_seeds(&root.join(folder), &mut without);
        }
        assert!(without.is_empty(), "{without:?}");
    }

    /// The files below a folder with a `proptest!` of another configuration.
    fn find_own_seeds(folder: &Path, found: &mut Vec<String>) {
        for entry in fs::read_dir(folder).unwrap() {
            let path = entry.unwrap().path();
            if path.is_dir() {
                find_own_seeds(&path, found);
            } else if path.extension().is_some_and(|extension| extension == "rs") {
                let text = fs::read_to_string(&path).unwrap();
                let count = |what: &str| text.matches(what).count();
                if count("proptest! {") != count("#![proptest_config(isosheet_random::cases(")
                    || text.contains("TestRunner::") && !text.contains("isosheet_random::")
                {
                    found.push(path.display().to_string());
                }
            }
        }
    }
}
