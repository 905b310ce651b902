//! Wrong scenes that are derived from the reference: each key misspelled, left out, of every type that it
//! must not have, and out of range; each path to a file that cannot be read. A key that is added to scenes is
//! tried, too: a test of the reference demands that it is in the scenes that these are made of.

use crate::complete::{Place, Step, places, scenes};
use crate::parse;
use isosheet_scenes::{PlacedProblem, SceneError, SceneFile, SceneFileError, schema};
use serde_json::Value as Schema;
use std::panic::{AssertUnwindSafe, catch_unwind};
use toml::Value;

/// The value that a way leads to.
fn at<'a>(scene: &'a mut Value, way: &[Step]) -> &'a mut Value {
    way.iter().fold(scene, |value, step| match step {
        Step::Key(key) => &mut value[key.as_str()],
        Step::Entry(k) => &mut value[*k],
    })
}

/// The table that has a key, and the key.
fn table_of<'a>(scene: &'a mut Value, place: &Place) -> (&'a mut toml::Table, String) {
    let Some((Step::Key(key), table)) = place.way.split_last() else {
        panic!("a key is the last step: {place:?}");
    };
    let table = at(scene, table).as_table_mut();
    (table.expect("keys are in tables"), key.clone())
}

/// Whether the place is that of a key, and not that of a choice among words.
fn is_key(name: &str, place: &Place) -> bool {
    let last = name.rsplit('.').next().unwrap();
    matches!(place.way.last(), Some(Step::Key(key)) if key == last)
}

/// Reads and checks a scene; a panic is a failure of the test that names what was tried.
fn read(tried: &str, scene: &Value) -> Result<SceneFile, SceneFileError> {
    let text = toml::to_string(scene).unwrap();
    let result = catch_unwind(AssertUnwindSafe(|| parse(&text)));
    result.unwrap_or_else(|_| panic!("{tried} panics:\n{text}"))
}

/// The problems of a scene that has to be refused, each shown with file, line, marker and remedy.
#[track_caller]
fn refused(tried: &str, scene: &Value) -> Vec<PlacedProblem> {
    match read(tried, scene) {
        Err(SceneFileError::Scene(error)) => checked(tried, &error),
        Err(other) => panic!("{tried}: {other}"),
        Ok(_) => panic!("{tried} is accepted:\n{}", toml::to_string(scene).unwrap()),
    }
}

#[track_caller]
fn checked(tried: &str, error: &SceneError) -> Vec<PlacedProblem> {
    let (shown, placed) = (error.to_string(), error.placed());
    assert!(!placed.is_empty(), "{tried}");
    for problem in &placed {
        let (Some(line), Some(column)) = (problem.line, problem.column) else {
            panic!("{tried} has no place: {shown}");
        };
        let place = format!("--> test.toml:{line}:{column}");
        assert!(
            shown.contains(&place) && shown.contains('^'),
            "{tried}: {shown}"
        );
        let remedy = problem.remedy.as_deref().unwrap_or_default();
        assert!(
            remedy.len() > 5 && shown.contains("= help: "),
            "{tried}: {shown}"
        );
        assert!(problem.message.len() > 5, "{tried}: {shown}");
        for word in [
            "f64",
            "u32",
            "usize",
            "serde",
            "variant",
            "struct ",
            "type: sequence",
            "boolean",
        ] {
            assert!(!shown.contains(word), "{tried} speaks of {word}: {shown}");
        }
    }
    placed
}

/// Wrong spellings of a word: a letter too many, one too few, two in the wrong order.
fn misspelled(word: &str) -> Vec<String> {
    let letters: Vec<char> = word.chars().collect();
    let n = letters.len();
    let mut wrong = vec![format!("{word}q")];
    if n > 2 {
        wrong.push(letters[..n - 1].iter().collect());
    }
    if n > 3 && letters[1] != letters[2] {
        let mut turned = letters.clone();
        turned.swap(1, 2);
        wrong.push(turned.into_iter().collect());
    }
    wrong
}

