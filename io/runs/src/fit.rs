//! Finds values of keys of a scene with which its run ends as is asked for.

mod error;
mod least_squares;
mod range;
mod target;

pub use error::FitError;
pub use range::FitRange;
pub use target::FitTarget;

use crate::{Recording, RunError, simulate_recorded};
use isosheet_files::DataError;
use isosheet_formats::read_mesh;
use isosheet_mesh::wording::given;
use isosheet_scenes::{Edit, SceneFile};
use least_squares::{DETERMINED, DIFFERENCE, Minimum, Point, combinations, least_squares};
use nalgebra::DVector;
use std::cell::Cell;
use std::num::NonZero;
use std::ops::ControlFlow;
use std::panic::resume_unwind;
use std::path::{Path, PathBuf};

/// Where the runs of a fit end.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum FitRuns {
    /// Where the scene says.
    Motion,
    /// At the equilibrium, as [`Scene::at_rest`](isosheet_scenes::Scene::at_rest) finds it.
    Rest,
}

/// A scene, the keys that are varied, and what its run is to end with.
///
/// The fit minimises the sum of `((found - asked) / sigma)^2` over all targets, with `sigma = 1` where no
/// target has one, by the method of Gauss and Newton with the damping of Levenberg and Marquardt (Marquardt
/// 1963) and derivatives by differences. A step takes two runs for each key, and one or more besides.
#[derive(Clone, Debug)]
pub struct Fit {
    path: PathBuf,
    edits: Vec<String>,
    ranges: Vec<FitRange>,
    targets: Vec<Wanted>,
    runs: FitRuns,
    start: Vec<f64>,
    notes: Vec<String>,
}

/// A target with what its runs are compared with.
#[derive(Clone, Debug)]
struct Wanted {
    target: FitTarget,
    unit: String,
    /// The positions of the mesh.
    positions: Vec<f64>,
}

/// How far a search has come.
#[derive(Clone, Debug)]
pub struct FitProgress {
    /// The runs that were made.
    pub runs: usize,
    /// The keys with their values.
    pub values: Vec<(String, f64)>,
    /// The root of the mean square of the differences: in the unit of the targets, or by their standard
    /// deviations.
    pub rms: f64,
    /// The scene with these values; none at the start of the search.
    pub scene: Option<SceneFile>,
}

/// What was found of a key.
#[derive(Clone, Debug, PartialEq)]
pub struct FittedValue {
    /// The key.
    pub key: String,
    /// Its value.
    pub value: f64,
    /// The standard deviation: the root of the diagonal of `s^2 (J^T J)^-1` with the derivatives `J` of the
    /// differences. `s` is 1 where targets have standard deviations, and otherwise the root of the sum of the
    /// squares over the number of values less that of keys. None where there are no more values than keys, at
    /// an end of the range, and of a key that is not determined.
    pub deviation: Option<f64>,
    /// Whether the targets determine it, and no combination of it with others alone.
    pub is_determined: bool,
    /// Whether it is at an end of its range.
    pub is_at_end: bool,
}

/// What a run ends with beside what was asked for.
#[derive(Clone, Debug, PartialEq)]
pub struct ReachedTarget {
    /// The target.
    pub target: FitTarget,
    /// The value of a measure, or the root of the mean square of the distances from the vertices of a mesh,
    /// metres.
    pub found: f64,
    /// Its difference from what was asked for, over that at the start of the search or the standard
    /// deviation.
    pub part: f64,
    /// The unit of the value.
    pub unit: String,
}

/// What a fit found.
#[derive(Clone, Debug)]
pub struct Fitted {
    /// The values of the keys.
    pub values: Vec<FittedValue>,
    /// What the run ends with.
    pub targets: Vec<ReachedTarget>,
    /// The root of the mean square of the differences, as [`FitProgress::rms`].
    pub rms: f64,
    /// The number of runs.
    pub runs: usize,
    /// Whether the search came to its end.
    pub is_found: bool,
    /// The number of runs that failed, and why the last one did.
    pub failed: Option<(usize, String)>,
    /// The scene with the values.
    pub scene: SceneFile,
}

