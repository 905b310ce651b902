//! The files of a run that grow with its steps.

use super::RunError;
use super::balance::ForceBalance;
use super::checkpoint::{self, RunProgress};
use super::commit;
use super::elastic::ElasticSummary;
use super::energy::EnergySummary;
use super::folder::RunFolder;
use super::frames::FrameFile;
use super::incidence::Incidence;
use super::last_change::last_change;
use super::plan::{Plan, Rows};
use super::recording::Tables;
use super::row::{row_of_start, row_of_step};
use super::steps::step_count;
use super::summary::{EndReason, Measured};
use super::time_error::TimeError;
use isosheet_dynamics::{Checkpoint, StepReport};
use isosheet_formats::{
    EventRow, EventWriter, FrameData, HistoryRow, HistoryWriter, LoadKind, LoadRow, LoadWriter,
    MeasureRow, MeasureWriter,
};
use isosheet_scenes::{CarriedBody, FollowedFolds, Integrator, Scene, UnderWay};
use nalgebra::Vector3;
use std::path::PathBuf;
use std::time::Instant;

/// The files that a run writes as it goes on, and how far it has come.
pub(crate) struct RunWriter {
    history: HistoryWriter,
    /// The loads of supports and obstacles, if there are any.
    loads: Option<LoadWriter>,
    /// What the measures of the scene show, if there are any.
    measures: Option<MeasureWriter>,
    /// What is taken up and released, if anything is.
    events: Option<EventWriter>,
    frames: FrameFile,
    /// The rows of these tables, where they are kept in memory.
    pub(super) tables: Option<Tables>,
    pub(super) progress: RunProgress,
    /// The file of the checkpoints.
    checkpoint: PathBuf,
    /// Since when the wall time in the progress counts.
    pub(super) clock: Instant,
    /// Until when functions of time change, seconds.
    last_change: f64,
}

impl RunWriter {
    /// The files of a run at its start, or after `saved` steps, of which its folder has them.
    pub(super) fn begin(
        plan: &Plan<'_>,
        folder: &RunFolder,
        under_way: &UnderWay,
        saved: Option<RunProgress>,
        clock: Instant,
    ) -> Result<Self, RunError> {
        let (scene, facts) = (plan.file.scene(), &plan.start.facts);
        let bears_loads =
            !scene.support.is_empty() || !scene.obstacle.is_empty() || !scene.body.is_empty();
        let path = |name| folder.path(name);
        let [history, loads, measures, events, frames] = [
            RunFolder::HISTORY,
            RunFolder::LOADS,
            RunFolder::MEASURES,
            RunFolder::EVENTS,
            RunFolder::FRAMES,
        ]
        .map(path);
        let is_new = saved.is_none();
        let keeps = plan.rows == Rows::InMemory;
        let (history, loads, measures, events, frames) = match &saved {
            None => (
                HistoryWriter::create(&history)?,
                bears_loads
                    .then(|| LoadWriter::create(&loads))
                    .transpose()?,
                (!facts.measures.is_empty())
                    .then(|| MeasureWriter::create(&measures))
                    .transpose()?,
                (scene.has_periods())
                    .then(|| EventWriter::create(&events))
                    .transpose()?,
                FrameFile::create(&frames)?,
            ),
            Some(saved) => (
                HistoryWriter::resume(&history, saved.history)?,
                saved
                    .loads
                    .map(|of| LoadWriter::resume(&loads, of))
                    .transpose()?,
                saved
                    .measures
                    .map(|of| MeasureWriter::resume(&measures, of))
                    .transpose()?,
                saved
                    .events
                    .map(|of| EventWriter::resume(&events, of))
                    .transpose()?,
                FrameFile::resume(&frames, saved.frames, plan.start.shape)?,
            ),
        };
        // The files have been cut back to the checkpoint.
        let tables = match keeps && !is_new {
            true => Some(Tables::read(folder.root())?),
            false => keeps.then(Tables::default),
        };
        let mut writer = Self {
            tables,
            history,
            loads,
            measures,
            events,
            frames,
            progress: saved.unwrap_or_else(|| RunProgress {
                scene: plan.hash.to_string(),
                version: env!("CARGO_PKG_VERSION").into(),
                commit: commit::noted(),
                steps_by: plan.steps_by,
                ..RunProgress::default()
            }),
            checkpoint: folder.path(RunFolder::CHECKPOINT),
            clock,
            last_change: last_change(scene),
        };
        if is_new {
            writer.record_start(under_way)?;
        }
        Ok(writer)
    }

