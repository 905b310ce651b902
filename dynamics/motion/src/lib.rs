//! Functions of time, and the prescribed motions of points and of rigid bodies that are made of them.
//!
//! A [`Profile`] is a scalar function of time with exact derivatives. A [`PointMotion`] is three of them or
//! any function, a [`RigidMotion`] is made of profiles, of poses at given times, or of any function. SI
//! units, angles in radians.

mod led;
mod profile;
mod rigid;
#[cfg(test)]
mod tests;

pub use led::Led;
pub use profile::{Interpolation, Profile, ProfileError};
pub use rigid::{AxisRotation, Keyframe, Kinematics, RigidDisplacement, RigidMotion, RigidProfile};

use isosheet_mesh::Advice;
use isosheet_mesh::wording::given;
use nalgebra::Vector3;
use std::fmt;
use std::sync::Arc;

/// Why a motion cannot be used.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum MotionError {
    /// A number is not finite.
    #[error("{name} has the component {value}", value = given(*value))]
    NotFinite {
        /// The vector or rotation.
        name: &'static str,
        /// The first component that is not finite.
        value: f64,
    },
    /// One of the profiles cannot be used.
    #[error("{name}: {source}")]
    Profile {
        /// The profile.
        name: &'static str,
        /// What is wrong with it.
        source: ProfileError,
    },
    /// The axis of a rotation has no direction.
    #[error("the axis of the rotation is zero")]
    NoAxis,
    /// There are no keyframes.
    #[error("the motion has no keyframes")]
    Empty,
    /// A time or pose is not finite.
    #[error("keyframe {index} at t = {t} s has a time or pose that is not finite", t = given(*t))]
    Keyframe {
        /// The keyframe, from 0.
        index: usize,
        /// Its time, seconds.
        t: f64,
    },
    /// Times do not increase.
    #[error(
        "keyframe {index} at t = {t} s does not come after t = {previous} s",
        t = given(*t), previous = given(*previous)
    )]
    Order {
        /// The keyframe, from 0.
        index: usize,
        /// Its time, seconds.
        t: f64,
        /// The time of the keyframe before, seconds.
        previous: f64,
    },
    /// The sense of a rotation is ambiguous.
    #[error("the body turns by half a turn up to keyframe {index} at t = {t} s", t = given(*t))]
    HalfTurn {
        /// The keyframe, from 0.
        index: usize,
        /// Its time, seconds.
        t: f64,
    },
}

impl Advice for MotionError {
    fn advice(&self) -> Option<&'static str> {
        match self {
            Self::NotFinite { .. } | Self::Keyframe { .. } => Some("give finite numbers"),
            Self::Profile { source, .. } => source.advice(),
            Self::NoAxis => Some("give a direction"),
            Self::Empty => Some("give at least one"),
            Self::Order { .. } => Some("sort the keyframes by time"),
            Self::HalfTurn { .. } => Some("add a keyframe between that says which way"),
        }
    }
}

/// The prescribed motion of a point by profiles: `offset + (x(t), y(t), z(t))`.
///
/// ```
/// use isosheet_motion::{PointProfile, Profile};
///
/// let lift = PointProfile {
///     offset: [0.2, 0.0, 0.1],
///     z: Profile::SmoothStep { from: 0.0, to: 0.05, begin: 0.0, end: 1.0 },
///     ..PointProfile::default()
/// };
/// assert_eq!(lift.position(2.0), [0.2, 0.0, 0.1 + 0.05]);
/// ```
#[derive(Debug, Clone, PartialEq, Default)]
pub struct PointProfile {
    /// Where the point is as long as the displacement is zero, metres: with profiles that begin at zero,
    /// where the vertex is in the start state.
    pub offset: [f64; 3],
    /// Displacement along x, metres.
    pub x: Profile,
    /// Displacement along y, metres.
    pub y: Profile,
    /// Displacement along z, metres.
    pub z: Profile,
}

impl PointProfile {
    /// Checks the offset and the profiles.
    ///
    /// # Errors
    /// [`MotionError`] naming the first that cannot be used.
    pub fn validate(&self) -> Result<(), MotionError> {
        check_finite("the offset of the motion", &self.offset)?;
        check_profiles([&self.x, &self.y, &self.z])
    }

    /// Position at time `t` (seconds), metres.
    pub fn position(&self, t: f64) -> [f64; 3] {
        let displacement = self.derivatives(t)[0];
        std::array::from_fn(|k| self.offset[k] + displacement[k])
    }

    /// Displacement, velocity and acceleration.
    fn derivatives(&self, t: f64) -> [Vector3<f64>; 3] {
        vector_derivatives([&self.x, &self.y, &self.z], t)
    }
}

/// A function of time (seconds) that returns a position (metres).
type PointFunction = dyn Fn(f64) -> [f64; 3] + Send + Sync;

