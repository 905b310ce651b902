//! A case: a scene, variations of it, and bounds for what its runs say of themselves.

use super::check::Check;
use super::variants::Variants;
use crate::interrupt;
use crate::report::{Effort, Finding, Table, columns};
use anyhow::{Context, Result, ensure};
use isosheet_formats::read_history;
use isosheet_runs::RunError;
use isosheet_scenes::SceneFile;
use rayon::prelude::*;
use serde::Deserialize;
use serde_json::{Value, json};
use std::fs;
use std::path::{Path, PathBuf};

/// The folder of the files.
const FOLDER: &str = concat!(env!("CARGO_MANIFEST_DIR"), "/cases");

/// The contents of a file.
#[derive(Clone, Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct CaseFile {
    pub(super) title: String,
    /// What should happen.
    pub(super) expected: String,
    /// The scene, relative to the file.
    scene: PathBuf,
    /// Edits of the scene in quick reports, after the edits of the variants.
    #[serde(default)]
    quick: Vec<String>,
    /// Edits of the scene in full reports, after the edits of the variants.
    #[serde(default)]
    full: Vec<String>,
    /// Each entry makes runs; without entries there is one run, of the scene as it is.
    #[serde(default)]
    variants: Vec<Variants>,
    check: Vec<Check>,
}

/// A case with the name of its file.
#[derive(Clone, Debug)]
pub(super) struct Case {
    pub(super) name: String,
    pub(super) contents: CaseFile,
    scene: PathBuf,
    /// The texts of case and scene and of all meshes beside the scene, which decide what is found.
    pub(super) texts: Vec<String>,
}

/// A run of a case, and what came of it.
#[derive(Debug)]
pub(super) struct CaseRun {
    pub(super) edits: Vec<String>,
    /// `summary.json`, or what the accepted steps say of a run that stopped early.
    numbers: Value,
    pub(super) stopped: Option<Stopped>,
}

/// When a run stopped early, seconds, and why.
#[derive(Debug)]
pub(super) struct Stopped {
    pub(super) time: f64,
    pub(super) why: String,
}

/// The name of a case, if there is one of that name.
pub(super) fn named(name: &str) -> Result<String, String> {
    let paths = of_kind(Path::new(FOLDER), "toml").map_err(|error| error.to_string())?;
    let names: Vec<String> = paths.iter().map(|path| stem(path)).collect();
    match names.iter().any(|known| known == name) {
        true => Ok(name.to_owned()),
        false => Err(format!("the cases are '{}'", names.join("', '"))),
    }
}

/// The cases in the folder, by name.
///
/// # Errors
/// What is wrong with a file of the folder.
pub(super) fn all() -> Result<Vec<Case>> {
    let paths = of_kind(Path::new(FOLDER), "toml").context(FOLDER)?;
    let read = |path: &PathBuf| Case::read(path).with_context(|| path.display().to_string());
    paths.iter().map(read).collect()
}

/// The name of a file without its extension.
fn stem(path: &Path) -> String {
    let stem = path.file_stem().unwrap_or_default();
    stem.to_string_lossy().into_owned()
}

/// The files of a folder whose names have an extension, in order.
fn of_kind(folder: &Path, extension: &str) -> Result<Vec<PathBuf>> {
    let mut paths = Vec::new();
    for entry in fs::read_dir(folder)? {
        paths.push(entry?.path());
    }
    paths.retain(|path| path.extension().is_some_and(|e| e == extension));
    paths.sort();
    Ok(paths)
}

