//! Contact of a simulation and of a step.

use super::{
    ActiveContacts, BarrierPotential, BodyLoad, Contact, ContactError, ContactState, ContactTerms,
    LaggedFriction,
};
use crate::{SheetModel, State};

/// Contact as a step uses it.
pub struct StepContact<'a> {
    /// The geometry.
    pub geometry: &'a mut (dyn Contact + 'static),
    /// The barrier of the run.
    pub barrier: BarrierPotential,
}

/// Contact as a simulation holds it.
pub(crate) struct RunContact {
    geometry: Box<dyn Contact>,
    barrier: BarrierPotential,
    /// The contacts at the last accepted state.
    pub(crate) state: ContactState,
}

impl RunContact {
    /// Starts at a state.
    pub(crate) fn new(
        mut geometry: Box<dyn Contact>,
        model: &SheetModel,
        state: &State,
    ) -> Result<Self, ContactError> {
        geometry.check_start(model, state)?;
        Ok(Self {
            barrier: BarrierPotential::at_start(geometry.laws(), model, state)?,
            state: ContactState {
                active: ActiveContacts::at_rest(geometry.as_mut(), state.t, &state.x),
                friction: LaggedFriction::none(),
            },
            geometry,
        })
    }

    /// For a step.
    pub(crate) fn step(&mut self) -> StepContact<'_> {
        StepContact {
            geometry: self.geometry.as_mut(),
            barrier: self.barrier,
        }
    }

    fn terms<'a>(&'a self, x: &'a [f64]) -> ContactTerms<'a> {
        ContactTerms {
            x,
            active: &self.state.active,
            barrier: &self.barrier,
            friction: &self.state.friction,
        }
    }

    /// The barrier potential at the last accepted state, joules.
    pub(crate) fn barrier_energy(&self) -> f64 {
        self.state.active.barrier_energy(&self.barrier)
    }

    /// What the sheet does to the bodies at the last accepted state, `x` being its positions.
    pub(crate) fn loads(&self, x: &[f64]) -> Vec<BodyLoad> {
        self.terms(x).loads()
    }
}
