//! What is made of the code: `docs/scene.md` and `docs/scene.schema.json` of the structs that read scenes,
//! the keys of scenes in the stubs of the Python module, and `docs/materials.md` of the catalogue of
//! materials.

mod materials;

use anyhow::{Context, Result};
use clap::Args;
use isosheet_files::{write_atomically, write_json};
use isosheet_mesh::wording::given;
use isosheet_scenes::{StartingPoint, UnitRange, as_written, documented_schema, schema};
use serde_json::{Map, Value};
use std::collections::BTreeSet;
use std::fs;
use std::io::Write;
use std::path::{Path, PathBuf};

/// Arguments of `reference`.
#[derive(Debug, Args)]
pub(crate) struct ReferenceArgs {
    /// Folder of the book
    #[arg(long, value_name = "DIR", default_value = "docs")]
    out: PathBuf,
}

/// Writes the pages and the schema.
pub(crate) fn run(args: &ReferenceArgs) -> Result<()> {
    for (name, page) in [("scene.md", page()), ("materials.md", materials::page())] {
        write_atomically(&args.out.join(name), |w| w.write_all(page.as_bytes()))?;
    }
    write_json(&args.out.join("scene.schema.json"), &schema())?;
    let stubs = fs::read_to_string(STUBS)?;
    let stubs = with_keys(&stubs).context("the stubs of Python have no class Scene")?;
    Ok(write_atomically(Path::new(STUBS), |w| {
        w.write_all(stubs.as_bytes())
    })?)
}

/// The stubs of the Python module, for editors that complete.
const STUBS: &str = concat!(
    env!("CARGO_MANIFEST_DIR"),
    "/../io/python/isosheet/_isosheet.pyi"
);

/// The stubs with the keys of a scene as what the class `Scene` is called with.
fn with_keys(stubs: &str) -> Option<String> {
    let (before, scene) = stubs.split_once("class Scene:\n")?;
    let (_, after) = scene.split_once(") -> Scene: ...\n")?;
    let schema = schema();
    let keys = schema["properties"].as_object().into_iter().flatten();
    let keys = keys.filter(|(key, _)| !["sheet", "version"].contains(&key.as_str()));
    let keys = keys.map(|(key, form)| {
        let kind = match form["type"] == "array" {
            true => "Sequence[Mapping[str, Any]]",
            false => "Mapping[str, Any]",
        };
        format!("        {key}: {kind} | None = None,\n")
    });
    let keys: String = keys.collect();
    let sheet = "Mapping[str, Any] | Sequence[Mapping[str, Any]]";
    Some(format!(
        "{before}class Scene:\n    def __new__(\n        cls,\n        *,\n        sheet: {sheet},\n        \
         folder: _Path = \"\",\n{keys}        version: int = 1,\n    ) -> Scene: ...\n{after}"
    ))
}

/// How an example begins in a description.
const EXAMPLE: &str = "```toml\n";

/// The reference page of scene files in Markdown: every key with value, default and meaning, in the order of
/// a scene file, and an example for each table.
fn page() -> String {
    let schema = documented_schema();
    let kinds = StartingPoint::ALL.map(StartingPoint::name).join("|");
    let mut page = INTRODUCTION.replace("KINDS", &kinds);
    page.push_str("\n## The scene\n\n");
    page.push_str(&format!("{EXAMPLE}{}```\n\n", StartingPoint::Drape.text()));
    object_table(&mut page, &schema);
    let mut told = BTreeSet::new();
    for property in schema["properties"].as_object().into_iter().flatten() {
        for name in references(property.1) {
            section(&mut page, &schema["$defs"], &name, 2, &mut told);
        }
    }
    ranges(&mut page);
    page
}

/// The section of a part and those of the parts that its keys refer to, unless they were told before.
fn section(
    page: &mut String,
    parts: &Value,
    name: &str,
    level: usize,
    told: &mut BTreeSet<String>,
) {
    if !told.insert(name.to_owned()) {
        return;
    }
    let part = &parts[name];
    page.push_str(&format!(
        "\n{} {name}\n\n{}\n\n",
        "#".repeat(level),
        text_of(part)
    ));
    let description = part["description"].as_str().unwrap_or_default();
    if let Some((_, example)) = description.split_once(EXAMPLE) {
        page.push_str(&format!("{EXAMPLE}{}\n\n", example.trim_end()));
    }
    if let Some(choices) = choices(part) {
        choice_table(page, choices);
    } else if part["properties"].is_object() {
        object_table(page, part);
    } else {
        page.push_str(&format!("Value: {}.\n", kind_of(part)));
    }
    for inner in references(part) {
        section(page, parts, &inner, 3, told);
    }
}

