//! The chart-free engine: proposals of an integrator, judged and committed.

use crate::contact::{Contact, ContactError, ContactState, RunContact, StepSpan};
use crate::damped::air_step::Formula;
use crate::damped::implicit::Implicit;
use crate::linear::rank::rod_rank;
use crate::material::elastic_sheet::ElasticSheet;
use crate::model::immobile::immobile_vertices;
use crate::model::load_scale::LoadScale;
use crate::step::blocked::{blocked_vertices, dependent_vertices};
use crate::step::checkpoint_error::{CheckpointError, check_length};
use crate::step::control::{Decision, Stepping, take_substep};
use crate::step::energy_account::{EnergyAccount, Exchange};
use crate::step::free_state::FreeState;
use crate::step::infeasibility::{Infeasibility, infeasibility};
use crate::step::integrator::{
    Attempt, ContactSupport, Integrator, Memory, Phases, Proposal, RodDemand, Scene, SolverState,
};
use crate::step::pressing::{Pressing, pressing};
use crate::step::reaction::Balance;
use crate::step::report::{StepError, StepOutcome, StepTotals};
use crate::step::rod_forces::rod_forces;
use crate::step::subdivision::Subdivision;
use crate::step::trace::TraceEvent;
use crate::step::tuning::Tuning;
use crate::{
    Fallback, Isometry, Method, SheetModel, SimulationError, State, StepControl, Unsatisfiable,
};
use isosheet_mesh::VertexId;

/// A sheet that a chart-free method moves.
pub(crate) struct Engine {
    pub(crate) model: SheetModel,
    contact: Option<RunContact>,
    method: Method,
    /// Vertices that became pins at the start because they cannot move.
    fixed: Vec<VertexId>,
    integrator: Box<dyn Integrator>,
    control: StepControl,
    tuning: Tuning,
    fallback: Option<Box<dyn Integrator>>,
    /// Where the sheet is. Nothing but [`Substeps::commit`] changes it.
    solver: SolverState,
    account: EnergyAccount,
    /// Steps taken since the start.
    has_moved: bool,
    proposal: Proposal,
}

impl Engine {
    /// Vertices that rods to pins at rest hold in place become pins.
    pub(crate) fn new(
        mut model: SheetModel,
        method: Method,
        mut state: State,
    ) -> Result<Self, SimulationError> {
        let fixed = immobile_vertices(&model, &state.x);
        model.fix(&fixed);
        model.clear_velocities(&fixed, &mut state.v);
        let acceleration = LoadScale::at(&model, &state).acceleration;
        model.set_strain_barrier(&state, acceleration, None);
        Self::with_fixed(model, method, state, fixed)
    }

    fn with_fixed(
        model: SheetModel,
        method: Method,
        state: State,
        fixed: Vec<VertexId>,
    ) -> Result<Self, SimulationError> {
        if model.isometry() != Isometry::Rods && !method.is_minimising() {
            return Err(SimulationError::Elastic);
        }
        if model.can_yield() && !method.is_minimising() {
            return Err(SimulationError::Plastic);
        }
        let tuning = Tuning::default();
        let integrator = method.build(&model, &tuning)?;
        let control = StepControl::default();
        let traits = integrator.traits();
        if traits.demand == RodDemand::Independent
            && let Some(index) = model.constraints().iter().position(|c| c.is_one_sided())
        {
            return Err(SimulationError::OneSided { index });
        }
        Ok(Self {
            solver: SolverState::at(state, &model, traits),
            proposal: Proposal::new(&model, traits),
            fallback: fallback(&model, &control, &tuning)?,
            integrator,
            control,
            tuning,
            contact: None,
            account: EnergyAccount::default(),
            has_moved: false,
            method,
            fixed,
            model,
        })
    }

    /// What a checkpoint keeps.
    pub(crate) fn motion(&self) -> FreeState {
        FreeState {
            method: self.method.clone(),
            control: self.control.clone(),
            solver: self.solver.compact(),
            account: self.account,
            has_moved: self.has_moved,
            fixed: self.fixed.iter().map(|v| v.0).collect(),
            barrier: self.contact.as_ref().map(RunContact::barrier),
            strain_barrier: self.model.elastic_sheet().map(ElasticSheet::barrier),
            memories: self.model.memories(),
        }
    }

