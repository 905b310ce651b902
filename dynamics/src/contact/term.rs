//! Contact as a term of the objective of a step.

use super::course::EndVelocity;
use super::surface_points::CarriedSink;
use super::{
    ActiveContacts, BarrierPotential, BodyMotions, BodyPlace, Contact, ContactError, ContactKey,
    ContactLaws, ContactSet, ContactState, ContactTerms, FrictionError, FrictionLaw, JointMotion,
    LaggedFriction, StepSpan, SurfacePoints, advanced, check_values,
};
use crate::{SheetModel, State, StepError};
use isosheet_materials::hessian::{BlockSink, HessianPart, HessianProduct};
use isosheet_model::term::{Barrier, Exchange, Iterate, Lagging, StepStart, Term, Value};
use std::sync::Arc;

/// Barrier and lagged friction, `B(x) + D(x - x0)`.
pub(crate) struct ContactTerm {
    pub(super) geometry: Box<dyn Contact>,
    /// Its stiffness is set at the start of a run.
    pub(super) barrier: BarrierPotential,
    points: Option<Arc<SurfacePoints>>,
    /// The motions of the bodies that were asked for last.
    bodies: BodyMotions,
    /// What belongs to the present step; nothing before the first one.
    pub(super) step: Option<InStep>,
}

/// Contact in the course of a step. The contacts are evaluated where the term is asked for, and no more often
/// than that.
pub(super) struct InStep {
    pub(super) points: Option<Arc<SurfacePoints>>,
    pub(super) bodies: BodyMotions,
    /// Progress of the bodies over the step.
    pub(super) progress: f64,
    /// The pairs of the motion that was checked last; the iterates stay on it.
    pub(super) set: ContactSet,
    pub(super) state: ContactState,
    /// Positions of the vertices at which the contacts were evaluated, unless set or bodies have changed
    /// since.
    x: Vec<f64>,
    is_evaluated: bool,
    /// The points there, where they are not the vertices, and forces on them.
    surface: Vec<f64>,
    forces: Vec<f64>,
    friction_before: LaggedFriction,
    /// What was wrong with a law of friction first.
    friction_fault: Option<FrictionError>,
    /// The points at the start of the step.
    pub(super) start: Vec<f64>,
    pub(super) velocity: EndVelocity,
    /// The points at the end of the motion that was checked last, and the contacts there.
    end: Vec<f64>,
    ahead: ActiveContacts,
    /// Work and energy of the barrier at the start of the step, joules.
    start_work: f64,
    start_energy: f64,
    pub(super) zeros: Vec<f64>,
    /// The positions of the vertices at which friction was lagged anew, `3V`, metres.
    lags: Vec<Vec<f64>>,
    /// The points where friction was lagged, and the bodies there, of a step that is differentiated.
    pub(super) lagged_at: Vec<f64>,
    pub(super) lagged_bodies: Vec<BodyPlace>,
    pub(super) lagged_pairs: Vec<ContactKey>,
}

impl ContactTerm {
    /// Starts at a state; with the contacts there.
    pub(crate) fn new(
        mut geometry: Box<dyn Contact>,
        model: &SheetModel,
        state: &State,
    ) -> Result<(Self, ContactState), ContactError> {
        let bodies = check_start(geometry.as_mut(), model, state)?;
        geometry.laws().validate()?;
        let barrier = BarrierPotential::at_start(geometry.laws(), model, state)?;
        Ok(Self::at_rest_with(geometry, barrier, bodies, state))
    }

    /// Goes on with the barrier of an earlier run, where other things touch; with the contacts there, of
    /// which friction knows nothing yet.
    ///
    /// # Errors
    /// As [`ContactTerm::resume`].
    pub(crate) fn anew(
        mut geometry: Box<dyn Contact>,
        barrier: BarrierPotential,
        model: &SheetModel,
        state: &State,
    ) -> Result<(Self, ContactState), ContactError> {
        let bodies = check_start(geometry.as_mut(), model, state)?;
        geometry.laws().validate()?;
        Ok(Self::at_rest_with(geometry, barrier, bodies, state))
    }

    fn at_rest_with(
        mut geometry: Box<dyn Contact>,
        barrier: BarrierPotential,
        bodies: BodyMotions,
        state: &State,
    ) -> (Self, ContactState) {
        let x = SurfacePoints::placed(geometry.points(), &state.x).into_owned();
        let contacts = ContactState {
            barrier,
            active: ActiveContacts::at_rest(geometry.as_mut(), state.t, &x),
            friction: LaggedFriction::none(),
        };
        (Self::with(geometry, barrier, bodies), contacts)
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
        Ok(Self::with(geometry, barrier, bodies))
    }

