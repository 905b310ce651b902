//! Running a scene and keeping what it did.

use super::FigureScene;
use crate::interrupt::{self, Interrupted};
use crate::progress::{self, Progress};
use crate::store::{Draft, Extent, Store};
use anyhow::{Context, Result, ensure};
use isosheet_dynamics::{RunEnd, Simulation, StepOutcome, StepReport};
use isosheet_io::scene::SupportForces;
use isosheet_io::{
    HistoryRow, HistoryWriter, Trajectory, frame_path, read_history, read_json, write_atomically,
    write_json, write_obj,
};
use isosheet_mesh::Sheet;
use nalgebra::Vector3;
use serde::{Deserialize, Serialize};
use std::fmt::Write as _;
use std::io::Write as _;
use std::ops::ControlFlow;
use std::path::Path;
use std::time::Instant;

/// A run with an edge strain from here on is an error: what every figure promises is that nothing stretches.
const STRAIN: f64 = 1e-10;

/// A sheet with less kinetic energy than this part of the potential energy released is at rest.
const REST: f64 = 1e-6;

/// What a run did, as in its summary.json.
#[derive(Clone, Debug, Default, Serialize, Deserialize)]
pub(crate) struct RunSummary {
    /// The scene file.
    pub(crate) scene: String,
    pub(crate) extent: Extent,
    pub(crate) vertices: usize,
    pub(crate) faces: usize,
    /// Frames after the first.
    pub(crate) frames: usize,
    /// Simulated time, seconds.
    pub(crate) time: f64,
    /// Time that the steps took, seconds; without writing and drawing.
    pub(crate) wall: f64,
    pub(crate) frames_per_second: f64,
    /// Accepted sub-steps.
    pub(crate) substeps: usize,
    /// Rejected sub-steps.
    pub(crate) rejected: usize,
    pub(crate) iterations: usize,
    pub(crate) factorisations: usize,
    /// Shortest and longest step, seconds; where a frame was subdivided, the mean of its sub-steps counts.
    /// `None` without a step.
    pub(crate) step_range: Option<[f64; 2]>,
    /// Largest relative edge length error.
    pub(crate) max_strain: f64,
    /// Smallest gap between the sheet and a body or itself at the end of a frame, metres; `None` without
    /// contact or if nothing ever came within reach.
    pub(crate) smallest_gap: Option<f64>,
    /// The energy balance at the end.
    pub(crate) energy: Energy,
    /// Time from which the kinetic energy stays below [`REST`] of the potential energy released, seconds.
    pub(crate) at_rest_from: Option<f64>,
    /// Frames by the path that their hardest sub-step took: Newton alone, globalised, seeded, other.
    pub(crate) paths: [usize; 4],
    /// Kinetic energy at the end as part of the potential energy released.
    pub(crate) motion_left: f64,
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
    /// What the balance lacks: the error of the integrator.
    pub(crate) drift: f64,
}

impl RunSummary {
    /// Wall time over simulated time: below one is faster than real time.
    pub(crate) fn slowness(&self) -> f64 {
        self.wall / self.time.max(1e-12)
    }

    /// Linear systems solved per second of wall time.
    pub(crate) fn solves_per_second(&self) -> f64 {
        self.iterations as f64 / self.wall.max(1e-9)
    }
}

fn unit(scene: &FigureScene) -> String {
    format!("run-{}", scene.name())
}

fn folder(scene: &FigureScene) -> String {
    format!("runs/{}", scene.name())
}

/// The summary of an up-to-date run of the scene, which is made now when there is none.
///
/// # Errors
/// [`Interrupted`] after Ctrl-C; the frames made so far are kept and readable.
pub(crate) fn ensure(store: &Store, scene: &FigureScene) -> Result<RunSummary> {
    let options = scene.options();
    if let Some(stamp) = store.current(&unit(scene), &options) {
        progress::note(&format!("run {}", scene.name()), "up to date");
        return Ok(serde_json::from_value(stamp.facts)?);
    }
    let mut draft = store.draft()?;
    let summary = run(scene, &mut draft, interrupt::requested)
        .with_context(|| format!("run {}", scene.name()))?;
    let extent = summary.extent;
    store.commit(
        draft,
        &unit(scene),
        &options,
        extent,
        serde_json::to_value(&summary)?,
    )?;
    if extent == Extent::Partial {
        return Err(Interrupted.into());
    }
    Ok(summary)
}

