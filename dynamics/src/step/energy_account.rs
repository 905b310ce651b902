//! Bound of the energy gained by damped methods.

use crate::{SheetModel, State};
use isosheet_linalg::norm_inf;
use isosheet_model::StepError;
use isosheet_model::term::Exchange;
use serde::{Deserialize, Serialize};

/// Part of the energy that friction takes by which it may differ from that by the normal forces at the end of
/// the step. Sheets that are crumpled differ by up to a fifth where they jam for a moment, and go on; where
/// it is more than a half, most of the friction is not that of the step.
const UNSETTLED: f64 = 0.5;

/// Part of the kinetic energy that a damped method may gain in one step. Compressed rods that snap through
/// can feed implicit methods; shorter steps do not let them.
const GAIN: f64 = 0.1;
/// Part of the largest kinetic energy so far that all steps together may gain: second-order methods err to
/// either side by about that at the longest steps that resolve a motion.
const NET_GAIN: f64 = 0.02;
/// Part of the work of bodies, supports and air that the trapezoidal rule may err by: its error is of the
/// size of the difference between the forces at both ends of a step.
const DRIVEN: f64 = 0.5;
/// Relative displacement that the tolerance of the lengths, 1e-12 unless another is asked for, leaves open
/// over ten rods in a row: over a short step it looks like a velocity, and forces do work over it.
const LENGTH_NOISE: f64 = 1e-11;
/// What forces of rods up to a thousand times the weight do over the tolerance of the lengths, relative to
/// the energies and the work.
const ENERGY_NOISE: f64 = 1e-9;

/// Energy gains of the steps of a damped method, without the work of forces, bodies and supports.
#[derive(Debug, Clone, Copy, Default, PartialEq, Serialize, Deserialize)]
pub(crate) struct EnergyAccount {
    /// Sum of the gains, joules.
    net: f64,
    /// Sum of the uncertainties, joules.
    unknown: f64,
    /// Largest kinetic energy, joules.
    kinetic: f64,
}

impl EnergyAccount {
    /// The account after a step between two states, with the potential energies of both at the end of the
    /// step (joules) and the sum of the magnitudes of the components of the conservative forces there
    /// (newtons).
    ///
    /// # Errors
    /// [`StepError::EnergyGain`], [`StepError::Friction`], [`StepError::StiffForce`],
    /// [`StepError::NonFiniteEnergy`].
    pub(crate) fn after(
        &self,
        model: &SheetModel,
        [before, after]: [&State; 2],
        potential: [f64; 2],
        force_sum: impl FnOnce() -> f64,
        exchange: &Exchange,
    ) -> Result<Self, StepError> {
        let kinetic = [&before.v, &after.v].map(|v| model.kinetic_energy(v));
        let drives = exchange.driven_size;
        let gain = kinetic[1] + potential[1] + exchange.stored
            - kinetic[0]
            - potential[0]
            - exchange.work
            - exchange.driven;
        if !gain.is_finite() {
            // A comparison with a bound would let it pass, and spoil the account for good.
            return Err(StepError::NonFiniteEnergy {
                quantity: "the energy gained in the step",
                value: gain,
                t: after.t,
            });
        }
        let size = norm_inf(&after.x);
        let noise = LENGTH_NOISE * size / (after.t - before.t);
        let energies = kinetic[0] + potential[0].abs() + potential[1].abs();
        let mut round_off = ENERGY_NOISE * (energies + exchange.work.abs() + drives)
            + model.mass().total() * noise * noise
            + exchange.length_slack;
        let unsettled = (exchange.friction - exchange.settled_friction).abs();
        let settled = UNSETTLED * exchange.friction.max(exchange.settled_friction);
        if unsettled > settled.max(GAIN * self.kinetic.max(kinetic[0]).max(kinetic[1])) + round_off
        {
            return Err(StepError::Friction {
                t: before.t,
                h: after.t - before.t,
                lost: exchange.friction,
                settled: exchange.settled_friction,
            });
        }
        let most = kinetic[0].max(kinetic[1]);
        if exchange.misjudged > GAIN * most + round_off {
            return Err(StepError::StiffForce {
                t: before.t,
                h: after.t - before.t,
                misjudged: exchange.misjudged,
                kinetic: most,
            });
        }
        let share = most + DRIVEN * drives / GAIN;
        let net = self.net + gain;
        let largest = self.kinetic.max(kinetic[0]);
        let unknown = |round_off| self.unknown + round_off + DRIVEN * drives;
        let is_too_much = |round_off| {
            gain > GAIN * share + round_off
                || gain > round_off && net > NET_GAIN * largest.max(kinetic[1]) + unknown(round_off)
        };
        if is_too_much(round_off) {
            // Forces far above the weight do work over the noise of positions, which energies near zero do
            // not show.
            round_off += LENGTH_NOISE * size * force_sum();
            if is_too_much(round_off) {
                return Err(StepError::EnergyGain {
                    t: before.t,
                    h: after.t - before.t,
                    gain,
                    kinetic: kinetic[1],
                });
            }
        }
        Ok(Self {
            net,
            unknown: unknown(round_off),
            kinetic: largest,
        })
    }

