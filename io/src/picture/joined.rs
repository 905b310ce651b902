//! Marks of a vector drawing that are joined: the pieces of a body to areas of one colour, and its edges to
//! lines.

use super::order::{Part, painted};
use super::pieces::Piece;
use std::collections::{BTreeMap, HashMap};
use std::fmt::Write;

/// Steps of colours of bodies, of 255: neighbours that differ by less are hardly told apart, and are one
/// area.
const COLOUR_STEP: u8 = 4;

/// A point of the drawing, hundredths of a pixel.
type Point = [i64; 2];

/// A part of the drawing.
pub(super) struct Mark {
    /// Corners in the picture, pixels, and their nearness.
    pub(super) corners: Vec<[f64; 3]>,
    pub(super) shape: Shape,
}

/// What a mark draws.
pub(super) enum Shape {
    /// An element of SVG.
    Element(String),
    /// A piece of a body, one of a layer whose pieces do not cover each other.
    Area {
        layer: usize,
        /// The numbers of the corners, counter-clockwise as the viewer sees them.
        numbers: [usize; 3],
        colour: [u8; 3],
    },
    /// A part of an edge of a body, which is above the areas of its layer. Beside those of others it counts as nearer
    /// by the lift.
    Line { layer: usize, lift: f64 },
}

impl Part for Mark {
    /// Elements first, then areas by layer and colour, then lines.
    type Group = (u8, usize, [u8; 3]);

    fn corners(&self) -> &[[f64; 3]] {
        &self.corners
    }

    fn group(&self) -> Self::Group {
        match self.shape {
            Shape::Element(_) => (0, 0, [0; 3]),
            Shape::Area { layer, colour, .. } => (1, layer, colour),
            Shape::Line { layer, .. } => (2, layer, [0; 3]),
        }
    }

    fn lead(&self, other: &Self) -> Option<f64> {
        let over = |line: usize, lift: f64, area: usize| match line == area {
            true => f64::INFINITY,
            false => lift,
        };
        match (&self.shape, &other.shape) {
            (Shape::Area { layer: a, .. }, Shape::Area { layer: b, .. }) if a == b => None,
            (Shape::Line { layer, lift }, Shape::Area { layer: area, .. }) => {
                Some(over(*layer, *lift, *area))
            }
            (Shape::Area { layer: area, .. }, Shape::Line { layer, lift }) => {
                Some(-over(*layer, *lift, *area))
            }
            _ => Some(0.0),
        }
    }
}

/// The elements of marks in the order of painting: those of areas and lines that follow each other in one group are
/// joined.
pub(super) fn elements(marks: &[Mark], ink: &str) -> Vec<String> {
    let order = painted(marks);
    let groups = order.chunk_by(|a, b| marks[*a].group() == marks[*b].group());
    groups.flat_map(|group| drawn(marks, group, ink)).collect()
}

/// The elements of marks of one group.
fn drawn(marks: &[Mark], group: &[usize], ink: &str) -> Vec<String> {
    // The sides of pieces: which corner follows on which, with the place of the first. Sides that two pieces have in
    // common are left out.
    let mut sides = HashMap::new();
    let mut lines = Vec::new();
    let (mut elements, mut fill) = (Vec::new(), None);
    for mark in group.iter().map(|k| &marks[*k]) {
        let place = |k: usize| point([mark.corners[k][0], mark.corners[k][1]]);
        match &mark.shape {
            Shape::Element(element) => elements.push(element.clone()),
            Shape::Line { .. } => lines.push([place(0), place(1)]),
            Shape::Area {
                numbers, colour, ..
            } => {
                fill = Some(*colour);
                for k in 0..3 {
                    let (from, to) = (numbers[k], numbers[(k + 1) % 3]);
                    if sides.remove(&[to, from]).is_none() {
                        sides.insert([from, to], place(k));
                    }
                }
            }
        }
    }
    if let Some(colour) = fill {
        // Areas have a line of their own colour, so that no gaps are seen between them.
        let (path, colour) = (outlines(sides), hex(colour));
        elements.push(format!(
            "<path d=\"{path}\" fill=\"{colour}\" stroke=\"{colour}\"/>"
        ));
    }
    if !lines.is_empty() {
        let path = polylines(lines);
        elements.push(format!(
            "<path d=\"{path}\" fill=\"none\" stroke=\"{ink}\"/>"
        ));
    }
    elements
}

/// The colour of areas that are joined with those of a colour.
pub(super) fn step(colour: [u8; 3]) -> [u8; 3] {
    colour.map(|c| c / COLOUR_STEP * COLOUR_STEP + COLOUR_STEP / 2)
}

/// A colour as SVG has it.
pub(super) fn hex([r, g, b]: [u8; 3]) -> String {
    format!("#{r:02x}{g:02x}{b:02x}")
}

/// The closed lines of some sides, each of which ends where others begin.
fn outlines(sides: HashMap<[usize; 2], Point>) -> String {
    let mut next: BTreeMap<usize, Vec<(usize, Point)>> = BTreeMap::new();
    for ([from, to], place) in sides {
        next.entry(from).or_default().push((to, place));
    }
    next.values_mut().for_each(|sides| sides.sort_unstable());
    let mut path = String::new();
    while let Some((&start, _)) = next.first_key_value() {
        let mut at = start;
        let mut places = Vec::new();
        while let Some(sides) = next.get_mut(&at) {
            let Some((to, place)) = sides.pop() else {
                break;
            };
            if sides.is_empty() {
                next.remove(&at);
            }
            places.push(place);
            at = to;
        }
        add_line(&mut path, &places);
        path.push('Z');
    }
    path
}

/// Lines that are joined where one ends and another one begins or ends.
fn polylines(lines: Vec<[Point; 2]>) -> String {
    let mut at: HashMap<Point, Vec<usize>> = HashMap::new();
    for (k, ends) in lines.iter().enumerate() {
        for end in ends {
            at.entry(*end).or_default().push(k);
        }
    }
    let mut is_drawn = vec![false; lines.len()];
    let mut follow = |places: &mut Vec<Point>| {
        while let Some(&end) = places.last() {
            let next = at[&end].iter().find(|&&k| !is_drawn[k]);
            let Some(&k) = next else {
                return;
            };
            is_drawn[k] = true;
            let [a, b] = lines[k];
            places.push(if a == end { b } else { a });
        }
    };
    let mut path = String::new();
    for [a, _] in &lines {
        let mut places = vec![*a];
        follow(&mut places);
        if places.len() == 1 {
            continue;
        }
        // From the first end in the other direction.
        places.reverse();
        follow(&mut places);
        add_line(&mut path, &places);
    }
    path
}

fn add_line(path: &mut String, places: &[Point]) {
    path.push('M');
    for (k, [x, y]) in places.iter().enumerate() {
        let space = if k == 0 { "" } else { " " };
        // Writing to a string cannot fail.
        let _ = write!(path, "{space}{} {}", *x as f64 / 100.0, *y as f64 / 100.0);
    }
}

fn point(place: [f64; 2]) -> Point {
    place.map(|c| (100.0 * c).round() as i64)
}

/// The corners of a piece counter-clockwise as the viewer sees it.
pub(super) fn seen(piece: &Piece) -> [usize; 3] {
    let [a, b, c] = piece.corners;
    if piece.back { [a, c, b] } else { [a, b, c] }
}
