//! Who watches a run, and what the watcher is told.

use isosheet_scenes::Warning;
use std::ops::ControlFlow;
use std::time::Duration;

/// How a run begins.
#[derive(Clone, Debug, PartialEq)]
pub struct Beginning {
    /// Steps that were taken before, 0 for a new run.
    pub steps: u64,
    /// Most steps of the whole run.
    pub of: u64,
    /// What is modelled, in words.
    pub modelled: Vec<String>,
    /// Number of vertices.
    pub vertices: usize,
    /// What to know before the run.
    pub warnings: Vec<Warning>,
}

/// What has been reached after a step.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Tick {
    /// Time, seconds.
    pub t: f64,
    /// Steps taken.
    pub steps: u64,
    /// Most steps of the whole run.
    pub of: u64,
    /// Largest edge strain at the end of the step.
    pub strain: f64,
    /// Smallest gap, metres; none if nothing is close.
    pub gap: Option<f64>,
    /// Wall time of the step, without what is recorded of it.
    pub wall: Duration,
    /// Time of the processor of the step: that of the thread that calls.
    pub cpu: Duration,
}

/// How far a step has come that is under way.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct StepPart {
    /// The number of the step, from 1.
    pub step: u64,
    /// Most steps of the whole run.
    pub of: u64,
    /// The part of the step that accepted sub-steps have reached, from 0 to 1.
    pub part: f64,
    /// Accepted sub-steps of the step.
    pub substeps: usize,
    /// Matrix factorisations of the step, rejected sub-steps included.
    pub factorisations: usize,
}

/// Is told what the iterations of the steps do, see
/// [`Simulation::with_trace`](isosheet_dynamics::Simulation::with_trace).
pub type TraceSink = Box<dyn FnMut(&isosheet_dynamics::TraceEvent) + Send>;

/// Watches a run.
pub trait Watch {
    /// Called before the first step.
    fn begin(&mut self, _beginning: &Beginning) {}

    /// Who is told what the iterations of the steps do; asked once, before the first step.
    fn trace(&mut self) -> Option<TraceSink> {
        None
    }

    /// Called between the factorisations of a step. [`ControlFlow::Break`] gives the step up, writes a
    /// checkpoint of the state before it and stops.
    fn within_step(&mut self, _part: &StepPart) -> ControlFlow<()> {
        ControlFlow::Continue(())
    }

    /// Called after every step. [`ControlFlow::Break`] writes a checkpoint and stops.
    fn step(&mut self, tick: &Tick) -> ControlFlow<()>;
}

impl<F: FnMut(&Tick) -> ControlFlow<()>> Watch for F {
    fn step(&mut self, tick: &Tick) -> ControlFlow<()> {
        self(tick)
    }
}
