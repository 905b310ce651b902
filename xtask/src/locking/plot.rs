//! Figures of measured numbers (colour: model, symbol: mesh), and the orders fitted to them.

use super::isometry::Isometry;
use crate::draw::{
    Anchor, Axis, Drawing, Legend, Line, Marker, Plot, Series, Stroke, TEXT, Vertical, column,
    palette, row,
};
use crate::scale::exponent;

/// Symbols of the meshes of a figure, in order.
const MARKERS: [Marker; 4] = [
    Marker::Disc,
    Marker::Square,
    Marker::Triangle,
    Marker::Diamond,
];

/// Heights above the axes of the line of runs that did not end and of the title, points.
const NOT_ENDED: f64 = 13.0;
pub(super) const TITLE: f64 = 22.0;

/// Distance of the symbols of two models or meshes on that line, points.
const BESIDE: f64 = 3.0;

/// The result of one run.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Dot {
    pub(super) isometry: Isometry,
    /// Number of the mesh among those that the figure names.
    pub(super) mesh: usize,
    pub(super) x: f64,
    /// What was measured; nothing of a run that did not end.
    pub(super) y: Option<f64>,
}

/// Whether the points of a model on a mesh are joined by a line.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Joined {
    Yes,
    No,
}

/// Runs with common axes.
#[derive(Clone, Debug)]
pub(super) struct Panel {
    pub(super) title: String,
    pub(super) dots: Vec<Dot>,
    /// Lines for comparison: points of the plot.
    pub(super) guides: Vec<Vec<[f64; 2]>>,
}

/// A figure: panels in rows.
#[derive(Clone, Debug)]
pub(super) struct Figure {
    pub(super) x: Scale,
    pub(super) rows: Vec<(Scale, Vec<Panel>)>,
    /// Names of the meshes: of each symbol.
    pub(super) meshes: Vec<String>,
    /// Name of the lines for comparison.
    pub(super) guide: String,
    pub(super) joined: Joined,
    /// Size of the area inside the axes of each panel, points.
    pub(super) size: [f64; 2],
}

/// An axis, and whether it is one of logarithms.
#[derive(Clone, Debug)]
pub(super) enum Scale {
    Linear(Axis),
    Logarithmic(Axis),
}

impl Scale {
    /// A logarithmic axis over whole decades that hold all values.
    pub(super) fn decades(label: &str, values: impl Iterator<Item = f64>) -> Self {
        let (mut low, mut high) = (i32::MAX, i32::MIN);
        for v in values.filter(|v| v.is_finite() && *v > 0.0) {
            low = low.min((v.log10() + 1e-9).floor() as i32);
            high = high.max((v.log10() - 1e-9).ceil() as i32);
        }
        if low > high {
            (low, high) = (0, 1);
        }
        let high = high.max(low + 1);
        let every = if high - low > 7 { 2 } else { 1 };
        Self::Logarithmic(Axis::decades(label, low, high, every))
    }

    /// A logarithmic axis with a tick at every one of some values, and room beside the first and the last.
    pub(super) fn ticks(label: &str, ticks: Vec<(f64, String)>) -> Self {
        let mut axis = Axis::decades(label, 0, 1, 1);
        let low = ticks.iter().map(|t| t.0).fold(f64::INFINITY, f64::min);
        let high = ticks.iter().map(|t| t.0).fold(0.0, f64::max);
        axis.range = [low / 1.5, high * 1.5];
        axis.ticks = ticks;
        Self::Logarithmic(axis)
    }

    pub(super) fn axis(&self) -> &Axis {
        match self {
            Self::Linear(axis) | Self::Logarithmic(axis) => axis,
        }
    }

    /// Where on the axis a value is: 0 and 1 are the ends.
    pub(super) fn part(&self, value: f64) -> f64 {
        let [low, high] = self.axis().range;
        match self {
            Self::Linear(_) => (value - low) / (high - low),
            Self::Logarithmic(_) => (value / low).ln() / (high / low).ln(),
        }
    }

    /// Whether a value is on the axis.
    fn holds(&self, value: f64) -> bool {
        (-1e-9..=1.0 + 1e-9).contains(&self.part(value))
    }
}

