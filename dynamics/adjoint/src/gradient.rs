//! Gradients.

use isosheet_dynamics::sensitivity::OfState;

/// The gradient of a loss of a run.
#[derive(Debug, Clone)]
pub struct Gradient {
    /// The loss.
    pub value: f64,
    /// Its derivatives by the numbers of the scene, in their order.
    pub of_numbers: Vec<f64>,
    /// Its derivatives by positions (per metre) and velocities (seconds per metre) at the start, `3V` each,
    /// the numbers being what they are: of sheets of rods in directions that keep the lengths. Pins are among
    /// them; velocities of pins in motion follow from their motions, and have zeros.
    pub of_start: OfState,
    /// What counted as constant since it has no derivative; nothing unless the options say so.
    pub passed_by: Vec<PassedBy>,
    /// What it took.
    pub effort: Effort,
}

/// What counted as constant in a step.
#[derive(Debug, Clone, PartialEq)]
pub struct PassedBy {
    /// Time at the end of the step, seconds.
    pub t: f64,
    /// What, as a clause.
    pub what: String,
}

/// What a gradient took.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Effort {
    /// Sub-steps.
    pub substeps: usize,
    /// Linear systems.
    pub systems: usize,
    /// Factorisations.
    pub factorisations: usize,
    /// Iterations of all linear systems.
    pub iterations: usize,
    /// The largest residual that was left of one, relative to its right-hand side.
    pub residual: f64,
}
