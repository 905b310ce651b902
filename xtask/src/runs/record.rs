//! Runs of scenes as figures are made of them: made once, recorded in DIR/runs.

use super::{Course, FigureScene, Plan};
use crate::progress::Progress;
use crate::report::Table;
use crate::store::{Files, Store, Unit};
use anyhow::{Result, ensure};
use isosheet_dynamics::{Simulation, StepOutcome, StepReport};
use isosheet_io::run::ElasticSummary;
use isosheet_io::scene::SupportForces;
use isosheet_io::{
    HistoryRow, HistoryWriter, Trajectory, frame_path, read_history, write_json, write_obj,
};
use isosheet_mesh::Sheet;
use isosheet_mesh::wording::brief;
use nalgebra::Vector3;
use serde::{Deserialize, Serialize};
use std::ops::ControlFlow;
use std::path::Path;

/// A run of rods with an edge strain from here on is an error: figures of rods promise that nothing stretches.
const STRAIN: f64 = 1e-10;

/// A sheet with less kinetic energy than this part of the potential energy released is at rest.
const REST: f64 = 1e-6;

/// What a run did, as in its summary.json.
#[derive(Clone, Debug, Default, Serialize, Deserialize)]
pub(crate) struct RunSummary {
    /// The scene file.
    pub(crate) scene: String,
    pub(crate) vertices: usize,
    pub(crate) faces: usize,
    /// Its steps are the frames after the first.
    #[serde(flatten)]
    pub(crate) course: Course,
    pub(crate) frames_per_second: f64,
    /// Shortest and longest step, seconds; where a frame was subdivided, the mean of its sub-steps counts.
    /// `None` without a step.
    pub(crate) step_range: Option<[f64; 2]>,
    /// The energy balance at the end.
    pub(crate) energy: Energy,
    /// Time from which the kinetic energy stays below [`REST`] of the potential energy released, seconds.
    pub(crate) at_rest_from: Option<f64>,
    /// Frames by the path that their hardest sub-step took: Newton alone, globalised, seeded, other.
    pub(crate) paths: [usize; 4],
    /// Kinetic energy at the end as part of the potential energy released.
    pub(crate) motion_left: f64,
    /// How an elastic sheet was softened and deformed; none for rods.
    pub(crate) elastic: Option<ElasticSummary>,
}

/// Where the energy went, joules.
#[derive(Clone, Copy, Debug, Default, Serialize, Deserialize)]
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
    #[serde(default)]
    pub(crate) plastic: f64,
    /// What the balance lacks: the error of the integrator.
    pub(crate) drift: f64,
}

impl RunSummary {
    /// Wall time over simulated time: below one is faster than real time.
    pub(crate) fn slowness(&self) -> f64 {
        self.course.cost.wall / self.course.time.max(1e-12)
    }

    /// Largest strain: of an edge of rods, of a face of an elastic sheet.
    pub(crate) fn strain(&self) -> f64 {
        self.elastic.map_or(self.course.strain, |e| e.strain)
    }

    /// Membrane stiffness of an elastic sheet, softened where the mesh is coarse, and that of its material, in words.
    pub(crate) fn stiffness(&self) -> Option<String> {
        let e = self.elastic?;
        let [least, most] = e.used.map(brief);
        Some(format!("{least} to {most} of {} N/m", brief(e.stiffness)))
    }

    /// Takes a step of a run into account that started with the energy `before`, joules.
    fn add(&mut self, r: &StepReport, before: f64) {
        let step = r.h / r.substeps.max(1) as f64;
        let [low, high] = self.step_range.unwrap_or([step, step]);
        self.step_range = Some([low.min(step), high.max(step)]);
        self.paths[match r.outcome {
            StepOutcome::Newton => 0,
            StepOutcome::Globalised => 1,
            StepOutcome::BranchSeeded => 2,
            _ => 3,
        }] += 1;
        let released = before - r.potential;
        let is_lower = released > 0.0;
        self.motion_left = if is_lower { r.kinetic / released } else { 0.0 };
        let is_at_rest = is_lower && self.motion_left < REST;
        self.at_rest_from = is_at_rest.then(|| self.at_rest_from.unwrap_or(r.t));
        self.energy = Energy {
            released,
            work: r.work,
            damped: r.dissipated,
            friction: r.friction,
            plastic: r.plastic,
            drift: r.energy_drift,
        };
    }
}

/// A force of the sheet on a body with its torque about the body's origin: time (s), number of the body, N,
/// N m.
#[derive(Clone, Copy, Debug, Serialize, Deserialize)]
struct Load {
    t: f64,
    body: usize,
    force: [f64; 3],
    torque: [f64; 3],
}

