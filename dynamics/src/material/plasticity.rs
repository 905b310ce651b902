//! Bending that stays: sections that yield under bending moments.

use crate::options::OptionsError;
use nalgebra::{SMatrix, SVector};
use serde::{Deserialize, Serialize};

/// When a section yields in bending, and how it hardens: rate-independent plasticity with linear kinematic
/// hardening (Prager).
///
/// The curvature `k` of a section (of a crease its fold angle) is the sum of an elastic part, which gives the moment
/// `M = D (k - p)`, and a plastic part `p`, which stays when the moment goes. The section is elastic as long as
///
/// ```text
/// |M - H p| <= M_y,
/// ```
///
/// `D` the rigidity, `M_y` the [moment](Yield::moment) and `H` the [hardening](Yield::hardening). Beyond that `p`
/// follows, and the moment grows with the slope `D H / (D + H)`. A section that was flat at first and is bent to
/// `k > M_y / D` springs back to
///
/// ```text
/// p = (D k - M_y) / (D + H),
/// ```
///
/// which is `k - M_y / D` without hardening. What the section has yielded to one side makes it yield sooner to the
/// other (Bauschinger's effect): from `M` backwards it is elastic over the range `2 M_y`.
///
/// A moment of three components, that of a plate, is measured by the norm of the 2 x 2 matrix, `|M|^2 = M_11^2 + 2
/// M_12^2 + M_22^2`, the norm of the elastic energy. A sheet bends in one direction at a place, where this is the
/// moment itself, as is von Mises' plane-stress norm; where it was bent in two directions in turn, von Mises' norm
/// is another one, 0.7 to 1.2 times as large.
///
/// (J. C. Simo and T. J. R. Hughes, *Computational Inelasticity*, Springer 1998, sections 1.4 and 3.3.)
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Yield {
    /// The moment `M_y` at which the section yields: newton metres for a spring, newton metres per metre of width
    /// for a sheet. A sheet of thickness `h` whose material yields at the stress `s` begins to yield at `s h^2 / 6`,
    /// and has yielded in the whole of its section at `s h^2 / 4`.
    pub moment: f64,
    /// The hardening `H`, what `M_y` is shifted by per plastic curvature: newton metres per radian for a spring,
    /// newton metres for a sheet. Zero for a section that yields without hardening.
    pub hardening: f64,
}

/// What a section does to a deformation.
#[derive(Clone, Copy, Debug)]
pub(super) struct Flow<const N: usize> {
    /// Growth of the plastic part.
    pub(super) step: SVector<f64, N>,
    /// Derivative of `step` by the deformation: symmetric, between zero and the unit matrix.
    pub(super) slope: SMatrix<f64, N, N>,
}

impl Yield {
    /// Without hardening.
    pub const fn perfect(moment: f64) -> Self {
        Self {
            moment,
            hardening: 0.0,
        }
    }

    /// Checks the numbers; the ranges are far beyond those of all sheets.
    ///
    /// # Errors
    /// [`OptionsError`] naming the number that makes no sense.
    pub fn validate(&self) -> Result<(), OptionsError> {
        OptionsError::check_range("moment", self.moment, 1e-18, 1e18)?;
        OptionsError::check_range("hardening", self.hardening, 0.0, 1e18)
    }

    /// The plastic part after a step of time, from the elastic part `e` (of a section with stiffness `k`) that there
    /// is if nothing yields in the step, and the plastic part `p` before: it grows by
    ///
    /// ```text
    /// argmin_d  k/2 |e - d|^2 + H/2 |p + d|^2 + M_y |d|,
    /// ```
    ///
    /// the minimum being the incremental energy of the section (M. Ortiz and L. Stainier, "The variational
    /// formulation of viscoplastic constitutive updates", Comput. Methods Appl. Mech. Eng. 171, 1999). Of `e` it is
    /// convex and has a continuous gradient `k (e - d)`, the moment, and the Hessian `k (1 - slope)`.
    pub(super) fn flow<const N: usize>(
        &self,
        k: f64,
        e: SVector<f64, N>,
        p: SVector<f64, N>,
    ) -> Flow<N> {
        let drive = k * e - self.hardening * p;
        let size = drive.norm();
        if size <= self.moment {
            return Flow {
                step: SVector::zeros(),
                slope: SMatrix::zeros(),
            };
        }
        let direction = drive / size;
        let along = direction * direction.transpose();
        let turned = (size - self.moment) / size;
        Flow {
            step: direction * ((size - self.moment) / (k + self.hardening)),
            slope: (along + turned * (SMatrix::identity() - along)) * (k / (k + self.hardening)),
        }
    }

    /// `H/2 |p + d|^2 + M_y |d|`: what hardening stores, and what the growth `d` of the plastic part `p` dissipates.
    pub(super) fn energy<const N: usize>(&self, p: SVector<f64, N>, d: SVector<f64, N>) -> f64 {
        0.5 * self.hardening * (p + d).norm_squared() + self.moment * d.norm()
    }
}

#[cfg(test)]
mod tests;
