//! Every key of the reference is accepted, and the reference in the repository is current.

use crate::complete::{places, scenes};
use isosheet_io::scene::{materials_page, reference_page, schema};
use serde_json::Value;
use std::collections::BTreeSet;
use std::path::Path;

/// All keys of a schema, as `Part.key`.
fn all_keys(schema: &Value, part: &str, keys: &mut BTreeSet<String>) {
    if let Some(name) = schema["const"].as_str() {
        keys.insert(format!("{part}.{name}"));
    }
    for options in [&schema["anyOf"], &schema["oneOf"]] {
        for option in options.as_array().into_iter().flatten() {
            all_keys(option, part, keys);
        }
    }
    for (key, inner) in schema["properties"].as_object().into_iter().flatten() {
        keys.insert(format!("{part}.{key}"));
        all_keys(inner, &format!("{part}.{key}"), keys);
    }
}

#[test]
fn every_key_of_the_reference_is_accepted() {
    let schema = schema();
    let mut all = BTreeSet::new();
    all_keys(&schema, "", &mut all);
    for (name, part) in schema["$defs"].as_object().unwrap() {
        all_keys(part, name, &mut all);
    }
    let seen: BTreeSet<String> = places(&scenes()).into_keys().collect();
    let missing: Vec<&String> = all.difference(&seen).collect();
    assert!(missing.is_empty(), "no test scene has {missing:?}");
}

#[test]
fn the_reference_in_the_repository_is_current() {
    let docs = Path::new(env!("CARGO_MANIFEST_DIR")).join("../docs");
    for (name, page) in [
        ("scene.md", reference_page()),
        ("materials.md", materials_page()),
    ] {
        let committed = std::fs::read_to_string(docs.join(name)).unwrap();
        assert!(committed == page, "call `cargo isosheet reference docs`");
    }
    let text = std::fs::read_to_string(docs.join("scene.schema.json")).unwrap();
    let committed: Value = serde_json::from_str(&text).unwrap();
    assert!(
        committed == schema(),
        "call `cargo isosheet reference docs`"
    );
}

/// The sections of the page are in the order of the keys of a scene, and each with keys has an example.
#[test]
fn the_reference_follows_a_scene_and_has_examples() {
    let page = reference_page();
    let sections: Vec<(&str, &str)> = page
        .split("\n## ")
        .flat_map(|part| part.split("\n### "))
        .skip(1)
        .map(|section| section.split_once('\n').unwrap())
        .collect();
    let place = |name: &str| {
        let found = sections.iter().position(|(heading, _)| *heading == name);
        found.unwrap_or_else(|| panic!("no section {name}"))
    };
    let order = [
        "The scene",
        "Sheet",
        "Mesh",
        "Crease",
        "Support",
        "Obstacle",
        "Forces",
        "Contact",
    ];
    let order = order.iter().chain(&["Method", "Stop", "Output", "Ranges"]);
    assert!(order.map(|name| place(name)).is_sorted());
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
    assert!(page.contains("| `1/60` |") && !page.contains("0.016666"));
}
