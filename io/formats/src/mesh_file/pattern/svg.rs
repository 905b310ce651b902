//! Crease patterns as SVG drawings by the colours of Origami Simulator.

use super::{PatternLines, Segment};
use crate::mesh_file::EdgeAssignment;
use isosheet_drawings::{DrawnLines, Pen, svg};
use isosheet_files::DataError;
use std::collections::BTreeSet;
use std::f64::consts::PI;

/// Curves become lines that turn by so much at most, radians: 10 degrees.
const TURN: f64 = PI / 18.0;

/// The lines of the drawing: black the outline, red a mountain, blue a valley, green a cut, yellow what stays
/// flat, magenta what folds freely. The opacity of mountains and valleys is their fold angle as a part of 180
/// degrees. Lines of other colours and shapes without a stroke are none of the pattern, and counted.
pub(crate) fn parse(bytes: &[u8]) -> Result<PatternLines, DataError> {
    let drawing = svg::parse(bytes, svg::Areas::LeftOut, None, 1.0)?;
    let (mut drawn, numbers) = DrawnLines::of_pens(&drawing.pens);
    let mut segments = Vec::new();
    let mut of_other_colours = 0;
    for line in &drawing.lines {
        let pen = &drawing.pens[line.pen];
        let Some(assignment) = assignment(pen) else {
            // White ones cannot be seen.
            of_other_colours += usize::from(pen.colour.name() != Some("white"));
            continue;
        };
        let angle = match assignment {
            EdgeAssignment::Mountain => Some(-pen.opacity * PI),
            EdgeAssignment::Valley => Some(pen.opacity * PI),
            _ => None,
        };
        let of_pen = drawn.set(BTreeSet::from([numbers[line.pen]]));
        let places = line.curve.subdivide([0.0, 1.0], f64::INFINITY, TURN);
        let segment = |ends: &[f64]| Segment {
            ends: [ends[0], ends[1]].map(|t| line.curve.point(t)),
            assignment,
            angle,
            drawn: Some(of_pen),
        };
        segments.extend(places.windows(2).map(segment));
    }
    Ok(PatternLines {
        segments,
        in_metres: drawing.assumed_unit.is_none(),
        drawn,
        of_other_colours,
        left_out: drawing.left_out,
    })
}

/// What a line is meant to do by its colour.
fn assignment(pen: &Pen) -> Option<EdgeAssignment> {
    Some(match pen.colour.name()? {
        "black" => EdgeAssignment::Boundary,
        "red" => EdgeAssignment::Mountain,
        "blue" => EdgeAssignment::Valley,
        "green" => EdgeAssignment::Cut,
        "yellow" => EdgeAssignment::Flat,
        "magenta" => EdgeAssignment::Unassigned,
        _ => return None,
    })
}