#[test]
fn every_misspelled_key_is_named_with_the_right_one() {
    let scenes = scenes();
    let mut tried = 0;
    for (name, place) in places(&scenes).iter().filter(|(n, p)| is_key(n, p)) {
        let right: Value = toml::from_str(&scenes[place.scene].text().text).unwrap();
        let (_, key) = table_of(&mut right.clone(), place);
        for wrong in misspelled(&key) {
            let mut scene = right.clone();
            let (table, _) = table_of(&mut scene, place);
            let value = table.remove(&key).unwrap();
            table.insert(wrong.clone(), value);
            let tried_here = format!("{name} as {wrong}");
            let found = refused(&tried_here, &scene);
            let [problem] = &found[..] else {
                panic!("{tried_here}: {found:?}");
            };
            let remedy = problem.remedy.as_deref().unwrap();
            assert!(
                problem.message.contains(&format!("`{wrong}`"))
                    && remedy.starts_with(&format!("did you mean `{key}`?")),
                "{tried_here}: {problem:?}"
            );
            let text = toml::to_string(&scene).unwrap();
            let line = text.lines().nth(problem.line.unwrap() - 1).unwrap();
            assert!(line.contains(&wrong), "{tried_here} is marked in `{line}`");
            tried += 1;
        }
    }
    assert!(tried > 500, "{tried} misspelled keys");
}

#[test]
fn every_misspelled_choice_is_named_with_the_right_one() {
    let scenes = scenes();
    let mut tried = 0;
    for (name, place) in places(&scenes).iter().filter(|(n, p)| !is_key(n, p)) {
        let right: Value = toml::from_str(&scenes[place.scene].text().text).unwrap();
        let word = name.rsplit('.').next().unwrap();
        for wrong in misspelled(word) {
            let mut scene = right.clone();
            *at(&mut scene, &place.way) = Value::String(wrong.clone());
            let tried_here = format!("{name} as {wrong}");
            let found = refused(&tried_here, &scene);
            let (message, remedy) = (&found[0].message, found[0].remedy.as_deref().unwrap());
            assert!(
                message.contains(&format!("`{wrong}`")) && remedy.contains(&format!("`{word}`")),
                "{tried_here}: {found:?}"
            );
            tried += 1;
        }
    }
    assert!(tried > 100, "{tried} misspelled choices");
}

#[test]
fn every_key_that_is_needed_is_missed() {
    let (scenes, schema) = (scenes(), schema());
    let places = places(&scenes);
    let mut needed = Vec::new();
    required(&schema, "", &mut needed);
    for (name, part) in schema["$defs"].as_object().unwrap() {
        required(part, name, &mut needed);
    }
    let mut tried = 0;
    for name in needed {
        let place = &places[&name];
        let mut scene: Value = toml::from_str(&scenes[place.scene].text().text).unwrap();
        let (table, key) = table_of(&mut scene, place);
        table.remove(&key).unwrap();
        let found = refused(&format!("{name} left out"), &scene);
        let (message, remedy) = (&found[0].message, found[0].remedy.as_deref().unwrap());
        assert!(
            message.contains(&format!("`{key}`")) || remedy.contains(&format!("`{key}`")),
            "{name}: {found:?}"
        );
        tried += 1;
    }
    assert!(tried > 60, "{tried} needed keys");
}

/// The needed keys of a schema, as `Part.key`, without choices, each of which is needed in its own form.
fn required(schema: &Schema, part: &str, keys: &mut Vec<String>) {
    let needed = schema["required"].as_array().into_iter().flatten();
    keys.extend(needed.map(|key| format!("{part}.{}", key.as_str().unwrap())));
    for options in [&schema["anyOf"], &schema["oneOf"]] {
        for option in options.as_array().into_iter().flatten() {
            for (key, inner) in option["properties"].as_object().into_iter().flatten() {
                required(inner, &format!("{part}.{key}"), keys);
            }
        }
    }
    for (key, inner) in schema["properties"].as_object().into_iter().flatten() {
        required(inner, &format!("{part}.{key}"), keys);
    }
}

