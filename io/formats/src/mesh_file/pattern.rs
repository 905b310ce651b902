//! Crease patterns as drawings: lines in a plane, each with what it is meant to do.
//!
//! Formats of drawings give [`Segment`]s. Ends that are near each other become one point, lines are divided
//! where they cross, and the circuits of what comes of it are the faces.

pub(super) mod cp;
mod faces;
mod gaps;
pub(super) mod opx;
mod planar;
pub(super) mod svg;
#[cfg(test)]
mod tests;

use super::plane::{NEAR, Point};
use super::{EdgeAssignment, FileCrease, polygon};
pub(super) use faces::faces;
use isosheet_drawings::DrawnLines;
use isosheet_files::DataError;
pub(super) use planar::{FileUnit, Planar, planar};
use std::collections::BTreeMap;

/// A straight line of a drawing.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Segment {
    /// Where it begins and ends, x to the right and y upwards.
    pub(super) ends: [[f64; 2]; 2],
    pub(super) assignment: EdgeAssignment,
    /// The fold angle in radians, positive for a valley, where the drawing says it.
    pub(super) angle: Option<f64>,
    /// How it is drawn, see [`PatternLines::drawn`].
    pub(super) drawn: Option<u32>,
}

/// The lines of a drawing, and how much of it is something else.
#[derive(Clone, Debug, Default, PartialEq)]
pub(super) struct PatternLines {
    pub(super) segments: Vec<Segment>,
    /// Whether the drawing says how long its unit is.
    pub(super) in_metres: bool,
    /// How they are drawn, where the format has colours and layers.
    pub(super) drawn: DrawnLines,
    /// Visible lines of colours that mean nothing.
    pub(super) of_other_colours: usize,
    /// What is left out besides, with its number: texts, images, what is hidden, colours that are not
    /// understood.
    pub(super) left_out: BTreeMap<String, usize>,
}

/// Ends of lines that are so near each other become one point, as a part of the longer side of the drawing,
/// unless the reader is told otherwise: the first of these distances with which no face crosses itself, every
/// line leads somewhere and no two contradict each other, or else fewest do so. They are above the digits
/// that drawing programs write, and at most a millimetre of a sheet of twenty centimetres.
const SNAP: [f64; 4] = [5e-4, 1e-3, 2e-3, 5e-3];

/// The planar graph of a drawing. `snap` is the distance within which points become one, in the unit of the
/// drawing.
///
/// # Errors
/// [`DataError`] for lines that are no drawing of a sheet.
pub(super) fn of_segments(segments: &[Segment], snap: Option<f64>) -> Result<Planar, DataError> {
    let ends = || segments.iter().flat_map(|s| s.ends);
    if let Some(line) = segments
        .iter()
        .position(|s| s.ends.iter().flatten().any(|c| !c.is_finite()))
    {
        let message = format!("an end of line {line}, counted from 0, is not finite");
        return Err(DataError::new(message, "correct it, or remove the line").at(line));
    }
    let points: Vec<Point> = ends().map(|[x, y]| [x, y, 0.0]).collect();
    let size = extent(&points);
    if size <= 0.0 {
        let message = "the drawing has no lines of the colours or kinds of a crease pattern";
        let remedy = "draw the outline of the sheet and its creases in the colours of the page \"Folding a crease pattern\" of \
                      the book, or say which lines fold, `isosheet mesh DRAWING -o FILE.fold --spacing 5mm --valley \
                      layer:NAME` (or a colour), and fold FILE.fold";
        return Err(DataError::new(message, remedy));
    }
    let edge = |(k, segment): (u32, &Segment)| FileCrease {
        ends: [2 * k, 2 * k + 1],
        assignment: segment.assignment,
        angle: segment.angle,
        drawn: segment.drawn,
    };
    let edges: Vec<FileCrease> = (0..).zip(segments).map(edge).collect();
    match snap {
        Some(snap) => within(&points, &edges, snap),
        None => snapped(&points, &edges, SNAP.map(|snap| snap * size)),
    }
}

/// The planar graph of the edges of a crease pattern whose points are one within `snap`, or else within their
/// round-off; where that leaves faults that a larger distance mends, within the distances of drawings.
///
/// # Errors
/// [`DataError`] for edges that are no drawing of a sheet.
pub(super) fn of_edges(
    points: &[Point],
    edges: &[FileCrease],
    snap: Option<f64>,
) -> Result<Planar, DataError> {
    let size = extent(points);
    match snap {
        Some(snap) => within(points, edges, snap),
        None => {
            let distances = std::iter::once(NEAR).chain(SNAP);
            snapped(points, edges, distances.map(|snap| snap * size))
        }
    }
}

/// The longer side of the box about points.
pub(super) fn extent(points: &[Point]) -> f64 {
    let side = |k: usize| {
        let [low, high] = faces::bounds(points.iter().map(|p| p[k]));
        high - low
    };
    side(0).max(side(1))
}

/// The planar graph with the first of some distances that leaves fewest faults.
fn snapped(
    points: &[Point],
    edges: &[FileCrease],
    distances: impl IntoIterator<Item = f64>,
) -> Result<Planar, DataError> {
    let mut distances = distances.into_iter();
    let mut best = within(points, edges, distances.next().unwrap_or(0.0));
    for snap in distances {
        let least = best.as_ref().map_or((usize::MAX, 0), faults);
        if least == (0, 0) {
            break;
        }
        if let Ok(planar) = within(points, edges, snap)
            && faults(&planar) < least
        {
            best = Ok(planar);
        }
    }
    best
}

/// The number of faces that cross or touch themselves, as lines bend where their ends are moved, and of lines
/// that lead nowhere or contradict each other.
fn faults(planar: &Planar) -> (usize, usize) {
    let crosses = |face: &&Vec<i64>| {
        let corners: Vec<u32> = face.iter().map(|&v| v as u32).collect();
        polygon::outline(&corners, |v| planar.points[v as usize]).is_none()
    };
    let crossed = planar.faces.iter().filter(crosses).count();
    (crossed, planar.loose + planar.contradicting)
}

/// The planar graph of edges whose points are one within a distance.
fn within(points: &[Point], edges: &[FileCrease], near: f64) -> Result<Planar, DataError> {
    let mut merged = planar::Points::within(near);
    let label: Vec<u32> = points.iter().map(|p| merged.add(*p)).collect();
    let moved = edges.iter().map(|edge| FileCrease {
        ends: edge.ends.map(|v| label[v as usize]),
        ..*edge
    });
    let edges: Vec<FileCrease> = moved.filter(|e| e.ends[0] != e.ends[1]).collect();
    let places = merged.into_points();
    let welded = points.len() - places.len();
    let mut planar = planar(places, &edges, near)?;
    planar.welded = welded;
    Ok(planar)
}
