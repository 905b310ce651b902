//! The chart-free engine: proposals of an integrator, judged and committed.

use crate::checkpoint::{CheckpointError, FreeMotion, check_length};
use crate::contact::{Contact, ContactError, ContactState, RunContact, StepSpan};
use crate::control::{Decision, Stepping, take_substep};
use crate::elastic_sheet::{ElasticSheet, strain_barrier_at_start};
use crate::energy_account::{EnergyAccount, Exchange};
use crate::feasibility::{Excess, excess};
use crate::history::History;
use crate::hold::Hold;
use crate::immobile::immobile_vertices;
use crate::implicit::ImplicitEuler;
use crate::integrator::{
    Attempt, ContactSupport, Integrator, Memory, Moment, Proposal, RodDemand, Scene,
};
use crate::minimiser::problem::StepEnd;
use crate::rank::rod_rank;
use crate::reaction::Balance;
use crate::report::{StepError, StepOutcome, StepTotals};
use crate::rod_forces::rod_forces;
use crate::subdivision::Subdivision;
use crate::{
    Fallback, Isometry, Method, SheetModel, SimulationError, State, StepControl, Unsatisfiable,
};
use isosheet_mesh::VertexId;

/// How many times [`StepControl::hold_after`] a step takes where supports move, before the sheet is held that
/// was not so before. A strip of paper that jams in a guide and buckles needs 700 factorisations in one step
/// with the default of 200, and is not to be held there.
const DRIVEN: usize = 5;