/// The largest difference of a measure that is met without a standard deviation, a part of the one at the
/// start of the search.
const MET: f64 = 1e-3;

impl ReachedTarget {
    /// Whether the run ends as is asked for: a target with a standard deviation within it, a measure without
    /// one to a thousandth of the difference at the start. Of a mesh without one the distance alone is told.
    pub fn is_met(&self) -> bool {
        match (&self.target, self.target.sigma()) {
            (_, Some(_)) => self.part <= 1.0,
            (FitTarget::Measure { .. }, None) => self.part <= MET,
            (FitTarget::Mesh { .. }, None) => true,
        }
    }
}

impl Fit {
    /// Reads the scene with edits, and checks keys and targets.
    ///
    /// # Errors
    /// [`FitError`], before anything is run.
    pub fn new(
        path: &Path,
        edits: Vec<String>,
        ranges: Vec<FitRange>,
        targets: Vec<FitTarget>,
        runs: FitRuns,
    ) -> Result<Self, FitError> {
        check_keys(&ranges)?;
        if targets.is_empty() {
            let remedy = "name a measure of the scene, `tip=-0.05`, or a mesh file";
            return Err(FitError::Keys(DataError::new("no target is given", remedy)));
        }
        let file = SceneFile::read(path, &edits)?;
        let mut notes = Vec::new();
        let mut start = Vec::new();
        for range in &ranges {
            let value = file.number(range.place());
            start.push(value.map_or(0.5, |value| range.part(value)));
            let [from, to] = range.ends();
            if let Some(value) = value.filter(|value| !(from..=to).contains(value)) {
                notes.push(format!(
                    "the search begins at an end of the range of `{}`, which is {} in the scene",
                    range.key(),
                    given(value)
                ));
            }
        }
        let mut fit = Self {
            path: path.to_owned(),
            edits,
            ranges,
            targets: Vec::new(),
            runs,
            start,
            notes,
        };
        let built = fit.scene(&fit.start).and_then(|file| Ok(file.build()?));
        let setup = built.map_err(|error| {
            let takes = |range: &FitRange, value: String| {
                SceneFile::read(path, &[format!("{}={value}", range.key())]).is_ok()
            };
            let is_whole = |range: &&FitRange| {
                let value = range.value(0.5).round();
                takes(range, format!("{value}")) && !takes(range, format!("{value:?}"))
            };
            match fit.ranges.iter().find(is_whole) {
                Some(range) => FitError::Whole {
                    key: range.key().to_owned(),
                },
                None => FitError::Scene(error),
            }
        })?;
        for target in targets {
            let wanted = match &target {
                FitTarget::Measure { name, .. } => {
                    let gauges = &setup.measures;
                    let Some(gauge) = gauges.iter().find(|gauge| gauge.name == *name) else {
                        let known = gauges.iter().map(|gauge| format!("`{}`", gauge.name));
                        return Err(FitError::NoMeasure {
                            name: name.clone(),
                            known: known.collect(),
                        });
                    };
                    let unit = gauge.unit().to_owned();
                    Wanted {
                        target,
                        unit,
                        positions: Vec::new(),
                    }
                }
                FitTarget::Mesh { path, .. } => {
                    let mesh = read_mesh(path)?;
                    let expected = setup.sheet.topology().vertex_count();
                    if mesh.vertex_count() != expected {
                        return Err(FitError::Vertices {
                            path: path.clone(),
                            found: mesh.vertex_count(),
                            expected,
                        });
                    }
                    Wanted {
                        target,
                        unit: "m".to_owned(),
                        positions: mesh.positions,
                    }
                }
            };
            fit.targets.push(wanted);
        }
        if fit.has_sigmas() {
            return Ok(fit);
        }
        let mut units = fit.targets.iter().map(|wanted| &wanted.unit);
        let first = units.next().cloned().unwrap_or_default();
        let given = fit
            .targets
            .iter()
            .filter(|wanted| wanted.target.sigma().is_some())
            .count();
        match units.find(|unit| **unit != first) {
            Some(other) => Err(FitError::Units {
                units: [first, other.clone()],
            }),
            None if given > 0 => {
                let message = "some targets have a standard deviation, and others have none";
                let remedy = "give it for all of them, or for none";
                Err(FitError::Keys(DataError::new(message, remedy)))
            }
            None => Ok(fit),
        }
    }