    /// Goes on from a checkpoint.
    pub(crate) fn resume(
        mut model: SheetModel,
        contact: Option<Box<dyn Contact>>,
        motion: FreeState,
    ) -> Result<Self, SimulationError> {
        check_lengths(&model, &motion)?;
        motion.check_numbers()?;
        model.set_memories(&motion.memories);
        let fixed: Vec<VertexId> = motion.fixed.iter().copied().map(VertexId).collect();
        model.fix(&fixed);
        let start = &motion.solver.state;
        let acceleration = LoadScale::at(&model, start).acceleration;
        model.set_strain_barrier(start, acceleration, motion.strain_barrier);
        motion.solver.balance.check(&model)?;
        check_energy(&model, &motion.solver.state)?;
        let state = motion.solver.state.clone();
        let mut engine = Self::with_fixed(model, motion.method, state, fixed)?;
        engine.set_control(motion.control)?;
        engine.solver.copy_from(&motion.solver);
        engine.account = motion.account;
        engine.has_moved = motion.has_moved;
        engine.contact = match (contact, motion.barrier) {
            (None, None) => None,
            (Some(contact), Some(barrier)) => {
                let state = &engine.solver.state;
                Some(RunContact::resume(contact, barrier, &engine.model, state)?)
            }
            (_, barrier) => {
                let expected = barrier.is_some();
                return Err(CheckpointError::Contact { expected }.into());
            }
        };
        Ok(engine)
    }

    /// Contact, if the scene has any.
    pub(crate) fn contact(&self) -> Option<(&RunContact, &ContactState)> {
        self.contact.as_ref().zip(self.solver.contacts.as_ref())
    }

    /// Forces of the rods in the last accepted sub-step; `None` where the method does not solve for them.
    pub(crate) fn rod_forces(&self) -> Option<Vec<f64>> {
        let SolverState { state, history, .. } = &self.solver;
        rod_forces(&self.model, &self.method, &history.multipliers, &state.x)
    }

    /// Vertices that became pins at the start because they cannot move.
    pub(crate) fn immobile(&self) -> &[VertexId] {
        &self.fixed
    }

    pub(crate) fn state(&self) -> &State {
        &self.solver.state
    }

    /// Forces of the supports in the last sub-step.
    pub(crate) fn balance(&self) -> Option<&Balance> {
        self.has_moved.then_some(&self.solver.balance)
    }

    /// Adds contact.
    pub(crate) fn set_contact(&mut self, contact: Box<dyn Contact>) -> Result<(), SimulationError> {
        if self.integrator.traits().contact == ContactSupport::None {
            return Err(ContactError::Method.into());
        }
        let (contact, contacts) = RunContact::new(contact, &self.model, &self.solver.state)?;
        self.contact = Some(contact);
        self.solver.contacts = Some(contacts);
        Ok(())
    }

    pub(crate) fn set_control(&mut self, control: StepControl) -> Result<(), SimulationError> {
        control.validate()?;
        self.fallback = fallback(&self.model, &control, &self.tuning)?;
        self.control = control;
        Ok(())
    }

    /// Replaces the constants of the damped methods.
    pub(crate) fn set_tuning(&mut self, tuning: Tuning) -> Result<(), SimulationError> {
        self.tuning = tuning;
        self.integrator = self.method.build(&self.model, &tuning)?;
        self.fallback = fallback(&self.model, &self.control, &tuning)?;
        Ok(())
    }