    /// Records the state at the start.
    fn record_start(&mut self, under_way: &UnderWay) -> Result<(), RunError> {
        self.progress.elastic = ElasticSummary::of(&under_way.simulation);
        self.observe_elastic(under_way);
        self.progress.kept.observe(under_way);
        self.progress.start_energy = under_way.simulation.energy();
        let row = row_of_start(&under_way.simulation);
        self.progress.energy = EnergySummary::of_start(&under_way.simulation);
        self.progress.strain = row.strain;
        self.observe_sheets(under_way);
        self.follow_folds(under_way);
        self.progress.gap = row.gap;
        self.record_row(row)?;
        self.record_measures(under_way)?;
        self.record_frame(under_way)?;
        self.save(&under_way.simulation.checkpoint())
    }

    /// Records a step that has been taken, but for its frame.
    pub(super) fn record_step(
        &mut self,
        scene: &Scene,
        under_way: &UnderWay,
        report: &StepReport,
    ) -> Result<(), RunError> {
        self.progress.steps += 1;
        self.count(scene, under_way, report);
        self.observe_sheets(under_way);
        self.observe_elastic(under_way);
        self.progress.kept.observe(under_way);
        self.follow_folds(under_way);
        let model = under_way.simulation.model();
        let row = row_of_step(report, model, self.progress.start_energy);
        self.record_row(row)?;
        self.record_loads(under_way)?;
        self.record_measures(under_way)
    }

    /// Records what has been taken up and released.
    pub(super) fn record_events(
        &mut self,
        rows: impl IntoIterator<Item = EventRow>,
    ) -> Result<(), RunError> {
        let Some(events) = &mut self.events else {
            return Ok(());
        };
        for row in rows {
            events.append(&row)?;
            if let Some(tables) = &mut self.tables {
                tables.events.push(row);
            }
        }
        Ok(())
    }

    fn record_row(&mut self, row: HistoryRow) -> Result<(), RunError> {
        self.history.append(&row)?;
        if let Some(tables) = &mut self.tables {
            tables.history.push(row);
        }
        Ok(())
    }

    /// Records a frame.
    pub(super) fn record_frame(&mut self, under_way: &UnderWay) -> Result<(), RunError> {
        let simulation = &under_way.simulation;
        let state = simulation.state();
        let facts = &under_way.facts;
        let rod_forces = facts.of_edges(simulation.rod_forces().unwrap_or_default());
        // Points of round bodies, which come after all others, are not seen.
        let seen = facts.sheet.topology().vertex_count();
        let mut contact_forces = simulation.surface_forces().unwrap_or_default();
        contact_forces.truncate(3 * seen);
        let shown = facts.shown(&state.x);
        CarriedBody::add_round_forces(&facts.bodies, simulation, &shown, &mut contact_forces);
        let mut gaps = simulation.vertex_gaps().unwrap_or_default();
        gaps.truncate(seen);
        let plastic_angles = facts.of_edges(simulation.plastic_angles().unwrap_or_default());
        let curvatures = simulation.plastic_curvatures().unwrap_or_default();
        let plastic_curvatures = facts.of_faces(curvatures.into_flattened());
        let crease_bends = facts.of_edges(simulation.bends_at_creases().unwrap_or_default());
        let data = FrameData {
            rod_forces: &rod_forces,
            contact_forces: &contact_forces,
            gaps: &gaps,
            plastic_angles: &plastic_angles,
            plastic_curvatures: &plastic_curvatures,
            crease_bends: &crease_bends,
            ..FrameData::default()
        };
        Ok(self.frames.append(state.t, &shown, &data)?)
    }

    /// Takes back the last frame.
    pub(super) fn take_back_frame(&mut self) -> Result<(), RunError> {
        Ok(self.frames.take_back()?)
    }

