//! Vertices constrained to curves and surfaces.

mod curve;
mod polyline;
mod spline;
mod surface;
#[cfg(test)]
mod tests;

pub use curve::{Circle, Curve, CurvePoint, Line};
pub use polyline::Polyline;
pub use spline::Spline;
pub use surface::{Cylinder, Plane, SignedDistanceField, Sphere, Surface, SurfacePoint};

use isosheet_mesh::wording::{brief, given};
use isosheet_mesh::{Advice, VertexId};
use isosheet_motion::{MotionError, RigidMotion};
use nalgebra::{Matrix2x3, Matrix3, Vector3};

/// Why a curve or surface cannot be made.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum ConstraintError {
    /// A number is not finite, or not positive where it has to be.
    #[error("{what} is {value}", value = given(*value))]
    Number {
        /// Which one.
        what: &'static str,
        /// Its value.
        value: f64,
        /// What else is asked of it.
        condition: &'static str,
    },
    /// A direction has no length.
    #[error("{what} has no direction")]
    NoDirection {
        /// Which one.
        what: &'static str,
    },
    /// Too few points.
    #[error("{found} points make no {what}, which needs at least {needed}")]
    TooFewPoints {
        /// The curve.
        what: &'static str,
        /// Points given.
        found: usize,
        /// Points needed.
        needed: usize,
    },
    /// Two neighbouring points coincide.
    #[error("points {first} and {second} coincide")]
    Coincident {
        /// The first.
        first: usize,
        /// The one after it.
        second: usize,
    },
    /// A corner cannot be rounded.
    #[error(
        "the corner at point {point} cannot be rounded with radius {radius} m between the sides \
         beside it: at most {largest} m fit",
        radius = given(*radius), largest = brief(*largest)
    )]
    Corner {
        /// The point.
        point: usize,
        /// The radius asked for, metres.
        radius: f64,
        /// The largest that fits, metres.
        largest: f64,
    },
}

impl Advice for ConstraintError {
    fn advice(&self) -> Option<&'static str> {
        match self {
            Self::Number { condition: "", .. } => Some("give a finite number"),
            Self::Number { .. } => Some("give a finite number above 0"),
            Self::NoDirection { .. } => Some("give a vector that is not zero"),
            Self::TooFewPoints { .. } => Some("give more points"),
            Self::Coincident { .. } => Some("leave one out"),
            Self::Corner { .. } => Some("give a smaller radius"),
        }
    }
}

impl ConstraintError {
    pub(crate) fn check_vector(what: &'static str, v: &[f64; 3]) -> Result<Vector3<f64>, Self> {
        match v.iter().find(|c| !c.is_finite()) {
            Some(&value) => Err(Self::Number {
                what,
                value,
                condition: "",
            }),
            None => Ok(Vector3::from(*v)),
        }
    }

    pub(crate) fn check_direction(what: &'static str, v: &[f64; 3]) -> Result<Vector3<f64>, Self> {
        Self::check_vector(what, v)?
            .try_normalize(0.0)
            .ok_or(Self::NoDirection { what })
    }

    pub(crate) fn check_positive(what: &'static str, value: f64) -> Result<f64, Self> {
        if value.is_finite() && value > 0.0 {
            Ok(value)
        } else {
            Err(Self::Number {
                what,
                value,
                condition: " above 0",
            })
        }
    }
}

/// On which side of a surface a vertex may be.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Side {
    /// On it: an equality.
    On,
    /// On it or where its level is positive: an inequality, whose force pushes and does not pull.
    Outside,
    /// On it or where its level is negative: an inequality.
    Inside,
}

/// What the rows of a constraint have to know of its vertex.
#[derive(Debug, Clone, Copy)]
pub struct ConstrainedVertex {
    /// The vertex.
    pub vertex: VertexId,
    /// Mass, kilograms; zero if the vertex is pinned.
    pub mass: f64,
    /// Length of the shortest rod at it, metres: the scale of violations.
    pub length: f64,
}

#[derive(Debug)]
enum Locus {
    Surface(Box<dyn Surface>, Side),
    Curve(Box<dyn Curve>),
}

