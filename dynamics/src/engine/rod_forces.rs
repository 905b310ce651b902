//! Forces of the rods.

use crate::linear::rod_least_squares::RodLeastSquares;
use crate::step::history::Multipliers;
use crate::{Method, SheetModel};
use isosheet_model::PINNED;

impl Method {
    /// Force density (tension over length, N/m) of a unit multiplier: BDF2 and implicit Euler have
    /// multipliers `h^2` times the density, with the effective step `h`; energy-momentum the impulse over the
    /// step, RATTLE that over its first half, both compressive.
    fn density_of_multipliers(&self, h: f64) -> f64 {
        match self {
            Self::ImplicitEuler(_) | Self::Bdf2(_) | Self::Equilibrium(_) => 1.0 / (h * h),
            Self::EnergyMomentum(_) => -1.0 / h,
            Self::Rattle(_) | Self::RattleComposition(_) => -2.0 / h,
        }
    }
}

/// Smallest singular value of the rigidity matrix of unit rods, about a fold angle in radians, that rod
/// forces take part in: lengths exact to 1e-12 give fold angles to 1e-6, and forces across flatter folds are
/// noise over the angle. In a tablecloth of 2 N on a box the largest force is 300 N without this bound, and
/// 13, 1.7 and 1.5 N with 1e-3, 5e-3 and 1e-2.
const FLATTEST_FOLD: f64 = 5e-3;

/// Rod forces at positions `x`, newtons, see [`Simulation::rod_forces`](crate::Simulation::rod_forces).
pub(crate) fn rod_forces(
    model: &SheetModel,
    method: &Method,
    multipliers: &Multipliers,
    x: &[f64],
) -> Option<Vec<f64>> {
    if !model.has_rods_in_sheets() {
        return None;
    }
    let rods = model.rods();
    let mut all = vec![0.0; model.edges().len()];
    if multipliers.rods.is_empty() || multipliers.step == 0.0 {
        return Some(all);
    }
    let density = method.density_of_multipliers(multipliers.step);
    let edges = rods.edges().iter();
    let known = edges.zip(rods.lengths()).zip(&multipliers.rods);
    let force = |((ends, length), multiplier): ((&[usize; 2], &f64), &f64)| {
        if ends.iter().all(|&v| model.free_index()[v] == PINNED) {
            return 0.0;
        }
        density * multiplier * length
    };
    let forces: Vec<f64> = known.map(force).collect();
    // Methods that need independent rods have unique forces.
    let forces = match method.is_minimising() {
        true => least_forces(model, x, &forces).unwrap_or(forces),
        false => forces,
    };
    for (edge, force) in model.rod_edges().iter().zip(forces) {
        all[edge.index()] = force;
    }
    Some(all)
}

/// The forces of least squares that load the free vertices as the given ones do, without singular directions
/// below [`FLATTEST_FOLD`]: `F = A (A^T A)^+ A^T F0` with the rigidity matrix `A` of unit rods. `None` if
/// memory runs out, or if the masses of bodies differ too much for the factorisation.
fn least_forces(model: &SheetModel, x: &[f64], given: &[f64]) -> Option<Vec<f64>> {
    let mut left = given.to_vec();
    RodLeastSquares::new(model, x, FLATTEST_FOLD)?.reduce(&mut left);
    Some(
        given
            .iter()
            .zip(left)
            .map(|(given, left)| given - left)
            .collect(),
    )
}

#[cfg(test)]
mod tests;