/// What is kept of a run beside its files.
#[derive(Clone, Debug, Default, Serialize, Deserialize)]
struct Found {
    summary: RunSummary,
    loads: Vec<Load>,
    /// Time (s), and the sum of the forces (N) of all pins and vertex constraints on the sheet.
    supports: Vec<[f64; 4]>,
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
    /// Time and force of all supports on the sheet: seconds, newtons.
    pub(crate) supports: Vec<[f64; 4]>,
    loads: Vec<Load>,
}

impl Run {
    /// An up-to-date run of the scene, which is made now when there is none.
    ///
    /// # Errors
    /// [`Interrupted`](crate::interrupt::Interrupted) after Ctrl-C; those of the simulation.
    pub(crate) fn of(store: &Store, scene: FigureScene) -> Result<Self> {
        let unit = Unit {
            name: format!("run-{}", scene.name()),
            title: format!("run {}", scene.name()),
            options: scene.options(),
        };
        let Found {
            summary,
            loads,
            supports,
        } = store.keep(&unit, |files| record(&scene, files))?;
        let folder = store.path(&folder(&scene));
        Ok(Self {
            sheet: scene.sheet()?,
            trajectory: Trajectory::read(&folder.join("trajectory.npz"))?,
            history: read_history(&folder.join("history.csv"))?,
            summary,
            loads,
            supports,
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
        let of_body = self.loads.iter().filter(|load| load.body == body);
        let row = |load: &Load| [load.t, load.force[0], load.force[1], load.force[2]];
        of_body.map(row).collect()
    }
}

fn folder(scene: &FigureScene) -> String {
    format!("runs/{}", scene.name())
}

/// What every run has to keep at every frame.
fn check(report: &StepReport) -> Result<()> {
    let StepReport { t, gap, .. } = *report;
    let strain = report.constrained_strain;
    ensure!(
        strain < STRAIN,
        "at t = {t} s an edge is strained by {strain:e}, {STRAIN:e} is the limit"
    );
    // Not a number is no gap either.
    ensure!(
        gap.is_none_or(|g| g > 0.0),
        "at t = {t} s the smallest gap is {gap:?} m: something touches"
    );
    Ok(())
}

struct Recorder<'a> {
    sheet: &'a Sheet,
    trajectory: Trajectory,
    history: HistoryWriter,
    folder: &'a Path,
    start: f64,
    found: Found,
}

impl Recorder<'_> {
    fn frame(&mut self, simulation: &Simulation, report: Option<&StepReport>) -> Result<()> {
        let state = simulation.state();
        let t = state.t;
        let obj = frame_path(&self.folder.join("obj"), self.trajectory.len());
        write_obj(&obj, self.sheet.topology(), &state.x)?;
        self.trajectory.push(t, &state.x)?;
        let kinetic = simulation.model().kinetic_energy(&state.v);
        let total = simulation.energy();
        let mut row = HistoryRow {
            t,
            kinetic,
            potential: total - kinetic,
            total,
            drift: total - self.start,
            plastic: simulation.model().can_yield().then_some(0.0),
            ..HistoryRow::default()
        };
        if let Some(r) = report {
            check(r)?;
            self.found.summary.add(r, self.start);
            if let Some(elastic) = &mut self.found.summary.elastic {
                elastic.observe(simulation.model(), t, &state.x);
                let (strain, limit) = (elastic.strain, elastic.limit);
                ensure!(
                    strain < limit,
                    "at t = {t} s a face is strained by {strain:e}, beyond {limit:e}"
                );
            }
            (row.h, row.iterations, row.factorisations) = (r.h, r.iterations, r.factorisations);
            (row.rejected, row.strain) = (r.rejected, r.strain);
            // An infinite gap means that nothing is within reach.
            row.gap = r.gap.filter(|g| g.is_finite());
            row.plastic = row.plastic.map(|_| r.plastic);
        }
        self.history.append(&row)?;
        let loads = simulation.body_loads().into_iter().enumerate();
        self.found.loads.extend(loads.map(|(body, load)| Load {
            t,
            body,
            force: load.force.into(),
            torque: load.torque.into(),
        }));
        // Their forces are known after the first step.
        let forces: Vec<_> = simulation.reactions().iter().map(|r| r.force).collect();
        if !forces.is_empty() {
            let [x, y, z]: [f64; 3] = forces.iter().sum::<Vector3<f64>>().into();
            self.found.supports.push([t, x, y, z]);
        }
        Ok(())
    }
}

