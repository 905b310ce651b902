//! How stiff a plate is.

/// The stiffness of an isotropic plate: a curvature `k`, a symmetric 2 x 2 matrix, stores
///
/// ```text
/// D/2 [ (1 - nu) |k|^2 + nu (tr k)^2 ] = D/2 [ (k_1 + k_2)^2 - 2 (1 - nu) k_1 k_2 ]
/// ```
///
/// per area, with the flexural rigidity `D`, Poisson's ratio `nu` and the principal curvatures `k_1` and
/// `k_2` (Kirchhoff's plate; S. P. Timoshenko and S. Woinowsky-Krieger, *Theory of Plates and Shells*, 2nd
/// ed., 1959, section 11). A developable surface has one principal curvature, where this is `D k_1^2 / 2` for
/// every ratio; a twist `k_12` stores `D (1 - nu) k_12^2`.
///
/// ```
/// use isosheet_materials::{Material, PlateStiffness};
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
