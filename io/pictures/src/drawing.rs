//! Triangles, lines and dots, in pixels.

use super::canvas::Light;

/// A corner of something drawn: pixels (y downwards), nearness and light.
#[derive(Clone, Copy, Debug)]
pub(super) struct Corner {
    pub(super) x: f64,
    pub(super) y: f64,
    pub(super) nearness: f64,
    pub(super) light: Light,
}

/// A triangle that is part of a face.
#[derive(Clone, Copy, Debug)]
pub(super) struct Facet {
    pub(super) corners: [Corner; 3],
    pub(super) face: u32,
}

/// A line or, of no length, a dot.
#[derive(Clone, Copy, Debug)]
pub(super) struct Stroke {
    pub(super) ends: [Corner; 2],
    /// Vertices at the ends of the edge that is drawn.
    pub(super) vertices: [usize; 2],
    /// Pixels.
    pub(super) width: f64,
    /// How much of what is below it hides, from 0 to 1.
    pub(super) cover: f32,
    /// How much nearer the line counts than it is, where a face is seen that has a vertex with it in common.
    pub(super) lift: f64,
    /// How much farther the line counts than it is, where another face is seen: what lies on it hides all of
    /// its width.
    pub(super) sink: f64,
}

/// All that a picture shows, in pixels.
pub(super) struct Drawing<'a> {
    /// Width and height, pixels.
    pub(super) size: [usize; 2],
    /// The corners of each face: an edge is not hidden by faces that it bounds.
    pub(super) faces: &'a [[usize; 3]],
    pub(super) facets: Vec<Facet>,
    /// Lines of the colour of ink. Where several meet the darkest counts.
    pub(super) strokes: Vec<Stroke>,
    pub(super) ink: Light,
    /// Dots and lines on top of all others, in their order, each of the light of its first end.
    pub(super) marks: Vec<Stroke>,
}

impl Stroke {
    pub(super) fn rows(&self) -> [f64; 2] {
        let [low, high] = bounds(self.ends.map(|end| end.y));
        [low - 0.5 * self.width, high + 0.5 * self.width]
    }
}

/// The smallest and the largest of some values.
pub(super) fn bounds<const N: usize>(values: [f64; N]) -> [f64; 2] {
    let low = values.into_iter().fold(f64::INFINITY, f64::min);
    [low, values.into_iter().fold(f64::NEG_INFINITY, f64::max)]
}