/// Runs a scene and writes what it did.
fn record(scene: &FigureScene, files: &mut Files<'_>) -> Result<Found> {
    let folder = files.folder(&folder(scene))?;
    let setup = scene.setup()?;
    let (sheet, origins) = (setup.sheet.clone(), setup.origins.clone());
    let mut simulation = setup.start()?;
    let supports = SupportForces::new(origins, &simulation, scene.scene().support.len());
    let mut recorder = Recorder {
        sheet: &sheet,
        trajectory: Trajectory::new(&sheet),
        history: HistoryWriter::create(&folder.join("history.csv"))?,
        folder: &folder,
        // The sheet starts at rest.
        start: simulation.energy(),
        found: Found {
            summary: RunSummary {
                elastic: ElasticSummary::of(simulation.model()),
                ..RunSummary::default()
            },
            ..Found::default()
        },
    };
    recorder.frame(&simulation, None)?;
    let stop = &scene.scene().stop;
    let bar = Progress::start(format!("run {}", scene.name()), scene.frames());
    let mut outcome = Ok(());
    let mut look = |simulation: &Simulation, report: &StepReport| {
        outcome = recorder.frame(simulation, Some(report));
        bar.step();
        if outcome.is_err() || stop.is_force_reached(|| supports.of(simulation)) {
            return ControlFlow::Break(());
        }
        ControlFlow::Continue(())
    };
    let plan = Plan::new(scene.frame(), stop.time);
    let mut course = plan.run(&mut simulation, &mut look)?;
    outcome?;
    if let Some(error) = course.error.take() {
        return Err(error.into());
    }
    let mut found = recorder.found;
    found.summary = RunSummary {
        scene: scene.text().to_owned(),
        vertices: sheet.topology().vertex_count(),
        faces: sheet.topology().face_count(),
        frames_per_second: course.cost.steps as f64 / course.cost.wall.max(1e-9),
        course,
        ..found.summary
    };
    recorder.trajectory.write(&folder.join("trajectory.npz"))?;
    write_tables(&found, &folder)?;
    write_json(&folder.join("summary.json"), &found.summary)?;
    let s = &found.summary;
    bar.finish(&format!(
        "{} of {} frames, {:.1} frames/s",
        s.course.cost.steps,
        scene.frames(),
        s.frames_per_second
    ));
    Ok(found)
}

/// Writes loads.csv and supports.csv, where there are any.
fn write_tables(found: &Found, folder: &Path) -> Result<()> {
    let loads = Table::of(
        "",
        &found.loads,
        &[
            ("t", &|l| l.t.into()),
            ("body", &|l| l.body.into()),
            ("fx", &|l| l.force[0].into()),
            ("fy", &|l| l.force[1].into()),
            ("fz", &|l| l.force[2].into()),
            ("mx", &|l| l.torque[0].into()),
            ("my", &|l| l.torque[1].into()),
            ("mz", &|l| l.torque[2].into()),
        ],
    );
    let supports = Table::of(
        "",
        &found.supports,
        &[
            ("t", &|s| s[0].into()),
            ("fx", &|s| s[1].into()),
            ("fy", &|s| s[2].into()),
            ("fz", &|s| s[3].into()),
        ],
    );
    for (file, table) in [("loads.csv", loads), ("supports.csv", supports)] {
        if !table.rows.is_empty() {
            table.write_to(&folder.join(file))?;
        }
    }
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::report::Effort;
    use crate::store::Remake;

    /// [`simulate`](isosheet_io::run::simulate) is what `isosheet simulate` calls.
    #[test]
    fn the_command_makes_the_motion_that_the_figures_show() {
        let folder = tempfile::tempdir().unwrap();
        let out = folder.path().join("out");
        let store = Store::open(&out, "a", Effort::Quick, Remake::Never).unwrap();
        // A strip that is pushed until its support bears 3 mN, a vertex that folds, a sheet in a chart.
        let cases = [
            ("fig16", vec!["stop.time=0.05", "stop.support_force=0.003"]),
            ("fig17-vertex-odd", vec!["stop.time=0.5"]),
            ("fig10", vec!["stop.time=0.1"]),
        ];
        for (file, edits) in cases {
            let edits: Vec<String> = edits.into_iter().map(str::to_owned).collect();
            let scene = FigureScene::of(file, file, &edits).unwrap();
            let shown = Run::of(&store, scene.clone()).unwrap();
            let course = &shown.summary.course;
            assert!(course.strain < 1e-11 && shown.summary.step_range.is_some());
            let run = folder.path().join(file);
            let go_on = &mut |_: &isosheet_io::run::Tick| ControlFlow::Continue(());
            isosheet_io::run::simulate(scene.file(), &run, go_on).unwrap();
            let made = Trajectory::read(&run.join("trajectory.npz")).unwrap();
            assert_eq!(made.times(), shown.trajectory.times(), "{file}");
            assert_eq!(made.len(), course.cost.steps + 1, "{file}");
            assert_eq!(shown.history.len(), made.len());
            let is_whole = course.cost.steps == scene.frames();
            assert!(!is_whole || file != "fig16", "stopped by force");
            for (k, x) in shown.frames().enumerate() {
                assert_eq!(made.frame(k), Some(x), "{file}, frame {k}");
            }
        }
    }
}
