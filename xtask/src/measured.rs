//! `measured`: what the reports have measured becomes the numbers of the book and of the README.
//!
//! The book includes the files in `docs/measured` part by part. The README cannot include: it has blocks
//! between `<!-- measured: REPORT PART -->` and `<!-- /measured -->`, which are copies of such parts.

use crate::failure::ReportError;
use crate::progress;
use crate::report::excerpt;
use anyhow::{Context, Result};
use clap::Args;
use isosheet_io::write_atomically;
use std::fs;
use std::io::Write;
use std::path::{Path, PathBuf};

/// The reports that write what they measured.
const REPORTS: [&str; 6] = [
    "condition-table",
    "cost",
    "hard-cases",
    "locking",
    "reproduce-figures",
    "tuning",
];

/// Arguments of `measured`.
#[derive(Debug, Args)]
pub(crate) struct MeasuredArgs {
    /// Folder with the output folders of the reports
    #[arg(long, value_name = "DIR", default_value = "out")]
    from: PathBuf,
}

/// Runs the command.
pub(crate) fn run(args: &MeasuredArgs) -> Result<()> {
    let root = Path::new(env!("CARGO_MANIFEST_DIR")).join("..");
    let book = root.join("docs/measured");
    for report in REPORTS {
        let from = args.from.join(report).join(excerpt::FILE);
        if from.is_file() {
            replace(&of_report(&book, report), &read(&from)?)?;
            progress::note(report, "copied");
        }
    }
    let readme = root.join("README.md");
    let text = filled(&read(&readme)?, &|report, part| {
        measured(&book, report, part)
    })?;
    replace(&readme, &text)
}

/// The file of a report in the book.
fn of_report(book: &Path, report: &str) -> PathBuf {
    book.join(format!("{report}.md"))
}

/// A part of the file of a report in the book.
fn measured(book: &Path, report: &str, part: &str) -> Result<String> {
    let file = of_report(book, report);
    let text = read(&file)?;
    let found = excerpt::part(&text, part).map(str::to_owned);
    let part = part.to_owned();
    Ok(found.ok_or(ReportError::Part { file, part })?)
}

fn read(path: &Path) -> Result<String> {
    fs::read_to_string(path).with_context(|| format!("{} cannot be read", path.display()))
}

/// Writes a file in one piece.
fn replace(path: &Path, text: &str) -> Result<()> {
    Ok(write_atomically(path, |w| w.write_all(text.as_bytes()))?)
}

const BEGIN: &str = "<!-- measured: ";
const END: &str = "<!-- /measured -->";

/// A text with its blocks filled, each with the part that its first line names.
fn filled(text: &str, part: &dyn Fn(&str, &str) -> Result<String>) -> Result<String> {
    let mut out = String::new();
    let mut lines = text.lines();
    while let Some(line) = lines.next() {
        out += line;
        out.push('\n');
        let named = line
            .strip_prefix(BEGIN)
            .and_then(|l| l.strip_suffix(" -->"));
        if let Some((report, name)) = named.and_then(|n| n.split_once(' ')) {
            out += &format!("{}\n{END}\n", part(report, name)?);
            lines.by_ref().find(|l| *l == END);
        }
    }
    Ok(out)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn docs() -> PathBuf {
        Path::new(env!("CARGO_MANIFEST_DIR")).join("../docs")
    }

    #[test]
    fn blocks_are_filled_and_the_rest_is_kept() {
        let text = "a\n<!-- measured: cost steps -->\nold\nolder\n<!-- /measured -->\nb\n";
        let part = |report: &str, name: &str| Ok(format!("{report}, {name}\nnew"));
        let new = filled(text, &part).unwrap();
        let expected =
            "a\n<!-- measured: cost steps -->\ncost, steps\nnew\n<!-- /measured -->\nb\n";
        assert_eq!(new, expected);
        assert_eq!(filled(&new, &part).unwrap(), new);
    }

    /// The numbers of the README are those that the reports wrote.
    #[test]
    fn the_readme_has_what_was_measured() {
        let readme = read(&docs().join("../README.md")).unwrap();
        assert!(readme.contains(BEGIN), "a block");
        let part = |report: &str, name: &str| measured(&docs().join("measured"), report, name);
        let new = filled(&readme, &part).unwrap();
        assert!(new == readme, "`cargo xtask measured` changes README.md");
    }

    /// What the book includes exists, parts of files and whole ones.
    #[test]
    fn the_book_includes_parts_that_exist() {
        let mut found = 0;
        for entry in fs::read_dir(docs()).unwrap() {
            let path = entry.unwrap().path();
            if path.extension().is_none_or(|e| e != "md") {
                continue;
            }
            for include in read(&path).unwrap().split("{{#include ").skip(1) {
                let include = include.split("}}").next().unwrap();
                let (file, name) = match include.split_once(':') {
                    Some((file, name)) => (file, Some(name)),
                    None => (include, None),
                };
                let text = read(&docs().join(file)).unwrap();
                let is_there = name.is_none_or(|name| excerpt::part(&text, name).is_some());
                assert!(is_there, "{}: {include}", path.display());
                found += 1;
            }
        }
        assert!(found > 5, "{found} parts are included");
    }

    /// Every file in the folder says where its numbers are from, and is a page of the book.
    #[test]
    fn measured_files_name_their_origin() {
        let contents = read(&docs().join("SUMMARY.md")).unwrap();
        let book = docs().join("measured");
        for report in REPORTS.iter().filter(|r| of_report(&book, r).exists()) {
            let origin = measured(&book, report, "origin").unwrap();
            assert!(
                origin.contains(" commit ") && origin.contains(report),
                "{origin}"
            );
            assert!(
                contents.contains(&format!("(measured/{report}.md)")),
                "{report}"
            );
        }
    }
}
