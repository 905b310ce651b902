//! Three-vectors over any differentiable scalar.
//!
//! Coordinate gradients are written once, generic over the scalar; evaluated with plain `f64` they
//! are the rows of the chart, evaluated with dual numbers they give the exact rate of these rows
//! along a velocity.

use isosheet_mesh::VertexId;
use num_dual::DualNum;

/// A real scalar: `f64`, or a dual number over it.
pub(crate) trait Scalar: DualNum<Primitive = f64> + Copy {}
impl<T: DualNum<Primitive = f64> + Copy> Scalar for T {}

/// A three-vector.
pub(crate) type Vec3<T> = [T; 3];

/// The three values of vertex `v` in a slice of three values per vertex.
pub(crate) fn at(x: &[f64], v: VertexId) -> Vec3<f64> {
    let i = 3 * v.index();
    [x[i], x[i + 1], x[i + 2]]
}

pub(crate) fn lift<T: Scalar>(a: &Vec3<f64>) -> Vec3<T> {
    [T::from(a[0]), T::from(a[1]), T::from(a[2])]
}

pub(crate) fn add<T: Scalar>(a: &Vec3<T>, b: &Vec3<T>) -> Vec3<T> {
    [a[0] + b[0], a[1] + b[1], a[2] + b[2]]
}

pub(crate) fn sub<T: Scalar>(a: &Vec3<T>, b: &Vec3<T>) -> Vec3<T> {
    [a[0] - b[0], a[1] - b[1], a[2] - b[2]]
}

pub(crate) fn scale<T: Scalar>(a: &Vec3<T>, s: T) -> Vec3<T> {
    [a[0] * s, a[1] * s, a[2] * s]
}

/// `a + s b`.
pub(crate) fn axpy<T: Scalar>(a: &Vec3<T>, s: T, b: &Vec3<T>) -> Vec3<T> {
    [a[0] + s * b[0], a[1] + s * b[1], a[2] + s * b[2]]
}

pub(crate) fn neg<T: Scalar>(a: &Vec3<T>) -> Vec3<T> {
    [-a[0], -a[1], -a[2]]
}

pub(crate) fn dot<T: Scalar>(a: &Vec3<T>, b: &Vec3<T>) -> T {
    a[0] * b[0] + a[1] * b[1] + a[2] * b[2]
}

pub(crate) fn cross<T: Scalar>(a: &Vec3<T>, b: &Vec3<T>) -> Vec3<T> {
    [
        a[1] * b[2] - a[2] * b[1],
        a[2] * b[0] - a[0] * b[2],
        a[0] * b[1] - a[1] * b[0],
    ]
}

pub(crate) fn norm<T: Scalar>(a: &Vec3<T>) -> T {
    DualNum::sqrt(&dot(a, a))
}

/// A unit vector perpendicular to the unit vector `a`, built from the coordinate axis that is least
/// aligned with it.
pub(crate) fn any_perpendicular(a: &Vec3<f64>) -> Vec3<f64> {
    let mut k = 0;
    for i in 1..3 {
        if a[i].abs() < a[k].abs() {
            k = i;
        }
    }
    let mut e = [0.0; 3];
    e[k] = 1.0;
    let p = axpy(&e, -dot(&e, a), a);
    scale(&p, 1.0 / norm(&p))
}

/// Inverse of the matrix with the given rows, or `None` when it is singular to working precision.
///
/// Singular means a determinant below 1e-14 of the product of the row lengths: from there on no
/// digit of the inverse is right.
pub(crate) fn inverse(rows: &[Vec3<f64>; 3]) -> Option<[Vec3<f64>; 3]> {
    let c = [
        cross(&rows[1], &rows[2]),
        cross(&rows[2], &rows[0]),
        cross(&rows[0], &rows[1]),
    ];
    let det = dot(&rows[0], &c[0]);
    let size = norm(&rows[0]) * norm(&rows[1]) * norm(&rows[2]);
    if !det.is_finite() || det.abs() <= 1e-14 * size {
        return None;
    }
    // Column k of the inverse is c[k] / det; returned as rows of the inverse.
    let mut inv = [[0.0; 3]; 3];
    for i in 0..3 {
        for k in 0..3 {
            inv[i][k] = c[k][i] / det;
        }
    }
    Some(inv)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn inverse_of_rows() {
        let a = [[1.0, 2.0, 0.5], [-0.3, 1.0, 4.0], [0.0, 2.0, 1.0]];
        let b = inverse(&a).unwrap();
        for i in 0..3 {
            for j in 0..3 {
                let s: f64 = (0..3).map(|k| a[i][k] * b[k][j]).sum();
                assert!((s - f64::from(u8::from(i == j))).abs() < 1e-14);
            }
        }
        assert!(inverse(&[[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [1.0, 1.0, 0.0]]).is_none());
    }
}
