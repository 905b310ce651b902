//! Every key of the reference is accepted.

use crate::complete::{places, scenes};
use isosheet_scenes::schema;
use serde_json::Value;
use std::collections::BTreeSet;

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
