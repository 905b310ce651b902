//! What damped methods may gain in energy.

use crate::report::{Accepted, StepError};
use crate::{SheetModel, State};
use isosheet_coords::linalg::norm_inf;

/// Share of the kinetic energy that a damped method may gain in one step. Compressed rods that snap
/// through can feed implicit methods; shorter steps, and steps of implicit Euler, do not let them.
const MAX_GAIN: f64 = 0.1;

/// Share of the largest kinetic energy so far that all steps together may gain: second-order methods err to either side
/// by about that at the longest steps that resolve a motion.
const MAX_NET_GAIN: f64 = 0.02;

/// Relative displacement that the tolerance of the lengths leaves open: over a short step it looks
/// like a velocity.
const POSITION_NOISE: f64 = 1e-11;

/// The work of bodies, pins and moving constraints is known to the accuracy of the trapezoidal rule only.
const DRIVES: f64 = 5.0;

/// Gains and losses of the steps of a damped method, which should but lose: numerical errors alone, without the work of
/// forces, bodies and supports.
#[derive(Debug, Clone, Default)]
pub(crate) struct EnergyAccount {
    /// Sum of all gains, losses being negative, joules.
    net: f64,
    /// Sum of what steps could not know of, joules.
    unknown: f64,
    /// Largest kinetic energy so far, joules.
    kinetic: f64,
    force: Vec<f64>,
}

impl EnergyAccount {
    /// Takes a step into account.
    ///
    /// # Errors
    /// [`StepError::EnergyGain`] if it gains too much; then it is not taken into account.
    pub(crate) fn enter(
        &mut self,
        model: &SheetModel,
        before: &State,
        after: &State,
        accepted: &Accepted,
    ) -> Result<(), StepError> {
        let mut force = std::mem::take(&mut self.force);
        let (t0, t1) = (
            model.kinetic_energy(&before.v),
            model.kinetic_energy(&after.v),
        );
        let (v0, v1) = (
            model.potential_energy(after.t, &before.x),
            model.potential_energy(after.t, &after.x),
        );
        let contact = &accepted.contact;
        let drives = contact.bodies.abs() + accepted.driven.abs();
        let driven = accepted.work.abs() + drives;
        let gain =
            t1 + v1 + contact.stored - t0 - v0 - accepted.work - accepted.driven - contact.bodies;
        let noise = POSITION_NOISE * norm_inf(&after.x) / (after.t - before.t);
        let mut round_off = 1e-9 * (t0 + v0.abs() + v1.abs() + driven)
            + model.mass().total() * noise * noise
            + contact.length_slack;
        let share = t0.max(t1) + DRIVES * drives;
        let net = self.net + gain;
        let kinetic = self.kinetic.max(t0);
        let unknown = |round_off| self.unknown + round_off + MAX_GAIN * DRIVES * drives;
        let is_too_much = |round_off| {
            gain > MAX_GAIN * share + round_off
                || gain > round_off && net > MAX_NET_GAIN * kinetic.max(t1) + unknown(round_off)
        };
        let mut refused = is_too_much(round_off);
        if refused {
            // Forces far above the weight do work over the noise of positions, which energies near zero do not show.
            round_off += POSITION_NOISE * norm_inf(&after.x) * force_sum(model, after, &mut force);
            refused = is_too_much(round_off);
        }
        let unknown = unknown(round_off);
        self.force = force;
        if refused {
            return Err(StepError::EnergyGain {
                t: before.t,
                h: after.t - before.t,
                gain,
                kinetic: t1,
            });
        }
        (self.net, self.unknown, self.kinetic) = (net, unknown, kinetic);
        Ok(())
    }

    /// Takes energy out, joules: what velocity damping dissipates. (A two-step method that remembers the
    /// undamped past gives part of it back.)
    pub(crate) fn spend(&mut self, dissipated: f64) {
        self.net -= dissipated;
    }
}

/// Sum of the magnitudes of the components of the conservative forces, newtons.
fn force_sum(model: &SheetModel, state: &State, force: &mut Vec<f64>) -> f64 {
    force.resize(state.x.len(), 0.0);
    model.potential_force(state.t, &state.x, force);
    force.iter().map(|f| f.abs()).sum()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::contact::ContactWork;
    use crate::report::Path;
    use isosheet_mesh::{MassKind, generate};

    /// Flies through a cycle of speeds, metres per second; the first step that is refused.
    fn refused(speeds: &[f64], dissipated: f64, bodies: f64) -> Option<usize> {
        let sheet = generate::isotropic_square(0, 1.0).unwrap();
        let model = SheetModel::new(&sheet, 1.0, MassKind::Lumped).unwrap();
        let state = |k: usize| State {
            t: k as f64,
            x: sheet.positions().to_vec(),
            v: vec![speeds[k]; sheet.positions().len()],
        };
        let mut account = EnergyAccount::default();
        let accepted = Accepted {
            residual: 0.0,
            work: 0.0,
            driven: 0.0,
            path: Path::Newton,
            contact: ContactWork {
                bodies,
                ..Default::default()
            },
        };
        (1..speeds.len()).find(|&k| {
            let entered = account.enter(&model, &state(k - 1), &state(k), &accepted);
            account.spend(dissipated);
            entered.is_err()
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
        fn energy(&self, _t: f64, x: &[f64]) -> f64 {
            -self.force * (x[0] - self.origin)
        }

        fn add_gradient(&self, _t: f64, _x: &[f64], gradient: &mut [f64]) {
            gradient[0] -= self.force;
        }
    }

    #[test]
    fn a_strong_force_over_the_noise_of_positions_is_no_gain() {
        let sheet = generate::isotropic_square(0, 1.0).unwrap();
        let model = SheetModel::new(&sheet, 1.0, MassKind::Lumped).unwrap();
        let origin = sheet.positions()[0];
        let model = model.with_potential(Pull { force: 1e6, origin });
        let accepted = Accepted {
            residual: 0.0,
            work: 0.0,
            driven: 0.0,
            path: Path::Newton,
            contact: ContactWork::default(),
        };
        let start = State::at_rest(sheet.positions().to_vec());
        let enter = |back: f64| {
            let mut end = start.clone();
            (end.t, end.x[0]) = (1e-3, origin - back);
            EnergyAccount::default().enter(&model, &start, &end, &accepted)
        };
        assert!(enter(1e-12).is_ok());
        assert!(enter(1e-9).is_err());
    }
}
