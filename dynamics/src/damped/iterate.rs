//! Positions in the course of a step, with the contacts there.

use crate::contact::{
    ActiveContacts, BodyMotions, ContactSet, ContactState, ContactTerms, ContactWork, JointMotion,
    LaggedFriction, StepContact, StepSpan, advanced,
};

/// The positions of an iteration and, in scenes with contact, the places of the bodies and what is known of
/// the contacts there. The contacts always belong to the positions: whatever changes one makes the other
/// evaluated anew when it is asked for, and no more often than that.
pub(crate) struct Iterate {
    x: Vec<f64>,
    contact: Option<ContactIterate>,
}

struct ContactIterate {
    bodies: BodyMotions,
    /// Progress of the bodies over the step.
    progress: f64,
    /// The pairs of the motion that was checked last; the iterate stays on it.
    set: ContactSet,
    state: ContactState,
    /// Whether the active contacts are those at the positions.
    is_current: bool,
    friction_before: LaggedFriction,
    /// Positions at the end of the motion that was checked last, and the contacts there.
    end: Vec<f64>,
    ahead: ActiveContacts,
    /// Work and energy of the barrier at the start of the step, joules.
    start_work: f64,
    start_energy: f64,
    zeros: Vec<f64>,
}

impl ContactIterate {
    fn new(contact: &mut StepContact<'_>, span: StepSpan, x0: &[f64]) -> Self {
        let bodies = BodyMotions::over(contact.geometry, span);
        let progress = bodies.first_progress();
        let zeros = vec![0.0; x0.len()];
        let set = ContactSet::of(
            contact.geometry,
            motion_at_rest(&bodies, progress, x0, &zeros),
        );
        let active = ActiveContacts::at(contact.geometry, &set, progress, x0);
        let mut new = Self {
            bodies,
            progress,
            set,
            end: x0.to_vec(),
            ahead: active.clone(),
            state: ContactState {
                active,
                friction: LaggedFriction::none(),
            },
            is_current: true,
            friction_before: LaggedFriction::none(),
            start_work: 0.0,
            start_energy: 0.0,
            zeros,
        };
        new.set_start(contact, x0);
        new
    }

    /// Back to the start of a step; reuses memory.
    fn restart(&mut self, contact: &mut StepContact<'_>, span: StepSpan, x0: &[f64]) {
        self.bodies.update(contact.geometry, span);
        self.progress = self.bodies.first_progress();
        let motion = motion_at_rest(&self.bodies, self.progress, x0, &self.zeros);
        self.set.update(contact.geometry, motion);
        self.update(contact, x0);
        self.set_start(contact, x0);
    }

    fn set_start(&mut self, contact: &StepContact<'_>, x0: &[f64]) {
        let laws = contact.geometry.laws();
        let ContactState { active, friction } = &mut self.state;
        friction.lag(laws, &contact.barrier, active, x0);
        self.start_energy = active.barrier_energy(&contact.barrier);
        self.start_work = if self.bodies.any_moves() {
            active.barrier_work(&contact.barrier)
        } else {
            0.0
        };
    }

    fn update(&mut self, contact: &StepContact<'_>, x: &[f64]) {
        let active = &mut self.state.active;
        active.update(contact.geometry, &self.set, self.progress, x);
        self.is_current = true;
    }
}

/// No motion: bodies and sheet stay where they are.
fn motion_at_rest<'a>(
    bodies: &'a BodyMotions,
    s: f64,
    x: &'a [f64],
    zeros: &'a [f64],
) -> JointMotion<'a> {
    JointMotion {
        bodies,
        progress: [s; 2],
        x,
        dx: zeros,
    }
}

impl Iterate {
    /// With `n` coordinates, all zero.
    pub(crate) fn new(n: usize) -> Self {
        Self::without_contact(vec![0.0; n])
    }

    /// At positions in a scene without contact.
    pub(crate) fn without_contact(x: Vec<f64>) -> Self {
        Self { x, contact: None }
    }

    /// Positions, `3V`, metres.
    pub(crate) fn x(&self) -> &[f64] {
        &self.x
    }

    /// The positions to be changed.
    pub(crate) fn x_mut(&mut self) -> &mut [f64] {
        if let Some(contact) = &mut self.contact {
            contact.is_current = false;
        }
        &mut self.x
    }

    /// The positions alone.
    pub(crate) fn into_x(self) -> Vec<f64> {
        self.x
    }

    /// Puts sheet and bodies where a step starts, and lags friction there.
    pub(crate) fn begin(
        &mut self,
        contact: Option<&mut StepContact<'_>>,
        span: StepSpan,
        x0: &[f64],
    ) {
        self.x.copy_from_slice(x0);
        match (contact, &mut self.contact) {
            (None, own) => *own = None,
            (Some(contact), Some(own)) => own.restart(contact, span, x0),
            (Some(contact), own) => *own = Some(ContactIterate::new(contact, span, x0)),
        }
    }

