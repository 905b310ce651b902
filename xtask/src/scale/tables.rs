//! Tables of the scaling study: all columns for programs, some of them for people.

use super::drape::DrapeRow;
use super::steps::{Row, STEP};
use crate::report::Table;
use crate::timing::OrderRow;

pub(super) fn factor_bytes(o: &OrderRow) -> f64 {
    8.0 * o.stored as f64
}

/// The hanging sheet: a row for every order of elimination of every mesh.
pub(super) fn hanging(rows: &[Row]) -> Table {
    let all = rows
        .iter()
        .flat_map(|r| r.orders.iter().map(move |o| (r, &r.course, o)));
    Table::of(
        "",
        all,
        &[
            ("level", &|(r, ..)| r.level.into()),
            ("vertices", &|(r, ..)| r.vertices.into()),
            ("faces", &|(r, ..)| r.faces.into()),
            ("step_size_s", &|_| STEP.into()),
            ("steps", &|(_, c, _)| c.cost.steps.into()),
            ("setup_s", &|(r, ..)| r.setup.into()),
            ("step_s", &|(r, ..)| r.step().into()),
            ("factorising_s", &|(r, ..)| r.parts()[0].into()),
            ("solving_s", &|(r, ..)| r.parts()[1].into()),
            ("rest_s", &|(r, ..)| r.parts()[2].into()),
            ("iterations", &|(_, c, _)| {
                c.cost.iterations_per_step().into()
            }),
            ("factorisations", &|(r, ..)| r.factorisations().into()),
            ("cpu_s", &|(_, c, _)| c.cost.cpu_per_step().into()),
            ("strain", &|(_, c, _)| c.strain.into()),
            ("energy_error", &|(r, ..)| r.balance.into()),
            ("factor_bytes", &|(r, ..)| factor_bytes(r.best()).into()),
            ("peak_bytes", &|(r, ..)| r.peak.into()),
            ("ordering", &|(.., o)| o.ordering.as_str().into()),
            ("order_s", &|(.., o)| o.order.into()),
            ("symbolic_s", &|(.., o)| o.symbolic.into()),
            ("numeric_s", &|(.., o)| o.numeric.into()),
            ("two_threads_s", &|(.., o)| o.two_threads.into()),
            ("same_bits", &|(.., o)| o.same_bits.to_string().into()),
            ("solve_s", &|(.., o)| o.solve.into()),
            ("factor_entries", &|(.., o)| o.entries.into()),
            ("factor_stored", &|(.., o)| o.stored.into()),
            ("factor_operations", &|(.., o)| o.operations.into()),
        ],
    )
}

/// The steps of [`hanging`].
pub(super) fn steps(rows: &[Row]) -> Table {
    let names = "level vertices faces setup_s step_s iterations factorisations cpu_s factorising_s solving_s rest_s strain \
                 energy_error factor_bytes peak_bytes";
    hanging(rows).select(
        "Per step of the hanging sheet. Factorisations, solves: their numbers times what one takes alone, parts of the step; the rest is \
         assembly, gradients and vectors. The energy error is relative to the potential energy released, the memory is that of the \
         Cholesky factor and the peak of the process.",
        names,
    )
}

/// The orders of elimination of [`hanging`].
pub(super) fn orders(rows: &[Row]) -> Table {
    let names = "level ordering order_s symbolic_s numeric_s two_threads_s solve_s factor_entries factor_stored \
                 factor_operations";
    hanging(rows).select("Elimination orders of the matrix of a step.", names)
}

/// The draping sheet.
pub(super) fn draping(rows: &[DrapeRow]) -> Table {
    Table::of(
        "Per step of the draping sheet. Detection: pairs within reach and the safe part of every motion; distances: distances, normals \
         and weights of the pairs. Couplings: pairs of vertices that contact adds to the pattern of the matrix.",
        rows,
        &[
            ("level", &|r| r.level.into()),
            ("vertices", &|r| r.vertices.into()),
            ("step_size_s", &|_| STEP.into()),
            ("steps", &|r| r.course.cost.steps.into()),
            ("step_s", &|r| r.step().into()),
            ("detection_s", &|r| r.detection().into()),
            ("distances_s", &|r| r.evaluation().into()),
            ("iterations", &|r| {
                r.course.cost.iterations_per_step().into()
            }),
            ("factorisations", &|r| r.factorisations().into()),
            ("cpu_s", &|r| r.course.cost.cpu_per_step().into()),
            ("rejected", &|r| r.course.cost.rejected.into()),
            ("contacts", &|r| r.contacts.into()),
            ("couplings", &|r| r.couplings.into()),
            ("strain", &|r| r.course.strain.into()),
            ("gap_m", &|r| r.course.gap.into()),
            ("peak_bytes", &|r| r.peak.into()),
            ("stopped", &|r| r.course.failure().into()),
        ],
    )
}
