//! A motion of the sheet that is searched for pairs.

use crate::{CcdOptions, ContactMesh};

/// A motion of the sheet and what the search for pairs needs to know about it.
#[derive(Debug, Clone, Copy)]
pub(super) struct SheetMotion<'a> {
    pub(super) mesh: &'a ContactMesh,
    pub(super) x: &'a [f64],
    pub(super) dx: &'a [f64],
    /// Distance below which the barrier acts, metres.
    pub(super) reach: f64,
    pub(super) ccd: &'a CcdOptions,
}

impl SheetMotion<'_> {
    /// Distance from which continuous collision detection is needed, metres: half way between contact and the
    /// reach of the barrier. Pairs that stay further apart need none; the margin is larger than round-off.
    pub(super) fn trigger_distance(&self) -> f64 {
        self.ccd.separation + 0.5 * (self.reach - self.ccd.separation)
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
