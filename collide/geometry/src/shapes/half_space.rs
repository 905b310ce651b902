//! Everything below a plane.

use super::contact_geometry::ContactGeometry;
use super::form::{Form, ShapeError, Symmetry};
use super::skin::Skin;
use super::triangles::Triangles;
use crate::signed_distance::SignedDistance;
use nalgebra::{Matrix3, Vector3};

/// Everything with `z <= 0`.
#[derive(Debug, Clone, Copy)]
pub(super) struct HalfSpace;

impl Form for HalfSpace {
    fn name(&self) -> &'static str {
        "half-space"
    }

    fn signed_distance(&self, p: &Vector3<f64>) -> SignedDistance {
        SignedDistance {
            value: p.z,
            normal: Vector3::z(),
            hessian: Matrix3::zeros(),
        }
    }

    fn triangles(&self, _: usize) -> Result<Option<Triangles>, ShapeError> {
        Ok(None)
    }

    fn contact_geometry(&self, _: usize) -> Result<Option<ContactGeometry>, ShapeError> {
        Ok(None)
    }

    fn bounds(&self) -> Option<[Vector3<f64>; 2]> {
        None
    }

    fn symmetry(&self) -> Symmetry {
        Symmetry::Axis
    }

    fn is_convex(&self) -> bool {
        true
    }

    fn skin(&self) -> Skin {
        Skin::Plane
    }
}