    /// Subtracts the energy dissipated by velocity damping, joules. (A two-step method with undamped history
    /// returns part of it.)
    pub(crate) fn spend(&mut self, dissipated: f64) {
        self.net -= dissipated;
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::At;
    use isosheet_mesh::{MassKind, generate};

    /// Flies through a cycle of speeds, metres per second; the first step that is refused.
    fn refused(speeds: &[f64], dissipated: f64, driven: f64) -> Option<usize> {
        let sheet = generate::isotropic_square(0, 1.0).unwrap();
        let model = SheetModel::new(&sheet, 1.0, MassKind::Lumped).unwrap();
        let state = |k: usize| State {
            t: k as f64,
            x: sheet.positions().to_vec(),
            v: vec![speeds[k]; sheet.positions().len()],
        };
        let mut account = EnergyAccount::default();
        let exchange = Exchange::driven(driven);
        (1..speeds.len()).find(|&k| {
            let after = account.after(
                &model,
                [&state(k - 1), &state(k)],
                [0.0; 2],
                || 0.0,
                &exchange,
            );
            account = *after.as_ref().unwrap_or(&account);
            account.spend(dissipated);
            after.is_err()
        })
    }

    #[test]
    fn gains_add_up() {
        // The kinetic energy is 3/2 v^2: gains of 1 % each.
        let gains = |n: i32| (0..n).map(|k| 1.01_f64.powf(0.5 * f64::from(k)));
        let up: Vec<f64> = gains(9).collect();
        assert_eq!(refused(&up, 0.0, 0.0), Some(3));
        // A loss before makes up for them, and so does what damping takes out.
        let down: Vec<f64> = [1.06].into_iter().chain(gains(9)).collect();
        assert_eq!(refused(&down, 0.0, 0.0), None);
        assert_eq!(refused(&up, 0.02, 0.0), None);
        // One step may gain more than all of them, but not more than a tenth.
        assert_eq!(refused(&[1.2, 1.0, 1.04], 0.0, 0.0), None);
        assert_eq!(refused(&[1.2, 1.0, 1.06], 0.0, 0.0), Some(2));
    }

    #[test]
    fn work_of_bodies_counts_roughly() {
        assert_eq!(refused(&[1.0, 1.1], 0.0, 0.2), None);
        assert_eq!(refused(&[1.0, 1.1], 0.0, 0.0), Some(1));
    }

    /// Pulls the first vertex along x, its energy zero at `origin`.
    #[derive(Debug)]
    struct Pull {
        force: f64,
        origin: f64,
    }

    impl crate::Potential for Pull {
        fn energy(&self, at: At<'_>) -> f64 {
            let At { x, .. } = at;
            -self.force * (x[0] - self.origin)
        }

        fn add_gradient(&self, _at: At<'_>, gradient: &mut [f64]) {
            gradient[0] -= self.force;
        }
    }

    #[test]
    fn a_strong_force_over_the_noise_of_positions_is_no_gain() {
        let sheet = generate::isotropic_square(0, 1.0).unwrap();
        let model = SheetModel::new(&sheet, 1.0, MassKind::Lumped).unwrap();
        let origin = sheet.positions()[0];
        let model = model.with_potential(Pull { force: 1e6, origin });
        let start = State::at_rest(sheet.positions().to_vec());
        let enter = |back: f64| {
            let mut end = start.clone();
            (end.t, end.x[0]) = (1e-3, origin - back);
            let potential = [&start, &end].map(|s| model.potential_energy(s.t, &s.x));
            EnergyAccount::default().after(
                &model,
                [&start, &end],
                potential,
                || 1e6,
                &Exchange::default(),
            )
        };
        assert!(enter(1e-12).is_ok());
        assert!(enter(1e-9).is_err());
    }
}
