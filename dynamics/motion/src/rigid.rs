//! Prescribed rigid motions.

use super::{
    Led, MotionError, check_finite, check_profile, check_profiles, first_difference,
    second_difference, vector_derivatives,
};
use crate::profile::Profile;
use nalgebra::{Isometry3, Translation3, UnitQuaternion, Vector3};
use std::f64::consts::PI;
use std::fmt;
use std::sync::Arc;

/// A pose to be reached at a time.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Keyframe {
    /// Time, seconds.
    pub t: f64,
    /// Position and orientation of the body's frame, metres.
    pub pose: Isometry3<f64>,
}

/// A rotation about an axis that keeps its direction.
#[derive(Debug, Clone, PartialEq)]
pub struct AxisRotation {
    /// A point of the axis as long as the displacement is zero, metres.
    pub centre: [f64; 3],
    /// Direction of the axis, of any length; positive angles turn counter-clockwise seen against it.
    pub axis: [f64; 3],
    /// Angle, radians.
    pub angle: Profile,
}

impl AxisRotation {
    fn validate(&self) -> Result<(), MotionError> {
        check_finite("the centre of the rotation", &self.centre)?;
        check_finite("the axis of the rotation", &self.axis)?;
        if self.direction() == Vector3::zeros() {
            return Err(MotionError::NoAxis);
        }
        check_profile("the angle of the rotation", &self.angle)
    }

    /// The axis as a unit vector; zero if it has no direction.
    fn direction(&self) -> Vector3<f64> {
        Vector3::from(self.axis)
            .try_normalize(0.0)
            .unwrap_or_default()
    }
}

/// A rigid motion composed of profiles: `pose(t) = T(x(t), y(t), z(t)) R(t) pose` with `T` the translation by
/// three profiles and `R` the rotation by an angle about an axis through a centre. The centre moves with the
/// translation, so a rolling body turns about its own axis.
///
/// The sheet meets a body on the straight and evenly turning motion between its poses at the two ends of a
/// step: a step in which it turns by half a turn or more leaves the sense of the rotation open.
#[derive(Debug, Clone, PartialEq)]
pub struct RigidDisplacement {
    /// The pose as long as translation and angle are zero, metres.
    pub pose: Isometry3<f64>,
    /// Translation along x, metres.
    pub x: Profile,
    /// Translation along y, metres.
    pub y: Profile,
    /// Translation along z, metres.
    pub z: Profile,
    /// Rotation, if there is one.
    pub rotation: Option<AxisRotation>,
}

impl Default for RigidDisplacement {
    /// At rest in the frame of space.
    fn default() -> Self {
        Self {
            pose: Isometry3::identity(),
            x: Profile::default(),
            y: Profile::default(),
            z: Profile::default(),
            rotation: None,
        }
    }
}

impl RigidDisplacement {
    /// Rest at a place: the origin of the body's frame, metres, in space.
    ///
    /// ```
    /// use isosheet_motion::{Profile, RigidDisplacement};
    ///
    /// // It rises by 20 mm in the first second.
    /// let rises = RigidDisplacement {
    ///     z: Profile::SmoothStep { from: 0.0, to: 0.02, begin: 0.0, end: 1.0 },
    ///     ..RigidDisplacement::at([0.1, 0.2, 0.0])
    /// };
    /// # let _ = rises;
    /// ```
    pub fn at(place: [f64; 3]) -> Self {
        Self::turned(place, [0.0; 3])
    }

    /// Rest at a place (metres), turned by a rotation vector: an axis in space times an angle, radians.
    pub fn turned(place: [f64; 3], turn: [f64; 3]) -> Self {
        Self {
            pose: Isometry3::new(place.into(), turn.into()),
            ..Self::default()
        }
    }

    fn validate(&self) -> Result<(), MotionError> {
        check_finite(
            "the position of the pose",
            self.pose.translation.vector.as_slice(),
        )?;
        check_finite(
            "the rotation of the pose",
            self.pose.rotation.coords.as_slice(),
        )?;
        check_profiles([&self.x, &self.y, &self.z])?;
        self.rotation
            .as_ref()
            .map_or(Ok(()), AxisRotation::validate)
    }

