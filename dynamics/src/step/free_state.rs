//! What a chart-free simulation is between two steps.

use crate::contact::BarrierPotential;
use crate::step::checkpoint_error::{CheckpointError, check_finite};
use crate::step::energy_account::EnergyAccount;
use crate::step::integrator::SolverState;
use crate::{Method, StepControl};
use serde::{Deserialize, Serialize};

/// A chart-free simulation between two steps.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub(crate) struct FreeState {
    pub(crate) method: Method,
    pub(crate) control: StepControl,
    pub(crate) solver: SolverState,
    pub(crate) account: EnergyAccount,
    pub(crate) has_moved: bool,
    /// Vertices that were pinned at the start because they cannot move.
    pub(crate) fixed: Vec<u32>,
    /// The barrier of contact, in scenes that have any.
    pub(crate) barrier: Option<BarrierPotential>,
    /// The stiffness of the barrier at the limit of the strain, joules per square metre, of elastic sheets.
    pub(crate) strain_barrier: Option<f64>,
    /// What potentials remember, of those that do.
    pub(crate) memories: Vec<Vec<f64>>,
}

impl FreeState {
    /// Refuses numbers that are not finite, which a checkpoint that was changed from outside may have.
    pub(crate) fn check_numbers(&self) -> Result<(), CheckpointError> {
        let SolverState { state, history, .. } = &self.solver;
        let previous = history.previous.as_ref().unwrap_or(state);
        let multipliers = &history.multipliers;
        check_finite("times", &[state.t, previous.t, multipliers.step])?;
        check_finite("positions", &state.x)?;
        check_finite("velocities", &state.v)?;
        check_finite("positions of the step before", &previous.x)?;
        check_finite("velocities of the step before", &previous.v)?;
        check_finite("multipliers of the isometry", &multipliers.rods)?;
        check_finite("stiffnesses of the rods", &[history.rod_stiffness])?;
        for memory in &self.memories {
            check_finite("plastic deformations", memory)?;
        }
        check_finite(
            "stiffnesses of the strain barrier",
            self.strain_barrier.as_slice(),
        )
    }
}
