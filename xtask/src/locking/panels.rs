//! Panels of measured numbers: the colour is the model, the symbol is the mesh.

use super::model::Model;
use crate::draw::{Axis, Chart, Charts, Legend, Marker, Series, palette};

/// Symbols of the kinds of meshes, in order.
const MARKERS: [Marker; 5] = [
    Marker::Disc,
    Marker::Square,
    Marker::Triangle,
    Marker::Diamond,
    Marker::Down,
];

/// Size of the area inside the axes, points.
const SIZE: [f64; 2] = [125.0, 130.0];

/// A number of a run: the model, the number of its mesh, and its place.
pub(super) type Point = (Model, usize, [f64; 2]);

/// Numbers with a common title and axes.
#[derive(Clone, Debug)]
pub(super) struct Panel {
    pub(super) title: String,
    pub(super) axes: [Axis; 2],
    /// The points of a model on a mesh are joined in the order given.
    pub(super) points: Vec<Point>,
    /// Grey dashed lines for comparison.
    pub(super) guides: Vec<Vec<[f64; 2]>>,
}

/// Rows of panels with the names of models, meshes and lines for comparison to the right of the first row. Meshes
/// are of a kind, and have the same symbol, where their names are the same.
pub(super) fn charts(
    rows: Vec<Vec<Panel>>,
    models: &[Model],
    meshes: &[&str],
    guide: &str,
) -> Charts {
    let mut kinds: Vec<&str> = Vec::new();
    for mesh in meshes {
        if !kinds.contains(mesh) {
            kinds.push(mesh);
        }
    }
    let kinds = &kinds;
    let marker = |name: &str| {
        let kind = kinds.iter().position(|k| *k == name);
        MARKERS[kind.unwrap_or(0) % MARKERS.len()]
    };
    let row = |(k, panels): (usize, Vec<Panel>)| {
        let last = panels.len().saturating_sub(1);
        let chart = |(i, panel): (usize, Panel)| {
            let legend = if k == 0 && i == last {
                Legend::Right
            } else {
                Legend::None
            };
            let mut series: Vec<Series> = panel
                .guides
                .iter()
                .map(|points| Series::guide("", points.clone()))
                .collect();
            for &model in models {
                for (mesh, name) in meshes.iter().enumerate() {
                    let of = panel.points.iter();
                    let of = of.filter(|p| p.0 == model && p.1 == mesh);
                    let line = Series::line("", model.colour(), of.map(|p| p.2).collect());
                    series.push(line.marked(marker(name)));
                }
            }
            let name = |m: &Model| Series::line(&m.to_string(), m.colour(), Vec::new());
            series.extend(models.iter().map(name));
            let dots = |name: &&str| Series::dots(name, palette::INK, marker(name), Vec::new());
            series.extend(kinds.iter().map(dots));
            if !guide.is_empty() {
                series.push(Series::guide(guide, Vec::new()));
            }
            let [x, y] = panel.axes;
            Chart::new(x, y, SIZE, series)
                .titled(panel.title)
                .with_legend(legend)
        };
        panels.into_iter().enumerate().map(chart).collect()
    };
    Charts(rows.into_iter().enumerate().map(row).collect())
}
