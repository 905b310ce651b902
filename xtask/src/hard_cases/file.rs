//! Cases that are files: a scene, variations of it, and bounds for what its runs say of themselves.
//!
//! `xtask/cases/README.md` describes the files.

use super::case::{Case, Findings, Work};
use crate::interrupt;
use crate::report::{Bound, Effort, Limitation, Table};
use anyhow::{Context, Result, bail, ensure};
use isosheet_io::read_history;
use isosheet_io::run::{RunError, Sweep, Variation};
use isosheet_io::scene::SceneFile;
use rayon::prelude::*;
use serde::Deserialize;
use serde_json::{Value, json};
use std::collections::BTreeMap;
use std::path::{Path, PathBuf};
use std::sync::OnceLock;

/// The folder of the files.
const FOLDER: &str = concat!(env!("CARGO_MANIFEST_DIR"), "/cases");

/// The quantity that counts runs: those that stop before their end.
const STOPPED: &str = "stopped";

/// The contents of a file.
#[derive(Clone, Debug, Deserialize)]
#[serde(deny_unknown_fields)]
struct Contents {
    title: String,
    /// What should happen.
    expected: String,
    /// The scene, relative to the file.
    scene: PathBuf,
    /// Edits of the scene in quick reports.
    #[serde(default)]
    quick: Vec<String>,
    /// Keys of the scene and the values that they take: a list, or `"1..12"` for whole numbers.
    #[serde(default)]
    variants: BTreeMap<String, Values>,
    check: Vec<FileCheck>,
}

/// The values of a key.
#[derive(Clone, Debug, Deserialize)]
#[serde(untagged)]
enum Values {
    List(Vec<toml::Value>),
    Range(String),
}

/// A bound.
#[derive(Clone, Debug, Deserialize)]
#[serde(deny_unknown_fields)]
struct FileCheck {
    /// A number of the summary by its path, or `stopped`.
    quantity: String,
    /// The runs that it is for, by values of variants; all if left out.
    #[serde(default)]
    only: BTreeMap<String, toml::Value>,
    at_most: Option<f64>,
    at_least: Option<f64>,
    limitation: Option<Limitation>,
}

/// A case that is a file.
#[derive(Clone, Debug)]
pub(crate) struct CaseFile {
    contents: Contents,
    scene: PathBuf,
    /// The text of case and scene, which decide what is found.
    texts: [String; 2],
}

/// A run of a case, and what came of it.
struct Ran {
    edits: Vec<String>,
    /// The summary; of a run that stopped early only what its steps say.
    summary: Value,
    /// When and why it stopped early.
    stopped: Option<(f64, String)>,
}

/// The cases in the folder, by name.
///
/// # Panics
/// If a file of the folder is wrong; it says which and why.
pub(super) fn all() -> &'static [&'static Case] {
    static ALL: OnceLock<Vec<&'static Case>> = OnceLock::new();
    ALL.get_or_init(|| {
        let read = || -> Result<Vec<&'static Case>> {
            let mut paths = Vec::new();
            for entry in std::fs::read_dir(FOLDER)? {
                paths.push(entry?.path());
            }
            paths.retain(|p| p.extension().is_some_and(|e| e == "toml"));
            paths.sort();
            let cases = paths
                .iter()
                .map(|path| Ok(&*Box::leak(Box::new(case(path)?))));
            cases.collect()
        };
        read().unwrap_or_else(|error| panic!("{FOLDER}: {error:#}"))
    })
}

/// The case of a file.
fn case(path: &Path) -> Result<Case> {
    let file = CaseFile::read(path).with_context(|| path.display().to_string())?;
    let leak = |text: &str| -> &'static str { Box::leak(text.to_owned().into_boxed_str()) };
    let name = path.file_stem().unwrap_or_default().to_string_lossy();
    Ok(Case {
        name: leak(&name),
        title: leak(&file.contents.title),
        expected: leak(&file.contents.expected),
        run: Work::File(Box::leak(Box::new(file))),
    })
}

impl Values {
    /// As texts of TOML.
    fn texts(&self) -> Result<Vec<String>> {
        match self {
            Self::List(values) => Ok(values.iter().map(toml::Value::to_string).collect()),
            Self::Range(range) => {
                let ends = range.split_once("..").and_then(|(a, b)| {
                    let ends: (i64, i64) = (a.parse().ok()?, b.parse().ok()?);
                    Some(ends)
                });
                let (first, last) = ends
                    .filter(|(first, last)| first <= last)
                    .with_context(|| format!("`{range}` is no range such as `1..12`"))?;
                Ok((first..=last).map(|n| n.to_string()).collect())
            }
        }
    }
}