    /// What to know before the search.
    pub fn notes(&self) -> &[String] {
        &self.notes
    }

    fn has_sigmas(&self) -> bool {
        self.targets
            .iter()
            .all(|wanted| wanted.target.sigma().is_some())
    }

    /// The edits of a point.
    fn edits_at(&self, at: &[f64]) -> Vec<String> {
        let edit =
            |(range, part): (&FitRange, &f64)| format!("{}={:?}", range.key(), range.value(*part));
        self.ranges.iter().zip(at).map(edit).collect()
    }

    /// The scene of a point.
    fn scene(&self, at: &[f64]) -> Result<SceneFile, isosheet_scenes::SceneFileError> {
        // (A key that is set and varied has the value of the point alone.)
        let is_varied = |edit: &&String| {
            let edit: Option<Edit> = edit.parse().ok();
            edit.is_some_and(|edit| self.ranges.iter().any(|range| *range.place() == edit.key))
        };
        let own = self.edits.iter().filter(|edit| !is_varied(edit)).cloned();
        let edits: Vec<String> = own.chain(self.edits_at(at)).collect();
        SceneFile::read(&self.path, &edits)
    }

    /// The differences of a run from the targets, over their standard deviations.
    fn differences(&self, run: &Recording) -> DVector<f64> {
        let mut all = Vec::new();
        for wanted in &self.targets {
            let sigma = wanted.target.sigma().unwrap_or(1.0);
            match &wanted.target {
                FitTarget::Measure { name, value, .. } => {
                    all.push((last_of(run, name) - value) / sigma);
                }
                FitTarget::Mesh { .. } => {
                    let frames = &run.trajectory;
                    let end = frames.len().checked_sub(1).and_then(|k| frames.frame(k));
                    let pairs = end.unwrap_or_default().iter().zip(&wanted.positions);
                    all.extend(pairs.map(|(x, y)| (x - y) / sigma));
                }
            }
        }
        DVector::from_vec(all)
    }

    /// Makes the run of a point in a folder.
    fn run_at(
        &self,
        at: &[f64],
        folder: &Path,
        watch: &(dyn Fn() -> ControlFlow<()> + Sync),
    ) -> Result<DVector<f64>, FitError> {
        // (A run of one step asks nobody before its end.)
        if watch().is_break() {
            return Err(FitError::Interrupted);
        }
        let failed = |source: RunError| FitError::Run {
            edits: self.edits_at(at).join(", "),
            source,
        };
        let file = self.scene(at).map_err(|e| failed(e.into()))?;
        let file = match self.runs {
            FitRuns::Motion => file,
            FitRuns::Rest => {
                let (scene, keys) = file.scene().at_rest();
                file.changed(scene, keys)
                    .map_err(|e| failed(RunError::Scene(e)))?
            }
        };
        let mut scene = file.scene().clone();
        scene.output.page = false;
        let page = "output.page".parse().expect("a key");
        let file = file
            .changed(scene, [page])
            .map_err(|e| failed(RunError::Scene(e)))?;
        let done = simulate_recorded(&file, folder, &mut |_: &_| watch());
        let recorded = done.map_err(failed)?.ok_or(FitError::Interrupted)?;
        // (A folder that stays is in the way of nobody: the system clears its temporary files.)
        let _ = std::fs::remove_dir_all(folder);
        Ok(self.differences(&recorded))
    }