/// The prescribed motion of a point.
///
/// Made from a [`PointProfile`], whose derivatives are exact, or from a function of time (seconds) that
/// returns the position (metres) and has to be defined a little before the start too: its derivatives are
/// taken by differences.
#[derive(Clone)]
pub enum PointMotion {
    /// By profiles: data that can be written and read.
    Profile(PointProfile),
    /// Any function of time.
    Custom(Arc<PointFunction>),
    /// One that a program leads.
    Led(Led<PointMotion>),
}

impl fmt::Debug for PointMotion {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Profile(profile) => profile.fmt(f),
            Self::Custom(_) => f.write_str("Custom"),
            Self::Led(led) => led.with(|motion| motion.fmt(f)),
        }
    }
}

impl From<PointProfile> for PointMotion {
    fn from(profile: PointProfile) -> Self {
        Self::Profile(profile)
    }
}

impl<F: Fn(f64) -> [f64; 3] + Send + Sync + 'static> From<F> for PointMotion {
    fn from(position: F) -> Self {
        Self::Custom(Arc::new(position))
    }
}

impl PointMotion {
    /// Checks the profiles. (A function is checked where it is evaluated.)
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

    /// Position at time `t` (seconds), metres.
    pub fn position(&self, t: f64) -> [f64; 3] {
        match self {
            Self::Profile(profile) => profile.position(t),
            Self::Custom(position) => position(t),
            Self::Led(led) => led.with(|motion| motion.position(t)),
        }
    }

    /// Velocity at time `t` (seconds), metres per second: that of the profiles, or by five-point differences
    /// of the function with a spacing of a hundredth of `span` (seconds, the step for instance).
    pub fn velocity(&self, t: f64, span: f64) -> Vector3<f64> {
        match self {
            Self::Profile(profile) => profile.derivatives(t)[1],
            Self::Custom(at) => first_difference(|s| at(s).into(), t, span),
            Self::Led(led) => led.with(|motion| motion.velocity(t, span)),
        }
    }

    /// Acceleration at time `t` (seconds), metres per second squared: that of the profiles, or by five-point
    /// differences of the function with a spacing of a tenth of `span` (seconds).
    pub fn acceleration(&self, t: f64, span: f64) -> Vector3<f64> {
        match self {
            Self::Profile(profile) => profile.derivatives(t)[2],
            Self::Custom(at) => second_difference(|s| at(s).into(), t, span),
            Self::Led(led) => led.with(|motion| motion.acceleration(t, span)),
        }
    }
}

/// Values, rates and accelerations of three profiles.
fn vector_derivatives(profiles: [&Profile; 3], t: f64) -> [Vector3<f64>; 3] {
    let axes = profiles.map(|p| p.derivatives(t));
    std::array::from_fn(|order| Vector3::from_fn(|k, _| axes[k][order]))
}

fn check_finite(name: &'static str, numbers: &[f64]) -> Result<(), MotionError> {
    match numbers.iter().find(|c| !c.is_finite()) {
        Some(&value) => Err(MotionError::NotFinite { name, value }),
        None => Ok(()),
    }
}

fn check_profile(name: &'static str, profile: &Profile) -> Result<(), MotionError> {
    profile
        .validate()
        .map_err(|source| MotionError::Profile { name, source })
}

fn check_profiles([x, y, z]: [&Profile; 3]) -> Result<(), MotionError> {
    check_profile("the displacement along x", x)?;
    check_profile("the displacement along y", y)?;
    check_profile("the displacement along z", z)
}

/// Spacing of first differences in time, relative to the step: their truncation error is 1e-8 of the fifth
/// derivative's part in the motion over a step.
const FIRST_SPACING: f64 = 1e-2;

/// First derivative of a motion by five-point differences.
fn first_difference(at: impl Fn(f64) -> Vector3<f64>, t: f64, span: f64) -> Vector3<f64> {
    let d = FIRST_SPACING * span.abs();
    let near = at(t + d) - at(t - d);
    let far = at(t + 2.0 * d) - at(t - 2.0 * d);
    (8.0 * near - far) / (12.0 * d)
}

/// Spacing of second differences in time, relative to the step: round-off is 1e-14 of a motion over its
/// squared step, truncation 1e-6 of the sixth derivative's part.
const SECOND_SPACING: f64 = 0.1;

/// Second derivative of a motion by five-point differences.
fn second_difference(at: impl Fn(f64) -> Vector3<f64>, t: f64, span: f64) -> Vector3<f64> {
    let d = SECOND_SPACING * span.abs();
    let near = at(t + d) + at(t - d);
    let far = at(t + 2.0 * d) + at(t - 2.0 * d);
    (16.0 * near - far - 30.0 * at(t)) / (12.0 * d * d)
}

/// The code of the README is compiled and run as a test.
#[cfg(doctest)]
#[doc = include_str!("../README.md")]
struct Readme;