    /// Advances by `h` seconds. On failure the state is that of the last committed sub-step.
    pub(crate) fn advance(&mut self, h: f64, totals: &mut StepTotals<'_>) -> Result<(), StepError> {
        let lengths = Subdivision::new(self.state().t, h, self.tuning.patience as usize);
        let mut run = Substeps {
            limit: self.work_limit(self.state().t + h),
            engine: self,
            lengths,
            memory: Memory::All,
            proposer: Proposer::Method,
            pending: Pending::default(),
            totals,
        };
        run.totals.effort.begin(run.limit);
        while !run.lengths.is_finished() {
            let h = run.lengths.length();
            match take_substep(&mut run, h) {
                Ok(()) => (),
                Err(Stop::Taut(infeasibility)) => {
                    run.totals.taut = Some(infeasibility);
                    return Ok(());
                }
                Err(Stop::Error(error)) => return Err(error),
            }
        }
        Ok(())
    }

    /// Largest number of factorisations from an accepted state to the next until time `end`, for sheets that
    /// may lock, or be moved where they cannot go, by methods that take dependent rods.
    fn work_limit(&mut self, end: f64) -> Option<usize> {
        let is_limited = self.integrator.traits().demand == RodDemand::Nothing
            && (self.may_lock() || !self.surroundings_rest(end));
        is_limited.then_some(self.control.max_factorisations)
    }

    /// Whether the sheet has rods, and supports at two vertices or more.
    fn may_lock(&self) -> bool {
        self.model.isometry() == Isometry::Rods && self.model.supported_vertex_count() > 1
    }

    /// By how much moving supports and bodies ask for more than the lengths or the limit of the strain allow
    /// until time `t`, if they do.
    fn infeasibility(&mut self, t: f64) -> Option<Infeasibility> {
        if self.surroundings_rest(t) {
            return None;
        }
        let SolverState {
            state, contacts, ..
        } = &self.solver;
        let contact = self.contact.as_mut().zip(contacts.as_ref());
        infeasibility(&self.model, contact, state, t)
    }

    /// The body that presses the sheet most while it moves on until time `end`, seconds, if one does.
    fn pressing(&mut self, end: f64) -> Option<Pressing> {
        let t0 = self.state().t;
        let (contact, contacts) = self.contact.as_mut().zip(self.solver.contacts.as_ref())?;
        pressing(contact, contacts, StepSpan { t0, h: end - t0 })
    }

    /// Whether supports and bodies rest until time `end`, seconds.
    fn surroundings_rest(&mut self, end: f64) -> bool {
        let t0 = self.state().t;
        let span = StepSpan { t0, h: end - t0 };
        let contact = self.contact.as_mut();
        !self.model.has_drives() && contact.is_none_or(|contact| contact.bodies_rest(span))
    }

    /// The error of dependent rods, if there are any and the method needs independent ones.
    fn rank_deficient(&self) -> Option<StepError> {
        if self.integrator.traits().demand != RodDemand::Independent {
            return None;
        }
        let State { t, x, .. } = self.state();
        let rank = rod_rank(&self.model, x).filter(|rank| rank.nearly_dependent > 0)?;
        Some(StepError::RankDeficient {
            t: *t,
            rank_deficiency: rank.deficiency,
            smallest_singular_value: rank.smallest,
        })
    }
}

/// The sub-steps of one step.
struct Substeps<'a, 'w> {
    engine: &'a mut Engine,
    lengths: Subdivision,
    /// Largest number of factorisations from an accepted state to the next, if there is one.
    limit: Option<usize>,
    /// What of the history the next proposal begins with.
    memory: Memory,
    proposer: Proposer,
    pending: Pending,
    totals: &'a mut StepTotals<'w>,
}

/// Who proposes.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Proposer {
    /// The method that was asked for.
    Method,
    /// The fallback of the step control.
    Fallback,
}

/// What the energy accounts will be once the proposal is committed.
#[derive(Debug, Clone, Copy, Default)]
struct Pending {
    account: EnergyAccount,
    exchange: Exchange,
}

/// Why a step ends early.
enum Stop {
    /// At a taut state, as the step control allows.
    Taut(Infeasibility),
    Error(StepError),
}

