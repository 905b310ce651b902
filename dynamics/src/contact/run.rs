//! Contact of a simulation and of a step.

use super::{
    ActiveContacts, BarrierPotential, BodyMotionError, BodyMotions, Contact, ContactError,
    ContactState, ContactTerms, LaggedFriction, StepSpan,
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
    /// The motions of the bodies that were checked last.
    bodies: BodyMotions,
}

impl RunContact {
    /// Starts at a state; with the contacts there.
    pub(crate) fn new(
        mut geometry: Box<dyn Contact>,
        model: &SheetModel,
        state: &State,
    ) -> Result<(Self, ContactState), ContactError> {
        let bodies = check_start(geometry.as_mut(), model, state)?;
        let barrier = BarrierPotential::at_start(geometry.laws(), model, state)?;
        let contacts = ContactState {
            active: ActiveContacts::at_rest(geometry.as_mut(), state.t, &state.x),
            friction: LaggedFriction::none(),
        };
        let run = Self {
            geometry,
            barrier,
            bodies,
        };
        Ok((run, contacts))
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
        let bodies = check_start(geometry.as_mut(), model, state)?;
        Ok(Self {
            geometry,
            barrier,
            bodies,
        })
    }

    /// Refuses a span of time if the pose of a body is not finite at its start or end.
    pub(crate) fn check_bodies(&mut self, span: StepSpan) -> Result<(), BodyMotionError> {
        self.bodies.update(self.geometry.as_ref(), span);
        self.bodies.check()
    }

    /// The motions of the bodies over a span of time.
    pub(crate) fn motions(&mut self, span: StepSpan) -> &BodyMotions {
        self.bodies.update(self.geometry.as_ref(), span);
        &self.bodies
    }

    /// Whether no body moves in a span of time.
    pub(crate) fn bodies_rest(&mut self, span: StepSpan) -> bool {
        !self.motions(span).any_moves()
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

    /// Barrier and friction at contacts, `x` being the positions.
    pub(crate) fn terms<'a>(
        &'a self,
        contacts: &'a ContactState,
        x: &'a [f64],
    ) -> ContactTerms<'a> {
        ContactTerms {
            x,
            active: &contacts.active,
            barrier: &self.barrier,
            friction: &contacts.friction,
        }
    }
}

/// Checks that contact can start at a state; with the bodies there.
///
/// # Errors
/// [`ContactError::Motion`] if the pose of a body is not finite, and as [`Contact::check_start`].
pub(crate) fn check_start(
    geometry: &mut dyn Contact,
    model: &SheetModel,
    state: &State,
) -> Result<BodyMotions, ContactError> {
    let span = StepSpan {
        t0: state.t,
        h: 0.0,
    };
    let bodies = BodyMotions::over(geometry, span);
    bodies.check()?;
    geometry.check_start(model, state)?;
    Ok(bodies)
}
