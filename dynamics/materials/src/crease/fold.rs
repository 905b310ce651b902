//! The fold angle of an edge.

use crate::vectors::point;
use isosheet_mesh::VertexId;
use nalgebra::{Matrix3, Vector3};

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

    /// The second derivatives of the fold angle, 3 x 3 blocks by the two ends and the two opposite vertices.
    ///
    /// With the edge `e` from the first end and the vertex at `p` from there, the gradient of the angle by
    /// that vertex is `g = |e| n / |n|^2`, `n` the normal of the face, and by the ends `(s - 1) g` and
    /// `-s g`, `s = p . e / |e|^2`, for each of the two faces: the blocks are the derivatives of these, and
    /// that of the two opposite vertices is zero. (Tamstorf and Grinspun, "Discrete bending forces and their
    /// Jacobians", Graphical Models 75, 2013.)
    pub(super) fn hessian(&self) -> [[Matrix3<f64>; 4]; 4] {
        let mut blocks = [[Matrix3::zeros(); 4]; 4];
        let sides = [
            (2, self.to_left, self.left, 1.0),
            (3, self.to_right, self.right, -1.0),
        ];
        let e = self.along;
        let squared = e.norm_squared();
        let length = squared.sqrt();
        for (corner, p, normal, sign) in sides {
            let area = normal.norm_squared();
            let g = normal * (length / area);
            let s = p.dot(&e) / squared;
            let by_normal = (Matrix3::identity() - normal * normal.transpose() * (2.0 / area))
                * (sign * length / area);
            let g_by_edge = normal * e.transpose() / (area * length) - by_normal * p.cross_matrix();
            let g_by_corner = by_normal * e.cross_matrix();
            let s_by_edge = (p - e * (2.0 * s)).transpose() / squared;
            let s_by_corner = e.transpose() / squared;
            let first_by_edge = g * s_by_edge + g_by_edge * (s - 1.0);
            let first_by_corner = g * s_by_corner + g_by_corner * (s - 1.0);
            blocks[0][0] -= first_by_edge + first_by_corner;
            blocks[0][1] += first_by_edge;
            blocks[1][1] -= g * s_by_edge + g_by_edge * s;
            blocks[0][corner] = first_by_corner;
            blocks[1][corner] = -(g * s_by_corner + g_by_corner * s);
            blocks[corner][corner] = g_by_corner;
        }
        for row in 1..4 {
            for column in 0..row {
                blocks[row][column] = blocks[column][row].transpose();
            }
        }
        blocks
    }
}
