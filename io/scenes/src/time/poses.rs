//! Motions through poses.

use crate::words::key::Key;
use crate::words::part::Part;
use crate::words::problem::{Checks, Problem};
use crate::words::unit::Unit;
use isosheet_dynamics::{Keyframe, MotionError, RigidProfile};
use isosheet_mesh::wording::{brief, given};
use nalgebra::{Isometry3, Quaternion, UnitQuaternion};
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

/// By how much the norm of a quaternion may differ from one: numbers in single precision leave up to 6e-8 of
/// it, six decimals 1e-6.
const ROUND_OFF: f64 = 1e-6;

/// A motion through poses of a frame, which carries what moves. Between two of them the origin of the frame
/// goes straight at constant speed, and the frame turns about one axis at a constant rate, the shorter way
/// round. It rests before the first and after the last.
///
/// ```toml
/// [[support]]
/// at = { box = { min = [0, 0, 0], max = [0, 0.1, 0] } }
///
/// [support.hold.moving_clamp.poses]
/// keys = [
///     { position = [0, 0.05, 0] },
///     { time = 1, position = [0, 0.05, 0.1], orientation = [0.9238795, 0, 0.3826834, 0] },
/// ]
/// ```
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema, Part)]
#[serde(deny_unknown_fields)]
#[checked]
pub struct Poses {
    /// The poses, in the order of time.
    pub keys: Vec<TimedPose>,
    /// The frame while an obstacle is in its `pose`, or vertices are where they start. By default the frame
    /// of the first key.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub frame: Option<FramePose>,
    /// The times at which the velocity really jumps, seconds: there the method begins anew. If left out, at
    /// each pose; a smooth motion that was sampled has none, `[]`.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub kinks: Option<Vec<f64>>,
}

/// The pose of a frame.
///
/// ```toml
/// [[obstacle]]
/// shape = { box = { size = [0.1, 0.1, 0.02] } }
///
/// [obstacle.motion.poses]
/// frame = { position = [0, 0, 0] }
/// keys = [
///     { time = 0, position = [0, 0, 0] },
///     { time = 1, position = [0, 0, 0.1], orientation = [0.7071068, 0, 0, 0.7071068] },
/// ]
/// ```
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize, JsonSchema, Part)]
#[serde(deny_unknown_fields)]
pub struct FramePose {
    /// Its origin, metres.
    pub position: [f64; 3],
    /// Its orientation, a unit quaternion `w, x, y, z` that takes directions of the frame to directions of
    /// space.
    #[serde(default = "unturned")]
    pub orientation: [f64; 4],
}

/// The pose of a frame at a time.
///
/// ```toml
/// [[obstacle]]
/// shape = { sphere = { radius = 0.05 } }
/// motion = { poses = { keys = [{ position = [0, 0, 0] }, { time = 1, position = [0.1, 0, 0] }] } }
/// ```
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize, JsonSchema, Part)]
#[serde(deny_unknown_fields)]
pub struct TimedPose {
    /// When, seconds.
    #[serde(default)]
    pub time: f64,
    /// Its origin, metres.
    pub position: [f64; 3],
    /// Its orientation, a unit quaternion `w, x, y, z` that takes directions of the frame to directions of
    /// space.
    #[serde(default = "unturned")]
    pub orientation: [f64; 4],
}

fn unturned() -> [f64; 4] {
    [1.0, 0.0, 0.0, 0.0]
}

impl From<Isometry3<f64>> for FramePose {
    fn from(pose: Isometry3<f64>) -> Self {
        let q = pose.rotation.quaternion();
        Self {
            position: pose.translation.vector.into(),
            orientation: [q.w, q.i, q.j, q.k],
        }
    }
}

impl FramePose {
    /// The pose that is had at a time, seconds.
    pub fn at(self, time: f64) -> TimedPose {
        let Self {
            position,
            orientation,
        } = self;
        TimedPose {
            time,
            position,
            orientation,
        }
    }

    pub(crate) fn isometry(&self) -> Isometry3<f64> {
        let [w, x, y, z] = self.orientation;
        let rotation = UnitQuaternion::from_quaternion(Quaternion::new(w, x, y, z));
        Isometry3::from_parts(self.position.into(), rotation)
    }

    fn check(&self, key: &Key, checks: &mut Checks) {
        checks.finite(key.name("position"), &self.position, Unit::Metre);
        let (key, q) = (key.name("orientation"), self.orientation);
        if let Some((k, value)) = q.iter().enumerate().find(|(_, c)| !c.is_finite()) {
            let message = format!("`{key}` has the component {}", given(*value));
            return checks.report(key.entry(k), message, "give finite numbers");
        }
        let norm = q.iter().map(|c| c * c).sum::<f64>().sqrt();
        if (norm - 1.0).abs() > ROUND_OFF {
            let message = format!(
                "`{key}` is a quaternion whose norm differs by {} from 1",
                brief(norm - 1.0)
            );
            let remedy = "give a unit quaternion, the scalar first: w, x, y, z";
            checks.report(key, message, remedy);
        }
    }
}

impl TimedPose {
    /// Whether another one is the same at another time.
    pub fn is_as(&self, other: &Self) -> bool {
        self.pose() == other.pose()
    }

    fn pose(&self) -> FramePose {
        FramePose {
            position: self.position,
            orientation: self.orientation,
        }
    }
}

impl Poses {
    /// The times at which the velocity jumps, seconds.
    pub(crate) fn breaks(&self) -> Vec<f64> {
        let times = || self.keys.iter().map(|key| key.time).collect();
        self.kinks.clone().unwrap_or_else(times)
    }

    /// The frame while nothing is displaced.
    pub fn frame(&self) -> FramePose {
        let first = self.keys.first().map(TimedPose::pose);
        let origin = FramePose::from(Isometry3::identity());
        self.frame.or(first).unwrap_or(origin)
    }

    /// The motion of a body that is in a pose while the frame is where it is while nothing is displaced.
    pub(crate) fn of_body(&self, pose: Isometry3<f64>) -> RigidProfile {
        let keys = self.keys.iter().map(|key| Keyframe {
            t: key.time,
            pose: key.pose().isometry(),
        });
        RigidProfile::Keyframes {
            keys: keys.collect(),
            body: self.frame().isometry().inverse() * pose,
        }
    }

    pub(crate) fn check(&self, key: &Key, checks: &mut Checks) {
        let before = checks.problems.len();
        if let Some(frame) = &self.frame {
            frame.check(&key.name("frame"), checks);
        }
        let kinks = self.kinks.as_deref().unwrap_or_default();
        for (key, time) in key.name("kinks").entries(kinks) {
            checks.number(key, *time, Unit::Second);
        }
        for (key, pose) in key.name("keys").entries(&self.keys) {
            checks.number(key.name("time"), pose.time, Unit::Second);
            pose.pose().check(&key, checks);
        }
        if checks.problems.len() == before
            && let Err(error) = self.of_body(Isometry3::identity()).validate()
        {
            let keys = key.name("keys");
            let key = match error {
                MotionError::Keyframe { index, .. }
                | MotionError::Order { index, .. }
                | MotionError::HalfTurn { index, .. } => keys.entry(index),
                _ => keys,
            };
            checks.problems.push(Problem::from_error(key, &error));
        }
    }
}
