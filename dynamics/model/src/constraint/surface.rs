//! Surfaces that a vertex can be constrained to.

use super::ConstraintError;
use nalgebra::{Matrix3, Vector3};
use std::fmt::{self, Debug};

/// A surface as the zero level of a function.
pub trait Surface: Debug + Send + Sync {
    /// The level at `p` (metres) and its derivatives.
    fn at(&self, p: &Vector3<f64>) -> SurfacePoint;
}

/// The level of a surface at a point.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct SurfacePoint {
    /// Signed distance, metres, or a function of the same zeros whose gradient there has about unit length.
    pub level: f64,
    /// Its gradient.
    pub gradient: Vector3<f64>,
    /// Its second derivative, one over metres.
    pub hessian: Matrix3<f64>,
}

/// A plane; its outside is where the normal points.
#[derive(Debug, Clone, PartialEq)]
pub struct Plane {
    point: Vector3<f64>,
    normal: Vector3<f64>,
}

impl Plane {
    /// Through a point (metres), perpendicular to a normal of any length.
    ///
    /// # Errors
    /// [`ConstraintError`] if a number is not finite or the normal is zero.
    pub fn new(point: [f64; 3], normal: [f64; 3]) -> Result<Self, ConstraintError> {
        Ok(Self {
            point: ConstraintError::check_vector("a point of the plane", &point)?,
            normal: ConstraintError::check_direction("the normal of the plane", &normal)?,
        })
    }
}

impl Surface for Plane {
    fn at(&self, p: &Vector3<f64>) -> SurfacePoint {
        SurfacePoint {
            level: self.normal.dot(&(p - self.point)),
            gradient: self.normal,
            hessian: Matrix3::zeros(),
        }
    }
}

/// A sphere.
#[derive(Debug, Clone, PartialEq)]
pub struct Sphere {
    centre: Vector3<f64>,
    radius: f64,
}

impl Sphere {
    /// About a centre (metres).
    ///
    /// # Errors
    /// [`ConstraintError`] if a number is not finite or the radius (metres) not positive.
    pub fn new(centre: [f64; 3], radius: f64) -> Result<Self, ConstraintError> {
        Ok(Self {
            centre: ConstraintError::check_vector("the centre of the sphere", &centre)?,
            radius: ConstraintError::check_positive("the radius of the sphere", radius)?,
        })
    }
}

impl Surface for Sphere {
    fn at(&self, p: &Vector3<f64>) -> SurfacePoint {
        around(&(p - self.centre), &Matrix3::identity(), self.radius)
    }
}

/// A cylinder without ends.
#[derive(Debug, Clone, PartialEq)]
pub struct Cylinder {
    point: Vector3<f64>,
    axis: Vector3<f64>,
    radius: f64,
}

impl Cylinder {
    /// About the axis through a point (metres) in a direction of any length.
    ///
    /// # Errors
    /// [`ConstraintError`] if a number is not finite, the direction is zero or the radius (metres) not
    /// positive.
    pub fn new(point: [f64; 3], axis: [f64; 3], radius: f64) -> Result<Self, ConstraintError> {
        Ok(Self {
            point: ConstraintError::check_vector("a point of the axis", &point)?,
            axis: ConstraintError::check_direction("the axis of the cylinder", &axis)?,
            radius: ConstraintError::check_positive("the radius of the cylinder", radius)?,
        })
    }
}

impl Surface for Cylinder {
    fn at(&self, p: &Vector3<f64>) -> SurfacePoint {
        let projector = Matrix3::identity() - self.axis * self.axis.transpose();
        around(&(projector * (p - self.point)), &projector, self.radius)
    }
}

/// The surface at a distance from a centre or an axis, from which `d` leads to the point. `projector` removes
/// the part of a vector that does not change this distance.
fn around(d: &Vector3<f64>, projector: &Matrix3<f64>, radius: f64) -> SurfacePoint {
    let size = d.norm();
    // From the centre every direction leads out.
    let (n, hessian) = if size > 0.0 {
        let n = d / size;
        (n, (projector - n * n.transpose()) / size)
    } else {
        (
            projector.column(projector.diagonal().imax()).normalize(),
            Matrix3::zeros(),
        )
    };
    SurfacePoint {
        level: size - radius,
        gradient: n,
        hessian,
    }
}

/// A surface given by a function of the point (metres).
pub struct SignedDistanceField<F>(pub F);

impl<F> Debug for SignedDistanceField<F> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str("SignedDistanceField")
    }
}

impl<F: Fn(&Vector3<f64>) -> SurfacePoint + Send + Sync> Surface for SignedDistanceField<F> {
    fn at(&self, p: &Vector3<f64>) -> SurfacePoint {
        (self.0)(p)
    }
}