    /// Progress of the bodies over the step, from 0 to 1; 1 if no body moves.
    pub(crate) fn progress(&self) -> f64 {
        self.contact.as_ref().map_or(1.0, |c| c.progress)
    }

    /// Largest part of a displacement, at most one, that is proven to bring nothing into contact while the
    /// bodies go through the same part of the rest of their motions. Until the next call of this or of
    /// [`Iterate::begin`], the iterate has to stay on that motion.
    pub(crate) fn safe_fraction(
        &mut self,
        contact: Option<&mut StepContact<'_>>,
        dx: &[f64],
    ) -> f64 {
        let (Some(contact), Some(own)) = (contact, &mut self.contact) else {
            return 1.0;
        };
        let motion = JointMotion {
            bodies: &own.bodies,
            progress: [own.progress, 1.0],
            x: &self.x,
            dx,
        };
        own.set.update(contact.geometry, motion);
        own.is_current = false;
        own.set.safe_fraction()
    }

    /// Adds `scale` times the forces with which a second-order correction of the displacement `dx` answers
    /// gaps that close faster than to first order; whether there are any. `dx` has to be the motion that was
    /// checked last, with the bodies at rest. See [`ActiveContacts::add_gap_correction`].
    pub(crate) fn add_gap_correction(
        &mut self,
        contact: Option<&StepContact<'_>>,
        dx: &[f64],
        scale: f64,
        out: &mut [f64],
    ) -> bool {
        let (Some(contact), Some(own)) = (contact, &mut self.contact) else {
            return false;
        };
        if !own.is_current {
            own.update(contact, &self.x);
        }
        for ((end, x), d) in own.end.iter_mut().zip(&self.x).zip(dx) {
            *end = x + d;
        }
        own.ahead
            .update(contact.geometry, &own.set, own.progress, &own.end);
        let active = &own.state.active;
        active.add_gap_correction(&own.ahead, &contact.barrier, dx, scale, out)
    }

    /// Moves the bodies by a fraction of the rest of their motions, to the end exactly for one.
    pub(crate) fn advance_bodies(&mut self, fraction: f64) {
        if let Some(own) = &mut self.contact {
            own.progress = advanced(own.progress, fraction);
            own.is_current = false;
        }
    }

    /// The contact terms at the iterate; `None` in scenes without contact.
    pub(crate) fn terms<'a>(
        &'a mut self,
        contact: Option<&'a StepContact<'_>>,
    ) -> Option<ContactTerms<'a>> {
        let (contact, own) = (contact?, self.contact.as_mut()?);
        if !own.is_current {
            own.update(contact, &self.x);
        }
        Some(ContactTerms {
            x: &self.x,
            active: &own.state.active,
            barrier: &contact.barrier,
            friction: &own.state.friction,
        })
    }

    /// Lags friction of the step from `x0` anew at the iterate where a normal force has changed by more than
    /// `settled`, relative to the largest; whether it has. Otherwise friction remains that for which the
    /// iterate was found, and the forces of the step balance.
    pub(crate) fn renew_friction(
        &mut self,
        contact: Option<&StepContact<'_>>,
        x0: &[f64],
        settled: f64,
    ) -> bool {
        let (Some(contact), Some(own)) = (contact, &mut self.contact) else {
            return false;
        };
        if !own.is_current {
            own.update(contact, &self.x);
        }
        let friction = &mut own.state.friction;
        std::mem::swap(friction, &mut own.friction_before);
        let laws = contact.geometry.laws();
        friction.lag(laws, &contact.barrier, &own.state.active, x0);
        let has_changed = friction.change_since(&own.friction_before) > settled;
        if !has_changed {
            std::mem::swap(friction, &mut own.friction_before);
        }
        has_changed
    }

    /// What contact did over the step from `x0` if it ends at the iterate; zero without contact.
    pub(crate) fn contact_work(
        &mut self,
        contact: Option<&StepContact<'_>>,
        x0: &[f64],
    ) -> ContactWork {
        let start = self
            .contact
            .as_ref()
            .map(|c| (c.start_work, c.start_energy));
        let (Some(terms), Some((work, energy))) = (self.terms(contact), start) else {
            return ContactWork::default();
        };
        let work = terms.work(work, energy);
        let (Some(contact), Some(own)) = (contact, &mut self.contact) else {
            return work;
        };
        let (laws, active) = (contact.geometry.laws(), &own.state.active);
        let settled = &mut own.friction_before;
        settled.lag(laws, &contact.barrier, active, x0);
        ContactWork {
            settled_friction: settled.loss(&self.x, active.bodies()),
            ..work
        }
    }

    /// The contacts that were evaluated last, with friction.
    pub(crate) fn contact_state(&self) -> Option<&ContactState> {
        self.contact.as_ref().map(|c| &c.state)
    }
}