impl Figure {
    /// The figure; the names of models, meshes and lines are to the right of the first row.
    pub(super) fn draw(&self) -> Drawing {
        let rows: Vec<Drawing> = self
            .rows
            .iter()
            .enumerate()
            .map(|(k, (y, panels))| {
                let last = panels.len().saturating_sub(1);
                let drawings: Vec<Drawing> = panels
                    .iter()
                    .enumerate()
                    .map(|(i, panel)| {
                        let has_legend = k == 0 && i == last;
                        let legend = if has_legend {
                            self.legend()
                        } else {
                            Vec::new()
                        };
                        self.panel(panel, y, legend)
                    })
                    .collect();
                row(&drawings, 12.0)
            })
            .collect();
        column(&rows, 14.0)
    }

    fn panel(&self, panel: &Panel, y: &Scale, legend: Vec<Series>) -> Drawing {
        let mut series: Vec<Series> = panel
            .guides
            .iter()
            .map(|points| Series::guide("", clipped(points, y)))
            .collect();
        for isometry in Isometry::ALL {
            for mesh in 0..self.meshes.len() {
                series.push(self.series(panel, y, isometry, mesh));
            }
        }
        series.extend(legend);
        let mut drawing = Plot {
            x: self.x.axis().clone(),
            y: y.axis().clone(),
            size: self.size,
            series,
            legend: Legend::Right,
        }
        .draw();
        self.not_ended(&mut drawing, panel);
        let [w, h] = self.size;
        let at = [0.5 * w, h + TITLE];
        let (anchor, ink) = (Anchor::Middle, palette::INK);
        drawing.text(at, &panel.title, TEXT, anchor, Vertical::Above, ink);
        drawing
    }

    /// The runs of a model on a mesh that ended.
    fn series(&self, panel: &Panel, y: &Scale, isometry: Isometry, mesh: usize) -> Series {
        let of = panel.dots.iter();
        let of = of.filter(|d| d.isometry == isometry && d.mesh == mesh);
        let points = of.filter_map(|d| Some([d.x, d.y?]));
        Series {
            name: String::new(),
            points: points.filter(|p| y.holds(p[1])).collect(),
            colour: isometry.colour(),
            marker: Some(MARKERS[mesh % MARKERS.len()]),
            line: match self.joined {
                Joined::Yes => Line::Solid,
                Joined::No => Line::None,
            },
        }
    }

    /// The line above the axes with the runs that did not end.
    fn not_ended(&self, drawing: &mut Drawing, panel: &Panel) {
        let y = not_ended_line(drawing, self.size);
        let rim = Stroke::new(palette::WHITE, 0.4);
        for (x, dot) in self.marks(panel) {
            let marker = MARKERS[dot.mesh % MARKERS.len()];
            marker.draw(drawing, [x, y], 1.8, dot.isometry.colour(), rim);
        }
    }

    /// The runs that did not end with their horizontal places, points: models and meshes beside one another.
    fn marks(&self, panel: &Panel) -> Vec<(f64, Dot)> {
        // Where lines join the meshes of a model, all of them are at the same places.
        let meshes = match self.joined {
            Joined::Yes => self.meshes.len(),
            Joined::No => 1,
        };
        let count = Isometry::ALL.len() * meshes;
        let place = |dot: &Dot| {
            let model = Isometry::ALL.iter().position(|m| *m == dot.isometry);
            let place = model.unwrap_or(0) * meshes + dot.mesh % meshes;
            let beside = BESIDE * (place as f64 - 0.5 * (count as f64 - 1.0));
            (self.size[0] * self.x.part(dot.x) + beside, *dot)
        };
        let not_ended = panel.dots.iter().filter(|d| d.y.is_none());
        not_ended.map(place).collect()
    }

    /// Series without points for the names of models, meshes and lines.
    fn legend(&self) -> Vec<Series> {
        let named = |name: &str, colour, marker, line| Series {
            name: name.to_owned(),
            points: Vec::new(),
            colour,
            marker,
            line,
        };
        let mut legend: Vec<Series> = Isometry::ALL
            .iter()
            .map(|m| named(&m.to_string(), m.colour(), None, Line::Solid))
            .collect();
        for (name, marker) in self.meshes.iter().zip(MARKERS) {
            legend.push(named(name, palette::INK, Some(marker), Line::None));
        }
        if !self.guide.is_empty() {
            legend.push(Series::guide(&self.guide, Vec::new()));
        }
        legend
    }
}

/// Draws the line of runs that did not end above axes of a size (points), and returns its height.
pub(super) fn not_ended_line(drawing: &mut Drawing, [width, height]: [f64; 2]) -> f64 {
    let (y, grey) = (height + NOT_ENDED, palette::GREY);
    drawing.line(&[[0.0, y], [width, y]], Stroke::new(grey, 0.5).dashed());
    let at = [-4.0, y];
    drawing.text(at, "did not end", 6.0, Anchor::End, Vertical::Centre, grey);
    y
}