/// The frames of a run that [`ensure()`] has made.
pub(crate) fn trajectory(store: &Store, scene: &FigureScene) -> Result<Trajectory> {
    let path = store.root().join(folder(scene)).join("trajectory.npz");
    Ok(Trajectory::read(&path)?)
}

/// The positions (3V, metres) in the last frame of a run that [`ensure()`] has made.
pub(crate) fn end(store: &Store, scene: &FigureScene) -> Result<Vec<f64>> {
    let trajectory = trajectory(store, scene)?;
    let last = trajectory.frame(trajectory.len() - 1);
    Ok(last.context("last frame")?.to_vec())
}

/// The summary of a run that [`ensure()`] has made.
pub(crate) fn summary(store: &Store, scene: &FigureScene) -> Result<RunSummary> {
    let path = store.root().join(folder(scene)).join("summary.json");
    Ok(read_json(&path)?)
}

/// The history of a run that [`ensure()`] has made: a row for the start and for each frame.
pub(crate) fn history(store: &Store, scene: &FigureScene) -> Result<Vec<HistoryRow>> {
    let path = store.root().join(folder(scene)).join("history.csv");
    Ok(read_history(&path)?)
}

/// Columns of loads.csv: time (s), body, force (N) and torque about the body's origin (N m) of the sheet on
/// the body.
const LOADS: &str = "t,body,fx,fy,fz,mx,my,mz";

/// Time and force of the sheet on a body in a run that [`ensure()`] has made: seconds, newtons.
pub(crate) fn forces(store: &Store, scene: &FigureScene, body: usize) -> Result<Vec<[f64; 4]>> {
    let rows = table(store, scene, "loads.csv")?;
    let of_body = rows.iter().filter_map(|row| match row[..] {
        [t, number, fx, fy, fz, ..] if number == body as f64 => Some([t, fx, fy, fz]),
        _ => None,
    });
    Ok(of_body.collect())
}

/// Columns of supports.csv: time (s) and the sum of the forces (N) of all pins and vertex constraints on the
/// sheet.
const SUPPORTS: &str = "t,fx,fy,fz";

/// Time and force of all supports on the sheet in a run that [`ensure()`] has made: seconds, newtons.
pub(crate) fn supports(store: &Store, scene: &FigureScene) -> Result<Vec<[f64; 4]>> {
    let rows = table(store, scene, "supports.csv")?;
    let rows = rows.into_iter();
    rows.map(|row| <[f64; 4]>::try_from(row).ok().context("supports.csv"))
        .collect()
}

/// The numbers of a file of a run, row by row, without its header.
fn table(store: &Store, scene: &FigureScene, file: &'static str) -> Result<Vec<Vec<f64>>> {
    let text = store.read(&format!("{}/{file}", folder(scene)))?;
    let text = String::from_utf8_lossy(&text);
    let numbers = |line: &str| line.split(',').map(str::parse).collect::<Result<_, _>>();
    let rows = text.lines().skip(1).map(numbers);
    rows.collect::<Result<_, _>>().context(file)
}

/// What every run has to keep at every frame.
fn check(report: &StepReport) -> Result<()> {
    let StepReport { t, strain, gap, .. } = *report;
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
    /// Rows of loads.csv.
    loads: String,
    /// Rows of supports.csv.
    supports: String,
}

