//! Prescribed rigid motions.

use nalgebra::{Isometry3, Translation3, UnitQuaternion, Vector3};
use thiserror::Error;

/// A pose to be reached at a time.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Keyframe {
    /// Time, seconds.
    pub t: f64,
    /// Position and orientation of the body's frame, metres.
    pub pose: Isometry3<f64>,
}

/// A rigid motion through keyframes.
///
/// Between two keyframes the origin moves on a straight line at constant speed and the body turns
/// about a fixed axis at constant rate, the shorter way round. Before the first and after the last
/// keyframe it rests.
#[derive(Debug, Clone, PartialEq)]
pub struct Motion {
    keyframes: Vec<Keyframe>,
}

/// Keyframes that make no motion.
#[derive(Debug, Clone, PartialEq, Error)]
pub enum MotionError {
    /// No keyframes at all.
    #[error("a motion needs at least one keyframe")]
    Empty,
    /// A time or pose is not finite.
    #[error("keyframe {index} at t = {t} s has a time or pose that is not finite")]
    NotFinite {
        /// The keyframe.
        index: usize,
        /// Its time.
        t: f64,
    },
    /// Times do not increase.
    #[error("keyframe {index} at t = {t} s does not come after t = {previous} s: sort by time")]
    Order {
        /// The keyframe.
        index: usize,
        /// Its time.
        t: f64,
        /// The time before.
        previous: f64,
    },
    /// The way round is ambiguous.
    #[error(
        "the body turns by half a turn up to keyframe {index} at t = {t} s: add a keyframe between, to say which way"
    )]
    HalfTurn {
        /// The keyframe.
        index: usize,
        /// Its time.
        t: f64,
    },
}

/// Turns closer to half a turn than this have no direction, radians: well above the round-off of a
/// quaternion, well below what anybody specifies.
const HALF_TURN_MARGIN: f64 = 1e-6;

impl Motion {
    /// At rest.
    ///
    /// # Errors
    /// [`MotionError::NotFinite`].
    pub fn still(pose: Isometry3<f64>) -> Result<Self, MotionError> {
        Self::new(vec![Keyframe { t: 0.0, pose }])
    }

    /// Through the keyframes, sorted by time.
    ///
    /// # Errors
    /// [`MotionError`] naming the first keyframe that makes no sense.
    pub fn new(keyframes: Vec<Keyframe>) -> Result<Self, MotionError> {
        if keyframes.is_empty() {
            return Err(MotionError::Empty);
        }
        for (index, key) in keyframes.iter().enumerate() {
            let t = key.t;
            let finite = t.is_finite()
                && key.pose.translation.vector.iter().all(|c| c.is_finite())
                && key.pose.rotation.coords.iter().all(|c| c.is_finite());
            if !finite {
                return Err(MotionError::NotFinite { index, t });
            }
            if index > 0 {
                let before = &keyframes[index - 1];
                if t <= before.t {
                    return Err(MotionError::Order {
                        index,
                        t,
                        previous: before.t,
                    });
                }
                let turn = before.pose.rotation.angle_to(&key.pose.rotation);
                if turn > std::f64::consts::PI - HALF_TURN_MARGIN {
                    return Err(MotionError::HalfTurn { index, t });
                }
            }
        }
        Ok(Self { keyframes })
    }

    /// The keyframes.
    pub fn keyframes(&self) -> &[Keyframe] {
        &self.keyframes
    }

    /// Whether the body never moves.
    pub fn is_still(&self) -> bool {
        self.keyframes
            .iter()
            .all(|k| k.pose == self.keyframes[0].pose)
    }

    /// The two keyframes around `t`, or `None` where the body rests outside of them.
    fn segment(&self, t: f64) -> Option<[&Keyframe; 2]> {
        let after = self.keyframes.partition_point(|k| k.t <= t);
        (after > 0 && after < self.keyframes.len())
            .then(|| [&self.keyframes[after - 1], &self.keyframes[after]])
    }

