//! Where a motion in a chart is, as a value.

use super::stepping::PhaseState;
use isosheet_dynamics::CheckpointError;
use isosheet_dynamics::Memories;
use isosheet_dynamics::engine::Balance;
use nalgebra::Vector3;
use serde::{Deserialize, Serialize};

/// Smallest and largest step of a run: the column "Step size min/max" of Fig. 10.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct StepRange {
    /// Smallest, seconds.
    pub min: f64,
    /// Largest, seconds.
    pub max: f64,
    /// Number of steps.
    pub steps: u64,
}

/// Where a motion in a chart is: all that the next step depends on besides model, contact and options.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub(crate) struct ChartState {
    /// Time, seconds.
    pub(super) t: f64,
    pub(super) state: PhaseState,
    /// Energy after velocity damping, joules.
    pub(super) hamiltonian: f64,
    /// Planned length of the next step, seconds.
    pub(super) next_step: f64,
    /// Smallest and largest step so far; none before the first.
    pub(super) range: Option<StepRange>,
    /// Steps since the condition number was estimated.
    pub(super) since_check: u32,
    /// Growth of the largest eigenvalue of C since the reference state.
    pub(super) growth: f64,
    /// Whether the present state is the chart's reference state.
    pub(super) is_fresh: bool,
    /// Positions at which the chart was rebased last; none if it is as its user built it.
    pub(super) reference: Option<Vec<f64>>,
    /// Largest eigenvalue of C at the reference state, and the vector of the power iteration.
    pub(super) eigenvalue: f64,
    pub(super) eigenvector: Vec<f64>,
    /// Positions of the fixed pins that the chart does not eliminate.
    pub(super) pins: Vec<Vector3<f64>>,
    /// Forces of the supports now, in scenes where they move.
    pub(super) balance: Option<Balance>,
    /// What the potentials remember.
    pub(super) memories: Memories,
}

impl ChartState {
    /// Refuses numbers that are not finite, which a checkpoint that was changed from outside may have.
    pub(crate) fn check_numbers(&self) -> Result<(), CheckpointError> {
        let check =
            |what, values: &[f64]| CheckpointError::check_numbers(what, values, values.len());
        check("times", &[self.t])?;
        check("positions", &self.state.x)?;
        check("coordinates", &self.state.q)?;
        check("momenta", &self.state.p)?;
        for memory in self.memories.lists() {
            check("memories of potentials", memory)?;
        }
        let reference = self.reference.as_deref().unwrap_or_default();
        check("reference positions", reference)
    }

    /// The motion at time `t` before its first step, with the chart as its user built it.
    pub(super) fn start(
        t: f64,
        state: PhaseState,
        next_step: f64,
        pins: Vec<Vector3<f64>>,
    ) -> Self {
        Self {
            t,
            hamiltonian: state.hamiltonian,
            state,
            next_step,
            range: None,
            since_check: 0,
            growth: 1.0,
            is_fresh: true,
            reference: None,
            eigenvector: Vec::new(),
            eigenvalue: 0.0,
            pins,
            balance: None,
            memories: Memories::default(),
        }
    }
}
