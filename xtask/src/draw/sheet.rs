//! Flat sheets seen from above.

use super::colour::Colour;
use super::drawing::{Drawing, Stroke};
use isosheet_mesh::{EdgeId, FaceId, Sheet, VertexId};

/// Place of a vertex of a flat sheet in the drawing, `scale` points per metre.
pub(crate) fn plan(sheet: &Sheet, scale: f64) -> impl Fn(VertexId) -> [f64; 2] + '_ {
    move |v| {
        let p = sheet.position(v);
        [scale * p[0], scale * p[1]]
    }
}

/// Draws the faces; `colour` gives the colour of each.
pub(crate) fn flat_faces(
    drawing: &mut Drawing,
    sheet: &Sheet,
    scale: f64,
    colour: impl Fn(FaceId) -> Colour,
) {
    let place = plan(sheet, scale);
    for f in sheet.topology().face_ids() {
        let corners = sheet.topology().faces()[f.index()].map(&place);
        drawing.polygon(&corners, colour(f));
    }
}

/// Draws the edges for which `stroke` gives a style.
pub(crate) fn flat_edges(
    drawing: &mut Drawing,
    sheet: &Sheet,
    scale: f64,
    stroke: impl Fn(EdgeId) -> Option<Stroke>,
) {
    let place = plan(sheet, scale);
    for e in sheet.topology().edge_ids() {
        if let Some(stroke) = stroke(e) {
            drawing.line(&sheet.topology().edges()[e.index()].map(&place), stroke);
        }
    }
}
