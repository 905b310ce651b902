//! Cases that are files: a scene, variations of it, and bounds for what its runs say of themselves.
//!
//! `xtask/cases/README.md` describes the files.

mod check;
mod variants;

use super::BESIDE;
use super::case::{Case, Findings, Work};
use crate::interrupt;
use crate::report::{Effort, Table};
use anyhow::{Context, Result, ensure};
use check::FileCheck;
use isosheet_io::read_history;
use isosheet_io::run::RunError;
use isosheet_io::scene::SceneFile;
use rayon::prelude::*;
use serde::Deserialize;
use serde_json::{Value, json};
use std::borrow::Cow;
use std::path::{Path, PathBuf};
use variants::Variants;

/// The folder of the files.
const FOLDER: &str = concat!(env!("CARGO_MANIFEST_DIR"), "/cases");

/// The contents of a file.
#[derive(Clone, Debug, Deserialize)]
#[serde(deny_unknown_fields)]
struct Contents {
    title: String,
    /// What should happen.
    expected: String,
    /// The scene, relative to the file.
    scene: PathBuf,
    /// Edits of the scene in quick reports, after those of the variants.
    #[serde(default)]
    quick: Vec<String>,
    /// The same in full reports.
    #[serde(default)]
    full: Vec<String>,
    /// The runs are those of all entries; without entries there is one, of the scene as it is.
    #[serde(default)]
    variants: Vec<Variants>,
    check: Vec<FileCheck>,
}

/// A case that is a file.
#[derive(Clone, Debug)]
pub(crate) struct CaseFile {
    contents: Contents,
    scene: PathBuf,
    /// The texts of case and scene and of all meshes beside the scene, which decide what is found.
    texts: Vec<String>,
}

/// A run of a case, and what came of it.
struct Ran {
    edits: Vec<String>,
    /// The summary; of a run that stopped early only what its steps say.
    summary: Value,
    /// When and why it stopped early.
    stopped: Option<(f64, String)>,
}

/// The names of the cases in the folder, whatever is in the files; none without the folder.
pub(super) fn names() -> Vec<&'static str> {
    let paths = of_kind(Path::new(FOLDER), "toml").unwrap_or_default();
    paths.iter().map(|path| leaked(&stem(path))).collect()
}

/// The cases in the folder, by name.
///
/// # Errors
/// What is wrong with a file of the folder.
pub(super) fn all() -> Result<Vec<&'static Case>> {
    let paths = of_kind(Path::new(FOLDER), "toml").context(FOLDER)?;
    let cases = paths
        .iter()
        .map(|path| Ok(&*Box::leak(Box::new(case(path)?))));
    cases.collect()
}

/// The name of a file without its extension.
fn stem(path: &Path) -> Cow<'_, str> {
    path.file_stem().unwrap_or_default().to_string_lossy()
}

/// A text for as long as the program runs.
fn leaked(text: &str) -> &'static str {
    Box::leak(text.to_owned().into_boxed_str())
}

/// The files of a folder whose names have an extension, in order.
fn of_kind(folder: &Path, extension: &str) -> Result<Vec<PathBuf>> {
    let mut paths = Vec::new();
    for entry in std::fs::read_dir(folder)? {
        paths.push(entry?.path());
    }
    paths.retain(|path| path.extension().is_some_and(|e| e == extension));
    paths.sort();
    Ok(paths)
}

/// The case of a file.
fn case(path: &Path) -> Result<Case> {
    let file = CaseFile::read(path).with_context(|| path.display().to_string())?;
    let name = stem(path);
    let beside = BESIDE
        .iter()
        .find(|(of, _)| *of == name)
        .map(|(_, code)| *code);
    Ok(Case {
        name: leaked(&name),
        title: leaked(&file.contents.title),
        expected: leaked(&file.contents.expected),
        run: Work::File(Box::leak(Box::new(file)), beside),
    })
}

impl CaseFile {
    /// Reads and checks a file.
    ///
    /// # Errors
    /// What is wrong with it, or with its scene.
    fn read(path: &Path) -> Result<Self> {
        let text = std::fs::read_to_string(path)?;
        let contents: Contents = toml::from_str(&text)?;
        let scene = path
            .parent()
            .unwrap_or(Path::new("."))
            .join(&contents.scene);
        let read = |path: &Path| {
            let text = std::fs::read_to_string(path);
            text.with_context(|| path.display().to_string())
        };
        let mut texts = vec![text, read(&scene)?];
        for mesh in of_kind(scene.parent().unwrap_or(Path::new(".")), "obj")? {
            texts.push(read(&mesh)?);
        }
        ensure!(!contents.check.is_empty(), "there is no check");
        for check in &contents.check {
            check.validate(&contents.variants)?;
        }
        Ok(Self {
            contents,
            scene,
            texts,
        })
    }

