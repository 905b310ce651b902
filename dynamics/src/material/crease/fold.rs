//! The fold angle of an edge.

use crate::vectors::point;
use isosheet_mesh::VertexId;
use nalgebra::Vector3;

/// The two faces at an edge.
pub(super) struct Fold {
    along: Vector3<f64>,
    to_left: Vector3<f64>,
    to_right: Vector3<f64>,
    /// Normals of the left and of the right face, twice their areas long.
    left: Vector3<f64>,
    right: Vector3<f64>,
}

impl Fold {
    pub(super) fn at(x: &[f64], vertices: &[VertexId; 4]) -> Self {
        let [a, b, l, r] = vertices;
        let [a, b, l, r] = [point(x, *a), point(x, *b), point(x, *l), point(x, *r)];
        let (along, to_left, to_right) = (b - a, l - a, r - a);
        Self {
            left: along.cross(&to_left),
            right: to_right.cross(&along),
            along,
            to_left,
            to_right,
        }
    }

    /// The length of the edge.
    pub(super) fn length(&self) -> f64 {
        self.along.norm()
    }

    /// The unit normal of the left face.
    pub(super) fn normal(&self) -> Vector3<f64> {
        self.left.normalize()
    }

    /// The fold angle.
    pub(super) fn angle(&self) -> f64 {
        let sine = self.right.cross(&self.left).dot(&self.along) / self.along.norm();
        sine.atan2(self.left.dot(&self.right))
    }

    /// The derivatives of the fold angle by the two ends and the two opposite vertices.
    pub(super) fn gradient(&self) -> [Vector3<f64>; 4] {
        let squared = self.along.norm_squared();
        let length = squared.sqrt();
        // Per unit of height of an opposite vertex the angle grows by the inverse of its distance from the
        // edge.
        let (g_l, g_r) = (
            self.left * (length / self.left.norm_squared()),
            self.right * (length / self.right.norm_squared()),
        );
        let s_l = self.to_left.dot(&self.along) / squared;
        let s_r = self.to_right.dot(&self.along) / squared;
        [
            (s_l - 1.0) * g_l + (s_r - 1.0) * g_r,
            -s_l * g_l - s_r * g_r,
            g_l,
            g_r,
        ]
    }
}
