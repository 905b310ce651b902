//! The steps of a run and what is recorded of them.

use super::balance::ForceBalance;
use super::checkpoint::RunProgress;
use super::folder::RunFolder;
use super::plan::Plan;
use super::steps::{step_count, step_length};
use super::writer::RunWriter;
use super::{RunError, StepPart, Tick, Watch};
use cpu_time::ThreadTime;
use isosheet_dynamics::{StepError, StepProgress};
use isosheet_scenes::{Kept, SceneError, UnderWay, check_positions};
use std::time::Instant;

/// A run between two steps.
pub(crate) struct Stepping<'a> {
    plan: &'a Plan<'a>,
    kept: &'a mut Kept,
    pub(crate) under_way: UnderWay,
    pub(crate) writer: RunWriter,
}

impl<'a> Stepping<'a> {
    /// A run at its start, or after `saved` steps, of which its folder has the files.
    pub(crate) fn begin(
        plan: &'a Plan<'a>,
        folder: &RunFolder,
        kept: &'a mut Kept,
        under_way: UnderWay,
        saved: Option<RunProgress>,
        clock: Instant,
    ) -> Result<Self, RunError> {
        let writer = RunWriter::begin(plan, folder, &under_way, saved, clock)?;
        Ok(Self {
            plan,
            kept,
            under_way,
            writer,
        })
    }

    /// Takes and records a step. Says what has been reached, or nothing if the watch gave the step up: then a
    /// checkpoint of the state before it is written.
    pub(crate) fn step(&mut self, watch: &mut dyn Watch) -> Result<Option<Tick>, RunError> {
        let scene = self.plan.file.scene();
        let number = self.writer.progress.steps + 1;
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
        let stepped = self.under_way.step_watched(h, &mut ask);
        let (wall, cpu) = (wall.elapsed(), cpu.elapsed());
        let report = match stepped {
            Ok(report) => report,
            Err(StepError::Interrupted { .. }) => {
                self.writer.save(&before)?;
                return Ok(None);
            }
            Err(error) => {
                let problem = SceneError::from(self.under_way.problem(scene, &error, h));
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
        let (writer, under_way) = (&mut self.writer, &self.under_way);
        writer.record_step(scene, under_way, &report)?;
        let reason = writer.end_reason(scene, under_way, &report);
        let frame = scene.output.steps_per_frame(scene.method.step);
        if number.is_multiple_of(frame) || reason.is_some() {
            writer.record_frame(under_way)?;
        }
        if let Some(reason) = reason {
            writer.progress.end_balance = ForceBalance::at_end(None, &under_way.simulation);
            writer.progress.ending = Some(writer.ending(under_way, reason, &report));
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

    /// Takes up and releases what the last step asks for. (Not at its end, where a run may stop that is
    /// continued later.)
    fn switch(&mut self) -> Result<(), RunError> {
        if self.writer.progress.steps == 0 {
            return Ok(());
        }
        let scene = self.plan.file.scene();
        let switched = self.under_way.switch(scene, self.kept, None);
        let rows = switched.map_err(|e| RunError::Step(e.in_text(self.plan.file.text())))?;
        self.writer.record_events(rows)
    }

    /// Writes a checkpoint, after everything that it counts is on the disk.
    pub(crate) fn save(&mut self) -> Result<(), RunError> {
        self.writer.save(&self.under_way.simulation.checkpoint())
    }
}