    /// The laws of barrier and friction.
    pub(crate) fn laws(&self) -> &ContactLaws {
        self.geometry.laws()
    }

    fn with(geometry: Box<dyn Contact>, barrier: BarrierPotential, bodies: BodyMotions) -> Self {
        Self {
            points: geometry.points().cloned().map(Arc::new),
            geometry,
            barrier,
            bodies,
            step: None,
        }
    }

    /// The points that contact acts between, where these are not the vertices, for longer than the term is
    /// borrowed.
    pub(crate) fn shared_points(&self) -> Option<Arc<SurfacePoints>> {
        self.points.clone()
    }

    /// The points that contact acts between, where these are not the vertices.
    pub(crate) fn points(&self) -> Option<&SurfacePoints> {
        self.points.as_deref()
    }

    /// The motions of the bodies over a span of time.
    pub(crate) fn motions(&mut self, span: StepSpan) -> &BodyMotions {
        self.bodies.update(self.geometry.as_ref(), span);
        &self.bodies
    }

    /// What is wrong with the law of friction of a contact, in the step that was tried last: `check` is asked
    /// about laws that returned nothing wrong.
    pub(crate) fn friction_fault(
        &self,
        check: fn(&dyn FrictionLaw, f64) -> Result<(), FrictionError>,
    ) -> Option<FrictionError> {
        let step = self.step.as_ref()?;
        let known = step.friction_fault.clone();
        known.or_else(|| step.check_friction(check).err())
    }

    /// The contacts that were evaluated last, with friction.
    pub(crate) fn state(&self) -> Option<&ContactState> {
        self.step.as_ref().map(|step| &step.state)
    }

    /// The positions of the vertices at which friction was lagged anew in the step, `3V`, metres.
    pub(crate) fn lags(&self) -> Vec<Vec<f64>> {
        self.step
            .as_ref()
            .map_or_else(Vec::new, |step| step.lags.clone())
    }

    /// The step, with the contacts at positions `x`.
    pub(super) fn at(&mut self, x: &[f64]) -> &mut InStep {
        let step = self.step.as_mut().expect("a step has begun");
        if !step.is_evaluated || step.x != x {
            step.is_evaluated = true;
            step.x.clear();
            step.x.extend_from_slice(x);
            let places = match &step.points {
                None => x,
                Some(points) => {
                    points.place(x, &mut step.surface);
                    &step.surface
                }
            };
            let active = &mut step.state.active;
            active.update(self.geometry.as_ref(), &step.set, step.progress, places);
        }
        step
    }
}

impl InStep {
    pub(super) fn new(
        geometry: &mut dyn Contact,
        barrier: BarrierPotential,
        start: &StepStart<'_>,
    ) -> Self {
        let points = geometry.points().cloned().map(Arc::new);
        let x0 = SurfacePoints::placed(points.as_deref(), &start.state.x).into_owned();
        let bodies = BodyMotions::over(geometry, span(start));
        let progress = bodies.first_progress();
        let zeros = vec![0.0; x0.len()];
        let set = ContactSet::of(geometry, at_rest(&bodies, progress, &x0, &zeros));
        let active = ActiveContacts::at(geometry, &set, progress, &x0);
        Self {
            points,
            bodies,
            progress,
            set,
            end: x0.clone(),
            start: x0,
            ahead: active.clone(),
            state: ContactState {
                barrier,
                active,
                friction: LaggedFriction::none(),
            },
            x: Vec::new(),
            is_evaluated: false,
            surface: Vec::new(),
            forces: Vec::new(),
            friction_before: LaggedFriction::none(),
            friction_fault: None,
            velocity: EndVelocity::default(),
            start_work: 0.0,
            start_energy: 0.0,
            zeros,
            lags: Vec::new(),
            lagged_at: Vec::new(),
            lagged_bodies: Vec::new(),
            lagged_pairs: Vec::new(),
        }
    }

    /// Back to the start of a step; reuses memory.
    fn restart(&mut self, geometry: &mut dyn Contact, start: &StepStart<'_>) {
        match &self.points {
            None => self.start.copy_from_slice(&start.state.x),
            Some(points) => points.place(&start.state.x, &mut self.start),
        }
        self.bodies.update(geometry, span(start));
        self.progress = self.bodies.first_progress();
        let motion = at_rest(&self.bodies, self.progress, &self.start, &self.zeros);
        self.set.update(geometry, motion);
        self.forget();
    }

