//! A motion of the sheet that is searched for pairs.

use super::thickness::{Clearance, Thickness};
use isosheet_geometry::{CcdOptions, ContactMesh};
use std::ops::Range;

/// A motion of the sheet and what the search for pairs needs to know about it.
#[derive(Debug, Clone, Copy)]
pub(super) struct SheetMotion<'a> {
    pub(super) mesh: &'a ContactMesh,
    /// The vertices that move in a prescribed way.
    pub(super) driven: &'a Range<u32>,
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
    /// Whether a primitive meets bodies, by one of its vertices: one that moves in a prescribed way does not,
    /// as bodies do so too.
    pub(super) fn meets_bodies(&self, vertex: u32) -> bool {
        !self.driven.contains(&vertex) && self.mesh.takes_part(vertex)
    }

    /// Of the pair of two primitives, the first one of which has the first and the second one the last of
    /// these vertices.
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
