//! Plots with linear or logarithmic axes.

use super::colour::{Colour, palette};
use super::drawing::{Anchor, Drawing, Stroke, Vertical};
use super::text::{SMALL, TEXT, width};

/// One axis of a plot.
#[derive(Clone, Debug)]
pub(crate) struct Axis {
    /// What is shown, with its unit.
    pub(crate) label: String,
    /// Values at the ends.
    pub(crate) range: [f64; 2],
    /// Positions and texts of the ticks.
    pub(crate) ticks: Vec<(f64, String)>,
    logarithmic: Scale,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Scale {
    Linear,
    Logarithmic,
}

impl Axis {
    /// A linear axis with the given ticks.
    pub(crate) fn linear(label: &str, range: [f64; 2], ticks: Vec<(f64, String)>) -> Self {
        Self {
            label: label.to_owned(),
            range,
            ticks,
            logarithmic: Scale::Linear,
        }
    }

    /// A linear axis from `range` with about `count` ticks at round values.
    pub(crate) fn round(label: &str, range: [f64; 2], count: usize) -> Self {
        let raw = (range[1] - range[0]) / count.max(1) as f64;
        let power = 10f64.powf(raw.log10().floor());
        let step = [1.0, 2.0, 5.0, 10.0]
            .map(|m| m * power)
            .into_iter()
            .find(|s| *s >= raw)
            .unwrap_or(raw);
        let decimals = (-step.log10().floor()).max(0.0) as usize;
        let first = (range[0] / step - 1e-9).ceil() as i64;
        let last = (range[1] / step + 1e-9).floor() as i64;
        let ticks = (first..=last)
            .map(|k| {
                let v = k as f64 * step;
                (v, format!("{v:.decimals$}").replace('-', "−"))
            })
            .collect();
        Self::linear(label, range, ticks)
    }

    /// A logarithmic axis over whole decades, with a tick every `every` decades.
    pub(crate) fn decades(label: &str, first: i32, last: i32, every: usize) -> Self {
        let ticks = (first..=last)
            .step_by(every.max(1))
            .map(|k| (10f64.powi(k), format!("10^{{{k}}}").replace('-', "−")))
            .collect();
        Self {
            label: label.to_owned(),
            range: [10f64.powi(first), 10f64.powi(last)],
            ticks,
            logarithmic: Scale::Logarithmic,
        }
    }

    /// A logarithmic axis over the whole decades that hold all positive values, with at most seven ticks.
    pub(crate) fn holding(label: &str, values: impl IntoIterator<Item = f64>) -> Self {
        let (mut low, mut high) = (i32::MAX, i32::MIN);
        for v in values.into_iter().filter(|v| v.is_finite() && *v > 0.0) {
            low = low.min((v.log10() + 1e-9).floor() as i32);
            high = high.max((v.log10() - 1e-9).ceil() as i32);
        }
        if low > high {
            (low, high) = (0, 1);
        }
        let high = high.max(low + 1);
        let every = (high - low).unsigned_abs().div_ceil(6) as usize;
        Self::decades(label, low, high, every)
    }

    /// A logarithmic axis with a tick at every one of some values, and room beside the first and the last.
    pub(crate) fn at(label: &str, ticks: Vec<(f64, String)>) -> Self {
        let low = ticks.iter().map(|t| t.0).fold(f64::INFINITY, f64::min);
        let high = ticks.iter().map(|t| t.0).fold(0.0, f64::max);
        Self {
            label: label.to_owned(),
            range: [low / 1.5, high * 1.5],
            ticks,
            logarithmic: Scale::Logarithmic,
        }
    }

    /// Where on the axis a value is: 0 and 1 are the ends.
    pub(crate) fn part(&self, value: f64) -> f64 {
        let f = |v: f64| match self.logarithmic {
            Scale::Linear => v,
            Scale::Logarithmic => v.log10(),
        };
        (f(value) - f(self.range[0])) / (f(self.range[1]) - f(self.range[0]))
    }

    /// Whether a value is on the axis.
    pub(crate) fn holds(&self, value: f64) -> bool {
        (-1e-9..=1.0 + 1e-9).contains(&self.part(value))
    }
}

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
    /// A named sequence of points with a line, the style by its place `k` among the series of a plot.
    pub(crate) fn styled(k: usize, name: &str, points: Vec<[f64; 2]>) -> Self {
        let (colour, marker) = STYLES[k % STYLES.len()];
        Self {
            name: name.to_owned(),
            points,
            colour,
            marker: Some(marker),
            line: Line::Solid,
        }
    }

