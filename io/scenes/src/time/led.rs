//! Motions that a program leads, in a simulation that is under way.

use crate::time::pose::MotionKey;
use crate::words::key::Key;
use isosheet_dynamics::{Led, PointMotion, RigidMotion};
use nalgebra::Isometry3;

/// All that the engine has of a rigid motion of the scene.
#[derive(Clone, Debug)]
pub(crate) struct LedMotion {
    key: Key,
    /// Bodies, with the pose of each while nothing is displaced.
    bodies: Vec<(Isometry3<f64>, Led<RigidMotion>)>,
    /// Pinned vertices, with the place of each while nothing is displaced, metres.
    points: Vec<([f64; 3], Led<PointMotion>)>,
}

impl LedMotion {
    /// Whether a key is that of the motion, or of a part of it.
    pub(crate) fn has(&self, key: &Key) -> bool {
        key.is_within(&self.key)
    }

    /// Goes on with another motion, which is where this one is now.
    pub(crate) fn lead(&self, motion: &MotionKey) {
        for (body, led) in &self.bodies {
            led.lead(motion.of_body(*body));
        }
        for (point, led) in &self.points {
            led.lead(motion.of_pin(*point));
        }
    }
}

/// What a model that is on its way has of the motions that are led.
#[derive(Debug)]
pub(crate) struct LedMotions(Vec<LedMotion>);

impl LedMotions {
    /// Of these keys, which have nothing yet.
    pub(crate) fn of(keys: &[Key]) -> Self {
        let motion = |key: &Key| LedMotion {
            key: key.clone(),
            bodies: Vec::new(),
            points: Vec::new(),
        };
        Self(keys.iter().map(motion).collect())
    }

    fn find(&mut self, key: &Key) -> Option<&mut LedMotion> {
        self.0.iter_mut().find(|led| led.key == *key)
    }

    /// Whether a motion is led.
    pub(crate) fn has(&mut self, key: &Key) -> bool {
        self.find(key).is_some()
    }

    /// The motion of a body in a pose, as the engine has it.
    pub(crate) fn of_body(
        &mut self,
        key: &Key,
        motion: &MotionKey,
        pose: Isometry3<f64>,
    ) -> RigidMotion {
        let now = RigidMotion::from(motion.of_body(pose));
        match self.find(key) {
            None => now,
            Some(led) => {
                let cell = Led::new(now);
                led.bodies.push((pose, cell.clone()));
                RigidMotion::Led(cell)
            }
        }
    }

    /// The motion of a pinned vertex at a place (metres), as the engine has it.
    pub(crate) fn of_pin(&mut self, key: &Key, motion: &MotionKey, place: [f64; 3]) -> PointMotion {
        let now = motion.of_pin(place);
        match self.find(key) {
            None => now,
            Some(led) => {
                let cell = Led::new(now);
                led.points.push((place, cell.clone()));
                PointMotion::Led(cell)
            }
        }
    }

    pub(crate) fn into_list(self) -> Vec<LedMotion> {
        self.0
    }
}
