//! Panels of measured numbers: a line for each model, with a band of all meshes.

use super::median;
use super::model::Model;
use crate::draw::{Axis, Chart, Charts, Legend, Marker, Series};
use crate::report::extremes;

/// Symbols of the models, in order.
const MARKERS: [Marker; 3] = [Marker::Disc, Marker::Square, Marker::Triangle];

/// Size of the area inside the axes, points.
const SIZE: [f64; 2] = [125.0, 130.0];

/// What lines and bands are.
pub(super) const BANDS: &str = "In the figure lines are medians over the meshes of a size on which the sheet comes to rest, and bands have all of them.";

/// Numbers with a common title and axes.
#[derive(Clone, Debug)]
pub(super) struct Panel {
    pub(super) title: String,
    pub(super) axes: [Axis; 2],
    /// The numbers of single runs: the model and the place.
    pub(super) points: Vec<(Model, [f64; 2])>,
    /// Grey dashed lines for comparison.
    pub(super) guides: Vec<Vec<[f64; 2]>>,
}

/// Rows of panels with the names of models and lines for comparison to the right of the first row.
pub(super) fn charts(rows: Vec<Vec<Panel>>, models: &[Model], guide: &str) -> Charts {
    let row = |(k, panels): (usize, Vec<Panel>)| {
        let last = panels.len().saturating_sub(1);
        let chart = |(i, panel): (usize, Panel)| {
            let legend = if k == 0 && i == last {
                Legend::Right
            } else {
                Legend::None
            };
            let lines = panel.guides.iter();
            let mut series: Vec<Series> = lines
                .map(|points| Series::guide("", points.clone()))
                .collect();
            let curves = models.iter().map(|model| curve(&panel.points, *model));
            let curves: Vec<Vec<[f64; 4]>> = curves.collect();
            for (model, curve) in models.iter().zip(&curves) {
                let band: Vec<[f64; 3]> = curve.iter().map(|c| [c[0], c[1], c[3]]).collect();
                series.push(Series::band(model.colour(), &band));
            }
            for ((model, curve), marker) in models.iter().zip(&curves).zip(MARKERS) {
                let points = curve.iter().map(|c| [c[0], c[2]]).collect();
                let line = Series::line(&model.to_string(), model.colour(), points);
                series.push(line.marked(marker));
            }
            if !guide.is_empty() {
                series.push(Series::guide(guide, Vec::new()));
            }
            let [x, y] = panel.axes;
            let y = if i == 0 { y } else { y.unlabelled() };
            Chart::new(x, y, SIZE, series)
                .titled(panel.title)
                .with_legend(legend)
        };
        panels.into_iter().enumerate().map(chart).collect()
    };
    Charts(rows.into_iter().enumerate().map(row).collect())
}

/// The numbers of a model: each place with the least, the median and the largest value there.
fn curve(points: &[(Model, [f64; 2])], model: Model) -> Vec<[f64; 4]> {
    let of: Vec<[f64; 2]> = points
        .iter()
        .filter(|p| p.0 == model)
        .map(|p| p.1)
        .collect();
    let mut places: Vec<f64> = of.iter().map(|p| p[0]).collect();
    places.sort_by(f64::total_cmp);
    places.dedup();
    let at = |place: f64| {
        let values = of.iter().filter(|p| p[0] == place).map(|p| p[1]);
        let values: Vec<f64> = values.filter(|v| v.is_finite()).collect();
        let [low, high] = extremes(values.iter().copied())?;
        Some([place, low, median(values), high])
    };
    places.into_iter().filter_map(at).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn curves_have_the_values_of_one_model_in_order() {
        let (a, b) = (Model::Elastic, Model::Rods);
        let points = [
            (a, [2.0, 5.0]),
            (a, [1.0, 7.0]),
            (b, [2.0, 100.0]),
            (a, [2.0, 3.0]),
            (a, [2.0, 4.5]),
            (a, [3.0, f64::NAN]),
        ];
        let found = curve(&points, a);
        assert_eq!(found, [[1.0, 7.0, 7.0, 7.0], [2.0, 3.0, 4.5, 5.0]]);
    }
}
