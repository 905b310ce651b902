//! The plots of the scaling study.

use super::drape::DrapeRow;
use super::findings::points;
use super::measure::Row;
use super::results::Results;
use super::tables::factor_bytes;
use super::whole::{Damped, SCENES, name};
use crate::draw::{Axis, Colour, Drawing, Line, Marker, Series, column, palette};
use crate::report::Chart;

/// A law through the last point of a series.
fn law(name: &str, of: &[[f64; 2]], f: impl Fn(f64) -> f64) -> Series {
    let scale = of.last().map_or(1.0, |p| p[1] / f(p[0]));
    series(
        name,
        of.iter().map(|p| [p[0], scale * f(p[0])]).collect(),
        palette::GREY,
        None,
    )
}

fn series(name: &str, points: Vec<[f64; 2]>, colour: Colour, marker: Option<Marker>) -> Series {
    Series {
        name: name.into(),
        points,
        colour,
        marker,
        line: if marker.is_some() {
            Line::Solid
        } else {
            Line::Dashed
        },
    }
}

fn panel(label: &str, series: Vec<Series>) -> Drawing {
    let all = |k: usize| {
        let of = move |s: &Series| s.points.iter().map(move |p| p[k]).collect::<Vec<_>>();
        series.iter().flat_map(of)
    };
    let x = Axis::holding("vertices", all(0));
    let y = Axis::holding(label, all(1));
    Chart::new(x, y, [230.0, 130.0], series).draw()
}

/// Time, time with contact, memory and operations against the number of vertices.
pub(super) fn plot(results: &Results) -> Drawing {
    let rows = &results.hanging;
    let of = |f: fn(&Row) -> f64| points(rows, |r| [r.vertices as f64, f(r)]);
    let step = of(|r| r.per_step);
    let stored = of(|r| factor_bytes(r.best()) / 1e6);
    let dissection = of(|r| r.orders[1].fill.operations);
    let time = panel(
        "seconds",
        vec![
            series("step", step.clone(), palette::BLUE, Some(Marker::Disc)),
            series(
                "factor, min. degree",
                of(|r| r.orders[0].numeric),
                palette::ORANGE,
                Some(Marker::Square),
            ),
            series(
                "factor, dissection",
                of(|r| r.orders[1].numeric),
                palette::GREEN,
                Some(Marker::Triangle),
            ),
            series(
                "order, dissection",
                of(|r| r.orders[1].order),
                palette::PURPLE,
                Some(Marker::Diamond),
            ),
            law("~V~^{1.5}", &step, |v| v.powf(1.5)),
        ],
    );
    let memory = panel(
        "megabytes",
        vec![
            series(
                "process, peak",
                rows.iter()
                    .filter_map(|r| Some([r.vertices as f64, r.peak? / 1e6]))
                    .collect(),
                palette::BLUE,
                Some(Marker::Disc),
            ),
            series(
                "Cholesky factor",
                stored.clone(),
                palette::GREEN,
                Some(Marker::Triangle),
            ),
            law("~V~ log ~V~", &stored, |v| v * v.ln()),
        ],
    );
    let operations = panel(
        "operations",
        vec![
            series(
                "minimum degree",
                of(|r| r.orders[0].fill.operations),
                palette::ORANGE,
                Some(Marker::Square),
            ),
            series(
                "nested dissection",
                dissection.clone(),
                palette::GREEN,
                Some(Marker::Triangle),
            ),
            law("~V~^{1.5}", &dissection, |v| v.powf(1.5)),
        ],
    );
    let drape = |f: fn(&DrapeRow) -> f64| points(&results.draping, |r| [r.vertices as f64, f(r)]);
    let contact = panel(
        "seconds, with contact",
        vec![
            series(
                "step",
                drape(|r| r.per_step),
                palette::BLUE,
                Some(Marker::Disc),
            ),
            series(
                "contact, detection",
                drape(|r| r.detection),
                palette::VERMILION,
                Some(Marker::Square),
            ),
            series(
                "contact, distances",
                drape(|r| r.evaluation),
                palette::PURPLE,
                Some(Marker::Diamond),
            ),
            law("~V~^{1.5}", &drape(|r| r.per_step), |v| v.powf(1.5)),
        ],
    );
    let mut panels = vec![time, contact, memory, operations];
    panels.extend(whole(results));
    column(&panels, 26.0)
}

/// Whole runs by the default method from the first start, of meshes on which they came to the end.
fn whole(results: &Results) -> Option<Drawing> {
    let of = |scene| -> Vec<[f64; 2]> {
        let mut runs = results.whole_of(scene);
        runs.retain(|r| r.measured.run.ended() && r.method == Damped::Bdf2 && r.start == 1);
        runs.iter()
            .filter_map(|r| Some([r.vertices as f64, r.measured.run.rate()?]))
            .collect()
    };
    let [hanging, tablecloth] = SCENES.map(of);
    let law = law("~V~^{1.5}", &hanging, |v| v.powf(1.5));
    let all: Vec<Series> = [
        series(name(SCENES[0]), hanging, palette::BLUE, Some(Marker::Disc)),
        series(
            name(SCENES[1]),
            tablecloth,
            palette::VERMILION,
            Some(Marker::Square),
        ),
        law,
    ]
    .into_iter()
    .filter(|s| !s.points.is_empty())
    .collect();
    (!all.is_empty()).then(|| panel("seconds per simulated second", all))
}
