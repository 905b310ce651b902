//! Bodies with round shapes: their mass, and the surface by which they touch.

use crate::time::pose::Pose;
use isosheet_collide::RoundBody;
use isosheet_dynamics::{RigidBody, RigidBodyError};
use isosheet_geometry::{Moments, Shape, Skin};

/// The moments of a shape for which triangles only stand; none of one that they are.
pub(crate) fn true_moments(shape: &Shape) -> Option<Moments> {
    match shape.skin() {
        Skin::Flat => None,
        Skin::Plane | Skin::Round { .. } | Skin::Tube { .. } => shape.moments(),
    }
}

/// The body of a mass (kilograms) that is spread evenly over a shape with these moments, in a pose.
pub(crate) fn body(moments: &Moments, mass: f64, pose: &Pose) -> Result<RigidBody, RigidBodyError> {
    let density = mass / moments.volume;
    let turn = pose.isometry().rotation.to_rotation_matrix().into_inner();
    let turned = turn * (density * moments.second) * turn.transpose();
    let turned = 0.5 * (turned + turned.transpose());
    RigidBody::new(mass, pose.place(moments.centre.into()), turned.into())
}

/// The surface by which a shape touches, in a pose, if it is at a radius from a segment; others touch as
/// polyhedra.
pub(crate) fn surface(shape: &Shape, pose: &Pose) -> Option<RoundBody> {
    match shape.skin() {
        Skin::Round {
            half_length,
            radius,
        } => Some(RoundBody {
            axis: [-half_length, half_length].map(|z| pose.place([0.0, 0.0, z])),
            radius,
        }),
        Skin::Flat | Skin::Plane | Skin::Tube { .. } => None,
    }
}
