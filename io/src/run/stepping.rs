//! The steps of a run and what is recorded of them.

use super::checkpoint::{self, RunProgress};
use super::elastic::ElasticSummary;
use super::energy::EnergySummary;
use super::folder::{RunFolder, SceneHash};
use super::frames::{FrameFile, FrameShape};
use super::recording::Tables;
use super::summary::{EndReason, Ending, Measured};
use super::{RunError, StepPart, Tick, Watch};
use crate::format::{
    EventWriter, FrameData, HistoryRow, HistoryWriter, LoadKind, LoadRow, LoadWriter,
};
use crate::format::{MeasureRow, MeasureWriter};
use crate::scene::check_positions;
use crate::scene::{CarriedBody, Facts, Integrator, Kept, Scene, SceneError, SceneFile, UnderWay};
use cpu_time::ThreadTime;
use isosheet_dynamics::contact::ActiveContacts;
use isosheet_dynamics::{
    Checkpoint, SheetModel, Simulation, State, StepError, StepProgress, StepReport,
};
use nalgebra::Vector3;
use std::time::Instant;

/// What is known of a run before its first step.
pub(crate) struct Plan<'a> {
    pub(crate) file: &'a SceneFile,
    pub(crate) hash: SceneHash,
    pub(crate) facts: Facts,
    pub(crate) shape: FrameShape,
    pub(crate) rows: Rows,
}

/// Where the rows of the tables of a run are, while it goes on.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Rows {
    /// In its files.
    InFiles,
    /// In its files, and in memory for what is made of them at the end.
    InMemory,
}

/// A run between two steps.
pub(crate) struct Stepping<'a> {
    plan: &'a Plan<'a>,
    folder: &'a RunFolder,
    kept: &'a mut Kept,
    pub(crate) under_way: UnderWay,
    history: HistoryWriter,
    /// The loads of supports and obstacles, if there are any.
    loads: Option<LoadWriter>,
    /// What the measures of the scene show, if there are any.
    measures: Option<MeasureWriter>,
    /// What is taken up and released, if anything is.
    events: Option<EventWriter>,
    frames: FrameFile,
    /// The rows of these tables, where they are kept in memory.
    pub(crate) tables: Option<Tables>,
    pub(crate) progress: RunProgress,
    /// Since when the wall time in the progress counts.
    pub(crate) clock: Instant,
}

/// Part of a step by which the time of a run may differ from a whole number of steps, to allow for round-off.
const ROUND_OFF: f64 = 1e-9;

/// Number of steps of a run.
pub(crate) fn step_count(scene: &Scene) -> u64 {
    let steps = (scene.stop.time / scene.method.step - ROUND_OFF).ceil();
    steps.max(1.0) as u64
}

/// Length of the last step that the time asks for, seconds.
fn last_length(scene: &Scene) -> f64 {
    scene.stop.time - (step_count(scene) - 1) as f64 * scene.method.step
}

/// Whether the last step of a run is shorter than the others.
pub(super) fn has_short_step(scene: &Scene) -> bool {
    let h = scene.method.step;
    (last_length(scene) - h).abs() > ROUND_OFF * h
}

/// Length of a step, from 1 to the number of steps: the last one is as short as the time asks for.
fn step_length(scene: &Scene, number: u64) -> f64 {
    match number == step_count(scene) && has_short_step(scene) {
        true => last_length(scene),
        false => scene.method.step,
    }
}

impl HistoryRow {
    /// The row of the state that a simulation starts at.
    pub(crate) fn of_start(simulation: &Simulation) -> Self {
        let state = simulation.state();
        let kinetic = simulation.model().kinetic_energy(&state.v);
        let total = simulation.energy();
        Self {
            t: state.t,
            kinetic,
            potential: total - kinetic,
            total,
            strain: simulation.model().max_strain(&state.x),
            plastic: dissipated(simulation.model(), 0.0),
            gap: simulation.contacts().and_then(finite_gap),
            ..Self::default()
        }
    }

    /// The row of a step of a model in a run that started at an energy, joules.
    pub(crate) fn of_step(report: &StepReport, model: &SheetModel, start_energy: f64) -> Self {
        let total = report.hamiltonian();
        Self {
            t: report.t,
            h: report.h,
            substeps: report.substeps,
            iterations: report.iterations,
            factorisations: report.factorisations,
            rejected: report.rejected,
            kinetic: report.kinetic,
            potential: report.potential,
            total,
            drift: total - start_energy,
            work: report.work,
            damped: report.dissipated,
            friction: report.friction,
            plastic: dissipated(model, report.plastic),
            strain: report.strain,
            gap: report.gap.filter(|gap| gap.is_finite()),
        }
    }
}

