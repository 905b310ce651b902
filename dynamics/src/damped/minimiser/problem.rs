//! The problem of one implicit step.

use crate::objective::Objective;
use crate::potential::Memories;
use crate::report::reason::Reason;
use crate::report::step_error::StepError;
use crate::step::integrator::Phases;
use crate::term::{Barrier, Iterate, Refusal, StepStart};
use crate::{SheetModel, State};

/// Minimise the [`Objective`] over the positions with the rest lengths and with the vertex constraints kept at
/// the end of the step.
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

    pub(crate) fn has_contact(&self) -> bool {
        self.objective.has(Barrier::Contact)
    }

    /// Whether displacements are bounded. Then pins in motion start where they were, and advance with the
    /// iterates.
    pub(crate) fn is_bounded(&self) -> bool {
        self.has_contact() || self.objective.has(Barrier::StrainLimit)
    }

    /// The error of a refusal by a term after some iterations.
    pub(crate) fn error(&self, refusal: Refusal, iterations: usize) -> StepError {
        match refusal {
            Refusal::NonFiniteForce { vertex, value, t } => {
                StepError::NonFiniteForce { vertex, value, t }
            }
            Refusal::Contact { gap } => StepError::Contact {
                t: self.state().t,
                h: self.start.span,
                gap,
            },
            Refusal::Linalg(source) => StepError::Linalg {
                t: self.state().t,
                source,
            },
            Refusal::UnsettledLoads { error } => StepError::NotConverged {
                t: self.state().t,
                h: self.start.span,
                iterations,
                residual: error,
                strain: 0.0,
                reason: Reason::UnsettledLoads,
            },
        }
    }
}
