//! Runs beside a run: the same scene with another value of a number.

use isosheet_dynamics::Simulation;
use isosheet_materials::{Difference, Potential};

/// The simulations with another value of a number.
pub(crate) struct Neighbours {
    pub(crate) number: usize,
    /// With a larger and with a smaller value.
    pub(crate) simulations: [Simulation; 2],
    /// Between the two values.
    pub(crate) distance: f64,
    /// Which parts of each potential of the two differ.
    pub(crate) differences: Vec<Difference>,
    /// Which parts of each one may remember something else.
    pub(crate) of_memories: Vec<Difference>,
}

impl Neighbours {
    /// Of the simulations with a larger and a smaller value of a number.
    pub(crate) fn new(number: usize, simulations: [Simulation; 2], distance: f64) -> Self {
        let [up, down] = simulations.each_ref().map(Simulation::model);
        let pairs = || up.potentials().zip(down.potentials());
        let of_memory = |(a, b): (&dyn Potential, &dyn Potential)| match a.remembering() {
            Some(own) => own.memory_difference(b),
            None => Difference::Nothing,
        };
        Self {
            number,
            differences: pairs().map(|(a, b)| a.difference(b)).collect(),
            of_memories: pairs().map(of_memory).collect(),
            simulations,
            distance,
        }
    }

    /// By which part the lengths at rest of the elastic sheets of the two differ at a time.
    pub(crate) fn rest_difference(&self, t: f64) -> f64 {
        let [up, down] = self.simulations.each_ref().map(Simulation::model);
        let sheets = up.elastic_sheet().zip(down.elastic_sheet());
        let difference = sheets.and_then(|(up, down)| up.rest_difference(down, t));
        difference.unwrap_or(0.0)
    }
}