    fn is_fixed(&self) -> bool {
        [&self.x, &self.y, &self.z].iter().all(|p| p.is_constant())
            && self.rotation.as_ref().is_none_or(|r| r.angle.is_constant())
    }

    fn kinematics(&self, t: f64) -> Kinematics {
        let [shift, velocity, acceleration] = vector_derivatives([&self.x, &self.y, &self.z], t);
        let start = self.pose.translation.vector;
        let Some(rotation) = &self.rotation else {
            let translation = Translation3::from(start + shift);
            return Kinematics {
                pose: Isometry3::from_parts(translation, self.pose.rotation),
                velocity,
                acceleration,
                angular_velocity: Vector3::zeros(),
                angular_acceleration: Vector3::zeros(),
            };
        };
        let (axis, centre) = (rotation.direction(), Vector3::from(rotation.centre));
        let [angle, rate, second_rate] = rotation.angle.derivatives(t);
        let turn = UnitQuaternion::from_scaled_axis(angle * axis);
        let arm = turn * (start - centre);
        let (omega, alpha) = (rate * axis, second_rate * axis);
        Kinematics {
            pose: Isometry3::from_parts((centre + shift + arm).into(), turn * self.pose.rotation),
            velocity: velocity + omega.cross(&arm),
            acceleration: acceleration + alpha.cross(&arm) + omega.cross(&omega.cross(&arm)),
            angular_velocity: omega,
            angular_acceleration: alpha,
        }
    }
}

/// A rigid motion that is given by profiles or by poses.
#[derive(Debug, Clone, PartialEq)]
pub enum RigidProfile {
    /// Translation and rotation by profiles.
    Displacement(Box<RigidDisplacement>),
    /// Through poses, sorted by time. Between two keyframes the origin moves on a straight line at constant
    /// speed and the body turns about a fixed axis at constant rate, the shorter way round. Before the first
    /// and after the last keyframe it rests.
    Keyframes {
        /// The poses of a frame.
        keys: Vec<Keyframe>,
        /// Where the body's frame is in that one, metres; the identity if it is the same.
        body: Isometry3<f64>,
    },
}

impl From<RigidDisplacement> for RigidProfile {
    fn from(displacement: RigidDisplacement) -> Self {
        Self::Displacement(Box::new(displacement))
    }
}

impl From<Vec<Keyframe>> for RigidProfile {
    fn from(keys: Vec<Keyframe>) -> Self {
        let body = Isometry3::identity();
        Self::Keyframes { keys, body }
    }
}

/// Turns closer to half a turn than this have no direction, radians: well above the round-off of a
/// quaternion, well below what anybody specifies.
const HALF_TURN_MARGIN: f64 = 1e-6;

impl RigidProfile {
    /// Rest in a pose.
    pub fn fixed(pose: Isometry3<f64>) -> Self {
        RigidDisplacement {
            pose,
            ..RigidDisplacement::default()
        }
        .into()
    }

    /// Checks poses, profiles and keyframes.
    ///
    /// # Errors
    /// [`MotionError`] naming the first that cannot be used.
    pub fn validate(&self) -> Result<(), MotionError> {
        match self {
            Self::Displacement(displacement) => displacement.validate(),
            Self::Keyframes { keys, body } => {
                check_finite(
                    "the position of the body in its frame",
                    body.translation.vector.as_slice(),
                )?;
                check_finite(
                    "the rotation of the body in its frame",
                    body.rotation.coords.as_slice(),
                )?;
                check_keys(keys)
            }
        }
    }

    /// Whether the body never moves.
    pub fn is_fixed(&self) -> bool {
        match self {
            Self::Displacement(displacement) => displacement.is_fixed(),
            Self::Keyframes { keys, .. } => keys.iter().all(|k| k.pose == keys[0].pose),
        }
    }

    /// Pose, velocities and accelerations at time `t` (seconds), exactly; where one of them jumps, its value
    /// in the motion that begins there.
    pub fn kinematics(&self, t: f64) -> Kinematics {
        match self {
            Self::Displacement(displacement) => displacement.kinematics(t),
            Self::Keyframes { keys, body } => between(keys, t).carried(body),
        }
    }
}

