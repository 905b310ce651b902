//! Lists where the scene has tables: the structs of a scene can be read of lists of their values, which
//! nobody means.

use super::problem::{Key, Problem};
use super::reference::schema;
use serde_json::Value as Schema;
use std::sync::LazyLock;
use toml::Value;

static SCHEMA: LazyLock<Schema> = LazyLock::new(schema);

/// Problems for the lists in a scene that stand where the reference has no list.
pub(crate) fn misplaced_lists(scene: &Value) -> Vec<Problem> {
    let mut problems = Vec::new();
    visit(&[&*SCHEMA], scene, &Key::root(), &mut problems);
    problems
}

fn visit(forms: &[&'static Schema], value: &Value, key: &Key, problems: &mut Vec<Problem>) {
    let forms: Vec<&'static Schema> = forms.iter().flat_map(|form| alternatives(form)).collect();
    match value {
        Value::Array(entries) => {
            let items: Vec<&'static Schema> =
                forms.iter().filter_map(|form| form.get("items")).collect();
            if items.is_empty() && !forms.is_empty() {
                let message = format!("`{key}` is a list, and its keys belong in a table");
                let remedy = "write `key = value` in braces; docs/scene.md describes all keys";
                problems.push(Problem::new(key.clone(), message, remedy));
            }
            for (k, entry) in entries.iter().enumerate() {
                visit(&items, entry, &key.entry(k), problems);
            }
        }
        Value::Table(entries) => {
            for (name, entry) in entries {
                let forms = forms.iter().filter_map(|form| form["properties"].get(name));
                visit(&forms.collect::<Vec<_>>(), entry, &key.name(name), problems);
            }
        }
        _ => {}
    }
}

/// The forms that a value may have, references followed.
fn alternatives(form: &'static Schema) -> Vec<&'static Schema> {
    if let Some(name) = form["$ref"].as_str().and_then(|r| r.rsplit('/').next()) {
        return alternatives(&SCHEMA["$defs"][name]);
    }
    let choices = ["anyOf", "oneOf"].map(|of| form[of].as_array());
    let choices: Vec<&'static Schema> = choices.into_iter().flatten().flatten().collect();
    match choices.is_empty() {
        true => vec![form],
        false => choices.into_iter().flat_map(alternatives).collect(),
    }
}
