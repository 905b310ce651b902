//! A box.

use super::form::{Form, ShapeError};
use super::moments::Moments;
use super::triangles::Triangles;
use crate::signed_distance::SignedDistance;
use nalgebra::{Matrix3, Vector3};

/// A box about the origin with edges along the axes, by half its edge lengths, metres.
#[derive(Debug, Clone, Copy)]
pub(super) struct Cuboid {
    pub(super) half: [f64; 3],
}

impl Form for Cuboid {
    fn name(&self) -> &'static str {
        "cuboid"
    }

    fn lengths(&self) -> Vec<(&'static str, f64)> {
        let [x, y, z] = self.half;
        vec![("half[0]", x), ("half[1]", y), ("half[2]", z)]
    }

    fn signed_distance(&self, p: &Vector3<f64>) -> SignedDistance {
        let side = Vector3::from_fn(|k, _| 1.0_f64.copysign(p[k]));
        let over = Vector3::from_fn(|k, _| p[k].abs() - self.half[k]);
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

    /// Its faces, whatever the number of sides. Corner `i` is on the positive side of axis `k` if bit `k` of
    /// `i` is set.
    fn triangles(&self, _: usize) -> Result<Option<Triangles>, ShapeError> {
        let half = self.half;
        let corner = |i: u32| [0, 1, 2].map(|k| if i >> k & 1 == 1 { half[k] } else { -half[k] });
        Ok(Some(Triangles {
            points: (0..8).map(corner).collect(),
            faces: FACES.to_vec(),
        }))
    }

    fn bounds(&self) -> Option<[Vector3<f64>; 2]> {
        let half = Vector3::from(self.half);
        Some([-half, half])
    }

    fn moments(&self) -> Option<Moments> {
        Some(Moments::of_box(self.half))
    }

    fn is_convex(&self) -> bool {
        true
    }
}

const FACES: [[u32; 3]; 12] = [
    [0, 2, 3],
    [0, 3, 1],
    [4, 5, 7],
    [4, 7, 6],
    [0, 1, 5],
    [0, 5, 4],
    [2, 6, 7],
    [2, 7, 3],
    [0, 4, 6],
    [0, 6, 2],
    [1, 3, 7],
    [1, 7, 5],
];
