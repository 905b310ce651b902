//! Where things are and how they move.

use crate::time::poses::{FramePose, Poses, TimedPose};
use crate::time::profile::ProfileKey;
use crate::words::key::Key;
use crate::words::part::Part;
use crate::words::problem::Checks;
use crate::words::unit::Unit;
use isosheet_dynamics::{AxisRotation, PointMotion, PointProfile, RigidDisplacement, RigidProfile};
use nalgebra::{Isometry3, Point3, Translation3, UnitQuaternion, Vector3};
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

/// A rotation about an axis through the origin, by the right-hand rule.
///
/// ```toml
/// [sheet.placement]
/// turn = { axis = [0, 0, 1], angle = 45 }
/// ```
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema, Part)]
#[serde(deny_unknown_fields)]
pub struct Turn {
    /// Direction of the axis, of any length.
    pub axis: [f64; 3],
    /// Angle, degrees.
    pub angle: f64,
}

/// A pose: first the turn about the origin, then the translation.
///
/// ```toml
/// [sheet]
/// placement = { position = [0, 0, 0.3], turn = { axis = [1, 0, 0], angle = 90 } }
/// ```
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize, JsonSchema, Part)]
#[serde(default, deny_unknown_fields)]
#[checked]
pub struct Pose {
    /// Where the origin comes to lie, metres.
    pub position: [f64; 3],
    /// The turn, if there is one.
    pub turn: Option<Turn>,
}

impl Pose {
    /// A translation (metres).
    pub fn at(position: [f64; 3]) -> Self {
        Self {
            position,
            turn: None,
        }
    }

    /// The pose as a map from the frame of what is placed to space.
    pub fn isometry(&self) -> Isometry3<f64> {
        let translation = Translation3::from(self.position);
        let rotation = self.turn.as_ref().map(|turn| {
            let axis = Vector3::from(turn.axis).normalize();
            UnitQuaternion::from_scaled_axis(turn.angle.to_radians() * axis)
        });
        Isometry3::from_parts(translation, rotation.unwrap_or_default())
    }

    /// Where a point comes to lie, metres, by the formula of Rodrigues: quarter turns about a coordinate axis
    /// are exact.
    pub fn place(&self, p: [f64; 3]) -> [f64; 3] {
        let p = Vector3::from(p);
        let turned = self.turn.as_ref().map_or(p, |turn| {
            let axis = Vector3::from(turn.axis).normalize();
            let (sin, cos) = sin_cos(turn.angle);
            cos * p + sin * axis.cross(&p) + (1.0 - cos) * axis.dot(&p) * axis
        });
        (turned + Vector3::from(self.position)).into()
    }

    pub(crate) fn check(&self, key: &Key, checks: &mut Checks) {
        checks.finite(key.name("position"), &self.position, Unit::Metre);
        if let Some(turn) = &self.turn {
            checks.direction(key.name("turn.axis"), &turn.axis);
            checks.number(key.name("turn.angle"), turn.angle, Unit::Degree);
        }
    }
}

/// Sine and cosine of an angle in degrees, exact for quarter turns.
fn sin_cos(degrees: f64) -> (f64, f64) {
    match degrees.rem_euclid(360.0) {
        0.0 => (0.0, 1.0),
        90.0 => (1.0, 0.0),
        180.0 => (0.0, -1.0),
        270.0 => (-1.0, 0.0),
        _ => degrees.to_radians().sin_cos(),
    }
}

/// A prescribed rigid motion: a rotation, then a translation by three displacements; or through poses.
///
/// ```toml
/// [[support]]
/// at = { vertices = [0] }
///
/// [support.hold.moving_pin]
/// z = { smooth_step = { to = 0.1, end = 1 } }
/// rotation = { centre = [0, 0, 0], axis = [1, 0, 0], angle = { ramp = { to = 90, end = 1 } } }
/// ```
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize, JsonSchema, Part)]
#[serde(default, deny_unknown_fields)]
#[checked]
pub struct MotionKey {
    /// Displacement along x, metres.
    #[unit(Metre)]
    pub x: ProfileKey,
    /// Displacement along y, metres.
    #[unit(Metre)]
    pub y: ProfileKey,
    /// Displacement along z, metres.
    #[unit(Metre)]
    pub z: ProfileKey,
    /// The rotation, if there is one.
    pub rotation: Option<Rotation>,
    /// Poses in place of displacements and rotation.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub poses: Option<Poses>,
}

