//! Runs of scenes of which figures are made, as `isosheet simulate` makes them, made once in DIR/runs.

use super::{Course, FigureScene};
use crate::interrupt;
use crate::progress::Progress;
use crate::report::Cost;
use crate::store::{Files, Store, Unit};
use anyhow::{Result, ensure};
use isosheet_formats::{HistoryRow, LoadKind, LoadRow, Trajectory};
use isosheet_mesh::Sheet;
use isosheet_mesh::wording::brief;
use isosheet_runs::{ElasticSummary, Recording, Summary, Tick};
use serde::{Deserialize, Serialize};
use std::fs;
use std::path::Path;

/// A run of rods with an edge strain from here on is an error: figures of rods promise that nothing
/// stretches.
const STRAIN: f64 = 1e-10;

/// A sheet with less kinetic energy than this part of the potential energy released is at rest.
const REST: f64 = 1e-6;

/// What a run did.
#[derive(Clone, Debug, Default)]
pub(crate) struct RunSummary {
    pub(crate) vertices: usize,
    pub(crate) faces: usize,
    /// Its steps are the frames after the first.
    pub(crate) course: Course,
    pub(crate) frames_per_second: f64,
    /// Shortest and longest step, seconds; where a frame was subdivided, the mean of its sub-steps counts.
    /// `None` without a step.
    pub(crate) step_range: Option<[f64; 2]>,
    /// The energy balance at the end.
    pub(crate) energy: Energy,
    /// Time from which the kinetic energy stays below [`REST`] of the potential energy released, seconds.
    pub(crate) at_rest_from: Option<f64>,
    /// Kinetic energy at the end as part of the potential energy released.
    pub(crate) motion_left: f64,
    /// How an elastic sheet was deformed; none for rods.
    pub(crate) elastic: Option<ElasticSummary>,
}

/// Where the energy went, joules.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct Energy {
    /// Potential energy at the start less that at the end.
    pub(crate) released: f64,
    /// Work of moving bodies and applied forces.
    pub(crate) work: f64,
    /// Taken out by velocity damping.
    pub(crate) damped: f64,
    /// Lost to friction.
    pub(crate) friction: f64,
    /// Dissipated by yielding.
    pub(crate) plastic: f64,
    /// What the balance lacks: the error of the integrator.
    pub(crate) drift: f64,
}

impl RunSummary {
    /// What the rows of a run and its summary say, and what its steps took.
    fn new(summary: &Summary, rows: &[HistoryRow], times: Times) -> Self {
        let (first, steps) = rows
            .split_first()
            .map_or((None, rows), |(f, s)| (Some(f), s));
        let start = first.copied().unwrap_or_default();
        let cost = Cost {
            steps: steps.len(),
            substeps: steps.iter().map(|row| row.substeps).sum(),
            rejected: steps.iter().map(|row| row.rejected).sum(),
            iterations: steps.iter().map(|row| row.iterations).sum(),
            factorisations: steps.iter().map(|row| row.factorisations).sum(),
            wall: times.wall,
            cpu: times.cpu,
        };
        let lengths = || steps.iter().map(|row| row.h / row.substeps.max(1) as f64);
        let range = lengths().reduce(f64::min).zip(lengths().reduce(f64::max));
        // Kinetic energy as part of the potential energy released; nothing where none is.
        let motion = |row: &HistoryRow| {
            let released = start.total - row.potential;
            (released > 0.0).then(|| row.kinetic / released)
        };
        let moves = |row: &HistoryRow| motion(row).is_none_or(|part| part >= REST);
        let quiet = steps.iter().rposition(moves).map_or(0, |last| last + 1);
        let last = steps.last().copied().unwrap_or(start);
        Self {
            vertices: summary.vertices,
            faces: summary.faces,
            course: Course {
                time: last.t,
                cost,
                worst: steps
                    .iter()
                    .map(|row| row.factorisations)
                    .max()
                    .unwrap_or(0),
                strain: summary.largest_strain,
                gap: summary.smallest_gap,
                speed: summary.ending.largest_speed,
                ..Course::default()
            },
            frames_per_second: cost.steps as f64 / times.wall.max(1e-9),
            step_range: range.map(|(low, high)| [low, high]),
            energy: Energy {
                released: start.total - last.potential,
                work: last.work,
                damped: last.damped,
                friction: last.friction,
                plastic: last.plastic.unwrap_or(0.0),
                drift: summary.ending.energy_drift,
            },
            at_rest_from: steps.get(quiet).map(|row| row.t),
            motion_left: motion(&last).unwrap_or(0.0),
            elastic: summary.elastic,
        }
    }

    /// Vertices and faces of the mesh.
    pub(crate) fn mesh(&self) -> String {
        format!("{}/{}", self.vertices, self.faces)
    }

    /// Largest strain: of an edge of rods, of a face of an elastic sheet.
    pub(crate) fn strain(&self) -> f64 {
        self.elastic.map_or(self.course.strain, |e| e.strain)
    }

    /// Membrane stiffness of an elastic sheet, in words.
    pub(crate) fn stiffness(&self) -> Option<String> {
        let e = self.elastic?;
        Some(format!("{} N/m", brief(e.stiffness)))
    }

