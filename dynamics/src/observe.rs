//! Whole runs: steps of equal length, watched by observers.

use crate::report::{StepError, StepReport};
use crate::{Simulation, State};
use std::ops::ControlFlow;

/// Watches a run.
///
/// Closures `FnMut(&Simulation, &StepReport) -> ControlFlow<()>` are observers, too.
pub trait Observer {
    /// Called once before the first step.
    fn start(&mut self, _simulation: &Simulation) {}

    /// Called after every step. [`ControlFlow::Break`] ends the run after this step.
    fn step(&mut self, simulation: &Simulation, report: &StepReport) -> ControlFlow<()>;
}

impl<F: FnMut(&Simulation, &StepReport) -> ControlFlow<()>> Observer for F {
    fn step(&mut self, simulation: &Simulation, report: &StepReport) -> ControlFlow<()> {
        self(simulation, report)
    }
}

/// Keeps the state at the start and after every so many steps.
#[derive(Debug, Clone, PartialEq)]
pub struct Frames {
    every: usize,
    steps: usize,
    states: Vec<State>,
}

impl Frames {
    /// A frame after every `every` steps; zero counts as one.
    pub fn every(every: usize) -> Self {
        Self {
            every: every.max(1),
            steps: 0,
            states: Vec::new(),
        }
    }

    /// The frames so far, that of the start first.
    pub fn states(&self) -> &[State] {
        &self.states
    }
}

impl Observer for Frames {
    fn start(&mut self, simulation: &Simulation) {
        self.states.push(simulation.state().clone());
    }

    fn step(&mut self, simulation: &Simulation, _report: &StepReport) -> ControlFlow<()> {
        self.steps += 1;
        if self.steps.is_multiple_of(self.every) {
            self.states.push(simulation.state().clone());
        }
        ControlFlow::Continue(())
    }
}

/// Keeps the report of every step.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct History {
    reports: Vec<StepReport>,
}

impl History {
    /// The reports so far.
    pub fn reports(&self) -> &[StepReport] {
        &self.reports
    }
}

impl Observer for History {
    fn step(&mut self, _simulation: &Simulation, report: &StepReport) -> ControlFlow<()> {
        self.reports.push(report.clone());
        ControlFlow::Continue(())
    }
}

/// How a run ended.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum RunEnd {
    /// The whole time has passed.
    Complete,
    /// An observer ended it.
    Stopped,
    /// The step control stopped at a taut state, see
    /// [`Unsatisfiable::StopTaut`](crate::Unsatisfiable::StopTaut).
    Taut,
}

/// Part of a step by which the duration of a run may differ from a whole number of steps, to allow for
/// round-off.
const ROUND_OFF: f64 = 1e-9;

impl Simulation {
    /// Advances by `duration` seconds in steps of `step` seconds, the last one shorter where the duration
    /// asks for it, and shows every step to the observers, in their order.
    ///
    /// ```
    /// use isosheet_dynamics::{Frames, History, Method, RunEnd, SheetModel, Simulation, State};
    /// use isosheet_mesh::{MassKind, VertexId, generate};
    ///
    /// # fn main() -> Result<(), Box<dyn std::error::Error>> {
    /// let sheet = generate::isotropic_square(1, 0.21)?;
    /// let model = SheetModel::new(&sheet, 3.5e-3, MassKind::Lumped)?
    ///     .with_gravity()
    ///     .with_pins(&[VertexId(20)])?;
    /// let start = State::at_rest(sheet.positions().to_vec());
    /// let mut simulation = Simulation::new(model, start, Method::default())?;
    /// let (mut frames, mut history) = (Frames::every(2), History::default());
    /// let end = simulation.run(0.1, 1.0 / 60.0, &mut [&mut frames, &mut history])?;
    /// assert_eq!(end, RunEnd::Complete);
    /// assert_eq!((frames.states().len(), history.reports().len()), (4, 6));
    /// # Ok(())
    /// # }
    /// ```
    ///
    /// # Errors
    /// As [`Simulation::step`]; [`StepError::StepSize`] if the duration is not positive and finite. What the
    /// observers have kept up to then stays with them.
    pub fn run(
        &mut self,
        duration: f64,
        step: f64,
        observers: &mut [&mut dyn Observer],
    ) -> Result<RunEnd, StepError> {
        let start = self.state().t;
        for h in [step, duration] {
            if !(h.is_finite() && h > 0.0) {
                return Err(StepError::StepSize { h, t: start });
            }
        }
        for observer in &mut *observers {
            observer.start(self);
        }
        let count = (duration / step - ROUND_OFF).ceil().max(1.0) as u64;
        for k in 1..=count {
            let left = start + duration - self.state().t;
            let is_short = k == count && (left - step).abs() > ROUND_OFF * step;
            let report = self.step(if is_short { left } else { step })?;
            let mut go_on = true;
            for observer in &mut *observers {
                go_on &= observer.step(self, &report).is_continue();
            }
            if report.taut.is_some() {
                return Ok(RunEnd::Taut);
            }
            if !go_on && k < count {
                return Ok(RunEnd::Stopped);
            }
        }
        Ok(RunEnd::Complete)
    }
}
