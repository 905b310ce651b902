//! The charts of the scaling study.

use super::Results;
use super::drape::DrapeRow;
use super::steps::Row;
use super::tables::factor_bytes;
use super::whole::{DEFAULT, SCENES, name};
use crate::draw::{Chart, Charts, Series};

type Points = Vec<[f64; 2]>;

/// A chart of named quantities against the number of vertices, and of a law through the last point of one.
fn chart(label: &str, of: &[(&str, Points)], law: (&str, usize, fn(f64) -> f64)) -> Chart {
    let styled =
        |(k, (name, points)): (usize, &(&str, Points))| Series::styled(k, name, points.clone());
    let mut series: Vec<Series> = of.iter().enumerate().map(styled).collect();
    let (name, k, f) = law;
    let scale = of[k].1.last().map_or(1.0, |p| p[1] / f(p[0]));
    let law = of[k].1.iter().map(|p| [p[0], scale * f(p[0])]).collect();
    series.push(Series::guide(name, law));
    series.retain(|s| !s.points.is_empty());
    Chart::log_log("vertices", label, [230.0, 130.0], series)
}

/// The power of V that planar sheets are expected to follow.
const POWER: (&str, usize, fn(f64) -> f64) = ("V to the power 1.5", 0, |v| v.powf(1.5));

/// Time, time with contact, memory, operations and whole runs against the number of vertices.
pub(super) fn charts(results: &Results) -> Charts {
    let of = |value: fn(&Row) -> f64| -> Points {
        let rows = results.hanging.iter();
        rows.map(|r| [r.vertices as f64, value(r)]).collect()
    };
    let draped = |value: fn(&DrapeRow) -> f64| -> Points {
        let rows = results.draping.iter();
        rows.map(|r| [r.vertices as f64, value(r)]).collect()
    };
    let peaks = results.hanging.iter();
    let peaks = peaks.filter_map(|r| Some([r.vertices as f64, r.peak? / 1e6]));
    let whole = SCENES.map(|scene| {
        // Of meshes on which the default method came to the end, from the first start.
        let mut runs = results.whole_of(scene);
        runs.retain(|r| r.course.is_good() && r.method == DEFAULT && r.start == 1);
        let rate = runs
            .iter()
            .filter_map(|r| Some([r.mesh.vertices as f64, r.course.rate()?]));
        (name(scene), rate.collect())
    });
    Charts::column([
        chart(
            "seconds",
            &[
                ("step", of(Row::step)),
                ("factor, min. degree", of(|r| r.orders[0].numeric)),
                ("factor, dissection", of(|r| r.orders[1].numeric)),
                ("order, dissection", of(|r| r.orders[1].order)),
            ],
            POWER,
        ),
        chart(
            "seconds, with contact",
            &[
                ("step", draped(DrapeRow::step)),
                ("contact, detection", draped(DrapeRow::detection)),
                ("contact, distances", draped(DrapeRow::evaluation)),
            ],
            POWER,
        ),
        chart(
            "megabytes",
            &[
                ("process, peak", peaks.collect()),
                ("Cholesky factor", of(|r| factor_bytes(r.best()) / 1e6)),
            ],
            ("V log V", 1, |v| v * v.ln()),
        ),
        chart(
            "operations",
            &[
                ("nested dissection", of(|r| r.orders[1].operations)),
                ("minimum degree", of(|r| r.orders[0].operations)),
            ],
            POWER,
        ),
        chart("seconds per simulated second", &whole, POWER),
    ])
}
