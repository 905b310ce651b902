//! A signed distance with its derivatives.

use nalgebra::{Matrix3, Vector3};

/// Distance of a point from the surface of a body.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct SignedDistance {
    /// Distance, metres; negative inside.
    pub value: f64,
    /// Its gradient by the point: the outward unit normal at the closest point. Where several points
    /// are closest (the centre of a ball) it is one of their normals.
    pub normal: Vector3<f64>,
    /// Its Hessian by the point, one over metres; that of the nearest feature, zero where it does
    /// not exist.
    pub hessian: Matrix3<f64>,
}

impl SignedDistance {
    /// The closest point of the surface to `p`.
    #[inline]
    pub fn closest(&self, p: &Vector3<f64>) -> Vector3<f64> {
        p - self.value * self.normal
    }

    /// At a distance `radius` about the closest point of a skeleton, seen from which `p` is given; the
    /// closest point stays while `p` moves in the range of the projector `free`.
    pub(crate) fn about(p: &Vector3<f64>, free: &Matrix3<f64>, radius: f64) -> Self {
        let d = p.norm();
        let (normal, hessian) = if d > 0.0 {
            let n = p / d;
            (n, (free - n * n.transpose()) / d)
        } else {
            (Vector3::x(), Matrix3::zeros())
        };
        Self {
            value: d - radius,
            normal,
            hessian,
        }
    }
}
