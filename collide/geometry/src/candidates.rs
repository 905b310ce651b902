//! Pairs of primitives that may meet, and what all of them allow.

use crate::ccd::CcdOptions;
use crate::contact_mesh::ContactMesh;
use crate::distance::{edge_edge, point_triangle};
use crate::vectors::{gather, smaller};

/// Pairs of primitives of one mesh whose swept boxes overlap.
#[derive(Debug, Clone, Default, PartialEq, Eq)]
pub struct Candidates {
    /// Vertex and face; the vertex is no corner of the face, nor glued to one.
    pub vertex_face: Vec<[u32; 2]>,
    /// Two edges without a common end, glued or not, the lower number first.
    pub edge_edge: Vec<[u32; 2]>,
}

/// Pairs of primitives of two meshes whose swept boxes overlap.
#[derive(Debug, Clone, Default, PartialEq, Eq)]
pub struct CrossCandidates {
    /// Vertex of the first mesh and face of the second.
    pub vertex_face: Vec<[u32; 2]>,
    /// Face of the first mesh and vertex of the second.
    pub face_vertex: Vec<[u32; 2]>,
    /// Edge of the first mesh and edge of the second.
    pub edge_edge: Vec<[u32; 2]>,
}

impl Candidates {
    /// Number of pairs.
    pub fn len(&self) -> usize {
        self.vertex_face.len() + self.edge_edge.len()
    }

    /// Whether there is no pair.
    pub fn is_empty(&self) -> bool {
        self.len() == 0
    }

    /// The part of a motion of the mesh from `x` to `x + dx` (`3V`, metres), from 0 to 1, that brings none of
    /// the pairs to within the separation of the options, in which no radii of round bodies are. With the
    /// pairs of [`BroadPhase::self_candidates`](crate::BroadPhase::self_candidates) since an
    /// [update](crate::BroadPhase::update) for this motion, nothing of the mesh touches itself on that part
    /// of it.
    ///
    /// # Panics
    /// If the pairs are not those of the mesh, or the lengths of `x` and `dx` are not three times its number
    /// of vertices.
    pub fn safe_part(
        &self,
        mesh: &ContactMesh,
        options: &CcdOptions,
        x: &[f64],
        dx: &[f64],
    ) -> f64 {
        let with_radii = |[first, .., last]: [u32; 4]| CcdOptions {
            separation: options.separation + mesh.radius(first) + mesh.radius(last),
            ..*options
        };
        let part = self.vertex_face.iter().fold(1.0, |part, &pair| {
            let stencil = mesh.vertex_face(pair);
            let (x, dx) = (gather(x, stencil), gather(dx, stencil));
            with_radii(stencil).point_triangle(&x, &dx, part)
        });
        self.edge_edge.iter().fold(part, |part, &pair| {
            let stencil = mesh.edge_edge(pair);
            let (x, dx) = (gather(x, stencil), gather(dx, stencil));
            with_radii(stencil).edge_edge(&x, &dx, part)
        })
    }

    /// The smallest distance of the pairs at positions `x` (`3V`, metres), less the radii of round bodies,
    /// metres; infinite if there are none, and not a number if a coordinate is not.
    ///
    /// # Panics
    /// If the pairs are not those of the mesh, or the length of `x` is not three times its number of
    /// vertices.
    pub fn smallest_distance(&self, mesh: &ContactMesh, x: &[f64]) -> f64 {
        let radii = |[first, .., last]: [u32; 4]| mesh.radius(first) + mesh.radius(last);
        let faces = self.vertex_face.iter().map(|&pair| {
            let stencil = mesh.vertex_face(pair);
            point_triangle(&gather(x, stencil)).distance() - radii(stencil)
        });
        let edges = self.edge_edge.iter().map(|&pair| {
            let stencil = mesh.edge_edge(pair);
            edge_edge(&gather(x, stencil)).distance() - radii(stencil)
        });
        faces.chain(edges).fold(f64::INFINITY, smaller)
    }
}

impl CrossCandidates {
    /// Number of pairs.
    pub fn len(&self) -> usize {
        self.vertex_face.len() + self.face_vertex.len() + self.edge_edge.len()
    }

    /// Whether there is no pair.
    pub fn is_empty(&self) -> bool {
        self.len() == 0
    }
}
