//! Contact of a simulation and of a step.

use super::{
    ActiveContacts, BarrierPotential, BodyLoad, Contact, ContactError, ContactState, ContactTerms,
    LaggedFriction,
};
use crate::{SheetModel, State};

/// Contact as a step uses it.
pub(crate) struct StepContact<'a> {
    /// The geometry.
    pub(crate) geometry: &'a mut (dyn Contact + 'static),
    /// The barrier of the run.
    pub(crate) barrier: BarrierPotential,
}

/// Contact as a simulation holds it.
pub(crate) struct RunContact {
    geometry: Box<dyn Contact>,
    barrier: BarrierPotential,
}

impl RunContact {
    /// Starts at a state; with the contacts there.
    pub(crate) fn new(
        mut geometry: Box<dyn Contact>,
        model: &SheetModel,
        state: &State,
    ) -> Result<(Self, ContactState), ContactError> {
        geometry.check_start(model, state)?;
        let barrier = BarrierPotential::at_start(geometry.laws(), model, state)?;
        let contacts = ContactState {
            active: ActiveContacts::at_rest(geometry.as_mut(), state.t, &state.x),
            friction: LaggedFriction::none(),
        };
        Ok((Self { geometry, barrier }, contacts))
    }

    /// Goes on with the barrier of an earlier run.
    ///
    /// # Errors
    /// [`ContactError`] if the geometry is of another sheet, or something touches at the state.
    pub(crate) fn resume(
        mut geometry: Box<dyn Contact>,
        barrier: BarrierPotential,
        model: &SheetModel,
        state: &State,
    ) -> Result<Self, ContactError> {
        geometry.check_start(model, state)?;
        Ok(Self { geometry, barrier })
    }

    /// The barrier, whose stiffness was set at the start of the run.
    pub(crate) fn barrier(&self) -> BarrierPotential {
        self.barrier
    }

    /// For a step.
    pub(crate) fn step(&mut self) -> StepContact<'_> {
        StepContact {
            geometry: self.geometry.as_mut(),
            barrier: self.barrier,
        }
    }

    /// The barrier potential of contacts, joules.
    pub(crate) fn barrier_energy(&self, contacts: &ContactState) -> f64 {
        contacts.active.barrier_energy(&self.barrier)
    }

    /// What the sheet does to the bodies at contacts, `x` being the positions.
    pub(crate) fn loads(&self, contacts: &ContactState, x: &[f64]) -> Vec<BodyLoad> {
        let terms = ContactTerms {
            x,
            active: &contacts.active,
            barrier: &self.barrier,
            friction: &contacts.friction,
        };
        terms.loads()
    }
}
