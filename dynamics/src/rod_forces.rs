//! Forces of the rods.

use crate::history::Multipliers;
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

/// The forces of the rods of which these are the multipliers, newtons, see
/// [`Simulation::rod_forces`](crate::Simulation::rod_forces).
pub(crate) fn rod_forces(
    model: &SheetModel,
    method: &Method,
    multipliers: &Multipliers,
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
    Some(known.map(force).collect())
}

#[cfg(test)]
mod tests;