impl Substeps<'_, '_> {
    /// Why no sub-step was found: supports or bodies that ask for too much, rods that lock or depend on each other, or
    /// as the integrator said.
    fn stop(&mut self, cause: StepError) -> Stop {
        let t = self.engine.state().t;
        let ends = [self.lengths.end(), t + self.lengths.length()];
        let mut infeasible = ends
            .into_iter()
            .filter_map(|end| self.engine.infeasibility(end));
        if let Some(infeasibility) = infeasible.next() {
            return match self.engine.control.unsatisfiable {
                Unsatisfiable::StopTaut => Stop::Taut(infeasibility),
                Unsatisfiable::Refuse => Stop::Error(StepError::Unsatisfiable {
                    t,
                    infeasibility: Box::new(infeasibility),
                }),
            };
        }
        let known = self.locked().or_else(|| self.engine.rank_deficient());
        Stop::Error(known.unwrap_or_else(|| StepError::StepTooSmall {
            t,
            min_step: self.lengths.part(self.engine.control.min_fraction),
            pressing: self.engine.pressing(self.lengths.end()).map(Box::new),
            cause: Box::new(cause),
        }))
    }

    /// The error of a sheet that may lock, if rods block its motion, or depend on each other while supports
    /// and bodies rest. (A sheet has to follow what moves: many steps are divided before it buckles.)
    fn locked(&mut self) -> Option<StepError> {
        if !self.engine.may_lock() {
            return None;
        }
        let rests = self.engine.surroundings_rest(self.lengths.end());
        let Engine { model, solver, .. } = &*self.engine;
        let state = &solver.state;
        let mut vertices = blocked_vertices(model, state, self.lengths.length());
        if vertices.is_empty() && rests {
            vertices = dependent_vertices(model, &state.x);
        }
        (!vertices.is_empty()).then(|| StepError::Locked {
            t: state.t,
            factorisations: self.totals.effort.spent(),
            vertices,
        })
    }

    /// Proposes a sub-step of `h` seconds within the limit of the effort.
    fn attempt(&mut self, h: f64) -> Result<(), StepError> {
        // A sheet has to follow bodies and supports that move, and buckles under them in shorter steps too.
        let can_be_divided = self.lengths.can_halve(self.engine.control.min_fraction);
        let phases = match self.lengths.is_whole() && can_be_divided {
            true if self.engine.surroundings_rest(self.lengths.end()) => Phases::Brief,
            _ => Phases::All,
        };
        let Engine {
            model,
            contact,
            integrator,
            fallback,
            solver,
            account,
            has_moved,
            proposal,
            tuning,
            ..
        } = &mut *self.engine;
        let t = solver.state.t + h;
        if let Some((support, value)) = model.find_bad_motion(t) {
            return Err(StepError::NonFiniteMotion { support, value, t });
        }
        if let Some(contact) = contact {
            contact.check_bodies(StepSpan {
                t0: solver.state.t,
                h,
            })?;
        }
        let scene = Scene {
            model,
            contact: contact.as_mut().map(RunContact::step),
        };
        let attempt = Attempt::new(solver, h, self.memory).with(phases);
        let effort = &mut self.totals.effort;
        let is_fallback = self.proposer == Proposer::Fallback;
        effort.t = solver.state.t;
        let proposed = match fallback {
            Some(fallback) if is_fallback => fallback.propose(scene, attempt, proposal, effort),
            _ => integrator.propose(scene, attempt, proposal, effort),
        };
        if effort.is_interrupted() {
            return Err(StepError::Interrupted { t: solver.state.t });
        }
        proposed?;
        let (before, after) = (&solver.state, &proposal.solver.state);
        let step = &proposal.account;
        let mut exchange = Exchange {
            forces: step.work,
            air: step.air,
            bodies: step.contact.bodies,
            friction: step.contact.friction,
            settled_friction: step.contact.settled_friction,
            barrier: step.contact.stored,
            length_slack: step.contact.length_slack,
            ..Exchange::default()
        };
        if model.has_drives() {
            let kept = has_moved.then_some(&solver.balance);
            let ends = ((before.t, &before.x[..]), (after.t, &after.x[..]));
            let balance = &proposal.solver.balance;
            exchange.supports = balance.drive_work(model, kept, ends.0, ends.1);
            exchange.forces += model.applied_work_at_pins(before, after);
        }
        self.pending = Pending {
            account: *account,
            exchange,
        };
        // The conservative methods keep the energy by themselves.
        if integrator.traits().demand == RodDemand::Nothing || is_fallback {
            self.pending.account = account.after(model, before, after, &exchange, tuning)?;
            return Ok(());
        }
        check_energy(model, after)
    }

