//! What holds the sheet.

use crate::holding::switch::When;
use crate::meshes::selection::Selection;
use crate::meshes::sequence::Sequence;
use crate::time::pose::MotionKey;
use crate::words::key::Key;
use crate::words::part::{Part, all};
use crate::words::problem::{Checks, Problem};
use crate::words::unit::Unit;
use isosheet_dynamics::constraint::{
    Circle, ConstraintError, Cylinder, Line, Plane, Polyline, Side, Sphere, Spline,
};
use isosheet_dynamics::{RigidMotion, VertexConstraint};
use isosheet_mesh::VertexId;
use nalgebra::{Isometry3, Point3};
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

/// Vertices that are held in one way.
///
/// ```toml
/// [[support]]
/// at = { vertices = [0, 4] }
///
/// [[support]]
/// at = "boundary"
/// hold = { surface = { shape = { plane = { point = [0, 0, 0], normal = [0, 0, 1] } } } }
/// ```
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema, Part)]
#[serde(deny_unknown_fields)]
#[checked]
pub struct SupportKey {
    /// The name of the sheet, if there are several and not the vertices of all are meant.
    #[serde(default)]
    pub sheet: Option<String>,
    /// Which vertices.
    pub at: Selection,
    /// How they are held.
    #[serde(default)]
    pub hold: Hold,
    /// When it is taken up; if left out, at the start. It then holds the vertices where they are at that
    /// moment, and moves on from there by as much as its motion, at the time of the scene, changes
    /// afterwards; a curve or a surface has to be where they are.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub from: Option<When>,
    /// When it is released; if left out, never.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub until: Option<When>,
}

/// How vertices are held.
///
/// ```toml
/// [[support]]
/// at = { vertices = [0] }
/// hold = { moving_pin = { x = { smooth_step = { to = 0.05, end = 0.5 } } } }
/// ```
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize, JsonSchema, Part)]
#[serde(rename_all = "snake_case", deny_unknown_fields)]
pub enum Hold {
    /// Where they are at the start.
    #[default]
    Pin,
    /// In a prescribed motion, which is zero at the start: all vertices move as one rigid body.
    MovingPin(MotionKey),
    /// As vertices of a mesh in motion move: each keeps the distance and the direction from its vertex there
    /// that it has at the start.
    Follow {
        /// The mesh in motion.
        sequence: Sequence,
        /// Which of its vertices they follow.
        #[serde(default)]
        vertices: Followed,
    },
    /// Clamped where they are at the start: the sheet keeps the slope that it has there, along the edges
    /// between the vertices. A plate needs one line of vertices. In other sheets the faces along the line are
    /// pinned, which shortens the free part by their height.
    Clamp,
    /// Clamped, in a prescribed motion, which is zero at the start: all vertices and the slopes move as one
    /// rigid body.
    MovingClamp(MotionKey),
    /// Clamped, and free to slide along a direction without friction. For plates.
    SlidingClamp {
        /// The direction, of any length.
        direction: [f64; 3],
        /// The motion of clamp and direction.
        #[serde(default)]
        motion: MotionKey,
    },
    /// On a curve, along which they slide without friction. They have to be on it at the start.
    Curve {
        /// The curve.
        shape: CurveKey,
        /// Its motion.
        #[serde(default)]
        motion: MotionKey,
    },
    /// On a surface or on one side of it, without friction. They have to be there at the start.
    Surface {
        /// The surface.
        shape: SurfaceKey,
        /// On which side the vertices may be.
        #[serde(default)]
        side: SurfaceSide,
        /// Its motion.
        #[serde(default)]
        motion: MotionKey,
    },
}

/// Which vertices of a mesh in motion are followed.
///
/// ```toml
/// [[support]]
/// at = { group = "waistband" }
/// hold = { follow = { sequence = { path = "body.npz" }, vertices = "nearest" } }
/// ```
#[derive(Clone, Debug, Default, PartialEq, Eq, Serialize, Deserialize, JsonSchema, Part)]
#[serde(rename_all = "snake_case", deny_unknown_fields)]
pub enum Followed {
    /// Each vertex follows the vertex that is nearest at the start.
    #[default]
    Nearest,
    /// Each vertex follows the vertex of its own number, as in the sheet that it belongs to.
    SameNumber,
    /// Vertices by their numbers, from 0: one for each vertex that is held, in the order of the numbers of
    /// these.
    Numbers(Vec<usize>),
}

