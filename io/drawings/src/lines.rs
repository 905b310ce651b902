//! What a drawing has.

use super::colour::Colour;
use isosheet_mesh::plane::PlaneCurve;
use std::collections::BTreeMap;

/// How lines are drawn.
#[derive(Clone, Debug, PartialEq)]
pub struct Pen {
    /// The colour of the line, or that of the area that it bounds if it has none itself.
    pub colour: Colour,
    /// Whether it is dashed.
    pub dashed: bool,
    /// How opaque it is, from 0 to 1: its colour, the line, and the groups that it is in, multiplied.
    pub opacity: f64,
    /// The names of the layer and of the groups that it is in, and its own, the innermost first.
    pub layers: Vec<String>,
}

/// A line of a drawing.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct DrawnLine {
    /// Where it runs, metres, y upwards.
    pub curve: PlaneCurve,
    /// The number of its pen.
    pub pen: usize,
    /// The number of the path that it is a part of.
    pub path: usize,
}

/// The lines of a drawing, and what it has besides.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Drawing {
    /// The lines.
    pub lines: Vec<DrawnLine>,
    /// How they are drawn.
    pub pens: Vec<Pen>,
    /// What is no line, such as texts and images, or is drawn in a colour that is not understood, and was
    /// left out, with its number.
    pub left_out: BTreeMap<String, usize>,
    /// What a unit of the file was taken for, where the file does not say it.
    pub assumed_unit: Option<&'static str>,
    /// How many times as large the drawing is by the unit of the file as by another one that was given.
    pub by_own_unit: Option<f64>,
    paths: usize,
}

impl Drawing {
    /// Adds a path.
    pub(super) fn push(&mut self, pen: Pen, curves: impl IntoIterator<Item = PlaneCurve>) {
        if self.pens.last() != Some(&pen) {
            self.pens.push(pen);
        }
        let number = self.pens.len() - 1;
        let line = |curve| DrawnLine {
            curve,
            pen: number,
            path: self.paths,
        };
        self.lines.extend(curves.into_iter().map(line));
        self.paths += 1;
    }

    /// Counts something that is left out.
    pub(super) fn leave_out(&mut self, what: impl Into<String>) {
        *self.left_out.entry(what.into()).or_default() += 1;
    }
}
