//! Points of a chart, and how they are shown.

use super::colour::{Colour, palette};
use super::drawing::{Drawing, Stroke};

/// The symbol of a series.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Marker {
    Disc,
    Square,
    Triangle,
    Diamond,
}

impl Marker {
    /// Draws the symbol with its middle at `p`; `radius` is that of the disc of about the same area.
    pub(crate) fn draw(
        self,
        drawing: &mut Drawing,
        p: [f64; 2],
        radius: f64,
        fill: Colour,
        rim: Stroke,
    ) {
        let corners: &[[f64; 2]] = match self {
            Self::Disc => return drawing.disc(p, radius, fill, rim),
            Self::Square => &[[-0.88, -0.88], [0.88, -0.88], [0.88, 0.88], [-0.88, 0.88]],
            Self::Triangle => &[[-1.12, -0.76], [1.12, -0.76], [0.0, 1.24]],
            Self::Diamond => &[[0.0, -1.25], [1.25, 0.0], [0.0, 1.25], [-1.25, 0.0]],
        };
        let points: Vec<[f64; 2]> = corners
            .iter()
            .map(|c| [p[0] + radius * c[0], p[1] + radius * c[1]])
            .collect();
        drawing.polygon(&points, fill);
        drawing.outline(&points, rim);
    }
}

/// Points joined by a line.
#[derive(Clone, Debug)]
pub(crate) struct Series {
    /// Name in the legend; left out there when empty.
    pub(crate) name: String,
    pub(crate) points: Vec<[f64; 2]>,
    pub(crate) colour: Colour,
    pub(crate) marker: Option<Marker>,
    pub(crate) line: Line,
}

/// Colours and symbols of the series of a plot, in order.
const STYLES: [(Colour, Marker); 6] = [
    (palette::BLUE, Marker::Disc),
    (palette::VERMILION, Marker::Square),
    (palette::GREEN, Marker::Triangle),
    (palette::ORANGE, Marker::Diamond),
    (palette::PURPLE, Marker::Disc),
    (palette::SKY, Marker::Square),
];

impl Series {
    /// A named sequence of points with a solid line and without symbols.
    pub(crate) fn line(name: &str, colour: Colour, points: Vec<[f64; 2]>) -> Self {
        Self {
            name: name.to_owned(),
            points,
            colour,
            marker: None,
            line: Line::Solid,
        }
    }

    /// Points with symbols and without a line.
    pub(crate) fn dots(name: &str, colour: Colour, marker: Marker, points: Vec<[f64; 2]>) -> Self {
        Self {
            line: Line::None,
            ..Self::line(name, colour, points).marked(marker)
        }
    }

    /// A line with symbols, the style by its place `k` among the series of a chart.
    pub(crate) fn styled(k: usize, name: &str, points: Vec<[f64; 2]>) -> Self {
        let (colour, marker) = STYLES[k % STYLES.len()];
        Self::line(name, colour, points).marked(marker)
    }

    /// As [`Series::styled`], without symbols.
    pub(crate) fn curve(k: usize, name: &str, points: Vec<[f64; 2]>) -> Self {
        Self::line(name, STYLES[k % STYLES.len()].0, points)
    }

    /// A grey dashed line for comparison.
    pub(crate) fn guide(name: &str, points: Vec<[f64; 2]>) -> Self {
        Self::line(name, palette::GREY, points).dashed()
    }

    /// The same with symbols.
    pub(crate) fn marked(self, marker: Marker) -> Self {
        let marker = Some(marker);
        Self { marker, ..self }
    }

    /// The same with a dashed line.
    pub(crate) fn dashed(self) -> Self {
        let line = Line::Dashed;
        Self { line, ..self }
    }

    /// Draws the line through places of the drawing, and the symbols there.
    pub(super) fn draw(&self, d: &mut Drawing, line: &[[f64; 2]], symbols: &[[f64; 2]]) {
        let solid = Stroke::new(self.colour, 1.1);
        match self.line {
            Line::None => {}
            Line::Solid => d.line(line, solid),
            Line::Dashed => d.line(line, solid.dashed()),
        }
        let rim = Stroke::new(palette::WHITE, 0.5);
        for p in symbols.iter().filter(|_| self.marker.is_some()) {
            self.marker
                .inspect(|m| m.draw(d, *p, 2.4, self.colour, rim));
        }
    }
}

/// The line through the points of a series.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Line {
    None,
    Solid,
    Dashed,
}
