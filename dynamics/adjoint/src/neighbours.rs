//! Runs beside a run: the same scene with another value of a number.

use isosheet_dynamics::Simulation;

/// The simulations with another value of a number.
pub(crate) struct Neighbours {
    pub(crate) number: usize,
    /// With a larger and with a smaller value.
    pub(crate) simulations: [Simulation; 2],
    /// Between the two values.
    pub(crate) distance: f64,
    /// Of each potential of the two whether it is the same in both.
    pub(crate) same: Vec<bool>,
    /// Of each one whether it remembers the same in both.
    pub(crate) remembers_the_same: Vec<bool>,
}

impl Neighbours {
    /// Of the simulations with a larger and a smaller value of a number.
    pub(crate) fn new(number: usize, simulations: [Simulation; 2], distance: f64) -> Self {
        let [up, down] = simulations.each_ref().map(Simulation::model);
        let pairs = || up.potentials().zip(down.potentials());
        let same: Vec<bool> = pairs().map(|(a, b)| a.is_same(b)).collect();
        let remembers = pairs().zip(&same).map(|((a, b), same)| {
            let own = a.remembering();
            *same && own.is_none_or(|own| own.remembers_the_same(b))
        });
        let remembers_the_same = remembers.collect();
        Self {
            number,
            simulations,
            distance,
            same,
            remembers_the_same,
        }
    }
}