/// A rotation about an axis of fixed direction. The axis moves with the translation.
///
/// ```toml
/// [[obstacle]]
/// shape = { cylinder = { radius = 0.05, height = 0.5 } }
///
/// [obstacle.motion]
/// rotation = { centre = [0, 0, 0], axis = [0, 0, 1], angle = { run_up = { rate = 90, end = 0.5 } } }
/// ```
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema, Part)]
#[serde(deny_unknown_fields)]
pub struct Rotation {
    /// A point of the axis at zero displacement, metres.
    pub centre: [f64; 3],
    /// Direction of the axis, of any length; positive angles turn counter-clockwise seen against it.
    pub axis: [f64; 3],
    /// Angle, degrees.
    #[unit(Degree)]
    pub angle: ProfileKey,
}

impl MotionKey {
    /// The motion of a body that is in a pose while displacements and angle are zero.
    pub(crate) fn of_body(&self, pose: Isometry3<f64>) -> RigidProfile {
        if let Some(poses) = &self.poses {
            return poses.of_body(pose);
        }
        RigidProfile::from(RigidDisplacement {
            pose,
            x: self.x.as_given(),
            y: self.y.as_given(),
            z: self.z.as_given(),
            rotation: self.rotation.as_ref().map(|r| AxisRotation {
                centre: r.centre,
                axis: r.axis,
                angle: r.angle.as_angle(),
            }),
        })
    }

    /// The motion of a pinned vertex that starts at `p`.
    pub(crate) fn of_pin(&self, p: [f64; 3]) -> PointMotion {
        if !self.turns() {
            return PointMotion::from(PointProfile {
                offset: p,
                x: self.x.as_given(),
                y: self.y.as_given(),
                z: self.z.as_given(),
            });
        }
        let rigid = self.of_body(Isometry3::identity());
        PointMotion::from(move |t: f64| -> [f64; 3] {
            (rigid.kinematics(t).pose * Point3::from(p)).coords.into()
        })
    }

    /// Whether what moves can turn.
    pub(crate) fn turns(&self) -> bool {
        self.rotation.is_some() || self.poses.is_some()
    }

    /// The motion that goes from its pose at time `from` (seconds) to another one of its frame until time
    /// `to`, and rests there. `rest` is the frame while nothing is displaced, where the motion has no poses
    /// yet.
    pub(crate) fn led(&self, pose: FramePose, rest: Isometry3<f64>, [from, to]: [f64; 2]) -> Self {
        let frame = self.poses.as_ref().map(Poses::frame);
        let frame = frame.unwrap_or(rest.into());
        Self::through(frame, vec![self.pose_of(frame, from), pose.at(to)])
    }

    /// Where a frame is at time `t`, seconds.
    pub fn pose_of(&self, frame: FramePose, t: f64) -> TimedPose {
        FramePose::from(self.of_body(frame.isometry()).kinematics(t).pose).at(t)
    }

    /// The motion through poses of a frame.
    pub fn through(frame: FramePose, keys: Vec<TimedPose>) -> Self {
        let frame = Some(frame);
        Self {
            poses: Some(Poses {
                keys,
                frame,
                kinks: None,
            }),
            ..Self::default()
        }
    }

    pub(crate) fn check(&self, key: &Key, checks: &mut Checks) {
        if let Some(rotation) = &self.rotation {
            let key = key.name("rotation");
            checks.finite(key.name("centre"), &rotation.centre, Unit::Metre);
            checks.direction(key.name("axis"), &rotation.axis);
        }
        if self.poses.is_some() {
            let others = Self {
                poses: None,
                ..self.clone()
            };
            if others != Self::default() {
                let message = "poses stand in place of `x`, `y`, `z` and `rotation`, which the motion has, too";
                checks.report(key.name("poses"), message, "leave out one or the other");
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The formula of Rodrigues is the rotation by a quaternion, and upright sheets are upright to the last
    /// bit.
    #[test]
    fn sheets_are_placed_as_bodies_are_and_quarter_turns_are_exact() {
        let pose = |axis, angle| Pose {
            position: [0.1, -0.2, 0.3],
            turn: Some(Turn { axis, angle }),
        };
        let p = [0.7, 0.4, -0.9];
        for angle in [-500.0, -90.0, 0.0, 33.0, 90.0, 180.0, 270.0, 450.0] {
            let pose = pose([1.0, 2.0, -0.5], angle);
            let placed = Vector3::from(pose.place(p));
            let expected = pose.isometry() * Point3::from(p);
            assert!((placed - expected.coords).norm() < 1e-14, "{angle}");
        }
        for (angle, expected) in [
            (90.0, [0.0, -3.0, 2.0]),
            (180.0, [0.0, -2.0, -3.0]),
            (-90.0, [0.0, 3.0, -2.0]),
            (360.0, [0.0, 2.0, 3.0]),
        ] {
            let upright = Pose {
                position: [0.0; 3],
                ..pose([2.0, 0.0, 0.0], angle)
            };
            assert_eq!(upright.place([0.0, 2.0, 3.0]), expected, "{angle}");
        }
    }
}