/// Whether a schema takes a value of some type, `word` being no choice that any key has.
fn takes(root: &Schema, schema: &Schema, value: &Value) -> bool {
    if let Some(reference) = schema["$ref"].as_str() {
        let name = reference.rsplit('/').next().unwrap();
        return takes(root, &root["$defs"][name], value);
    }
    if let Some(name) = schema["const"].as_str() {
        return value.as_str() == Some(name);
    }
    if let Some(words) = schema["enum"].as_array() {
        return words.iter().any(|w| w.as_str() == value.as_str());
    }
    for options in [&schema["anyOf"], &schema["oneOf"]] {
        if let Some(options) = options.as_array() {
            return options.iter().any(|option| takes(root, option, value));
        }
    }
    let kind = |name: &str| match name {
        "number" => value.is_float() || value.is_integer(),
        "integer" => value.is_integer(),
        "string" => value.is_str(),
        "boolean" => value.is_bool(),
        "array" => value.is_array(),
        "object" => value.is_table(),
        _ => false,
    };
    let types = &schema["type"];
    let names = types.as_array().into_iter().flatten().chain([types]);
    names.filter_map(Schema::as_str).any(kind)
}

#[test]
fn every_wrong_type_is_refused_at_its_place() {
    let (scenes, schema) = (scenes(), schema());
    let values = [
        Value::String("some word".into()),
        Value::Float(1.5),
        Value::Integer(3),
        Value::Boolean(true),
        Value::Array(vec![Value::Boolean(true)]),
        Value::Datetime("2007-10-01".parse().unwrap()),
        Value::Table(toml::Table::from_iter([(
            "some_key".to_owned(),
            Value::Boolean(true),
        )])),
    ];
    let mut tried = 0;
    for (name, place) in places(&scenes).iter().filter(|(n, p)| is_key(n, p)) {
        let right: Value = toml::from_str(&scenes[place.scene].text().text).unwrap();
        for value in &values {
            // Lists and tables are of the right type where others are; what is in them is not.
            let is_container = value.is_array() || value.is_table();
            if !is_container && place.schemas.iter().any(|s| takes(&schema, s, value)) {
                continue;
            }
            let mut scene = right.clone();
            *at(&mut scene, &place.way) = value.clone();
            let tried_here = format!("{name} = {value}");
            let found = refused(&tried_here, &scene);
            let text = toml::to_string(&scene).unwrap();
            let line = text.lines().nth(found[0].line.unwrap() - 1).unwrap();
            let (_, key) = table_of(&mut scene, place);
            assert!(
                line.contains(&key) || line.contains("some_key"),
                "{tried_here} is marked in `{line}`: {found:?}"
            );
            tried += 1;
        }
    }
    assert!(tried > 1000, "{tried} wrong types");
}

/// The ways to all numbers below a value.
fn numbers(value: &Value, way: &mut Vec<Step>, found: &mut Vec<Vec<Step>>) {
    match value {
        Value::Integer(_) | Value::Float(_) => found.push(way.clone()),
        Value::Array(entries) => {
            for (k, entry) in entries.iter().enumerate() {
                way.push(Step::Entry(k));
                numbers(entry, way, found);
                way.pop();
            }
        }
        Value::Table(entries) => {
            for (key, entry) in entries {
                way.push(Step::Key(key.clone()));
                numbers(entry, way, found);
                way.pop();
            }
        }
        _ => {}
    }
}

/// Every number that is infinite or NaN is refused at its place; other values are accepted, or refused with
/// place and remedy, too.
#[test]
fn every_number_out_of_range_is_refused_at_its_place() {
    let scenes = scenes();
    let (mut tried, mut refusals) = (0, 0);
    for (k, file) in scenes.iter().enumerate() {
        let right: Value = toml::from_str(&file.text().text).unwrap();
        let mut ways = Vec::new();
        numbers(&right, &mut Vec::new(), &mut ways);
        for way in ways {
            let whole = at(&mut right.clone(), &way).is_integer();
            let must = [
                Value::Float(f64::NAN),
                Value::Float(f64::INFINITY),
                Value::Float(f64::NEG_INFINITY),
            ];
            let may = [-1.0, 0.0, 1e300, -1e300, 1e-300].map(Value::Float);
            let may_whole = [-1, 0, i64::MAX, i64::MIN].map(Value::Integer);
            for value in must {
                let mut scene = right.clone();
                *at(&mut scene, &way) = value.clone();
                let found = refused(&format!("scene {k}: {way:?} = {value}"), &scene);
                let text = toml::to_string(&scene).unwrap();
                let line = text.lines().nth(found[0].line.unwrap() - 1).unwrap();
                assert!(
                    line.contains(&value.to_string()),
                    "{way:?} is marked in `{line}`: {found:?}"
                );
                tried += 1;
            }
            let may = may.into_iter().filter(|_| !whole).chain(may_whole);
            for value in may {
                let mut scene = right.clone();
                *at(&mut scene, &way) = value.clone();
                let tried_here = format!("scene {k}: {way:?} = {value}");
                if let Err(SceneFileError::Scene(error)) = read(&tried_here, &scene) {
                    checked(&tried_here, &error);
                    refusals += 1;
                }
                tried += 1;
            }
        }
    }
    assert!(tried > 2000 && refusals > 500, "{tried}, {refusals}");
}

