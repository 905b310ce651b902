//! Tables and words of the scaling study.

use super::measure::{OrderRow, Row, STEP, exponent};
use super::{DrapeRow, Results, drape, plot};
use crate::figures::{Table, machine};
use crate::report::html::{STYLE, escape, inline_svg, table};
use anyhow::Result;
use std::fmt::Write;

/// What the picture shows, for those who do not see it.
const PICTURE: &str = "Time, memory and fill of a step against the number of vertices";

/// All files but the page: names and contents.
pub(super) fn files(results: &Results) -> Result<Vec<(String, Vec<u8>)>> {
    let plot = plot::plot(results);
    Ok(vec![
        ("scale.svg".into(), plot.to_svg(PICTURE)?.into_bytes()),
        ("scale.png".into(), plot.to_png(PICTURE)?),
        ("scale.csv".into(), csv(&results.hanging).into_bytes()),
        (
            "draping.csv".into(),
            draping_csv(&results.draping).into_bytes(),
        ),
    ])
}

/// The page.
pub(super) fn page(results: &Results) -> Result<String> {
    let svg = plot::plot(results).to_svg(PICTURE)?;
    let mut out = format!(
        "<!DOCTYPE html>\n<html lang=\"en\"><head><meta charset=\"utf-8\"><title>isosheet: scale</title><style>{STYLE}</style></head>\
         <body><h1>Scale</h1>"
    );
    paragraph(
        &mut out,
        &format!(
            "A square sheet of 1 m and 0.1 kg hangs by a corner from a start that is flat but for a bump of 1 mm; steps of {} ms by the default \
             method, the first {} after one of warm-up at each mesh size, without contact. Later steps of the fine meshes cost more: near the \
             flat state the length equations are all but dependent. Machine: {}.",
            1e3 * STEP,
            results.hanging.first().map_or(0, |r| r.steps),
            machine()
        ),
    );
    let _ = write!(out, "<figure>{}</figure>", inline_svg(&svg));
    paragraph(&mut out, &conclusion(&results.hanging));
    table(&mut out, &steps(&results.hanging));
    paragraph(&mut out, &threads(&results.hanging));
    table(&mut out, &orders(&results.hanging));
    out.push_str("<h2>With contact</h2>");
    paragraph(
        &mut out,
        &format!(
            "The same sheet with a bump of {} m, all vertices free, above a square table of half its side that its lowest part touches at once; \
             contact with the table and of the sheet with itself. Steps as above. (A nearly flat cloth on a table needs so many iterations from \
             16 641 vertices on that they would hide the price of the size.)",
            drape::BUMP
        ),
    );
    paragraph(&mut out, &draping_conclusion(results));
    table(&mut out, &draping(&results.draping));
    out.push_str("</body></html>\n");
    Ok(out)
}

fn paragraph(out: &mut String, text: &str) {
    // Writing to a string cannot fail.
    let _ = write!(out, "<p>{}</p>", escape(text));
}

fn head(names: &[&str]) -> Vec<String> {
    names.iter().map(|n| (*n).to_owned()).collect()
}

fn megabytes(bytes: Option<f64>) -> String {
    bytes.map_or("unknown".into(), |b| format!("{:.0}", b / 1e6))
}

fn percent(part: f64, whole: f64) -> String {
    format!("{:.0} %", 100.0 * part / whole)
}

fn steps(rows: &[Row]) -> Table {
    Table {
        caption: "Per step of the hanging sheet. Factorisations, solves: their numbers times what one takes alone, parts of the step; the rest is \
                  assembly, gradients and vectors. The energy error is relative to the potential energy released, the memory is that of the \
                  Cholesky factor and the peak of the process."
            .into(),
        head: head(&[
            "mesh", "V/F", "set-up, s", "step, s", "iterations", "factorisations", "factorising", "solving", "rest", "strain", "energy error",
            "factor, MB", "peak, MB",
        ]),
        rows: rows
            .iter()
            .map(|r| {
                let [factor, solve] = r.linear();
                vec![
                    format!("M^{}", r.level),
                    format!("{}/{}", r.vertices, r.faces),
                    format!("{:.3}", r.setup),
                    format!("{:.2e}", r.per_step),
                    format!("{:.1}", r.iterations),
                    format!("{:.1}", r.factorisations),
                    percent(factor, r.per_step),
                    percent(solve, r.per_step),
                    percent(r.per_step - factor - solve, r.per_step),
                    format!("{:.0e}", r.strain),
                    format!("{:.0e}", r.balance),
                    format!("{:.1}", factor_bytes(r.best()) / 1e6),
                    megabytes(r.peak),
                ]
            })
            .collect(),
    }
}

