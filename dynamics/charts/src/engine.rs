//! A simulation in a chart as an engine of [`Simulation`].

use super::{ChartDynamicsError, ChartOptions, ChartSimulation, ChartState};
use isosheet_coords::Chart;
use isosheet_dynamics::engine::{AcceptedSubstep, Engine, EngineError, Progress, supports};
use isosheet_dynamics::{
    Checkpoint, CheckpointError, Memories, Reaction, SheetModel, Simulation, SimulationError,
    State, StepError, StepOutcome,
};
use nalgebra::Vector3;
use serde::{Deserialize, Serialize};
use std::sync::Arc;

/// The name of the engine in checkpoints.
const NAME: &str = "a chart";

/// The outcome of a step in a chart, [`StepOutcome::Engine`].
pub const IN_CHART: &str = "chart";

/// The outcome of a step in a chart that has changed its reference state, [`StepOutcome::Engine`].
pub const REBASED: &str = "rebased";

/// A simulation of `model` from `state` in system coordinates.
///
/// Velocities are projected onto the motions that keep the lengths. Supports that the chart does not
/// eliminate are closure equations, see [`ChartSimulation::from_state`].
///
/// # Errors
/// [`SimulationError`] if options or state are invalid, or the chart is singular or too ill-conditioned
/// at the state.
pub fn in_chart(
    model: SheetModel,
    state: State,
    chart: Box<dyn Chart>,
    options: ChartOptions,
) -> Result<Simulation, SimulationError> {
    Simulation::with_engine(model, state, |model, mut state| {
        let mut simulation =
            ChartSimulation::from_state(model, chart, options, &state).map_err(EngineError::new)?;
        state.v = simulation.velocities().map_err(EngineError::new)?;
        Ok(Box::new(ChartEngine {
            simulation,
            state,
            reactions: Vec::new(),
        }))
    })
}

/// Resumes a simulation in a chart from a checkpoint bit for bit, with the model and the chart of its start.
///
/// # Errors
/// [`SimulationError::Checkpoint`] if the checkpoint is invalid, or of another model or engine.
pub fn resume_in_chart(
    model: SheetModel,
    chart: Box<dyn Chart>,
    checkpoint: Checkpoint,
) -> Result<Simulation, SimulationError> {
    Simulation::resume_with_engine(model, checkpoint, NAME, |model, bytes| {
        let decode = |e: postcard::Error| CheckpointError::Decode(e.to_string());
        let kept: InChart = postcard::from_bytes(bytes).map_err(decode)?;
        Ok(Box::new(ChartEngine::resume(model, chart, kept)?))
    })
}

/// The motion in a chart of a simulation by [`in_chart`].
pub fn of_simulation(simulation: &Simulation) -> Option<&ChartSimulation> {
    Some(&simulation.engine::<ChartEngine>()?.simulation)
}

/// What a checkpoint keeps.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
struct InChart {
    options: ChartOptions,
    motion: ChartState,
    /// Velocities of the vertices, `3V`, metres per second.
    velocities: Vec<f64>,
    /// Forces of the supports, newtons; empty before the first step.
    reactions: Vec<Vector3<f64>>,
}

/// Sub-steps shorter than this fraction of the time reached are round-off, not time.
const TIME_ROUND_OFF: f64 = 4.0 * f64::EPSILON;

/// A sheet that moves in a chart, with its state in space.
struct ChartEngine {
    simulation: ChartSimulation,
    state: State,
    /// Forces of the supports at the end of the last step.
    reactions: Vec<Reaction>,
}

impl ChartEngine {
    /// Goes on from a checkpoint.
    fn resume(
        model: SheetModel,
        chart: Box<dyn Chart>,
        kept: InChart,
    ) -> Result<Self, SimulationError> {
        CheckpointError::check_numbers("velocities", &kept.velocities, model.coordinate_count())?;
        kept.motion.check_numbers()?;
        let simulation = ChartSimulation::resume(model, chart, kept.options, kept.motion)
            .map_err(EngineError::new)?;
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
            simulation,
            state,
        })
    }
}

impl Engine for ChartEngine {
    fn name(&self) -> &'static str {
        NAME
    }

    fn model(&self) -> &Arc<SheetModel> {
        self.simulation.mechanics().model()
    }

    fn state(&self) -> &State {
        &self.state
    }

    fn memories(&self) -> &Memories {
        self.simulation.memories()
    }

    fn memories_mut(&mut self) -> &mut Memories {
        self.simulation.memories_mut()
    }

    fn reactions(&self) -> Vec<Reaction> {
        self.reactions.clone()
    }

    fn kept(&self) -> Vec<u8> {
        let kept = InChart {
            options: *self.simulation.options(),
            motion: self.simulation.motion(),
            velocities: self.state.v.clone(),
            reactions: self.reactions.iter().map(|r| r.force).collect(),
        };
        postcard::to_stdvec(&kept).expect("numbers and lists can be encoded")
    }

    fn advance(&mut self, end: f64, progress: &mut Progress<'_, '_>) -> Result<(), StepError> {
        let (chart, state) = (&mut self.simulation, &mut self.state);
        let failed = |t: f64, source: ChartDynamicsError| StepError::Engine {
            t,
            source: EngineError::new(source),
        };
        let has_forces = chart.mechanics().model().has_applied_forces();
        let mut applied = vec![0.0; if has_forces { state.x.len() } else { 0 }];
        let limit = chart.options().max_steps;
        let outcome = loop {
            let left = end - chart.time();
            if left <= TIME_ROUND_OFF * end.abs() {
                break Ok(());
            }
            let t = chart.time();
            if !progress.goes_on(t) {
                break Err(StepError::Interrupted { t });
            }
            if progress.count() >= limit {
                break Err(failed(t, ChartDynamicsError::TooManySteps { t, limit }));
            }
            if has_forces {
                let v = match chart.velocities() {
                    Ok(v) => v,
                    Err(error) => break Err(failed(t, error)),
                };
                let model = chart.mechanics().model();
                model.applied_force(t, chart.positions(), &v, &mut applied);
                state.x.copy_from_slice(chart.positions());
            }
            let report = match chart.step_within(left) {
                Ok(report) => report,
                Err(error) => break Err(failed(chart.time(), error)),
            };
            let mut work = report.driven;
            if has_forces {
                work += applied
                    .iter()
                    .zip(chart.positions().iter().zip(&state.x))
                    .map(|(f, (new, old))| f * (new - old))
                    .sum::<f64>();
            }
            progress.accept(AcceptedSubstep {
                rejected: report.rejected as usize,
                outcome: StepOutcome::Engine(match report.rebased {
                    true => REBASED,
                    false => IN_CHART,
                }),
                work,
                dissipated: report.damped,
            });
        };
        state.t = if outcome.is_ok() { end } else { chart.time() };
        state.x.copy_from_slice(chart.positions());
        state.v = chart.velocities().map_err(|e| failed(state.t, e))?;
        if chart.mechanics().model().has_supports() {
            self.reactions = chart.reactions().map_err(|e| failed(state.t, e))?;
        }
        outcome
    }
}
