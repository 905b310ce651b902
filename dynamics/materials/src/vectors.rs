//! Vectors of all vertices: flat slices of length `3V`.

use isosheet_mesh::VertexId;
use nalgebra::Vector3;

/// The coordinates of a vertex.
pub fn point(x: &[f64], v: VertexId) -> Vector3<f64> {
    let i = 3 * v.index();
    Vector3::new(x[i], x[i + 1], x[i + 2])
}

/// Adds to the coordinates of a vertex.
pub fn add(x: &mut [f64], v: VertexId, d: &Vector3<f64>) {
    for k in 0..3 {
        x[3 * v.index() + k] += d[k];
    }
}

/// Inner product.
pub fn dot(a: &[f64], b: &[f64]) -> f64 {
    a.iter().zip(b).map(|(a, b)| a * b).sum()
}

/// Largest norm of the vectors of the vertices.
pub fn largest_norm(values: &[f64]) -> f64 {
    let vectors = values.as_chunks::<3>().0.iter();
    vectors
        .map(|v| Vector3::from(*v).norm())
        .fold(0.0, f64::max)
}

/// Diagonal of the box around the vertices, metres.
pub fn diameter(x: &[f64]) -> f64 {
    let extent = |k: usize| {
        let values = || x.as_chunks::<3>().0.iter().map(move |p| p[k]);
        values().fold(f64::NEG_INFINITY, f64::max) - values().fold(f64::INFINITY, f64::min)
    };
    Vector3::new(extent(0), extent(1), extent(2)).norm()
}