fn orders(rows: &[Row]) -> Table {
    Table {
        caption: "Elimination orders of the matrix of a step.".into(),
        head: head(&[
            "mesh",
            "order",
            "found in, ms",
            "symbolic, ms",
            "numeric, ms",
            "on two threads, ms",
            "solve, ms",
            "entries of L",
            "stored",
            "operations",
        ]),
        rows: rows
            .iter()
            .flat_map(|r| {
                r.orders.iter().map(|o| {
                    vec![
                        format!("M^{}", r.level),
                        name(o).into(),
                        format!("{:.2}", 1e3 * o.order),
                        format!("{:.2}", 1e3 * o.symbolic),
                        format!("{:.2}", 1e3 * o.numeric),
                        format!("{:.2}", 1e3 * o.two_threads),
                        format!("{:.2}", 1e3 * o.solve),
                        format!("{:.3e}", o.fill.entries),
                        format!("{:.3e}", o.stored as f64),
                        format!("{:.3e}", o.fill.operations),
                    ]
                })
            })
            .collect(),
    }
}

fn draping(rows: &[DrapeRow]) -> Table {
    Table {
        caption: "Per step of the draping sheet. Detection: pairs within reach and the safe part of every motion; distances: distances, normals \
                  and weights of the pairs. Couplings: pairs of vertices that contact adds to the pattern of the matrix."
            .into(),
        head: head(&[
            "mesh", "V", "steps", "step, s", "iterations", "factorisations", "rejected", "detection", "distances", "contacts", "couplings",
            "strain", "gap, µm", "peak, MB", "remark",
        ]),
        rows: rows
            .iter()
            .map(|r| {
                vec![
                    format!("M^{}", r.level),
                    r.vertices.to_string(),
                    r.steps.to_string(),
                    format!("{:.2e}", r.per_step),
                    format!("{:.1}", r.iterations),
                    format!("{:.1}", r.factorisations),
                    r.rejected.to_string(),
                    percent(r.detection, r.per_step),
                    percent(r.evaluation, r.per_step),
                    r.contacts.to_string(),
                    r.couplings.to_string(),
                    format!("{:.0e}", r.strain),
                    format!("{:.1}", 1e6 * r.gap),
                    megabytes(r.peak),
                    r.stopped.clone().unwrap_or_default(),
                ]
            })
            .collect(),
    }
}

fn name(o: &OrderRow) -> &'static str {
    use isosheet_coords::linalg::Ordering;
    match o.ordering {
        Ordering::MinimumDegree => "minimum degree",
        Ordering::NestedDissection => "nested dissection",
        Ordering::Best => "best",
    }
}

pub(super) fn factor_bytes(o: &OrderRow) -> f64 {
    8.0 * o.stored as f64
}

/// Points of a plot.
pub(super) fn points<R>(rows: &[R], point: impl Fn(&R) -> [f64; 2]) -> Vec<[f64; 2]> {
    rows.iter().map(point).collect()
}

/// The fitted power of V, for people.
fn power(points: &[[f64; 2]]) -> String {
    exponent(points).map_or("?".into(), |p| format!("{p:.2}"))
}

