//! The display list.

use super::colour::Colour;
use super::text;

/// A line style.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Stroke {
    pub(crate) colour: Colour,
    /// Width in points.
    pub(crate) width: f64,
    /// Length of dashes and of the gaps between them, points; `None` for a solid line.
    pub(crate) dash: Option<[f64; 2]>,
}

impl Stroke {
    /// A solid line.
    pub(crate) const fn new(colour: Colour, width: f64) -> Self {
        Self {
            colour,
            width,
            dash: None,
        }
    }

    /// This line, dashed.
    pub(crate) const fn dashed(self) -> Self {
        Self {
            dash: Some([2.6, 2.0]),
            ..self
        }
    }
}

/// Which point of a text the given position is, horizontally.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Anchor {
    Start,
    Middle,
}

/// Where a text lies relative to the given position, vertically.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Vertical {
    Centre,
    Below,
}

/// One element of a drawing.
#[derive(Clone, Debug)]
pub(crate) enum Item {
    Polygon {
        points: Vec<[f64; 2]>,
        fill: Colour,
    },
    Line {
        points: Vec<[f64; 2]>,
        stroke: Stroke,
    },
    Disc {
        centre: [f64; 2],
        radius: f64,
        fill: Colour,
    },
    /// `at` is on the baseline.
    Text {
        at: [f64; 2],
        text: String,
        size: f64,
        anchor: Anchor,
        colour: Colour,
    },
}

/// An axis-parallel rectangle.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Rect {
    pub(crate) min: [f64; 2],
    pub(crate) max: [f64; 2],
}

impl Rect {
    const EMPTY: Self = Self {
        min: [f64::INFINITY; 2],
        max: [f64::NEG_INFINITY; 2],
    };

    fn add(&mut self, p: [f64; 2], margin: f64) {
        for k in 0..2 {
            self.min[k] = self.min[k].min(p[k] - margin);
            self.max[k] = self.max[k].max(p[k] + margin);
        }
    }

    pub(crate) fn width(&self) -> f64 {
        self.max[0] - self.min[0]
    }

    pub(crate) fn height(&self) -> f64 {
        self.max[1] - self.min[1]
    }

    pub(crate) fn centre(&self) -> [f64; 2] {
        [0, 1].map(|k| 0.5 * (self.min[k] + self.max[k]))
    }
}

/// A drawing in points, y upwards. What is added later lies on top.
#[derive(Clone, Debug, Default)]
pub(crate) struct Drawing {
    pub(crate) items: Vec<Item>,
}

impl Drawing {
    pub(crate) fn new() -> Self {
        Self::default()
    }

    /// A filled polygon without an outline.
    pub(crate) fn polygon(&mut self, points: &[[f64; 2]], fill: Colour) {
        self.items.push(Item::Polygon {
            points: points.to_vec(),
            fill,
        });
    }

    /// An open polyline.
    pub(crate) fn line(&mut self, points: &[[f64; 2]], stroke: Stroke) {
        self.items.push(Item::Line {
            points: points.to_vec(),
            stroke,
        });
    }

    /// A closed polyline.
    pub(crate) fn outline(&mut self, points: &[[f64; 2]], stroke: Stroke) {
        let mut closed = points.to_vec();
        closed.extend(points.first());
        self.items.push(Item::Line {
            points: closed,
            stroke,
        });
    }

    /// A filled disc with a rim.
    pub(crate) fn disc(&mut self, centre: [f64; 2], radius: f64, fill: Colour, rim: Stroke) {
        self.items.push(Item::Disc {
            centre,
            radius: radius + 0.5 * rim.width,
            fill: rim.colour,
        });
        self.items.push(Item::Disc {
            centre,
            radius: radius - 0.5 * rim.width,
            fill,
        });
    }

    /// A polyline that ends in an arrow head.
    pub(crate) fn arrow(&mut self, points: &[[f64; 2]], stroke: Stroke) {
        let [.., before, tip] = points else { return };
        let d = [tip[0] - before[0], tip[1] - before[1]];
        let l = d[0].hypot(d[1]).max(1e-9);
        let u = [d[0] / l, d[1] / l];
        let (long, half) = (3.6 + 1.6 * stroke.width, 1.3 + 0.8 * stroke.width);
        let base = [tip[0] - long * u[0], tip[1] - long * u[1]];
        let mut shaft = points.to_vec();
        if let Some(last) = shaft.last_mut() {
            *last = [tip[0] - 0.8 * long * u[0], tip[1] - 0.8 * long * u[1]];
        }
        self.line(&shaft, stroke);
        let head = [
            *tip,
            [base[0] - half * u[1], base[1] + half * u[0]],
            [base[0] + half * u[1], base[1] - half * u[0]],
        ];
        self.polygon(&head, stroke.colour);
    }