fn check_keys(keys: &[Keyframe]) -> Result<(), MotionError> {
    if keys.is_empty() {
        return Err(MotionError::Empty);
    }
    for (index, key) in keys.iter().enumerate() {
        let t = key.t;
        let mut parts = key.pose.translation.vector.iter();
        let finite = t.is_finite()
            && parts.all(|c| c.is_finite())
            && key.pose.rotation.coords.iter().all(|c| c.is_finite());
        if !finite {
            return Err(MotionError::Keyframe { index, t });
        }
        if index > 0 {
            let before = &keys[index - 1];
            if t <= before.t {
                let previous = before.t;
                return Err(MotionError::Order { index, t, previous });
            }
            let turn = before.pose.rotation.angle_to(&key.pose.rotation);
            if turn > PI - HALF_TURN_MARGIN {
                return Err(MotionError::HalfTurn { index, t });
            }
        }
    }
    Ok(())
}

/// The motion at a time between keyframes.
fn between(keys: &[Keyframe], t: f64) -> Kinematics {
    let after = keys.partition_point(|k| k.t <= t);
    if keys.is_empty() {
        return Kinematics::at_rest(Isometry3::translation(f64::NAN, f64::NAN, f64::NAN));
    }
    if after == 0 || after == keys.len() {
        return Kinematics::at_rest(keys[after.saturating_sub(1)].pose);
    }
    let (a, b) = (&keys[after - 1], &keys[after]);
    let duration = b.t - a.t;
    let s = (t - a.t) / duration;
    let (p, q) = (a.pose.translation.vector, b.pose.translation.vector);
    let turn = a.pose.rotation.rotation_to(&b.pose.rotation).scaled_axis();
    let pose = Isometry3::from_parts(
        Translation3::from(p + s * (q - p)),
        UnitQuaternion::from_scaled_axis(s * turn) * a.pose.rotation,
    );
    Kinematics {
        velocity: (q - p) / duration,
        angular_velocity: turn / duration,
        ..Kinematics::at_rest(pose)
    }
}

/// A function of time (seconds) that returns a pose (metres).
type PoseFunction = dyn Fn(f64) -> Isometry3<f64> + Send + Sync;

/// The prescribed motion of a rigid body, or of a curve or surface.
///
/// Made from a [`RigidProfile`], a [`RigidDisplacement`] or keyframes, whose derivatives are exact, or from a
/// function of time (seconds) that returns the pose (metres; it takes body coordinates to space) and has to
/// be defined a little before the start too: its derivatives are taken by differences.
#[derive(Clone)]
pub enum RigidMotion {
    /// By profiles or keyframes: data that can be written and read.
    Profile(RigidProfile),
    /// Any function of time.
    Custom(Arc<PoseFunction>),
    /// One that a program leads.
    Led(Led<RigidMotion>),
}

impl fmt::Debug for RigidMotion {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Profile(profile) => profile.fmt(f),
            Self::Custom(_) => f.write_str("Custom"),
            Self::Led(led) => led.with(|motion| motion.fmt(f)),
        }
    }
}

impl From<RigidProfile> for RigidMotion {
    fn from(profile: RigidProfile) -> Self {
        Self::Profile(profile)
    }
}

impl From<RigidDisplacement> for RigidMotion {
    fn from(displacement: RigidDisplacement) -> Self {
        Self::Profile(displacement.into())
    }
}

impl From<Vec<Keyframe>> for RigidMotion {
    fn from(keys: Vec<Keyframe>) -> Self {
        Self::Profile(keys.into())
    }
}

impl<F: Fn(f64) -> Isometry3<f64> + Send + Sync + 'static> From<F> for RigidMotion {
    fn from(pose: F) -> Self {
        Self::Custom(Arc::new(pose))
    }
}

