//! Charts of measured numbers: one panel each, with its title and with marks of runs that did not end.

use crate::draw::{
    Anchor, Axis, Colour, Drawing, Legend, Marker, Plot, Series, Stroke, TEXT, Vertical, palette,
};

/// Heights above the axes of the line of runs that did not end and of the title, points.
const NOT_ENDED: f64 = 13.0;
const TITLE: f64 = 9.0;

/// A run that did not end: a mark above the axes.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Missing {
    /// Where on the horizontal axis it is.
    pub(crate) x: f64,
    /// How far beside that place the mark is drawn, points.
    pub(crate) beside: f64,
    pub(crate) colour: Colour,
    pub(crate) marker: Marker,
}

/// A panel: axes and what is drawn in them.
#[derive(Clone, Debug)]
pub(crate) struct Chart {
    /// Written above; none when empty.
    pub(crate) title: String,
    pub(crate) x: Axis,
    pub(crate) y: Axis,
    /// Size of the area inside the axes, points.
    pub(crate) size: [f64; 2],
    /// Points outside the vertical axis are left out.
    pub(crate) series: Vec<Series>,
    /// Runs that did not end, on a line above the axes; without it there is no such line.
    pub(crate) missing: Option<Vec<Missing>>,
    pub(crate) legend: Legend,
}

impl Chart {
    /// A chart with a legend and without a title.
    pub(crate) fn new(x: Axis, y: Axis, size: [f64; 2], series: Vec<Series>) -> Self {
        Self {
            title: String::new(),
            x,
            y,
            size,
            series,
            missing: None,
            legend: Legend::Right,
        }
    }

    /// The drawing, its origin at the lower left corner of the area inside the axes.
    pub(crate) fn draw(&self) -> Drawing {
        let mut series = self.series.clone();
        for s in &mut series {
            s.points.retain(|p| self.y.holds(p[1]));
        }
        let (x, y) = (self.x.clone(), self.y.clone());
        let (size, legend) = (self.size, self.legend);
        let plot = Plot {
            x,
            y,
            size,
            series,
            legend,
        };
        let mut drawing = plot.draw();
        let mut top = size[1];
        if let Some(missing) = &self.missing {
            top += NOT_ENDED;
            self.not_ended(&mut drawing, missing);
        }
        if !self.title.is_empty() {
            let at = [0.5 * size[0], top + TITLE];
            let (anchor, ink) = (Anchor::Middle, palette::INK);
            drawing.text(at, &self.title, TEXT, anchor, Vertical::Above, ink);
        }
        drawing
    }

    /// The line above the axes with the runs that did not end.
    fn not_ended(&self, drawing: &mut Drawing, missing: &[Missing]) {
        let ([width, height], grey) = (self.size, palette::GREY);
        let y = height + NOT_ENDED;
        drawing.line(&[[0.0, y], [width, y]], Stroke::new(grey, 0.5).dashed());
        let (at, centre) = ([-4.0, y], Vertical::Centre);
        drawing.text(at, "did not end", 6.0, Anchor::End, centre, grey);
        let rim = Stroke::new(palette::WHITE, 0.4);
        for m in missing {
            let x = width * self.x.part(m.x) + m.beside;
            m.marker.draw(drawing, [x, y], 1.8, m.colour, rim);
        }
    }
}

/// A line `y ~ x^power` over the range of `x` of some points, through the geometric mean of their values at
/// the largest `x`; nothing where there are none.
pub(crate) fn order_line(points: &[[f64; 2]], power: f64) -> Vec<[f64; 2]> {
    let positive = || points.iter().filter(|p| p[1] > 0.0);
    let high = positive().map(|p| p[0]).fold(0.0, f64::max);
    let low = positive().map(|p| p[0]).fold(f64::INFINITY, f64::min);
    let last: Vec<f64> = positive()
        .filter(|p| p[0] > 0.999 * high)
        .map(|p| p[1].ln())
        .collect();
    if last.is_empty() || low >= high {
        return Vec::new();
    }
    let mean = (last.iter().sum::<f64>() / last.len() as f64).exp();
    // Many points, so that what leaves the axes can be left out.
    let point = |k: i32| {
        let x = high * (low / high).powf(f64::from(k) / 32.0);
        [x, mean * (x / high).powf(power)]
    };
    (0..=32).map(point).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn order_lines_have_their_slope_and_pass_through_the_mean() {
        let points = [[1.0, 1e-3], [4.0, 0.1], [4.0, 0.4], [8.0, 0.0]];
        let line = order_line(&points, 2.0);
        for pair in line.windows(2) {
            let [[x, y], [u, v]] = [pair[0], pair[1]];
            assert!(((y / v).ln() / (x / u).ln() - 2.0).abs() < 1e-9);
        }
        assert!((line[0][0] - 4.0).abs() < 1e-12 && (line[0][1] - 0.2).abs() < 1e-12);
        assert!((line[32][0] - 1.0).abs() < 1e-12);
        assert!(order_line(&points[3..], 2.0).is_empty());
    }
}
