//! Rigid bodies as tetrahedra.

mod attachment;
mod force;
mod joint;
mod solid;

pub use attachment::Attachment;
pub use force::{BodyForce, BodyTorque};
pub use joint::{JointCoordinate, JointError, JointSpring};
pub use solid::{Solid, SolidError};

use isosheet_mesh::wording::given;
use isosheet_mesh::{Advice, MassMatrix, Sheet, VertexId};
use nalgebra::{Matrix3, Matrix4, SymmetricEigen, Vector3};
use std::f64::consts::TAU;

/// A point that is carried by vertices: their numbers and weights, which add up to one; unused places have
/// weight zero.
pub type CarriedPoint = [(VertexId, f64); 4];

/// A rigid body as the four corners of a tetrahedron with rigid edges, which moves as the body does.
///
/// A point p of the body is the combination `sum_k b_k(p) a_k` of the corners with constant weights that add
/// up to one, so that the kinetic energy of the body is that of the constant mass matrix
/// `M_kl = integral rho b_k b_l`, whatever tetrahedron carries it. The corners are placed in a frame in which
/// the body is round: with the mass `m`, the centre `c` and the second moments
/// `S = integral rho (r - c)(r - c)^T`, a point p is at `u = (S / m)^(-1/2) (p - c)`. A body that is much
/// thinner in one direction than in another is taken for a thicker one there, so that its tetrahedron is not
/// flat.
///
/// * Without more the corners are the corners of a regular tetrahedron with `|u|^2 = 3`. Then the matrix is
///   that of four equal masses (equimomental systems: E. J. Routh, *The Elementary Part of a Treatise on the
///   Dynamics of a System of Rigid Bodies*, 1882, Ch. I), unless the body is thin.
/// * [`RigidBody::with_corner`] puts the first corner at a point, where a ball joint can hold it.
/// * [`RigidBody::with_edge`] puts the first two on a line, where a hinge or a slider can hold them.
///
/// The [tetrahedron](RigidBody::tetrahedron) is a sheet of rods, whose [masses](RigidBody::mass_matrix) a
/// [`SheetModel`](crate::SheetModel) takes; beside an elastic sheet it remains rigid
/// (`ElasticSheet::union`).
#[derive(Debug, Clone, PartialEq)]
pub struct RigidBody {
    mass: f64,
    centre: Vector3<f64>,
    /// The frame, metres, and its inverse.
    frame: Matrix3<f64>,
    inverse: Matrix3<f64>,
    /// Second moments in the frame over the mass: one, but for what is thin.
    moments: Matrix3<f64>,
    corners: [Vector3<f64>; 4],
    /// The weights of the corners as functions of `(1, u)`.
    weights: Matrix4<f64>,
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
    /// A point or a direction of a guide is not finite, or the direction is zero.
    #[error(
        "the guide of a rigid body has the {what} ({}, {}, {})",
        given(value[0]), given(value[1]), given(value[2])
    )]
    Guide {
        /// Which one.
        what: &'static str,
        /// Its coordinates.
        value: [f64; 3],
    },
    /// No body with a volume has the second moments.
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
            Self::Guide { .. } => {
                Some("give finite numbers near the body, and a direction that is not zero")
            }
            Self::Moments { .. } => Some(
                "give the symmetric matrix of the second moments about the centre, of a body that is \
                 not a plate without thickness",
            ),
        }
    }
}

/// Corners of the regular tetrahedron with the distance `3^(1/2)` from the origin.
const REGULAR: [[f64; 3]; 4] = [
    [1.0, 1.0, 1.0],
    [1.0, -1.0, -1.0],
    [-1.0, 1.0, -1.0],
    [-1.0, -1.0, 1.0],
];

/// Faces of the tetrahedron.
const FACES: [[u32; 3]; 4] = [[0, 1, 2], [0, 3, 1], [0, 2, 3], [1, 3, 2]];

/// Least size of a body along an axis of its frame, as a part of the largest: the height of its tetrahedron.
const LEAST_SIZE: f64 = 0.1;

/// Couplings of the corners over the mass that are round-off.
const ROUND_OFF: f64 = 1e-14;

