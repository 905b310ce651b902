//! The end of a run.

use super::row::dissipated;
use super::row::row_of_start;
use super::summary::{EndReason, Ending};
use super::writer::{RunWriter, largest_speed};
use isosheet_dynamics::StepReport;
use isosheet_scenes::{CarriedBody, Residuals, UnderWay};

impl RunWriter {
    /// The state at the end of a step, which ends a run for a reason.
    pub(super) fn ending(
        &self,
        under_way: &UnderWay,
        reason: EndReason,
        report: &StepReport,
    ) -> Ending {
        Ending {
            t: report.t,
            kinetic: report.kinetic,
            potential: report.potential,
            plastic: dissipated(under_way.simulation.model(), report.plastic),
            energy_drift: report.energy_drift,
            lowest_frequency: report.lowest_frequency,
            taut: report.taut.as_ref().map(|demand| {
                let origins = &under_way.facts.origins;
                demand.named(|body| format!("`{}`", origins.obstacle_called(body)))
            }),
            ..self.ending_at_start(under_way, reason)
        }
    }

    /// The present state, which ends a run without a step for a reason.
    pub(super) fn ending_at_start(&self, under_way: &UnderWay, reason: EndReason) -> Ending {
        let row = row_of_start(&under_way.simulation);
        let loads = under_way.facts.obstacle_loads(&under_way.simulation);
        Ending {
            reason,
            t: row.t,
            kinetic: row.kinetic,
            potential: row.potential,
            plastic: row.plastic,
            energy_drift: 0.0,
            largest_speed: largest_speed(under_way),
            supports: under_way.support_forces(),
            obstacles: loads.iter().map(|load| load.force).collect(),
            bodies: CarriedBody::contact_loads(&under_way.facts.bodies, &under_way.simulation)
                .iter()
                .map(|load| load.force)
                .collect(),
            lowest_frequency: None,
            taut: None,
            failed: None,
            kept: self.progress.kept.of_yielded(),
            residuals: self.residuals(under_way),
        }
    }

    /// How far the sheets are from what the scene asks for, creases as they were followed.
    fn residuals(&self, under_way: &UnderWay) -> Residuals {
        let targets = &under_way.facts.targets;
        let mut residuals = targets.residuals(&under_way.simulation);
        if let (Some(folds), Some(targets)) = (&self.progress.folds, &targets.folding) {
            let topology = under_way.simulation.model().topology();
            let x = &under_way.simulation.state().x;
            residuals.folding = Some(folds.residual(targets, topology, x));
        }
        residuals
    }
}
