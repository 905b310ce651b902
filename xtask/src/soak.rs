//! `soak`: the random tests with new seeds, which `cargo test` never draws.

use crate::failure::ReportError;
use crate::{interrupt, progress};
use anyhow::{Context, Result, ensure};
use clap::Args;
use proc_macro2::{Delimiter, TokenStream, TokenTree};
use std::fs;
use std::num::{NonZeroU32, NonZeroU64};
use std::path::Path;
use std::process::Command;
use std::str::FromStr;

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
    let entries =
        fs::read_dir(folder).with_context(|| format!("cannot read {}", folder.display()))?;
    for entry in entries {
        let path = entry?.path();
        if path.is_dir() {
            add_tests_below(&path, names)?;
        } else if path.extension().is_some_and(|extension| extension == "rs") {
            let text = fs::read_to_string(&path)
                .with_context(|| format!("cannot read {}", path.display()))?;
            if text.contains("isosheet_random::") {
                let tokens = TokenStream::from_str(&text)
                    .map_err(|error| anyhow::anyhow!("{}: {error}", path.display()))?;
                add_tests(tokens, false, names);
            }
        }
    }
    Ok(())
}

/// Adds the functions with the attribute `test` that name `isosheet_random` in their bodies, or stand in a
/// macro that names it.
fn add_tests(tokens: TokenStream, is_random: bool, names: &mut Vec<String>) {
    let tokens: Vec<TokenTree> = tokens.into_iter().collect();
    let (mut is_test, mut name) = (false, None);
    for (k, token) in tokens.iter().enumerate() {
        match token {
            TokenTree::Ident(word) if word == "fn" => {
                name = tokens.get(k + 1).map(TokenTree::to_string);
            }
            TokenTree::Group(group) if group.delimiter() == Delimiter::Bracket => {
                is_test |= group.stream().to_string() == "test";
            }
            TokenTree::Group(group) if group.delimiter() == Delimiter::Brace => {
                let body = group.stream();
                let is_named = body.to_string().contains("isosheet_random ::");
                match name.take() {
                    Some(name) if is_test && (is_random || is_named) => names.push(name),
                    Some(_) => {}
                    // A module, or the tests of `proptest!`.
                    None => {
                        let is_macro = matches!(
                            k.checked_sub(1).map(|before| &tokens[before]),
                            Some(TokenTree::Punct(mark)) if mark.as_char() == '!'
                        );
                        add_tests(body, is_macro && is_named, names);
                    }
                }
                is_test = false;
            }
            _ => {}
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn random_tests_are_found_by_what_they_name() {
        let text = "
            #[test] fn always() { assert!(true); }
            #[test] fn by_a_runner() { run(isosheet_random::cases(10)); }
            fn helper() { isosheet_random::seed(); }
            mod tests {
                proptest! {
                    #![proptest_config(isosheet_random::cases(24))]
                    /// Says something.
                    #[test]
                    fn by_proptest(x in 0..1) { prop_assert!(x == 0); }
                }
            }";
        let mut names = Vec::new();
        add_tests(TokenStream::from_str(text).unwrap(), false, &mut names);
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
