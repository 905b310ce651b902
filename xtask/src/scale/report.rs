//! Tables, plots and words of the scaling study.

use super::measure::{OrderRow, Row, STEP, exponent};
use crate::draw::{Axis, Colour, Drawing, Legend, Line, Marker, Plot, Series, column, palette};
use anyhow::Result;
use std::fmt::Write;

/// The part of a page that tells about scale, and the files that belong to it.
pub(crate) struct Section {
    /// HTML, with its pictures inside.
    pub(crate) html: String,
    /// Names and contents.
    pub(crate) files: Vec<(String, Vec<u8>)>,
}

/// The section of some measured rows.
pub(crate) fn section(rows: &[Row]) -> Result<Section> {
    let title = "Time, memory and fill of a step against the number of vertices";
    let svg = plot(rows).to_svg(title)?;
    let inline = svg.find("<svg").map_or(svg.as_str(), |k| &svg[k..]);
    let mut html = String::from("<section id=\"scale\"><h2>Scale</h2>");
    // Writing to a string cannot fail.
    let _ = write!(
        html,
        "<p>A square sheet of 1 m and 0.1 kg hangs by a corner from a start that is flat but for a bump of 1 mm; steps of \
         {} ms by the default method, the first {} after one of warm-up at each mesh size, without contact. \
         Later steps of the fine meshes cost more: near the flat state the length equations are all but dependent.</p><figure>{inline}</figure><p>{}</p>",
        1e3 * STEP,
        rows.first().map_or(0, |r| r.steps),
        conclusion(rows)
    );
    let steps = [
        "mesh",
        "V/F",
        "set-up, s",
        "step, s",
        "iterations",
        "factorisations",
        "strain",
        "energy error",
        "factor, MB",
        "peak, MB",
    ];
    table(
        &mut html,
        "Per step of the hanging sheet; the energy error is relative to the potential energy released, the memory is that \
         of the Cholesky factor and the peak of the process.",
        &steps,
        rows.iter().map(|r| {
            vec![
                format!("M<sup>{}</sup>", r.level),
                format!("{}/{}", r.vertices, r.faces),
                format!("{:.3}", r.setup),
                format!("{:.2e}", r.per_step),
                format!("{:.1}", r.iterations),
                format!("{:.1}", r.factorisations),
                format!("{:.0e}", r.strain),
                format!("{:.0e}", r.balance),
                format!("{:.1}", factor_bytes(r.best()) / 1e6),
                r.peak
                    .map_or("unknown".into(), |p| format!("{:.0}", p / 1e6)),
            ]
        }),
    );
    let orders = [
        "mesh",
        "order",
        "found in, ms",
        "symbolic, ms",
        "numeric, ms",
        "solve, ms",
        "entries of L",
        "stored",
        "operations",
    ];
    table(
        &mut html,
        "Elimination orders of the matrix of a step.",
        &orders,
        rows.iter().flat_map(|r| {
            r.orders.iter().map(|o| {
                vec![
                    format!("M<sup>{}</sup>", r.level),
                    name(o).into(),
                    format!("{:.2}", 1e3 * o.order),
                    format!("{:.2}", 1e3 * o.symbolic),
                    format!("{:.2}", 1e3 * o.numeric),
                    format!("{:.2}", 1e3 * o.solve),
                    format!("{:.3e}", o.fill.entries),
                    format!("{:.3e}", o.stored as f64),
                    format!("{:.3e}", o.fill.operations),
                ]
            })
        }),
    );
    html.push_str("</section>\n");
    Ok(Section {
        html,
        files: vec![
            ("scale.svg".into(), svg.into_bytes()),
            ("scale.csv".into(), csv(rows).into_bytes()),
        ],
    })
}

/// The section as a page of its own.
pub(super) fn page(rows: &[Row]) -> Result<String> {
    Ok(format!(
        "<!DOCTYPE html>\n<html lang=\"en\"><head><meta charset=\"utf-8\"><title>isosheet: scale</title><style>\
         body{{font:16px/1.5 Helvetica,Arial,sans-serif;color:#222;margin:2.5rem auto;max-width:64rem;padding:0 1.5rem}}\
         figure{{margin:1rem 0}}figure svg{{max-width:100%;height:auto}}table{{border-collapse:collapse;font-size:.88rem;\
         margin:1rem 0}}caption{{text-align:left;color:#666}}th,td{{border-bottom:1px solid #ddd;padding:.25rem .8rem .25rem 0;\
         text-align:left}}</style></head><body>{}</body></html>\n",
        section(rows)?.html
    ))
}

fn table(html: &mut String, caption: &str, head: &[&str], rows: impl Iterator<Item = Vec<String>>) {
    let _ = write!(html, "<table><caption>{caption}</caption><tr>");
    for h in head {
        let _ = write!(html, "<th>{h}</th>");
    }
    html.push_str("</tr>");
    for row in rows {
        html.push_str("<tr>");
        for cell in row {
            let _ = write!(html, "<td>{cell}</td>");
        }
        html.push_str("</tr>");
    }
    html.push_str("</table>");
}

fn name(o: &OrderRow) -> &'static str {
    use isosheet_coords::linalg::Ordering;
    match o.ordering {
        Ordering::MinimumDegree => "minimum degree",
        Ordering::NestedDissection => "nested dissection",
        Ordering::Best => "best",
    }
}