/// A curve.
///
/// ```toml
/// [[support]]
/// at = { vertices = [0] }
/// hold = { curve = { shape = { line = { point = [0, 0, 0], direction = [1, 0, 0] } } } }
/// ```
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema, Part)]
#[serde(rename_all = "snake_case", deny_unknown_fields)]
#[checked]
pub enum CurveKey {
    /// A straight line without ends.
    Line {
        /// A point of it, metres.
        point: [f64; 3],
        /// Its direction, of any length.
        direction: [f64; 3],
    },
    /// A circle.
    Circle {
        /// Centre, metres.
        centre: [f64; 3],
        /// Normal of its plane, of any length.
        normal: [f64; 3],
        /// Radius, metres.
        radius: f64,
    },
    /// Straight lines between points, with rounded corners.
    Polyline {
        /// The points, metres.
        points: Vec<[f64; 3]>,
        /// Radius of the corners, metres.
        corner_radius: f64,
    },
    /// A smooth curve through points.
    Spline {
        /// The points, metres.
        points: Vec<[f64; 3]>,
    },
    /// A smooth closed curve through points.
    ClosedSpline {
        /// The points, metres; the first is not repeated.
        points: Vec<[f64; 3]>,
    },
}

impl CurveKey {
    fn check(&self, key: &Key, checks: &mut Checks) {
        let (key, before) = (&key.name(self.name()), checks.problems.len());
        match self {
            Self::Line { point, direction } => {
                checks.finite(key.name("point"), point, Unit::Metre);
                checks.direction(key.name("direction"), direction);
            }
            Self::Circle {
                centre,
                normal,
                radius,
            } => {
                checks.finite(key.name("centre"), centre, Unit::Metre);
                checks.direction(key.name("normal"), normal);
                checks.positive(key.name("radius"), *radius, Unit::Metre);
            }
            Self::Polyline {
                points,
                corner_radius,
            } => {
                checks.points(key.name("points"), points);
                checks.positive(key.name("corner_radius"), *corner_radius, Unit::Metre);
            }
            Self::Spline { points } | Self::ClosedSpline { points } => {
                checks.points(key.name("points"), points);
            }
        }
        // What no number alone is to blame for.
        if checks.problems.len() == before
            && let Err(error) = self.constrain(VertexId(0))
        {
            checks
                .problems
                .push(Problem::from_error(key.clone(), &error));
        }
    }
}

/// A surface.
///
/// ```toml
/// [[support]]
/// at = { vertices = [0] }
/// hold = { surface = { shape = { plane = { point = [0, 0, 0], normal = [0, 0, 1] } }, side = "outside" } }
/// ```
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema, Part)]
#[serde(rename_all = "snake_case", deny_unknown_fields)]
#[checked]
pub enum SurfaceKey {
    /// A plane.
    Plane {
        /// A point of it, metres.
        point: [f64; 3],
        /// Its normal, of any length, which points outside.
        normal: [f64; 3],
    },
    /// A sphere.
    Sphere {
        /// Centre, metres.
        centre: [f64; 3],
        /// Radius, metres.
        radius: f64,
    },
    /// A cylinder without ends.
    Cylinder {
        /// A point of its axis, metres.
        point: [f64; 3],
        /// Direction of its axis, of any length.
        axis: [f64; 3],
        /// Radius, metres.
        radius: f64,
    },
}

impl SurfaceKey {
    fn check(&self, key: &Key, checks: &mut Checks) {
        let (key, before) = (&key.name(self.name()), checks.problems.len());
        match self {
            Self::Plane { point, normal } => {
                checks.finite(key.name("point"), point, Unit::Metre);
                checks.direction(key.name("normal"), normal);
            }
            Self::Sphere { centre, radius } => {
                checks.finite(key.name("centre"), centre, Unit::Metre);
                checks.positive(key.name("radius"), *radius, Unit::Metre);
            }
            Self::Cylinder {
                point,
                axis,
                radius,
            } => {
                checks.finite(key.name("point"), point, Unit::Metre);
                checks.direction(key.name("axis"), axis);
                checks.positive(key.name("radius"), *radius, Unit::Metre);
            }
        }
        // What no number alone is to blame for.
        if checks.problems.len() == before
            && let Err(error) = self.constrain(VertexId(0), Side::On)
        {
            checks
                .problems
                .push(Problem::from_error(key.clone(), &error));
        }
    }
}

/// On which side of a surface vertices may be.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize, JsonSchema, Part)]
#[serde(rename_all = "snake_case")]
pub enum SurfaceSide {
    /// On the surface.
    #[default]
    On,
    /// On it or outside.
    Outside,
    /// On it or inside.
    Inside,
}

impl SupportKey {
    /// Vertices that stay where they are at the start.
    pub fn pin(at: Selection) -> Self {
        Self {
            sheet: None,
            at,
            hold: Hold::Pin,
            from: None,
            until: None,
        }
    }

