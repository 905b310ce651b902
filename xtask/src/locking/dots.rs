//! Charts of measured numbers: the colour is the model, the symbol is the mesh.

use super::isometry::Isometry;
use super::meshes::Pattern;
use super::sample::Sample;
use crate::draw::{Axis, Chart, Charts, Legend, Marker, Missing, Series, palette};
use crate::report::{number, order_line};

/// Symbols of the meshes of a figure, in order.
const MARKERS: [Marker; 4] = [
    Marker::Disc,
    Marker::Square,
    Marker::Triangle,
    Marker::Diamond,
];

/// Distance of the symbols of two models or meshes on that line, points.
const BESIDE: f64 = 3.0;

/// The result of one run.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Dot {
    pub(super) isometry: Isometry,
    /// Number of the mesh among those that the figure names.
    pub(super) mesh: usize,
    pub(super) x: f64,
    /// What was measured; nothing of a run that did not end or has no such value.
    pub(super) y: Option<f64>,
}

impl Dot {
    /// Of a sample.
    pub(super) fn of<J, M>(sample: &Sample<J, M>, mesh: usize, x: f64, y: Option<f64>) -> Self {
        let isometry = sample.isometry;
        Self {
            isometry,
            mesh,
            x,
            y,
        }
    }
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
    pub(super) x: Axis,
    pub(super) rows: Vec<(Axis, Vec<Panel>)>,
    /// Names of the meshes: of each symbol.
    pub(super) meshes: Vec<String>,
    /// Name of the lines for comparison.
    pub(super) guide: String,
    pub(super) joined: Joined,
    /// Size of the area inside the axes of each panel, points.
    pub(super) size: [f64; 2],
}

impl Panel {
    /// Without lines for comparison.
    pub(super) fn new(title: impl Into<String>, dots: Vec<Dot>) -> Self {
        Self {
            title: title.into(),
            dots,
            guides: Vec::new(),
        }
    }

    /// Errors against the spacing, with a line of the second order.
    pub(super) fn of_second_order(title: String, dots: Vec<Dot>) -> Self {
        Self {
            title,
            guides: vec![order_line(&measured(&dots), 2.0)],
            dots,
        }
    }
}

impl Figure {
    /// One row of panels with single points, without lines for comparison.
    pub(super) fn of_row(
        x: Axis,
        y: Axis,
        panels: Vec<Panel>,
        meshes: Vec<String>,
        size: [f64; 2],
    ) -> Self {
        Self {
            x,
            rows: vec![(y, panels)],
            meshes,
            guide: String::new(),
            joined: Joined::No,
            size,
        }
    }

    /// Errors against the spacings (metres) of meshes by all patterns.
    pub(super) fn of_spacings(spacings: &[f64], rows: Vec<(Axis, Vec<Panel>)>) -> Self {
        let ticks = spacings.iter().map(|h| (*h, number(1e3 * h)));
        Self {
            x: Axis::at("h, mm", ticks.collect()),
            rows,
            meshes: Pattern::ALL.map(|p| p.to_string()).to_vec(),
            guide: "h²".into(),
            joined: Joined::Yes,
            size: [110.0, 130.0],
        }
    }

    /// The charts; the names of models, meshes and lines are to the right of the first row.
    pub(super) fn draw(&self) -> Charts {
        let rows = self.rows.iter().enumerate().map(|(k, (y, panels))| {
            let last = panels.len().saturating_sub(1);
            let chart = |(i, panel)| {
                let is_named = k == 0 && i == last;
                let legend = if is_named {
                    Legend::Right
                } else {
                    Legend::None
                };
                let y = y.clone();
                let y = if i == 0 { y } else { y.unlabelled() };
                self.chart(panel, y).with_legend(legend)
            };
            panels.iter().enumerate().map(chart).collect()
        });
        Charts(rows.collect())
    }

    fn chart(&self, panel: &Panel, y: Axis) -> Chart {
        let guide = |points: &Vec<[f64; 2]>| Series::guide("", points.clone());
        let mut series: Vec<Series> = panel.guides.iter().map(guide).collect();
        for isometry in Isometry::ALL {
            let of_mesh = |mesh| self.series(panel, isometry, mesh);
            series.extend((0..self.meshes.len()).map(of_mesh));
        }
        series.extend(self.legend());
        Chart::new(self.x.clone(), y, self.size, series)
            .titled(&panel.title)
            .with_missing(self.missing(panel))
    }

    /// The runs of a model on a mesh that ended.
    fn series(&self, panel: &Panel, isometry: Isometry, mesh: usize) -> Series {
        let of = panel.dots.iter();
        let of = of.filter(|d| d.isometry == isometry && d.mesh == mesh);
        let points = of.filter_map(|d| Some([d.x, d.y?])).collect();
        let marker = MARKERS[mesh % MARKERS.len()];
        match self.joined {
            Joined::Yes => Series::line("", isometry.colour(), points).marked(marker),
            Joined::No => Series::dots("", isometry.colour(), marker, points),
        }
    }

    /// The runs without a value: models and meshes beside one another.
    fn missing(&self, panel: &Panel) -> Vec<Missing> {
        // Where lines join the meshes of a model, all of them are at the same places.
        let meshes = match self.joined {
            Joined::Yes => self.meshes.len(),
            Joined::No => 1,
        };
        let count = Isometry::ALL.len() * meshes;
        let mark = |dot: &Dot| {
            let model = Isometry::ALL.iter().position(|m| *m == dot.isometry);
            let place = model.unwrap_or(0) * meshes + dot.mesh % meshes;
            Missing {
                x: dot.x,
                beside: BESIDE * (place as f64 - 0.5 * (count as f64 - 1.0)),
                colour: dot.isometry.colour(),
                marker: MARKERS[dot.mesh % MARKERS.len()],
            }
        };
        let not_ended = panel.dots.iter().filter(|d| d.y.is_none());
        not_ended.map(mark).collect()
    }

    /// Series without points for the names of models, meshes and lines.
    fn legend(&self) -> Vec<Series> {
        let model = |m: &Isometry| Series::line(&m.to_string(), m.colour(), Vec::new());
        let mut legend: Vec<Series> = Isometry::ALL.iter().map(model).collect();
        let meshes = self.meshes.iter().zip(MARKERS);
        let mesh =
            |(name, marker): (&String, _)| Series::dots(name, palette::INK, marker, Vec::new());
        legend.extend(meshes.map(mesh));
        if !self.guide.is_empty() {
            legend.push(Series::guide(&self.guide, Vec::new()));
        }
        legend
    }
}

/// The points of the runs that ended.
fn measured(dots: &[Dot]) -> Vec<[f64; 2]> {
    dots.iter().filter_map(|d| Some([d.x, d.y?])).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

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
        let x = Axis::at("h", vec![(1.0, "1".into()), (4.0, "4".into())]);
        let meshes = vec!["a".into(), "b".into()];
        let figure = Figure {
            joined: Joined::Yes,
            ..Figure::of_row(x.clone(), x, Vec::new(), meshes, [100.0, 80.0])
        };
        let marks = figure.missing(&Panel::new("", dots));
        assert_eq!(marks.len(), 2 * Isometry::ALL.len());
        let mean = marks.iter().map(|m| m.beside).sum::<f64>() / marks.len() as f64;
        assert!(mean.abs() < 1e-9, "{mean}");
        for pair in marks.windows(2) {
            assert!((pair[1].beside - pair[0].beside - BESIDE).abs() < 1e-9);
        }
    }
}
