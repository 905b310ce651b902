//! Points, edges and faces that stand for a body where a mesh meets it.

use crate::contact_mesh::ContactMesh;

/// Primitives whose distance, less a radius, is the distance from a body.
#[derive(Debug, Clone, PartialEq)]
pub struct ContactGeometry {
    /// Vertices, edges and faces.
    pub mesh: ContactMesh,
    /// Positions of the vertices in the body's frame, `3V`, metres.
    pub positions: Vec<f64>,
    /// Thickness about the primitives, metres: the separation that contact has to add.
    pub radius: f64,
}

impl ContactGeometry {
    /// Triangles without a radius, by the positions of their corners (`3V`, metres).
    ///
    /// # Panics
    /// If the faces name corners that do not exist, or one of them twice.
    pub fn of_triangles(positions: Vec<f64>, faces: &[[u32; 3]]) -> Self {
        let mesh = ContactMesh::from_triangles(positions.len() / 3, faces);
        Self {
            mesh: mesh.expect("the faces of a shape name its corners"),
            positions,
            radius: 0.0,
        }
    }

    /// All within a radius (metres) of the origin.
    pub(super) fn about_point(radius: f64) -> Self {
        Self {
            mesh: ContactMesh::point(),
            positions: vec![0.0; 3],
            radius,
        }
    }

    /// All within a radius (metres) of the z axis from `-half_length` to `half_length`.
    pub(super) fn about_segment(radius: f64, half_length: f64) -> Self {
        Self {
            mesh: ContactMesh::segment(),
            positions: vec![0.0, 0.0, -half_length, 0.0, 0.0, half_length],
            radius,
        }
    }
}