    /// What every run has to keep.
    fn check(&self) -> Result<()> {
        let strain = self.strain();
        let limit = self.elastic.map_or(STRAIN, |e| e.limit);
        ensure!(
            strain < limit,
            "the largest strain is {strain:e}, {limit:e} is the limit"
        );
        // Not a number is no gap either.
        let gap = self.course.gap;
        ensure!(
            gap.is_none_or(|g| g > 0.0),
            "the smallest gap is {gap:?} m: something touches"
        );
        Ok(())
    }
}

/// A run that has been made.
#[derive(Clone, Debug)]
pub(crate) struct Run {
    pub(crate) scene: FigureScene,
    pub(crate) sheet: Sheet,
    pub(crate) summary: RunSummary,
    pub(crate) trajectory: Trajectory,
    /// A row for the start and for each frame.
    pub(crate) history: Vec<HistoryRow>,
    loads: Vec<LoadRow>,
}

impl Run {
    /// An up-to-date run of the scene, which is made now when there is none.
    ///
    /// # Errors
    /// [`Interrupted`](interrupt::Interrupted) after Ctrl-C; errors of the simulation.
    pub(crate) fn of(store: &Store, scene: FigureScene) -> Result<Self> {
        let (summary, times, recorded) = kept(store, &scene)?;
        Self::new(scene, &summary, times, recorded)
    }

    /// A run that is made now and of which nothing is kept but what the caller takes from it.
    ///
    /// # Errors
    /// As [`Run::of`]; errors of temporary files.
    pub(super) fn passing(scene: FigureScene) -> Result<Self> {
        let folder = tempfile::tempdir()?;
        let (summary, times) = simulate(&scene, folder.path(), &mut || ())?;
        let recorded = Recording::read(folder.path())?;
        Self::new(scene, &summary, times, recorded)
    }

    fn new(
        scene: FigureScene,
        summary: &Summary,
        times: Times,
        recorded: Recording,
    ) -> Result<Self> {
        let summary = RunSummary::new(summary, &recorded.history, times);
        summary.check()?;
        Ok(Self {
            sheet: recorded.facts.sheet.clone(),
            trajectory: recorded.trajectory,
            history: recorded.history,
            loads: recorded.loads,
            summary,
            scene,
        })
    }

    /// Positions (3V, metres) in all frames.
    pub(crate) fn frames(&self) -> impl Iterator<Item = &[f64]> {
        (0..self.trajectory.len()).filter_map(|k| self.trajectory.frame(k))
    }

    /// The positions in the last frame.
    pub(crate) fn end(&self) -> &[f64] {
        let last = self.frames().last();
        last.unwrap_or(self.sheet.positions())
    }

    /// Time and force of the sheet on a body: seconds, newtons.
    pub(crate) fn forces(&self, body: usize) -> Vec<[f64; 4]> {
        let is_of_body = |row: &&LoadRow| row.on == LoadKind::Obstacle && row.number == body;
        self.loads.iter().filter(is_of_body).map(timed).collect()
    }
}

/// What a run recorded, which is made if it is not there.
///
/// # Errors
/// As [`Run::of`].
pub(crate) fn recorded(store: &Store, scene: &FigureScene) -> Result<Recording> {
    kept(store, scene).map(|(_, _, recording)| recording)
}

fn kept(store: &Store, scene: &FigureScene) -> Result<(Summary, Times, Recording)> {
    let unit = Unit {
        name: format!("run-{}", scene.name()),
        title: format!("run {}", scene.name()),
        options: scene.options(),
    };
    let (summary, times) = store.keep(&unit, |files| record(scene, files))?;
    let recording = Recording::read(&store.path(&folder(scene)))?;
    Ok((summary, times, recording))
}

/// Time and force of a load.
fn timed(row: &LoadRow) -> [f64; 4] {
    [row.t, row.force[0], row.force[1], row.force[2]]
}

fn folder(scene: &FigureScene) -> String {
    format!("runs/{}", scene.name())
}

/// What the steps of a run took, seconds.
#[derive(Clone, Copy, Debug, Default, Serialize, Deserialize)]
struct Times {
    wall: f64,
    cpu: f64,
}

/// Runs a scene in an empty folder and says `stepped` after each step. What came of it, and what its steps
/// took.
fn simulate(
    scene: &FigureScene,
    folder: &Path,
    stepped: &mut dyn FnMut(),
) -> Result<(Summary, Times)> {
    let mut times = Times::default();
    let mut look = |tick: &Tick| {
        times.wall += tick.wall.as_secs_f64();
        times.cpu += tick.cpu.as_secs_f64();
        stepped();
    };
    let summary = interrupt::simulate(&scene.without_page()?, folder, &mut look)??;
    Ok((summary, times))
}

/// Runs a scene and keeps what it recorded.
fn record(scene: &FigureScene, files: &mut Files<'_>) -> Result<(Summary, Times)> {
    let folder = files.folder(&folder(scene))?;
    let bar = Progress::start(format!("run {}", scene.name()), scene.frames());
    let (summary, times) = simulate(scene, &folder, &mut || bar.step())?;
    // The trajectory has all of these frames, and a run that is complete needs no others.
    fs::remove_file(folder.join("frames.bin"))?;
    bar.finish(&format!(
        "{} steps, {:.1} steps/s",
        summary.steps,
        summary.steps as f64 / times.wall.max(1e-9)
    ));
    Ok((summary, times))
}
