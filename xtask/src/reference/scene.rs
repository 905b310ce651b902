//! The pages about scene files in Markdown.
//!
//! Every key has its value, default and meaning, in the order of a scene file, and each table an example.

use super::index;
use super::introduction::INTRODUCTION;
use super::keys::{EXAMPLE, choice_table, choices, default_of, kind_of, object_table, text_of};
use super::places::{Places, SHARED};
use super::ranges;
use isosheet_scenes::{StartingPoint, documented_schema};
use serde_json::Value;

/// The folder in the book with a page for each table.
pub(super) const FOLDER: &str = "scene";

/// All pages, with their paths from the folder of the book.
pub(super) fn pages() -> Vec<(String, String)> {
    let schema = documented_schema();
    let places = Places::of(&schema);
    let mut pages = vec![("scene.md".to_owned(), first(&schema, &places))];
    for table in places.tables() {
        let property = &schema["properties"][table];
        let mut page = String::new();
        for part in places.on(table) {
            section(&mut page, &schema["$defs"], part, &places);
            if places.place(part).is_title {
                let headings = headings(table, property).join(" or ");
                let line = format!("\n\n{headings} of a [scene file](../scene.md).\n\n");
                page = page.replacen("\n\n", &line, 1);
            }
        }
        pages.push((format!("{FOLDER}/{table}.md"), page));
    }
    let mut shared = String::from(VALUES);
    for part in places.on(SHARED) {
        shared.push('\n');
        section(&mut shared, &schema["$defs"], part, &places);
    }
    pages.push((format!("{FOLDER}/{SHARED}.md"), shared));
    pages.push((format!("{FOLDER}/ranges.md"), ranges::page()));
    pages
}

const VALUES: &str = "\
# Values of several tables

Each of these values is described once, though several tables of a [scene file](../scene.md) have it.
";

/// The page with the tables and the index of all keys.
fn first(schema: &Value, places: &Places) -> String {
    let kinds = StartingPoint::ALL.map(|kind| format!("`{}`", kind.name()));
    let kinds = kinds.join(", ");
    let example = format!("{EXAMPLE}{}```\n", StartingPoint::Drape.text());
    let mut page = INTRODUCTION.replace("KINDS", &kinds);
    page = page.replace("EXAMPLE\n", &example);
    page = page.replace("TABLES\n", &tables(schema, places));
    page.push_str(&index::table(schema, places));
    page
}

/// A line for each table of a scene, and for its other keys.
fn tables(schema: &Value, places: &Places) -> String {
    let mut lines = String::from("| table | default | meaning |\n|---|---|---|\n");
    for (name, property) in schema["properties"].as_object().into_iter().flatten() {
        let shown = if places.tables().contains(name) {
            let headings = headings(name, property).join(" or ");
            format!("[{headings}]({FOLDER}/{name}.md)")
        } else {
            format!("`{name}`")
        };
        let default = default_of(schema, name).replace("see there", "see its page");
        let text = text_of(property);
        lines.push_str(&format!("| {shown} | {default} | {text} |\n"));
    }
    lines
}

/// How a scene writes the heading of a table, or of each one in a list.
fn headings(name: &str, property: &Value) -> Vec<String> {
    let kinds = kind_of(property, &|_| String::new());
    let kinds = kinds.split(" or ").map(|kind| match kind {
        list if list.starts_with("list of") => format!("`[[{name}]]`"),
        _ => format!("`[{name}]`"),
    });
    kinds.collect()
}

/// The section of a part, which is the title of a page or one of its parts.
fn section(page: &mut String, parts: &Value, name: &str, places: &Places) {
    let (part, place) = (&parts[name], places.place(name));
    let link = |part: &str| places.target(part, &place.page);
    let text = text_of(part);
    if page.is_empty() {
        page.push_str(&format!("# {name}\n\n{text}\n\n"));
    } else {
        page.push_str(&format!("\n## {name}\n\n{text}\n\n"));
    }
    let description = part["description"].as_str().unwrap_or_default();
    if let Some((_, example)) = description.split_once(EXAMPLE) {
        page.push_str(&format!("{EXAMPLE}{}\n\n", example.trim_end()));
    }
    if let Some(choices) = choices(part) {
        choice_table(page, choices, &link);
    } else if part["properties"].is_object() {
        object_table(page, part, &link);
    } else {
        page.push_str(&format!("Value: {}.\n", kind_of(part, &link)));
    }
}