    /// What follows from a refusal that another sub-step may mend:
    ///
    /// | refused | with a history | without | by the fallback |
    /// |---|---|---|---|
    /// | since it would create energy | restart as a one-step method | halve | stop |
    /// | for any other reason | halve | halve | stop |
    ///
    /// Where the step is not to be halved any more, the fallback takes it if there is one.
    fn follow(&mut self, refusal: StepError) -> Decision<Stop> {
        let looks_back = self.memory > Memory::Restart && self.engine.solver.history.looks_back();
        let gains_energy = matches!(refusal, StepError::EnergyGain { .. });
        if self.proposer == Proposer::Fallback {
            Decision::Stop(self.stop(refusal))
        } else if gains_energy && looks_back {
            // Contact came or went, or rods snapped through: the history of the motion does not continue.
            Decision::Restart
        } else if let Some(shorter) = self.lengths.halve(self.engine.control.min_fraction) {
            self.memory = self.memory.min(Memory::State);
            Decision::Shorten(shorter)
        } else if self.engine.fallback.is_some() {
            Decision::FallBack(self.lengths.lengthen())
        } else {
            Decision::Stop(self.stop(refusal))
        }
    }
}

impl Stepping for Substeps<'_, '_> {
    type Refusal = StepError;
    type Error = Stop;
    type Report = ();

    /// An attempt that the limit ends is made again without a limit, unless the sheet locks, or has nowhere to
    /// go: what is accepted does not depend on the effort.
    fn propose(&mut self, h: f64) -> Result<(), StepError> {
        let proposed = self.attempt(h);
        if !self.totals.effort.is_spent() {
            return proposed;
        }
        if self
            .engine
            .infeasibility(self.engine.state().t + h)
            .is_some()
        {
            self.totals.effort.begin(self.limit);
            return proposed;
        }
        if self.engine.infeasibility(self.lengths.end()).is_none()
            && let Some(error) = self.locked()
        {
            return Err(error);
        }
        self.totals.effort.lift_limit();
        self.attempt(h)
    }

    fn decide(&mut self, refusal: StepError, h: f64) -> Decision<Stop> {
        if matches!(
            refusal,
            StepError::NonFiniteMotion { .. }
                | StepError::Body(_)
                | StepError::Interrupted { .. }
                | StepError::Locked { .. }
        ) {
            return Decision::Stop(Stop::Error(refusal));
        }
        self.totals.rejected += 1;
        let error = self.totals.effort.is_traced().then(|| refusal.to_string());
        let decision = self.follow(refusal);
        if let Some(error) = error {
            let (t, decision) = (self.engine.state().t, decision.name());
            let event = || TraceEvent::Refused {
                t,
                h,
                error,
                decision,
            };
            self.totals.effort.trace(event);
        }
        decision
    }

    fn restart(&mut self) -> Result<(), Stop> {
        self.memory = Memory::Restart;
        Ok(())
    }

    fn fall_back(&mut self) {
        self.memory = Memory::Restart;
        self.proposer = Proposer::Fallback;
    }