    /// A grey dashed line for comparison.
    pub(crate) fn guide(name: &str, points: Vec<[f64; 2]>) -> Self {
        Self {
            name: name.to_owned(),
            points,
            colour: palette::GREY,
            marker: None,
            line: Line::Dashed,
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

impl Series {
    fn stroke(&self) -> Option<Stroke> {
        let solid = Stroke::new(self.colour, 1.1);
        match self.line {
            Line::None => None,
            Line::Solid => Some(solid),
            Line::Dashed => Some(solid.dashed()),
        }
    }
}

/// A plot: axes, series and a legend to the right.
#[derive(Clone, Debug)]
pub(crate) struct Plot {
    pub(crate) x: Axis,
    pub(crate) y: Axis,
    /// Size of the area inside the axes, points.
    pub(crate) size: [f64; 2],
    pub(crate) series: Vec<Series>,
    pub(crate) legend: Legend,
}

/// Where the names of the series are written.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Legend {
    None,
    /// To the right of the plot.
    Right,
}

impl Plot {
    /// The plot as a drawing with the origin at the lower left corner of the area inside the axes.
    pub(crate) fn draw(&self) -> Drawing {
        let mut d = Drawing::new();
        let [w, h] = self.size;
        let ink = palette::INK;
        let frame = Stroke::new(ink, 0.6);
        let grid = Stroke::new(palette::PALE, 0.4);
        for (value, text) in &self.x.ticks {
            let x = self.x.part(*value) * w;
            d.line(&[[x, 0.0], [x, -3.0]], frame);
            d.text([x, -5.0], text, SMALL, Anchor::Middle, Vertical::Below, ink);
        }
        let mut widest: f64 = 0.0;
        for (value, text) in &self.y.ticks {
            let y = self.y.part(*value) * h;
            d.line(&[[0.0, y], [w, y]], grid);
            d.line(&[[0.0, y], [-3.0, y]], frame);
            d.text([-5.0, y], text, SMALL, Anchor::End, Vertical::Centre, ink);
            widest = widest.max(width(text, SMALL));
        }
        d.line(&[[0.0, h], [0.0, 0.0], [w, 0.0]], frame);
        d.text(
            [0.5 * w, -17.0],
            &self.x.label,
            TEXT,
            Anchor::Middle,
            Vertical::Below,
            ink,
        );
        d.text_upwards([-12.0 - widest, 0.5 * h], &self.y.label, TEXT, ink);
        for s in &self.series {
            let points: Vec<[f64; 2]> = s
                .points
                .iter()
                .map(|p| [self.x.part(p[0]) * w, self.y.part(p[1]) * h])
                .collect();
            if let Some(stroke) = s.stroke() {
                d.line(&points, stroke);
            }
            if let Some(marker) = s.marker {
                for p in points {
                    marker.draw(&mut d, p, 2.4, s.colour, Stroke::new(palette::WHITE, 0.5));
                }
            }
        }
        if self.legend == Legend::Right {
            for (k, s) in self
                .series
                .iter()
                .filter(|s| !s.name.is_empty())
                .enumerate()
            {
                let y = h - 6.0 - 12.5 * k as f64;
                let (a, b) = (w + 14.0, w + 32.0);
                if let Some(stroke) = s.stroke() {
                    d.line(&[[a, y], [b, y]], stroke);
                }
                if let Some(marker) = s.marker {
                    marker.draw(
                        &mut d,
                        [0.5 * (a + b), y],
                        2.4,
                        s.colour,
                        Stroke::new(palette::WHITE, 0.5),
                    );
                }
                d.text(
                    [b + 5.0, y],
                    &s.name,
                    SMALL,
                    Anchor::Start,
                    Vertical::Centre,
                    ink,
                );
            }
        }
        d
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn ticks_are_round_and_inside() {
        let axis = Axis::round("depth", [0.0, 0.17], 4);
        let texts: Vec<&str> = axis.ticks.iter().map(|(_, t)| t.as_str()).collect();
        assert_eq!(texts, ["0.00", "0.05", "0.10", "0.15"]);
        let log = Axis::decades("cond", 0, 6, 3);
        assert_eq!(log.ticks.len(), 3);
        assert!((log.part(1e3) - 0.5).abs() < 1e-15);
        let log = Axis::holding("e", [0.02, 3.0, 0.0, f64::NAN]);
        assert!((log.part(0.1) - 1.0 / 3.0).abs() < 1e-12 && log.holds(10.0) && !log.holds(11.0));
        assert!(!log.holds(0.0) && !log.holds(f64::NAN));
        assert_eq!(Axis::holding("e", []).range, [1.0, 10.0]);
        let at = Axis::at("h", vec![(1.0, "1".into()), (4.0, "4".into())]);
        assert!((at.part(2.0) - 0.5).abs() < 1e-12);
    }
}