    /// Pose at time `t` (seconds); it takes body coordinates to space.
    pub fn pose(&self, t: f64) -> Isometry3<f64> {
        match self.segment(t) {
            Some([a, b]) => {
                let s = (t - a.t) / (b.t - a.t);
                let (p, q) = (a.pose.translation.vector, b.pose.translation.vector);
                let turn = a.pose.rotation.rotation_to(&b.pose.rotation).scaled_axis();
                Isometry3::from_parts(
                    Translation3::from(p + s * (q - p)),
                    UnitQuaternion::from_scaled_axis(s * turn) * a.pose.rotation,
                )
            }
            None if t < self.keyframes[0].t => self.keyframes[0].pose,
            None => self.keyframes[self.keyframes.len() - 1].pose,
        }
    }

    /// Velocity (metres per second) of the body's point that is at `p` (metres, in space) at time
    /// `t`. At a keyframe it is that of the motion that begins there.
    pub fn velocity(&self, t: f64, p: &Vector3<f64>) -> Vector3<f64> {
        match self.segment(t) {
            Some([a, b]) => {
                let duration = b.t - a.t;
                let turn = a.pose.rotation.rotation_to(&b.pose.rotation).scaled_axis();
                let shift = b.pose.translation.vector - a.pose.translation.vector;
                let arm = p - self.pose(t).translation.vector;
                (shift + turn.cross(&arm)) / duration
            }
            None => Vector3::zeros(),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use nalgebra::Point3;
    use proptest::prelude::*;

    fn key(t: f64, translation: [f64; 3], turn: [f64; 3]) -> Keyframe {
        let pose = Isometry3::new(Vector3::from(translation), Vector3::from(turn));
        Keyframe { t, pose }
    }

    fn vector() -> impl Strategy<Value = [f64; 3]> {
        proptest::array::uniform3(-1.0..1.0_f64)
    }

    proptest! {
        #[test]
        fn velocity_is_the_rate_of_the_pose(a in vector(), b in vector(), c in vector(), d in vector(), p in vector(), s in 0.01..0.99_f64) {
            let motion = Motion::new(vec![key(1.0, a, c), key(3.0, b, d)]).unwrap();
            let t = 1.0 + 2.0 * s;
            let body = Point3::from(Vector3::from(p));
            let at = |t: f64| (motion.pose(t) * body).coords;
            let h = 1e-5;
            let rate = (at(t + h) - at(t - h)) / (2.0 * h);
            prop_assert!((rate - motion.velocity(t, &at(t))).norm() < 1e-8);
            // Keyframes are met.
            for (k, t) in [(0, 1.0), (1, 3.0), (0, -5.0), (1, 9.0)] {
                let error = (at(t) - (motion.keyframes()[k].pose * body).coords).norm();
                prop_assert!(error < 1e-14);
            }
            prop_assert_eq!(motion.velocity(9.0, &at(9.0)), Vector3::zeros());
        }
    }

    #[test]
    fn a_quarter_turn_is_halved() {
        let turn = [0.0, 0.0, std::f64::consts::FRAC_PI_2];
        let motion = Motion::new(vec![
            key(0.0, [0.0; 3], [0.0; 3]),
            key(2.0, [4.0, 0.0, 0.0], turn),
        ])
        .unwrap();
        let p = (motion.pose(1.0) * Point3::new(1.0, 0.0, 0.0)).coords;
        let r = 0.5_f64.sqrt();
        assert!((p - Vector3::new(2.0 + r, r, 0.0)).norm() < 1e-15);
        assert!(!motion.is_still());
        assert!(Motion::still(motion.pose(1.0)).unwrap().is_still());
    }

    #[test]
    fn bad_keyframes_are_named() {
        let zero = [0.0; 3];
        assert_eq!(Motion::new(Vec::new()), Err(MotionError::Empty));
        let keys = vec![key(0.0, zero, zero), key(0.0, zero, zero)];
        assert_eq!(
            Motion::new(keys),
            Err(MotionError::Order {
                index: 1,
                t: 0.0,
                previous: 0.0
            })
        );
        let keys = vec![key(0.0, [f64::NAN, 0.0, 0.0], zero)];
        assert_eq!(
            Motion::new(keys),
            Err(MotionError::NotFinite { index: 0, t: 0.0 })
        );
        let half = [0.0, std::f64::consts::PI, 0.0];
        let keys = vec![key(0.0, zero, zero), key(1.0, zero, half)];
        assert_eq!(
            Motion::new(keys),
            Err(MotionError::HalfTurn { index: 1, t: 1.0 })
        );
    }
}