    fn commit(&mut self, h: f64) -> Result<(), Stop> {
        let engine = &mut *self.engine;
        let (step, exchange) = (engine.proposal.account, self.pending.exchange);
        std::mem::swap(&mut engine.solver, &mut engine.proposal.solver);
        engine.account = self.pending.account;
        engine.has_moved = true;
        // Free of accumulated round-off, for the pins in motion too.
        let state = &mut engine.solver.state;
        state.t = self.lengths.advance();
        engine.model.place_pins(state.t, &mut state.x);
        let totals = &mut *self.totals;
        if engine.model.has_driven_potentials() {
            let (before, after) = (&engine.proposal.solver.state, &engine.solver.state);
            let ends = ((before.t, &before.x[..]), (after.t, &after.x[..]));
            totals.work += engine.model.potential_work(ends.0, ends.1);
        }
        let State { t, x, .. } = &engine.solver.state;
        totals.plastic += engine.model.settle(*t, x);
        totals.substeps += 1;
        totals.residual = totals.residual.max(step.residual);
        totals.outcome = totals.outcome.max(step.outcome);
        totals.work += exchange.forces + exchange.air + exchange.supports + exchange.bodies;
        totals.friction += step.contact.friction;
        let dissipated = damp(&engine.model, &mut engine.solver.state, h);
        totals.dissipated += dissipated;
        engine.account.spend(dissipated);
        totals.work += engine.model.raise_strain_barrier(&engine.solver.state);
        if self.proposer == Proposer::Fallback {
            // What the fallback remembers means nothing to the method that was asked for.
            engine.solver.history.previous = None;
            engine.solver.history.multipliers.clear();
            totals.outcome = totals.outcome.max(StepOutcome::Fallback);
        }
        let (t, factorisations) = (engine.solver.state.t, totals.effort.spent());
        totals.effort.trace(|| TraceEvent::Accepted {
            t,
            h,
            factorisations,
        });
        totals.effort.begin(self.limit);
        (self.memory, self.proposer) = (Memory::All, Proposer::Method);
        Ok(())
    }
}

/// The fallback of a step control.
fn fallback(
    model: &SheetModel,
    control: &StepControl,
    tuning: &Tuning,
) -> Result<Option<Box<dyn Integrator>>, SimulationError> {
    Ok(match &control.fallback {
        Fallback::ImplicitEuler(o) => {
            let formula = Formula::OneStep;
            Some(Box::new(Implicit::new(formula, model, o.clone(), tuning)?))
        }
        Fallback::Refuse => None,
    })
}

/// Refuses a state whose energy is not finite.
fn check_energy(model: &SheetModel, state: &State) -> Result<(), StepError> {
    let value = model.kinetic_energy(&state.v) + model.potential_energy(state.t, &state.x);
    if value.is_finite() {
        return Ok(());
    }
    Err(StepError::NonFiniteEnergy {
        quantity: "the energy",
        value,
        t: state.t,
    })
}

/// Refuses arrays of the wrong length.
fn check_lengths(model: &SheetModel, motion: &FreeState) -> Result<(), CheckpointError> {
    let (n, m, k) = (
        model.coordinate_count(),
        model.rods().len(),
        model.constraints().len(),
    );
    let SolverState { state, history, .. } = &motion.solver;
    let previous = history.previous.as_ref().unwrap_or(state);
    let multipliers = &history.multipliers;
    let optional = |length: usize, expected: usize| if length == 0 { expected } else { length };
    let vertices = model.topology().vertex_count();
    let largest = history
        .couplings
        .iter()
        .flatten()
        .chain(&motion.fixed)
        .max();
    let memories = model.memories();
    check_length(
        "the list of potentials that yield",
        motion.memories.len(),
        memories.len(),
    )?;
    for (found, expected) in motion.memories.iter().zip(&memories) {
        check_length(
            "the list of plastic deformations",
            found.len(),
            expected.len(),
        )?;
    }
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
    match largest {
        Some(&v) if v as usize >= vertices => Err(CheckpointError::NoSuchVertex {
            vertex: v,
            vertices,
        }),
        _ => Ok(()),
    }
}

/// Applies velocity damping over a step; returns the energy taken out.
fn damp(model: &SheetModel, state: &mut State, h: f64) -> f64 {
    if model.damping() == 0.0 {
        return 0.0;
    }
    let before = model.kinetic_energy(&state.v);
    let factor = (-model.damping() * h).exp();
    state.v.iter_mut().for_each(|v| *v *= factor);
    before * (1.0 - factor * factor)
}

#[cfg(test)]
mod tests;