    /// Records the loads at the end of a step.
    fn record_loads(&mut self, under_way: &UnderWay) -> Result<(), RunError> {
        let Some(loads) = &mut self.loads else {
            return Ok(());
        };
        let t = under_way.simulation.state().t;
        let supports = under_way.supports.loads(&under_way.simulation).enumerate();
        let on_supports = supports.map(|(number, load)| LoadRow {
            t,
            on: LoadKind::Support,
            number,
            force: load.force,
            torque: load.torque,
        });
        let obstacles = under_way.facts.obstacle_loads(&under_way.simulation);
        let on_obstacles = obstacles
            .into_iter()
            .enumerate()
            .map(|(number, load)| LoadRow {
                t,
                on: LoadKind::Obstacle,
                number,
                force: load.force,
                torque: load.torque,
            });
        let on_bodies = CarriedBody::contact_loads(&under_way.facts.bodies, &under_way.simulation);
        let on_bodies = on_bodies
            .into_iter()
            .enumerate()
            .map(|(number, load)| LoadRow {
                t,
                on: LoadKind::Body,
                number,
                force: load.force,
                torque: load.torque,
            });
        let guided = under_way.facts.bodies.iter().enumerate();
        let of_guides = guided.filter_map(|(number, body)| {
            let load = body.guide_load(&under_way.simulation)?;
            Some(LoadRow {
                t,
                on: LoadKind::Guide,
                number,
                force: load.force,
                torque: load.torque,
            })
        });
        for row in on_supports
            .chain(on_obstacles)
            .chain(on_bodies)
            .chain(of_guides)
        {
            loads.append(&row)?;
            if let Some(tables) = &mut self.tables {
                tables.loads.push(row);
            }
        }
        Ok(())
    }

    /// Records what the gauges show.
    fn record_measures(&mut self, under_way: &UnderWay) -> Result<(), RunError> {
        let Some(measures) = &mut self.measures else {
            return Ok(());
        };
        let state = under_way.simulation.state();
        let x = under_way.facts.shown(&state.x);
        for gauge in &under_way.facts.measures {
            let row = MeasureRow {
                t: state.t,
                name: gauge.name.clone(),
                value: gauge.value(state.t, &x, under_way.simulation.memories()),
            };
            measures.append(&row)?;
            if let Some(tables) = &mut self.tables {
                tables.measures.push(row.clone());
            }
            let first = Measured {
                last: row.value,
                least: row.value,
                largest: row.value,
            };
            let measured = self.progress.measured.entry(row.name).or_insert(first);
            measured.last = row.value;
            measured.least = measured.least.min(row.value);
            measured.largest = measured.largest.max(row.value);
        }
        Ok(())
    }

    fn count(&mut self, scene: &Scene, under_way: &UnderWay, report: &StepReport) {
        let displacement = displacement(under_way);
        let mass = under_way.simulation.model().mass().total();
        let coordinates = under_way.simulation.state().x.iter();
        let size = coordinates.fold(0.0, |size: f64, c| size.max(c.abs()));
        let progress = &mut self.progress;
        progress.strain = progress.strain.max(report.strain);
        progress.displacement = progress.displacement.max(displacement);
        progress.energy.observe(report, mass, size);
        let (asked, before) = (scene.method.accuracy, progress.time_error);
        progress.time_error = TimeError::after(report, asked, before);
        // Whoever looks for a state of rest needs no vibrations on the way, and an accuracy divides the
        // steps.
        let method = &scene.method;
        let is_resolved = method.accuracy.is_some() || scene.stop.rest.is_some();
        if method.integrator == Integrator::Bdf2 && !is_resolved {
            let (t, h) = (report.t, report.h);
            progress.vibrations.observe(t, h, report.kinetic);
        }
        progress.balance = ForceBalance::after(progress.balance, &under_way.simulation);
        if let Some(incidence) = Incidence::after(scene, under_way) {
            progress.incidence = Some(incidence.larger(progress.incidence));
        }
        progress.iterations += report.iterations as u64;
        progress.factorisations += report.factorisations as u64;
        progress.rejected += report.rejected as u64;
        // An infinite gap means that nothing is within reach.
        if let Some(gap) = report.gap.filter(|gap| gap.is_finite()) {
            progress.gap = Some(progress.gap.map_or(gap, |least| least.min(gap)));
        }
    }

