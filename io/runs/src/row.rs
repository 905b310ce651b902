//! The rows of the history of a run.

use isosheet_dynamics::contact::ActiveContacts;
use isosheet_dynamics::{SheetModel, Simulation, StepReport};
use isosheet_formats::HistoryRow;

/// The row of the state that a simulation starts at.
pub fn row_of_start(simulation: &Simulation) -> HistoryRow {
    let state = simulation.state();
    let kinetic = simulation.model().kinetic_energy(&state.v);
    let total = simulation.energy();
    HistoryRow {
        t: state.t,
        kinetic,
        potential: total - kinetic,
        total,
        strain: simulation.model().max_strain(&state.x),
        plastic: dissipated(simulation.model(), 0.0),
        gap: simulation.contacts().and_then(finite_gap),
        ..HistoryRow::default()
    }
}

/// The row of a step of a model in a run that started at an energy, joules.
pub fn row_of_step(report: &StepReport, model: &SheetModel, start_energy: f64) -> HistoryRow {
    let total = report.hamiltonian();
    HistoryRow {
        t: report.t,
        h: report.h,
        substeps: report.substeps,
        iterations: report.iterations,
        factorisations: report.factorisations,
        rejected: report.rejected,
        kinetic: report.kinetic,
        potential: report.potential,
        total,
        drift: total - start_energy,
        work: report.work,
        damped: report.dissipated,
        friction: report.friction,
        plastic: dissipated(model, report.plastic),
        strain: report.strain,
        gap: report.gap.filter(|gap| gap.is_finite()),
    }
}

/// The smallest gap; none if nothing is within reach.
fn finite_gap(contacts: &ActiveContacts) -> Option<f64> {
    Some(contacts.gap()).filter(|gap| gap.is_finite())
}

/// What yielding has dissipated, joules, as it is written: none if nothing can yield.
pub(super) fn dissipated(model: &SheetModel, plastic: f64) -> Option<f64> {
    model.can_yield().then_some(plastic)
}
