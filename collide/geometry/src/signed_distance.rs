//! Signed distances from simple bodies in their own frame, with derivatives.

use nalgebra::{Matrix2, Matrix3, Vector2, Vector3};

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
    pub fn closest(&self, p: &Vector3<f64>) -> Vector3<f64> {
        p - self.value * self.normal
    }
}

/// The body is `z <= 0`.
pub(crate) fn half_space(p: &Vector3<f64>) -> SignedDistance {
    SignedDistance {
        value: p.z,
        normal: Vector3::z(),
        hessian: Matrix3::zeros(),
    }
}

/// A ball about the origin.
pub(crate) fn sphere(p: &Vector3<f64>, radius: f64) -> SignedDistance {
    around(p, &Matrix3::identity(), radius)
}

/// A ball swept along the z axis from `-half_length` to `half_length`.
pub(crate) fn capsule(p: &Vector3<f64>, radius: f64, half_length: f64) -> SignedDistance {
    let on_axis = p.z.clamp(-half_length, half_length);
    let mut free = Matrix3::identity();
    if p.z.abs() < half_length {
        free[(2, 2)] = 0.0;
    }
    around(&(p - on_axis * Vector3::z()), &free, radius)
}

/// At a distance `radius` about the closest point of a skeleton, seen from which `p` is given; the
/// closest point stays while `p` moves in the range of the projector `free`.
fn around(p: &Vector3<f64>, free: &Matrix3<f64>, radius: f64) -> SignedDistance {
    let d = p.norm();
    let (normal, hessian) = if d > 0.0 {
        let n = p / d;
        (n, (free - n * n.transpose()) / d)
    } else {
        (Vector3::x(), Matrix3::zeros())
    };
    SignedDistance {
        value: d - radius,
        normal,
        hessian,
    }
}

/// A box with the given half edge lengths about the origin.
pub(crate) fn cuboid(p: &Vector3<f64>, half: &[f64; 3]) -> SignedDistance {
    let side = Vector3::from_fn(|k, _| 1.0_f64.copysign(p[k]));
    let over = Vector3::from_fn(|k, _| p[k].abs() - half[k]);
    let beyond = over.map(|o| o.max(0.0));
    let d = beyond.norm();
    if d > 0.0 {
        let n = beyond.component_mul(&side) / d;
        let free = Matrix3::from_diagonal(&over.map(|o| f64::from(u8::from(o > 0.0))));
        SignedDistance {
            value: d,
            normal: n,
            hessian: (free - n * n.transpose()) / d,
        }
    } else {
        let k = over.imax();
        let mut normal = Vector3::zeros();
        normal[k] = side[k];
        SignedDistance {
            value: over[k],
            normal,
            hessian: Matrix3::zeros(),
        }
    }
}

/// A solid cylinder about the z axis from `-half_height` to `half_height`.
pub(crate) fn cylinder(p: &Vector3<f64>, radius: f64, half_height: f64) -> SignedDistance {
    let rho = p.x.hypot(p.y);
    let radial = if rho > 0.0 {
        Vector3::new(p.x / rho, p.y / rho, 0.0)
    } else {
        Vector3::x()
    };
    let up = Vector3::new(0.0, 0.0, 1.0_f64.copysign(p.z));
    // In the half plane through the axis the body is a corner.
    let over = Vector2::new(rho - radius, p.z.abs() - half_height);
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
