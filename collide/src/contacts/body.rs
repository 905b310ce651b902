//! The bodies of a scene.

use super::features::{Ends, Features};
use crate::Obstacle;
use isosheet_dynamics::contact::{BodyMotion, ContactKey, ContactKind, StepMotion, StepSpan};
use isosheet_geometry::{ShapeError, Symmetry};
use nalgebra::{Isometry3, UnitQuaternion, Vector3};

/// Directions of an axis closer than this are the same but for the round-off of a quaternion.
const SAME_AXIS: f64 = 1e-14;

/// A body of a scene.
#[derive(Debug, Clone)]
pub(super) struct ContactBody {
    obstacle: Obstacle,
    number: u32,
    features: Option<Features>,
}

impl ContactBody {
    pub(super) fn new(
        obstacle: Obstacle,
        number: u32,
        segments: usize,
        ends: Ends,
    ) -> Result<Self, ShapeError> {
        Ok(Self {
            features: Features::new(obstacle.shape(), segments, ends)?,
            obstacle,
            number,
        })
    }

    pub(super) fn obstacle(&self) -> &Obstacle {
        &self.obstacle
    }

    /// Corners, edges and faces, if it has any.
    pub(super) fn features(&self) -> Option<&Features> {
        self.features.as_ref()
    }

    /// Corners, edges and faces, if it has any, to be moved.
    pub(super) fn features_mut(&mut self) -> Option<&mut Features> {
        self.features.as_mut()
    }

    /// The motion over a span of time.
    pub(super) fn motion_over(&self, span: StepSpan) -> BodyMotion {
        let motion = self.obstacle.motion();
        let (start, end) = (motion.pose(span.t0), motion.pose(span.t0 + span.h));
        BodyMotion {
            material: StepMotion::new(start, end),
            surface: StepMotion::new(self.without_spin(start), self.without_spin(end)),
        }
    }

    /// A pose with the same place of the surface: for a body that is round about its z axis the
    /// orientation that the shortest turn of the axis from the pose at time zero leads to, so that it
    /// stays while the body spins; for a ball always the same.
    fn without_spin(&self, pose: Isometry3<f64>) -> Isometry3<f64> {
        let rotation = match self.obstacle.shape().symmetry() {
            Symmetry::None => pose.rotation,
            Symmetry::Full => UnitQuaternion::identity(),
            Symmetry::Axis => {
                let first = self.obstacle.motion().pose(0.0).rotation;
                let (before, after) = (first * Vector3::z(), pose.rotation * Vector3::z());
                if (after - before).amax() <= SAME_AXIS {
                    first
                } else {
                    match UnitQuaternion::rotation_between(&before, &after) {
                        Some(swing) => swing * first,
                        // Upside down: any half turn leads there.
                        None => pose.rotation,
                    }
                }
            }
        };
        Isometry3::from_parts(pose.translation, rotation)
    }

    /// Its number in the scene.
    pub(super) fn number(&self) -> u32 {
        self.number
    }

    /// The key of a pair of the sheet and the body.
    pub(super) fn key(&self, kind: ContactKind, pair: [u32; 2]) -> ContactKey {
        ContactKey {
            body: Some(self.number),
            kind,
            pair,
        }
    }
}
