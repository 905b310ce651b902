//! `soak`: the random tests with new seeds, which `cargo test` never draws.

use crate::failure::ReportError;
use crate::{interrupt, progress};
use anyhow::{Context, Result, ensure};
use clap::Args;
use std::collections::BTreeSet;
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

/// The names of the tests in files that draw random cases by `isosheet_random`.
fn random_tests(root: &Path) -> Result<BTreeSet<String>> {
    let mut names = BTreeSet::new();
    for folder in ["mesh", "coords", "dynamics", "collide", "io", "tests"] {
        for_each_file(&root.join(folder), &mut |_, text| {
            if text.contains("isosheet_random::") {
                let tests = text.split("#[test]").skip(1);
                let name =
                    |test: &str| Some(test.split_once("fn ")?.1.split_once('(')?.0.to_owned());
                names.extend(tests.filter_map(name));
            }
        })?;
    }
    Ok(names)
}

/// Visits the files of Rust in and beneath a folder.
fn for_each_file(folder: &Path, visit: &mut impl FnMut(&Path, &str)) -> Result<()> {
    let name = || format!("cannot read {}", folder.display());
    for entry in fs::read_dir(folder).with_context(name)? {
        let path = entry?.path();
        if path.is_dir() {
            for_each_file(&path, visit)?;
        } else if path.extension().is_some_and(|extension| extension == "rs") {
            visit(&path, &fs::read_to_string(&path).with_context(name)?);
        }
    }
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Every test of proptest draws its cases by `isosheet_random`, so that its seeds are changed.
    #[test]
    fn no_test_draws_seeds_by_itself() {
        let root = Path::new(env!("CARGO_MANIFEST_DIR")).join("..");
        assert!(random_tests(&root).unwrap().len() > 40);
        for folder in ["mesh", "coords", "dynamics", "collide", "io", "tests"] {
            let check = &mut |path: &Path, text: &str| {
                let count = |what: &str| text.matches(what).count();
                let configured = count("#![proptest_config(isosheet_random::cases(");
                let is_random = text.contains("isosheet_random::");
                assert_eq!(count("proptest! {"), configured, "{}", path.display());
                assert!(
                    is_random || !text.contains("TestRunner::"),
                    "{}",
                    path.display()
                );
            };
            for_each_file(&root.join(folder), check).unwrap();
        }
    }
}
