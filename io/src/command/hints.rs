//! What to know of a sheet that can be simulated, and may not do what was meant: lines of text, or none.

use crate::mesh::wording::brief;
use crate::mesh::{Sheet, VertexId};

/// Width from which the unit of a file is questioned, metres: hardly a sheet is larger than a big tent, and
/// files in millimetres, points or pixels are.
const WIDE: f64 = 20.0;

/// Closed parts: they have `3V - E = 3 chi`, at most the six degrees of freedom of a rigid body, and almost
/// all of them are rigid ([`Dof`](crate::mesh::Dof)).
pub(crate) fn closed(sheet: &Sheet) -> String {
    let t = sheet.topology();
    let parts = t.components();
    let is_closed = |part: &&Vec<VertexId>| !part.iter().any(|&v| t.is_boundary_vertex(v));
    let what = match (parts.iter().filter(is_closed).count(), parts.len()) {
        (0, _) => return String::new(),
        (n, all) if n == all => "the surface is closed".to_owned(),
        (n, all) => format!("{n} of the {all} parts are closed surfaces"),
    };
    format!(
        "note: {what}: a sheet of rigid rods without a boundary cannot bend; cut it open along some edges, or make it \
         an obstacle\n"
    )
}

/// A sheet of a file whose unit is not that of the scene, as it seems.
pub(crate) fn wide(sheet: &Sheet) -> String {
    let points = sheet.positions().as_chunks::<3>().0;
    let extent = |k: usize| {
        let along = points.iter().map(|p| p[k]);
        along.clone().fold(f64::NEG_INFINITY, f64::max) - along.fold(f64::INFINITY, f64::min)
    };
    let width = (0..3).map(extent).fold(0.0, f64::max);
    if width <= WIDE {
        return String::new();
    }
    format!(
        "note: the sheet is {} m wide, as the numbers of a file are taken for metres; of a file in millimetres write \
         `scale = 0.001` beside `path` in the scene\n",
        brief(width)
    )
}
