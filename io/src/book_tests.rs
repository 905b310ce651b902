//! The lines of shell in the hand-written pages are command lines that the parser takes.

use super::Cli;
use clap::{CommandFactory, Parser};
use std::fs;
use std::path::Path;

/// The command lines of a page: in blocks of shell what begins with `isosheet`, up to the end of the command.
fn lines(page: &str) -> Vec<String> {
    let blocks = page.split("```sh\n").skip(1);
    let blocks = blocks.map(|b| b.split("```").next().unwrap_or_default());
    let lines = blocks.flat_map(str::lines);
    let commands = lines.filter_map(|l| {
        let at = l
            .find("isosheet ")
            .filter(|&k| k == 0 || l[..k].ends_with(' '))?;
        let whole = !l[..at].contains("cargo");
        whole.then(|| {
            let command = l[at..].split([';', '#', '|', '>']).next();
            with_first_value(&l[..at], command.unwrap_or_default())
        })
    });
    commands.collect()
}

/// A command line with the first value of the variable of the loop that it is in: `for d in 1 2; do ...`.
fn with_first_value(before: &str, command: &str) -> String {
    let list = before
        .strip_prefix("for ")
        .and_then(|l| l.split_once(" in "));
    let first = list.and_then(|(name, values)| Some((name, values.split([' ', ';']).next()?)));
    match first {
        Some((name, value)) => command.replace(&format!("${name}"), value),
        None => command.to_owned(),
    }
}

/// The words of a command line; single quotes keep blanks together.
fn words(line: &str) -> Vec<String> {
    let (mut words, mut quoted) = (vec![String::new()], false);
    for c in line.chars() {
        match c {
            '\'' => quoted = !quoted,
            ' ' if !quoted => words.push(String::new()),
            c => words.last_mut().expect("never empty").push(c),
        }
    }
    words.retain(|w| !w.is_empty());
    words
}

#[test]
fn the_commands_of_the_book_are_known() {
    let root = Path::new(env!("CARGO_MANIFEST_DIR")).join("..");
    let entries = ["docs", "docs/scene"]
        .into_iter()
        .flat_map(|name| fs::read_dir(root.join(name)).expect("a folder of the book"));
    let paths = entries.map(|e| e.expect("an entry").path());
    let pages = paths.filter(|p| p.extension().is_some_and(|e| e == "md"));
    let mut known = 0;
    for path in pages.chain([root.join("README.md")]) {
        let page = fs::read_to_string(&path).expect("a page");
        for line in lines(&page) {
            let words = words(&line);
            if let Err(error) = Cli::try_parse_from(&words) {
                panic!("{}: {line}\n{error}", path.display());
            }
            known += 1;
        }
    }
    assert!(known > 15, "{known} lines were found");
}

/// The command lines of the examples of a help text, without what follows them behind two or more blanks.
fn examples(help: &str) -> Vec<String> {
    let commands = help.lines().filter_map(|line| {
        let line = line.strip_prefix("  ")?;
        let command = line.split("  ").next()?;
        let command = command.split(['|', '>']).next()?;
        command
            .starts_with("isosheet ")
            .then(|| command.trim().to_owned())
    });
    commands.collect()
}

/// Every help text begins with examples, and the parser takes all of them. The completion script and what
/// `--help` does not show have none.
#[test]
fn help_begins_with_examples_that_are_known() {
    let mut cli = Cli::command();
    let shown: Vec<String> = cli
        .get_subcommands()
        .filter(|c| !c.is_hide_set() && c.get_name() != "completions")
        .map(|c| c.get_name().to_owned())
        .collect();
    assert!(shown.len() >= 10 && !shown.iter().any(|name| name == "reference"));
    for name in &shown {
        let command = cli.find_subcommand_mut(name).expect("a subcommand");
        let help = command.render_long_help().to_string();
        assert!(help.starts_with("Examples:\n"), "{help}");
        let examples = examples(&help);
        let of_command = examples.iter().filter(|e| e.contains(name.as_str()));
        assert!(of_command.count() > 0, "{help}");
    }
    let all = shown.iter().map(|name| {
        let command = cli.find_subcommand_mut(name).expect("a subcommand");
        command.render_long_help().to_string()
    });
    let all: Vec<String> = all.collect();
    let whole = cli.render_long_help().to_string();
    assert!(whole.starts_with("Examples:\n"), "{whole}");
    for line in all.iter().chain([&whole]).flat_map(|help| examples(help)) {
        if let Err(error) = Cli::try_parse_from(words(&line)) {
            panic!("{line}\n{error}");
        }
    }
}
