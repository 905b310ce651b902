//! Tables of the scaling study, for people and as CSV.

use super::DrapeRow;
use super::measure::{OrderRow, Row, STEP};
use crate::figures::Table;
use std::fmt::Write;

pub(super) fn head(names: &[&str]) -> Vec<String> {
    names.iter().map(|n| (*n).to_owned()).collect()
}

pub(super) fn megabytes(bytes: Option<f64>) -> String {
    bytes.map_or("unknown".into(), |b| format!("{:.0}", b / 1e6))
}

pub(super) fn percent(part: f64, whole: f64) -> String {
    format!("{:.0} %", 100.0 * part / whole)
}

pub(super) fn steps(rows: &[Row]) -> Table {
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

pub(super) fn orders(rows: &[Row]) -> Table {
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

pub(super) fn draping(rows: &[DrapeRow]) -> Table {
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

pub(super) fn name(o: &OrderRow) -> &'static str {
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

pub(super) fn csv(rows: &[Row]) -> String {
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

pub(super) fn draping_csv(rows: &[DrapeRow]) -> String {
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
