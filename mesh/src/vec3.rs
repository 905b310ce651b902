//! The few vector operations that the geometry needs, on `[f64; 3]`.

pub(crate) type Vec3 = [f64; 3];

/// Position of vertex `v` in a flat array of length 3V.
#[inline]
pub(crate) fn at(x: &[f64], v: crate::VertexId) -> Vec3 {
    let i = 3 * v.index();
    [x[i], x[i + 1], x[i + 2]]
}

#[inline]
pub(crate) fn sub(a: Vec3, b: Vec3) -> Vec3 {
    [a[0] - b[0], a[1] - b[1], a[2] - b[2]]
}

#[inline]
pub(crate) fn dot(a: Vec3, b: Vec3) -> f64 {
    a[0] * b[0] + a[1] * b[1] + a[2] * b[2]
}

#[inline]
pub(crate) fn cross(a: Vec3, b: Vec3) -> Vec3 {
    [
        a[1] * b[2] - a[2] * b[1],
        a[2] * b[0] - a[0] * b[2],
        a[0] * b[1] - a[1] * b[0],
    ]
}

#[inline]
pub(crate) fn norm(a: Vec3) -> f64 {
    dot(a, a).sqrt()
}
