//! What the book shows of a report: `measured.md` beside the page of the report, in parts that the book
//! includes by their names.

use super::{Effort, Table, machine};
use crate::store::Store;
use anyhow::Result;
use serde::{Deserialize, Serialize};
use std::fmt::Write;
use std::process::Command;

/// Name of the file in the output folder of a report.
pub(crate) const FILE: &str = "measured.md";

/// A part of the file, which `mdbook` includes by its name.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub(crate) struct Part {
    name: String,
    text: String,
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

/// Writes the file of a report. Quick results are no results: of them there is no such file.
pub(crate) fn write(store: &Store, report: &str, parts: &[Part]) -> Result<()> {
    if store.effort == Effort::Quick {
        return Ok(());
    }
    Ok(store.write(
        FILE,
        to_markdown(report, &origin(report, store.effort), parts).as_bytes(),
    )?)
}

/// How, at which commit and on which machine a report was made.
fn origin(report: &str, effort: Effort) -> String {
    let full = if effort == Effort::Full {
        " --full"
    } else {
        ""
    };
    format!(
        "Measured by `cargo xtask {report}{full}` at commit {} on {}.",
        commit(),
        machine()
    )
}

/// The commit of the working copy, marked where files differ from it.
fn commit() -> String {
    let mut git = Command::new("git");
    git.args([
        "-C",
        env!("CARGO_MANIFEST_DIR"),
        "describe",
        "--always",
        "--abbrev=9",
        "--dirty",
    ]);
    let said = git.output().ok().filter(|o| o.status.success());
    let name = said.map(|o| String::from_utf8_lossy(&o.stdout).trim().to_owned());
    name.unwrap_or_else(|| "unknown".to_owned())
}

fn to_markdown(report: &str, origin: &str, parts: &[Part]) -> String {
    let mut file = format!(
        "# Measured: {report}\n\nThis page was written by the report that it names, and is not edited by hand.\n"
    );
    let origin = Part::text("origin", origin);
    for Part { name, text } in [&origin].into_iter().chain(parts) {
        let _ = write!(
            file,
            "\n<!-- ANCHOR: {name} -->\n{text}\n<!-- ANCHOR_END: {name} -->\n"
        );
    }
    file
}

/// A part of a file by its name.
pub(crate) fn part<'a>(file: &'a str, name: &str) -> Option<&'a str> {
    let (_, rest) = file.split_once(&format!("<!-- ANCHOR: {name} -->\n"))?;
    let (text, _) = rest.split_once(&format!("\n<!-- ANCHOR_END: {name} -->"))?;
    Some(text)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn parts_are_found_by_their_names() {
        let table = Table::of("a | b", [1.5, 2.0e-9], &[("x_m", &|v| (*v).into())]);
        let parts = [
            Part::table("sizes", &table),
            Part::text("said", "- one\n- two"),
        ];
        let file = to_markdown("cost", "Measured.", &parts);
        assert_eq!(part(&file, "origin"), Some("Measured."));
        let sizes = "a \\| b\n\n| x m |\n|---|\n| 1.5 |\n| 2.0e-9 |";
        assert_eq!(part(&file, "sizes"), Some(sizes));
        assert_eq!(part(&file, "said"), Some("- one\n- two"));
        assert_eq!(part(&file, "other"), None);
    }

    #[test]
    fn the_origin_names_command_commit_and_machine() {
        let text = origin("cost", Effort::Full);
        assert!(
            text.starts_with("Measured by `cargo xtask cost --full` at commit "),
            "{text}"
        );
        assert!(!commit().is_empty() && text.contains(&machine()));
    }
}
