//! The alphabetical index of all keys of scenes.

use super::keys::choices;
use super::places::{INDEX, Places, SHARED};
use serde_json::Value;
use std::collections::{BTreeMap, BTreeSet};

/// A line for each key and each choice, with links to the sections that describe it.
pub(super) fn table(schema: &Value, places: &Places) -> String {
    let mut found: BTreeMap<String, Vec<String>> = BTreeMap::new();
    let mut note = |key: &str, link: String| {
        let links = found.entry(key.to_owned()).or_default();
        if !links.contains(&link) {
            links.push(link);
        }
    };
    for name in names(schema) {
        let page = match places.tables().contains(&name) {
            true => format!("scene/{name}.md"),
            false => "#the-tables".to_owned(),
        };
        note(&name, format!("[a scene]({page})"));
    }
    for (part, inner) in schema["$defs"].as_object().into_iter().flatten() {
        let place = places.place(part);
        let shown = match (place.is_title, place.page.as_str()) {
            (true, page) => page.to_owned(),
            (false, SHARED) => part.clone(),
            (false, page) => format!("{page}: {part}"),
        };
        for name in names(inner) {
            note(&name, format!("[{shown}]({})", places.target(part, INDEX)));
        }
    }
    let mut table = String::from("| key or choice | described at |\n|---|---|\n");
    for (key, mut links) in found {
        links.sort();
        table.push_str(&format!("| `{key}` | {} |\n", links.join(", ")));
    }
    table
}

/// The keys of a part, its choices and the keys of these.
fn names(part: &Value) -> BTreeSet<String> {
    let mut names = BTreeSet::new();
    for value in [part]
        .into_iter()
        .chain(choices(part).into_iter().flatten())
    {
        for (name, inner) in value["properties"].as_object().into_iter().flatten() {
            names.insert(name.clone());
            let inner = inner["properties"].as_object().into_iter().flatten();
            names.extend(inner.map(|(name, _)| name.clone()));
        }
        let choices = value["enum"].as_array().into_iter().flatten();
        let choices = choices.chain([&value["const"]]).filter_map(Value::as_str);
        names.extend(choices.map(str::to_owned));
    }
    names
}
