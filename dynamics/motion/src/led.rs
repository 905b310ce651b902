//! Motions that are replaced while a simulation goes on.

use std::sync::{Arc, PoisonError, RwLock};

/// A motion that a program leads: all that has it, also in clones, goes on with another one from a moment on.
/// The other one has to be where this one is at that moment, which nothing here checks.
///
/// ```
/// use isosheet_motion::{Led, PointMotion, PointProfile, Profile};
///
/// let led = Led::new(PointProfile::default());
/// let motion = PointMotion::Led(led.clone());
/// let z = Profile::Ramp { from: 0.0, to: 0.1, begin: 1.0, end: 2.0 };
/// led.lead(PointProfile { z, ..PointProfile::default() });
/// assert_eq!(motion.position(3.0), [0.0, 0.0, 0.1]);
/// ```
#[derive(Debug, Clone)]
pub struct Led<M>(Arc<RwLock<M>>);

impl<M> Led<M> {
    /// One that begins with a motion.
    pub fn new(motion: impl Into<M>) -> Self {
        Self(Arc::new(RwLock::new(motion.into())))
    }

    /// Goes on with another motion.
    pub fn lead(&self, motion: impl Into<M>) {
        *self.0.write().unwrap_or_else(PoisonError::into_inner) = motion.into();
    }

    /// Does something with the present motion.
    pub(super) fn with<R>(&self, of: impl FnOnce(&M) -> R) -> R {
        of(&self.0.read().unwrap_or_else(PoisonError::into_inner))
    }
}
