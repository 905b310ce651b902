//! How far what touches stays apart.

use isosheet_geometry::{CcdOptions, ContactMesh};
use std::ops::Range;

/// The thickness of sheets, by their vertices.
#[derive(Debug, Clone)]
pub(super) struct Thickness {
    /// The thickness of all sheets, metres, unless they have their own.
    all: f64,
    /// Of each vertex of a sheet, where sheets have different ones; otherwise empty.
    of_vertices: Vec<f64>,
    /// Number of vertices of sheets. Those after them belong to bodies, which have no thickness.
    sheet_vertices: usize,
}

impl Thickness {
    /// One thickness, metres, of all sheets, which have so many vertices.
    pub(super) fn new(all: f64, sheet_vertices: usize) -> Self {
        Self {
            all,
            of_vertices: Vec::new(),
            sheet_vertices,
        }
    }

    /// Another one of some vertices of sheets.
    pub(super) fn set(&mut self, vertices: Range<usize>, thickness: f64) {
        self.of_vertices.resize(self.sheet_vertices, self.all);
        self.of_vertices[vertices].fill(thickness);
    }

    /// The thickness of the sheet of a vertex, metres; nothing of bodies.
    fn of(&self, v: u32) -> Option<f64> {
        let v = v as usize;
        let own = || self.of_vertices.get(v).copied().unwrap_or(self.all);
        (v < self.sheet_vertices).then(own)
    }

    /// The largest of all, metres.
    pub(super) fn largest(&self) -> f64 {
        let own = self.of_vertices.iter().copied().reduce(f64::max);
        own.unwrap_or(self.all)
    }

    /// The distance, metres, that the sheets or bodies of two vertices keep: of two sheets the mean of both,
    /// half of which is on each side of the middle surface of a sheet.
    pub(super) fn between(&self, first: u32, second: u32) -> f64 {
        match (self.of(first), self.of(second)) {
            (Some(a), Some(b)) => 0.5 * (a + b),
            (own, other) => own.or(other).unwrap_or(0.0),
        }
    }

    /// The distance, metres, that the sheet or body of a vertex keeps from obstacles.
    pub(super) fn against_obstacles(&self, v: u32) -> f64 {
        self.of(v).unwrap_or(0.0)
    }

    /// Which distances count between the sheets or bodies of two vertices of a mesh, with the radii of what
    /// is round.
    pub(super) fn clearance(
        &self,
        mesh: &ContactMesh,
        [first, last]: [u32; 2],
        activation: f64,
    ) -> Clearance {
        let radii = mesh.radius(first) + mesh.radius(last);
        Clearance::new(self.between(first, last) + radii, activation)
    }

    /// Which distances of a vertex of a mesh from obstacles count.
    pub(super) fn obstacle_clearance(
        &self,
        mesh: &ContactMesh,
        vertex: u32,
        activation: f64,
    ) -> Clearance {
        Clearance::new(
            self.against_obstacles(vertex) + mesh.radius(vertex),
            activation,
        )
    }
}

/// Which distances of two parts count.
#[derive(Debug, Clone, Copy)]
pub(super) struct Clearance {
    /// That which they keep, metres.
    pub(super) thickness: f64,
    /// That below which the barrier acts, metres.
    pub(super) reach: f64,
}

impl Clearance {
    pub(super) fn new(thickness: f64, activation: f64) -> Self {
        Self {
            thickness,
            reach: thickness + activation,
        }
    }

    /// Distance from which continuous collision detection is needed, metres: half way between contact and the
    /// reach of the barrier. Pairs that stay further apart need none; the margin is larger than round-off.
    pub(super) fn trigger_distance(&self) -> f64 {
        self.thickness + 0.5 * (self.reach - self.thickness)
    }

    /// The options of collision detection with this separation.
    pub(super) fn ccd(&self, options: &CcdOptions) -> CcdOptions {
        CcdOptions {
            separation: self.thickness,
            ..*options
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn two_sheets_keep_the_mean_and_bodies_add_nothing() {
        let mut thickness = Thickness::new(3e-3, 8);
        assert_eq!(thickness.between(0, 7), 3e-3);
        thickness.set(4..8, 1e-3);
        assert_eq!(thickness.between(0, 3), 3e-3);
        assert_eq!(thickness.between(0, 4), 2e-3);
        assert_eq!(thickness.between(5, 4), 1e-3);
        // 8 and later are of bodies.
        assert_eq!(
            [thickness.between(0, 8), thickness.between(9, 4)],
            [3e-3, 1e-3]
        );
        assert_eq!(
            [thickness.between(8, 9), thickness.against_obstacles(8)],
            [0.0; 2]
        );
        assert_eq!(thickness.against_obstacles(4), 1e-3);
        assert_eq!(thickness.largest(), 3e-3);
        thickness.set(0..4, 5e-4);
        assert_eq!(thickness.largest(), 1e-3);
    }
}
