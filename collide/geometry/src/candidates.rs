//! Pairs of primitives that may meet, and what all of them allow.

use crate::ccd::CcdOptions;
use crate::contact_mesh::ContactMesh;
use crate::distance::{edge_edge, point_triangle};
use crate::vectors::{gather, smaller};
use nalgebra::Vector3;

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

    /// The part of a motion of the mesh, from 0 to 1, that brings none of the pairs to within the separation
    /// of the options, in which no radii of round bodies are. With the pairs of
    /// [`BroadPhase::self_candidates`](crate::BroadPhase::self_candidates) since an
    /// [update](crate::BroadPhase::update) for this motion, of boxes that are enlarged by half the separation
    /// at least, the mesh keeps the separation from itself on that part of it.
    ///
    /// # Panics
    /// If the pairs are of another mesh, or the lists of the motion are too short.
    pub fn safe_part(&self, options: &CcdOptions, motion: MeshMotion<'_>) -> f64 {
        let mesh = motion.mesh;
        let vertex_face = self.vertex_face.iter().map(|&pair| mesh.vertex_face(pair));
        let part = vertex_face.fold(1.0, |part, stencil @ [first, .., last]| {
            let options = with_radii(options, mesh.radius(first) + mesh.radius(last));
            let [x, dx] = motion.of(stencil);
            options.point_triangle(&x, &dx, part)
        });
        let edge_edge = self.edge_edge.iter().map(|&pair| mesh.edge_edge(pair));
        edge_edge.fold(part, |part, stencil @ [first, .., last]| {
            let options = with_radii(options, mesh.radius(first) + mesh.radius(last));
            let [x, dx] = motion.of(stencil);
            options.edge_edge(&x, &dx, part)
        })
    }

    /// The smallest distance of the pairs at positions `x` (`3V`, metres), less the radii of round bodies,
    /// metres; infinite if there are none, and not a number if a coordinate is not.
    ///
    /// # Panics
    /// If the pairs are of another mesh, or the length of `x` is not three times its number of vertices.
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

/// A mesh on its way: its vertices go from `x` to `x + dx` on straight lines.
#[derive(Debug, Clone, Copy)]
pub struct MeshMotion<'a> {
    /// The primitives.
    pub mesh: &'a ContactMesh,
    /// Positions at the start, `3V`, metres.
    pub x: &'a [f64],
    /// Displacements, `3V`, metres.
    pub dx: &'a [f64],
}

impl MeshMotion<'_> {
    /// Places and displacements of some vertices.
    fn of<const N: usize>(&self, vertices: [u32; N]) -> [[Vector3<f64>; N]; 2] {
        [gather(self.x, vertices), gather(self.dx, vertices)]
    }

    /// How far the surface is from the vertex of a primitive, metres.
    fn radius(&self, vertex: u32) -> f64 {
        self.mesh.radius(vertex)
    }
}

/// The options of a pair whose primitives have radii of this sum, metres.
fn with_radii(options: &CcdOptions, radii: f64) -> CcdOptions {
    CcdOptions {
        separation: options.separation + radii,
        ..*options
    }
}

impl CrossCandidates {
    /// The part of the motions of both meshes, from 0 to 1, that brings none of the pairs to within the
    /// separation of the options, in which no radii of round bodies are. With the pairs of
    /// [`BroadPhase::candidates_with`](crate::BroadPhase::candidates_with) since
    /// [updates](crate::BroadPhase::update) for these motions, of boxes that are enlarged by the separation
    /// at least, both meshes together, the meshes keep it on that part of them.
    ///
    /// # Panics
    /// If the pairs are of other meshes, or the lists of the motions are too short.
    pub fn safe_part(
        &self,
        options: &CcdOptions,
        first: MeshMotion<'_>,
        second: MeshMotion<'_>,
    ) -> f64 {
        let point_triangle = |part, point: (MeshMotion<'_>, u32), face: (MeshMotion<'_>, u32)| {
            let ((of_point, v), (of_face, f)) = (point, face);
            let corners = of_face.mesh.faces()[f as usize];
            let options = with_radii(options, of_point.radius(v) + of_face.radius(corners[0]));
            let ([[p], [dp]], [[a, b, c], [da, db, dc]]) = (of_point.of([v]), of_face.of(corners));
            options.point_triangle(&[p, a, b, c], &[dp, da, db, dc], part)
        };
        let part = self.vertex_face.iter().fold(1.0, |part, &[v, f]| {
            point_triangle(part, (first, v), (second, f))
        });
        let part = self.face_vertex.iter().fold(part, |part, &[f, v]| {
            point_triangle(part, (second, v), (first, f))
        });
        self.edge_edge.iter().fold(part, |part, &[e, g]| {
            let ends = first.mesh.edges()[e as usize];
            let others = second.mesh.edges()[g as usize];
            let options = with_radii(options, first.radius(ends[0]) + second.radius(others[0]));
            let ([[a, b], [da, db]], [[c, d], [dc, dd]]) = (first.of(ends), second.of(others));
            options.edge_edge(&[a, b, c, d], &[da, db, dc, dd], part)
        })
    }

    /// Number of pairs.
    pub fn len(&self) -> usize {
        self.vertex_face.len() + self.face_vertex.len() + self.edge_edge.len()
    }

    /// Whether there is no pair.
    pub fn is_empty(&self) -> bool {
        self.len() == 0
    }
}