impl Recorder<'_> {
    fn frame(&mut self, simulation: &Simulation, report: Option<&StepReport>) -> Result<()> {
        let state = simulation.state();
        let frame = self.trajectory.len();
        self.trajectory.push(state.t, &state.x)?;
        write_obj(
            &frame_path(&self.folder.join("obj"), frame),
            self.sheet.topology(),
            &state.x,
        )?;
        let model = simulation.model();
        let kinetic = model.kinetic_energy(&state.v);
        let potential = simulation.energy() - kinetic;
        let total = kinetic + potential;
        let mut row = HistoryRow {
            t: state.t,
            kinetic,
            potential,
            total,
            ..HistoryRow::default()
        };
        match report {
            None => self.start = total,
            Some(r) => {
                (row.h, row.iterations, row.factorisations) = (r.h, r.iterations, r.factorisations);
                (row.rejected, row.strain) = (r.rejected, r.strain);
                // An infinite gap means that nothing is within reach.
                row.gap = r.gap.filter(|g| g.is_finite());
            }
        }
        row.drift = total - self.start;
        self.history.append(&row)?;
        for (body, load) in simulation.body_loads().iter().enumerate() {
            let [fx, fy, fz]: [f64; 3] = load.force.into();
            let [mx, my, mz]: [f64; 3] = load.torque.into();
            let t = state.t;
            writeln!(self.loads, "{t},{body},{fx},{fy},{fz},{mx},{my},{mz}")?;
        }
        // Their forces are known after the first step.
        let forces: Vec<_> = simulation.reactions().iter().map(|r| r.force).collect();
        if !forces.is_empty() {
            let [fx, fy, fz]: [f64; 3] = forces.iter().sum::<Vector3<f64>>().into();
            writeln!(self.supports, "{},{fx},{fy},{fz}", state.t)?;
        }
        Ok(())
    }
}

/// Runs a scene into a draft until it ends or `stop` says so.
fn run(scene: &FigureScene, draft: &mut Draft, stop: impl Fn() -> bool) -> Result<RunSummary> {
    let folder = draft.folder(&folder(scene))?;
    let setup = scene.setup()?;
    let (sheet, origins) = (setup.sheet.clone(), setup.origins.clone());
    let mut simulation = setup.start()?;
    let supports = SupportForces::new(origins, &simulation, scene.scene().support.len());
    let mut recorder = Recorder {
        sheet: &sheet,
        trajectory: Trajectory::new(&sheet),
        history: HistoryWriter::create(&folder.join("history.csv"))?,
        folder: &folder,
        start: 0.0,
        loads: String::new(),
        supports: String::new(),
    };
    recorder.frame(&simulation, None)?;
    let mut s = RunSummary::start(scene, &sheet);
    // The sheet starts at rest.
    let before = simulation.energy();
    let (frame, frames) = (scene.frame(), scene.frames());
    let bar = Progress::start(format!("run {}", scene.name()), frames);
    let stopped_at_once = stop();
    let mut stopped = stopped_at_once;
    let mut outcome = Ok(());
    let mut clock = Instant::now();
    let mut record = |simulation: &Simulation, report: &StepReport| {
        s.wall += clock.elapsed().as_secs_f64();
        s.count(report);
        s.balance(report, before);
        outcome = check(report).and_then(|()| recorder.frame(simulation, Some(report)));
        bar.step();
        let supports = supports.of(simulation);
        let over = outcome.is_err() || scene.scene().stop.is_force_reached(&supports);
        stopped = !over && stop();
        clock = Instant::now();
        if over || stopped {
            ControlFlow::Break(())
        } else {
            ControlFlow::Continue(())
        }
    };
    let end = if stopped_at_once {
        RunEnd::Stopped
    } else {
        simulation.run(scene.scene().stop.time, frame, &mut [&mut record])?
    };
    outcome?;
    if stopped && end == RunEnd::Stopped {
        s.extent = Extent::Partial;
    }
    recorder.trajectory.write(&folder.join("trajectory.npz"))?;
    for (file, head, rows) in [
        ("loads.csv", LOADS, &recorder.loads),
        ("supports.csv", SUPPORTS, &recorder.supports),
    ] {
        if !rows.is_empty() {
            let text = format!("{head}\n{rows}");
            write_atomically(&folder.join(file), |w| w.write_all(text.as_bytes()))?;
        }
    }
    s.frames_per_second = s.frames as f64 / s.wall.max(1e-9);
    write_json(&folder.join("summary.json"), &s)?;
    let how = format!(
        "{} of {} frames, {:.1} frames/s",
        s.frames, frames, s.frames_per_second
    );
    bar.finish(&how);
    Ok(s)
}

impl RunSummary {
    /// Of a run without a frame yet.
    fn start(scene: &FigureScene, sheet: &Sheet) -> Self {
        Self {
            scene: scene.text().to_owned(),
            vertices: sheet.topology().vertex_count(),
            faces: sheet.topology().face_count(),
            ..Self::default()
        }
    }

