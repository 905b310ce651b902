//! Clamps along lines of vertices.

use crate::vectors::point;
use isosheet_mesh::{EdgeId, FaceId, Sheet, VertexId};
use isosheet_motion::RigidMotion;
use nalgebra::Vector3;
use std::collections::BTreeSet;

/// A clamp that holds the slope of a plate at the edges between its vertices: each face at such an edge keeps
/// there the direction that it has at given positions, turned by the rotation of the clamp. The vertices
/// themselves are held by pins, or on lines along which the clamp slides.
///
/// A face whose three corners are pinned holds the slope at its edges by itself
/// ([`PlateBending::clamped`](crate::PlateBending::clamped)); a single line of vertices does by this.
#[derive(Debug, Clone)]
pub struct LineClamp {
    /// The vertices.
    pub vertices: Vec<VertexId>,
    /// The positions at which faces have the slopes that the clamp holds, `3V`, metres: of the sheet that the
    /// plate is made of.
    pub positions: Vec<f64>,
    /// Its motion, of which the rotation counts.
    pub motion: RigidMotion,
}

/// What holds a plate or interrupts it, see [`PlateBending::held`](crate::PlateBending::held).
#[derive(Debug, Clone, Copy, Default)]
pub struct PlateEdges<'a> {
    /// Pinned vertices: where all three corners of a face are among them, the plate leaves the clamp with the
    /// slope of that face.
    pub pinned: &'a [VertexId],
    /// Edges of creases: the slopes of the two sides are independent there.
    pub creases: &'a [EdgeId],
    /// Clamps along lines of vertices.
    pub clamps: &'a [LineClamp],
}

/// The slope of a face at an edge, held by a clamp: a vector that turns with it.
#[derive(Debug, Clone)]
pub(super) struct Director {
    pub(super) clamp: usize,
    /// The outward normal of the edge in the plane of the face, without rotation of the clamp.
    pub(super) rest: Vector3<f64>,
    /// Its weights in the stencil of the face.
    pub(super) weights: Vector3<f64>,
}

/// Which edges clamps hold.
pub(super) struct HeldEdges<'a> {
    clamps: &'a [LineClamp],
    /// Of each edge its clamp.
    of_edges: Vec<Option<usize>>,
}

impl<'a> HeldEdges<'a> {
    pub(super) fn new(sheet: &Sheet, clamps: &'a [LineClamp]) -> Self {
        let topology = sheet.topology();
        let mut of_edges = vec![None; topology.edge_count()];
        for (number, clamp) in clamps.iter().enumerate() {
            let held: BTreeSet<VertexId> = clamp.vertices.iter().copied().collect();
            for (of_edge, ends) in of_edges.iter_mut().zip(topology.edges()) {
                if ends.iter().all(|v| held.contains(v)) {
                    *of_edge = Some(number);
                }
            }
        }
        Self { clamps, of_edges }
    }

    pub(super) fn holds(&self, edge: EdgeId) -> bool {
        self.of_edges[edge.index()].is_some()
    }

    /// The clamp that holds a face at an edge, and the outward normal there.
    pub(super) fn director(
        &self,
        sheet: &Sheet,
        face: FaceId,
        edge: EdgeId,
    ) -> Option<(usize, Vector3<f64>)> {
        let number = self.of_edges[edge.index()]?;
        let x = &self.clamps[number].positions;
        let topology = sheet.topology();
        let [a, b] = topology.edges()[edge.index()];
        let corners = topology.faces()[face.index()];
        let third = corners.into_iter().find(|v| *v != a && *v != b)?;
        let [a, b, c] = [a, b, third].map(|v| point(x, v));
        let along = (b - a).normalize();
        let inward = (c - a) - along * along.dot(&(c - a));
        Some((number, -inward.normalize()))
    }
}
