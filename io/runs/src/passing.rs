//! Whether panels of a sheet that does not touch itself pass through each other.

use isosheet_geometry::{BroadPhase, ContactMesh};
use isosheet_mesh::Topology;
use isosheet_scenes::{Folding, size};

/// How deep an edge is in a panel that passes through it, beside the longest side of the sheet: two
/// thicknesses of office paper of 0.2 m. Panels that lie on each other in one plane are less deep in each
/// other, by round-off.
const DEEP: f64 = 1e-3;

/// When panels pass through each other in a motion.
#[derive(Debug)]
pub(super) struct Passing {
    boxes: BroadPhase,
    depth: f64,
    /// The first time at which they do, seconds.
    first: Option<f64>,
}

impl Passing {
    /// Where the motion begins, at positions `x` (`3V`, metres).
    pub(super) fn begin(topology: &Topology, x: &[f64]) -> Self {
        Self {
            boxes: BroadPhase::new(ContactMesh::from_topology(topology), x),
            depth: DEEP * size(x.as_chunks::<3>().0),
            first: None,
        }
    }

    /// At the next time (seconds) and positions.
    pub(super) fn follow(&mut self, t: f64, x: &[f64]) {
        if self.first.is_some() {
            return;
        }
        self.boxes.update(x, x, 0.0);
        if self.boxes.self_crossing(x, self.depth).is_some() {
            self.first = Some(t);
        }
    }

    /// The part of a folding that is done when panels first pass through each other.
    pub(super) fn part_of(&self, folding: Option<&Folding>) -> Option<f64> {
        Some(folding?.progress(self.first?))
    }
}
