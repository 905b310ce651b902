//! Tables of the scaling study, for people and for programs.

use super::drape::DrapeRow;
use super::measure::{Row, STEP};
use crate::report::{Cell, Table};
use crate::timing::OrderRow;

fn megabytes(bytes: Option<f64>) -> Cell {
    bytes
        .map_or("unknown".into(), |b| format!("{:.0}", b / 1e6))
        .into()
}

fn percent(part: f64, whole: f64) -> Cell {
    format!("{:.0} %", 100.0 * part / whole).into()
}

fn milliseconds(seconds: f64) -> Cell {
    format!("{:.2}", 1e3 * seconds).into()
}

fn tenths(value: f64) -> Cell {
    format!("{value:.1}").into()
}

fn power(value: f64) -> Cell {
    format!("{value:.0e}").into()
}

pub(super) fn steps(rows: &[Row]) -> Table {
    Table::of(
        "Per step of the hanging sheet. Factorisations, solves: their numbers times what one takes alone, parts of the step; the rest is \
         assembly, gradients and vectors. The energy error is relative to the potential energy released, the memory is that of the \
         Cholesky factor and the peak of the process.",
        rows,
        &[
            ("mesh", &|r| format!("M^{}", r.level).into()),
            ("V/F", &|r| format!("{}/{}", r.vertices, r.faces).into()),
            ("set-up, s", &|r| format!("{:.3}", r.setup).into()),
            ("step, s", &|r| format!("{:.2e}", r.per_step).into()),
            ("iterations", &|r| tenths(r.iterations)),
            ("factorisations", &|r| tenths(r.factorisations)),
            ("factorising", &|r| percent(r.linear()[0], r.per_step)),
            ("solving", &|r| percent(r.linear()[1], r.per_step)),
            ("rest", &|r| {
                percent(r.per_step - r.linear()[0] - r.linear()[1], r.per_step)
            }),
            ("strain", &|r| power(r.strain)),
            ("energy error", &|r| power(r.balance)),
            ("factor, MB", &|r| tenths(factor_bytes(r.best()) / 1e6)),
            ("peak, MB", &|r| megabytes(r.peak)),
        ],
    )
}

/// Every order of every mesh.
fn all_orders(rows: &[Row]) -> impl Iterator<Item = (&Row, &OrderRow)> {
    rows.iter()
        .flat_map(|r| r.orders.iter().map(move |o| (r, o)))
}

pub(super) fn orders(rows: &[Row]) -> Table {
    Table::of(
        "Elimination orders of the matrix of a step.",
        all_orders(rows),
        &[
            ("mesh", &|(r, _)| format!("M^{}", r.level).into()),
            ("order", &|(_, o)| name(o).into()),
            ("found in, ms", &|(_, o)| milliseconds(o.order)),
            ("symbolic, ms", &|(_, o)| milliseconds(o.symbolic)),
            ("numeric, ms", &|(_, o)| milliseconds(o.numeric)),
            ("on two threads, ms", &|(_, o)| milliseconds(o.two_threads)),
            ("solve, ms", &|(_, o)| milliseconds(o.solve)),
            ("entries of L", &|(_, o)| {
                format!("{:.3e}", o.fill.entries).into()
            }),
            ("stored", &|(_, o)| {
                format!("{:.3e}", o.stored as f64).into()
            }),
            ("operations", &|(_, o)| {
                format!("{:.3e}", o.fill.operations).into()
            }),
        ],
    )
}

pub(super) fn draping(rows: &[DrapeRow]) -> Table {
    Table::of(
        "Per step of the draping sheet. Detection: pairs within reach and the safe part of every motion; distances: distances, normals \
         and weights of the pairs. Couplings: pairs of vertices that contact adds to the pattern of the matrix.",
        rows,
        &[
            ("mesh", &|r| format!("M^{}", r.level).into()),
            ("V", &|r| r.vertices.into()),
            ("steps", &|r| r.cost.steps.into()),
            ("step, s", &|r| format!("{:.2e}", r.step()).into()),
            ("iterations", &|r| tenths(r.iterations())),
            ("factorisations", &|r| tenths(r.factorisations())),
            ("rejected", &|r| r.cost.rejected.into()),
            ("detection", &|r| percent(r.detection(), r.step())),
            ("distances", &|r| percent(r.evaluation(), r.step())),
            ("contacts", &|r| r.contacts.into()),
            ("couplings", &|r| r.couplings.into()),
            ("strain", &|r| power(r.strain)),
            ("gap, µm", &|r| tenths(1e6 * r.gap)),
            ("peak, MB", &|r| megabytes(r.peak)),
            ("remark", &|r| r.stopped.clone().unwrap_or_default().into()),
        ],
    )
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

/// The hanging sheet, for programs.
pub(super) fn steps_data(rows: &[Row]) -> Table {
    Table::of(
        "",
        all_orders(rows),
        &[
            ("level", &|(r, _)| r.level.into()),
            ("vertices", &|(r, _)| r.vertices.into()),
            ("faces", &|(r, _)| r.faces.into()),
            ("step_size_s", &|_| STEP.into()),
            ("steps", &|(r, _)| r.steps.into()),
            ("setup_s", &|(r, _)| r.setup.into()),
            ("step_s", &|(r, _)| r.per_step.into()),
            ("iterations", &|(r, _)| r.iterations.into()),
            ("factorisations", &|(r, _)| r.factorisations.into()),
            ("strain", &|(r, _)| r.strain.into()),
            ("energy_error", &|(r, _)| r.balance.into()),
            ("peak_bytes", &|(r, _)| r.peak.into()),
            ("ordering", &|(_, o)| name(o).replace(' ', "_").into()),
            ("order_s", &|(_, o)| o.order.into()),
            ("symbolic_s", &|(_, o)| o.symbolic.into()),
            ("numeric_s", &|(_, o)| o.numeric.into()),
            ("two_threads_s", &|(_, o)| o.two_threads.into()),
            ("same_bits", &|(_, o)| o.same_bits.to_string().into()),
            ("solve_s", &|(_, o)| o.solve.into()),
            ("factor_entries", &|(_, o)| o.fill.entries.into()),
            ("factor_stored", &|(_, o)| o.stored.into()),
            ("factor_operations", &|(_, o)| o.fill.operations.into()),
        ],
    )
}

/// The draping sheet, for programs.
pub(super) fn draping_data(rows: &[DrapeRow]) -> Table {
    Table::of(
        "",
        rows,
        &[
            ("level", &|r| r.level.into()),
            ("vertices", &|r| r.vertices.into()),
            ("step_size_s", &|_| STEP.into()),
            ("steps", &|r| r.cost.steps.into()),
            ("step_s", &|r| r.step().into()),
            ("detection_s", &|r| r.detection().into()),
            ("distances_s", &|r| r.evaluation().into()),
            ("iterations", &|r| r.iterations().into()),
            ("factorisations", &|r| r.factorisations().into()),
            ("rejected", &|r| r.cost.rejected.into()),
            ("contacts", &|r| r.contacts.into()),
            ("couplings", &|r| r.couplings.into()),
            ("strain", &|r| r.strain.into()),
            ("gap_m", &|r| r.gap.into()),
            ("peak_bytes", &|r| r.peak.into()),
            ("stopped", &|r| r.stopped.clone().into()),
        ],
    )
}