    /// Takes in the strain of each of several sheets.
    fn observe_sheets(&mut self, under_way: &UnderWay) {
        let facts = &under_way.facts;
        let strains = &mut self.progress.sheet_strains;
        // Bodies and obstacles in motion come last.
        let others = facts.bodies.len() + facts.origins.driven_parts().len();
        strains.resize(facts.parts.len() - others, 0.0);
        let (edges, x) = (
            under_way.simulation.model().edges(),
            &under_way.simulation.state().x,
        );
        for (strain, (_, part)) in strains.iter_mut().zip(&facts.parts) {
            *strain = strain.max(edges.max_strain_among(part.edges.clone(), x));
        }
    }

    fn observe_elastic(&mut self, under_way: &UnderWay) {
        if let Some(elastic) = &mut self.progress.elastic {
            elastic.observe(&under_way.simulation);
        }
    }

    /// Takes in the angles of creases that are folded to targets.
    fn follow_folds(&mut self, under_way: &UnderWay) {
        let Some(targets) = &under_way.facts.targets.folding else {
            return;
        };
        let topology = under_way.simulation.model().topology();
        let x = &under_way.simulation.state().x;
        match &mut self.progress.folds {
            Some(folds) => folds.follow(targets, topology, x),
            none => *none = Some(FollowedFolds::begin(targets, topology, x)),
        }
    }

    /// Whether a condition to stop holds after a step.
    pub(super) fn end_reason(
        &mut self,
        scene: &Scene,
        under_way: &UnderWay,
        report: &StepReport,
    ) -> Option<EndReason> {
        if report.taut.is_some() {
            return Some(EndReason::Taut);
        }
        if scene.stop.is_force_reached(|| under_way.support_forces()) {
            return Some(EndReason::SupportForce);
        }
        if let Some(rest) = &scene.stop.rest {
            // A sheet at rest is not at its end while a support is about to release it, or a function of time
            // to move it.
            let is_due = under_way.is_due(scene) || report.t < self.last_change;
            if is_due || largest_speed(under_way) > rest.speed {
                self.progress.slow_since = None;
            } else {
                let since = *self.progress.slow_since.get_or_insert(report.t);
                if report.t - since >= rest.duration {
                    return Some(EndReason::Rest);
                }
            }
        }
        (self.progress.steps >= step_count(scene)).then_some(EndReason::Time)
    }

    /// Writes a checkpoint of the simulation after the steps that are recorded, after everything that it
    /// counts is on the disk.
    pub(super) fn save(&mut self, simulation: &Checkpoint) -> Result<(), RunError> {
        self.history.sync()?;
        self.frames.sync()?;
        self.progress.history = self.history.written();
        if let Some(loads) = &self.loads {
            loads.sync()?;
            self.progress.loads = Some(loads.written());
        }
        if let Some(measures) = &self.measures {
            measures.sync()?;
            self.progress.measures = Some(measures.written());
        }
        if let Some(events) = &self.events {
            events.sync()?;
            self.progress.events = Some(events.written());
        }
        self.progress.frames = self.frames.count();
        self.progress.wall += self.clock.elapsed().as_secs_f64();
        self.clock = Instant::now();
        checkpoint::write(&self.checkpoint, &self.progress, simulation)
    }
}

/// Largest distance of a vertex from its place at the start, metres.
fn displacement(under_way: &UnderWay) -> f64 {
    let now = under_way.facts.shown(&under_way.simulation.state().x);
    let pairs = now
        .as_chunks::<3>()
        .0
        .iter()
        .zip(under_way.facts.start.as_chunks::<3>().0);
    let distances = pairs.map(|(p, q)| (Vector3::from(*p) - Vector3::from(*q)).norm());
    distances.fold(0.0, f64::max)
}

/// Largest speed of a vertex, m/s.
pub(super) fn largest_speed(under_way: &UnderWay) -> f64 {
    let velocities = under_way.facts.shown(&under_way.simulation.state().v);
    let speeds = velocities
        .as_chunks::<3>()
        .0
        .iter()
        .map(|v| Vector3::from(*v).norm());
    speeds.fold(0.0, f64::max)
}
