//! The commands of the README name files that there are.

use std::collections::BTreeSet;
use std::path::Path;

/// The commands `isosheet ...` of a page, in their order: lines of code blocks, and code in sentences.
fn commands(page: &str) -> Vec<&str> {
    let mut found = Vec::new();
    for line in page.lines() {
        let code = line.split('`').skip(1).step_by(2);
        let pieces = std::iter::once(line).chain(code);
        found.extend(pieces.filter(|piece| piece.starts_with("isosheet ")));
    }
    found
}

/// The files that commands read, and that are neither in a folder nor written by a command before.
fn missing<'a>(commands: &[&'a str], folder: &Path) -> Vec<&'a str> {
    let mut written = BTreeSet::new();
    let mut missing = Vec::new();
    for command in commands {
        let words: Vec<&str> = command.split_whitespace().collect();
        if let ["isosheet", "new", name, ..] = words[..] {
            written.insert(format!("{name}.toml"));
        }
        let files = words.into_iter().filter(|word| {
            let name = word.rsplit('/').next().unwrap_or(word);
            name.contains('.') && !word.starts_with('-')
        });
        missing
            .extend(files.filter(|file| !written.contains(*file) && !folder.join(file).is_file()));
    }
    missing
}

#[test]
fn commands_read_files_of_the_repository() {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("..");
    let page = std::fs::read_to_string(folder.join("README.md")).expect("the README");
    let commands = commands(&page);
    assert!(commands.len() >= 5, "{commands:?}");
    assert_eq!(missing(&commands, &folder), [""; 0]);
}

#[test]
fn a_file_that_nobody_has_is_found() {
    let page =
        "- `isosheet fold crane.svg --open` folds\n\nisosheet new a\nisosheet simulate a.toml\n";
    let commands = commands(page);
    assert_eq!(commands.len(), 3, "{commands:?}");
    assert_eq!(missing(&commands, Path::new("nowhere")), ["crane.svg"]);
}