impl Case {
    /// Reads and checks a file.
    ///
    /// # Errors
    /// What is wrong with it, or with its scene.
    fn read(path: &Path) -> Result<Self> {
        let text = fs::read_to_string(path)?;
        let contents: CaseFile = toml::from_str(&text)?;
        let folder = path.parent().unwrap_or(Path::new("."));
        let scene = folder.join(&contents.scene);
        let mut texts = vec![text];
        let meshes = of_kind(scene.parent().unwrap_or(Path::new(".")), "obj")?;
        for path in [&scene].into_iter().chain(&meshes) {
            texts.push(fs::read_to_string(path).with_context(|| path.display().to_string())?);
        }
        ensure!(!contents.check.is_empty(), "there is no check");
        for check in &contents.check {
            check.validate(&contents.variants)?;
        }
        Ok(Self {
            name: stem(path),
            contents,
            scene,
            texts,
        })
    }

    /// The edits of each run.
    fn runs(&self, effort: Effort) -> Result<Vec<Vec<String>>> {
        let last = effort.pick(&self.contents.quick[..], &[], &self.contents.full);
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

    /// Runs all variants, judges what they say, and tabulates them. A check may be for variants that reports
    /// of less effort do not have.
    pub(super) fn run(&self, effort: Effort) -> Result<(Vec<Finding>, Table)> {
        self.require_runs()?;
        let runs = self.runs(effort)?.into_par_iter().with_max_len(1);
        let runs: Result<Vec<CaseRun>> = runs.map(|edits| ran(&self.scene, edits)).collect();
        let runs = runs?;
        let mut findings = Vec::new();
        for check in &self.contents.check {
            let of: Vec<&CaseRun> = runs.iter().filter(|r| check.is_for(&r.edits)).collect();
            if !of.is_empty() {
                findings.extend(check.judge(&of)?);
            }
        }
        Ok((findings, self.table(&runs)))
    }

    fn table(&self, runs: &[CaseRun]) -> Table {
        let scene = self.scene.file_name().unwrap_or_default().to_string_lossy();
        let command = |run: &CaseRun| {
            let edits = run.edits.iter().map(|e| format!(" --set '{e}'"));
            format!("isosheet simulate {scene}{}", edits.collect::<String>())
        };
        Table::of(
            "The runs",
            runs,
            columns! { run;
                "command" => command(run),
                "steps" => run.number("steps"),
                "rejected" => run.number("rejected"),
                "edge strain" => run.number("largest_strain"),
                "smallest gap, m" => run.number("smallest_gap"),
                "energy drift at the end, J" => run.number("ending.energy_drift"),
                "stops early at, s" => run.stopped.as_ref().map(|stopped| stopped.time),
            },
        )
    }
}

impl CaseRun {
    /// A number by its place, such as `energy.least_potential`.
    pub(super) fn number(&self, place: &str) -> Option<f64> {
        let place = format!("/{}", place.replace('.', "/"));
        self.numbers.pointer(&place)?.as_f64()
    }
}

/// Runs a scene with edits.
fn ran(scene: &Path, edits: Vec<String>) -> Result<CaseRun> {
    interrupt::check()?;
    // Summaries alone are judged.
    let unseen = ["output.page=false", "output.trajectory=false"].map(str::to_owned);
    let file = SceneFile::read(scene, &[&edits[..], &unseen].concat())?;
    let folder = tempfile::tempdir()?;
    let folder = folder.path().join("run");
    let (numbers, stopped) = match interrupt::simulate(&file, &folder, &mut |_| ())? {
        Ok(summary) => (serde_json::to_value(summary)?, None),
        Err(error @ (RunError::Step(_) | RunError::Scene(_))) => {
            let rows = read_history(&folder.join("history.csv")).unwrap_or_default();
            let message = error.to_string();
            let stopped = Stopped {
                time: rows.last().map_or(0.0, |row| row.t),
                why: message.lines().next().unwrap_or_default().to_owned(),
            };
            let numbers = json!({
                "largest_strain": rows.iter().fold(0.0, |most, row| row.strain.max(most)),
                "smallest_gap": rows.iter().filter_map(|row| row.gap).reduce(f64::min),
            });
            (numbers, Some(stopped))
        }
        Err(error) => return Err(error.into()),
    };
    Ok(CaseRun {
        edits,
        numbers,
        stopped,
    })
}

#[cfg(test)]
mod tests;
