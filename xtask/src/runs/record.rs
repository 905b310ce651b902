//! Running a scene and keeping what it did.

use super::{Scene, Shape};
use crate::interrupt::{self, Interrupted};
use crate::progress::{self, Progress};
use crate::store::{Draft, Extent, Store};
use anyhow::{Context, Result};
use isosheet_dynamics::{Path as SolverPath, Simulation, StepReport};
use isosheet_io::{HistoryRow, HistoryWriter, Trajectory, frame_path, write_json, write_obj};
use isosheet_mesh::Sheet;
use serde::{Deserialize, Serialize};
use std::path::Path;
use std::time::Instant;

/// What a run did, as in its summary.json.
#[derive(Clone, Debug, Serialize, Deserialize)]
pub(crate) struct RunSummary {
    pub(crate) scene: Scene,
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
    /// Shortest and longest step, seconds; where a frame was subdivided, the mean of its sub-steps counts. `None` without a
    /// step.
    pub(crate) step_range: Option<[f64; 2]>,
    /// Largest relative edge length error.
    pub(crate) max_strain: f64,
    /// Frames by the path that their hardest sub-step took: Newton alone, globalised, seeded, other.
    pub(crate) paths: [usize; 4],
    /// Kinetic energy at the end as part of the potential energy released.
    pub(crate) motion_left: f64,
    /// The shape at the end.
    pub(crate) shape: Shape,
}

fn unit(scene: &Scene) -> String {
    format!("run-{}", scene.name)
}

fn folder(scene: &Scene) -> String {
    format!("runs/{}", scene.name)
}

/// The summary of an up-to-date run of the scene, which is made now when there is none.
///
/// # Errors
/// [`Interrupted`] after Ctrl-C; the frames made so far are kept and readable.
pub(crate) fn ensure(store: &Store, scene: &Scene) -> Result<RunSummary> {
    let options = serde_json::to_value(scene)?;
    if let Some(stamp) = store.current(&unit(scene), &options) {
        progress::note(&format!("run {}", scene.name), "up to date");
        return Ok(serde_json::from_value(stamp.facts)?);
    }
    let mut draft = store.draft()?;
    let summary = run(scene, &mut draft, interrupt::requested)
        .with_context(|| format!("run {}", scene.name))?;
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

/// The frames of a run that [`ensure`] has made.
pub(crate) fn trajectory(store: &Store, scene: &Scene) -> Result<Trajectory> {
    let path = store.root().join(folder(scene)).join("trajectory.npz");
    Ok(Trajectory::read(&path)?)
}

struct Recorder<'a> {
    sheet: &'a Sheet,
    trajectory: Trajectory,
    history: HistoryWriter,
    folder: &'a Path,
    start: f64,
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
        let (kinetic, potential) = (
            model.kinetic_energy(&state.v),
            model.potential_energy(state.t, &state.x),
        );
        if report.is_none() {
            self.start = kinetic + potential;
        }
        self.history.append(&HistoryRow {
            t: state.t,
            h: report.map_or(0.0, |r| r.h),
            iterations: report.map_or(0, |r| r.iterations),
            kinetic,
            potential,
            total: kinetic + potential,
            drift: kinetic + potential - self.start,
            strain: report.map_or(0.0, |r| r.strain),
            gap: report.and_then(|r| r.gap),
        })?;
        Ok(())
    }
}

/// Runs a scene into a draft until it ends or `stop` says so.
fn run(scene: &Scene, draft: &mut Draft, stop: impl Fn() -> bool) -> Result<RunSummary> {
    let folder = draft.folder(&folder(scene))?;
    let sheet = scene.sheet()?;
    let mut simulation = scene.simulation(&sheet)?;
    let mut recorder = Recorder {
        sheet: &sheet,
        trajectory: Trajectory::new(&sheet),
        history: HistoryWriter::create(&folder.join("history.csv"))?,
        folder: &folder,
        start: 0.0,
    };
    recorder.frame(&simulation, None)?;
    let mut s = RunSummary {
        scene: scene.clone(),
        extent: Extent::Complete,
        vertices: sheet.topology().vertex_count(),
        faces: sheet.topology().face_count(),
        frames: 0,
        time: 0.0,
        wall: 0.0,
        frames_per_second: 0.0,
        substeps: 0,
        rejected: 0,
        iterations: 0,
        factorisations: 0,
        step_range: None,
        max_strain: 0.0,
        paths: [0; 4],
        motion_left: 0.0,
        shape: Shape::of(scene, &sheet, sheet.positions())?,
    };
    let before = simulation
        .model()
        .potential_energy(0.0, &simulation.state().x);
    let bar = Progress::start(format!("run {}", scene.name), scene.frames);
    for _ in 0..scene.frames {
        if stop() {
            s.extent = Extent::Partial;
            break;
        }
        let clock = Instant::now();
        let report = simulation.step(scene.frame)?;
        s.wall += clock.elapsed().as_secs_f64();
        s.count(&report);
        recorder.frame(&simulation, Some(&report))?;
        bar.step();
        let released = before - report.potential;
        s.motion_left = if released > 0.0 {
            report.kinetic / released
        } else {
            0.0
        };
    }
    recorder.trajectory.write(&folder.join("trajectory.npz"))?;
    s.shape = Shape::of(scene, &sheet, &simulation.state().x)?;
    s.frames_per_second = s.frames as f64 / s.wall.max(1e-9);
    write_json(&folder.join("summary.json"), &s)?;
    let how = format!(
        "{} of {} frames, {:.1} frames/s",
        s.frames, scene.frames, s.frames_per_second
    );
    bar.finish(&how);
    Ok(s)
}

impl RunSummary {
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
        self.paths[match r.path {
            SolverPath::Newton => 0,
            SolverPath::Globalised => 1,
            SolverPath::BranchSeeded => 2,
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
        let scene = Scene::paper(0, 6);
        for stopped_after in [0, 3] {
            let count = Cell::new(0);
            let stop = || count.replace(count.get() + 1) == stopped_after;
            let mut draft = store.draft().unwrap();
            let s = run(&scene, &mut draft, stop).unwrap();
            assert_eq!((s.frames, s.extent), (stopped_after, Extent::Partial));
            let options = serde_json::to_value(&scene).unwrap();
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
            let rows =
                isosheet_io::read_history(&folder.path().join("runs/crumple-m0/history.csv"))
                    .unwrap();
            assert_eq!(rows.len(), stopped_after + 1);
        }
        let whole = ensure(&store, &scene).unwrap();
        assert_eq!((whole.frames, whole.extent), (6, Extent::Complete));
        assert!(whole.max_strain < 1e-11 && whole.step_range.is_some());
    }
}
