//! Runs beside a run: the same scene with another value of a number.

use isosheet_dynamics::Simulation;

/// The simulations with another value of a number.
pub(crate) struct Neighbours {
    pub(crate) number: usize,
    /// With a larger and with a smaller value.
    pub(crate) simulations: [Simulation; 2],
    /// Between the two values.
    pub(crate) distance: f64,
}