    /// Makes the runs of some points at once.
    fn run_all<'p>(
        &self,
        points: &'p [Vec<f64>],
        folder: &Path,
        jobs: NonZero<usize>,
        watch: &(dyn Fn() -> ControlFlow<()> + Sync),
    ) -> Vec<Result<DVector<f64>, FitError>> {
        let mut found = Vec::with_capacity(points.len());
        for points in points.chunks(jobs.get()) {
            std::thread::scope(|scope| {
                let run = |(k, at): (usize, &'p Vec<f64>)| {
                    scope.spawn(move || self.run_at(at, &folder.join(k.to_string()), watch))
                };
                let runs: Vec<_> = points.iter().enumerate().map(run).collect();
                let ended = runs.into_iter().map(|run| run.join());
                found.extend(ended.map(|run| run.unwrap_or_else(|panic| resume_unwind(panic))));
            });
        }
        found
    }

    /// Finds the values, with `jobs` runs at a time in a folder for temporary files. The result does not
    /// depend on `jobs`. `progress` is told each step; `watch` ends the search.
    ///
    /// # Errors
    /// [`FitError`] if a run at the start fails, or a key has no effect. A run that fails elsewhere shortens
    /// the step that led to it.
    pub fn run(
        &self,
        folder: &Path,
        jobs: NonZero<usize>,
        watch: &(dyn Fn() -> ControlFlow<()> + Sync),
        progress: &mut dyn FnMut(&FitProgress),
    ) -> Result<Fitted, FitError> {
        let mut found = self.run_all(std::slice::from_ref(&self.start), folder, jobs, watch);
        let Some(differences) = found.pop() else {
            return Err(FitError::Interrupted);
        };
        let start = Point {
            at: self.start.clone(),
            differences: differences?,
        };
        let runs = Cell::new(1);
        let mut failures = Vec::new();
        let mut evaluate = |points: &[Vec<f64>]| {
            runs.set(runs.get() + points.len());
            let found = self.run_all(points, folder, jobs, watch).into_iter();
            let one = |found: Result<_, FitError>| match found {
                Ok(differences) => Ok(Some(differences)),
                Err(FitError::Interrupted) => Err(FitError::Interrupted),
                Err(error) => {
                    failures.push(error);
                    Ok(None)
                }
            };
            found.map(one).collect()
        };
        let mut tell = |point: &Point| {
            let values = self.ranges.iter().zip(&point.at);
            progress(&FitProgress {
                runs: runs.get(),
                values: values
                    .map(|(r, part)| (r.key().to_owned(), r.value(*part)))
                    .collect(),
                rms: rms(&point.differences),
                scene: match runs.get() {
                    1 => None,
                    _ => self.scene(&point.at).ok(),
                },
            });
        };
        let minimum = least_squares(start.clone(), &mut evaluate, &mut tell)?;
        let Some(minimum) = minimum else {
            return Err(failures.pop().unwrap_or(FitError::Interrupted));
        };
        let last = failures.last().map(|error| {
            let text = error.to_string();
            text.lines().next().unwrap_or_default().to_owned()
        });
        let failed = last.map(|why| (failures.len(), why));
        self.fitted(&start, &minimum, runs.get(), failed)
    }

    /// What was found, in words of the scene.
    fn fitted(
        &self,
        start: &Point,
        minimum: &Minimum,
        runs: usize,
        failed: Option<(usize, String)>,
    ) -> Result<Fitted, FitError> {
        let Minimum {
            point,
            jacobian,
            is_found,
        } = minimum;
        let at_end = |part: f64| part <= 0.0 || part >= 1.0;
        for (k, column) in jacobian.column_iter().enumerate() {
            let range = &self.ranges[k];
            if column.iter().all(|slope| *slope == 0.0) {
                return Err(FitError::NoEffect {
                    key: range.key().to_owned(),
                    step: DIFFERENCE * range.slope(point.at[k]),
                    value: range.value(point.at[k]),
                });
            }
        }
        let free: Vec<usize> = (0..point.at.len())
            .filter(|k| !at_end(point.at[*k]))
            .collect();
        let spare = point.differences.len().saturating_sub(free.len());
        let variance = match (self.has_sigmas(), spare) {
            (true, _) => Some(1.0),
            (false, 0) => None,
            (false, spare) => Some(point.cost() / spare as f64),
        };
        let own = jacobian.select_columns(&free);
        let (sizes, vectors, lengths) = combinations(&own);
        let vectors = &vectors;
        let largest = sizes.iter().copied().fold(0.0, f64::max);
        let is_weak = |n: usize| sizes[n] <= DETERMINED * largest;
        let value = |(k, range): (usize, &FitRange)| {
            let place = free.iter().position(|own| *own == k);
            // A combination that is not determined has parts of the keys that are not.
            let parts = |own: usize| (0..free.len()).map(move |n| (n, vectors[(own, n)]));
            let weak = place.map_or(0.0, |own| {
                parts(own)
                    .filter(|(n, _)| is_weak(*n))
                    .map(|(_, part)| part * part)
                    .sum::<f64>()
            });
            let is_determined = weak <= DETERMINED;
            let own = place.filter(|_| is_determined).zip(variance);
            let deviation = own.map(|(own, variance)| {
                let strong = parts(own).filter(|(n, _)| !is_weak(*n));
                let sum: f64 = strong.map(|(n, part)| (part / sizes[n]).powi(2)).sum();
                (variance * sum).sqrt() / lengths[own] * range.slope(point.at[k])
            });
            FittedValue {
                key: range.key().to_owned(),
                value: range.value(point.at[k]),
                deviation,
                is_determined,
                is_at_end: at_end(point.at[k]),
            }
        };
        let mut from = 0;
        let targets = self.targets.iter().map(|wanted| {
            let count = wanted.positions.len().max(1);
            let [first, last] = [start, point].map(|p| p.differences.rows(from, count).norm());
            let own = point.differences.rows(from, count);
            from += count;
            let sigma = wanted.target.sigma();
            let vertices = (wanted.positions.len() / 3) as f64;
            let (found, scale) = match &wanted.target {
                FitTarget::Measure { value, .. } => (value + own[0] * sigma.unwrap_or(1.0), 1.0),
                FitTarget::Mesh { .. } => {
                    let root = vertices.sqrt();
                    (last * sigma.unwrap_or(1.0) / root, (3.0 * vertices).sqrt())
                }
            };
            ReachedTarget {
                target: wanted.target.clone(),
                found,
                part: match sigma {
                    Some(_) => last / scale,
                    None => last / first.max(f64::MIN_POSITIVE),
                },
                unit: wanted.unit.clone(),
            }
        });
        let targets = targets.collect();
        Ok(Fitted {
            values: self.ranges.iter().enumerate().map(value).collect(),
            targets,
            rms: rms(&point.differences),
            runs,
            is_found: *is_found,
            failed,
            scene: self.scene(&point.at)?,
        })
    }
}

fn rms(differences: &DVector<f64>) -> f64 {
    (differences.norm_squared() / differences.len().max(1) as f64).sqrt()
}

/// The last value of a measure.
fn last_of(run: &Recording, name: &str) -> f64 {
    let own = run.measures.iter().rfind(|row| row.name == name);
    own.map_or(f64::NAN, |row| row.value)
}

/// Refuses fits without a key, and keys that change one another.
fn check_keys(ranges: &[FitRange]) -> Result<(), FitError> {
    let wrong = |message: String, remedy| Err(FitError::Keys(DataError::new(message, remedy)));
    if ranges.is_empty() {
        return wrong("no key is varied".to_owned(), "give `--vary KEY=FROM..TO`");
    }
    for (k, range) in ranges.iter().enumerate() {
        let overlaps = |other: &&FitRange| {
            let (own, other) = (range.place(), other.place());
            own.is_within(other) || other.is_within(own)
        };
        if let Some(other) = ranges[..k].iter().find(overlaps) {
            let message = format!("`{}` and `{}` change one value", other.key(), range.key());
            return wrong(message, "leave one of them out");
        }
    }
    Ok(())
}
