//! The schema of scene files, made of the structs that read them.

use crate::Scene;
use isosheet_mesh::wording::given;
use serde_json::Value;

/// The JSON schema of scene files, for editors that complete and check TOML.
pub fn schema() -> Value {
    let mut schema = documented_schema();
    remove_examples(&mut schema);
    schema
}

/// The JSON schema whose descriptions have the examples in TOML of the documentation of the structs.
pub fn documented_schema() -> Value {
    let mut schema = schemars::schema_for!(Scene).to_value();
    schema["title"] = "A scene of isosheet".into();
    name_parts_plainly(&mut schema);
    schema
}

/// The end of the names of types that are values of keys, which tells them from what is made of them. Parts
/// of a schema need none.
const OF_KEY: &str = "Key";

/// Names the parts of a schema without [`OF_KEY`].
fn name_parts_plainly(schema: &mut Value) {
    match schema {
        Value::Object(entries) => {
            if let Some(Value::String(of)) = entries.get_mut("$ref") {
                *of = plain(of).to_owned();
            }
            if let Some(Value::Object(parts)) = entries.get_mut("$defs") {
                let named = std::mem::take(parts).into_iter();
                parts.extend(named.map(|(name, part)| (plain(&name).to_owned(), part)));
            }
            entries.values_mut().for_each(name_parts_plainly);
        }
        Value::Array(entries) => entries.iter_mut().for_each(name_parts_plainly),
        _ => {}
    }
}

/// A name without [`OF_KEY`].
fn plain(name: &str) -> &str {
    name.strip_suffix(OF_KEY).unwrap_or(name)
}

/// How an example begins in a description.
const EXAMPLE: &str = "```toml\n";

/// Removes the examples from all descriptions.
fn remove_examples(part: &mut Value) {
    match part {
        Value::Object(entries) => {
            if let Some(Value::String(text)) = entries.get_mut("description")
                && let Some((before, _)) = text.split_once(EXAMPLE)
            {
                *text = before.trim_end().to_owned();
            }
            entries.values_mut().for_each(remove_examples);
        }
        Value::Array(entries) => entries.iter_mut().for_each(remove_examples),
        _ => {}
    }
}

/// A default or an example as one writes it in a scene; the inverse of a whole number as a fraction.
pub fn as_written(value: &Value) -> String {
    match value {
        Value::Number(number) => number
            .as_f64()
            .map_or_else(|| number.to_string(), number_as_written),
        Value::Array(entries) => {
            let entries: Vec<String> = entries.iter().map(as_written).collect();
            format!("[{}]", entries.join(", "))
        }
        other => other.to_string(),
    }
}

/// Most digits that anybody writes.
const DIGITS: usize = 8;

fn number_as_written(value: f64) -> String {
    let text = given(value).to_string();
    let inverse = (1.0 / value).round();
    match text.len() > DIGITS && 1.0 / inverse == value {
        true => format!("1/{inverse}"),
        false => text,
    }
}