    pub(crate) fn check(&self, key: &Key, checks: &mut Checks) {
        match &self.hold {
            Hold::Follow { .. } if self.from.is_some() => {
                let message = "a support that follows a mesh in motion cannot be taken up in the course of a run";
                let remedy =
                    "leave `from` out, or follow the mesh from the start; `until` may release it";
                checks.report(key.name("from"), message, remedy);
            }
            Hold::SlidingClamp { direction, .. } => {
                checks.direction(key.name("hold.sliding_clamp.direction"), direction);
            }
            _ => {}
        }
    }
}

impl Hold {
    /// Whether vertices have no motion of their own.
    pub(crate) fn is_pin(&self) -> bool {
        match self {
            Self::Pin
            | Self::MovingPin(_)
            | Self::Follow { .. }
            | Self::Clamp
            | Self::MovingClamp(_) => true,
            Self::SlidingClamp { .. } | Self::Curve { .. } | Self::Surface { .. } => false,
        }
    }

    /// Whether vertices stay where they are at the start.
    pub(crate) fn is_at_rest(&self) -> bool {
        matches!(self, Self::Pin | Self::Clamp)
    }

    /// Its motion, if it has one.
    fn motion(&self) -> Option<&MotionKey> {
        let found = all(self, Key::root()).pop();
        found.map(|(_, motion)| motion)
    }

    /// Where vertices are while its motion is zero, of positions `x` (`3V`, metres) at time `t`, seconds.
    pub(crate) fn at_rest(&self, t: f64, x: &[f64]) -> Vec<f64> {
        let Some(motion) = self.motion().and_then(frame_motion) else {
            return x.to_vec();
        };
        let back = motion.pose(t).inverse();
        let points = x.as_chunks::<3>().0.iter();
        let moved = points.map(|p| <[f64; 3]>::from((back * Point3::from(*p)).coords));
        moved.flatten().collect()
    }

    /// The motion of the slopes that it holds, if it does.
    pub(crate) fn clamp_motion(&self) -> Option<MotionKey> {
        match self {
            Self::Clamp => Some(MotionKey::default()),
            Self::MovingClamp(motion) | Self::SlidingClamp { motion, .. } => Some(motion.clone()),
            Self::Pin
            | Self::MovingPin(_)
            | Self::Follow { .. }
            | Self::Curve { .. }
            | Self::Surface { .. } => None,
        }
    }
}

impl CurveKey {
    fn name(&self) -> &'static str {
        match self {
            Self::Line { .. } => "line",
            Self::Circle { .. } => "circle",
            Self::Polyline { .. } => "polyline",
            Self::Spline { .. } => "spline",
            Self::ClosedSpline { .. } => "closed_spline",
        }
    }

    pub(crate) fn constrain(&self, vertex: VertexId) -> Result<VertexConstraint, ConstraintError> {
        Ok(match self {
            Self::Line { point, direction } => {
                VertexConstraint::on_curve(vertex, Line::new(*point, *direction)?)
            }
            Self::Circle {
                centre,
                normal,
                radius,
            } => VertexConstraint::on_curve(vertex, Circle::new(*centre, *normal, *radius)?),
            Self::Polyline {
                points,
                corner_radius,
            } => VertexConstraint::on_curve(vertex, Polyline::new(points, *corner_radius)?),
            Self::Spline { points } => VertexConstraint::on_curve(vertex, Spline::open(points)?),
            Self::ClosedSpline { points } => {
                VertexConstraint::on_curve(vertex, Spline::closed(points)?)
            }
        })
    }
}

impl SurfaceKey {
    fn name(&self) -> &'static str {
        match self {
            Self::Plane { .. } => "plane",
            Self::Sphere { .. } => "sphere",
            Self::Cylinder { .. } => "cylinder",
        }
    }

    pub(crate) fn constrain(
        &self,
        vertex: VertexId,
        side: Side,
    ) -> Result<VertexConstraint, ConstraintError> {
        Ok(match self {
            Self::Plane { point, normal } => {
                VertexConstraint::on_surface(vertex, Plane::new(*point, *normal)?, side)
            }
            Self::Sphere { centre, radius } => {
                VertexConstraint::on_surface(vertex, Sphere::new(*centre, *radius)?, side)
            }
            Self::Cylinder {
                point,
                axis,
                radius,
            } => VertexConstraint::on_surface(vertex, Cylinder::new(*point, *axis, *radius)?, side),
        })
    }
}

impl SurfaceSide {
    pub(crate) fn as_engine(self) -> Side {
        match self {
            Self::On => Side::On,
            Self::Outside => Side::Outside,
            Self::Inside => Side::Inside,
        }
    }
}

/// The motion of a curve or surface, if it has any.
pub fn frame_motion(motion: &MotionKey) -> Option<RigidMotion> {
    (*motion != MotionKey::default()).then(|| motion.of_body(Isometry3::identity()).into())
}
