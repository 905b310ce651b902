//! What is made of the code: `docs/scene.md`, the pages of `docs/scene` and `docs/scene.schema.json` of the
//! structs that read scenes, the keys of scenes in the stubs of the Python module, and `docs/materials.md` of
//! the catalogue of materials.

mod index;
mod introduction;
mod keys;
mod materials;
mod places;
mod ranges;
mod scene;

use anyhow::{Context, Result};
use clap::Args;
use isosheet_files::{write_atomically, write_json};
use isosheet_scenes::schema;
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
    let pages = pages();
    let folder = args.out.join(scene::FOLDER);
    fs::create_dir_all(&folder).with_context(|| folder.display().to_string())?;
    for (name, page) in &pages {
        write_atomically(&args.out.join(name), |w| w.write_all(page.as_bytes()))?;
    }
    for old in superseded(&args.out, &pages)? {
        fs::remove_file(&old).with_context(|| old.display().to_string())?;
    }
    write_json(&args.out.join("scene.schema.json"), &schema())?;
    let stubs = fs::read_to_string(STUBS)?;
    let stubs = with_keys(&stubs).context("the stubs of Python have no class Scene")?;
    Ok(write_atomically(Path::new(STUBS), |w| {
        w.write_all(stubs.as_bytes())
    })?)
}

/// All pages, with their paths from the folder of the book.
fn pages() -> Vec<(String, String)> {
    let mut pages = scene::pages();
    pages.push(("materials.md".to_owned(), materials::page()));
    pages
}

/// The pages in the folder of tables whose tables exist no longer.
fn superseded(book: &Path, pages: &[(String, String)]) -> Result<Vec<PathBuf>> {
    let current: BTreeSet<PathBuf> = pages.iter().map(|(name, _)| book.join(name)).collect();
    let mut old = Vec::new();
    for entry in fs::read_dir(book.join(scene::FOLDER))? {
        let path = entry?.path();
        if path.extension().is_some_and(|e| e == "md") && !current.contains(&path) {
            old.push(path);
        }
    }
    Ok(old)
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

#[cfg(test)]
mod tests;
