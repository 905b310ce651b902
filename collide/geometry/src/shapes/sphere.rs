//! A ball.

use super::contact_geometry::ContactGeometry;
use super::form::{Form, ShapeError, Symmetry};
use super::moments::{Caps, Moments};
use super::skin::Skin;
use super::triangles::Triangles;
use crate::signed_distance::SignedDistance;
use nalgebra::{Matrix3, Vector3};

/// A ball about the origin, metres.
#[derive(Debug, Clone, Copy)]
pub(super) struct Sphere {
    pub(super) radius: f64,
}

impl Form for Sphere {
    fn name(&self) -> &'static str {
        "sphere"
    }

    fn lengths(&self) -> Vec<(&'static str, f64)> {
        vec![("radius", self.radius)]
    }

    fn signed_distance(&self, p: &Vector3<f64>) -> SignedDistance {
        SignedDistance::about(p, &Matrix3::identity(), self.radius)
    }

    fn triangles(&self, sides: usize) -> Result<Option<Triangles>, ShapeError> {
        Ok(Some(Triangles::about_segment(self.radius, 0.0, sides)))
    }

    /// Its centre, which is exact.
    fn contact_geometry(&self, _: usize) -> Result<Option<ContactGeometry>, ShapeError> {
        Ok(Some(ContactGeometry::about_point(self.radius)))
    }

    fn bounds(&self) -> Option<[Vector3<f64>; 2]> {
        Some([-self.radius, self.radius].map(Vector3::repeat))
    }

    fn moments(&self) -> Option<Moments> {
        Some(Moments::about_axis(self.radius, 0.0, Caps::Balls))
    }

    fn symmetry(&self) -> Symmetry {
        Symmetry::Full
    }

    fn is_convex(&self) -> bool {
        true
    }

    fn skin(&self) -> Skin {
        Skin::Round {
            half_length: 0.0,
            radius: self.radius,
        }
    }
}