/// The parts that a part refers to, in the order of its keys.
fn references(part: &Value) -> Vec<String> {
    match part {
        Value::Object(entries) => {
            let own = entries.get("$ref").and_then(Value::as_str);
            let own = own.and_then(|r| r.rsplit('/').next()).map(str::to_owned);
            let inner = entries.iter().filter(|(name, _)| *name != "$defs");
            own.into_iter()
                .chain(inner.flat_map(|(_, value)| references(value)))
                .collect()
        }
        Value::Array(entries) => entries.iter().flat_map(references).collect(),
        _ => Vec::new(),
    }
}

/// The ranges of numbers by their units.
fn ranges(page: &mut String) {
    page.push_str(RANGES);
    for UnitRange {
        symbol,
        least,
        most,
        reason,
        usual,
    } in UnitRange::all()
    {
        let least = if least > 0.0 {
            given(least).to_string()
        } else {
            String::new()
        };
        let symbol = match symbol {
            "" => "coefficients of friction and drag",
            symbol => symbol,
        };
        let (questioned, compare) = match usual {
            Some(usual) => (
                given(usual.most).to_string(),
                format!("{reason}; {}", usual.compare),
            ),
            None => (String::new(), reason.to_owned()),
        };
        page.push_str(&format!(
            "| {symbol} | {least} | {questioned} | {} | {compare} |\n",
            given(most)
        ));
    }
}

const RANGES: &str = "
## Ranges

A number beyond the range of its unit is refused. The bounds are far beyond everything that a sheet is made of, and near
enough for the squares, cubes and quotients of a step neither to overflow nor to vanish. The smallest size holds for
numbers that have to be above zero. A number beyond the size that its unit usually has is warned of, as it is mostly
meant in another unit.

| unit | smallest | warned of above | largest | for comparison |
|---|---|---|---|---|
";

const INTRODUCTION: &str = "\
# Scene files

A scene file says in TOML what is simulated; `isosheet simulate SCENE` runs it. Lengths are in metres, times in
seconds, masses in kilograms, forces in newtons and **angles in degrees**. Only what the scene names is modelled:
without `forces.gravity` there is no gravity, without `air` no air, without obstacles and self-contact no contact.

`isosheet new NAME --kind KINDS` writes a commented scene to start from,
`isosheet check SCENE` says what is wrong with one, and `--set key=value` changes a key for one run, for example
`--set stop.time=0.5 --set 'obstacle[1].friction=0.3'`; the number of the only entry of a list may be left out. An
unknown key is an error, which names the nearest known one.

Where a key has several choices, a choice with keys of its own is a table with one entry
(`shape = { sphere = { radius = 0.1 } }`), and one without keys is its name (`shape = \"half_space\"`).

`isosheet simulate` writes the folder `NAME-run` (`--out` names another one): `scene.toml` as it was run, `meshes/`
with the mesh files, `history.csv`, `loads.csv`, `measures.csv`, `events.csv`, `trajectory.npz`, `obj/` if it is asked for, `index.html`, and
last `summary.json`. The page `index.html` shows the run in 3D and plays it, in any browser and without a connection;
`isosheet page DIR` makes it anew, of a run that is not complete too, and `isosheet info DIR` says what came of the run.
A run that was stopped is continued by the same command, or by `isosheet resume DIR`. After an edit of the scene
`isosheet simulate SCENE --force` replaces the run. Runs that failed or were stopped have `trajectory.npz`, too; where
it was deleted, the same command or `isosheet convert DIR x.npz` writes it again.

`isosheet sweep SCENE --over stop.time=1,2 --over sheet.damping=0.5,1,2` runs all combinations of the values in the
folders `NAME-sweep/000`, `001` and so on, as many at a time as the machine has cores, or as `-j` says;
`NAME-sweep/runs.csv` is the table of the runs. With `--engine parallel`, `slurm` or `snakemake` it prints instead what
GNU parallel, Slurm or Snakemake need to run them. The same command again continues what was stopped or killed, and
values may be added at the end of the first key. `isosheet collect NAME-sweep --out all.csv` makes one table of the keys
and of all `summary.json`, with a row for each run.

The exit codes:

| code | meaning |
|---|---|
| 0 | done; of `simulate`, the run is complete; of `sweep`, all runs are |
| 1 | a step of the simulation failed |
| 2 | the command line is wrong, or does not fit to the files that it names |
| 3 | the scene or the mesh is wrong, or a file cannot be read |
| 4 | the folder holds the run of another scene or version, another sweep, or other files |
| 5 | another process is writing to the folder |
| 6 | a file or a folder cannot be written |
| 130 | stopped by Ctrl-C, or a run of a sweep was killed; the same command without `--force` continues |

This page and `scene.schema.json`, the JSON schema for editors, are made of the structs that read scenes.
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
            Some(value) => format!("`{}`", as_written(value)),
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

/// The description of a part in one line, without its example.
fn text_of(part: &Value) -> String {
    let text = part["description"].as_str().unwrap_or_default();
    let text = text.split(EXAMPLE).next().unwrap_or_default();
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

#[cfg(test)]
mod tests;
