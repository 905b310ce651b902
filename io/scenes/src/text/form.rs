//! The form of a scene against the reference: unknown keys, and lists, tables and numbers that
//! stand where the scene has something else. All of them are found at once, each at its place in the text.

use crate::text::schema::{as_written, schema};
use crate::words::key::{Key, KeyPart};
use crate::words::problem::Problem;
use crate::words::toml_problem::suggestion;
use serde_json::Value as Schema;
use std::collections::BTreeMap;
use std::ops::Range;
use std::sync::LazyLock;
use toml::de::{DeTable, DeValue};

static SCHEMA: LazyLock<Schema> = LazyLock::new(schema);

/// What is wrong with the form of a scene, in the order of its text.
pub(crate) fn form_problems(scene: &DeTable<'_>) -> Vec<Problem> {
    let mut problems = Vec::new();
    visit_table(&alternatives(&SCHEMA), scene, &Key::root(), &mut problems);
    problems.sort_by_key(|problem| problem.span.as_ref().map(|span| span.start));
    problems
}

/// The place of a value, as far as messages need it.
struct ValuePlace {
    key: Key,
    span: Range<usize>,
}

impl ValuePlace {
    fn problem(&self, message: String, remedy: impl Into<String>) -> Problem {
        Problem {
            span: Some(self.span.clone()),
            ..Problem::new(self.key.clone(), message, remedy)
        }
    }
}

fn visit(
    forms: &[&'static Schema],
    value: &DeValue<'_>,
    place: &ValuePlace,
    problems: &mut Vec<Problem>,
) {
    let key = &place.key;
    let has_lists = forms.iter().any(|form| form["items"].is_object());
    match value {
        DeValue::Array(entries) => {
            let items = forms.iter().filter_map(|form| form.get("items"));
            let items: Vec<&'static Schema> = items.flat_map(alternatives).collect();
            if !has_lists && !forms.is_empty() {
                problems.push(match properties(forms).is_empty() {
                    true => place.problem(
                        format!("`{key}` is a list, and the scene has one value there"),
                        "write it without brackets; parts of a sheet that are of another material are `[[sheet.patch]]`",
                    ),
                    false => place.problem(
                        format!("`{key}` is a list, and its keys belong in a table"),
                        format!(
                            "write them below `[{}]`, or in braces as `key = value`; docs/scene.md describes all keys",
                            header(key)
                        ),
                    ),
                });
            }
            for (k, entry) in entries.iter().enumerate() {
                let place = ValuePlace {
                    key: key.entry(k),
                    span: entry.span(),
                };
                visit(&items, entry.get_ref(), &place, problems);
            }
        }
        DeValue::Table(_) if has_lists && properties(forms).is_empty() => {
            let message = format!("`{key}` is a table, and the scene has a list there");
            let items = forms.iter().filter_map(|form| form.get("items"));
            let items: Vec<&'static Schema> = items.flat_map(alternatives).collect();
            let remedy = match properties(&items).is_empty() {
                true => "write the values in brackets, `[1, 2]`".to_owned(),
                false => format!(
                    "write `[[{}]]` in double brackets, once for each entry",
                    header(key)
                ),
            };
            problems.push(place.problem(message, remedy));
        }
        DeValue::Table(entries) => visit_table(forms, entries, key, problems),
        DeValue::Integer(_) | DeValue::Float(_) if has_lists && !takes_numbers(forms) => {
            let message = format!("`{key}` is a number, and the scene has a list there");
            problems.push(place.problem(message, list_remedy(forms, key)));
        }
        DeValue::Integer(_) | DeValue::Float(_) if !takes_numbers(forms) => {
            let choices = choices(forms);
            if !choices.is_empty() {
                let message = format!("`{key}` is a number, and the scene has a choice there");
                let remedy = format!(
                    "write one of these: {}; docs/scene.md describes them",
                    choices.join(", ")
                );
                problems.push(place.problem(message, remedy));
            }
        }
        _ => {}
    }
}

fn visit_table(
    forms: &[&'static Schema],
    entries: &DeTable<'_>,
    key: &Key,
    problems: &mut Vec<Problem>,
) {
    let known = properties(forms);
    if known.is_empty() {
        return;
    }
    let names: Vec<&str> = known.keys().copied().collect();
    for (name, entry) in entries {
        let place = ValuePlace {
            key: key.name(name.get_ref()),
            span: entry.span(),
        };
        match known.get(&**name.get_ref()) {
            Some(forms) => visit(forms, entry.get_ref(), &place, problems),
            None => {
                let place = ValuePlace {
                    span: name.span(),
                    ..place
                };
                let what = if is_choice(forms) { "choice" } else { "key" };
                let message = format!("unknown {what} `{}`", name.get_ref());
                problems.push(place.problem(message, suggestion(name.get_ref(), &names)));
            }
        }
    }
}

/// The name of a table in its header, which has no numbers of entries.
fn header(key: &Key) -> String {
    let names = key.parts().iter().filter_map(|part| match part {
        KeyPart::Name(name) => Some(name.as_str()),
        KeyPart::Entry(_) => None,
    });
    names.collect::<Vec<_>>().join(".")
}

/// How to write a list, with the example of the reference if it has one.
fn list_remedy(forms: &[&'static Schema], key: &Key) -> String {
    let example = forms.iter().find_map(|form| form["examples"].get(0));
    let example = example.map_or_else(|| "[0, 0, 1]".to_owned(), as_written);
    let is_vector = forms.iter().any(|form| form["minItems"] == 3);
    let what = if is_vector {
        "the components along x, y and z"
    } else {
        "the values"
    };
    let name = key.to_string();
    let name = name.rsplit('.').next().unwrap_or_default();
    format!("write {what} in brackets, for example `{name} = {example}`")
}

fn takes_numbers(forms: &[&Schema]) -> bool {
    forms.iter().any(|form| {
        ["number", "integer"]
            .iter()
            .any(|kind| has_type(form, kind))
    })
}

fn has_type(form: &Schema, kind: &str) -> bool {
    let types = &form["type"];
    let several = types.as_array().into_iter().flatten();
    several.chain([types]).any(|t| t == kind)
}

/// Whether a table with such forms names one of several choices.
fn is_choice(forms: &[&Schema]) -> bool {
    let tables = forms.iter().filter(|form| form["properties"].is_object());
    tables.count() > 1
}

/// How the choices are written of a value that is one of several names and tables; empty of another value.
fn choices(forms: &[&'static Schema]) -> Vec<String> {
    let names = forms.iter().flat_map(|form| {
        let several = form["enum"].as_array().into_iter().flatten();
        several
            .chain([&form["const"]])
            .filter_map(|name| name.as_str())
    });
    let names: Vec<String> = names.map(|name| format!("{name:?}")).collect();
    let tables = forms
        .iter()
        .filter_map(|form| form["properties"].as_object());
    let keys = tables.flat_map(|table| table.keys());
    let tables: Vec<String> = keys.map(|key| format!("{{ {key} = ... }}")).collect();
    match names.len() + usize::from(!tables.is_empty()) {
        0 | 1 => Vec::new(),
        _ => [names, tables].concat(),
    }
}

/// The keys that a table of one of these forms may have, with the forms of their values.
fn properties(forms: &[&'static Schema]) -> BTreeMap<&'static str, Vec<&'static Schema>> {
    let mut known: BTreeMap<&str, Vec<&Schema>> = BTreeMap::new();
    for form in forms {
        for (name, property) in form["properties"].as_object().into_iter().flatten() {
            known
                .entry(name)
                .or_default()
                .extend(alternatives(property));
        }
    }
    known
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
