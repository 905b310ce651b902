//! Contact as a term of the objective of a step.

use super::{
    ActiveContacts, BarrierPotential, BodyMotionError, BodyMotions, Contact, ContactError,
    ContactSet, ContactState, ContactTerms, JointMotion, LaggedFriction, StepSpan, advanced,
};
use crate::hessian::{BlockSink, HessianPart, HessianProduct};
use crate::term::{Barrier, Exchange, Iterate, Refusal, StepStart, Term, Value};
use crate::{SheetModel, State};

/// Barrier and lagged friction, `B(x) + D(x - x0)`.
pub(crate) struct ContactTerm {
    geometry: Box<dyn Contact>,
    /// Its stiffness is set at the start of a run.
    barrier: BarrierPotential,
    /// The motions of the bodies that were asked for last.
    bodies: BodyMotions,
    /// What belongs to the present step; nothing before the first one.
    step: Option<InStep>,
}

/// Contact in the course of a step. The contacts are evaluated where the term is asked for, and no more often
/// than that.
struct InStep {
    bodies: BodyMotions,
    /// Progress of the bodies over the step.
    progress: f64,
    /// The pairs of the motion that was checked last; the iterates stay on it.
    set: ContactSet,
    state: ContactState,
    /// Positions of the active contacts; `None` where set or bodies have changed since.
    evaluated: Option<Vec<f64>>,
    /// Room for them.
    room: Vec<f64>,
    friction_before: LaggedFriction,
    /// Positions at the start of the step.
    start: Vec<f64>,
    /// Positions at the end of the motion that was checked last, and the contacts there.
    end: Vec<f64>,
    ahead: ActiveContacts,
    /// Work and energy of the barrier at the start of the step, joules.
    start_work: f64,
    start_energy: f64,
    zeros: Vec<f64>,
}

impl ContactTerm {
    /// Starts at a state; with the contacts there.
    pub(crate) fn new(
        mut geometry: Box<dyn Contact>,
        model: &SheetModel,
        state: &State,
    ) -> Result<(Self, ContactState), ContactError> {
        let bodies = check_start(geometry.as_mut(), model, state)?;
        let barrier = BarrierPotential::at_start(geometry.laws(), model, state)?;
        let contacts = ContactState {
            barrier,
            active: ActiveContacts::at_rest(geometry.as_mut(), state.t, &state.x),
            friction: LaggedFriction::none(),
        };
        let step = None;
        let term = Self {
            geometry,
            barrier,
            bodies,
            step,
        };
        Ok((term, contacts))
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
        let step = None;
        Ok(Self {
            geometry,
            barrier,
            bodies,
            step,
        })
    }

    /// Refuses a span of time if the pose of a body is not finite at its start or end.
    pub(crate) fn check_bodies(&mut self, span: StepSpan) -> Result<(), BodyMotionError> {
        self.motions(span).check()
    }

    /// The motions of the bodies over a span of time.
    pub(crate) fn motions(&mut self, span: StepSpan) -> &BodyMotions {
        self.bodies.update(self.geometry.as_ref(), span);
        &self.bodies
    }

    /// The contacts that were evaluated last, with friction.
    pub(crate) fn state(&self) -> Option<&ContactState> {
        self.step.as_ref().map(|step| &step.state)
    }

    /// The step, with the contacts at positions `x`.
    fn at(&mut self, x: &[f64]) -> &mut InStep {
        let step = self.step.as_mut().expect("a step has begun");
        if step.evaluated.as_deref() != Some(x) {
            let active = &mut step.state.active;
            active.update(self.geometry.as_ref(), &step.set, step.progress, x);
            let mut room = match step.evaluated.take() {
                Some(room) => room,
                None => std::mem::take(&mut step.room),
            };
            room.clear();
            room.extend_from_slice(x);
            step.evaluated = Some(room);
        }
        step
    }
}

impl InStep {
    fn new(geometry: &mut dyn Contact, barrier: BarrierPotential, start: &StepStart<'_>) -> Self {
        let x0 = &start.state.x;
        let bodies = BodyMotions::over(geometry, span(start));
        let progress = bodies.first_progress();
        let zeros = vec![0.0; x0.len()];
        let set = ContactSet::of(geometry, at_rest(&bodies, progress, x0, &zeros));
        let active = ActiveContacts::at(geometry, &set, progress, x0);
        Self {
            bodies,
            progress,
            set,
            start: x0.clone(),
            end: x0.clone(),
            ahead: active.clone(),
            state: ContactState {
                barrier,
                active,
                friction: LaggedFriction::none(),
            },
            evaluated: None,
            room: Vec::new(),
            friction_before: LaggedFriction::none(),
            start_work: 0.0,
            start_energy: 0.0,
            zeros,
        }
    }

    /// Back to the start of a step; reuses memory.
    fn restart(&mut self, geometry: &mut dyn Contact, start: &StepStart<'_>) {
        let x0 = &start.state.x;
        self.start.copy_from_slice(x0);
        self.bodies.update(geometry, span(start));
        self.progress = self.bodies.first_progress();
        let motion = at_rest(&self.bodies, self.progress, x0, &self.zeros);
        self.set.update(geometry, motion);
        self.forget();
    }

    /// Has the contacts evaluated anew when they are asked for.
    fn forget(&mut self) {
        if let Some(room) = self.evaluated.take() {
            self.room = room;
        }
    }

    fn set_start(&mut self, geometry: &dyn Contact) {
        let ContactState {
            barrier,
            active,
            friction,
        } = &mut self.state;
        friction.lag(geometry.laws(), barrier, active, &self.start);
        self.start_energy = active.barrier_energy(barrier);
        self.start_work = match self.bodies.any_moves() {
            true => active.barrier_work(barrier),
            false => 0.0,
        };
    }
}

