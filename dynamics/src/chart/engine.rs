//! A simulation in a chart as an engine of [`Simulation`](crate::Simulation).

use super::{ChartDynamicsError, ChartOptions, ChartSimulation, ChartState};
use crate::contact::Contact;
use crate::report::checkpoint_error::{CheckpointError, check_finite, check_length};
use crate::report::simulation_error::SimulationError;
use crate::report::step_error::{StepError, StepOutcome, StepTotals};
use crate::step::reaction::{Reaction, supports};
use crate::{SheetModel, State};
use isosheet_coords::Chart;
use nalgebra::Vector3;
use serde::{Deserialize, Serialize};

/// State of a simulation in a chart.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub(crate) struct InChart {
    pub(crate) options: ChartOptions,
    pub(crate) motion: ChartState,
    /// Velocities of the vertices, `3V`, metres per second.
    pub(crate) velocities: Vec<f64>,
    /// Forces of the supports, newtons; empty before the first step.
    pub(crate) reactions: Vec<Vector3<f64>>,
    pub(crate) has_contact: bool,
    /// Mean contact forces of the last step, `3V`, newtons; empty before the first and without contact.
    pub(crate) contact_forces: Vec<f64>,
}

/// Sub-steps shorter than this fraction of the time reached are round-off, not time.
const TIME_ROUND_OFF: f64 = 4.0 * f64::EPSILON;

/// A sheet that moves in a chart, with its state in space.
pub(crate) struct ChartEngine {
    pub(crate) simulation: ChartSimulation,
    pub(crate) state: State,
    /// Forces of the supports at the end of the last step.
    pub(crate) reactions: Vec<Reaction>,
    /// Mean forces of contact over the last step, `3V`, newtons; empty before the first.
    contact_forces: Vec<f64>,
}

impl ChartEngine {
    pub(crate) fn new(simulation: ChartSimulation, state: State) -> Self {
        Self {
            simulation,
            state,
            reactions: Vec::new(),
            contact_forces: Vec::new(),
        }
    }

    /// Mean forces of contact over the last step, `3V`, newtons; `None` in scenes without contact.
    pub(crate) fn contact_forces(&self) -> Option<Vec<f64>> {
        self.simulation.contacts()?;
        let mut forces = self.contact_forces.clone();
        forces.resize(self.state.x.len(), 0.0);
        Some(forces)
    }

    /// What a checkpoint keeps.
    pub(crate) fn motion(&self) -> InChart {
        InChart {
            options: *self.simulation.options(),
            motion: self.simulation.motion(),
            velocities: self.state.v.clone(),
            reactions: self.reactions.iter().map(|r| r.force).collect(),
            has_contact: self.simulation.contacts().is_some(),
            contact_forces: self.contact_forces.clone(),
        }
    }

    /// Goes on from a checkpoint.
    pub(crate) fn resume(
        model: SheetModel,
        chart: Box<dyn Chart>,
        contact: Option<Box<dyn Contact>>,
        kept: InChart,
    ) -> Result<Self, SimulationError> {
        if kept.has_contact != contact.is_some() {
            let expected = kept.has_contact;
            return Err(CheckpointError::Contact { expected }.into());
        }
        let expected = model.coordinate_count();
        check_length("velocities", kept.velocities.len(), expected)?;
        check_finite("velocities", &kept.velocities)?;
        let found = kept.contact_forces.len();
        if found > 0 {
            check_length("forces of contact", found, expected)?;
            check_finite("forces of contact", &kept.contact_forces)?;
        }
        kept.motion.check_numbers()?;
        let mut simulation = ChartSimulation::resume(model, chart, kept.options, kept.motion)?;
        if let Some(contact) = contact {
            simulation.set_contact(contact)?;
        }
        let state = State {
            t: simulation.time(),
            x: simulation.positions().to_vec(),
            v: kept.velocities,
        };
        Ok(Self {
            reactions: supports(simulation.mechanics().model())
                .zip(kept.reactions)
                .map(|(support, force)| Reaction { support, force })
                .collect(),
            contact_forces: kept.contact_forces,
            simulation,
            state,
        })
    }

    /// Advances to the time `end`.
    pub(crate) fn advance(
        &mut self,
        end: f64,
        totals: &mut StepTotals<'_>,
    ) -> Result<(), StepError> {
        let (chart, state) = (&mut self.simulation, &mut self.state);
        let start = state.t;
        self.contact_forces.clear();
        if chart.contacts().is_some() {
            self.contact_forces.resize(state.x.len(), 0.0);
        }
        totals.outcome = StepOutcome::Chart;
        let failed = |t: f64, source: ChartDynamicsError| StepError::Chart {
            t,
            source: Box::new(source),
        };
        let has_forces = chart.mechanics().model().has_applied_forces();
        let mut applied = vec![0.0; if has_forces { state.x.len() } else { 0 }];
        let limit = chart.options().max_steps;
        let outcome = loop {
            let left = end - chart.time();
            if left <= TIME_ROUND_OFF * end.abs() {
                break Ok(());
            }
            totals.effort.t = chart.time();
            if !totals.effort.goes_on() {
                break Err(StepError::Interrupted { t: chart.time() });
            }
            if totals.substeps + totals.rejected >= limit {
                let t = chart.time();
                break Err(failed(t, ChartDynamicsError::TooManySteps { t, limit }));
            }
            if has_forces {
                let v = match chart.velocities() {
                    Ok(v) => v,
                    Err(error) => break Err(failed(chart.time(), error)),
                };
                let model = chart.mechanics().model();
                model.applied_force(chart.time(), chart.positions(), &v, &mut applied);
                state.x.copy_from_slice(chart.positions());
            }
            let report = match chart.step_within(left) {
                Ok(report) => report,
                Err(error) => break Err(failed(chart.time(), error)),
            };
            for contact in chart.impulses() {
                contact.add_to(&mut self.contact_forces);
            }
            totals.substeps += 1;
            totals.rejected += report.rejected as usize;
            totals.work += report.driven;
            totals.dissipated += report.damped;
            totals.friction += report.impact;
            totals.outcome = totals.outcome.max(if report.rebased {
                StepOutcome::Rebased
            } else {
                StepOutcome::Chart
            });
            if has_forces {
                totals.work += applied
                    .iter()
                    .zip(chart.positions().iter().zip(&state.x))
                    .map(|(f, (new, old))| f * (new - old))
                    .sum::<f64>();
            }
        };
        state.t = if outcome.is_ok() { end } else { chart.time() };
        // Impulses so far; nothing has moved if no time has passed.
        let span = state.t - start;
        if span > 0.0 {
            self.contact_forces.iter_mut().for_each(|f| *f /= span);
        }
        state.x.copy_from_slice(chart.positions());
        state.v = chart.velocities().map_err(|e| failed(state.t, e))?;
        if chart.mechanics().model().has_supports() {
            self.reactions = chart.reactions().map_err(|e| failed(state.t, e))?;
        }
        outcome
    }
}
