//! Going on from a state with other supports, glue and contacts.

use super::{Engine, Steps, check_energy};
use crate::contact::{Contact, ContactTerm};
use crate::report::checkpoint_error::CheckpointError;
use crate::{SheetModel, SimulationError};
use isosheet_model::immobile_vertices;

impl Engine {
    /// From the present state on with a model of the same sheet that is held otherwise. Pinned vertices take
    /// the velocities of their motions over `span` seconds, and a method of two steps begins anew, as at a
    /// start.
    pub(crate) fn held_by(
        &self,
        mut model: SheetModel,
        contact: Option<Box<dyn Contact>>,
        span: f64,
    ) -> Result<Self, SimulationError> {
        let mut state = self.motion.state.clone();
        let mut memories = model.memories();
        let taken = memories.take_over(&self.motion.memories);
        taken.map_err(CheckpointError::from)?;
        model.clear_pinned(&mut state.v);
        model.set_pin_velocities(state.t, span, &mut state.v);
        let fixed = immobile_vertices(&model, &state.x);
        model.fix(&fixed);
        model.clear_velocities(&fixed, &mut state.v);
        model.set_load(&state);
        check_energy(&model, &memories, &state)?;
        let mut engine = Self::with_fixed(model, self.method.clone(), state, fixed, Steps::Taken)?;
        engine.set_control(self.control.clone())?;
        engine.motion.memories = memories;
        engine.motion.account = self.motion.account;
        let barrier = self.motion.contacts.as_ref().map(|c| c.barrier);
        match (contact, barrier) {
            (None, None) => {}
            (Some(contact), Some(barrier)) => {
                let state = &engine.motion.state;
                let (term, contacts) = ContactTerm::anew(contact, barrier, &engine.model, state)?;
                engine.objective.set(term);
                engine.motion.contacts = Some(contacts);
            }
            (_, barrier) => {
                let expected = barrier.is_some();
                return Err(CheckpointError::Contact { expected }.into());
            }
        }
        Ok(engine)
    }

    /// Whether its steps are minima.
    pub(crate) fn is_minimising(&self) -> bool {
        self.method.is_minimising()
    }
}
