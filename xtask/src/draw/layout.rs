//! Putting panels side by side.

use super::drawing::Drawing;

/// How panels line up across the direction in which they follow each other.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Align {
    /// By the origin of their coordinates.
    Origin,
    /// By the middle of their bounds.
    Middle,
}

/// Panels from left to right with a gap between their bounds.
pub(crate) fn row(panels: &[Drawing], gap: f64, align: Align) -> Drawing {
    let mut all = Drawing::new();
    let mut x = 0.0;
    for panel in panels {
        let b = panel.bounds();
        let y = match align {
            Align::Origin => 0.0,
            Align::Middle => -b.centre()[1],
        };
        all.place(panel, [x - b.min[0], y]);
        x += b.width() + gap;
    }
    all
}

/// Panels from top to bottom with a gap between their bounds.
pub(crate) fn column(panels: &[Drawing], gap: f64, align: Align) -> Drawing {
    let mut all = Drawing::new();
    let mut y = 0.0;
    for panel in panels {
        let b = panel.bounds();
        let x = match align {
            Align::Origin => 0.0,
            Align::Middle => -b.centre()[0],
        };
        all.place(panel, [x, y - b.max[1]]);
        y -= b.height() + gap;
    }
    all
}