/// The smallest gap; none if nothing is within reach.
fn finite_gap(contacts: &ActiveContacts) -> Option<f64> {
    Some(contacts.gap()).filter(|gap| gap.is_finite())
}

/// What yielding has dissipated, joules, as it is written: none if nothing can yield.
fn dissipated(model: &SheetModel, plastic: f64) -> Option<f64> {
    model.can_yield().then_some(plastic)
}

impl<'a> Stepping<'a> {
    /// A run at its start, or after `saved` steps, of which its folder has the files.
    pub(crate) fn begin(
        plan: &'a Plan<'a>,
        folder: &'a RunFolder,
        kept: &'a mut Kept,
        under_way: UnderWay,
        saved: Option<RunProgress>,
        clock: Instant,
    ) -> Result<Self, RunError> {
        let (scene, facts) = (plan.file.scene(), &plan.facts);
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
                (scene.periods().next().is_some())
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
                FrameFile::resume(&frames, saved.frames, plan.shape)?,
            ),
        };
        // The files have been cut back to the checkpoint.
        let tables = match keeps && !is_new {
            true => Some(Tables::read(folder.root())?),
            false => keeps.then(Tables::default),
        };
        let mut stepping = Self {
            tables,
            history,
            loads,
            measures,
            events,
            frames,
            progress: saved.unwrap_or_else(|| RunProgress {
                scene: plan.hash.to_string(),
                version: env!("CARGO_PKG_VERSION").into(),
                ..RunProgress::default()
            }),
            plan,
            folder,
            kept,
            under_way,
            clock,
        };
        if is_new {
            stepping.record_start()?;
        }
        Ok(stepping)
    }

    /// Records the state at the start.
    fn record_start(&mut self) -> Result<(), RunError> {
        self.progress.elastic = ElasticSummary::of(self.under_way.simulation.model());
        self.observe_elastic();
        self.progress.start_energy = self.under_way.simulation.energy();
        let row = HistoryRow::of_start(&self.under_way.simulation);
        self.progress.energy = EnergySummary::of_start(&self.under_way.simulation);
        self.progress.strain = row.strain;
        self.observe_sheets();
        self.progress.gap = row.gap;
        self.record_row(row)?;
        self.record_measures()?;
        self.record_frame()?;
        self.save()
    }

    fn record_row(&mut self, row: HistoryRow) -> Result<(), RunError> {
        self.history.append(&row)?;
        if let Some(tables) = &mut self.tables {
            tables.history.push(row);
        }
        Ok(())
    }

    fn record_frame(&mut self) -> Result<(), RunError> {
        let simulation = &self.under_way.simulation;
        let state = simulation.state();
        let facts = &self.under_way.facts;
        let rod_forces = facts.of_edges(simulation.rod_forces().unwrap_or_default());
        let contact_forces = simulation.surface_forces().unwrap_or_default();
        let gaps = simulation.vertex_gaps().unwrap_or_default();
        let plastic_angles = facts.of_edges(simulation.plastic_angles().unwrap_or_default());
        let curvatures = simulation.plastic_curvatures().unwrap_or_default();
        let plastic_curvatures = facts.of_faces(curvatures.into_flattened());
        let data = FrameData {
            rod_forces: &rod_forces,
            contact_forces: &contact_forces,
            gaps: &gaps,
            plastic_angles: &plastic_angles,
            plastic_curvatures: &plastic_curvatures,
        };
        let (t, x) = (state.t, self.under_way.facts.shown(&state.x));
        Ok(self.frames.append(t, &x, &data)?)
    }

    /// Records the loads at the end of a step.
    fn record_loads(&mut self) -> Result<(), RunError> {
        let Some(loads) = &mut self.loads else {
            return Ok(());
        };
        let t = self.under_way.simulation.state().t;
        let supports = self
            .under_way
            .supports
            .loads(&self.under_way.simulation)
            .enumerate();
        let on_supports = supports.map(|(number, load)| LoadRow {
            t,
            on: LoadKind::Support,
            number,
            force: load.force,
            torque: load.torque,
        });
        let obstacles = self
            .under_way
            .facts
            .obstacle_loads(&self.under_way.simulation);
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
        let on_bodies =
            CarriedBody::contact_loads(&self.under_way.facts.bodies, &self.under_way.simulation);
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
        let guided = self.under_way.facts.bodies.iter().enumerate();
        let of_guides = guided.filter_map(|(number, body)| {
            let load = body.guide_load(&self.under_way.simulation)?;
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
    fn record_measures(&mut self) -> Result<(), RunError> {
        let Some(measures) = &mut self.measures else {
            return Ok(());
        };
        let state = self.under_way.simulation.state();
        let x = self.under_way.facts.shown(&state.x);
        for gauge in &self.under_way.facts.measures {
            let row = MeasureRow {
                t: state.t,
                name: gauge.name.clone(),
                value: gauge.value(&x),
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

    /// Takes and records a step. Says what has been reached, or nothing if the watch gave the step up: then a
    /// checkpoint of the state before it is written.
    pub(crate) fn step(&mut self, watch: &mut dyn Watch) -> Result<Option<Tick>, RunError> {
        let scene = self.plan.file.scene();
        let number = self.progress.steps + 1;
        let h = step_length(scene, number);
        self.switch()?;
        let before = self.under_way.simulation.checkpoint();
        let start = self.under_way.simulation.state().t;
        let mut part = StepPart {
            step: number,
            of: step_count(scene),
            part: 0.0,
            substeps: 0,
            factorisations: 0,
        };
        let mut reached = start;
        let mut ask = |progress: &StepProgress| {
            if progress.t > reached {
                reached = progress.t;
                part.substeps += 1;
            }
            part.part = ((reached - start) / h).min(1.0);
            part.factorisations = progress.factorisations;
            watch.within_step(&part)
        };
        let (wall, cpu) = (Instant::now(), ThreadTime::now());
        let stepped = self.under_way.simulation.step_watched(h, &mut ask);
        let (wall, cpu) = (wall.elapsed(), cpu.elapsed());
        let report = match stepped {
            Ok(report) => report,
            Err(StepError::Interrupted { .. }) => {
                self.write_checkpoint(&before)?;
                return Ok(None);
            }
            Err(error) => {
                let problem = SceneError::from(
                    self.under_way
                        .facts
                        .origins
                        .of_failed_step(&error, &self.under_way.simulation),
                );
                return Err(RunError::Step(problem.in_text(self.plan.file.text())));
            }
        };
        let (model, x) = (
            self.under_way.simulation.model(),
            &self.under_way.simulation.state().x,
        );
        if let Err(problem) = check_positions(model, x) {
            let problem = SceneError::from(problem).in_text(self.plan.file.text());
            return Err(RunError::Step(problem));
        }
        self.progress.steps = number;
        self.count(&report);
        self.observe_sheets();
        self.observe_elastic();
        self.record_row(self.row(&report))?;
        self.record_loads()?;
        self.record_measures()?;
        let reason = self.end_reason(&report);
        let frame = scene.output.steps_per_frame(scene.method.step);
        if number.is_multiple_of(frame) || reason.is_some() {
            self.record_frame()?;
        }
        if let Some(reason) = reason {
            self.progress.ending = Some(self.ending(reason, &report));
        }
        Ok(Some(Tick {
            t: report.t,
            steps: number,
            of: step_count(scene),
            strain: report.strain,
            gap: report.gap.filter(|gap| gap.is_finite()),
            wall,
            cpu,
        }))
    }

    /// Takes up and releases what the last step asks for. (Not at its end, where a run may stop that is continued
    /// later.)
    fn switch(&mut self) -> Result<(), RunError> {
        let Some(events) = self.events.as_mut().filter(|_| self.progress.steps > 0) else {
            return Ok(());
        };
        let scene = self.plan.file.scene();
        let switched = self.under_way.switch(scene, self.kept, None);
        let rows = switched.map_err(|e| RunError::Step(e.in_text(self.plan.file.text())))?;
        for row in rows {
            events.append(&row)?;
            if let Some(tables) = &mut self.tables {
                tables.events.push(row);
            }
        }
        Ok(())
    }

    fn count(&mut self, report: &StepReport) {
        let displacement = self.displacement();
        let mass = self.under_way.simulation.model().mass().total();
        let coordinates = self.under_way.simulation.state().x.iter();
        let size = coordinates.fold(0.0, |size: f64, c| size.max(c.abs()));
        let progress = &mut self.progress;
        progress.strain = progress.strain.max(report.strain);
        progress.displacement = progress.displacement.max(displacement);
        progress.energy.observe(report, mass, size);
        let scene = self.plan.file.scene();
        // Whoever looks for a state of rest needs no vibrations on the way.
        if scene.method.integrator == Integrator::Bdf2 && scene.stop.rest.is_none() {
            let (t, h) = (report.t, report.h);
            progress.vibrations.observe(t, h, report.kinetic);
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
    fn observe_sheets(&mut self) {
        let facts = &self.plan.facts;
        let strains = &mut self.progress.sheet_strains;
        // Bodies and obstacles in motion come last.
        let others = facts.bodies.len() + facts.origins.driven.len();
        strains.resize(facts.parts.len() - others, 0.0);
        let (edges, x) = (
            self.under_way.simulation.model().edges(),
            &self.under_way.simulation.state().x,
        );
        for (strain, (_, part)) in strains.iter_mut().zip(&facts.parts) {
            *strain = strain.max(edges.max_strain_among(part.edges.clone(), x));
        }
    }

    fn observe_elastic(&mut self) {
        if let Some(elastic) = &mut self.progress.elastic {
            elastic.observe(&self.under_way.simulation);
        }
    }

    fn row(&self, report: &StepReport) -> HistoryRow {
        let model = self.under_way.simulation.model();
        HistoryRow::of_step(report, model, self.progress.start_energy)
    }

    /// Whether a condition to stop holds after a step.
    fn end_reason(&mut self, report: &StepReport) -> Option<EndReason> {
        let scene = self.plan.file.scene();
        if report.taut.is_some() {
            return Some(EndReason::Taut);
        }
        if scene.stop.is_force_reached(|| self.support_forces()) {
            return Some(EndReason::SupportForce);
        }
        if let Some(rest) = &scene.stop.rest {
            // A sheet at rest that a support is about to release is not at its end.
            let is_due = self.under_way.switches.are_due(scene);
            if is_due || self.largest_speed() > rest.speed {
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

    /// Largest distance of a vertex from its place at the start, metres.
    fn displacement(&self) -> f64 {
        let now = self
            .under_way
            .facts
            .shown(&self.under_way.simulation.state().x);
        let pairs = now
            .as_chunks::<3>()
            .0
            .iter()
            .zip(self.under_way.facts.start.as_chunks::<3>().0);
        let distances = pairs.map(|(p, q)| (Vector3::from(*p) - Vector3::from(*q)).norm());
        distances.fold(0.0, f64::max)
    }

    fn largest_speed(&self) -> f64 {
        let velocities = self
            .under_way
            .facts
            .shown(&self.under_way.simulation.state().v);
        let speeds = velocities
            .as_chunks::<3>()
            .0
            .iter()
            .map(|v| Vector3::from(*v).norm());
        speeds.fold(0.0, f64::max)
    }

    /// Force of each support of the scene on the sheet, newtons.
    fn support_forces(&self) -> Vec<[f64; 3]> {
        self.under_way.support_forces()
    }

    fn ending(&self, reason: EndReason, report: &StepReport) -> Ending {
        let loads = self
            .under_way
            .facts
            .obstacle_loads(&self.under_way.simulation);
        Ending {
            reason,
            t: report.t,
            kinetic: report.kinetic,
            potential: report.potential,
            plastic: dissipated(self.under_way.simulation.model(), report.plastic),
            energy_drift: report.energy_drift,
            largest_speed: self.largest_speed(),
            supports: self.support_forces(),
            obstacles: loads.iter().map(|load| load.force).collect(),
            bodies: CarriedBody::contact_loads(
                &self.under_way.facts.bodies,
                &self.under_way.simulation,
            )
            .iter()
            .map(|load| load.force)
            .collect(),
            taut: report.taut.as_ref().map(|demand| demand.to_string()),
            residuals: {
                let State { t, x, .. } = self.under_way.simulation.state();
                self.under_way.facts.targets.residuals(
                    self.under_way.simulation.model().topology(),
                    *t,
                    x,
                )
            },
        }
    }

    /// Writes a checkpoint, after everything that it counts is on the disk.
    pub(crate) fn save(&mut self) -> Result<(), RunError> {
        self.write_checkpoint(&self.under_way.simulation.checkpoint())
    }

    /// Writes a checkpoint of the simulation after the steps that are recorded.
    fn write_checkpoint(&mut self, simulation: &Checkpoint) -> Result<(), RunError> {
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
        let path = self.folder.path(RunFolder::CHECKPOINT);
        checkpoint::write(&path, &self.progress, simulation)
    }
}
