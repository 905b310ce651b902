//! Curves that a vertex can be constrained to.

use super::{ConstraintError, orthonormal_complement};
use nalgebra::{Matrix3, Vector3};
use std::fmt::Debug;

/// A smooth curve `q(s)` with any regular parameter.
pub trait Curve: Debug + Send + Sync {
    /// The point of the curve closest to `p` (metres), with the derivatives of the curve there.
    fn closest(&self, p: &Vector3<f64>) -> CurvePoint;
}

/// A point of a curve and the derivatives there by the parameter.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct CurvePoint {
    /// `q`, metres.
    pub position: Vector3<f64>,
    /// `q'`, not zero.
    pub first: Vector3<f64>,
    /// `q''`.
    pub second: Vector3<f64>,
    /// `q'''`.
    pub third: Vector3<f64>,
}

/// Smallest denominator relative to `|q'|^2`: as close to the centre of curvature the closest point is
/// about to jump, and its derivatives with it.
const SMALLEST_DENOMINATOR: f64 = 1e-3;

impl CurvePoint {
    /// `|q'|^2 - q'' . r`: the slope of `q' . (p - q)` along the curve, negated; zero at the centre of
    /// curvature.
    pub(crate) fn denominator(&self, r: &Vector3<f64>) -> f64 {
        let size = self.first.norm_squared();
        (size - self.second.dot(r)).max(SMALLEST_DENOMINATOR * size)
    }

    /// Second derivative by `p` of `w . r(p)`, `r(p) = p - q(s(p))`, from the implicit equation
    /// `q'(s) . (p - q(s)) = 0`.
    pub fn hessian(&self, r: &Vector3<f64>, w: &Vector3<f64>) -> Matrix3<f64> {
        let d = self.denominator(r);
        let slope = self.first / d;
        let mixed = self.second * slope.transpose();
        let along = 3.0 * self.first.dot(&self.second) - self.third.dot(r);
        let square = slope * slope.transpose();
        let parameter = (mixed + mixed.transpose() - along * square) / d;
        -w.dot(&self.second) * square - w.dot(&self.first) * parameter
    }
}

/// A straight line.
#[derive(Debug, Clone, PartialEq)]
pub struct Line {
    point: Vector3<f64>,
    direction: Vector3<f64>,
}

impl Line {
    /// Through a point (metres) in a direction of any length.
    ///
    /// # Errors
    /// [`ConstraintError`] if a number is not finite or the direction is zero.
    pub fn new(point: [f64; 3], direction: [f64; 3]) -> Result<Self, ConstraintError> {
        Ok(Self {
            point: ConstraintError::check_vector("a point of the line", &point)?,
            direction: ConstraintError::check_direction("the line", &direction)?,
        })
    }
}

impl Curve for Line {
    fn closest(&self, p: &Vector3<f64>) -> CurvePoint {
        straight(&self.point, &self.direction, p)
    }
}

/// The point closest to `p` of a line with a unit direction.
pub(super) fn straight(
    point: &Vector3<f64>,
    direction: &Vector3<f64>,
    p: &Vector3<f64>,
) -> CurvePoint {
    CurvePoint {
        position: point + direction * direction.dot(&(p - point)),
        first: *direction,
        second: Vector3::zeros(),
        third: Vector3::zeros(),
    }
}

/// A circle.
#[derive(Debug, Clone, PartialEq)]
pub struct Circle {
    centre: Vector3<f64>,
    axes: [Vector3<f64>; 2],
    radius: f64,
}

impl Circle {
    /// About a centre (metres) in the plane perpendicular to `normal`, which may have any length.
    ///
    /// # Errors
    /// [`ConstraintError`] if a number is not finite, the normal is zero or the radius (metres) not positive.
    pub fn new(centre: [f64; 3], normal: [f64; 3], radius: f64) -> Result<Self, ConstraintError> {
        let normal = ConstraintError::check_direction("the normal of the circle", &normal)?;
        Ok(Self {
            centre: ConstraintError::check_vector("the centre of the circle", &centre)?,
            axes: orthonormal_complement(&normal),
            radius: ConstraintError::check_positive("the radius of the circle", radius)?,
        })
    }
}

impl Curve for Circle {
    fn closest(&self, p: &Vector3<f64>) -> CurvePoint {
        let [a, b] = &self.axes;
        let d = p - self.centre;
        let (x, y) = (a.dot(&d), b.dot(&d));
        let size = x.hypot(y);
        // Seen from the axis all points are as close.
        let (c, s) = if size > 0.0 {
            (x / size, y / size)
        } else {
            (1.0, 0.0)
        };
        round(&self.centre, &[*a, *b], self.radius, c, s)
    }
}

/// The point of a circle at the angle with the given cosine and sine; the parameter is the arc length.
pub(super) fn round(
    centre: &Vector3<f64>,
    axes: &[Vector3<f64>; 2],
    radius: f64,
    cos: f64,
    sin: f64,
) -> CurvePoint {
    let out = cos * axes[0] + sin * axes[1];
    let along = cos * axes[1] - sin * axes[0];
    CurvePoint {
        position: centre + radius * out,
        first: along,
        second: -out / radius,
        third: -along / (radius * radius),
    }
}
