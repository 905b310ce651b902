//! Lines that are written, and their layers.

use super::class::LineClass;
use super::colour::Colour;

/// A line that is written: a polygon, closed if its first point is its last one.
#[derive(Clone, Debug, PartialEq)]
pub struct Stroke {
    /// Its points, metres, y upwards.
    pub points: Vec<[f64; 2]>,
    /// What it is meant to do. Lines that are [left out](LineClass::Ignored) are written on a layer `guide`,
    /// which no reader takes for a part of the sheet: they show something and are not cut.
    pub class: LineClass,
    /// The angle by which a mountain or a valley folds, radians from 0 to pi; by pi where nothing is said. It
    /// is the opacity of the line in SVG files, as a part of pi; DXF files have no place for it.
    pub angle: Option<f64>,
}

impl Stroke {
    /// Whether it ends where it begins.
    pub(crate) fn is_closed(&self) -> bool {
        self.points.len() > 2 && self.points.first() == self.points.last()
    }

    /// Its opacity.
    pub(crate) fn opacity(&self) -> f64 {
        match self.class {
            LineClass::Mountain | LineClass::Valley => self
                .angle
                .map_or(1.0, |a| (a / std::f64::consts::PI).clamp(0.0, 1.0)),
            _ => 1.0,
        }
    }
}

/// Layers in the order in which they are written, below each other: what is cut last comes last. Each has the
/// class, a name that readers understand, the colour of Origami Simulator, and the number of that colour in
/// DXF files.
pub(crate) const LAYERS: [(LineClass, &str, Colour, i32); 6] = [
    (LineClass::Ignored, "guide", Colour([160, 160, 160]), 9),
    (LineClass::Flat, "flat", Colour([255, 255, 0]), 2),
    (LineClass::Crease, "crease", Colour([255, 0, 255]), 6),
    (LineClass::Valley, "valley", Colour([0, 0, 255]), 5),
    (LineClass::Mountain, "mountain", Colour([255, 0, 0]), 1),
    (LineClass::Cut, "cut", Colour([0, 0, 0]), 7),
];

/// Millimetres of a metre: the unit of drawings that are written.
pub(crate) const MILLIMETRES: f64 = 1e3;

/// The lines of a class.
pub(crate) fn of_class(lines: &[Stroke], class: LineClass) -> impl Iterator<Item = &Stroke> {
    lines
        .iter()
        .filter(move |line| line.class == class && line.points.len() > 1)
}

/// The least and the largest coordinates of all lines; zero without any.
pub(crate) fn bounds(lines: &[Stroke]) -> [[f64; 2]; 2] {
    let mut points = lines.iter().flat_map(|line| &line.points);
    let first = points.next().map_or([[0.0; 2]; 2], |p| p.map(|c| [c, c]));
    points.fold(first, |b, p| {
        [0, 1].map(|k| [b[k][0].min(p[k]), b[k][1].max(p[k])])
    })
}