    /// Has the contacts evaluated anew when they are asked for.
    pub(super) fn forget(&mut self) {
        self.is_evaluated = false;
    }

    /// The points where the contacts were evaluated.
    pub(super) fn places(&self) -> &[f64] {
        match self.points {
            None => &self.x,
            Some(_) => &self.surface,
        }
    }

    /// The terms there.
    fn terms(&self) -> ContactTerms<'_> {
        ContactTerms::of(&self.state, self.places())
    }

    /// Asks `check` about laws of friction at the iterate, see [`LaggedFriction::check`].
    fn check_friction(
        &self,
        check: fn(&dyn FrictionLaw, f64) -> Result<(), FrictionError>,
    ) -> Result<(), FrictionError> {
        let ContactTerms {
            x,
            active,
            friction,
            ..
        } = self.terms();
        friction.check(x, active.bodies(), check)
    }

    /// Adds to `out` (`3V`) what `add` adds at the points.
    fn add_carried(&mut self, out: &mut [f64], add: impl FnOnce(&Self, &mut [f64])) {
        let Some(points) = &self.points else {
            return add(self, out);
        };
        let points = Arc::clone(points);
        let mut forces = std::mem::take(&mut self.forces);
        forces.clear();
        forces.resize(3 * points.count(), 0.0);
        add(self, &mut forces);
        points.add_forces(&forces, out);
        self.forces = forces;
    }

    /// Friction is lagged at the start.
    fn set_start(&mut self, geometry: &dyn Contact, start: &StepStart<'_>) {
        let laws = geometry.laws();
        self.friction_fault = None;
        self.lags.clear();
        self.velocity.update(laws, self.points.as_deref(), start);
        let ContactState {
            barrier,
            active,
            friction,
        } = &mut self.state;
        let course = self.velocity.course(&self.start);
        friction.lag(laws, barrier, active, course, &self.start);
        self.start_energy = active.barrier_energy(barrier);
        self.start_work = match self.bodies.any_moves() {
            true => active.barrier_work(barrier),
            false => 0.0,
        };
    }
}

pub(super) fn span(start: &StepStart<'_>) -> StepSpan {
    StepSpan {
        t0: start.state.t,
        h: start.span,
    }
}

/// No motion: bodies and sheet stay where they are.
pub(super) fn at_rest<'a>(
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

impl Term for ContactTerm {
    /// Refuses a span of time if the pose of a body is not finite at its start or end.
    fn check(&mut self, span: [f64; 2], _x: &[f64]) -> Result<(), StepError> {
        Ok(self.motions(StepSpan::between(span)).check()?)
    }

    /// Whether the bodies rest.
    fn rests(&mut self, span: [f64; 2]) -> bool {
        !self.motions(StepSpan::between(span)).any_moves()
    }

    /// Puts sheet and bodies where the step starts, and lags friction there.
    fn begin(&mut self, start: &StepStart<'_>) -> Result<(), StepError> {
        let geometry = self.geometry.as_mut();
        match &mut self.step {
            Some(step) => step.restart(geometry, start),
            None => self.step = Some(InStep::new(geometry, self.barrier, start)),
        }
        self.at(&start.state.x);
        if let Some(step) = &mut self.step {
            step.set_start(self.geometry.as_ref(), start);
        }
        Ok(())
    }

    fn value(&mut self, at: Iterate<'_>) -> Value {
        let step = self.at(at.x);
        if step.friction_fault.is_none() {
            step.friction_fault = step.check_friction(check_values).err();
        }
        Value::of(step.terms().energy())
    }

    fn add_gradient(&mut self, at: Iterate<'_>, scale: f64, out: &mut [f64]) {
        let step = self.at(at.x);
        step.add_carried(out, |step, out| step.terms().add_gradient(scale, out));
    }

    /// Each contact's own part is positive semidefinite.
    fn add_hessian(&mut self, at: Iterate<'_>, _part: HessianPart, sink: &mut dyn BlockSink) {
        let step = self.at(at.x);
        match &step.points {
            None => step.terms().add_hessian(sink),
            Some(points) => {
                CarriedSink::hand_on(points, sink, |sink| step.terms().add_hessian(sink));
            }
        }
    }

    fn append_couplings(&mut self, at: Iterate<'_>, out: &mut Vec<[u32; 2]>) {
        let (step, start) = (self.at(at.x), out.len());
        step.terms().append_couplings(out);
        if let Some(points) = &step.points {
            points.carry_couplings(out, start);
        }
    }