    /// Everything that decides what is found.
    pub(super) fn options(&self) -> Value {
        json!(self.texts)
    }

    /// The edits of each run.
    fn runs(&self, effort: Effort) -> Result<Vec<Vec<String>>> {
        let last = match effort {
            Effort::Quick => &self.contents.quick[..],
            Effort::Standard => &[],
            Effort::Full => &self.contents.full,
        };
        let mut runs = Vec::new();
        for variants in &self.contents.variants {
            runs.extend(variants.edits(&self.scene, effort)?);
        }
        if self.contents.variants.is_empty() {
            runs.push(Vec::new());
        }
        for edits in &mut runs {
            edits.extend_from_slice(last);
        }
        Ok(runs)
    }

    /// Whether each check is for a run of full reports, which have the runs of all others.
    fn require_runs(&self) -> Result<()> {
        let runs = self.runs(Effort::Full)?;
        for check in &self.contents.check {
            let any = runs.iter().any(|edits| check.is_for(edits));
            ensure!(any, "no run is one of `{}`", check.words());
        }
        Ok(())
    }

    /// Judges what runs say. A check may be for variants that reports of less effort do not have.
    fn judge(&self, found: &mut Findings, ran: &[Ran]) -> Result<()> {
        for check in &self.contents.check {
            let runs: Vec<&Ran> = ran.iter().filter(|r| check.is_for(&r.edits)).collect();
            if !runs.is_empty() {
                check.judge(found, &runs)?;
            }
        }
        Ok(())
    }

    /// Runs all variants, and judges what they say.
    pub(super) fn run(&self, found: &mut Findings, effort: Effort) -> Result<()> {
        self.require_runs()?;
        let edits = self.runs(effort)?;
        let ran: Result<Vec<Ran>> = edits
            .into_par_iter()
            .with_max_len(1)
            .map(|edits| ran(&self.scene, edits))
            .collect();
        let ran = ran?;
        self.judge(found, &ran)?;
        let name = self.scene.file_name().unwrap_or_default().to_string_lossy();
        let command = |run: &Ran| {
            let edits = run.edits.iter().map(|e| format!(" --set '{e}'"));
            format!("isosheet simulate {name}{}", edits.collect::<String>())
        };
        let of = |run: &Ran, path: &str| run.summary.pointer(path).and_then(Value::as_f64).into();
        found.tables.push(Table::of(
            "The runs",
            &ran,
            &[
                ("command", &|run| command(run).into()),
                ("steps", &|run| of(run, "/steps")),
                ("rejected", &|run| of(run, "/rejected")),
                ("edge strain", &|run| of(run, "/largest_strain")),
                ("smallest gap, m", &|run| of(run, "/smallest_gap")),
                ("energy drift at the end, J", &|run| {
                    of(run, "/ending/energy_drift")
                }),
                ("stops early at, s", &|run| {
                    run.stopped.as_ref().map(|(t, _)| *t).into()
                }),
            ],
        ));
        found.here = "The summaries of all runs of a scene are judged. Largest strains and smallest gaps are of all accepted steps, those of runs that \
                      stop early included.";
        Ok(())
    }
}

/// Runs a scene with edits.
fn ran(scene: &Path, edits: Vec<String>) -> Result<Ran> {
    interrupt::check()?;
    // Summaries alone are judged.
    let unseen = ["output.page=false", "output.trajectory=false"].map(str::to_owned);
    let file = SceneFile::read(scene, &[&edits[..], &unseen].concat())?;
    let folder = tempfile::tempdir()?;
    let folder = folder.path().join("run");
    let (summary, stopped) = match interrupt::simulate(&file, &folder, &mut |_| ())? {
        Ok(summary) => (serde_json::to_value(summary)?, None),
        Err(error @ (RunError::Step(_) | RunError::Scene(_))) => {
            let rows = read_history(&folder.join("history.csv")).unwrap_or_default();
            let strain = rows.iter().fold(0.0_f64, |most, row| most.max(row.strain));
            let gaps = rows.iter().filter_map(|row| row.gap);
            let summary = json!({
                "largest_strain": strain,
                "smallest_gap": gaps.reduce(f64::min),
            });
            let time = rows.last().map_or(0.0, |row| row.t);
            let why = error
                .to_string()
                .lines()
                .next()
                .unwrap_or_default()
                .to_owned();
            (summary, Some((time, why)))
        }
        Err(error) => return Err(error.into()),
    };
    Ok(Ran {
        edits,
        summary,
        stopped,
    })
}

#[cfg(test)]
mod tests;
