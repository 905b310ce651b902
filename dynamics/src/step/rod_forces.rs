//! Forces of the rods.

use crate::linear::rod_least_squares::RodLeastSquares;
use crate::step::history::Multipliers;
use crate::{Isometry, Method, SheetModel};

impl Method {
    /// Whether the method solves for the forces of rigid rods: all but projection, which corrects positions
    /// and velocities and has no multipliers that would balance the other forces.
    pub fn solves_for_rod_forces(&self) -> bool {
        !matches!(self, Self::Projection(_))
    }

    /// Force densities (force over length, tension positive, N/m) of multipliers with the value 1.
    ///
    /// Minimising methods have `h^2` times the density as multipliers, with the effective step `h`.
    /// Conservative ones have impulses that push the ends of a rod apart: energy-momentum over the whole
    /// step, RATTLE at each of its ends over half of it (the one at the start is kept).
    fn density_of_multipliers(&self, h: f64) -> f64 {
        match self {
            Self::ImplicitEuler(_) | Self::Bdf2(_) => 1.0 / (h * h),
            Self::EnergyMomentum(_) => -1.0 / h,
            Self::Rattle(_) | Self::RattleComposition(_) => -2.0 / h,
            Self::Projection(_) => 0.0,
        }
    }
}

/// Singular value of the rigidity matrix of unit rods, about the angle of a fold in radians, below which forces
/// are left out of the balance that the least forces keep. Lengths that are exact to 1e-12 determine fold angles
/// to 1e-6, and what a flatter fold carries is noise times the inverse of its angle. The largest force in a
/// tablecloth of 2 N that rests on a box is 300 N, and while it falls 2e4 N; with 1e-3, 5e-3 and 1e-2 here it is
/// 13, 1.7 and 1.5 N.
const FLATTEST_FOLD: f64 = 5e-3;

/// The forces of the rods of which these are the multipliers at positions `x`, newtons, see
/// [`Simulation::rod_forces`](crate::Simulation::rod_forces).
pub(crate) fn rod_forces(
    model: &SheetModel,
    method: &Method,
    multipliers: &Multipliers,
    x: &[f64],
) -> Option<Vec<f64>> {
    if model.isometry() != Isometry::Rods || !method.solves_for_rod_forces() {
        return None;
    }
    let rods = model.rods();
    if multipliers.rods.is_empty() || multipliers.step == 0.0 {
        return Some(vec![0.0; rods.len()]);
    }
    let density = method.density_of_multipliers(multipliers.step);
    let edges = model.topology().edges().iter();
    let known = edges.zip(rods.lengths()).zip(&multipliers.rods);
    let force = |((ends, length), multiplier): ((&[_; 2], &f64), &f64)| {
        if ends.iter().all(|&v| model.is_pinned(v)) {
            return 0.0;
        }
        density * multiplier * length
    };
    let forces: Vec<f64> = known.map(force).collect();
    // Methods that need independent rods have unique forces.
    match method.is_minimising() {
        true => least_forces(model, x, &forces),
        false => Some(forces),
    }
}

/// The least forces, in the sum of their squares, that load the free vertices as the given ones do, but for
/// directions in which rods depend on each other nearly ([`FLATTEST_FOLD`]).
///
/// With the rigidity matrix `A` of unit rods these are `F = A (A^T A)^+ A^T F0`, see [`RodLeastSquares`]. Nothing if
/// the memory for the matrix runs out.
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
