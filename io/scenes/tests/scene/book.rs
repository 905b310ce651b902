//! The scenes in the hand-written pages: whole ones can start, parts of one have keys and values that exist.

use isosheet_scenes::{SceneFile, StartingPoint};
use serde_json::Value;
use std::collections::BTreeSet;
use std::fs;
use std::path::{Path, PathBuf};

/// The pages of the book, and the README.
fn pages() -> Vec<PathBuf> {
    let root = Path::new(env!("CARGO_MANIFEST_DIR")).join("../..");
    let entries = ["docs", "docs/scene"]
        .into_iter()
        .flat_map(|name| fs::read_dir(root.join(name)).expect("a folder of the book"));
    let paths = entries.map(|e| e.expect("an entry").path());
    let mut pages: Vec<PathBuf> = paths
        .filter(|p| p.extension().is_some_and(|e| e == "md"))
        .collect();
    pages.push(root.join("README.md"));
    pages.sort();
    pages
}

/// The fenced blocks of a page in a language, indented or not.
fn blocks(page: &str, language: &str) -> Vec<String> {
    let mut found = Vec::new();
    let mut lines = page.lines();
    while let Some(line) = lines.next() {
        if line.trim() == format!("```{language}") {
            let inside = lines.by_ref().take_while(|l| l.trim() != "```");
            found.push(inside.map(|l| format!("{l}\n")).collect());
        }
    }
    found
}

/// A part of a scene with the version, and with a sheet if it has none.
fn completed(part: &str) -> String {
    let mut scene: toml::Table = toml::from_str(part).unwrap_or_else(|e| panic!("{e}\n{part}"));
    scene.insert("version".to_owned(), toml::Value::Integer(1));
    let empty = toml::Value::Table(toml::Table::new());
    let square: toml::Table = toml::from_str("square = { side = 0.2, level = 1 }").expect("TOML");
    // Several sheets have meshes of their own.
    if let Some(sheet) = scene.entry("sheet").or_insert(empty).as_table_mut() {
        sheet.entry("mesh").or_insert(toml::Value::Table(square));
    }
    toml::to_string(&scene).expect("TOML")
}

#[test]
fn the_scenes_of_the_book_can_start() {
    let (mut whole, mut parts) = (0, 0);
    for path in pages() {
        let page = fs::read_to_string(&path).expect("a page");
        for block in blocks(&page, "toml") {
            let text = match block.starts_with("version = 1\n") {
                true => block.clone(),
                false => completed(&block),
            };
            let scene = SceneFile::parse(text, &path, &[]);
            let scene = scene.unwrap_or_else(|e| panic!("{}: {e}\n{block}", path.display()));
            // Scenes that name files of the reader's are checked as far as that goes without the files.
            if block.starts_with("version = 1\n") && scene.scene().files().is_empty() {
                let started = scene.build().and_then(|setup| setup.start());
                started.unwrap_or_else(|e| panic!("{}: {e}\n{block}", path.display()));
                whole += 1;
            } else {
                parts += 1;
            }
        }
    }
    assert!(
        whole >= 5 && parts >= 3,
        "{whole} scenes and {parts} parts were found"
    );
}

/// What a page says outside of its blocks of code.
fn prose(page: &str) -> String {
    page.split("```").step_by(2).collect()
}

/// What links into a page may name behind `#`: its headings, as mdBook and GitHub write them, and anchors of
/// its own.
fn anchors(page: &str) -> BTreeSet<String> {
    let prose = prose(page);
    let headings = prose.lines().filter(|line| line.starts_with('#'));
    let headings = headings.map(|line| {
        let heading = line.trim_start_matches('#').trim().to_lowercase();
        let kept = heading
            .chars()
            .filter(|c| c.is_alphanumeric() || " _-".contains(*c));
        kept.map(|c| if c == ' ' { '-' } else { c }).collect()
    });
    let own = prose.split("<a id=\"").skip(1);
    let own = own.filter_map(|rest| rest.split('"').next().map(str::to_owned));
    headings.chain(own).collect()
}

