//! Vectors of space as arrays, which are given by value or by reference.

use std::borrow::Borrow;

/// A vector or a point of space.
pub type Vec3 = [f64; 3];

/// Position of vertex `v` in a flat array of length 3V.
#[inline]
pub(crate) fn at(x: &[f64], v: crate::VertexId) -> Vec3 {
    let i = 3 * v.index();
    [x[i], x[i + 1], x[i + 2]]
}

/// The vector `a + s b`.
#[inline]
pub fn axpy(a: impl Borrow<Vec3>, s: f64, b: impl Borrow<Vec3>) -> Vec3 {
    let (a, b) = (a.borrow(), b.borrow());
    [a[0] + s * b[0], a[1] + s * b[1], a[2] + s * b[2]]
}

/// The difference `a - b`.
#[inline]
pub fn sub(a: impl Borrow<Vec3>, b: impl Borrow<Vec3>) -> Vec3 {
    let (a, b) = (a.borrow(), b.borrow());
    [a[0] - b[0], a[1] - b[1], a[2] - b[2]]
}

/// The scalar product.
#[inline]
pub fn dot(a: impl Borrow<Vec3>, b: impl Borrow<Vec3>) -> f64 {
    let (a, b) = (a.borrow(), b.borrow());
    a[0] * b[0] + a[1] * b[1] + a[2] * b[2]
}

/// The vector product.
#[inline]
pub fn cross(a: impl Borrow<Vec3>, b: impl Borrow<Vec3>) -> Vec3 {
    let (a, b) = (a.borrow(), b.borrow());
    [
        a[1] * b[2] - a[2] * b[1],
        a[2] * b[0] - a[0] * b[2],
        a[0] * b[1] - a[1] * b[0],
    ]
}

/// The length.
#[inline]
pub fn norm(a: impl Borrow<Vec3>) -> f64 {
    let a = a.borrow();
    dot(a, a).sqrt()
}

/// The vector of length 1 in the direction of `a`, or `a` itself where it has no length.
#[inline]
pub fn unit(a: impl Borrow<Vec3>) -> Vec3 {
    let a = a.borrow();
    let length = norm(a);
    if length > 0.0 {
        a.map(|c| c / length)
    } else {
        *a
    }
}
