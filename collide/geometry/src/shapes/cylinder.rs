//! A cylinder with flat ends.

use super::form::{Form, ShapeError, Symmetry};
use super::moments::{Caps, Moments};
use super::skin::Skin;
use super::triangles::Triangles;
use crate::signed_distance::SignedDistance;
use nalgebra::{Matrix2, Vector2, Vector3};
use std::f64::consts::TAU;

/// A solid cylinder about the z axis from `-half_height` to `half_height`, metres.
#[derive(Debug, Clone, Copy)]
pub(super) struct Cylinder {
    pub(super) radius: f64,
    pub(super) half_height: f64,
}

/// A prism with more sides has slivers for faces and millions of candidates; its sag is 5e-12 of the
/// radius.
const MOST_SIDES: u32 = 1_000_000;

impl Form for Cylinder {
    fn name(&self) -> &'static str {
        "cylinder"
    }

    fn lengths(&self) -> Vec<(&'static str, f64)> {
        vec![("radius", self.radius), ("half_height", self.half_height)]
    }

    fn signed_distance(&self, p: &Vector3<f64>) -> SignedDistance {
        let rho = p.x.hypot(p.y);
        let radial = if rho > 0.0 {
            Vector3::new(p.x / rho, p.y / rho, 0.0)
        } else {
            Vector3::x()
        };
        let up = Vector3::new(0.0, 0.0, 1.0_f64.copysign(p.z));
        // In the half plane through the axis the body is a corner.
        let over = Vector2::new(rho - self.radius, p.z.abs() - self.half_height);
        let beyond = over.map(|o| o.max(0.0));
        let d = beyond.norm();
        let (value, n, flat) = if d > 0.0 {
            let n = beyond / d;
            let free = Matrix2::from_diagonal(&over.map(|o| f64::from(u8::from(o > 0.0))));
            (d, n, (free - n * n.transpose()) / d)
        } else if over.x >= over.y {
            (over.x, Vector2::x(), Matrix2::zeros())
        } else {
            (over.y, Vector2::y(), Matrix2::zeros())
        };
        let mut hessian = flat[(0, 0)] * radial * radial.transpose()
            + flat[(1, 1)] * up * up.transpose()
            + flat[(0, 1)] * (radial * up.transpose() + up * radial.transpose());
        if rho > 0.0 {
            // The radial direction turns with the point.
            let around = radial.cross(&up);
            hessian += n.x / rho * around * around.transpose();
        }
        SignedDistance {
            value,
            normal: n.x * radial + n.y * up,
            hessian,
        }
    }

    /// A prism with the same rim points: rims first, bottom then top, then the centres of bottom and top. It
    /// is smaller by up to `radius (1 - cos(pi / sides))`.
    fn triangles(&self, sides: usize) -> Result<Option<Triangles>, ShapeError> {
        let most = u32::try_from(sides).unwrap_or(u32::MAX);
        if !(3..=MOST_SIDES).contains(&most) {
            return Err(ShapeError::Segments(sides));
        }
        let (radius, half_height, sides) = (self.radius, self.half_height, most);
        let mut points = Vec::new();
        for z in [-half_height, half_height] {
            for i in 0..sides {
                let (sin, cos) = (TAU * f64::from(i) / f64::from(sides)).sin_cos();
                points.push([radius * cos, radius * sin, z]);
            }
        }
        points.extend([[0.0, 0.0, -half_height], [0.0, 0.0, half_height]]);
        let (bottom, top) = (2 * sides, 2 * sides + 1);
        let mut faces = Vec::new();
        for i in 0..sides {
            let j = (i + 1) % sides;
            faces.extend([
                [i, j, sides + j],
                [i, sides + j, sides + i],
                [bottom, j, i],
                [top, sides + i, sides + j],
            ]);
        }
        Ok(Some(Triangles { points, faces }))
    }

    fn bounds(&self) -> Option<[Vector3<f64>; 2]> {
        let high = Vector3::new(self.radius, self.radius, self.half_height);
        Some([-high, high])
    }

    fn moments(&self) -> Option<Moments> {
        let length = 2.0 * self.half_height;
        Some(Moments::about_axis(self.radius, length, Caps::Flat))
    }

    fn symmetry(&self) -> Symmetry {
        Symmetry::Axis
    }

    fn is_convex(&self) -> bool {
        true
    }

    fn skin(&self) -> Skin {
        Skin::Tube {
            half_length: self.half_height,
            radius: self.radius,
        }
    }
}