fn span(start: &StepStart<'_>) -> StepSpan {
    StepSpan {
        t0: start.state.t,
        h: start.span,
    }
}

/// No motion: bodies and sheet stay where they are.
fn at_rest<'a>(bodies: &'a BodyMotions, s: f64, x: &'a [f64], zeros: &'a [f64]) -> JointMotion<'a> {
    JointMotion {
        bodies,
        progress: [s; 2],
        x,
        dx: zeros,
    }
}

impl Term for ContactTerm {
    /// Puts sheet and bodies where the step starts, and lags friction there.
    fn begin(&mut self, start: &StepStart<'_>) -> Result<(), Refusal> {
        let geometry = self.geometry.as_mut();
        match &mut self.step {
            Some(step) => step.restart(geometry, start),
            None => self.step = Some(InStep::new(geometry, self.barrier, start)),
        }
        self.at(&start.state.x);
        if let Some(step) = &mut self.step {
            step.set_start(self.geometry.as_ref());
        }
        Ok(())
    }

    fn value(&mut self, at: Iterate<'_>) -> Value {
        let step = self.at(at.x);
        Value::of(ContactTerms::of(&step.state, at.x).energy())
    }

    fn add_gradient(&mut self, at: Iterate<'_>, scale: f64, out: &mut [f64]) {
        let step = self.at(at.x);
        ContactTerms::of(&step.state, at.x).add_gradient(scale, out);
    }

    /// Each contact's own part is positive semidefinite.
    fn add_hessian(&mut self, at: Iterate<'_>, _part: HessianPart, sink: &mut dyn BlockSink) {
        let step = self.at(at.x);
        ContactTerms::of(&step.state, at.x).add_hessian(sink);
    }

    fn append_couplings(&mut self, at: Iterate<'_>, out: &mut Vec<[u32; 2]>) {
        let step = self.at(at.x);
        ContactTerms::of(&step.state, at.x).append_couplings(out);
    }

    fn barrier(&self) -> Option<Barrier> {
        Some(Barrier::Contact)
    }

    /// The bodies go on by the same part of the rest of their motions.
    fn safe_part(&mut self, at: Iterate<'_>, dx: &[f64]) -> f64 {
        let step = self.step.as_mut().expect("a step has begun");
        let motion = JointMotion {
            bodies: &step.bodies,
            progress: [step.progress, 1.0],
            x: at.x,
            dx,
        };
        step.set.update(self.geometry.as_mut(), motion);
        step.forget();
        step.set.safe_fraction()
    }

    /// The forces that answer gaps which close faster than to first order, see
    /// [`ActiveContacts::add_gap_correction`].
    fn add_correction(&mut self, at: Iterate<'_>, dx: &[f64], scale: f64, out: &mut [f64]) -> bool {
        self.at(at.x);
        let step = self.step.as_mut().expect("a step has begun");
        for ((end, x), d) in step.end.iter_mut().zip(at.x).zip(dx) {
            *end = x + d;
        }
        let geometry = self.geometry.as_ref();
        step.ahead
            .update(geometry, &step.set, step.progress, &step.end);
        let ContactState {
            barrier, active, ..
        } = &step.state;
        active.add_gap_correction(&step.ahead, barrier, dx, scale, out)
    }

    fn progress(&self) -> f64 {
        self.step.as_ref().map_or(1.0, |step| step.progress)
    }

    fn advance(&mut self, part: f64) {
        if let Some(step) = &mut self.step {
            step.progress = advanced(step.progress, part);
            step.forget();
        }
    }

    /// By the motions of the bodies. (What pins change is left out.)
    fn add_drive(&mut self, at: Iterate<'_>, product: &mut HessianProduct<'_>) {
        let step = self.at(at.x);
        let terms = ContactTerms::of(&step.state, at.x);
        terms.add_drive(product.scale, product.product);
    }

    /// Lags friction of the step anew where a normal force has changed by more than `settled`, relative to the
    /// largest. Otherwise friction remains that for which the iterate was found, and the forces of the step
    /// balance.
    fn renew(&mut self, at: Iterate<'_>, settled: f64) -> bool {
        self.at(at.x);
        let step = self.step.as_mut().expect("a step has begun");
        let ContactState {
            barrier,
            active,
            friction,
        } = &mut step.state;
        std::mem::swap(friction, &mut step.friction_before);
        friction.lag(self.geometry.laws(), barrier, active, &step.start);
        let has_changed = friction.change_since(&step.friction_before) > settled;
        if !has_changed {
            std::mem::swap(friction, &mut step.friction_before);
        }
        has_changed
    }

    fn contact_count(&self) -> usize {
        self.state().map_or(0, |state| state.active.list().len())
    }

    /// Work of the bodies (trapezoidal rule), friction, and the change of the energy of the barrier.
    fn finish(&mut self, _start: &StepStart<'_>, at: Iterate<'_>) -> Result<Exchange, Refusal> {
        self.at(at.x);
        let step = self.step.as_mut().expect("a step has begun");
        let gap = step.state.active.gap();
        if gap <= 0.0 || gap.is_nan() {
            return Err(Refusal::Contact { gap });
        }
        let terms = ContactTerms::of(&step.state, at.x);
        let exchange = terms.exchange(step.start_work, step.start_energy);
        let ContactState {
            barrier, active, ..
        } = &step.state;
        let settled = &mut step.friction_before;
        settled.lag(self.geometry.laws(), barrier, active, &step.start);
        Ok(Exchange {
            settled_friction: settled.loss(at.x, active.bodies()),
            ..exchange
        })
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
