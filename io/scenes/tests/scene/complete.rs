//! Scenes that have every key of the reference between them, and the places of the keys in them.

use crate::all_keys::ALL_KEYS;
use crate::parse;
use isosheet_scenes::{SceneFile, schema};
use serde_json::Value;
use std::collections::BTreeMap;
use std::path::Path;

/// Scenes that have every key of the reference between them.
pub(crate) fn scenes() -> Vec<SceneFile> {
    let meshes = [
        "{ disk = { radius = 1, rings = 2 } }",
        "{ annulus = { inner = 1, outer = 2, segments = 5, rings = 1 } }",
        "{ fan = { radius = 1, opening = 90, triangles = 3 } }",
        "{ polygon = { outline = [[0, 0], [1, 0], [0, 1]], spacing = 0.2, seed = 1 } }",
        "{ polygon_rings = { outline = [[1, 0], [0, 1], [-1, -1]], rings = 2 } }",
        "{ octagon = { radius = 1 } }",
        "{ triangles = { vertices = [[0, 0, 0], [1, 0, 0], [0, 1, 0]], faces = [[0, 1, 2]] } }",
        "{ degree_four = { sectors = [60, 80], radius = 0.1, alike = \"odd\" } }",
        "{ degree_four = { sectors = [60, 80], radius = 0.1, alike = \"even\" } }",
        "{ waterbomb = { columns = 2, rows = 2, side = 0.1 } }",
        "{ yoshimura = { columns = 2, rows = 2, base = 0.1, height = 0.1 } }",
        "{ kresling = { columns = 2, rows = 2, base = 0.1, side = 0.1, angle = 60 } }",
        "{ hypar = { rings = 2, side = 0.1 } }",
        "{ strip_between = { first = [[0, 0, 0], [1, 0, 0]], second = [[0, 1, 0], [1, 1, 0]], columns = 2, rows = 2 } }",
        "{ strip_between = { first = { path = \"a.csv\", scale = 0.1 }, second = [[0, 1, 0], [1, 1, 0]], columns = 2 } }",
        "{ square_twist = { side = 0.2, square = 0.1, angle = 45 } }",
        "{ miura = { columns = 2, rows = 2, straight = 1, zigzag = 1, angle = 60 } }",
        "{ rectangle = { width = 1, height = 1, columns = 2, rows = 2, diagonals = \"falling\" } }",
        "{ rectangle = { width = 1, height = 1, columns = 2, rows = 2, diagonals = \"rising\" } }",
    ];
    let with = |key: &str, value: &str| format!("{key}={value}");
    let integrators = ["energy_momentum", "rattle_composition", "static"];
    let edits = meshes.iter().map(|m| with("sheet.mesh", m));
    let edits = edits.chain(integrators.iter().map(|i| with("method.integrator", i)));
    let charts = [
        "{ coordinates = \"cartesian\", substep = { fixed = 1e-3 }, singular = \"rebase\" }",
        "{ coordinates = \"front_with_straight_creases\", scheme = \"runge_kutta4\", equations = \"full\" }",
        "{ scheme = \"forward_euler\", equations = \"reformed\", positions = \"projected\" }",
        "{ positions = \"exact\", solver = \"sparse\" }",
        "{ solver = \"dense_lu\" }",
    ];
    let charts = charts.iter().map(|c| with("method.chart", c));
    let charts =
        charts.map(|edit| SceneFile::parse(ALL_KEYS[3].into(), Path::new("test.toml"), &[edit]));
    let mut scenes: Vec<SceneFile> = ALL_KEYS
        .iter()
        .map(|text| parse(text).unwrap_or_else(|e| panic!("{e}")))
        .collect();
    for edit in edits {
        let scene = SceneFile::parse(ALL_KEYS[2].into(), Path::new("test.toml"), &[edit]);
        scenes.push(scene.unwrap_or_else(|e| panic!("{e}")));
    }
    scenes.extend(charts.map(|scene| scene.unwrap_or_else(|e| panic!("{e}"))));
    scenes
}

/// A step on the way to a value.
#[derive(Clone, Debug)]
pub(crate) enum Step {
    Key(String),
    Entry(usize),
}

/// Where a key of the reference is in one of the scenes.
#[derive(Clone, Debug)]
pub(crate) struct Place {
    pub(crate) scene: usize,
    /// The way to the value; the last step that is a name is the key.
    pub(crate) way: Vec<Step>,
    /// What its values may be.
    pub(crate) schemas: Vec<Value>,
}

/// The first place of every key, by its name in the reference: `Part.key`, and `Part.name` of a choice.
pub(crate) fn places(scenes: &[SceneFile]) -> BTreeMap<String, Place> {
    let schema = schema();
    let mut walk = Walk {
        root: &schema,
        scene: 0,
        way: Vec::new(),
        found: BTreeMap::new(),
    };
    for (k, scene) in scenes.iter().enumerate() {
        walk.scene = k;
        let value: Value = toml::from_str(&scene.text().text).unwrap();
        walk.visit(&schema, "", &value);
    }
    walk.found
}

struct Walk<'a> {
    root: &'a Value,
    scene: usize,
    way: Vec<Step>,
    found: BTreeMap<String, Place>,
}

impl Walk<'_> {
    fn visit(&mut self, schema: &Value, part: &str, value: &Value) {
        if let Some(reference) = schema["$ref"].as_str() {
            let name = reference.rsplit('/').next().unwrap();
            return self.visit(&self.root["$defs"][name], name, value);
        }
        for options in [&schema["anyOf"], &schema["oneOf"]] {
            for option in options.as_array().into_iter().flatten() {
                self.visit(option, part, value);
            }
        }
        if let (Some(name), Some(found)) = (schema["const"].as_str(), value.as_str())
            && name == found
        {
            self.note(format!("{part}.{name}"), schema);
        }
        for (k, entry) in value.as_array().into_iter().flatten().enumerate() {
            self.way.push(Step::Entry(k));
            self.visit(&schema["items"], part, entry);
            self.way.pop();
        }
        for (key, inner) in value.as_object().into_iter().flatten() {
            let property = &schema["properties"][key];
            if property.is_object() {
                let name = format!("{part}.{key}");
                self.way.push(Step::Key(key.clone()));
                self.note(name.clone(), property);
                self.visit(property, &name, inner);
                self.way.pop();
            }
        }
    }

    fn note(&mut self, name: String, schema: &Value) {
        let place = self.found.entry(name).or_insert_with(|| Place {
            scene: self.scene,
            way: self.way.clone(),
            schemas: Vec::new(),
        });
        if !place.schemas.contains(schema) {
            place.schemas.push(schema.clone());
        }
    }
}