/// A vertex constrained to a curve or surface, without friction.
///
/// A constraint is up to three equations `c(x_v, t) = 0` (metres) at one vertex:
///
/// * a surface, its level (a signed distance, or near the surface like one): one equation;
/// * a curve, the vector from its closest point, `r(p) = p - q(s(p))`: three equations of rank two on the
///   curve. Its Jacobian there is the projector across the curve, so the two independent equations are
///   perfectly conditioned, and as smooth as the curve. No frame has to be transported along the curve, none
///   is undefined where a curve closes or is straight, and no unknown is added.
///
/// A constraint so touches its vertex's own 3x3 block of the matrices and nothing else.
///
/// One-sided constraints ask `c >= 0` (outside) or `c <= 0` (inside).
#[derive(Debug)]
pub struct VertexConstraint {
    vertex: VertexId,
    shape: Locus,
    motion: Option<RigidMotion>,
}

impl VertexConstraint {
    /// Constrains a vertex to a surface, or to one side of it.
    pub fn on_surface(vertex: VertexId, surface: impl Surface + 'static, side: Side) -> Self {
        Self {
            vertex,
            shape: Locus::Surface(Box::new(surface), side),
            motion: None,
        }
    }

    /// Constrains a vertex to a curve.
    pub fn on_curve(vertex: VertexId, curve: impl Curve + 'static) -> Self {
        Self {
            vertex,
            shape: Locus::Curve(Box::new(curve)),
            motion: None,
        }
    }

    /// Moves the curve or surface: the motion takes its frame to space. It is a
    /// `RigidProfile`, a `RigidDisplacement`, keyframes,
    /// or a function of time (seconds) that returns the pose.
    #[must_use]
    pub fn moving(mut self, motion: impl Into<RigidMotion>) -> Self {
        self.motion = Some(motion.into());
        self
    }

    /// The vertex.
    pub fn vertex(&self) -> VertexId {
        self.vertex
    }

    /// Whether it moves, as far as is known.
    pub fn moves(&self) -> bool {
        self.moving_frame().is_some()
    }

    fn moving_frame(&self) -> Option<&RigidMotion> {
        self.motion.as_ref().filter(|motion| !motion.is_fixed())
    }

    pub(crate) fn validate_motion(&self) -> Result<(), MotionError> {
        self.motion.as_ref().map_or(Ok(()), RigidMotion::validate)
    }

    /// A number of the pose at time `t` that is not finite, if there is one.
    pub(crate) fn bad_pose(&self, t: f64) -> Option<f64> {
        let pose = self.motion.as_ref()?.pose(t);
        let parts = pose
            .translation
            .vector
            .iter()
            .chain(pose.rotation.coords.iter());
        parts.copied().find(|c| !c.is_finite())
    }

    /// Whether the constraint is an inequality: it pushes, and does not pull.
    pub fn is_one_sided(&self) -> bool {
        matches!(self.shape, Locus::Surface(_, Side::Outside | Side::Inside))
    }

    /// Number of independent equations: 1 for a surface, 2 for a curve.
    pub fn equation_count(&self) -> usize {
        match self.shape {
            Locus::Surface(..) => 1,
            Locus::Curve(_) => 2,
        }
    }

    /// The equations at a point (metres) and time (seconds).
    pub fn at(&self, t: f64, p: &Vector3<f64>) -> LocalEquations {
        let Some(motion) = &self.motion else {
            return self.shape.at(p);
        };
        let pose = motion.pose(t);
        let rotation = pose.rotation.to_rotation_matrix().into_inner();
        let body = rotation.transpose() * (p - pose.translation.vector);
        self.shape.at(&body).turned(&rotation)
    }

    /// Rate `dc/dt = -J v` at a fixed point (metres), `v` the velocity of the curve or surface there; metres
    /// per second. Of motions that are functions of time by differences over a part of the time `span`
    /// (seconds).
    pub fn rate(&self, t: f64, span: f64, p: &Vector3<f64>) -> Vector3<f64> {
        match self.moving_frame() {
            Some(motion) => -(self.at(t, p).jacobian * motion.kinematics(t, span).velocity_at(p)),
            None => Vector3::zeros(),
        }
    }