fn factor_bytes(o: &OrderRow) -> f64 {
    8.0 * o.stored as f64
}

/// Points of a quantity against the number of vertices.
fn points(rows: &[Row], value: impl Fn(&Row) -> Option<f64>) -> Vec<[f64; 2]> {
    rows.iter()
        .filter_map(|r| value(r).map(|y| [r.vertices as f64, y]))
        .collect()
}

/// What the measurements say.
fn conclusion(rows: &[Row]) -> String {
    let power = |value: &dyn Fn(&Row) -> Option<f64>| {
        exponent(&points(rows, value)).map_or("?".into(), |p| format!("{p:.2}"))
    };
    let mut out = format!(
        "Fitted powers of V: time per step {}, factorisations per step {}, one numeric factorisation {}, its operations {}, \
         entries of the factor {}.",
        power(&|r| Some(r.per_step)),
        power(&|r| Some(r.factorisations)),
        power(&|r| Some(r.best().numeric)),
        power(&|r| Some(r.best().fill.operations)),
        power(&|r| Some(r.best().fill.entries)),
    );
    if let Some(last) = rows.last() {
        let [degree, dissection] = &last.orders;
        let _ = write!(
            out,
            " At {} vertices nested dissection needs {:.2} times the operations and {:.2} times the entries of minimum degree.",
            last.vertices,
            dissection.fill.operations / degree.fill.operations,
            dissection.fill.entries / degree.fill.entries
        );
        if let Some(peak) = last.peak {
            let _ = write!(out, " The process used at most {:.2} GB.", peak / 1e9);
        }
    }
    out
}

/// The rows for people.
pub(super) fn text(rows: &[Row]) -> String {
    let mut out = String::from(
        "mesh  vertices   step, s  iterations  factorisations  factor, MB  peak, MB\n",
    );
    for r in rows {
        let _ = writeln!(
            out,
            "M^{:<3} {:>8} {:>9.2e} {:>11.1} {:>15.1} {:>11.1} {:>9}",
            r.level,
            r.vertices,
            r.per_step,
            r.iterations,
            r.factorisations,
            factor_bytes(r.best()) / 1e6,
            r.peak.map_or("?".into(), |p| format!("{:.0}", p / 1e6))
        );
    }
    let _ = writeln!(out, "{}", conclusion(rows));
    out
}

fn csv(rows: &[Row]) -> String {
    let mut out = String::from(
        "level,vertices,faces,step_size_s,steps,setup_s,step_s,iterations,factorisations,strain,energy_error,peak_bytes,\
         ordering,order_s,symbolic_s,numeric_s,solve_s,factor_entries,factor_stored,factor_operations\n",
    );
    for r in rows {
        for o in &r.orders {
            let peak = r.peak.map_or(String::new(), |p| format!("{p:.0}"));
            let _ = writeln!(
                out,
                "{},{},{},{STEP},{},{:e},{:e},{},{},{:e},{:e},{peak},{},{:e},{:e},{:e},{:e},{},{},{}",
                r.level,
                r.vertices,
                r.faces,
                r.steps,
                r.setup,
                r.per_step,
                r.iterations,
                r.factorisations,
                r.strain,
                r.balance,
                name(o).replace(' ', "_"),
                o.order,
                o.symbolic,
                o.numeric,
                o.solve,
                o.fill.entries,
                o.stored,
                o.fill.operations
            );
        }
    }
    out
}

/// A decade axis that holds all values.
fn decades(label: &str, values: impl Iterator<Item = f64> + Clone) -> Axis {
    let low = values.clone().fold(f64::INFINITY, f64::min).log10().floor() as i32;
    let high = values.fold(0.0, f64::max).log10().ceil() as i32;
    Axis::decades(label, low, high.max(low + 1), 1)
}

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
        series
            .iter()
            .flat_map(move |s| s.points.iter().map(move |p| p[k]))
    };
    Plot {
        x: decades("vertices", all(0)),
        y: decades(label, all(1)),
        size: [230.0, 130.0],
        legend: Legend::Right,
        series: series.clone(),
    }
    .draw()
}

fn plot(rows: &[Row]) -> Drawing {
    let of = |f: fn(&Row) -> f64| points(rows, |r| Some(f(r)));
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
                points(rows, |r| r.peak.map(|p| p / 1e6)),
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
    column(&[time, memory, operations], 26.0)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_section_is_whole() {
        let rows: Vec<Row> = [0, 1]
            .map(|level| super::super::measure(level, 2).expect("small sheets move"))
            .to_vec();
        let section = section(&rows).expect("drawn");
        assert!(section.html.contains("<svg") && section.html.contains("nested dissection"));
        let csv = &section.files[1].1;
        let lines: Vec<&[u8]> = csv.split(|b| *b == b'\n').collect();
        assert_eq!(lines.len(), 1 + 2 * 2 + 1);
        let fields = |l: &[u8]| l.split(|b| *b == b',').count();
        assert!(lines[1..5].iter().all(|l| fields(l) == fields(lines[0])));
        assert!(text(&rows).contains("M^1"));
    }
}
