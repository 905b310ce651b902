//! The keys of a part of scenes as a table in Markdown.

use isosheet_scenes::as_written;
use serde_json::Value;

/// Where a link to a part leads.
pub(super) type Link<'a> = &'a dyn Fn(&str) -> String;

/// How an example begins in a description.
pub(super) const EXAMPLE: &str = "```toml\n";

const HEAD: &str = "| key | value | default | meaning |\n|---|---|---|---|\n";

/// The keys of a part that has keys.
pub(super) fn object_table(page: &mut String, object: &Value, link: Link<'_>) {
    page.push_str(HEAD);
    rows(page, "", object, link);
}

/// One row for each property of an object.
fn rows(page: &mut String, prefix: &str, object: &Value, link: Link<'_>) {
    for (name, property) in object["properties"].as_object().into_iter().flatten() {
        let default = default_of(object, name);
        let (kind, text) = (kind_of(property, link), text_of(property));
        page.push_str(&format!(
            "| `{prefix}{name}` | {kind} | {default} | {text} |\n"
        ));
    }
}

/// What holds where a key of an object is left out.
pub(super) fn default_of(object: &Value, name: &str) -> String {
    let required = object["required"].as_array().into_iter().flatten();
    if required
        .filter_map(Value::as_str)
        .any(|other| other == name)
    {
        return "required".to_owned();
    }
    match object["properties"][name].get("default") {
        None | Some(Value::Null) => "none".to_owned(),
        Some(Value::Object(_)) => "see there".to_owned(),
        Some(Value::Array(entries)) if entries.is_empty() => "none".to_owned(),
        Some(value) => format!("`{}`", as_written(value)),
    }
}

/// The choices of a part that has some.
pub(super) fn choices(part: &Value) -> Option<&Vec<Value>> {
    part["oneOf"].as_array()
}

/// The choices of a part, with their keys.
pub(super) fn choice_table(page: &mut String, choices: &[Value], link: Link<'_>) {
    page.push_str(HEAD);
    for choice in choices {
        let text = text_of(choice);
        if let Some(name) = choice["const"].as_str() {
            page.push_str(&format!("| `\"{name}\"` | | | {text} |\n"));
            continue;
        }
        for name in choice["enum"].as_array().into_iter().flatten() {
            page.push_str(&format!("| `{name}` | | | {text} |\n"));
        }
        for (name, inner) in choice["properties"].as_object().into_iter().flatten() {
            page.push_str(&format!(
                "| `{name} = ...` | {} | | {text} |\n",
                kind_of(inner, link)
            ));
            rows(page, &format!("{name}."), inner, link);
        }
    }
}

/// The description of a part in one line, without its example.
pub(super) fn text_of(part: &Value) -> String {
    let text = part["description"].as_str().unwrap_or_default();
    let text = text.split(EXAMPLE).next().unwrap_or_default();
    let words: Vec<&str> = text.split_whitespace().collect();
    words.join(" ").replace('|', "\\|")
}

/// What a value is, in words.
pub(super) fn kind_of(part: &Value, link: Link<'_>) -> String {
    if let Some(reference) = part["$ref"].as_str() {
        let name = reference.rsplit('/').next().unwrap_or_default();
        return format!("[{name}]({})", link(name));
    }
    if let Some(options) = part["anyOf"].as_array() {
        let kinds = options.iter().filter(|o| o["type"] != "null");
        let kinds = kinds.map(|option| kind_of(option, link));
        return kinds.collect::<Vec<_>>().join(" or ");
    }
    let kind = match &part["type"] {
        Value::Array(kinds) => kinds.first().and_then(Value::as_str).unwrap_or_default(),
        kind => kind.as_str().unwrap_or_default(),
    };
    match kind {
        "number" => "number".into(),
        "integer" => "whole number".into(),
        "string" => "text".into(),
        "boolean" => "true or false".into(),
        "array" => {
            let entries = plural(&kind_of(&part["items"], link));
            match part["minItems"].as_u64() {
                Some(3) => format!("three {entries}"),
                Some(2) => format!("two {entries}"),
                _ => format!("list of {entries}"),
            }
        }
        _ => "table".into(),
    }
}

/// The plural of what a value is.
fn plural(kind: &str) -> String {
    if kind.ends_with("number") {
        format!("{kind}s")
    } else if let Some(count) = kind
        .split_once(' ')
        .filter(|(n, _)| ["two", "three"].contains(n))
    {
        let size = if count.0 == "two" { "pairs" } else { "triples" };
        format!("{size} of {}", count.1)
    } else {
        kind.to_owned()
    }
}