    /// Second derivative by time of `c` along the straight path from a point (metres) with velocity `u`,
    /// metres per second squared: `w^T hessian_i w - J (a + 2 omega x w)`, where `w = u - v` is the velocity
    /// relative to the curve or surface, and `v`, `a` and `omega` are its velocity, acceleration and angular
    /// velocity there.
    pub fn second_rate(
        &self,
        t: f64,
        span: f64,
        p: &Vector3<f64>,
        u: &Vector3<f64>,
    ) -> Vector3<f64> {
        let local = self.at(t, p);
        let bend = |w: &Vector3<f64>| {
            Vector3::from_fn(|i, _| w.dot(&(local.hessian(&Vector3::ith(i, 1.0)) * w)))
        };
        let Some(motion) = self.moving_frame() else {
            return bend(u);
        };
        let frame = motion.kinematics(t, span);
        let w = u - frame.velocity_at(p);
        let apparent = frame.acceleration_at(p) + 2.0 * frame.angular_velocity.cross(&w);
        bend(&w) - local.jacobian * apparent
    }

    /// Distance by which the constraint is broken at a point, metres.
    pub fn violation(&self, t: f64, p: &Vector3<f64>) -> f64 {
        let value = self.at(t, p).value;
        let broken = if self.is_one_sided() {
            (-value.x).max(0.0)
        } else {
            value.norm()
        };
        // `max` passes over a value that is not a number.
        if value.x.is_nan() { f64::NAN } else { broken }
    }
}

impl Locus {
    fn at(&self, p: &Vector3<f64>) -> LocalEquations {
        match self {
            Self::Surface(surface, side) => {
                // One-sided constraints are written c >= 0.
                let sign = if *side == Side::Inside { -1.0 } else { 1.0 };
                let at = surface.at(p);
                let mut jacobian = Matrix3::zeros();
                jacobian.set_row(0, &(sign * at.gradient).transpose());
                LocalEquations {
                    value: Vector3::new(sign * at.level, 0.0, 0.0),
                    jacobian,
                    curvature: Curvature::Surface(sign * at.hessian),
                }
            }
            Self::Curve(curve) => {
                let at = curve.closest(p);
                let value = p - at.position;
                let d = at.denominator(&value);
                LocalEquations {
                    value,
                    jacobian: Matrix3::identity() - at.first * at.first.transpose() / d,
                    curvature: Curvature::Curve(at, Matrix3::identity()),
                }
            }
        }
    }
}

/// The equations of a constraint at a point: `value + jacobian dp + (dp^T hessian_i dp)_i / 2`.
#[derive(Debug, Clone)]
pub struct LocalEquations {
    /// Metres; a surface fills the first entry only.
    pub value: Vector3<f64>,
    /// One equation a row.
    pub jacobian: Matrix3<f64>,
    curvature: Curvature,
}

#[derive(Debug, Clone)]
enum Curvature {
    Surface(Matrix3<f64>),
    /// The closest point in the curve's frame, and the rotation from there to space.
    Curve(CurvePoint, Matrix3<f64>),
}

impl LocalEquations {
    fn turned(mut self, rotation: &Matrix3<f64>) -> Self {
        self.jacobian *= rotation.transpose();
        match &mut self.curvature {
            Curvature::Surface(h) => *h = rotation * *h * rotation.transpose(),
            Curvature::Curve(_, r) => *r = *rotation,
        }
        self
    }

    /// `sum_i w_i hessian_i`, one over metres.
    pub fn hessian(&self, w: &Vector3<f64>) -> Matrix3<f64> {
        match &self.curvature {
            Curvature::Surface(h) => w.x * h,
            Curvature::Curve(at, rotation) => {
                rotation * at.hessian(&self.value, w) * rotation.transpose()
            }
        }
    }

    /// Rows that pick the independent equations: the level, or two directions perpendicular to the curve.
    pub fn independent(&self) -> Matrix2x3<f64> {
        match &self.curvature {
            Curvature::Surface(_) => Matrix2x3::new(1.0, 0.0, 0.0, 0.0, 0.0, 0.0),
            Curvature::Curve(at, _) => {
                let [a, b] = orthonormal_complement(&at.first.normalize());
                Matrix2x3::from_rows(&[a.transpose(), b.transpose()])
            }
        }
    }
}

/// Two unit vectors that are perpendicular to the unit vector `t` and to each other.
pub(crate) fn orthonormal_complement(t: &Vector3<f64>) -> [Vector3<f64>; 2] {
    let mut axis = Vector3::zeros();
    axis[t.iamin()] = 1.0;
    let a = (axis - t * t.dot(&axis)).normalize();
    [a, t.cross(&a)]
}
