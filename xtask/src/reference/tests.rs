//! The reference in the repository is current, and follows a scene.

use super::{STUBS, pages, superseded, with_keys};
use isosheet_scenes::schema;
use serde_json::Value;
use std::path::{Path, PathBuf};

#[test]
fn the_reference_in_the_repository_is_current() {
    let docs = Path::new(env!("CARGO_MANIFEST_DIR")).join("../docs");
    let pages = pages();
    for (name, page) in &pages {
        let committed = std::fs::read_to_string(docs.join(name)).unwrap();
        assert!(&committed == page, "{name}: call `cargo xtask reference`");
    }
    assert_eq!(
        superseded(&docs, &pages).unwrap(),
        [""; 0].map(PathBuf::from)
    );
    let text = std::fs::read_to_string(docs.join("scene.schema.json")).unwrap();
    let committed: Value = serde_json::from_str(&text).unwrap();
    assert!(committed == schema(), "call `cargo xtask reference`");
    let stubs = std::fs::read_to_string(STUBS).unwrap();
    assert!(
        with_keys(&stubs) == Some(stubs),
        "call `cargo xtask reference`"
    );
}

/// The sections of the pages are in the order of the keys of a scene, and each with keys has an example.
#[test]
fn the_reference_follows_a_scene_and_has_examples() {
    let pages = pages();
    let tables = pages.iter().filter(|(name, _)| name.starts_with("scene/"));
    let text: String = tables.map(|(_, page)| format!("\n{page}")).collect();
    let sections: Vec<(&str, &str)> = text
        .split("\n# ")
        .flat_map(|part| part.split("\n## "))
        .skip(1)
        .map(|section| section.split_once('\n').unwrap())
        .collect();
    let place = |name: &str| {
        let found = sections.iter().position(|(heading, _)| *heading == name);
        found.unwrap_or_else(|| panic!("no section {name}"))
    };
    let order = [
        "Sheet",
        "Mesh",
        "Crease",
        "Support",
        "Obstacle",
        "Forces",
        "Contact",
        "Method",
        "Stop",
        "Output",
        "Values of several tables",
        "Profile",
        "Ranges of numbers",
    ];
    assert!(order.map(place).is_sorted());
    for (name, text) in &sections {
        let has_keys = text
            .lines()
            .any(|line| line.starts_with("| `") && !line.starts_with("| `\""));
        assert!(
            !has_keys || text.contains("```toml"),
            "{name} has no example"
        );
    }
    let parts = schema()["$defs"].as_object().unwrap().len();
    assert_eq!(sections.len(), parts + 2, "each part once");
    assert!(text.contains("| `1/60` |") && !text.contains("0.016666"));
}

/// A page for each table, a line for each in the first page, and every key of the pages in its index.
#[test]
fn the_first_page_has_all_tables_and_keys() {
    let pages = pages();
    let page = |name: &str| &pages.iter().find(|(other, _)| other == name).unwrap().1;
    let (first, index) = page("scene.md").split_once("\n## Index").unwrap();
    let schema = schema();
    for (key, form) in schema["properties"].as_object().unwrap() {
        if form["type"] != "integer" {
            assert!(first.contains(&format!("](scene/{key}.md)")), "{key}");
            assert!(page(&format!("scene/{key}.md")).starts_with("# "), "{key}");
        }
    }
    let mut keys = 0;
    for (name, page) in pages.iter().filter(|(name, _)| name.starts_with("scene/")) {
        for line in page.lines() {
            let Some((key, _)) = line.strip_prefix("| `").and_then(|l| l.split_once('`')) else {
                continue;
            };
            let key = key.trim_matches('"').trim_end_matches(" = ...");
            let key = key.rsplit('.').next().unwrap();
            let line = index
                .lines()
                .find(|l| l.starts_with(&format!("| `{key}` |")));
            assert!(line.is_some_and(|l| l.contains(name)), "{name}: {key}");
            keys += 1;
        }
    }
    assert!(keys > 300, "{keys} keys");
}

/// The page of a table that no longer exists is found, and no other file.
#[test]
fn pages_of_tables_that_are_gone_are_removed() {
    let book = tempfile::tempdir().unwrap();
    let folder = book.path().join("scene");
    std::fs::create_dir(&folder).unwrap();
    for name in ["sheet.md", "gone.md", "picture.png"] {
        std::fs::write(folder.join(name), "").unwrap();
    }
    let old = superseded(book.path(), &pages()).unwrap();
    assert_eq!(old, [folder.join("gone.md")]);
}
