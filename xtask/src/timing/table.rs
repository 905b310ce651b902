//! One table of runs for all reports.

use super::comparison::Entry;
use super::run::Measured;
use super::scene::{Pairs, Work};
use crate::report::Table;

impl Work {
    /// What moves, and what it touches.
    fn names(self) -> [&'static str; 2] {
        match self {
            Self::Hanging => ["hanging sheet", ""],
            Self::Tablecloth(Pairs::Table) => ["tablecloth", "table"],
            Self::Tablecloth(Pairs::TableAndItself) => ["tablecloth", "table, itself"],
        }
    }
}

/// The columns of [`table`] that a page shows.
pub(crate) const SHOWN: &str = "mesh contact method step_s wall_s_per_simulated_s times_fastest_exact \
    times_one_factorisation_a_step strain energy_balance largest_energy_change smallest_gap_m iterations factorisations \
    cpu_s_per_simulated_s steps rejected failure";

/// Runs; `all` gives the entries that a run is compared with, its own among them.
pub(crate) fn table(
    caption: &str,
    rows: &[&Measured],
    all: &dyn Fn(&Measured) -> Vec<Entry>,
) -> Table {
    let with = |r: &&Measured| {
        let times = r.entry(String::new()).multiples(&all(r));
        ((*r).clone(), r.course.clone(), times)
    };
    Table::of(
        caption,
        rows.iter().map(with),
        &[
            ("scene", &|(r, ..)| r.work.names()[0].into()),
            ("contact", &|(r, ..)| r.work.names()[1].into()),
            ("mesh", &|(r, ..)| r.mesh().into()),
            ("vertices", &|(r, ..)| r.mesh.vertices.into()),
            ("method", &|(r, ..)| r.method.as_str().into()),
            ("start", &|(r, ..)| r.start.into()),
            ("step_s", &|(r, ..)| r.step.into()),
            ("wall_s", &|(_, c, _)| c.cost.wall.into()),
            ("wall_s_per_simulated_s", &|(_, c, _)| c.rate().into()),
            ("times_fastest_exact", &|(.., times)| times[0].into()),
            ("times_one_factorisation_a_step", &|(.., times)| {
                times[1].into()
            }),
            ("strain", &|(_, c, _)| c.strain.into()),
            ("energy_balance", &|(r, ..)| r.balance().into()),
            ("largest_energy_change", &|(r, ..)| {
                r.relative_drift().into()
            }),
            ("smallest_gap_m", &|(_, c, _)| c.gap.into()),
            ("iterations", &|(_, c, _)| c.cost.iterations.into()),
            ("factorisations", &|(_, c, _)| c.cost.factorisations.into()),
            ("cpu_s_per_simulated_s", &|(_, c, _)| c.cpu_rate().into()),
            ("steps", &|(_, c, _)| c.cost.substeps.into()),
            ("rejected", &|(_, c, _)| c.cost.rejected.into()),
            ("iterations_per_step", &|(_, c, _)| {
                c.cost.iterations_per_step().into()
            }),
            ("factorisations_per_step", &|(_, c, _)| {
                c.cost.factorisations_per_step().into()
            }),
            ("wall_s_per_factorisation", &|(_, c, _)| {
                c.cost.wall_per_factorisation().into()
            }),
            ("factorisation_s", &|(r, ..)| r.mesh.factorisation.into()),
            ("reached_s", &|(_, c, _)| c.time.into()),
            ("repetitions", &|(r, ..)| r.repetitions.into()),
            ("failure", &|(_, c, _)| c.failure().into()),
        ],
    )
}
