//! What the book shows of a report: `measured.md` beside the page of the report, in parts that pages of the
//! book copy by their names.
//!
//! A file has one or several measurements, each with its origin and its parts. The file of a report has one;
//! in `docs/measured` parts stay until they are measured anew.

use super::{Effort, Table};
use crate::store::Store;
use anyhow::Result;
use serde::{Deserialize, Serialize};
use std::fmt::Write;

/// Name of the file in the output folder of a report.
pub(crate) const FILE: &str = "measured.md";

/// A part of the file, which pages of the book copy by its name.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub(crate) struct Part {
    pub(crate) name: String,
    pub(crate) text: String,
}

impl Part {
    /// Paragraphs or a list as Markdown.
    pub(crate) fn text(name: impl Into<String>, text: impl Into<String>) -> Self {
        let (name, text) = (name.into(), text.into());
        Self { name, text }
    }

    /// A table with its caption.
    pub(crate) fn table(name: impl Into<String>, table: &Table) -> Self {
        let line = |cells: Vec<String>| format!("| {} |", cells.join(" | "));
        let head = table.head.iter().map(|h| escaped(&h.replace('_', " ")));
        let mut lines = vec![line(head.collect())];
        lines.push(format!("|{}", "---|".repeat(table.head.len())));
        let rows = table.rows.iter();
        lines.extend(rows.map(|row| line(row.iter().map(|cell| escaped(&cell.text())).collect())));
        let caption = escaped(&table.caption);
        Self::text(name, format!("{caption}\n\n{}", lines.join("\n")))
    }
}

/// Text without the characters that end a cell of a table or begin a tag.
fn escaped(text: &str) -> String {
    text.replace('\n', " ")
        .replace('|', "\\|")
        .replace('<', "&lt;")
}

/// Parts that were measured together.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Measurement {
    /// How, at which commit and on which machine, in a sentence or two.
    pub(crate) origin: String,
    pub(crate) parts: Vec<Part>,
}

impl Measurement {
    /// The commit that its origin names.
    pub(crate) fn commit(&self) -> &str {
        let mut words = self
            .origin
            .split_whitespace()
            .skip_while(|w| *w != "commit");
        words.nth(1).unwrap_or_default()
    }
}

const MEASUREMENT: &str = "<!-- measurement -->";
const PART: &str = "<!-- part: ";
const PART_END: &str = "<!-- /part -->";

/// What a line of Markdown that is a comment says after `begin`.
pub(crate) fn comment<'a>(line: &'a str, begin: &str) -> Option<&'a str> {
    line.strip_prefix(begin)?.strip_suffix(" -->")
}

/// The file of a report.
pub(crate) fn to_markdown(report: &str, measurements: &[Measurement]) -> String {
    let mut file = format!(
        "# Measured: {report}\n\nThis page was written by the report that it names, and is not edited by hand.\n"
    );
    for measurement in measurements {
        let _ = write!(file, "\n{MEASUREMENT}\n{}\n", measurement.origin);
        for Part { name, text } in &measurement.parts {
            let _ = write!(file, "\n{PART}{name} -->\n{text}\n{PART_END}\n");
        }
    }
    file
}

/// The measurements of a file.
pub(crate) fn from_markdown(file: &str) -> Vec<Measurement> {
    let mut measurements: Vec<Measurement> = Vec::new();
    let mut lines = file.lines();
    while let Some(line) = lines.next() {
        let mut until = |end: &dyn Fn(&str) -> bool| {
            let text: Vec<&str> = lines.by_ref().take_while(|line| !end(line)).collect();
            text.join("\n")
        };
        if line == MEASUREMENT {
            measurements.push(Measurement {
                origin: until(&str::is_empty),
                parts: Vec::new(),
            });
        } else if let (Some(name), Some(last)) = (comment(line, PART), measurements.last_mut()) {
            let text = until(&|line| line == PART_END);
            last.parts.push(Part::text(name, text));
        }
    }
    measurements
}

/// New measurements, and before them what they do not replace of old ones.
pub(crate) fn merged(old: Vec<Measurement>, new: Vec<Measurement>) -> Vec<Measurement> {
    let is_new = |part: &Part| {
        new.iter()
            .flat_map(|m| &m.parts)
            .any(|p| p.name == part.name)
    };
    let mut kept = old;
    for measurement in &mut kept {
        measurement.parts.retain(|part| !is_new(part));
    }
    kept.retain(|measurement| !measurement.parts.is_empty());
    [kept, new].concat()
}

/// Writes the file of a report. Quick results are no results: of them there is no such file.
pub(crate) fn write(store: &Store, report: &str, parts: Vec<Part>) -> Result<()> {
    let Some(commit) = store.commit() else {
        return Ok(());
    };
    let measurement = Measurement {
        origin: sentence(report, store.effort, commit, &super::machine()),
        parts,
    };
    Ok(store.write(FILE, to_markdown(report, &[measurement]).as_bytes())?)
}

/// How, at which commit and on which machine a report was made.
fn sentence(report: &str, effort: Effort, commit: &str, machine: &str) -> String {
    let full = match effort {
        Effort::Full => " --full",
        _ => "",
    };
    format!("Measured by `cargo xtask {report}{full}` at commit {commit} on {machine}.")
}

#[cfg(test)]
mod tests {
    use super::*;

    fn measurement(commit: &str, parts: &[(&str, &str)]) -> Measurement {
        Measurement {
            origin: format!("Measured at commit {commit} on\ntwo lines."),
            parts: parts
                .iter()
                .map(|(name, text)| Part::text(*name, *text))
                .collect(),
        }
    }

    #[test]
    fn files_are_read_as_they_were_written() {
        let table = Table::of("a | b", [1.5, 2.0e-9], &[("x_m", &|v| (*v).into())]);
        let table = Part::table("sizes", &table);
        assert_eq!(table.text, "a \\| b\n\n| x m |\n|---|\n| 1.5 |\n| 2.0e-9 |");
        let mut first = measurement("1f", &[("said", "- one\n- two")]);
        first.parts.push(table);
        let all = [first, measurement("2f", &[("more", "text\n\nmore text")])];
        assert_eq!(from_markdown(&to_markdown("cost", &all)), all);
        assert_eq!(all[1].commit(), "2f");
    }

    #[test]
    fn parts_that_are_measured_anew_take_the_place_of_old_ones() {
        let old = vec![
            measurement("1f", &[("a", "old"), ("b", "old")]),
            measurement("2f", &[("c", "old")]),
        ];
        let new = vec![measurement("3f", &[("c", "new"), ("b", "new")])];
        let expected = [
            measurement("1f", &[("a", "old")]),
            measurement("3f", &[("c", "new"), ("b", "new")]),
        ];
        assert_eq!(merged(old, new), expected);
    }

    #[test]
    fn the_origin_names_command_commit_and_machine() {
        assert_eq!(
            sentence("cost", Effort::Full, "1234", "a machine"),
            "Measured by `cargo xtask cost --full` at commit 1234 on a machine."
        );
    }
}
