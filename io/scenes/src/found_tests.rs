//! Functions of time, files and selections are found wherever the schema has them.

#[path = "../tests/scene/all_keys.rs"]
mod all_keys;

use crate::text::schema::schema;
use crate::{Key, KeyPart, SceneFile};
use all_keys::ALL_KEYS;
use serde_json::Value;
use std::collections::BTreeSet;
use std::path::Path;

/// A key without the numbers of entries: `forces.load.size`.
fn plain(key: &Key) -> String {
    let names = key.parts().iter().filter_map(|part| match part {
        KeyPart::Name(name) => Some(name.as_str()),
        KeyPart::Entry(_) => None,
    });
    names.collect::<Vec<_>>().join(".")
}

/// The keys of a schema whose values are of a type, in the same form.
fn keys_of(of: &str) -> BTreeSet<String> {
    let root = schema();
    let mut walk = Walk {
        root: &root,
        of,
        open: Vec::new(),
        found: BTreeSet::new(),
    };
    walk.visit(&root, "");
    walk.found
}

struct Walk<'a> {
    root: &'a Value,
    of: &'a str,
    /// Types whose keys are being walked over.
    open: Vec<String>,
    found: BTreeSet<String>,
}

impl Walk<'_> {
    fn visit(&mut self, schema: &Value, key: &str) {
        if !schema.is_object() {
            return;
        }
        if let Some(reference) = schema["$ref"].as_str() {
            let name = reference.rsplit('/').next().unwrap_or_default().to_owned();
            if name == self.of {
                self.found.insert(key.to_owned());
            } else if !self.open.contains(&name) {
                self.open.push(name.clone());
                self.visit(&self.root["$defs"][&name].clone(), key);
                self.open.pop();
            }
        }
        for options in ["anyOf", "oneOf", "allOf"] {
            for option in schema[options].as_array().into_iter().flatten() {
                self.visit(option, key);
            }
        }
        for entries in ["items", "additionalProperties"] {
            self.visit(&schema[entries], key);
        }
        for entry in schema["prefixItems"].as_array().into_iter().flatten() {
            self.visit(entry, key);
        }
        for (name, inner) in schema["properties"].as_object().into_iter().flatten() {
            let inner_key = match key {
                "" => name.clone(),
                _ => format!("{key}.{name}"),
            };
            self.visit(inner, &inner_key);
        }
    }
}

/// What `found` finds in the scenes that have every key.
fn found(found: impl Fn(&SceneFile) -> Vec<Key>) -> BTreeSet<String> {
    let scenes = ALL_KEYS.iter().map(|text| {
        let scene = SceneFile::parse((*text).into(), Path::new("test.toml"), &[]);
        scene.expect("a scene with many keys")
    });
    scenes
        .flat_map(|scene| found(&scene))
        .map(|key| plain(&key))
        .collect()
}

#[test]
fn every_function_of_time_is_found() {
    let known = found(|file| {
        let functions = file.scene().functions().into_iter();
        functions.map(|function| function.key).collect()
    });
    // A rotation is found with the motion that it belongs to.
    let mut all = keys_of("Profile");
    assert!(known.contains("support.hold.moving_pin.rotation.angle"));
    all.retain(|key| known.contains(key) || !key.ends_with(".rotation.angle"));
    assert_eq!(known, all);
}

#[test]
fn every_selection_of_vertices_is_found() {
    let known = found(|file| {
        let selections = file.scene().selections().into_iter();
        selections.map(|selected| selected.key).collect()
    });
    assert_eq!(known, keys_of("Selection"));
}

#[test]
fn every_file_is_found() {
    let known = found(|file| {
        let mut scene = file.scene().clone();
        scene.files_mut().into_iter().map(|of| of.key).collect()
    });
    let files = ["MeshFile", "DrawingFile", "Sequence"].map(keys_of);
    let mut all: BTreeSet<String> = files.into_iter().flatten().collect();
    // A body that responds has no sequence, whose motion would be prescribed.
    assert!(all.remove("body.shape.sequence"));
    assert_eq!(known, all);
}
