//! Contact of a simulation in a chart.

use crate::contact::{
    ActiveContacts, BodyMotionError, BodyMotions, Contact, ContactError, ContactPoint, ContactSet,
    JointMotion, StepSpan, check_start,
};
use crate::{SheetModel, State};

/// The geometry of contact with the contacts at the present state.
pub(super) struct ChartContact {
    geometry: Box<dyn Contact>,
    bodies: BodyMotions,
    /// The pairs of the motion that was checked last.
    set: ContactSet,
    active: ActiveContacts,
    /// The active contacts before the step that is being taken; also memory for the next ones.
    kept: ActiveContacts,
    points: Vec<ContactPoint>,
    displacement: Vec<f64>,
}

impl ChartContact {
    /// Starts at a state.
    pub(super) fn new(
        mut geometry: Box<dyn Contact>,
        model: &SheetModel,
        state: &State,
    ) -> Result<Self, ContactError> {
        if geometry.points().is_some() {
            return Err(ContactError::Method);
        }
        let bodies = check_start(geometry.as_mut(), model, state)?;
        let displacement = vec![0.0; state.x.len()];
        let motion = JointMotion {
            bodies: &bodies,
            progress: [1.0; 2],
            x: &state.x,
            dx: &displacement,
        };
        let set = ContactSet::of(geometry.as_mut(), motion);
        let active = ActiveContacts::at(geometry.as_ref(), &set, 1.0, &state.x);
        let mut contact = Self {
            kept: active.clone(),
            active,
            points: Vec::new(),
            geometry,
            bodies,
            set,
            displacement,
        };
        contact.evaluate(&state.x)?;
        Ok(contact)
    }

    /// The part of a motion of the sheet, and of the bodies over a span of time, that is proven free of
    /// contact.
    ///
    /// # Errors
    /// [`BodyMotionError`] if the pose of a body is not finite at the start or end of the span.
    pub(super) fn safe_fraction(
        &mut self,
        span: StepSpan,
        from: &[f64],
        to: &[f64],
    ) -> Result<f64, BodyMotionError> {
        for ((d, a), b) in self.displacement.iter_mut().zip(to).zip(from) {
            *d = a - b;
        }
        self.bodies.update(self.geometry.as_ref(), span);
        self.bodies.check()?;
        let motion = JointMotion {
            bodies: &self.bodies,
            progress: [self.bodies.first_progress(), 1.0],
            x: from,
            dx: &self.displacement,
        };
        self.set.update(self.geometry.as_mut(), motion);
        Ok(self.set.safe_fraction())
    }

    /// Evaluates the contacts at positions on the motion that was checked last, with the bodies at its end.
    ///
    /// # Errors
    /// [`BodyMotionError`] if the velocity of a body is not finite.
    pub(super) fn evaluate(&mut self, x: &[f64]) -> Result<(), BodyMotionError> {
        let geometry = self.geometry.as_ref();
        self.active.update(geometry, &self.set, 1.0, x);
        self.active.contact_points(geometry, &mut self.points)
    }

    /// Keeps the active contacts for [`ChartContact::restore`]. They have to be evaluated before they are
    /// asked for again.
    pub(super) fn keep(&mut self) {
        std::mem::swap(&mut self.active, &mut self.kept);
    }

    /// Back to the active contacts that were kept last.
    pub(super) fn restore(&mut self) {
        std::mem::swap(&mut self.active, &mut self.kept);
    }

    /// The contacts that were evaluated last.
    pub(super) fn active(&self) -> &ActiveContacts {
        &self.active
    }

    /// The same for impulses.
    pub(super) fn points(&self) -> &[ContactPoint] {
        &self.points
    }

    /// Gap below which contacts are named, metres.
    pub(super) fn activation(&self) -> f64 {
        self.geometry.laws().activation
    }
}
