//! Vectors of all vertices: flat slices of length `3V`.

use isosheet_mesh::VertexId;
use nalgebra::Vector3;

/// The coordinates of a vertex.
pub(crate) fn point(x: &[f64], v: VertexId) -> Vector3<f64> {
    Vector3::from(x.as_chunks::<3>().0[v.index()])
}

/// Adds to the coordinates of a vertex.
pub(crate) fn add(x: &mut [f64], v: VertexId, d: &Vector3<f64>) {
    for (x, d) in x.as_chunks_mut::<3>().0[v.index()].iter_mut().zip(d) {
        *x += d;
    }
}

/// Inner product.
pub(crate) fn dot(a: &[f64], b: &[f64]) -> f64 {
    a.iter().zip(b).map(|(a, b)| a * b).sum()
}

/// Largest norm of the vectors of the vertices.
pub(crate) fn largest_norm(values: &[f64]) -> f64 {
    let vectors = values.as_chunks::<3>().0.iter();
    vectors
        .map(|v| Vector3::from(*v).norm())
        .fold(0.0, f64::max)
}