impl RigidMotion {
    /// Checks poses, profiles and keyframes. (A function is checked where it is evaluated.)
    ///
    /// # Errors
    /// [`MotionError`] naming the first that cannot be used.
    pub fn validate(&self) -> Result<(), MotionError> {
        match self {
            Self::Profile(profile) => profile.validate(),
            Self::Custom(_) => Ok(()),
            Self::Led(led) => led.with(Self::validate),
        }
    }

    /// Whether the body is known never to move; of a function nothing is known, nor of one that is led.
    pub fn is_fixed(&self) -> bool {
        match self {
            Self::Profile(profile) => profile.is_fixed(),
            Self::Custom(_) | Self::Led(_) => false,
        }
    }

    /// Pose at time `t` (seconds); it takes body coordinates to space.
    pub fn pose(&self, t: f64) -> Isometry3<f64> {
        match self {
            Self::Profile(profile) => profile.kinematics(t).pose,
            Self::Custom(pose) => pose(t),
            Self::Led(led) => led.with(|motion| motion.pose(t)),
        }
    }

    /// Pose, velocities and accelerations at time `t` (seconds): of the profile, or by five-point differences
    /// of the function with spacings of a hundredth (velocities) and a tenth (accelerations) of `span`
    /// (seconds, the step for instance).
    pub fn kinematics(&self, t: f64, span: f64) -> Kinematics {
        let at = match self {
            Self::Profile(profile) => return profile.kinematics(t),
            Self::Custom(pose) => pose,
            Self::Led(led) => return led.with(|motion| motion.kinematics(t, span)),
        };
        let pose = at(t);
        let origin = |s: f64| at(s).translation.vector;
        // The rotation vector from the orientation at `t`: its derivatives there are the angular velocity and
        // acceleration.
        let turn = |s: f64| pose.rotation.rotation_to(&at(s).rotation).scaled_axis();
        Kinematics {
            pose,
            velocity: first_difference(origin, t, span),
            angular_velocity: first_difference(turn, t, span),
            acceleration: second_difference(origin, t, span),
            angular_acceleration: second_difference(turn, t, span),
        }
    }
}

/// Pose, velocities and accelerations of a rigid body at one time.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Kinematics {
    /// Takes body coordinates to space, metres.
    pub pose: Isometry3<f64>,
    /// Velocity of the origin of the body's frame, metres per second.
    pub velocity: Vector3<f64>,
    /// Angular velocity in space, radians per second.
    pub angular_velocity: Vector3<f64>,
    /// Acceleration of the origin of the body's frame, metres per second squared.
    pub acceleration: Vector3<f64>,
    /// Angular acceleration in space, radians per second squared.
    pub angular_acceleration: Vector3<f64>,
}

impl Kinematics {
    fn at_rest(pose: Isometry3<f64>) -> Self {
        let zero = Vector3::zeros();
        Self {
            pose,
            velocity: zero,
            angular_velocity: zero,
            acceleration: zero,
            angular_acceleration: zero,
        }
    }

    /// The motion of a frame that this one carries: its place in this one, metres.
    fn carried(self, place: &Isometry3<f64>) -> Self {
        let pose = self.pose * place;
        let at = pose.translation.vector;
        Self {
            pose,
            velocity: self.velocity_at(&at),
            acceleration: self.acceleration_at(&at),
            ..self
        }
    }

    /// Velocity of the body's point that is at `p` (metres, in space) now, `v + w x r` with `r = p - origin`;
    /// metres per second.
    pub fn velocity_at(&self, p: &Vector3<f64>) -> Vector3<f64> {
        self.velocity + self.angular_velocity.cross(&self.arm(p))
    }

    /// Acceleration of the body's point that is at `p` (metres, in space) now, `a + w' x r + w x (w x r)`
    /// with `r = p - origin`; metres per second squared.
    pub fn acceleration_at(&self, p: &Vector3<f64>) -> Vector3<f64> {
        let (arm, w) = (self.arm(p), &self.angular_velocity);
        self.acceleration + self.angular_acceleration.cross(&arm) + w.cross(&w.cross(&arm))
    }

    fn arm(&self, p: &Vector3<f64>) -> Vector3<f64> {
        p - self.pose.translation.vector
    }
}
