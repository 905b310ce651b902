//! How stiff a plate is.

use nalgebra::{Matrix3, Vector3};
use std::f64::consts::FRAC_1_SQRT_2;

/// The stiffness of an isotropic plate: a curvature `k`, a symmetric 2 x 2 matrix, stores
///
/// ```text
/// D/2 [ (1 - nu) |k|^2 + nu (tr k)^2 ] = D/2 [ (k_1 + k_2)^2 - 2 (1 - nu) k_1 k_2 ]
/// ```
///
/// per area, with the flexural rigidity `D`, Poisson's ratio `nu` and the principal curvatures `k_1` and `k_2`
/// (Kirchhoff's plate; S. P. Timoshenko and S. Woinowsky-Krieger, *Theory of Plates and Shells*, 2nd ed., 1959,
/// section 11). A developable surface has one principal curvature, where this is `D k_1^2 / 2` for every ratio;
/// a twist `k_12` stores `D (1 - nu) k_12^2`.
///
/// ```
/// use isosheet_dynamics::{Material, PlateStiffness};
///
/// let limp = PlateStiffness::from(5e-4); // a rigidity alone: Poisson's ratio zero
/// let paper = PlateStiffness::from(&Material::office_paper());
/// assert_eq!((limp.rigidity, limp.poisson), (paper.rigidity, 0.0));
/// assert_eq!(paper.poisson, 0.3);
/// ```
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct PlateStiffness {
    /// Flexural rigidity `D`, newton metres (office paper: about 5e-4).
    pub rigidity: f64,
    /// Poisson's ratio, from 0 to 0.5.
    pub poisson: f64,
}

/// A plate whose Poisson's ratio is zero.
impl From<f64> for PlateStiffness {
    fn from(rigidity: f64) -> Self {
        let poisson = 0.0;
        Self { rigidity, poisson }
    }
}

impl PlateStiffness {
    /// The root of the law: with the components `k = (11, sqrt(2) 12, 22)` of a curvature, `|root k|^2` is
    /// what is in brackets above. Of the law, the unit matrix has the eigenvalue `1 + nu`, and what is
    /// perpendicular to it `1 - nu`.
    pub(super) fn root(self) -> Matrix3<f64> {
        self.by_eigenvalues(f64::sqrt)
    }

    /// The inverse of the [root](Self::root).
    pub(super) fn inverse_root(self) -> Matrix3<f64> {
        self.by_eigenvalues(|law| 1.0 / law.sqrt())
    }

    fn by_eigenvalues(self, function: fn(f64) -> f64) -> Matrix3<f64> {
        let unit = Vector3::new(FRAC_1_SQRT_2, 0.0, FRAC_1_SQRT_2);
        let trace = unit * unit.transpose();
        let [trace_law, other_law] = [1.0 + self.poisson, 1.0 - self.poisson].map(function);
        trace * trace_law + (Matrix3::identity() - trace) * other_law
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::f64::consts::SQRT_2;

    #[test]
    fn the_root_of_the_law_gives_its_energy() {
        let [k11, k12, k22] = [0.7, -1.3, 0.4];
        let (norm, trace) = (k11 * k11 + 2.0 * k12 * k12 + k22 * k22, k11 + k22);
        for poisson in [0.0, 0.3, 0.5] {
            let stiffness = PlateStiffness {
                rigidity: 1.0,
                poisson,
            };
            let root = stiffness.root();
            let energy = (root * Vector3::new(k11, SQRT_2 * k12, k22)).norm_squared();
            let expected = (1.0 - poisson) * norm + poisson * trace * trace;
            assert!((energy - expected).abs() < 1e-14, "{poisson}");
            let unit = root * stiffness.inverse_root();
            assert!((unit - Matrix3::identity()).norm() < 1e-14, "{poisson}");
        }
    }
}
