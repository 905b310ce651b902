//! The reference of scene files, made of the structs that read them.

use super::Scene;
use serde_json::{Map, Value};

/// The JSON schema of scene files, for editors that complete and check TOML.
pub fn schema() -> Value {
    let mut schema = schemars::schema_for!(Scene).to_value();
    schema["title"] = "A scene of isosheet".into();
    schema
}

/// The reference page of scene files in Markdown: every key with value, default and meaning.
pub fn reference_page() -> String {
    let schema = schema();
    let mut page = String::from(INTRODUCTION);
    page.push_str("\n## The scene\n\n");
    object_table(&mut page, &schema);
    let none = Map::new();
    let parts = schema["$defs"].as_object().unwrap_or(&none);
    for (name, part) in parts {
        page.push_str(&format!("\n## {name}\n\n{}\n\n", text_of(part)));
        if let Some(choices) = choices(part) {
            choice_table(&mut page, choices);
        } else if part["properties"].is_object() {
            object_table(&mut page, part);
        } else {
            page.push_str(&format!("Value: {}.\n", kind_of(part)));
        }
    }
    page
}

const INTRODUCTION: &str = "\
# Scene files

A scene file says in TOML what is simulated; `isosheet simulate SCENE` runs it. Lengths are in metres, times in
seconds, masses in kilograms, forces in newtons and **angles in degrees**. Only what the scene names is modelled:
without `forces.gravity` there is no gravity, without obstacles and self-contact no contact.

`isosheet new NAME --kind hanging|drape|stamp|feed|fold` writes a commented scene to start from, `isosheet check
SCENE` says what is wrong with one, and `--set key=value` changes a key for one run, for example
`--set stop.time=0.5 --set obstacle[0].friction=0.3`. An unknown key is an error, which names the nearest known one.

Where a key has several choices, a choice with keys of its own is a table with one entry
(`shape = { sphere = { radius = 0.1 } }`), and one without keys is its name (`shape = \"half_space\"`).

`isosheet simulate` writes the folder `NAME-run` (`--out` names another one): `scene.toml` as it was run, `meshes/`
with the mesh files, `history.csv`, `trajectory.npz`, `obj/` if it is asked for, `index.html`, and last
`summary.json`. The page `index.html` shows the run in 3D and plays it, in any browser and without a connection;
`isosheet page DIR` makes it anew, of a run that is not complete too. A run that was stopped is continued by the
same command, or by `isosheet resume DIR`.

`isosheet sweep SCENE --over stop.time=1,2 --over sheet.damping=0.5,1,2 -j 2` runs all combinations of the values, here
two at a time, in the folders `NAME-sweep/000`, `001` and so on; `NAME-sweep/runs.csv` is the table of the runs.
Without `-j` it prints what GNU parallel, Slurm or Snakemake need to run them. The same command again continues what was
stopped or killed, and values may be added at the end of the first key. `isosheet collect NAME-sweep --out all.csv`
makes one table of the keys and of all `summary.json`, with a row for each run.

The exit codes:

| code | meaning |
|---|---|
| 0 | done; of `simulate`, the run is complete; of `sweep -j`, all runs are |
| 1 | a step of the simulation failed |
| 2 | the command line is wrong |
| 3 | the scene or the mesh is wrong, or a file cannot be read |
| 4 | the folder holds the run of another scene or version, another sweep, or other files |
| 5 | another process is writing to the folder |
| 6 | a file or a folder cannot be written |
| 130 | stopped by Ctrl-C, or a run of a sweep was killed; the same command continues |

This page and `scene.schema.json`, the JSON schema for editors, are made by `isosheet reference DIR` of the
structs that read scenes.
";

const HEAD: &str = "| key | value | default | meaning |\n|---|---|---|---|\n";

fn object_table(page: &mut String, object: &Value) {
    page.push_str(HEAD);
    rows(page, "", object);
}

/// One row for each property of an object.
fn rows(page: &mut String, prefix: &str, object: &Value) {
    let none = Map::new();
    let required: Vec<&str> = match object["required"].as_array() {
        Some(names) => names.iter().filter_map(Value::as_str).collect(),
        None => Vec::new(),
    };
    for (name, property) in object["properties"].as_object().unwrap_or(&none) {
        let default = match property.get("default") {
            _ if required.contains(&name.as_str()) => "required".to_owned(),
            None | Some(Value::Null) => "none".to_owned(),
            Some(Value::Object(_)) => "see there".to_owned(),
            Some(Value::Array(entries)) if entries.is_empty() => "none".to_owned(),
            Some(value) => format!("`{}`", toml_value(value)),
        };
        let (kind, text) = (kind_of(property), text_of(property));
        page.push_str(&format!(
            "| `{prefix}{name}` | {kind} | {default} | {text} |\n"
        ));
    }
}

fn choices(part: &Value) -> Option<&Vec<Value>> {
    part["oneOf"].as_array()
}

fn choice_table(page: &mut String, choices: &[Value]) {
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
                kind_of(inner)
            ));
            rows(page, &format!("{name}."), inner);
        }
    }
}

/// The description of a part in one line.
fn text_of(part: &Value) -> String {
    let text = part["description"].as_str().unwrap_or_default();
    let words: Vec<&str> = text.split_whitespace().collect();
    words.join(" ").replace('|', "\\|")
}

/// What a value is, in words.
fn kind_of(part: &Value) -> String {
    if let Some(reference) = part["$ref"].as_str() {
        let name = reference.rsplit('/').next().unwrap_or_default();
        return format!("[{name}](#{})", name.to_lowercase());
    }
    if let Some(options) = part["anyOf"].as_array() {
        let kinds = options.iter().filter(|o| o["type"] != "null").map(kind_of);
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
            let entries = plural(&kind_of(&part["items"]));
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

/// A default as it is written in a scene.
fn toml_value(value: &Value) -> String {
    value.to_string().replace(',', ", ")
}
