//! `measured`: what the reports have measured becomes the numbers of the book and of the README.
//!
//! The README and the pages of the book have blocks between `<!-- measured: REPORT PART -->` and
//! `<!-- /measured -->`: copies of the parts of the files in `docs/measured`, or, with
//! `REPORT origin of PART`, of what is said there about how they were measured.

use crate::progress;
use crate::report::excerpt::{self, Measurement, comment};
use crate::sources::{REPORTS, changed, root};
use anyhow::{Context, Result, ensure};
use clap::Args;
use isosheet_files::write_atomically;
use std::fs;
use std::io::Write;
use std::path::{Path, PathBuf};

/// Arguments of `measured`.
#[derive(Debug, Args)]
pub(crate) struct MeasuredArgs {
    /// Folder with the output folders of the reports
    #[arg(long, value_name = "DIR", default_value = "out")]
    from: PathBuf,

    /// Copy nothing, and list the parts whose sources have changed since they were measured
    ///
    /// The exit code is 0 if there are none. Sources are the code of the solver and of the report without
    /// comments and files of tests, and the scenes of the report.
    #[arg(long, conflicts_with = "from")]
    check: bool,
}

/// Runs the command.
pub(crate) fn run(args: &MeasuredArgs) -> Result<()> {
    let root = root();
    let book = root.join("docs/measured");
    if args.check {
        return check(&book);
    }
    for report in REPORTS.map(|report| report.name) {
        let from = args.from.join(report).join(excerpt::FILE);
        if from.is_file() {
            let file = of_report(&book, report);
            let old = if file.is_file() {
                measurements(&file)?
            } else {
                Vec::new()
            };
            let all = excerpt::merged(old, measurements(&from)?);
            replace(&file, &excerpt::to_markdown(report, &all))?;
            progress::note(report, "copied");
        }
    }
    let mut texts = Vec::new();
    for page in pages(&root)? {
        let text = filled(&read(&page)?, &|words| measured(&book, words))?;
        texts.push((page, text));
    }
    // Nothing is written if a part is missing.
    texts
        .iter()
        .try_for_each(|(page, text)| replace(page, text))
}

/// Lists what is out of date.
fn check(book: &Path) -> Result<()> {
    let mut names = Vec::new();
    for report in REPORTS.map(|report| report.name) {
        for old in measurements(&of_report(book, report))? {
            let files = changed(&root(), report, old.commit());
            let what = match &files {
                Ok(files) if files.is_empty() => continue,
                Ok(files) => first_of(files),
                Err(error) => error.to_string(),
            };
            let parts: Vec<&str> = old.parts.iter().map(|part| part.name.as_str()).collect();
            println!(
                "{report}: {}\n  {}\n  {what}",
                parts.join(", "),
                old.origin.replace('\n', " ")
            );
            names.push(report);
        }
    }
    names.dedup();
    let all = names.join(", ");
    ensure!(
        names.is_empty(),
        "the sources of these reports have changed since they were measured: {all}; run them, without --quick, and \
         `cargo xtask measured`"
    );
    Ok(())
}

/// The first files that have changed, and how many others have.
fn first_of(files: &[String]) -> String {
    let (shown, others) = files.split_at(files.len().min(3));
    let more = match others.len() {
        0 => String::new(),
        count => format!(" and {count} others"),
    };
    format!("{}{more}", shown.join(", "))
}

/// The README and the pages of the book that are written by hand.
fn pages(root: &Path) -> Result<Vec<PathBuf>> {
    let mut pages = vec![root.join("README.md")];
    for entry in fs::read_dir(root.join("docs"))? {
        pages.push(entry?.path());
    }
    pages.retain(|path| path.extension().is_some_and(|e| e == "md"));
    Ok(pages)
}

/// The file of a report in the book.
fn of_report(book: &Path, report: &str) -> PathBuf {
    book.join(format!("{report}.md"))
}

fn measurements(file: &Path) -> Result<Vec<Measurement>> {
    Ok(excerpt::from_markdown(&read(file)?))
}

