//! Pinned vertices in prescribed motion.

use isosheet_motion::PointMotion;

/// A pinned vertex in prescribed motion.
#[derive(Debug)]
pub(super) struct MovingPin {
    pub(super) vertex: usize,
    pub(super) motion: PointMotion,
}
