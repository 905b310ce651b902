//! Points of a list of coordinates, and comparisons that pass on what is not a number.

use nalgebra::Vector3;

/// The points with the given numbers, of a list of three coordinates for each.
///
/// # Panics
/// If a point does not exist.
#[inline]
pub fn gather<const N: usize>(x: &[f64], vertices: [u32; N]) -> [Vector3<f64>; N] {
    vertices.map(|v| {
        let i = 3 * v as usize;
        Vector3::new(x[i], x[i + 1], x[i + 2])
    })
}

/// The minimum, or not a number if one of the two is not: a broken state must not pass for a wide
/// gap.
#[inline]
pub fn smaller(a: f64, b: f64) -> f64 {
    if a.is_nan() || b.is_nan() {
        f64::NAN
    } else {
        a.min(b)
    }
}

/// The maximum, or not a number if one of the two is not.
#[inline]
pub fn larger(a: f64, b: f64) -> f64 {
    -smaller(-a, -b)
}