impl RigidBody {
    /// A body of a mass (kilograms) with its centre (metres) and its second moments about the centre
    /// (kg m2, symmetric).
    ///
    /// # Errors
    /// [`RigidBodyError`]; also where a second moment is so much smaller than another one that the
    /// tetrahedron is flat but for round-off.
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
        let sizes = eigenvalues.map(|s| (s / mass).sqrt());
        let thickened = sizes.map(|a| a.max(LEAST_SIZE * sizes.max()));
        let of = |sizes: &Vector3<f64>| {
            eigenvectors * Matrix3::from_diagonal(sizes) * eigenvectors.transpose()
        };
        let body = Self {
            mass,
            centre: Vector3::from(centre),
            frame: of(&thickened),
            inverse: of(&thickened.map(f64::recip)),
            moments: of(&sizes.component_div(&thickened).map(|r| r * r)),
            corners: [Vector3::zeros(); 4],
            weights: Matrix4::zeros(),
        };
        let regular = body.carried_by(REGULAR.map(Vector3::from));
        regular.ok_or(RigidBodyError::Moments { least, largest })
    }

    /// A solid of a mass (kilograms) that is spread evenly.
    ///
    /// # Errors
    /// [`RigidBodyError::Mass`].
    pub fn of_solid(solid: &Solid, mass: f64) -> Result<Self, RigidBodyError> {
        let density = mass / solid.volume();
        let moments = solid.second_moments().map(|row| row.map(|s| density * s));
        Self::new(mass, solid.centre(), moments)
    }

    /// This body with the first corner of its tetrahedron at a point (metres).
    ///
    /// # Errors
    /// [`RigidBodyError::Guide`] if the point is not finite, or much too far away.
    pub fn with_corner(self, point: [f64; 3]) -> Result<Self, RigidBodyError> {
        let wrong = RigidBodyError::Guide {
            what: "point",
            value: point,
        };
        let place = self.place(point);
        let distance = place.norm();
        let towards = (-place).try_normalize(0.0).unwrap_or_else(Vector3::x);
        let side = across(&towards);
        let other_side = towards.cross(&side);
        // The farther the point, the nearer is this to the tetrahedron of four masses without couplings.
        let height = distance.hypot(1.0).recip();
        let radius = (2.0 * (1.0 + height * height)).sqrt();
        let corner = |k: u8| {
            let (sin, cos) = (TAU * f64::from(k) / 3.0).sin_cos();
            height * towards + radius * (cos * side + sin * other_side)
        };
        self.carried_by([place, corner(0), corner(1), corner(2)])
            .ok_or(wrong)
    }

    /// This body with the first two corners of its tetrahedron on the line through a point (metres) along a
    /// direction of any length.
    ///
    /// # Errors
    /// [`RigidBodyError::Guide`] if they are not finite, the direction is zero, or the line is much too far
    /// away.
    pub fn with_edge(self, point: [f64; 3], direction: [f64; 3]) -> Result<Self, RigidBodyError> {
        let along = Vector3::from(direction).try_normalize(0.0);
        let along = along.and_then(|d| (self.inverse * d).try_normalize(0.0));
        let Some(along) = along.filter(|d| d.iter().all(|c| c.is_finite())) else {
            return Err(RigidBodyError::Guide {
                what: "direction",
                value: direction,
            });
        };
        let place = self.place(point);
        let foot = place - place.dot(&along) * along;
        let distance = foot.norm();
        let towards = (-foot).try_normalize(0.0).unwrap_or_else(|| across(&along));
        let half = distance.hypot(1.0) * along;
        let height = distance.hypot(1.0).recip();
        let side = height.hypot(1.0) * towards.cross(&along);
        let corners = [
            foot - half,
            foot + half,
            height * towards - side,
            height * towards + side,
        ];
        self.carried_by(corners).ok_or(RigidBodyError::Guide {
            what: "point",
            value: point,
        })
    }

    /// A point of space in the frame of the body.
    fn place(&self, point: [f64; 3]) -> Vector3<f64> {
        self.inverse * (Vector3::from(point) - self.centre)
    }

    /// This body carried by other corners, given in its frame; `None` if these are flat or not finite.
    fn carried_by(self, corners: [Vector3<f64>; 4]) -> Option<Self> {
        let columns = corners.map(|u| u.insert_row(0, 1.0));
        let weights = Matrix4::from_columns(&columns).try_inverse()?;
        let is_finite = weights.iter().all(|b| b.is_finite());
        is_finite.then_some(Self {
            corners,
            weights,
            ..self
        })
    }

    /// Mass, kilograms.
    pub fn mass(&self) -> f64 {
        self.mass
    }

    /// Centre of mass, metres.
    pub fn centre(&self) -> [f64; 3] {
        self.centre.into()
    }

    /// The tetrahedron: four vertices and six edges.
    ///
    /// # Panics
    /// Never for a body that could be made.
    pub fn tetrahedron(&self) -> Sheet {
        let place = |u: &Vector3<f64>| -> [f64; 3] { (self.centre + self.frame * u).into() };
        let positions = self.corners.iter().flat_map(place).collect();
        Sheet::new(positions, &FACES).expect("a tetrahedron with volume is a surface")
    }

    /// The mass matrix of the [tetrahedron](RigidBody::tetrahedron): lumped if its corners are not coupled.
    pub fn mass_matrix(&self) -> MassMatrix {
        let mut moments = Matrix4::identity();
        moments
            .fixed_view_mut::<3, 3>(1, 1)
            .copy_from(&self.moments);
        let masses = self.mass * self.weights * moments * self.weights.transpose();
        let coupling = |[a, b]: [VertexId; 2]| masses[(a.index(), b.index())];
        let tetrahedron = self.tetrahedron();
        let edges = tetrahedron.topology().edges().iter();
        let couplings: Vec<f64> = edges.map(|ends| coupling(*ends)).collect();
        let is_coupled = couplings.iter().any(|m| m.abs() > ROUND_OFF * self.mass);
        MassMatrix {
            vertex: masses.diagonal().iter().copied().collect(),
            edge: is_coupled.then_some(couplings),
        }
    }

    /// A point of the body (metres, where the body is now) as it is carried by the tetrahedron, whose first
    /// vertex in a model is `first`.
    pub fn carried(&self, point: [f64; 3], first: VertexId) -> CarriedPoint {
        let weights = self.weights * self.place(point).insert_row(0, 1.0);
        // What round-off takes from their sum.
        let rest = 0.25 * (1.0 - weights.sum());
        std::array::from_fn(|k| (VertexId::from_index(first.index() + k), weights[k] + rest))
    }
}

/// A direction across another one.
fn across(direction: &Vector3<f64>) -> Vector3<f64> {
    direction
        .cross(&Vector3::ith(direction.iamin(), 1.0))
        .normalize()
}

#[cfg(test)]
mod tests;