/// What belongs into a block with these words: `REPORT PART` or `REPORT origin of PART`.
fn measured(book: &Path, words: &str) -> Result<String> {
    let (report, part) = words.split_once(' ').unwrap_or((words, ""));
    let (name, is_origin) = match part.strip_prefix("origin of ") {
        Some(name) => (name, true),
        None => (part, false),
    };
    let file = of_report(book, report);
    let mut found = None;
    for measurement in measurements(&file)? {
        if let Some(part) = measurement.parts.into_iter().find(|part| part.name == name) {
            found = Some(if is_origin {
                measurement.origin
            } else {
                part.text
            });
        }
    }
    let file = file.display();
    found.with_context(|| {
        format!("{file} has no part called {name}: run the whole report, without --quick")
    })
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

/// A text with its blocks filled, each with what its first line names.
fn filled(text: &str, part: &dyn Fn(&str) -> Result<String>) -> Result<String> {
    let mut out = String::new();
    let mut lines = text.lines();
    while let Some(line) = lines.next() {
        out += line;
        out.push('\n');
        if let Some(words) = comment(line, BEGIN) {
            out += &format!("{}\n{END}\n", part(words)?);
            lines.by_ref().find(|l| *l == END);
        }
    }
    Ok(out)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn book() -> PathBuf {
        root().join("docs/measured")
    }

    #[test]
    fn blocks_are_filled_and_the_rest_is_kept() {
        let text = "a\n<!-- measured: cost steps -->\nold\nolder\n<!-- /measured -->\nb\n";
        let part = |words: &str| Ok(format!("{words}\nnew"));
        let new = filled(text, &part).unwrap();
        let expected = "a\n<!-- measured: cost steps -->\ncost steps\nnew\n<!-- /measured -->\nb\n";
        assert_eq!(new, expected);
        assert_eq!(filled(&new, &part).unwrap(), new);
    }

    #[test]
    fn blocks_name_parts_and_origins_of_parts() {
        let book = tempfile::tempdir().unwrap();
        let of = |name: &str| Measurement {
            origin: format!("Measured with {name}."),
            parts: vec![excerpt::Part::text(name, format!("the {name}"))],
        };
        let text = excerpt::to_markdown("cost", &[of("first"), of("second")]);
        replace(&of_report(book.path(), "cost"), &text).unwrap();
        let named = |words: &str| measured(book.path(), words);
        assert_eq!(named("cost second").unwrap(), "the second");
        assert_eq!(
            named("cost origin of second").unwrap(),
            "Measured with second."
        );
        let error = named("cost third").unwrap_err();
        assert!(error.to_string().contains("no part called third"));
    }

    /// The README and the book have the numbers that the reports wrote, and the numbers stand in the text.
    #[test]
    fn pages_have_what_was_measured() {
        let mut blocks = 0;
        for page in pages(&root()).unwrap() {
            let text = read(&page).unwrap();
            let new = filled(&text, &|words| measured(&book(), words)).unwrap();
            assert!(
                new == text,
                "`cargo xtask measured` changes {}",
                page.display()
            );
            blocks += text.matches(BEGIN).count();
        }
        assert!(blocks > 10, "{blocks}");
    }

    /// Pages are read in the repository as well, where nothing fills in what a line only names.
    #[test]
    fn pages_include_nothing() {
        let measured = REPORTS.map(|report| of_report(&book(), report.name));
        for page in pages(&root()).unwrap().into_iter().chain(measured) {
            assert!(!read(&page).unwrap().contains("{{#"), "{}", page.display());
        }
    }

    /// Every file in the folder says where its numbers are from, and is a page of the book.
    #[test]
    fn measured_files_name_their_origin() {
        let contents = read(&root().join("docs/SUMMARY.md")).unwrap();
        for report in REPORTS.map(|report| report.name) {
            let all = measurements(&of_report(&book(), report)).unwrap();
            assert!(!all.is_empty(), "{report}");
            for measurement in all {
                let is_named = measurement.origin.contains(report);
                assert!(
                    is_named && !measurement.commit().is_empty(),
                    "{measurement:?}"
                );
            }
            assert!(
                contents.contains(&format!("(measured/{report}.md)")),
                "{report}"
            );
        }
    }
}
