//! Crease patterns as SVG drawings by the colours of Origami Simulator.

use super::Segment;
use super::svg_lines::{StrokeLine, stroke_lines};
use crate::format::DataError;
use crate::format::mesh_file::EdgeAssignment;
use std::f64::consts::PI;

/// Curves become lines that are nowhere further away, as a part of the size of the drawing.
const FLATNESS: f64 = 1e-3;

/// A colour is one of those of the format if none of its parts, of 255, is further from it.
const TOLERANCE: u8 = 60;

/// The lines of the drawing: black and the like the outline, red a mountain, blue a valley, green a cut, yellow what stays
/// flat, magenta what folds freely. The opacity of mountains and valleys is their fold angle as a part of 180 degrees.
/// Strokes of other colours are none of the pattern.
pub(in crate::format) fn parse(bytes: &[u8]) -> Result<Vec<Segment>, DataError> {
    let lines = stroke_lines(bytes, FLATNESS)?;
    Ok(lines.iter().filter_map(segment).collect())
}

fn segment(line: &StrokeLine) -> Option<Segment> {
    let assignment = assignment(line.colour?)?;
    let angle = match assignment {
        EdgeAssignment::Mountain => Some(-line.opacity * PI),
        EdgeAssignment::Valley => Some(line.opacity * PI),
        _ => None,
    };
    Some(Segment {
        ends: line.ends.map(|[x, y]| [x, -y]),
        assignment,
        angle,
    })
}

/// What a line of a colour is meant to do.
fn assignment(colour: [u8; 3]) -> Option<EdgeAssignment> {
    let full = |c: u8| match c {
        low if low <= TOLERANCE => Some(false),
        high if high >= u8::MAX - TOLERANCE => Some(true),
        _ => None,
    };
    // The name `green` has half of the light.
    if colour == [0, 128, 0] {
        return Some(EdgeAssignment::Cut);
    }
    let [red, green, blue] = colour.map(full);
    Some(match (red?, green?, blue?) {
        (false, false, false) => EdgeAssignment::Boundary,
        (true, false, false) => EdgeAssignment::Mountain,
        (false, false, true) => EdgeAssignment::Valley,
        (false, true, false) => EdgeAssignment::Cut,
        (true, true, false) => EdgeAssignment::Flat,
        (true, false, true) => EdgeAssignment::Unassigned,
        _ => return None,
    })
}
