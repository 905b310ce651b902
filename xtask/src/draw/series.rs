//! Series of points in charts, and how they are shown.

use super::colour::{Colour, palette};
use super::marker::Marker;

/// Points joined by a line.
#[derive(Clone, Debug)]
pub(crate) struct Series {
    /// Name in the legend; left out there when empty.
    pub(crate) name: String,
    pub(crate) points: Vec<[f64; 2]>,
    /// The ends of the vertical error bars of the first points, none beyond them.
    pub(crate) bars: Vec<[f64; 2]>,
    pub(crate) colour: Colour,
    pub(crate) marker: Option<Marker>,
    /// Whether its line is dashed.
    pub(crate) is_dashed: bool,
}

/// Colours and symbols of the series of a plot, in order.
const STYLES: [(Colour, Marker); 7] = [
    (palette::BLUE, Marker::Disc),
    (palette::VERMILION, Marker::Square),
    (palette::GREEN, Marker::Triangle),
    (palette::ORANGE, Marker::Diamond),
    (palette::PURPLE, Marker::Disc),
    (palette::SKY, Marker::Square),
    (palette::INK, Marker::Triangle),
];

impl Series {
    /// A named sequence of points with a solid line and without symbols.
    pub(crate) fn line(name: &str, colour: Colour, points: Vec<[f64; 2]>) -> Self {
        Self {
            name: name.to_owned(),
            points,
            bars: Vec::new(),
            colour,
            marker: None,
            is_dashed: false,
        }
    }

    /// A line with symbols, the style by its place `k` among the series of a chart.
    pub(crate) fn styled(k: usize, name: &str, points: Vec<[f64; 2]>) -> Self {
        Self::curve(k, name, points).marked(STYLES[k % STYLES.len()].1)
    }

    /// As [`Series::styled`], without symbols.
    pub(crate) fn curve(k: usize, name: &str, points: Vec<[f64; 2]>) -> Self {
        Self::line(name, STYLES[k % STYLES.len()].0, points)
    }

    /// This series with a vertical error bar at each point, from one value to another.
    pub(crate) fn with_bars(self, bars: Vec<[f64; 2]>) -> Self {
        Self { bars, ..self }
    }

    /// A grey dashed line for comparison.
    pub(crate) fn guide(name: &str, points: Vec<[f64; 2]>) -> Self {
        Self::line(name, palette::GREY, points).dashed()
    }

    /// This series with symbols.
    pub(crate) fn marked(self, marker: Marker) -> Self {
        let marker = Some(marker);
        Self { marker, ..self }
    }

    /// This series with a dashed line.
    pub(crate) fn dashed(self) -> Self {
        let is_dashed = true;
        Self { is_dashed, ..self }
    }
}