impl FileCheck {
    fn bounds(&self) -> impl Iterator<Item = Bound> {
        let bounds = [
            self.at_most.map(Bound::AtMost),
            self.at_least.map(Bound::AtLeast),
        ];
        bounds.into_iter().flatten()
    }

    /// Whether the check is for a run with these edits.
    fn is_for(&self, edits: &[String]) -> bool {
        let mut wanted = self.only.iter();
        wanted.all(|(key, value)| edits.contains(&format!("{key}={value}")))
    }

    /// The check in words.
    fn words(&self) -> String {
        let only = self
            .only
            .iter()
            .map(|(key, value)| format!("{key} = {value}"));
        let only: Vec<String> = only.collect();
        let runs = match only.is_empty() {
            true => "all runs".to_owned(),
            false => only.join(", "),
        };
        let quantity = match self.quantity.as_str() {
            STOPPED => "number that stop early",
            path => path,
        };
        format!("{runs}: {quantity}")
    }

    fn judge(&self, found: &mut Findings, runs: &[Ran]) -> Result<()> {
        let runs: Vec<&Ran> = runs.iter().filter(|run| self.is_for(&run.edits)).collect();
        ensure!(!runs.is_empty(), "no run is one of `{}`", self.words());
        for bound in self.bounds() {
            let check = match self.quantity.as_str() {
                STOPPED => {
                    let stopped: Vec<_> = runs.iter().filter_map(|r| r.stopped.as_ref()).collect();
                    let check = found.check(self.words(), stopped.len() as f64, bound);
                    check.remark(stopped.first().map(|(_, why)| why.clone()))
                }
                path => {
                    // The worst run: one without the number, or the one that is farthest on the wrong side.
                    let pointer = format!("/{}", path.replace('.', "/"));
                    let value = |run: &&Ran| run.summary.pointer(&pointer).and_then(Value::as_f64);
                    let badness =
                        |run: &&Ran| value(run).map_or(f64::INFINITY, |v| bound.badness(v));
                    let worst = runs.iter().max_by(|a, b| badness(a).total_cmp(&badness(b)));
                    let worst = worst.expect("there are runs");
                    if worst.stopped.is_none() && value(worst).is_none() {
                        bail!("the summary has no number `{path}`");
                    }
                    let check = found.check(self.words(), value(worst).unwrap_or(f64::NAN), bound);
                    check.stopped = worst.stopped.as_ref().map(|(t, _)| *t);
                    check.remark(worst.stopped.as_ref().map(|(_, why)| why.clone()))
                }
            };
            check.limitation.clone_from(&self.limitation);
        }
        Ok(())
    }
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
        let of_scene = std::fs::read_to_string(&scene);
        let of_scene = of_scene.with_context(|| scene.display().to_string())?;
        for check in &contents.check {
            let count = check.bounds().count();
            ensure!(
                count > 0,
                "`{}` has no bound: `at_most` or `at_least`",
                check.quantity
            );
            let limits = check.limitation.is_some();
            ensure!(
                count == 1 || !limits,
                "a limitation is of one bound: `{}`",
                check.quantity
            );
            for key in check.only.keys() {
                let known = contents.variants.contains_key(key);
                ensure!(known, "`{key}` of `only` is none of the variants");
            }
        }
        Ok(Self {
            contents,
            scene,
            texts: [text, of_scene],
        })
    }

    /// Everything that decides what is found.
    pub(super) fn options(&self) -> Value {
        json!(self.texts)
    }

    /// The edits of each run.
    fn runs(&self, effort: Effort) -> Result<Vec<Vec<String>>> {
        let edits = match effort {
            Effort::Quick => self.contents.quick.clone(),
            Effort::Standard | Effort::Full => Vec::new(),
        };
        let mut variations: Vec<Variation> = Vec::new();
        for (key, values) in &self.contents.variants {
            variations.push(format!("{key}={}", values.texts()?.join(",")).parse()?);
        }
        if variations.is_empty() {
            return Ok(vec![edits]);
        }
        let sweep = Sweep::new(&self.scene, Path::new("."), edits, variations)?;
        Ok(sweep.runs().map(|run| run.edits).collect())
    }

    /// Runs all variants, and judges what they say.
    pub(super) fn run(&self, found: &mut Findings, effort: Effort) -> Result<()> {
        let edits = self.runs(effort)?;
        let ran: Result<Vec<Ran>> = edits
            .into_par_iter()
            .with_max_len(1)
            .map(|edits| ran(&self.scene, edits))
            .collect();
        let ran = ran?;
        for check in &self.contents.check {
            check.judge(found, &ran)?;
        }
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
mod tests {
    use super::*;
    use crate::report::{Finding, Verdict};

    const SCENE: &str = "version = 1
        [sheet]
        mesh = { square = { side = 0.2, level = 0 } }
        [forces]
        gravity = [0, 0, -9.8]
        [stop]
        time = 0.1";

    /// The case with a scene of a falling sheet.
    fn read(case: &str) -> Result<CaseFile> {
        let folder = tempfile::tempdir()?;
        std::fs::write(folder.path().join("scene.toml"), SCENE)?;
        let path = folder.path().join("case.toml");
        std::fs::write(
            &path,
            format!("title = 't'\nexpected = 'e'\nscene = 'scene.toml'\n{case}"),
        )?;
        let mut file = CaseFile::read(&path)?;
        // The folder goes; the scene is wanted once more.
        let kept = folder.keep().join("scene.toml");
        file.scene = kept;
        Ok(file)
    }

    fn checks(case: &str) -> Vec<Finding> {
        let file = read(case).expect("right");
        let mut found = Findings::default();
        file.run(&mut found, Effort::Quick).expect("runs");
        std::fs::remove_dir_all(file.scene.parent().expect("a folder")).expect("a folder");
        found.checks
    }

    /// A sheet that falls freely has the speed `g t` at the end, and the worst of several runs counts.
    #[test]
    fn the_worst_run_is_judged() {
        let found = checks(
            "variants = { 'stop.time' = [0.1, 0.2] }
            [[check]]
            quantity = 'ending.largest_speed'
            at_most = 1.97
            at_least = 0.97
            [[check]]
            only = { 'stop.time' = 0.2 }
            quantity = 'ending.largest_speed'
            at_least = 1.95
            [[check]]
            quantity = 'stopped'
            at_most = 0",
        );
        let values: Vec<f64> = found.iter().map(|c| c.value.expect("a number")).collect();
        for (value, want) in values.iter().zip([1.96, 0.98, 1.96, 0.0]) {
            assert!((value - want).abs() < 1e-9, "{values:?}");
        }
        assert!(
            found.iter().all(|c| c.verdict() == Verdict::Passed),
            "{found:?}"
        );
    }

    /// A limitation has to be there.
    #[test]
    fn a_limitation_is_judged_on_both_sides() {
        for (range, verdict) in [
            ("[0.9, 1.1]", Verdict::Limitation),
            ("[1.5, 2.0]", Verdict::Improved),
            ("[0.6, 0.9]", Verdict::Failed),
        ] {
            let found = checks(&format!(
                "[[check]]
                quantity = 'ending.largest_speed'
                at_most = 0.5
                limitation = {{ why = 'it falls', between = {range} }}"
            ));
            assert_eq!(found[0].verdict(), verdict);
        }
    }

    /// A run that stops fails all bounds but those of what its accepted steps say.
    #[test]
    fn runs_that_stop_are_no_good() {
        let found = checks(
            "quick = ['method.integrator=projection', 'sheet.mesh.square.level=1', 'stop.time=1',
                'support=[{ at = { nearest = [[0, 0, 0], [0.2, 0.2, 0]] } }]']
            [[check]]
            quantity = 'ending.largest_speed'
            at_most = 1
            [[check]]
            quantity = 'largest_strain'
            at_most = 1e-12
            [[check]]
            quantity = 'stopped'
            at_most = 0",
        );
        let verdicts: Vec<Verdict> = found.iter().map(Finding::verdict).collect();
        assert_eq!(
            verdicts,
            [Verdict::Failed, Verdict::Passed, Verdict::Failed],
            "{found:?}"
        );
    }

    #[test]
    fn wrong_files_are_refused() {
        let said = |case: &str| format!("{:#}", read(case).expect_err("wrong"));
        let text = said("[[check]]\nquantity = 'stopped'");
        assert!(text.contains("`stopped` has no bound"), "{text}");
        let text = said("[[check]]\nquantity = 'stopped'\nat_most = 0\nonly = { 'a.b' = 1 }");
        assert!(
            text.contains("`a.b` of `only` is none of the variants"),
            "{text}"
        );
        let text = said("[[check]]\nquantity = 'stopped'\nat_mos = 0");
        assert!(text.contains("unknown field `at_mos`"), "{text}");
        let file = read("[[check]]\nquantity = 'speed'\nat_most = 0").expect("right");
        let error = file
            .run(&mut Findings::default(), Effort::Quick)
            .expect_err("wrong");
        assert!(error.to_string().contains("no number `speed`"), "{error}");
        let file = read("variants = { 'sheet.start.seed' = '3..1' }\ncheck = []").expect("right");
        let error = file
            .run(&mut Findings::default(), Effort::Quick)
            .expect_err("wrong");
        assert!(error.to_string().contains("`3..1` is no range"), "{error}");
    }

    #[test]
    fn the_files_of_the_folder_are_cases() {
        for case in all() {
            assert!(
                !case.title.is_empty() && case.expected.ends_with('.'),
                "{case:?}"
            );
        }
    }
}
