//! Putting panels side by side, their origins in line.

use super::drawing::Drawing;

/// Panels from left to right with a gap between their bounds.
pub(crate) fn row(panels: &[Drawing], gap: f64) -> Drawing {
    let (mut all, mut x) = (Drawing::new(), 0.0);
    for panel in panels {
        let b = panel.bounds();
        all.place(panel, [x - b.min[0], 0.0]);
        x += b.width() + gap;
    }
    all
}

/// Panels from top to bottom with a gap between their bounds.
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
        square.polygon(
            &[[-1.0, -1.0], [1.0, -1.0], [1.0, 1.0], [-1.0, 1.0]],
            palette::INK,
        );
        let panels = [square.clone(), square];
        let (r, c) = (row(&panels, 3.0).bounds(), column(&panels, 3.0).bounds());
        assert_eq!((r.width(), r.height()), (7.0, 2.0));
        assert_eq!((c.width(), c.height()), (2.0, 7.0));
    }
}