    /// The energies after a step of a run that started with the energy `before`, joules.
    fn balance(&mut self, r: &StepReport, before: f64) {
        let released = before - r.potential;
        self.motion_left = if released > 0.0 {
            r.kinetic / released
        } else {
            0.0
        };
        self.at_rest_from =
            (self.motion_left < REST && released > 0.0).then(|| self.at_rest_from.unwrap_or(r.t));
        self.energy = Energy {
            released,
            work: r.work,
            damped: r.dissipated,
            friction: r.friction,
            drift: r.energy_drift,
        };
    }

    fn count(&mut self, r: &StepReport) {
        self.frames += 1;
        self.time = r.t;
        self.substeps += r.substeps;
        self.rejected += r.rejected;
        self.iterations += r.iterations;
        self.factorisations += r.factorisations;
        let step = r.h / r.substeps.max(1) as f64;
        let [low, high] = self.step_range.unwrap_or([step, step]);
        self.step_range = Some([low.min(step), high.max(step)]);
        self.max_strain = self.max_strain.max(r.strain);
        if let Some(gap) = r.gap.filter(|g| g.is_finite()) {
            self.smallest_gap = Some(self.smallest_gap.map_or(gap, |g| g.min(gap)));
        }
        self.paths[match r.outcome {
            StepOutcome::Newton => 0,
            StepOutcome::Globalised => 1,
            StepOutcome::BranchSeeded => 2,
            _ => 3,
        }] += 1;
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::cell::Cell;

    #[test]
    fn a_run_that_is_stopped_is_readable_and_made_again() {
        let folder = tempfile::tempdir().unwrap();
        let store = Store::open(folder.path()).unwrap();
        let edits = ["sheet.mesh.square.level=0", "stop.time=0.1"].map(str::to_owned);
        let scene = FigureScene::of("fig11", "crumple-m0", &edits).unwrap();
        for stopped_after in [0, 3] {
            let count = Cell::new(0);
            let stop = || count.replace(count.get() + 1) == stopped_after;
            let mut draft = store.draft().unwrap();
            let s = run(&scene, &mut draft, stop).unwrap();
            assert_eq!((s.frames, s.extent), (stopped_after, Extent::Partial));
            let options = scene.options();
            store
                .commit(
                    draft,
                    &unit(&scene),
                    &options,
                    s.extent,
                    serde_json::to_value(&s).unwrap(),
                )
                .unwrap();
            assert_eq!(trajectory(&store, &scene).unwrap().len(), stopped_after + 1);
            let rows = read_history(&folder.path().join("runs/crumple-m0/history.csv")).unwrap();
            assert_eq!(rows.len(), stopped_after + 1);
        }
        let whole = ensure(&store, &scene).unwrap();
        assert_eq!((whole.frames, whole.extent), (6, Extent::Complete));
        assert!(whole.max_strain < 1e-11 && whole.step_range.is_some());
    }

    /// [`simulate`](isosheet_io::run::simulate) is what `isosheet simulate` calls.
    #[test]
    fn the_command_makes_the_motion_that_the_figures_show() {
        let folder = tempfile::tempdir().unwrap();
        let store = Store::open(&folder.path().join("out")).unwrap();
        // A strip that is pushed until its support bears 3 mN, a vertex that folds, a sheet in a chart.
        let cases = [
            ("fig16", vec!["stop.time=0.05", "stop.support_force=0.003"]),
            ("fig17-vertex-odd", vec!["stop.time=0.5"]),
            ("fig10", vec!["stop.time=0.1"]),
        ];
        for (file, edits) in cases {
            let edits: Vec<String> = edits.into_iter().map(str::to_owned).collect();
            let scene = FigureScene::of(file, file, &edits).unwrap();
            let summary = ensure(&store, &scene).unwrap();
            let shown = trajectory(&store, &scene).unwrap();
            let run = folder.path().join(file);
            let go_on = &mut |_: &isosheet_io::run::Tick| ControlFlow::Continue(());
            isosheet_io::run::simulate(scene.file(), &run, go_on).unwrap();
            let made = Trajectory::read(&run.join("trajectory.npz")).unwrap();
            assert_eq!(made.times(), shown.times(), "{file}");
            assert_eq!(made.len(), summary.frames + 1, "{file}");
            assert!(
                summary.frames < scene.frames() || file != "fig16",
                "stopped by force"
            );
            for k in 0..made.len() {
                assert_eq!(made.frame(k), shown.frame(k), "{file}, frame {k}");
            }
        }
    }
}
