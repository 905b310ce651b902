//! How comments are written, in all crates.

use std::fs;
use std::path::{Path, PathBuf};

/// Columns of a line of comment, tables and addresses apart.
const COLUMNS: usize = 110;

/// Words that a doc comment does not begin with: alone in an editor it would say nothing.
const POINTING: [&str; 4] = ["The same", "That of", "Those", "These"];

/// The Rust files in a folder and the folders in it.
fn sources(folder: &Path, found: &mut Vec<PathBuf>) {
    for entry in fs::read_dir(folder).expect("a folder") {
        let path = entry.expect("an entry").path();
        let name = path
            .file_name()
            .expect("a name")
            .to_string_lossy()
            .into_owned();
        if path.is_dir() && !["target", "out", "node_modules"].contains(&name.as_str()) {
            sources(&path, found);
        } else if name.ends_with(".rs") {
            found.push(path);
        }
    }
}

/// The lines that break the rules, with their numbers.
fn faults(text: &str) -> Vec<String> {
    let mut faults = Vec::new();
    let mut before = "";
    for (number, line) in text.lines().enumerate() {
        let own = line.trim_start();
        let is_comment = own.starts_with("//");
        let is_free = own.contains("| ") || own.contains("://");
        if is_comment && !is_free && line.chars().count() > COLUMNS {
            faults.push(format!("{}: longer than {COLUMNS} columns", number + 1));
        }
        let documents = own.strip_prefix("/// ");
        let begins = documents.filter(|_| !before.starts_with("///"));
        if begins.is_some_and(|text| POINTING.iter().any(|words| text.starts_with(words))) {
            faults.push(format!("{}: says nothing alone: {own}", number + 1));
        }
        before = own;
    }
    faults
}

#[test]
fn comments_keep_to_their_columns_and_can_be_read_alone() {
    let root = Path::new(env!("CARGO_MANIFEST_DIR")).with_file_name("");
    let mut files = Vec::new();
    for group in [
        "mesh", "coords", "dynamics", "collide", "io", "xtask", "tests",
    ] {
        sources(&root.join(group), &mut files);
    }
    assert!(files.len() > 900, "{} files", files.len());
    let all: Vec<String> = files
        .iter()
        .flat_map(|file| {
            let text = fs::read_to_string(file).expect("text");
            let name = file.strip_prefix(&root).expect("inside").display();
            let name = name.to_string();
            faults(&text)
                .into_iter()
                .map(move |fault| format!("{name}:{fault}"))
        })
        .collect();
    assert!(all.is_empty(), "{} lines:\n{}", all.len(), all.join("\n"));
}

#[test]
fn lines_that_break_the_rules_are_found() {
    let long = format!("    // {}", "word ".repeat(30));
    let text =
        format!("{long}\n/// The same for edges.\nfn a() {{}}\n/// Edges.\n/// Those of faces.\n");
    assert_eq!(faults(&text).len(), 2, "{:?}", faults(&text));
}