/// Every path of the reference: no such file, a folder, an empty name, a file of another kind.
#[test]
fn every_path_to_a_file_that_cannot_be_read_is_refused_at_its_place() {
    let folder = tempfile::tempdir().unwrap();
    std::fs::create_dir(folder.path().join("folder.obj")).unwrap();
    std::fs::write(folder.path().join("text.obj"), "Dear reader,\n").unwrap();
    std::fs::write(folder.path().join("text.txt"), "Dear reader,\n").unwrap();
    std::fs::write(folder.path().join("empty.obj"), "").unwrap();
    let square = isosheet_mesh::generate::isotropic_square(1, 0.2).unwrap();
    let good = folder.path().join("good.obj");
    isosheet_formats::write_obj(&good, square.topology(), square.positions()).unwrap();
    let scene = |sheet: &str, start: &str, curl: &str, body: &str| {
        format!(
            "version = 1
[sheet]
mesh = {{ file = {{ path = {sheet:?} }} }}
start = {{ file = {{ path = {start:?} }} }}
bending = {{ plate = {{ rigidity = 1e-3 }} }}
curl = {{ shape = {{ path = {curl:?} }} }}
[[obstacle]]
shape = {{ file = {{ path = {body:?} }} }}
pose = {{ position = [0, 0, -1] }}
"
        )
    };
    let wrong_names = [
        "none.obj",
        "folder.obj",
        "",
        "text.obj",
        "text.txt",
        "empty.obj",
    ];
    for wrong in wrong_names {
        for (k, key) in [
            "sheet.mesh.file.path",
            "sheet.start.file.path",
            "sheet.curl.shape.path",
            "obstacle[0].shape.file.path",
        ]
        .into_iter()
        .enumerate()
        {
            let name = |place: usize| if place == k { wrong } else { "good.obj" };
            let text = scene(name(0), name(1), name(2), name(3));
            let path = folder.path().join("test.toml");
            let file = SceneFile::parse(text.clone(), &path, &[]);
            let error = match file.map(|file| file.build()) {
                Err(SceneFileError::Scene(error)) | Ok(Err(error)) => error,
                other => panic!("{key} = {wrong:?}: {other:?}"),
            };
            let shown = error.to_string();
            let placed = error.placed();
            assert_eq!(
                (placed[0].line, placed[0].key.as_str()),
                (Some([3, 4, 6, 8][k]), key),
                "{shown}"
            );
            assert!(
                shown.contains("test.toml:") && shown.contains('^') && shown.contains("= help: "),
                "{shown}"
            );
            assert!(
                wrong.is_empty() || placed[0].message.contains(wrong),
                "{shown}"
            );
        }
    }
    // The scene above has all the paths of meshes that the reference knows. (Paths of drawings and of meshes
    // in motion are tried with these, and paths of curves with strips.)
    let scenes = scenes();
    let paths = places(&scenes)
        .into_keys()
        .filter(|name| name.ends_with(".path"));
    assert_eq!(
        paths.collect::<Vec<_>>(),
        [
            "CurveFile.path",
            "DrawingFile.path",
            "MeshFile.path",
            "Sequence.path"
        ]
    );
    let users = schema().to_string().matches("#/$defs/MeshFile").count();
    assert_eq!(users, 4, "a path was added to scenes: try it here");
}
