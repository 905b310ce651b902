//! What a run says of its energies.

use isosheet_dynamics::{Simulation, State, StepReport};
use serde::{Deserialize, Serialize};
use std::f64::consts::SQRT_2;

/// The extremes of the energies in a run, the start included, and the largest errors of their balance.
///
/// The error of the balance after a step is energy less work of supports and forces, plus what damping,
/// friction and yielding took, minus the energy at the start.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct EnergySummary {
    /// Largest kinetic energy, joules.
    pub largest_kinetic: f64,
    /// Potential energy at the start, joules.
    pub start_potential: f64,
    /// Least potential energy, joules.
    pub least_potential: f64,
    /// Largest size of an error, joules.
    pub largest_error: f64,
    /// Largest error by which energy was gained, joules; 0 if none ever was.
    pub largest_gain: f64,
    /// Largest energy that was exchanged: kinetic energy, change of the potential energy, work, or what
    /// damping, friction and yielding took, joules.
    pub largest_exchange: f64,
    /// Largest energy that the round-off of the positions looks like, joules: the change of the potential
    /// energy at the start by changes of the last bit, with the kinetic energy of such changes over a step.
    pub round_off: f64,
    /// `largest_error` over `largest_kinetic`; none if the sheet never moved.
    pub relative_error: Option<f64>,
    /// `largest_gain` over `largest_kinetic`; none if the sheet never moved.
    pub relative_gain: Option<f64>,
}

impl EnergySummary {
    /// Of a run at its start.
    pub(crate) fn of_start(simulation: &Simulation) -> Self {
        let (model, State { t, x, v }) = (simulation.model(), simulation.state());
        let kinetic = model.kinetic_energy(v);
        let potential = simulation.energy() - kinetic;
        let bit = f64::EPSILON * x.iter().fold(0.0, |size: f64, c| size.max(c.abs()));
        // Multiples of an irrational number have no period, as round-off has none.
        let change = |k: usize| bit * (2.0 * (k as f64 * SQRT_2).fract() - 1.0);
        let changed: Vec<f64> = x.iter().enumerate().map(|(k, c)| c + change(k)).collect();
        let round_off = model.potential_energy(*t, &changed) - model.potential_energy(*t, x);
        let mut start = Self {
            largest_kinetic: kinetic,
            least_potential: potential,
            start_potential: potential,
            largest_exchange: kinetic,
            round_off: round_off.abs(),
            ..Self::default()
        };
        start.compare();
        start
    }

    /// Takes in a step of a sheet of a mass (kilograms) whose coordinates are of a size (metres).
    pub(crate) fn observe(&mut self, report: &StepReport, mass: f64, size: f64) {
        let speed = f64::EPSILON * size / report.h;
        self.round_off = self.round_off.max(mass * speed * speed);
        self.largest_kinetic = self.largest_kinetic.max(report.kinetic);
        self.least_potential = self.least_potential.min(report.potential);
        self.largest_error = self.largest_error.max(report.energy_drift.abs());
        self.largest_gain = self.largest_gain.max(report.energy_drift);
        let exchanged = [
            report.kinetic,
            report.potential - self.start_potential,
            report.work,
            report.dissipated,
            report.friction,
            report.plastic,
        ];
        let sizes = exchanged.into_iter().map(f64::abs);
        self.largest_exchange = sizes.fold(self.largest_exchange, f64::max);
        self.compare();
    }

    /// Compares the errors with the largest kinetic energy.
    fn compare(&mut self) {
        let relative = |error: f64| {
            let moved = self.largest_kinetic > 0.0;
            moved.then(|| error / self.largest_kinetic)
        };
        self.relative_error = relative(self.largest_error);
        self.relative_gain = relative(self.largest_gain);
    }
}
