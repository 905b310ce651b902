//! What a simulation tells about its steps while it takes them.

use crate::report::reason::Reason;
use serde::Serialize;

/// A line of a trace, see `Simulation::with_trace`.
///
/// Times are in seconds, gaps in metres; strains, residuals and parts of displacements are relative.
#[derive(Debug, Clone, PartialEq, Serialize)]
#[serde(tag = "event", rename_all = "snake_case")]
#[non_exhaustive]
pub enum TraceEvent {
    /// A phase of the minimisation begins.
    Phase {
        /// Start of the sub-step.
        t: f64,
        /// Length of the sub-step.
        h: f64,
        /// Its name.
        phase: &'static str,
    },
    /// An iteration of Newton's method.
    Iteration {
        /// Number in the phase, from 1.
        iteration: usize,
        /// Round of the method of multipliers, from 0.
        round: usize,
        /// Decrease that the search direction promises, relative to the inertia term (root of the energy
        /// ratio); zero where it is round-off.
        residual: f64,
        /// Largest violation of the equations of isometry after the iteration.
        strain: f64,
        /// Part of the search direction that was taken.
        length: f64,
        /// What cut it.
        cut: Cut,
        /// Whether the Hessian was positive definite as it is.
        is_definite: bool,
        /// Number of active contacts; zero without contact.
        contacts: usize,
    },
    /// The iterate left a saddle, or friction was lagged anew, where an iteration had converged.
    GoesOn {
        /// Which of the two.
        because: Continuation,
    },
    /// A phase ended without a minimum.
    Failed {
        /// Its name.
        phase: &'static str,
        /// Why.
        reason: Reason,
        /// Largest violation of the equations of isometry.
        strain: f64,
    },
    /// A sub-step was refused.
    Refused {
        /// Start of the sub-step.
        t: f64,
        /// Length of the sub-step.
        h: f64,
        /// The error, in words.
        error: String,
        /// What follows.
        decision: &'static str,
    },
    /// A sub-step was accepted.
    Accepted {
        /// End of the sub-step.
        t: f64,
        /// Length of the sub-step.
        h: f64,
        /// Factorisations since the last accepted sub-step.
        factorisations: usize,
    },
}

/// What cut a search direction.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum Cut {
    /// Nothing.
    Nothing,
    /// Contact.
    Contact,
    /// The limit of the strain of an elastic sheet.
    StrainLimit,
    /// A barrier of another term, by its name.
    Barrier(&'static str),
    /// The merit function.
    Merit,
    /// Bodies or pins were on their way: the iteration moved them.
    Driven,
    /// The direction would have raised the potential to mend the lengths, which were restored instead.
    Lengths,
}

/// Why an iteration goes on from a point where it has converged.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum Continuation {
    /// The point was a saddle.
    Saddle,
    /// Friction belonged to other normal forces.
    Friction,
    /// The lengths are not exact enough for a restoration: another round of the method of multipliers.
    Round,
}