/// The points of a line that are on the axis.
fn clipped(points: &[[f64; 2]], y: &Scale) -> Vec<[f64; 2]> {
    let points = points.iter().copied();
    points.filter(|p| y.holds(p[1])).collect()
}

/// A line `y ~ x^power` over the range of `x` of some dots, through the geometric mean of their values at the
/// largest `x`; nothing where there are none.
pub(super) fn slope(dots: &[Dot], power: f64) -> Vec<[f64; 2]> {
    let ended = || {
        dots.iter()
            .filter_map(|d| Some([d.x, d.y.filter(|y| *y > 0.0)?]))
    };
    let high = ended().map(|p| p[0]).fold(0.0, f64::max);
    let low = ended().map(|p| p[0]).fold(f64::INFINITY, f64::min);
    let last: Vec<f64> = ended()
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

/// Fitted power of the errors above `floor`, the level of round-off and of the solver's tolerances, below
/// which an error says nothing; nothing from fewer than two.
pub(super) fn order(points: &[[f64; 2]], floor: f64) -> Option<f64> {
    let is_positive = |point: &[f64; 2]| point.iter().all(|v| v.is_finite() && *v > 0.0);
    let all = points.iter().copied();
    let above: Vec<[f64; 2]> = all.filter(|p| is_positive(p) && p[1] > floor).collect();
    if above.len() < 2 {
        return None;
    }
    exponent(&above)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn orders_need_two_values_above_the_floor() {
        let points = [[0.1, 0.02], [0.2, 0.08], [0.4, 0.0], [0.8, f64::NAN]];
        assert!((order(&points, 0.0).unwrap() - 2.0).abs() < 1e-12);
        assert_eq!(order(&points, 0.05), None);
        assert_eq!(order(&points[1..], 0.0), None);
    }

    #[test]
    fn guides_have_their_slope_and_pass_through_the_mean() {
        let dot = |x: f64, y: Option<f64>| Dot {
            isometry: Isometry::Rods,
            mesh: 0,
            x,
            y,
        };
        let dots = [
            dot(1.0, Some(1e-3)),
            dot(4.0, Some(0.1)),
            dot(4.0, Some(0.4)),
            dot(8.0, None),
        ];
        let line = slope(&dots, 2.0);
        assert!((order(&line, 0.0).unwrap() - 2.0).abs() < 1e-12);
        assert!((line[0][0] - 4.0).abs() < 1e-12 && (line[0][1] - 0.2).abs() < 1e-12);
        assert!((line[32][0] - 1.0).abs() < 1e-12);
        assert!(slope(&dots[3..], 2.0).is_empty());
    }

    /// Marks of runs that did not end are near their place, and those of two models or meshes apart.
    #[test]
    fn marks_of_runs_that_did_not_end_are_apart() {
        let dot = |isometry, mesh: usize, y: Option<f64>| Dot {
            isometry,
            mesh,
            x: 2.0,
            y,
        };
        let mut dots = vec![dot(Isometry::Rods, 0, Some(0.1))];
        for isometry in Isometry::ALL {
            dots.extend([0, 1].map(|mesh| dot(isometry, mesh, None)));
        }
        let figure = Figure {
            x: Scale::ticks("h", vec![(1.0, "1".into()), (4.0, "4".into())]),
            rows: Vec::new(),
            meshes: vec!["a".into(), "b".into()],
            guide: String::new(),
            joined: Joined::Yes,
            size: [100.0, 80.0],
        };
        let marks = figure.marks(&Panel {
            title: String::new(),
            dots,
            guides: Vec::new(),
        });
        assert_eq!(marks.len(), 2 * Isometry::ALL.len());
        let mean = marks.iter().map(|m| m.0).sum::<f64>() / marks.len() as f64;
        assert!((mean - 50.0).abs() < 1e-9, "{mean}");
        for pair in marks.windows(2) {
            assert!((pair[1].0 - pair[0].0 - BESIDE).abs() < 1e-9);
        }
    }

    #[test]
    fn places_on_axes() {
        let log = Scale::decades("e", [0.02, 3.0].into_iter());
        assert!((log.part(0.1) - 1.0 / 3.0).abs() < 1e-12 && log.holds(10.0) && !log.holds(11.0));
        let ticks = Scale::ticks("h", vec![(1.0, "1".into()), (4.0, "4".into())]);
        assert!((ticks.part(2.0) - 0.5).abs() < 1e-12);
    }
}
