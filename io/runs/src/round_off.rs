//! What of the numbers of a summary is no more than round-off.

use super::Summary;

/// What is this share of the largest value of a quantity is round-off.
const SHARE: f64 = 64.0 * f64::EPSILON;

/// A value, or 0 where its size is not beyond that of round-off.
pub(super) fn beyond(value: f64, round_off: f64) -> f64 {
    match value.abs() <= round_off {
        true => 0.0,
        false => value,
    }
}

impl Summary {
    /// The error of the energy balance at the end, joules; 0 where it is no more than round-off.
    pub(super) fn drift_beyond_round_off(&self) -> f64 {
        let energy = &self.energy;
        let round_off = energy.round_off.max(SHARE * energy.largest_exchange);
        beyond(self.ending.energy_drift, round_off)
    }

    /// The largest speed at the end, m/s; 0 where it is no more than round-off of the way over a step.
    pub(super) fn speed_beyond_round_off(&self) -> f64 {
        let steps = self.steps.max(1) as f64;
        let of_step = SHARE * self.largest_displacement * steps;
        let speed = self.ending.largest_speed;
        match self.ending.t > 0.0 {
            true => beyond(speed, of_step / self.ending.t),
            false => speed,
        }
    }

    /// The size up to which a component of a force at the end is round-off, newtons.
    pub(super) fn round_off_of_forces(&self) -> f64 {
        let ending = &self.ending;
        let forces = [&ending.supports, &ending.obstacles, &ending.bodies];
        let components = forces.into_iter().flatten().flatten();
        SHARE * components.fold(0.0, |largest: f64, c| largest.max(c.abs()))
    }
}

#[cfg(test)]
mod tests {
    use super::{SHARE, beyond};

    #[test]
    fn what_is_no_more_than_round_off_is_zero() {
        let round_off = SHARE * 2.5;
        assert_eq!(beyond(1.247e-27, round_off), 0.0);
        assert_eq!(beyond(-2.5 * f64::EPSILON, round_off), 0.0);
        assert_eq!(beyond(1e-12, round_off), 1e-12);
        assert_eq!(beyond(-1e-30, 0.0), -1e-30);
    }
}
