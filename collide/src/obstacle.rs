//! Bodies that a sheet meets.

use isosheet_dynamics::{MotionError, RigidDisplacement, RigidMotion, RigidProfile};
use isosheet_geometry::{Shape, ShapeError, SignedDistance};
use isosheet_mesh::Advice;
use nalgebra::{Isometry3, Point3, Vector3};
use thiserror::Error;

#[cfg(test)]
mod tests;

/// Why a body cannot be an obstacle.
#[derive(Debug, Clone, PartialEq, Error)]
#[non_exhaustive]
pub enum ObstacleError {
    /// The shape cannot be used.
    #[error(transparent)]
    Shape(#[from] ShapeError),
    /// The motion cannot be used.
    #[error(transparent)]
    Motion(#[from] MotionError),
}

impl Advice for ObstacleError {
    fn advice(&self) -> Option<&'static str> {
        match self {
            Self::Shape(error) => error.advice(),
            Self::Motion(error) => error.advice(),
        }
    }
}

/// A body at rest or in prescribed rigid motion.
#[derive(Debug, Clone)]
pub struct Obstacle {
    shape: Shape,
    motion: RigidMotion,
}

/// Velocities of bodies that move by a function of time are taken by differences over parts of this time,
/// seconds: they are good to 1e-8 of the change of velocity in a hundredth of a second.
const MOTION_SPAN: f64 = 1e-2;

impl Obstacle {
    /// A body that moves: by profiles, through keyframes, or as a function of time (seconds) that returns its
    /// pose.
    ///
    /// # Errors
    /// [`ObstacleError`] naming the length that is not positive, or what is wrong with the motion.
    pub fn new(shape: Shape, motion: impl Into<RigidMotion>) -> Result<Self, ObstacleError> {
        let motion = motion.into();
        shape.validate()?;
        motion.validate()?;
        Ok(Self { shape, motion })
    }

    /// A body that rests in a pose.
    ///
    /// # Errors
    /// [`ObstacleError`] naming the length that is not positive, or the number of the pose that is not
    /// finite.
    pub fn fixed(shape: Shape, pose: Isometry3<f64>) -> Result<Self, ObstacleError> {
        Self::new(shape, RigidProfile::fixed(pose))
    }

    /// A body that rests with the origin of its frame at a place (metres), its axes along the axes of space.
    /// For one that is turned or moves by profiles, see [`RigidDisplacement`].
    ///
    /// # Errors
    /// [`ObstacleError`] naming the length that is not positive, or the coordinate that is not finite.
    pub fn at(shape: Shape, place: [f64; 3]) -> Result<Self, ObstacleError> {
        Self::new(shape, RigidDisplacement::at(place))
    }

    /// Its form.
    pub fn shape(&self) -> &Shape {
        &self.shape
    }

    /// Its motion.
    pub fn motion(&self) -> &RigidMotion {
        &self.motion
    }

    /// Velocity (metres per second) of the body's point that is at `p` (metres, in space) at time `t`
    /// (seconds).
    pub fn velocity(&self, t: f64, p: &Vector3<f64>) -> Vector3<f64> {
        self.motion.kinematics(t, MOTION_SPAN).velocity_at(p)
    }

    /// Distance of `p` (metres, in space) at time `t` (seconds) with derivatives by `p`.
    pub fn signed_distance(&self, t: f64, p: &Vector3<f64>) -> SignedDistance {
        let pose = self.motion.pose(t);
        let local = self
            .shape
            .signed_distance(&pose.inverse_transform_point(&Point3::from(*p)).coords);
        let turn = pose.rotation.to_rotation_matrix().into_inner();
        SignedDistance {
            value: local.value,
            normal: turn * local.normal,
            hessian: turn * local.hessian * turn.transpose(),
        }
    }

    /// Writes body positions (`3V`) as positions in space at time `t` to `out`.
    ///
    /// # Panics
    /// If the lengths differ.
    pub fn place(&self, t: f64, positions: &[f64], out: &mut [f64]) {
        assert_eq!(positions.len(), out.len(), "one place per position");
        let pose = self.motion.pose(t);
        let chunks = positions.as_chunks::<3>().0;
        for (p, q) in chunks.iter().zip(out.as_chunks_mut::<3>().0) {
            *q = (pose * Point3::from(*p)).coords.into();
        }
    }
}
