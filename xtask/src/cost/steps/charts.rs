//! The charts of steps by size.

use super::measure::Row;
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

/// Time, time with contact, memory and operations against the number of vertices.
pub(super) fn charts(rows: &[Row]) -> Charts {
    let of = |value: fn(&Row) -> Option<f64>| -> Points {
        let point = |r: &Row| Some([r.vertices as f64, value(r)?]);
        rows.iter().filter_map(point).collect()
    };
    Charts::column([
        chart(
            "CPU seconds",
            &[
                ("step", of(|r| r.hanging.cost.cpu_per_step())),
                ("factor, min. degree", of(|r| Some(r.orders[0].numeric))),
                ("factor, dissection", of(|r| Some(r.orders[1].numeric))),
                ("order, dissection", of(|r| Some(r.orders[1].order))),
            ],
            POWER,
        ),
        chart(
            "CPU seconds, with contact",
            &[
                ("step", of(|r| r.draping.cost.cpu_per_step())),
                ("contact, detection", of(|r| Some(r.contact.detection))),
                ("contact, distances", of(|r| Some(r.contact.distances))),
            ],
            POWER,
        ),
        chart(
            "megabytes",
            &[
                ("process, peak", of(|r| Some(r.peak? / 1e6))),
                ("Cholesky factor", of(|r| Some(r.best().bytes() / 1e6))),
            ],
            ("V log V", 1, |v| v * v.ln()),
        ),
        chart(
            "operations",
            &[
                ("nested dissection", of(|r| Some(r.orders[1].operations))),
                ("minimum degree", of(|r| Some(r.orders[0].operations))),
            ],
            POWER,
        ),
    ])
}
