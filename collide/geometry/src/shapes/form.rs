//! What a shape says of itself.

use super::contact_geometry::ContactGeometry;
use super::moments::Moments;
use super::skin::Skin;
use super::triangles::Triangles;
use crate::signed_distance::SignedDistance;
use isosheet_mesh::Advice;
use isosheet_mesh::wording::given;
use nalgebra::Vector3;
use std::fmt::Debug;
use thiserror::Error;

/// A form of a body in its own frame, with all that contact, mass, pictures and files ask about it. Lengths
/// in metres.
///
/// Each [`Shape`](crate::Shape) is a file that implements this. A program gives one of its own as
/// [`Shape::Other`](crate::Shape::Other): distance, triangles and bounds are enough, and what follows from
/// them is there by default:
///
/// ```
/// use isosheet_geometry::nalgebra::{Matrix3, Vector3, vector};
/// use isosheet_geometry::{Form, Shape, ShapeError, SignedDistance, Triangles};
/// use std::f64::consts::TAU;
/// use std::sync::Arc;
///
/// /// All points within `tube` of a circle about the z axis.
/// #[derive(Debug)]
/// struct Torus {
///     radius: f64,
///     tube: f64,
/// }
///
/// impl Form for Torus {
///     fn name(&self) -> &'static str {
///         "torus"
///     }
///
///     fn lengths(&self) -> Vec<(&'static str, f64)> {
///         vec![("radius", self.radius), ("tube", self.tube), ("hole", self.radius - self.tube)]
///     }
///
///     fn signed_distance(&self, p: &Vector3<f64>) -> SignedDistance {
///         let rho = p.x.hypot(p.y);
///         let out = if rho > 0.0 { vector![p.x / rho, p.y / rho, 0.0] } else { Vector3::x() };
///         let from_circle = p - self.radius * out;
///         let d = from_circle.norm();
///         let normal = if d > 0.0 { from_circle / d } else { Vector3::z() };
///         let around = Vector3::z().cross(&out);
///         let tilt = around.cross(&normal);
///         // The normal turns about the circle, and with the circle about the axis.
///         let curvatures = [1.0 / d, normal.dot(&out) / rho];
///         let [tilting, turning] = curvatures.map(|c| if c.is_finite() { c } else { 0.0 });
///         SignedDistance {
///             value: d - self.tube,
///             normal,
///             hessian: tilting * tilt * tilt.transpose() + turning * around * around.transpose(),
///         }
///     }
///
///     fn triangles(&self, sides: usize) -> Result<Option<Triangles>, ShapeError> {
///         let turn = |k: usize| (TAU * k as f64 / sides as f64).sin_cos();
///         let corner = |i: usize, j: usize| {
///             let ((sin, cos), (up, out)) = (turn(i), turn(j));
///             let rho = self.radius + self.tube * out;
///             [rho * cos, rho * sin, self.tube * up]
///         };
///         let at = |i: usize, j: usize| ((i % sides) * sides + j % sides) as u32;
///         let places = || (0..sides).flat_map(|i| (0..sides).map(move |j| (i, j)));
///         Ok(Some(Triangles {
///             points: places().map(|(i, j)| corner(i, j)).collect(),
///             faces: places()
///                 .flat_map(|(i, j)| {
///                     let [a, b, c, d] = [at(i, j), at(i + 1, j), at(i + 1, j + 1), at(i, j + 1)];
///                     [[a, b, c], [a, c, d]]
///                 })
///                 .collect(),
///         }))
///     }
///
///     fn bounds(&self) -> Option<[Vector3<f64>; 2]> {
///         let out = self.radius + self.tube;
///         let high = vector![out, out, self.tube];
///         Some([-high, high])
///     }
/// }
///
/// let torus = Shape::Other(Arc::new(Torus { radius: 0.5, tube: 0.1 }));
/// torus.validate()?;
/// assert!((torus.signed_distance(&vector![0.0, 0.0, 0.0]).value - 0.4).abs() < 1e-15);
/// assert!((torus.signed_distance(&vector![0.0, 0.5, 0.3]).value - 0.2).abs() < 1e-15);
/// for p in torus.triangles(24)?.expect("it has an end").points {
///     assert!(torus.signed_distance(&p.into()).value.abs() < 1e-15);
/// }
/// assert_eq!(torus.contact_geometry(24)?.expect("it has an end").mesh.faces().len(), 1152);
/// # Ok::<(), ShapeError>(())
/// ```
pub trait Form: Debug + Send + Sync {
    /// What it is called in messages.
    fn name(&self) -> &'static str;

