//! Rigid bodies as four point masses.

use crate::contact::CarriedPoint;
use isosheet_mesh::wording::given;
use isosheet_mesh::{Advice, Sheet, VertexId};
use nalgebra::{Matrix3, SymmetricEigen, Vector3};

/// A rigid body as four equal point masses at the corners of a tetrahedron with rigid edges, which moves as
/// the body does.
///
/// A body of mass `m`, centre `c` and second moments `S = integral rho (r - c)(r - c)^T` has the mass, the
/// centre and the second moments, so the inertia, of the masses `m/4` at
///
/// ```text
/// a_k = c + 2 (S / m)^(1/2) s_k,
/// ```
///
/// with the corners `s_k` of the regular tetrahedron with `sum_k s_k = 0` and `sum_k s_k s_k^T = I`
/// (equimomental systems: E. J. Routh, *The Elementary Part of a Treatise on the Dynamics of a System of Rigid
/// Bodies*, 1882, Ch. I). A point `p` of the body is the combination `sum_k b_k a_k` with constant weights
/// that add up to one.
///
/// The [tetrahedron](RigidBody::tetrahedron) is a sheet of rods, whose [masses](RigidBody::point_masses) a
/// [`SheetModel`](crate::SheetModel) takes; beside an elastic sheet it remains rigid
/// ([`ElasticSheet::union`](crate::ElasticSheet::union)).
#[derive(Debug, Clone, PartialEq)]
pub struct RigidBody {
    mass: f64,
    centre: Vector3<f64>,
    /// `2 (S/m)^(1/2)`, metres, and its inverse.
    shape: Matrix3<f64>,
    inverse: Matrix3<f64>,
}

/// Why a rigid body makes no sense.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum RigidBodyError {
    /// The mass is not positive or not finite.
    #[error("the mass of a rigid body is {mass} kg", mass = given(*mass))]
    Mass {
        /// The mass, kilograms.
        mass: f64,
    },
    /// A coordinate of the centre is not finite.
    #[error("the centre of a rigid body is at {value} m", value = given(*value))]
    Centre {
        /// The coordinate, metres.
        value: f64,
    },
    /// The second moments are not those of a body with a volume.
    #[error(
        "the least second moment of a rigid body is {least} kg m2, the largest {largest} kg m2",
        least = given(*least), largest = given(*largest)
    )]
    Moments {
        /// The least one along an axis, kg m2.
        least: f64,
        /// The largest one.
        largest: f64,
    },
}

impl Advice for RigidBodyError {
    fn advice(&self) -> Option<&'static str> {
        match self {
            Self::Mass { .. } => Some("give a finite one above 0"),
            Self::Centre { .. } => Some("give finite coordinates"),
            Self::Moments { .. } => Some(
                "give the symmetric matrix of the second moments about the centre, of a body that is \
                 not a plate without thickness",
            ),
        }
    }
}

/// Corners of the regular tetrahedron with `sum_k s_k s_k^T = I`.
const CORNERS: [[f64; 3]; 4] = [
    [0.5, 0.5, 0.5],
    [0.5, -0.5, -0.5],
    [-0.5, 0.5, -0.5],
    [-0.5, -0.5, 0.5],
];

/// Faces of the tetrahedron, with outward normals.
const FACES: [[u32; 3]; 4] = [[0, 1, 2], [0, 3, 1], [0, 2, 3], [1, 3, 2]];

impl RigidBody {
    /// A body of a mass (kilograms) with its centre (metres) and its second moments about the centre
    /// (kg m2, symmetric).
    ///
    /// # Errors
    /// [`RigidBodyError`]; also where a second moment is so much smaller than another one that the tetrahedron
    /// is flat but for round-off.
    pub fn new(
        mass: f64,
        centre: [f64; 3],
        second_moments: [[f64; 3]; 3],
    ) -> Result<Self, RigidBodyError> {
        if !(mass.is_finite() && mass > 0.0) {
            return Err(RigidBodyError::Mass { mass });
        }
        if let Some(&value) = centre.iter().find(|c| !c.is_finite()) {
            return Err(RigidBodyError::Centre { value });
        }
        let moments = Matrix3::from(second_moments);
        let is_symmetric = moments == moments.transpose();
        let SymmetricEigen {
            eigenvectors,
            eigenvalues,
        } = moments.symmetric_eigen();
        let (least, largest) = (eigenvalues.min(), eigenvalues.max());
        // (Relative accuracy of heights is the root of that of squares.)
        let has_volume = least > f64::EPSILON * largest && largest.is_finite();
        if !(is_symmetric && has_volume) {
            return Err(RigidBodyError::Moments { least, largest });
        }
        let sizes = eigenvalues.map(|s| 2.0 * (s / mass).sqrt());
        let of = |sizes: &Vector3<f64>| {
            eigenvectors * Matrix3::from_diagonal(sizes) * eigenvectors.transpose()
        };
        Ok(Self {
            mass,
            centre: Vector3::from(centre),
            shape: of(&sizes),
            inverse: of(&sizes.map(f64::recip)),
        })
    }

    /// Mass, kilograms.
    pub fn mass(&self) -> f64 {
        self.mass
    }

    /// The tetrahedron: four vertices and six edges.
    ///
    /// # Panics
    /// Never for a body that could be made.
    pub fn tetrahedron(&self) -> Sheet {
        let corner =
            |s: &[f64; 3]| -> [f64; 3] { (self.centre + self.shape * Vector3::from(*s)).into() };
        let positions = CORNERS.iter().flat_map(corner).collect();
        Sheet::new(positions, &FACES).expect("a tetrahedron with volume is a surface")
    }

    /// The masses of its vertices, kilograms.
    pub fn point_masses(&self) -> [f64; 4] {
        [0.25 * self.mass; 4]
    }

    /// A point of the body (metres, where the body is now) as it is carried by the tetrahedron, whose first
    /// vertex in a model is `first`: `b_k = 1/4 + s_k^T (2 (S/m)^(1/2))^-1 (p - c)`.
    pub fn carried(&self, point: [f64; 3], first: VertexId) -> CarriedPoint {
        let along = self.inverse * (Vector3::from(point) - self.centre);
        std::array::from_fn(|k| {
            let weight = 0.25 + Vector3::from(CORNERS[k]).dot(&along);
            (VertexId::from_index(first.index() + k), weight)
        })
    }
}

#[cfg(test)]
mod tests;
