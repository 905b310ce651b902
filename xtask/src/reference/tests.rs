//! The reference in the repository is current, and follows a scene.

use super::{STUBS, materials, page, with_keys};
use isosheet_scenes::schema;
use serde_json::Value;
use std::path::Path;

#[test]
fn the_reference_in_the_repository_is_current() {
    let docs = Path::new(env!("CARGO_MANIFEST_DIR")).join("../docs");
    for (name, page) in [("scene.md", page()), ("materials.md", materials::page())] {
        let committed = std::fs::read_to_string(docs.join(name)).unwrap();
        assert!(committed == page, "call `cargo xtask reference`");
    }
    let text = std::fs::read_to_string(docs.join("scene.schema.json")).unwrap();
    let committed: Value = serde_json::from_str(&text).unwrap();
    assert!(committed == schema(), "call `cargo xtask reference`");
    let stubs = std::fs::read_to_string(STUBS).unwrap();
    assert!(
        with_keys(&stubs) == Some(stubs),
        "call `cargo xtask reference`"
    );
}

/// The sections of the page are in the order of the keys of a scene, and each with keys has an example.
#[test]
fn the_reference_follows_a_scene_and_has_examples() {
    let page = page();
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
