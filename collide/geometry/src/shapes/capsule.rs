//! A cylinder with half balls at both ends.

use super::contact_geometry::ContactGeometry;
use super::form::{Form, ShapeError, Symmetry};
use super::moments::{Caps, Moments};
use super::skin::Skin;
use super::triangles::Triangles;
use crate::signed_distance::SignedDistance;
use nalgebra::{Matrix3, Vector3};

/// A ball swept along the z axis from `-half_length` to `half_length`, metres.
#[derive(Debug, Clone, Copy)]
pub(super) struct Capsule {
    pub(super) radius: f64,
    pub(super) half_length: f64,
}

impl Form for Capsule {
    fn name(&self) -> &'static str {
        "capsule"
    }

    fn lengths(&self) -> Vec<(&'static str, f64)> {
        vec![("radius", self.radius), ("half_length", self.half_length)]
    }

    fn signed_distance(&self, p: &Vector3<f64>) -> SignedDistance {
        let on_axis = p.z.clamp(-self.half_length, self.half_length);
        let mut free = Matrix3::identity();
        if p.z.abs() < self.half_length {
            free[(2, 2)] = 0.0;
        }
        SignedDistance::about(&(p - on_axis * Vector3::z()), &free, self.radius)
    }

    fn triangles(&self, sides: usize) -> Result<Option<Triangles>, ShapeError> {
        let (radius, half_length) = (self.radius, self.half_length);
        Ok(Some(Triangles::about_segment(radius, half_length, sides)))
    }

    /// Its axis, which is exact.
    fn contact_geometry(&self, _: usize) -> Result<Option<ContactGeometry>, ShapeError> {
        let (radius, half_length) = (self.radius, self.half_length);
        Ok(Some(ContactGeometry::about_segment(radius, half_length)))
    }

    fn bounds(&self) -> Option<[Vector3<f64>; 2]> {
        let high = Vector3::new(self.radius, self.radius, self.half_length + self.radius);
        Some([-high, high])
    }

    fn moments(&self) -> Option<Moments> {
        let length = 2.0 * self.half_length;
        Some(Moments::about_axis(self.radius, length, Caps::Balls))
    }

    fn symmetry(&self) -> Symmetry {
        Symmetry::Axis
    }

    fn is_convex(&self) -> bool {
        true
    }

    fn skin(&self) -> Skin {
        Skin::Round {
            half_length: self.half_length,
            radius: self.radius,
        }
    }
}
