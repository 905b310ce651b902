//! Symbols of points.

use super::colour::Colour;
use super::drawing::{Drawing, Stroke};
use std::f64::consts::TAU;

/// Corners of the polygon that is drawn for a disc: at the size of a symbol it looks round.
const ROUND: usize = 20;

/// A symbol.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Marker {
    Disc,
    Square,
    Triangle,
    Diamond,
}

impl Marker {
    /// Corners about the middle, y upwards; `radius` is that of the disc of about the same area.
    pub(super) fn corners(self, radius: f64) -> Vec<[f64; 2]> {
        let corners: &[[f64; 2]] = match self {
            Self::Disc => {
                let angle = |k: usize| TAU * k as f64 / ROUND as f64;
                let corner = |k| [radius * f64::cos(angle(k)), radius * f64::sin(angle(k))];
                return (0..ROUND).map(corner).collect();
            }
            Self::Square => &[[-0.88, -0.88], [0.88, -0.88], [0.88, 0.88], [-0.88, 0.88]],
            Self::Triangle => &[[-1.12, -0.76], [1.12, -0.76], [0.0, 1.24]],
            Self::Diamond => &[[0.0, -1.25], [1.25, 0.0], [0.0, 1.25], [-1.25, 0.0]],
        };
        corners.iter().map(|c| c.map(|c| radius * c)).collect()
    }

    /// Draws the symbol with its middle at `p`.
    pub(crate) fn draw(
        self,
        drawing: &mut Drawing,
        p: [f64; 2],
        radius: f64,
        fill: Colour,
        rim: Stroke,
    ) {
        let corners = self.corners(radius).into_iter();
        let points: Vec<[f64; 2]> = corners.map(|c| [p[0] + c[0], p[1] + c[1]]).collect();
        drawing.polygon(&points, fill);
        drawing.outline(&points, rim);
    }
}