/// Pages refer to pages and sections that exist, pages of the book to no file outside of it, and the table of
/// contents has all of them.
#[test]
fn links_between_pages_lead_somewhere() {
    let root = Path::new(env!("CARGO_MANIFEST_DIR")).join("../..");
    let docs = fs::canonicalize(root.join("docs")).expect("the folder of the book");
    let others = ["ARCHITECTURE.md", "CONTRIBUTING.md"].map(|name| root.join(name));
    let mut links = 0;
    for path in pages().into_iter().chain(others) {
        let page = fs::read_to_string(&path).expect("a page");
        let folder = path.parent().expect("pages are in folders");
        for link in prose(&page).split("](").skip(1) {
            let link = link.split(')').next().unwrap_or_default();
            if link.contains("://") {
                continue;
            }
            let (file, anchor) = link.split_once('#').unwrap_or((link, ""));
            let target = match file {
                "" => path.clone(),
                file => folder.join(file),
            };
            let shown = format!("{}: {link}", path.display());
            let target = fs::canonicalize(target).unwrap_or_else(|e| panic!("{shown}: {e}"));
            let is_of_book = fs::canonicalize(folder).is_ok_and(|f| f.starts_with(&docs));
            assert!(
                !is_of_book || target.starts_with(&docs),
                "{shown} leaves the book"
            );
            if !anchor.is_empty() {
                let target = fs::read_to_string(target).expect("a page");
                assert!(
                    anchors(&target).contains(anchor),
                    "{shown}: no such section"
                );
            }
            links += 1;
        }
    }
    assert!(links > 150, "{links} links were found");
    let contents = fs::read_to_string(docs.join("SUMMARY.md")).expect("the contents");
    for path in pages() {
        let name = path.file_name().expect("a name").to_string_lossy();
        assert!(
            ["README.md", "SUMMARY.md"].contains(&&*name)
                || contents.contains(&format!("({name})"))
                || contents.contains(&format!("(scene/{name})")),
            "{name} is not in SUMMARY.md"
        );
    }
}

/// The JSON schema of scene files, which `docs` has a copy of.
fn schema() -> Value {
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../docs/scene.schema.json");
    let text = fs::read_to_string(path).expect("the schema");
    serde_json::from_str(&text).expect("JSON")
}

/// Whether values of a part of the schema have a key, given by its words.
fn has_key(schema: &Value, of: &Value, words: &[&str]) -> bool {
    let Some((word, rest)) = words.split_first() else {
        return true;
    };
    let named = of["$ref"].as_str().and_then(|name| name.strip_prefix('#'));
    let others = named.and_then(|name| schema.pointer(name)).into_iter();
    let choices = ["anyOf", "oneOf", "allOf"].map(|name| of[name].as_array());
    let mut others = others
        .chain(choices.into_iter().flatten().flatten())
        .chain(of.get("items"));
    of["properties"]
        .get(word)
        .is_some_and(|inner| has_key(schema, inner, rest))
        || others.any(|other| has_key(schema, other, words))
}

/// The words of a key of a scene in a piece of code, such as `obstacle[0].motion`; none of other code.
fn key_words(code: &str) -> Option<Vec<&str>> {
    let key = code.split([' ', '=']).next()?;
    let words = key
        .split('.')
        .map(|word| word.split('[').next().unwrap_or(word));
    let words: Vec<&str> = words.collect();
    let is_word = |w: &&str| !w.is_empty() && w.chars().all(|c| c.is_ascii_lowercase() || c == '_');
    (words.len() > 1 && words.iter().all(is_word)).then_some(words)
}

/// Keys that pages mention in their text exist.
#[test]
fn keys_in_the_text_of_the_book_exist() {
    let schema = schema();
    let mut keys = 0;
    for path in pages() {
        let page = fs::read_to_string(&path).expect("a page");
        // What is in blocks is read as a scene by another test.
        for code in prose(&page).split('`').skip(1).step_by(2) {
            let Some(words) = key_words(code) else {
                continue;
            };
            if has_key(&schema, &schema, &words[..1]) {
                assert!(
                    has_key(&schema, &schema, &words),
                    "{}: {code}",
                    path.display()
                );
                keys += 1;
            }
        }
    }
    assert!(keys > 30, "{keys} keys were found");
}

#[test]
fn the_book_names_all_scenes_to_start_from() {
    let docs = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../docs");
    let page = fs::read_to_string(docs.join("start.md")).expect("a page");
    for kind in StartingPoint::ALL {
        let name = kind.name();
        let is_named = [format!("`{name}`"), format!("--kind {name}`")]
            .iter()
            .any(|n| page.contains(n));
        assert!(is_named, "{name}");
    }
}