/// A sheet that a chart-free method moves.
pub(crate) struct Engine {
    pub(crate) model: SheetModel,
    contact: Option<RunContact>,
    method: Method,
    /// Vertices that became pins at the start because they cannot move.
    fixed: Vec<VertexId>,
    integrator: Box<dyn Integrator>,
    control: StepControl,
    fallback: Option<Box<dyn Integrator>>,
    /// Where the sheet is. Nothing but [`Substeps::commit`] changes it.
    moment: Moment,
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
        model.set_strain_barrier(strain_barrier_at_start(&model, &state));
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
        let integrator = method.build(&model)?;
        let control = StepControl::default();
        let traits = integrator.traits();
        if traits.demand == RodDemand::Independent
            && let Some(index) = model.constraints().iter().position(|c| c.is_one_sided())
        {
            return Err(SimulationError::OneSided { index });
        }
        Ok(Self {
            moment: Moment::at(state, &model, traits),
            proposal: Proposal::new(&model, traits),
            fallback: fallback(&model, &method, &control)?,
            integrator,
            control,
            contact: None,
            account: EnergyAccount::default(),
            has_moved: false,
            method,
            fixed,
            model,
        })
    }

    /// What a checkpoint keeps.
    pub(crate) fn motion(&self) -> FreeMotion {
        FreeMotion {
            method: self.method.clone(),
            control: self.control.clone(),
            moment: self.moment.compact(),
            account: self.account,
            has_moved: self.has_moved,
            fixed: self.fixed.iter().map(|v| v.0).collect(),
            barrier: self.contact.as_ref().map(RunContact::barrier),
            strain_barrier: self.model.elastic_sheet().map(ElasticSheet::barrier),
        }
    }

    /// Goes on from a checkpoint.
    pub(crate) fn resume(
        mut model: SheetModel,
        contact: Option<Box<dyn Contact>>,
        motion: FreeMotion,
    ) -> Result<Self, SimulationError> {
        check_lengths(&model, &motion)?;
        motion.check_numbers()?;
        let fixed: Vec<VertexId> = motion.fixed.iter().copied().map(VertexId).collect();
        model.fix(&fixed);
        model.set_strain_barrier(motion.strain_barrier.unwrap_or(0.0));
        motion.moment.balance.check(&model)?;
        check_energy(&model, &motion.moment.state)?;
        let state = motion.moment.state.clone();
        let mut engine = Self::with_fixed(model, motion.method, state, fixed)?;
        engine.set_control(motion.control)?;
        engine.moment.copy_from(&motion.moment);
        engine.account = motion.account;
        engine.has_moved = motion.has_moved;
        engine.contact = match (contact, motion.barrier) {
            (None, None) => None,
            (Some(contact), Some(barrier)) => {
                let state = &engine.moment.state;
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
        self.contact.as_ref().zip(self.moment.contacts.as_ref())
    }

    /// Forces of the rods in the last accepted sub-step; `None` where the method does not solve for them.
    pub(crate) fn rod_forces(&self) -> Option<Vec<f64>> {
        let Moment { state, history, .. } = &self.moment;
        rod_forces(&self.model, &self.method, &history.multipliers, &state.x)
    }

    /// Vertices that became pins at the start because they cannot move.
    pub(crate) fn immobile(&self) -> &[VertexId] {
        &self.fixed
    }

    pub(crate) fn state(&self) -> &State {
        &self.moment.state
    }

    /// Forces of the supports in the last sub-step.
    pub(crate) fn balance(&self) -> Option<&Balance> {
        self.has_moved.then_some(&self.moment.balance)
    }

    /// Adds contact.
    pub(crate) fn set_contact(&mut self, contact: Box<dyn Contact>) -> Result<(), SimulationError> {
        if self.integrator.traits().contact == ContactSupport::None {
            return Err(ContactError::Method.into());
        }
        let (contact, contacts) = RunContact::new(contact, &self.model, &self.moment.state)?;
        self.contact = Some(contact);
        self.moment.contacts = Some(contacts);
        self.moment.history.returning_step = 0.0;
        Ok(())
    }

    pub(crate) fn set_control(&mut self, control: StepControl) -> Result<(), SimulationError> {
        control.validate()?;
        self.fallback = fallback(&self.model, &self.method, &control)?;
        self.control = control;
        self.moment.history.returning_step = 0.0;
        Ok(())
    }

    /// Advances by `h` seconds. On failure the state is that of the last committed sub-step.
    pub(crate) fn advance(&mut self, h: f64, totals: &mut StepTotals<'_>) -> Result<(), StepError> {
        let lengths = Subdivision::new(self.state().t, h);
        // Only steps in which a sheet is held are known to return.
        let is_autonomous = self.may_hold() && self.is_autonomous(h);
        let proposer = if is_autonomous && self.moment.history.returning_step == h {
            Proposer::Fallback
        } else {
            Proposer::Method
        };
        let mut run = Substeps {
            engine: self,
            lengths,
            is_autonomous,
            memory: Memory::All,
            proposer,
            refused: None,
            pending: Pending::default(),
            totals,
        };
        while !run.lengths.is_finished() {
            let h = run.lengths.length();
            match take_substep(&mut run, h) {
                Ok(()) => (),
                Err(Stop::Taut(excess)) => {
                    run.totals.taut = Some(excess);
                    return Ok(());
                }
                Err(Stop::Error(error)) => return Err(error),
            }
        }
        Ok(())
    }

    /// Whether the last sub-step, whose start is the moment of the last proposal, ended where it started with
    /// the same history, so that the same sub-step would do so for ever.
    fn has_returned(&self) -> bool {
        let (start, end) = (&self.proposal.moment, &self.moment);
        let is_same_state = (&start.state.x, &start.state.v) == (&end.state.x, &end.state.v);
        let before = History {
            returning_step: end.history.returning_step,
            is_held: end.history.is_held,
            ..start.history.clone()
        };
        is_same_state && before == end.history
    }

    /// Whether the sheet is expected to lock where a sub-step of `h` seconds fails: where supports rest, or
    /// the sheet was held just before. Where supports move, the sheet has to follow, and most steps that
    /// fail need to be divided.
    fn may_lock(&self, h: f64) -> bool {
        let rests = || self.model.supports_rest(self.state(), self.state().t + h);
        self.may_hold() && (self.moment.history.is_held || rests())
    }

    /// Whether the fallback holds the sheet.
    fn may_hold(&self) -> bool {
        self.control.fallback == Fallback::Hold && self.fallback.is_some()
    }

    /// Whether a step of `h` seconds from here would be the same at another time.
    fn is_autonomous(&mut self, h: f64) -> bool {
        let t = self.state().t;
        let bodies_rest = |contact: &mut RunContact| contact.bodies_rest(StepSpan { t0: t, h });
        !self.model.has_forces()
            && !self.model.has_driven_potentials()
            && self.model.supports_rest(self.state(), t + h)
            && self.contact.as_mut().is_none_or(bodies_rest)
    }

    /// Why there is no sub-step: supports that ask for too much, dependent rods, or as the integrator said.
    fn stop(&self, lengths: &Subdivision, cause: StepError) -> Stop {
        let state = self.state();
        if self.model.has_drives()
            && self.model.isometry() == Isometry::Rods
            && let Some(excess) = excess(&self.model, state, lengths.end())
        {
            return match self.control.unsatisfiable {
                Unsatisfiable::StopTaut => Stop::Taut(excess),
                Unsatisfiable::Refuse => {
                    Stop::Error(StepError::Unsatisfiable { t: state.t, excess })
                }
            };
        }
        let rank = match self.model.isometry() {
            Isometry::Rods => rod_rank(&self.model, &state.x),
            Isometry::Elastic | Isometry::Weak => None,
        };
        let dependent = rank.filter(|rank| rank.nearly_dependent > 0);
        if self.integrator.traits().demand == RodDemand::Independent
            && let Some(rank) = &dependent
        {
            return Stop::Error(StepError::RankDeficient {
                t: state.t,
                rank_deficiency: rank.deficiency,
                smallest_singular_value: rank.smallest,
            });
        }
        Stop::Error(StepError::StepTooSmall {
            t: state.t,
            min_step: lengths.part(self.control.min_fraction),
            dependent_rods: dependent.map_or(0, |rank| rank.nearly_dependent),
            cause: Box::new(cause),
        })
    }
}

/// The sub-steps of one step.
struct Substeps<'a, 'w> {
    engine: &'a mut Engine,
    lengths: Subdivision,
    /// Whether the sheet may be held and the step would be the same at another time.
    is_autonomous: bool,
    /// What of the history the next proposal begins with.
    memory: Memory,
    proposer: Proposer,
    /// The sub-step that the method refused before the fallback was asked, and why.
    refused: Option<(Subdivision, StepError)>,
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
    Taut(Excess),
    Error(StepError),
}

impl Substeps<'_, '_> {
    /// Where a sub-step of `h` seconds may end.
    fn step_end(&self, h: f64) -> StepEnd {
        if self.engine.may_lock(h) {
            let after = self.engine.control.hold_after;
            StepEnd::Descent { after }
        } else {
            StepEnd::Minimum
        }
    }

    /// Number of factorisations in the step from which the sheet is held if a sub-step of `h` seconds is
    /// refused.
    fn holds_from(&self, h: f64) -> usize {
        let after = self.engine.control.hold_after;
        if self.engine.may_lock(h) {
            after
        } else {
            after.saturating_mul(DRIVEN)
        }
    }

    /// Goes on with the method and a shorter sub-step where the fallback has none.
    fn resume_method(&mut self) -> Decision<Stop> {
        self.proposer = Proposer::Method;
        let Some((lengths, refusal)) = self.refused.take() else {
            return Decision::Shorten(self.lengths.length());
        };
        self.lengths = lengths;
        match self.lengths.halve(self.engine.control.min_fraction) {
            Some(shorter) => Decision::Shorten(shorter),
            None => Decision::Stop(self.engine.stop(&self.lengths, refusal)),
        }
    }
}

impl Stepping for Substeps<'_, '_> {
    type Refusal = StepError;
    type Error = Stop;
    type Report = ();

    fn propose(&mut self, h: f64) -> Result<(), StepError> {
        let end = self.step_end(h);
        let Engine {
            model,
            contact,
            integrator,
            fallback,
            moment,
            account,
            has_moved,
            proposal,
            ..
        } = &mut *self.engine;
        let t = moment.state.t + h;
        if let Some((support, value)) = model.find_bad_motion(t) {
            return Err(StepError::NonFiniteMotion { support, value, t });
        }
        if let Some(contact) = contact {
            contact.check_bodies(StepSpan {
                t0: moment.state.t,
                h,
            })?;
        }
        let scene = Scene {
            model,
            contact: contact.as_mut().map(RunContact::step),
        };
        let attempt = Attempt::new(moment, h, self.memory).ending_at(end);
        let effort = &mut self.totals.effort;
        let is_fallback = self.proposer == Proposer::Fallback;
        effort.t = moment.state.t;
        let proposed = match fallback {
            Some(fallback) if is_fallback => fallback.propose(scene, attempt, proposal, effort),
            _ => integrator.propose(scene, attempt, proposal, effort),
        };
        if effort.is_interrupted() {
            return Err(StepError::Interrupted { t: moment.state.t });
        }
        proposed?;
        let (before, after) = (&moment.state, &proposal.moment.state);
        let step = &proposal.account;
        let mut exchange = Exchange {
            forces: step.work,
            bodies: step.contact.bodies,
            barrier: step.contact.stored,
            length_slack: step.contact.length_slack,
            ..Exchange::default()
        };
        if model.has_drives() {
            // The forces of a held step are those of an impact, and their work is known with them alone.
            let is_held = step.outcome == StepOutcome::Held;
            let kept = (*has_moved && !is_held).then_some(&moment.balance);
            let ends = ((before.t, &before.x[..]), (after.t, &after.x[..]));
            let balance = &proposal.moment.balance;
            exchange.supports = balance.drive_work(model, kept, ends.0, ends.1);
        }
        self.pending = Pending {
            account: *account,
            exchange,
        };
        // The conservative methods keep the energy by themselves, and the fallback is the last resort.
        if integrator.traits().demand == RodDemand::Nothing && !is_fallback {
            self.pending.account = account.after(model, before, after, &exchange)?;
            return Ok(());
        }
        check_energy(model, after)
    }

    fn decide(&mut self, refusal: StepError, h: f64) -> Decision<Stop> {
        if matches!(
            refusal,
            StepError::NonFiniteMotion { .. } | StepError::Body(_) | StepError::Interrupted { .. }
        ) {
            return Decision::Stop(Stop::Error(refusal));
        }
        self.totals.rejected += 1;
        let looks_back = self.memory > Memory::Restart && self.engine.moment.history.looks_back();
        let gains_energy = matches!(refusal, StepError::EnergyGain { .. });
        // What a locked sheet lacks is a motion, and not a shorter step.
        let lacks_motion = gains_energy || matches!(refusal, StepError::NotConverged { .. });
        let is_spent = self.totals.effort.factorisations >= self.holds_from(h);
        let is_locked = lacks_motion && is_spent && self.engine.may_hold();
        let smallest = self.engine.control.min_fraction;
        if self.proposer == Proposer::Fallback {
            self.resume_method()
        } else if gains_energy && looks_back {
            // Contact came or went, or rods snapped through: the history of the motion does not continue.
            Decision::Restart
        } else if !is_locked && let Some(shorter) = self.lengths.halve(smallest) {
            self.memory = self.memory.min(Memory::State);
            Decision::Shorten(shorter)
        } else if self.engine.fallback.is_some() {
            self.refused = Some((self.lengths.clone(), refusal));
            Decision::FallBack(self.lengths.lengthen())
        } else {
            Decision::Stop(self.engine.stop(&self.lengths, refusal))
        }
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
        let is_whole = self.lengths.is_whole();
        if step.outcome == StepOutcome::Descended {
            self.totals.dissipated += self.pending.account.loss_since(&engine.account);
        }
        std::mem::swap(&mut engine.moment, &mut engine.proposal.moment);
        engine.account = self.pending.account;
        engine.has_moved = true;
        // The end of the step is set by the caller, free of accumulated round-off.
        engine.moment.state.t = self.lengths.advance();
        if step.outcome == StepOutcome::Descended {
            // The sheet starts anew from there: refusals before say nothing of the rest of the step.
            self.lengths.lengthen();
        }
        let totals = &mut *self.totals;
        if engine.model.has_driven_potentials() {
            let (before, after) = (&engine.proposal.moment.state, &engine.moment.state);
            let ends = ((before.t, &before.x[..]), (after.t, &after.x[..]));
            totals.work += engine.model.potential_work(ends.0, ends.1);
        }
        totals.substeps += 1;
        totals.residual = totals.residual.max(step.residual);
        totals.outcome = totals.outcome.max(step.outcome);
        totals.work += exchange.forces + exchange.supports + exchange.bodies;
        totals.friction += step.contact.friction;
        let dissipated = damp(&engine.model, &mut engine.moment.state, h);
        totals.dissipated += dissipated;
        engine.account.spend(dissipated);
        if self.proposer == Proposer::Fallback {
            // What the fallback remembers means nothing to the method that was asked for.
            engine.moment.history.previous = None;
            engine.moment.history.multipliers.clear();
            totals.outcome = totals.outcome.max(StepOutcome::Fallback);
        }
        totals.dissipated += step.impact;
        engine.account.spend(step.impact);
        let is_held = step.outcome == StepOutcome::Held;
        let returns = is_held && is_whole && self.is_autonomous && engine.has_returned();
        engine.moment.history.is_held = is_held;
        engine.moment.history.returning_step = if returns { h } else { 0.0 };
        (self.memory, self.proposer) = (Memory::All, Proposer::Method);
        self.refused = None;
        Ok(())
    }
}

/// The fallback of a step control, for a sheet that a method moves.
///
/// Only methods that minimise hold sheets: the conservative ones would lose the energy that they are there to
/// keep, and the projection step divides steps of sheets that do not lock, too. Only rods lock, and only at
/// clamps and at taut lines between supports, which take supports at two vertices.
fn fallback(
    model: &SheetModel,
    method: &Method,
    control: &StepControl,
) -> Result<Option<Box<dyn Integrator>>, SimulationError> {
    Ok(match (&control.fallback, method) {
        (Fallback::ImplicitEuler(o), _) => Some(Box::new(ImplicitEuler::new(model, o.clone())?)),
        (Fallback::Hold, Method::Bdf2(o) | Method::ImplicitEuler(o))
            if model.isometry() == Isometry::Rods && model.supported_vertex_count() > 1 =>
        {
            Some(Box::new(Hold::new(model, o.strain_tolerance)))
        }
        (Fallback::Hold | Fallback::Refuse, _) => None,
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
fn check_lengths(model: &SheetModel, motion: &FreeMotion) -> Result<(), CheckpointError> {
    let (n, m, k) = (
        model.coordinate_count(),
        model.isometry_rows().len(),
        model.constraints().len(),
    );
    let Moment { state, history, .. } = &motion.moment;
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
