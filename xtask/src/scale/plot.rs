//! The plots of the scaling study.

use super::Results;
use super::drape::DrapeRow;
use super::findings::points;
use super::steps::Row;
use super::tables::factor_bytes;
use super::whole::{DEFAULT, SCENES, name};
use crate::draw::{Chart, Colour, Drawing, Marker, Series, column, palette};

/// A law through the last point of a series.
fn law(name: &str, of: &[[f64; 2]], f: fn(f64) -> f64) -> Series {
    let scale = of.last().map_or(1.0, |p| p[1] / f(p[0]));
    Series::guide(name, of.iter().map(|p| [p[0], scale * f(p[0])]).collect())
}

/// The power of V that planar sheets are expected to follow.
fn power_law(of: &[[f64; 2]]) -> Series {
    law("~V~^{1.5}", of, |v| v.powf(1.5))
}

/// Colour and symbol of a quantity.
type Look = (Colour, Marker);

const STEP: Look = (palette::BLUE, Marker::Disc);
const DEGREE: Look = (palette::ORANGE, Marker::Square);
const DISSECTION: Look = (palette::GREEN, Marker::Triangle);
const ORDER: Look = (palette::PURPLE, Marker::Diamond);
const DETECTION: Look = (palette::VERMILION, Marker::Square);

fn series(name: &str, points: &[[f64; 2]], (colour, marker): Look) -> Series {
    Series::line(name, colour, points.to_vec()).marked(marker)
}

fn panel(label: &str, series: Vec<Series>) -> Drawing {
    Chart::log_log("vertices", label, [230.0, 130.0], series).draw()
}

/// Time, time with contact, memory and operations against the number of vertices.
pub(super) fn plot(results: &Results) -> Drawing {
    let mut panels = vec![
        time(&results.hanging),
        contact(&results.draping),
        memory(&results.hanging),
        operations(&results.hanging),
    ];
    panels.extend(whole(results));
    column(&panels, 26.0)
}

/// A quantity of the hanging sheet against the number of vertices.
fn of(rows: &[Row], value: fn(&Row) -> f64) -> Vec<[f64; 2]> {
    points(rows, |r| [r.vertices as f64, value(r)])
}

fn time(rows: &[Row]) -> Drawing {
    let step = of(rows, Row::step);
    let [degree, dissection] = [0, 1].map(|k| {
        let numeric = rows
            .iter()
            .map(|r| [r.vertices as f64, r.orders[k].numeric]);
        numeric.collect::<Vec<_>>()
    });
    let order = of(rows, |r| r.orders[1].order);
    let all = vec![
        series("step", &step, STEP),
        series("factor, min. degree", &degree, DEGREE),
        series("factor, dissection", &dissection, DISSECTION),
        series("order, dissection", &order, ORDER),
        power_law(&step),
    ];
    panel("seconds", all)
}

fn contact(rows: &[DrapeRow]) -> Drawing {
    let of = |value: fn(&DrapeRow) -> f64| points(rows, |r| [r.vertices as f64, value(r)]);
    let step = of(DrapeRow::step);
    let all = vec![
        series("step", &step, STEP),
        series("contact, detection", &of(DrapeRow::detection), DETECTION),
        series("contact, distances", &of(DrapeRow::evaluation), ORDER),
        power_law(&step),
    ];
    panel("seconds, with contact", all)
}

fn memory(rows: &[Row]) -> Drawing {
    let peak = rows
        .iter()
        .filter_map(|r| Some([r.vertices as f64, r.peak? / 1e6]));
    let stored = of(rows, |r| factor_bytes(r.best()) / 1e6);
    let all = vec![
        series("process, peak", &peak.collect::<Vec<_>>(), STEP),
        series("Cholesky factor", &stored, DISSECTION),
        law("~V~ log ~V~", &stored, |v| v * v.ln()),
    ];
    panel("megabytes", all)
}

fn operations(rows: &[Row]) -> Drawing {
    let dissection = of(rows, |r| r.orders[1].fill.operations);
    let degree = of(rows, |r| r.orders[0].fill.operations);
    let all = vec![
        series("minimum degree", &degree, DEGREE),
        series("nested dissection", &dissection, DISSECTION),
        power_law(&dissection),
    ];
    panel("operations", all)
}

/// Whole runs by the default method from the first start, of meshes on which they came to the end.
fn whole(results: &Results) -> Option<Drawing> {
    let of = |scene| -> Vec<[f64; 2]> {
        let mut runs = results.whole_of(scene);
        runs.retain(|r| r.course.is_good() && r.method == DEFAULT && r.start == 1);
        let points = runs
            .iter()
            .filter_map(|r| Some([r.mesh.vertices as f64, r.course.rate()?]));
        points.collect()
    };
    let [hanging, tablecloth] = SCENES.map(of);
    let mut all = vec![
        series(name(SCENES[0]), &hanging, STEP),
        series(name(SCENES[1]), &tablecloth, DETECTION),
        power_law(&hanging),
    ];
    all.retain(|s| !s.points.is_empty());
    (!all.is_empty()).then(|| panel("seconds per simulated second", all))
}