    /// Its lengths with their names, metres, all of which have to be positive. By default there are none.
    fn lengths(&self) -> Vec<(&'static str, f64)> {
        Vec::new()
    }

    /// Distance of `p` (metres) with derivatives, negative inside; never negative where nothing is inside.
    fn signed_distance(&self, p: &Vector3<f64>) -> SignedDistance;

    /// As [`Form::signed_distance`], but of a surface with two sides negative on one of them. By default the
    /// same.
    fn oriented_distance(&self, p: &Vector3<f64>) -> SignedDistance {
        self.signed_distance(p)
    }

    /// Triangles that approximate the surface, with corners on it and so many sides (four at least) of
    /// whatever is a circle; `None` if the shape has no end.
    ///
    /// # Errors
    /// [`ShapeError::Segments`] for more sides than the shape can have.
    fn triangles(&self, sides: usize) -> Result<Option<Triangles>, ShapeError>;

    /// The primitives by which faces and edges of a mesh, not only its vertices, are kept away, with so many
    /// sides of whatever is a circle and is not met exactly. `None` for a half-space, from which a flat face
    /// is away if its corners are. Primitives of a shape that is not [convex](Form::is_convex) have faces and
    /// no radius. By default the primitives of the triangles.
    ///
    /// # Errors
    /// [`ShapeError::Segments`] for a number of sides that the shape cannot have.
    fn contact_geometry(&self, segments: usize) -> Result<Option<ContactGeometry>, ShapeError> {
        let triangles = self.triangles(segments)?;
        Ok(triangles.map(|of| ContactGeometry::of_triangles(of.points.concat(), &of.faces)))
    }

    /// The least and the largest coordinates of its points, metres; `None` if it has no end.
    fn bounds(&self) -> Option<[Vector3<f64>; 2]>;

    /// Volume with its moments in closed form; by default `None`, which says nothing about them.
    fn moments(&self) -> Option<Moments> {
        None
    }

    /// The rotations that leave it as it is. By default none are known.
    fn symmetry(&self) -> Symmetry {
        Symmetry::None
    }

    /// Whether it is convex: the plane at the closest point, across the normal, has all of it on one side.
    /// Vertices meet such a shape by its distance, and others by the primitives of
    /// [`Form::contact_geometry`]. By default `false`.
    fn is_convex(&self) -> bool {
        false
    }

    /// Whether it has an inside, where distances are negative. By default `true`.
    fn is_solid(&self) -> bool {
        true
    }

    /// What of the surface is curved, and how. By default that is not known, and triangles stand for it.
    fn skin(&self) -> Skin {
        Skin::Flat
    }
}

/// The rotations that leave a shape as it is.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Symmetry {
    /// None that are known.
    None,
    /// All rotations about the z axis.
    Axis,
    /// All about the origin.
    Full,
}

/// Why a shape cannot be used.
#[derive(Debug, Clone, PartialEq, Error)]
#[non_exhaustive]
pub enum ShapeError {
    /// A length is not positive.
    #[error("{shape}: {name} is {value} m", value = given(*value))]
    Length {
        /// The shape.
        shape: &'static str,
        /// The length.
        name: &'static str,
        /// Its value, metres.
        value: f64,
    },
    /// A number of sides that a round shape cannot have.
    #[error("a round body cannot have {0} segments")]
    Segments(usize),
}

impl Advice for ShapeError {
    fn advice(&self) -> Option<&'static str> {
        match self {
            Self::Length { .. } => Some("give a positive length"),
            Self::Segments(..) => Some("give at least 3"),
        }
    }
}
