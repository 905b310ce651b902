//! A motion of the sheet that is searched for pairs.

use super::thickness::{Clearance, Thickness};
use crate::{CcdOptions, ContactMesh};

/// A motion of the sheet and what the search for pairs needs to know about it.
#[derive(Debug, Clone, Copy)]
pub(super) struct SheetMotion<'a> {
    pub(super) mesh: &'a ContactMesh,
    pub(super) x: &'a [f64],
    pub(super) dx: &'a [f64],
    pub(super) thickness: &'a Thickness,
    /// Gap below which the barrier acts, metres.
    pub(super) activation: f64,
    /// Largest distance below which the barrier acts between any two parts, metres.
    pub(super) reach: f64,
    pub(super) ccd: &'a CcdOptions,
}

impl SheetMotion<'_> {
    /// Of the pair of two primitives, the first one of which has the first and the second one the last of these
    /// vertices.
    pub(super) fn of_pair(&self, [first, .., last]: [u32; 4]) -> Clearance {
        self.thickness
            .clearance(self.mesh, [first, last], self.activation)
    }

    /// Of a primitive with this vertex and an obstacle.
    pub(super) fn of_obstacle(&self, vertex: u32) -> Clearance {
        self.thickness
            .obstacle_clearance(self.mesh, vertex, self.activation)
    }
}

/// The vertices of the pair of a vertex and a face.
pub(super) fn vertex_face(mesh: &ContactMesh, [v, f]: [u32; 2]) -> [u32; 4] {
    let [a, b, c] = mesh.faces()[f as usize];
    [v, a, b, c]
}

/// The vertices of the pair of two edges.
pub(super) fn two_edges(mesh: &ContactMesh, [e, g]: [u32; 2]) -> [u32; 4] {
    let ([a, b], [c, d]) = (mesh.edges()[e as usize], mesh.edges()[g as usize]);
    [a, b, c, d]
}
