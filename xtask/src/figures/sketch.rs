//! Spatial constructions, seen from one side.

use super::{caption, style};
use crate::draw::{Colour, Drawing, Projection, Stroke, TEXT, palette, row};

/// Colour of vertices that are placed.
pub(super) const PLACED: Colour = palette::VERMILION;

/// A drawing to which spatial things are added.
#[derive(Debug)]
pub(super) struct Sketch {
    pub(super) view: Projection,
    pub(super) drawing: Drawing,
}

impl Sketch {
    /// An empty one, seen as [`Projection::from`] says.
    pub(super) fn seen(azimuth: f64, elevation: f64, scale: f64) -> Self {
        Self {
            view: Projection::from(azimuth, elevation, scale),
            drawing: Drawing::new(),
        }
    }

    /// An open polyline.
    pub(super) fn line(&mut self, points: &[[f64; 3]], stroke: Stroke) {
        self.drawing.line(&self.view.project_all(points), stroke);
    }

    /// A polyline that ends in an arrow head.
    pub(super) fn arrow(&mut self, points: &[[f64; 3]], colour: Colour) {
        let stroke = Stroke::new(colour, 0.9);
        self.drawing.arrow(&self.view.project_all(points), stroke);
    }

    /// A shaded triangle with its edges.
    pub(super) fn face(&mut self, corners: [[f64; 3]; 3], colour: Colour) {
        let points = self.view.project_all(&corners);
        let fill = self.view.shade(colour, &corners).alpha(colour.alpha);
        self.drawing.polygon(&points, fill);
        self.drawing.outline(&points, style::EDGE);
    }

    /// A triangle of sky blue.
    pub(super) fn blue_face(&mut self, corners: [[f64; 3]; 3], alpha: f64) {
        self.face(corners, palette::SKY.tint(0.55).alpha(alpha));
    }

    /// Vertices that are known.
    pub(super) fn known<'a>(&mut self, points: impl IntoIterator<Item = &'a [f64; 3]>) {
        let rim = Stroke::new(palette::WHITE, 0.6);
        for p in points {
            let at = self.view.project(p);
            self.drawing.disc(at, 2.7, palette::BLUE, rim);
        }
    }

    /// A vertex that is placed.
    pub(super) fn placed(&mut self, p: &[f64; 3]) {
        let (at, rim) = (self.view.project(p), Stroke::new(palette::WHITE, 0.6));
        self.drawing.disc(at, 2.7, PLACED, rim);
    }

    /// The other place that a vertex might have.
    pub(super) fn mirrored(&mut self, p: &[f64; 3]) {
        let (at, rim) = (self.view.project(p), Stroke::new(palette::GREY, 0.8));
        self.drawing.disc(at, 2.4, palette::WHITE, rim);
    }

    /// A text beside a point, `shift` points to the right and upwards.
    pub(super) fn label(&mut self, p: &[f64; 3], shift: [f64; 2], text: &str, colour: Colour) {
        let [x, y] = self.view.project(p);
        let at = [x + shift[0], y + shift[1]];
        self.drawing.label(at, text, colour);
    }
}

/// Panels side by side with lines of text below each, all at the same height.
pub(super) fn captioned(mut panels: Vec<Drawing>, words: &[Vec<String>], gap: f64) -> Drawing {
    let lows = panels.iter().map(|p| p.bounds().min[1]);
    let low = lows.fold(f64::INFINITY, f64::min) - 8.0;
    for (panel, lines) in panels.iter_mut().zip(words) {
        let x = panel.bounds().centre()[0];
        caption(panel, [x, low], TEXT, lines);
    }
    row(&panels, gap)
}
