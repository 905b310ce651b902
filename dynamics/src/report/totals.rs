//! What a step has done so far.

use crate::report::effort::SolverEffort;
use crate::report::step_report::StepOutcome;
use isosheet_model::{Infeasibility, Reason, StepError};

/// What was done on the way to the end of a step, kept also if the step fails half-way.
#[derive(Debug)]
pub(crate) struct StepTotals<'w> {
    pub(crate) substeps: usize,
    pub(crate) rejected: usize,
    pub(crate) effort: SolverEffort<'w>,
    pub(crate) residual: f64,
    pub(crate) error: Option<f64>,
    pub(crate) lowest_frequency: Option<f64>,
    pub(crate) outcome: StepOutcome,
    pub(crate) work: f64,
    pub(crate) dissipated: f64,
    pub(crate) friction: f64,
    pub(crate) plastic: f64,
    pub(crate) taut: Option<Infeasibility>,
}

impl Default for StepTotals<'_> {
    fn default() -> Self {
        Self {
            substeps: 0,
            rejected: 0,
            effort: SolverEffort::default(),
            residual: 0.0,
            error: None,
            lowest_frequency: None,
            outcome: StepOutcome::Newton,
            work: 0.0,
            dissipated: 0.0,
            friction: 0.0,
            plastic: 0.0,
            taut: None,
        }
    }
}

/// The error of an iteration of a step of `h` seconds at time `t` that did not converge.
pub(crate) fn not_converged(
    t: f64,
    h: f64,
    effort: &SolverEffort<'_>,
    reason: Reason,
    residual: f64,
    strain: f64,
) -> StepError {
    StepError::NotConverged {
        t,
        h,
        iterations: effort.iterations,
        residual,
        strain,
        reason,
    }
}
