//! The state of a chart-free simulation, as one value.

use crate::contact::ContactState;
use crate::report::checkpoint_error::{CheckpointError, check_finite, check_length};
use crate::step::energy_account::EnergyAccount;
use crate::step::history::History;
use crate::step::reaction::Balance;
use crate::{SheetModel, State};
use isosheet_materials::potential::Memories;
use serde::{Deserialize, Serialize};

/// A point of a motion: all that the next step depends on besides the scene and the options of the method. A
/// proposal is another one, a commit exchanges the two, and a checkpoint is this value, serialised.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub(crate) struct Motion {
    /// Time, positions and velocities.
    pub(crate) state: State,
    /// What the method remembers of earlier steps.
    pub(crate) history: History,
    /// What the potentials remember.
    pub(crate) memories: Memories,
    /// Forces of the supports in the step that ended here. Meaningless before the first step.
    pub(crate) balance: Balance,
    /// The contacts at the state, with the barrier and the friction of the step that ended here; `None`
    /// without contact.
    pub(crate) contacts: Option<ContactState>,
    /// The energy that a damped method has gained.
    pub(crate) account: EnergyAccount,
    /// Whether a step has been taken since the start.
    pub(crate) has_moved: bool,
}

impl Motion {
    /// A start at a state.
    pub(crate) fn at(state: State, model: &SheetModel, balance: Balance) -> Self {
        Self {
            memories: model.memories_at_start(&state),
            state,
            history: History::default(),
            balance,
            contacts: None,
            account: EnergyAccount::default(),
            has_moved: false,
        }
    }

    /// What a checkpoint keeps.
    pub(crate) fn compact(&self) -> Self {
        Self {
            balance: self.balance.compact(),
            ..self.clone()
        }
    }

    /// Takes over another motion of the same model, in place.
    pub(crate) fn copy_from(&mut self, other: &Self) {
        self.state.copy_from(&other.state);
        self.history.copy_from(&other.history);
        self.memories.copy_from(&other.memories);
        self.balance.copy_from(&other.balance);
        self.set_contacts(other.contacts.as_ref());
        self.account = other.account;
        self.has_moved = other.has_moved;
    }

    /// Sets the contacts, in place.
    pub(crate) fn set_contacts(&mut self, contacts: Option<&ContactState>) {
        match (&mut self.contacts, contacts) {
            (Some(mine), Some(other)) => mine.copy_from(other),
            (mine, other) => *mine = other.cloned(),
        }
    }

    /// Refuses arrays of the wrong length and numbers that are not finite, which a checkpoint that was
    /// changed from outside may have.
    pub(crate) fn check(&self, model: &SheetModel, fixed: &[u32]) -> Result<(), CheckpointError> {
        self.check_lengths(model, fixed)?;
        self.check_numbers()
    }

    fn check_lengths(&self, model: &SheetModel, fixed: &[u32]) -> Result<(), CheckpointError> {
        let (n, m, k) = (
            model.coordinate_count(),
            model.rods().len(),
            model.constraints().len(),
        );
        let Self { state, history, .. } = self;
        let previous = history.previous.as_ref().unwrap_or(state);
        let multipliers = &history.multipliers;
        let optional = |length: usize, expected: usize| if length == 0 { expected } else { length };
        let vertices = model.topology().vertex_count();
        let largest = history.couplings.iter().flatten().chain(fixed).max();
        for (what, found, expected) in [
            ("positions", state.x.len(), n),
            ("velocities", state.v.len(), n),
            ("positions of the step before", previous.x.len(), n),
            ("velocities of the step before", previous.v.len(), n),
            (
                "multipliers of the isometry",
                optional(multipliers.rods.len(), m),
                m,
            ),
            (
                "multipliers of vertex constraints",
                optional(multipliers.constraints.len(), k),
                k,
            ),
        ] {
            check_length(what, found, expected)?;
        }
        let of_bodies = history
            .body_changes
            .iter()
            .map(|body| body.first.saturating_add(3));
        let largest = largest.copied().into_iter().chain(of_bodies).max();
        match largest {
            Some(v) if v as usize >= vertices => Err(CheckpointError::NoSuchVertex {
                vertex: v,
                vertices,
            }),
            _ => Ok(()),
        }
    }

    fn check_numbers(&self) -> Result<(), CheckpointError> {
        let Self { state, history, .. } = self;
        let previous = history.previous.as_ref().unwrap_or(state);
        let multipliers = &history.multipliers;
        check_finite("times", &[state.t, previous.t, multipliers.step])?;
        check_finite("positions", &state.x)?;
        check_finite("velocities", &state.v)?;
        check_finite("positions of the step before", &previous.x)?;
        check_finite("velocities of the step before", &previous.v)?;
        check_finite("multipliers of the isometry", &multipliers.rods)?;
        check_finite("stiffnesses of the rods", &[history.rod_stiffness])?;
        check_finite("lengths of sub-steps", history.longest.as_slice())?;
        for change in history
            .body_changes
            .iter()
            .flat_map(|body| &body.velocities)
        {
            check_finite("changes of the velocities of bodies", change.as_slice())?;
        }
        for memory in self.memories.lists() {
            check_finite("memories of potentials", memory)?;
        }
        Ok(())
    }
}