    /// A text.
    pub(crate) fn text(
        &mut self,
        at: [f64; 2],
        text: &str,
        size: f64,
        anchor: Anchor,
        vertical: Vertical,
        colour: Colour,
    ) {
        let drop = match vertical {
            Vertical::Centre => 0.35 * size,
            Vertical::Below => 0.72 * size,
        };
        self.items.push(Item::Text {
            at: [at[0], at[1] - drop],
            text: text.to_owned(),
            size,
            anchor,
            colour,
        });
    }

    /// A text of the ordinary size with its middle at `at`.
    pub(crate) fn label(&mut self, at: [f64; 2], text: &str, colour: Colour) {
        let (size, middle) = (text::TEXT, Anchor::Middle);
        self.text(at, text, size, middle, Vertical::Centre, colour);
    }

    /// Another drawing, moved.
    pub(crate) fn place(&mut self, other: &Self, offset: [f64; 2]) {
        let moved = |p: &[f64; 2]| [p[0] + offset[0], p[1] + offset[1]];
        self.items
            .extend(other.items.iter().cloned().map(|mut item| {
                match &mut item {
                    Item::Polygon { points, .. } | Item::Line { points, .. } => {
                        for p in points {
                            *p = moved(p);
                        }
                    }
                    Item::Disc { centre: p, .. } | Item::Text { at: p, .. } => *p = moved(p),
                }
                item
            }));
    }

    /// The smallest rectangle that holds everything; widths of texts are estimated.
    pub(crate) fn bounds(&self) -> Rect {
        let mut r = Rect::EMPTY;
        for item in &self.items {
            match item {
                Item::Polygon { points, .. } => points.iter().for_each(|&p| r.add(p, 0.0)),
                Item::Line { points, stroke } => {
                    points.iter().for_each(|&p| r.add(p, 0.5 * stroke.width));
                }
                Item::Disc { centre, radius, .. } => r.add(*centre, *radius),
                Item::Text {
                    at,
                    text,
                    size,
                    anchor,
                    ..
                } => {
                    let (before, after) = match anchor {
                        Anchor::Start => (0.0, 1.0),
                        Anchor::Middle => (0.5, 0.5),
                    };
                    let w = text::width(text, *size);
                    r.add([at[0] - before * w, at[1] - 0.22 * size], 0.0);
                    r.add([at[0] + after * w, at[1] + 0.74 * size], 0.0);
                }
            }
        }
        r
    }
}

/// Panels from left to right with a gap between their bounds, their origins in line.
pub(crate) fn row(panels: &[Drawing], gap: f64) -> Drawing {
    let (mut all, mut x) = (Drawing::new(), 0.0);
    for panel in panels {
        let b = panel.bounds();
        all.place(panel, [x - b.min[0], 0.0]);
        x += b.width() + gap;
    }
    all
}

/// Panels from top to bottom with a gap between their bounds, their origins in line.
pub(crate) fn column(panels: &[Drawing], gap: f64) -> Drawing {
    let (mut all, mut y) = (Drawing::new(), 0.0);
    for panel in panels {
        let b = panel.bounds();
        all.place(panel, [0.0, y - b.max[1]]);
        y -= b.height() + gap;
    }
    all
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::draw::palette;

    #[test]
    fn panels_do_not_overlap() {
        let mut square = Drawing::new();
        let corners = [[-1.0, -1.0], [1.0, -1.0], [1.0, 1.0], [-1.0, 1.0]];
        square.polygon(&corners, palette::INK);
        let panels = [square.clone(), square];
        let (r, c) = (row(&panels, 3.0).bounds(), column(&panels, 3.0).bounds());
        assert_eq!((r.width(), r.height()), (7.0, 2.0));
        assert_eq!((c.width(), c.height()), (2.0, 7.0));
    }
}