    fn barrier(&self) -> Option<Barrier> {
        Some(Barrier::Contact)
    }

    /// The bodies go on by the same part of the rest of their motions.
    fn safe_part(&mut self, at: Iterate<'_>, dx: &[f64]) -> f64 {
        let step = self.step.as_mut().expect("a step has begun");
        let points = step.points.as_deref();
        let motion = JointMotion {
            bodies: &step.bodies,
            progress: [step.progress, 1.0],
            x: &SurfacePoints::placed(points, at.x),
            dx: &SurfacePoints::placed(points, dx),
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
        let points = step.points.clone();
        let dx = SurfacePoints::placed(points.as_deref(), dx);
        let mut end = std::mem::take(&mut step.end);
        for ((end, x), d) in end.iter_mut().zip(step.places()).zip(dx.iter()) {
            *end = x + d;
        }
        step.end = end;
        let geometry = self.geometry.as_ref();
        step.ahead
            .update(geometry, &step.set, step.progress, &step.end);
        let mut any = false;
        step.add_carried(out, |step, out| {
            let ContactState {
                active, barrier, ..
            } = &step.state;
            any = active.add_gap_correction(&step.ahead, barrier, &dx, scale, out);
        });
        any
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

    /// By the motions of the bodies and of pins, such as the vertices of meshes in motion.
    fn add_drive(&mut self, at: Iterate<'_>, product: &mut HessianProduct<'_>) {
        let step = self.at(at.x);
        let scale = product.scale;
        if product.vector.iter().any(|c| *c != 0.0) {
            match &step.points {
                None => step.terms().add_hessian(product),
                Some(points) => CarriedSink::hand_on(points, product, |sink| {
                    step.terms().add_hessian(sink);
                }),
            }
        }
        step.add_carried(product.product, |step, out| {
            step.terms().add_drive(scale, out);
        });
    }

    /// Lags friction of the step anew where a normal force has changed by more than `settled`, relative to
    /// the largest. Otherwise friction remains that for which the iterate was found, and the forces of the
    /// step balance.
    fn renew(&mut self, at: Iterate<'_>, settled: Lagging) -> bool {
        self.at(at.x);
        let step = self.step.as_mut().expect("a step has begun");
        let ContactState {
            barrier,
            active,
            friction,
        } = &mut step.state;
        std::mem::swap(friction, &mut step.friction_before);
        let x = match step.points {
            None => &step.x,
            Some(_) => &step.surface,
        };
        let course = step.velocity.course(&step.start);
        friction.lag(self.geometry.laws(), barrier, active, course, x);
        let has_changed = friction.change_since(&step.friction_before) > settled.friction;
        match has_changed {
            true => step.lags.push(step.x.clone()),
            false => std::mem::swap(friction, &mut step.friction_before),
        }
        has_changed
    }

    fn contact_count(&self) -> usize {
        self.state().map_or(0, |state| state.active.list().len())
    }

    /// Work of the bodies (trapezoidal rule), friction, and the change of the energy of the barrier.
    fn finish(&mut self, start: &StepStart<'_>, at: Iterate<'_>) -> Result<Exchange, StepError> {
        self.at(at.x);
        let step = self.step.as_mut().expect("a step has begun");
        let gap = step.state.active.gap();
        if gap <= 0.0 || gap.is_nan() {
            return Err(StepError::Contact {
                t: start.state.t,
                h: start.span,
                gap,
            });
        }
        let mut settled = std::mem::take(&mut step.friction_before);
        let terms = step.terms();
        let bodies = terms.active.bodies();
        if let Err(error) = terms.friction.check(terms.x, bodies, check_values) {
            return Err(StepError::FrictionLaw {
                t: start.state.t,
                error: Box::new(error),
            });
        }
        let exchange = terms.exchange(step.start_work, step.start_energy);
        settled.lag(
            self.geometry.laws(),
            terms.barrier,
            terms.active,
            step.velocity.course(&step.start),
            terms.x,
        );
        let settled_friction = settled.loss(terms.x, terms.active.bodies());
        step.friction_before = settled;
        Ok(Exchange {
            settled_friction,
            ..exchange
        })
    }
}

/// Checks that contact can start at a state; with the bodies there.
///
/// # Errors
/// [`ContactError::Motion`] if the pose of a body is not finite, and as [`Contact::check_start`].
fn check_start(
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
