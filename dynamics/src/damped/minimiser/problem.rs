//! The problem of one implicit step.

use crate::objective::Objective;
use crate::step::integrator::Phases;
use crate::{SheetModel, State};
use isosheet_materials::potential::Memories;
use isosheet_model::term::{Iterate, StepStart};

/// Minimise the [`Objective`] over the positions with the rest lengths and with the vertex constraints kept
/// at the end of the step.
pub(crate) struct StepProblem<'a> {
    /// The sheet.
    pub(crate) model: &'a SheetModel,
    /// What its potentials remember.
    pub(crate) memories: &'a Memories,
    pub(crate) objective: &'a mut Objective,
    pub(crate) start: StepStart<'a>,
    /// Phases that may be tried.
    pub(crate) phases: Phases,
}

impl<'a> StepProblem<'a> {
    /// The state at the start.
    pub(crate) fn state(&self) -> &'a State {
        self.start.state
    }

    /// Time at the end of the step, seconds.
    pub(crate) fn t(&self) -> f64 {
        self.start.t()
    }

    /// The effective step, seconds.
    pub(crate) fn h(&self) -> f64 {
        self.start.h
    }

    /// The objective, and where it is evaluated at positions `x`.
    pub(crate) fn objective_at<'x>(&'x mut self, x: &'x [f64]) -> (&'x mut Objective, Iterate<'x>) {
        let (t, memories) = (self.t(), self.memories);
        (self.objective, Iterate { t, x, memories })
    }

    /// Whether there is contact, or another barrier that holds on the whole way of a displacement.
    pub(crate) fn has_contact(&self) -> bool {
        self.objective.has_barrier_on_the_way()
    }

    /// Whether displacements are bounded. Then pins in motion start where they were, and advance with the
    /// iterates.
    pub(crate) fn is_bounded(&self) -> bool {
        self.objective.has_barrier()
    }
}
