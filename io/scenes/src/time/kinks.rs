//! The angles by which creases are folded.

use isosheet_mesh::{EdgeId, Topology, fold_angle};

/// The angles of creases at a state. The fold angle of the two faces at an edge has two parts: the kink of
/// the crease, which its spring resists, and the bend of the faces beside it
/// ([`SheetModel::bends_at_creases`](isosheet_dynamics::SheetModel::bends_at_creases)). Where nothing bends,
/// the kink is the fold angle.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Kinks<'a> {
    topology: &'a Topology,
    x: &'a [f64],
    /// Of each edge, radians; empty where nothing bends beside creases.
    bends: &'a [f64],
}

impl<'a> Kinks<'a> {
    /// At positions `x` (`3V`, metres), with the bends beside the creases (of each edge, radians, positive
    /// for a valley); an empty slice says that there are none.
    pub(crate) fn new(topology: &'a Topology, x: &'a [f64], bends: &'a [f64]) -> Self {
        Self { topology, x, bends }
    }

    /// The kink of an edge, radians within half a turn to both sides but for its bend, positive for a valley;
    /// 0 at a boundary.
    pub(crate) fn angle(&self, edge: EdgeId) -> f64 {
        let fold = fold_angle(self.topology, self.x, edge).unwrap_or(0.0);
        match self.bends.get(edge.index()) {
            Some(bend) => fold - bend,
            None => fold,
        }
    }
}
