//! Engines from outside: other ways to move a sheet than the methods of this crate.

use crate::report::step_report::StepOutcome;
use crate::report::totals::StepTotals;
pub use crate::step::reaction::{Balance, ForceTime, supports};
use crate::{Memories, Reaction, SheetModel, State};
use isosheet_model::StepError;
pub use isosheet_model::{AdvisedError, EngineError};
use std::any::Any;
use std::sync::Arc;

/// What moves a sheet in a [`Simulation`](crate::Simulation) that is made by
/// [`Simulation::with_engine`](crate::Simulation::with_engine), such as motion in system coordinates. The
/// simulation keeps the balance of energy, and takes checkpoints. There is no contact, and no step control
/// but the engine's own.
pub trait Engine: Any + Send {
    /// Its name in checkpoints and messages, such as "a chart".
    fn name(&self) -> &'static str;

    /// The model.
    fn model(&self) -> &Arc<SheetModel>;

    /// Time, positions and velocities.
    fn state(&self) -> &State;

    /// What the potentials remember.
    fn memories(&self) -> &Memories;

    /// What the potentials remember.
    fn memories_mut(&mut self) -> &mut Memories;

    /// Advances to the time `end` (seconds), and counts what it does. It stops where [`Progress::goes_on`]
    /// says no.
    ///
    /// # Errors
    /// [`StepError::Engine`], [`StepError::Interrupted`]. The state is that of the last accepted sub-step.
    fn advance(&mut self, end: f64, progress: &mut Progress<'_, '_>) -> Result<(), StepError>;

    /// Forces of the supports at the end of the last step; empty before the first.
    fn reactions(&self) -> Vec<Reaction>;

    /// What a checkpoint keeps of it besides model, energies and note.
    fn kept(&self) -> Vec<u8>;
}

/// What an engine does in a step.
#[derive(Debug)]
pub struct Progress<'a, 'w>(pub(crate) &'a mut StepTotals<'w>);

/// A sub-step that an engine has accepted.
#[derive(Debug, Clone, Copy)]
pub struct AcceptedSubstep {
    /// Proposals that were refused before it.
    pub rejected: usize,
    /// How it was found.
    pub outcome: StepOutcome,
    /// Work of all that is not conservative, and of what is prescribed, joules.
    pub work: f64,
    /// Energy that velocity damping took out, joules.
    pub dissipated: f64,
}

impl Progress<'_, '_> {
    /// Whether the step goes on from time `t`, seconds: its watch may end it.
    pub fn goes_on(&mut self, t: f64) -> bool {
        self.0.effort.t = t;
        self.0.effort.goes_on()
    }

    /// Sub-steps so far, refused ones included.
    pub fn count(&self) -> usize {
        self.0.substeps + self.0.rejected
    }

    /// Counts a sub-step.
    pub fn accept(&mut self, substep: AcceptedSubstep) {
        self.0.substeps += 1;
        self.0.rejected += substep.rejected;
        self.0.work += substep.work;
        self.0.dissipated += substep.dissipated;
        self.0.outcome = self.0.outcome.max(substep.outcome);
    }
}
