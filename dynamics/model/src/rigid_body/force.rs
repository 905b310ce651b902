//! Prescribed forces and torques on rigid bodies.

use crate::rigid_body::CarriedPoint;
use crate::sheet_model::load::{LoadError, direction};
use isosheet_materials::potential::Force;
use isosheet_materials::vectors::{add, point};
use isosheet_mesh::VertexId;
use isosheet_motion::Profile;
use nalgebra::{Matrix3, Vector3};

/// A force on a point of a [`RigidBody`](crate::RigidBody): its size (newtons) follows a profile, its
/// direction is fixed in space.
#[derive(Debug, Clone, PartialEq)]
pub struct BodyForce {
    at: CarriedPoint,
    direction: Vector3<f64>,
    size: Profile,
}

impl BodyForce {
    /// A force on a point as the body [carries](crate::RigidBody::carried) it, in a direction of any length.
    ///
    /// # Errors
    /// [`LoadError`] naming the first argument that cannot be used.
    pub fn new(at: CarriedPoint, along: [f64; 3], size: Profile) -> Result<Self, LoadError> {
        size.validate()?;
        Ok(Self {
            at,
            direction: direction(along)?,
            size,
        })
    }
}

impl Force for BodyForce {
    fn add_force(&self, t: f64, _x: &[f64], _v: &[f64], force: &mut [f64]) {
        let load = self.size.value(t) * self.direction;
        for (v, weight) in self.at {
            add(force, v, &(weight * load));
        }
    }

    fn is_of_time_alone(&self) -> bool {
        true
    }
}

/// A torque on a [`RigidBody`](crate::RigidBody): its size (newton metres) follows a profile, its axis is
/// fixed in space.
#[derive(Debug, Clone, PartialEq)]
pub struct BodyTorque {
    vertices: [VertexId; 4],
    axis: Vector3<f64>,
    size: Profile,
}

impl BodyTorque {
    /// A torque on the body that these vertices carry, about an axis of any length.
    ///
    /// # Errors
    /// [`LoadError`] naming the first argument that cannot be used.
    pub fn new(vertices: [VertexId; 4], axis: [f64; 3], size: Profile) -> Result<Self, LoadError> {
        size.validate()?;
        Ok(Self {
            vertices,
            axis: direction(axis)?,
            size,
        })
    }
}

impl Force for BodyTorque {
    /// The forces `l x r` with the places `r` about their mean, which have no sum, and whose torque
    /// `sum r x (l x r)` is that which is asked for.
    fn add_force(&self, t: f64, x: &[f64], _v: &[f64], force: &mut [f64]) {
        let places = self.vertices.map(|v| point(x, v));
        let mean = places.iter().sum::<Vector3<f64>>() / 4.0;
        let places = places.map(|p| p - mean);
        let of = |r: &Vector3<f64>| r.norm_squared() * Matrix3::identity() - r * r.transpose();
        let sum: Matrix3<f64> = places.iter().map(of).sum();
        let turned = sum.try_inverse().unwrap_or_default() * (self.size.value(t) * self.axis);
        for (v, r) in self.vertices.iter().zip(places) {
            add(force, *v, &turned.cross(&r));
        }
    }
}
