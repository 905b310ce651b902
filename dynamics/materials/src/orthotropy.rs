//! What the orthotropic laws of a sheet have in common, of its plane and of its bending.

use nalgebra::{Matrix3, SymmetricEigen};
use std::f64::consts::SQRT_2;

/// A symmetric 2 x 2 matrix `e`, with the components `e_1` along a direction of the material, `e_2` across it
/// and `e_12`, stores
///
/// ```text
/// 1/2 [ along e_1^2 + 2 coupling e_1 e_2 + across e_2^2 + 4 shear e_12^2 ].
/// ```
#[derive(Debug, Clone, Copy)]
pub(super) struct PrincipalLaw {
    pub(super) along: f64,
    pub(super) across: f64,
    pub(super) coupling: f64,
    pub(super) shear: f64,
}

/// The first of some stiffnesses that is not positive or not finite.
pub(super) fn first_unusable(stiffnesses: [f64; 3]) -> Option<f64> {
    let mut all = stiffnesses.into_iter();
    all.find(|stiffness| !(stiffness.is_finite() && *stiffness > 0.0))
}

impl PrincipalLaw {
    /// Whether the coupling leaves no matrix without resistance, the stiffnesses being positive. (A coupling
    /// that is not a number does.)
    pub(super) fn is_definite(&self) -> bool {
        self.coupling * self.coupling < self.along * self.across
    }

    /// The geometric mean of both directions.
    pub(super) fn mean(&self) -> f64 {
        (self.along * self.across).sqrt()
    }

    /// The law over a stiffness, by the components `(11, sqrt(2) 12, 22)`, the first axis along the
    /// direction.
    pub(super) fn over(&self, stiffness: f64) -> Matrix3<f64> {
        let all = [self.along, self.coupling, self.across, self.shear];
        let [along, coupling, across, shear] = all.map(|c| c / stiffness);
        Matrix3::new(
            along,
            0.0,
            coupling,
            0.0,
            2.0 * shear,
            0.0,
            coupling,
            0.0,
            across,
        )
    }

    /// The isotropic law of stiffness one that has a Poisson's ratio.
    pub(super) fn isotropic(poisson: f64) -> Self {
        Self {
            along: 1.0,
            across: 1.0,
            coupling: poisson,
            shear: 0.5 * (1.0 - poisson),
        }
    }
}

/// The components `(11, sqrt(2) 12, 22)` of a symmetric matrix along axes that are turned by an angle: an
/// orthogonal matrix.
pub(super) fn turn(angle: f64) -> Matrix3<f64> {
    let (s, c) = angle.sin_cos();
    Matrix3::new(
        c * c,
        SQRT_2 * s * c,
        s * s,
        -SQRT_2 * s * c,
        c * c - s * s,
        SQRT_2 * s * c,
        s * s,
        -SQRT_2 * s * c,
        c * c,
    )
}

/// The symmetric root of a positive definite matrix.
pub(super) fn root(matrix: &Matrix3<f64>) -> Matrix3<f64> {
    let SymmetricEigen {
        eigenvectors,
        eigenvalues,
    } = matrix.symmetric_eigen();
    eigenvectors * Matrix3::from_diagonal(&eigenvalues.map(f64::sqrt)) * eigenvectors.transpose()
}