/// What the measurements say.
fn conclusion(rows: &[Row]) -> String {
    let power = |value: fn(&Row) -> f64| power(&points(rows, |r| [r.vertices as f64, value(r)]));
    let mut out = format!(
        "Fitted powers of V: time per step {}, factorisations per step {}, one numeric factorisation {}, its operations {}, \
         entries of the factor {}.",
        power(|r| r.per_step),
        power(|r| r.factorisations),
        power(|r| r.best().numeric),
        power(|r| r.best().fill.operations),
        power(|r| r.best().fill.entries),
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
    let _ = write!(out, " {}", goals(rows));
    out
}

/// Largest power of V that the time of a step without contact is to grow with.
const POWER: f64 = 1.5;

/// Memory for the sheet of 66 049 vertices, bytes: 8 GiB.
const MEMORY: (u32, f64) = (7, 8.0 * 1024.0 * 1024.0 * 1024.0);

/// Largest relative deviation of the entries of the factor from `a V log V + b V`. (Entries that grow as
/// `V^1.5` deviate by 60 % over three decades.)
const STRAIGHT: f64 = 0.15;

/// `a`, `b` of `a V log2 V + b V` entries of the factor, with the least squares of relative deviations, and
/// the largest of these. (Plain powers mislead: the term linear in V is negative, and makes what grows as V
/// log V look faster.)
fn logarithmic(rows: &[Row]) -> Option<[f64; 3]> {
    let points: Vec<[f64; 2]> = points(rows, |r| {
        let v = r.vertices as f64;
        [v.log2(), r.best().stored as f64 / v]
    });
    if points.len() < 4 {
        return None;
    }
    // Weights 1 / y^2 make the deviations relative.
    let sum = |f: fn(f64, f64) -> f64| points.iter().map(|[x, y]| f(*x, *y) / (y * y)).sum::<f64>();
    let (w, wx, wy) = (sum(|_, _| 1.0), sum(|x, _| x), sum(|_, y| y));
    let (wxx, wxy) = (sum(|x, _| x * x), sum(|x, y| x * y));
    let a = (w * wxy - wx * wy) / (w * wxx - wx * wx);
    let b = (wy - a * wx) / w;
    let deviation = points
        .iter()
        .map(|[x, y]| ((a * x + b) / y - 1.0).abs())
        .fold(0.0, f64::max);
    Some([a, b, deviation])
}

/// Whether the goals are reached: time per step, memory of the factor, memory of the process.
fn goals(rows: &[Row]) -> String {
    let verdict = |met: bool| if met { "met" } else { "missed" };
    let of_v = exponent(&points(rows, |r| [r.vertices as f64, r.per_step]));
    let mut parts = Vec::new();
    if let Some(p) = of_v {
        parts.push(format!(
            "a step takes at most V^{POWER}: {}",
            verdict(p <= POWER)
        ));
    }
    if let Some([slope, offset, deviation]) = logarithmic(rows) {
        parts.push(format!(
            "the factor takes V log V: {} ({slope:.0} V log2 V {} {:.0} V entries, padding included, to within {:.0} %)",
            verdict(deviation <= STRAIGHT),
            if offset < 0.0 { "−" } else { "+" },
            offset.abs(),
            100.0 * deviation
        ));
    }
    let (level, memory) = MEMORY;
    if let Some(peak) = rows.iter().find(|r| r.level == level).and_then(|r| r.peak) {
        parts.push(format!(
            "M^{level} takes less than 8 GiB: {}",
            verdict(peak < memory)
        ));
    }
    format!("Goals: {}.", parts.join("; "))
}

/// What two threads in one factorisation do.
fn threads(rows: &[Row]) -> String {
    let all: Vec<&OrderRow> = rows.iter().flat_map(|r| &r.orders).collect();
    let faster: Vec<String> = rows
        .iter()
        .filter(|r| r.best().two_threads < PAYS * r.best().numeric)
        .map(|r| format!("M^{}", r.level))
        .collect();
    let ratios = rows
        .iter()
        .map(|r| r.best().two_threads / r.best().numeric)
        .fold([f64::INFINITY, 0.0_f64], |[l, h], r| [l.min(r), h.max(r)]);
    format!(
        "Two threads within one factorisation take {:.1} to {:.1} times as long as one, and {}; they {}. On a machine without two idle cores they \
         can only lose. The simulations use one.",
        ratios[0],
        ratios[1],
        if faster.is_empty() {
            "pay at no size".to_owned()
        } else {
            format!("pay on {}", faster.join(", "))
        },
        if all.iter().all(|o| o.same_bits) {
            "give the same bits in every factor"
        } else {
            "do not give the same bits in every factor"
        }
    )
}

/// Two threads pay where they save a tenth.
const PAYS: f64 = 0.9;

fn draping_conclusion(results: &Results) -> String {
    let rows = &results.draping;
    let power =
        |value: fn(&DrapeRow) -> f64| power(&points(rows, |r| [r.vertices as f64, value(r)]));
    let mut out = format!(
        "Fitted powers of V with contact: time per step {}, factorisations per step {}, detection {}, distances of contacts {}.",
        power(|r| r.per_step),
        power(|r| r.factorisations),
        power(|r| r.detection),
        power(|r| r.evaluation),
    );
    let shares = rows
        .iter()
        .map(|r| r.detection / r.per_step)
        .fold([f64::INFINITY, 0.0_f64], |[l, h], s| [l.min(s), h.max(s)]);
    let couplings = rows.iter().map(|r| r.couplings).max().unwrap_or(0);
    let _ = write!(
        out,
        " Detection takes {:.0} to {:.0} % of a step. ",
        100.0 * shares[0],
        100.0 * shares[1]
    );
    out.push_str(&if couplings == 0 {
        "Contact adds no couplings here: with a body it has none but those of the mesh, and the layers do not touch; the factor is the one of \
         the hanging sheet."
            .to_owned()
    } else {
        format!("Contact adds up to {couplings} couplings, which the factor has to be analysed and filled for.")
    });
    for r in rows.iter().filter(|r| r.stopped.is_some()) {
        let _ = write!(
            out,
            " M^{}: {} steps only ({}).",
            r.level,
            r.steps,
            r.stopped.as_deref().unwrap_or("")
        );
    }
    out
}

/// The results for people.
pub(super) fn text(results: &Results) -> String {
    let mut out = String::from(
        "mesh  vertices   step, s  iterations  factorisations  factor, MB  peak, MB\n",
    );
    for r in &results.hanging {
        let _ = writeln!(
            out,
            "M^{:<3} {:>8} {:>9.2e} {:>11.1} {:>15.1} {:>11.1} {:>9}",
            r.level,
            r.vertices,
            r.per_step,
            r.iterations,
            r.factorisations,
            factor_bytes(r.best()) / 1e6,
            megabytes(r.peak)
        );
    }
    let _ = writeln!(
        out,
        "{}\n{}\nwith contact:   step, s  factorisations  detection    distances  contacts  peak, MB",
        conclusion(&results.hanging),
        threads(&results.hanging)
    );
    for r in &results.draping {
        let _ = writeln!(
            out,
            "M^{:<3} {:>8} {:>9.2e} {:>15.1} {:>10} {:>12} {:>9} {:>9}",
            r.level,
            r.vertices,
            r.per_step,
            r.factorisations,
            percent(r.detection, r.per_step),
            percent(r.evaluation, r.per_step),
            r.contacts,
            megabytes(r.peak)
        );
    }
    let _ = writeln!(out, "{}", draping_conclusion(results));
    out
}

fn csv(rows: &[Row]) -> String {
    let mut out = String::from(
        "level,vertices,faces,step_size_s,steps,setup_s,step_s,iterations,factorisations,strain,energy_error,peak_bytes,\
         ordering,order_s,symbolic_s,numeric_s,two_threads_s,same_bits,solve_s,factor_entries,factor_stored,factor_operations\n",
    );
    for r in rows {
        for o in &r.orders {
            let peak = r.peak.map_or(String::new(), |p| format!("{p:.0}"));
            let _ = writeln!(
                out,
                "{},{},{},{STEP},{},{:e},{:e},{},{},{:e},{:e},{peak},{},{:e},{:e},{:e},{:e},{},{:e},{},{},{}",
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
                o.two_threads,
                o.same_bits,
                o.solve,
                o.fill.entries,
                o.stored,
                o.fill.operations
            );
        }
    }
    out
}

fn draping_csv(rows: &[DrapeRow]) -> String {
    let mut out = String::from(
        "level,vertices,step_size_s,steps,step_s,detection_s,distances_s,iterations,factorisations,rejected,contacts,couplings,strain,gap_m,\
         peak_bytes,stopped\n",
    );
    for r in rows {
        let peak = r.peak.map_or(String::new(), |p| format!("{p:.0}"));
        let _ = writeln!(
            out,
            "{},{},{STEP},{},{:e},{:e},{:e},{},{},{},{},{},{:e},{:e},{peak},\"{}\"",
            r.level,
            r.vertices,
            r.steps,
            r.per_step,
            r.detection,
            r.evaluation,
            r.iterations,
            r.factorisations,
            r.rejected,
            r.contacts,
            r.couplings,
            r.strain,
            r.gap,
            r.stopped.as_deref().unwrap_or("").replace('"', "'")
        );
    }
    out
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_page_is_whole() {
        let results = Results {
            hanging: [0, 1]
                .map(|level| super::super::measure(level, 2).expect("small sheets move"))
                .to_vec(),
            draping: [0, 1]
                .map(|level| drape::measure(level, 2, 10.0).expect("small cloths move"))
                .to_vec(),
        };
        let page = page(&results).expect("drawn");
        for part in [
            "<svg",
            "nested dissection",
            "With contact",
            "give the same bits",
        ] {
            assert!(page.contains(part), "{part}");
        }
        assert!(!page.contains("NaN"));
        let files = files(&results).expect("drawn");
        for (k, rows) in [(2, 4), (3, 2)] {
            let csv = &files[k].1;
            let lines: Vec<&[u8]> = csv.split(|b| *b == b'\n').collect();
            assert_eq!(lines.len(), 1 + rows + 1, "{}", files[k].0);
            let fields = |l: &[u8]| l.split(|b| *b == b',').count();
            assert!(
                lines[1..=rows]
                    .iter()
                    .all(|l| fields(l) == fields(lines[0]))
            );
        }
        assert!(text(&results).contains("M^1"));
    }

    #[test]
    fn growth_as_v_log_v_is_told_from_powers() {
        let rows = |entries: fn(f64) -> f64| {
            let row = super::super::measure(1, 1).expect("a small sheet moves");
            let of = |level: i32| {
                let mut row = row.clone();
                row.vertices = (2_usize.pow(level as u32 + 1) + 1).pow(2);
                for o in &mut row.orders {
                    o.stored = entries(row.vertices as f64) as usize;
                }
                row
            };
            (2..=7).map(of).collect::<Vec<_>>()
        };
        let [a, b, deviation] = logarithmic(&rows(|v| 20.0 * v * v.log2() - 50.0 * v)).unwrap();
        assert!((a - 20.0).abs() < 0.01 && (b + 50.0).abs() < 0.1 && deviation < 1e-3);
        for power in [|v: f64| 8.0 * v.powf(1.3), |v: f64| v.powf(1.5)] {
            let [.., deviation] = logarithmic(&rows(power)).unwrap();
            assert!(deviation > STRAIGHT, "{deviation}");
        }
    }

    #[test]
    fn words_follow_the_numbers() {
        let mut row = super::super::measure(1, 1).expect("a small sheet moves");
        for o in &mut row.orders {
            o.two_threads = 2.0 * o.numeric;
        }
        let rows = [row];
        assert!(threads(&rows).contains(
            "2.0 to 2.0 times as long as one, and pay at no size; they give the same bits"
        ));
        let [mut row] = rows;
        for o in &mut row.orders {
            (o.two_threads, o.same_bits) = (0.5 * o.numeric, false);
        }
        assert!(threads(&[row]).contains("pay on M^1; they do not give the same bits"));
    }
}
