//! The chart-free engine: proposals of an integrator, judged and committed.

mod held;

use crate::contact::{Contact, ContactError, ContactState, ContactTerm, StepSpan, SurfacePoints};
use crate::damped::implicit::Implicit;
use crate::diagnosis::blocked::{blocked_vertices, dependent_vertices};
use crate::diagnosis::friction_law::check_at;
use crate::diagnosis::infeasibility::infeasibility;
use crate::diagnosis::potentials::{Differences, find_fault};
use crate::diagnosis::pressing::pressing;
use crate::diagnosis::rank::rod_rank;
use crate::engine::rod_forces::rod_forces;
use crate::engine::subdivision::Subdivision;
use crate::objective::Objective;
use crate::report::checkpoint_error::CheckpointError;
use crate::report::effort::SolverEffort;
use crate::report::step_report::StepOutcome;
use crate::report::totals::StepTotals;
use crate::step::accepted::{AcceptedStep, Recording, StepEvent, StepKind, Taken};
use crate::step::integrator::{
    Attempt, ContactSupport, Integrator, Memory, MethodTraits, Phases, Proposal, RodDemand, Scene,
};
use crate::step::motion::Motion;
use crate::step::reaction::Balance;
use crate::step::tuning::Tuning;
use crate::{
    Fallback, HandError, Method, SheetModel, SimulationError, State, StepControl, Unsatisfiable,
};
use isosheet_materials::potential::{At, Memories};
use isosheet_materials::{LimitError, Refused};
use isosheet_mesh::VertexId;
use isosheet_model::Infeasibility;
use isosheet_model::PotentialFault;
use isosheet_model::Pressing;
use isosheet_model::Reason;
use isosheet_model::StepError;
use isosheet_model::TraceEvent;
use isosheet_model::immobile_vertices;
use isosheet_model::term::{Exchange, Formula};
use isosheet_model::{Breaks, Start};
use serde::{Deserialize, Serialize};
use std::sync::Arc;

/// What a checkpoint keeps of a simulation without a chart.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub(crate) struct ByMethod {
    pub(crate) method: Method,
    pub(crate) control: StepControl,
    pub(crate) motion: Motion,
    /// Vertices that were pinned at the start because they cannot move.
    pub(crate) fixed: Vec<u32>,
}

/// Whether an engine takes steps.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Steps {
    Taken,
    /// It is asked for equations alone.
    None,
}

/// In the place of a method that minimises, where no steps are taken.
struct NoSteps;

impl Integrator for NoSteps {
    fn propose(
        &mut self,
        _scene: Scene<'_>,
        attempt: Attempt<'_>,
        _proposal: &mut Proposal,
        _effort: &mut SolverEffort<'_>,
    ) -> Result<(), StepError> {
        let refused = Refused {
            by: "a simulation of equations alone".into(),
            why: "it takes no steps".into(),
            remedy: Some("start it by `Simulation::new`"),
        };
        Err(StepError::Refused {
            t: attempt.state.t,
            refused: Box::new(refused),
        })
    }

    fn traits(&self) -> MethodTraits {
        MethodTraits::minimising()
    }
}

/// Sub-steps accepted after a refusal before a longer one is tried.
const PATIENCE: usize = 4;

/// A sheet that a chart-free method moves.
pub(crate) struct Engine {
    pub(crate) model: Arc<SheetModel>,
    /// What damped steps minimise, with the geometry of contact.
    objective: Objective,
    method: Method,
    /// When what is prescribed changes abruptly.
    pub(crate) breaks: Breaks,
    /// Vertices that became pins at the start because they cannot move.
    fixed: Vec<VertexId>,
    integrator: Box<dyn Integrator>,
    control: StepControl,
    tuning: Tuning,
    fallback: Option<Box<dyn Integrator>>,
    /// Where the sheet is. Nothing but [`Substeps::commit`] changes it in a step.
    motion: Motion,
    proposal: Proposal,
    /// Receives accepted sub-steps.
    recorder: Option<Box<StepSink>>,
}

/// Receives accepted sub-steps.
pub(crate) type StepSink = dyn FnMut(AcceptedStep) + Send;

impl Engine {
    /// Vertices that rods to pins at rest hold in place become pins.
    pub(crate) fn new(
        model: SheetModel,
        method: Method,
        state: State,
    ) -> Result<Self, SimulationError> {
        Self::started(model, method, state, Steps::Taken)
    }

    /// As [`Engine::new`], for the equations of its steps alone.
    pub(crate) fn of_equations(
        model: SheetModel,
        method: Method,
        state: State,
    ) -> Result<Self, SimulationError> {
        Self::started(model, method, state, Steps::None)
    }

    fn started(
        mut model: SheetModel,
        method: Method,
        mut state: State,
        steps: Steps,
    ) -> Result<Self, SimulationError> {
        let fixed = immobile_vertices(&model, &state.x);
        model.fix(&fixed);
        model.clear_velocities(&fixed, &mut state.v);
        model.set_load(&state);
        Self::with_fixed(model, method, state, fixed, steps)
    }

    fn with_fixed(
        model: SheetModel,
        method: Method,
        state: State,
        fixed: Vec<VertexId>,
        steps: Steps,
    ) -> Result<Self, SimulationError> {
        if model.has_limit() && !method.is_minimising() {
            return Err(SimulationError::Elastic);
        }
        if model.can_yield() && !method.is_minimising() {
            return Err(SimulationError::Plastic);
        }
        if model.needs_minimising() && !method.is_minimising() {
            return Err(SimulationError::NeedsMinimising);
        }
        let model = Arc::new(model);
        let tuning = Tuning::default();
        let integrator: Box<dyn Integrator> = match steps {
            Steps::Taken => method.build(&model, &tuning)?,
            Steps::None => Box::new(NoSteps),
        };
        let control = StepControl::default();
        let traits = integrator.traits();
        if traits.demand == RodDemand::Independent
            && let Some(index) = model.constraints().iter().position(|c| c.is_one_sided())
        {
            return Err(SimulationError::OneSided { index });
        }
        Ok(Self {
            motion: Motion::at(state, &model, traits.balance(&model)),
            proposal: Proposal::new(&model, traits),
            recorder: None,
            fallback: fallback(&model, &control, &tuning)?,
            integrator,
            control,
            tuning,
            objective: match method {
                Method::Equilibrium(_) => Objective::at_rest(&model),
                _ => Objective::new(&model),
            },
            breaks: model.breaks.clone(),
            method,
            fixed,
            model,
        })
    }

    /// What a checkpoint keeps.
    pub(crate) fn kept(&self) -> ByMethod {
        ByMethod {
            method: self.method.clone(),
            control: self.control.clone(),
            motion: self.motion.compact(),
            fixed: self.fixed.iter().map(|v| v.0).collect(),
        }
    }

    /// Goes on from a checkpoint.
    pub(crate) fn resume(
        mut model: SheetModel,
        contact: Option<Box<dyn Contact>>,
        kept: ByMethod,
    ) -> Result<Self, SimulationError> {
        let mut motion = kept.motion;
        let mut memories = model.memories();
        let taken = memories.take_over(&motion.memories);
        taken.map_err(CheckpointError::from)?;
        motion.memories = memories;
        motion.check(&model, &kept.fixed)?;
        let fixed: Vec<VertexId> = kept.fixed.iter().copied().map(VertexId).collect();
        model.fix(&fixed);
        model.set_load(&motion.state);
        motion.balance.check(&model)?;
        check_energy(&model, &motion.memories, &motion.state)?;
        let mut engine = Self::with_fixed(
            model,
            kept.method,
            motion.state.clone(),
            fixed,
            Steps::Taken,
        )?;
        engine.set_control(kept.control)?;
        engine.motion.copy_from(&motion);
        let barrier = motion.contacts.map(|contacts| contacts.barrier);
        match (contact, barrier) {
            (None, None) => {}
            (Some(contact), Some(barrier)) => {
                let state = &engine.motion.state;
                let term = ContactTerm::resume(contact, barrier, &engine.model, state)?;
                let contacts = engine.motion.contacts.as_mut();
                if contacts.is_some_and(|c| !c.friction.take_laws(term.laws())) {
                    return Err(CheckpointError::Friction.into());
                }
                engine.objective.set(term);
            }
            (_, barrier) => {
                let expected = barrier.is_some();
                return Err(CheckpointError::Contact { expected }.into());
            }
        }
        Ok(engine)
    }

    /// The contacts, if the scene has any.
    pub(crate) fn contacts(&self) -> Option<&ContactState> {
        self.motion.contacts.as_ref()
    }

    /// The points between which contact acts, where these are not the vertices.
    pub(crate) fn surface_points(&self) -> Option<&SurfacePoints> {
        self.objective.get().and_then(ContactTerm::points)
    }

    /// Forces of the rods in the last accepted sub-step; `None` where the method does not solve for them.
    pub(crate) fn rod_forces(&self) -> Option<Vec<f64>> {
        let Motion { state, history, .. } = &self.motion;
        rod_forces(&self.model, &self.method, &history.multipliers, &state.x)
    }

    /// Vertices that became pins at the start because they cannot move.
    pub(crate) fn immobile(&self) -> &[VertexId] {
        &self.fixed
    }

    pub(crate) fn state(&self) -> &State {
        &self.motion.state
    }

    /// What the potentials remember.
    pub(crate) fn memories(&self) -> &Memories {
        &self.motion.memories
    }

    /// Leads the hand that holds a vertex to a point (metres) until time `end`, seconds.
    pub(crate) fn lead_hand(
        &mut self,
        vertex: VertexId,
        to: [f64; 3],
        end: f64,
    ) -> Result<(), HandError> {
        let (number, hand) = self.model.hand(vertex)?;
        let Motion {
            state, memories, ..
        } = &mut self.motion;
        hand.lead(to, [state.t, end], memories.list_mut(number))
    }

    /// Forces of the supports in the last sub-step.
    pub(crate) fn balance(&self) -> Option<&Balance> {
        let Motion {
            balance, has_moved, ..
        } = &self.motion;
        has_moved.then_some(balance)
    }

    /// Adds contact.
    pub(crate) fn set_contact(&mut self, contact: Box<dyn Contact>) -> Result<(), SimulationError> {
        if self.integrator.traits().contact == ContactSupport::None {
            return Err(ContactError::Method.into());
        }
        let (term, contacts) = ContactTerm::new(contact, &self.model, &self.motion.state)?;
        self.objective.set(term);
        self.motion.contacts = Some(contacts);
        Ok(())
    }

    pub(crate) fn set_control(&mut self, control: StepControl) -> Result<(), SimulationError> {
        control.validate()?;
        if control.accuracy.is_some() && !self.method.is_minimising() {
            return Err(SimulationError::Accuracy);
        }
        self.fallback = fallback(&self.model, &control, &self.tuning)?;
        self.control = control;
        Ok(())
    }

    /// Hands accepted sub-steps to a sink from now on.
    pub(crate) fn set_recorder(&mut self, sink: Box<StepSink>) {
        self.recorder = Some(sink);
    }

    /// Model and objective.
    pub(crate) fn parts(&mut self) -> (&Arc<SheetModel>, &mut Objective) {
        (&self.model, &mut self.objective)
    }

    /// Advances by `h` seconds. On failure the state is that of the last committed sub-step.
    ///
    /// A step that something prescribed breaks ends a sub-step there ([`SheetModel::with_breaks`]).
    pub(crate) fn advance(&mut self, h: f64, totals: &mut StepTotals<'_>) -> Result<(), StepError> {
        let end = self.state().t + h;
        let mut left = h;
        loop {
            let t = self.state().t;
            let (start, next) = self.breaks.within([t, end], h);
            if start == Start::AtBreak {
                totals.work += self.begin_anew(h);
            }
            let Some(next) = next else {
                return self.advance_between(left, totals);
            };
            self.advance_between(next - t, totals)?;
            if totals.taut.is_some() {
                return Ok(());
            }
            left = end - self.state().t;
        }
    }

    /// Forgets the state before, and gives moving pins the velocities with which they go on (of functions by
    /// differences over a part of `h` seconds); what that does to the kinetic energy, joules.
    fn begin_anew(&mut self, h: f64) -> f64 {
        let (model, motion) = (&self.model, &mut self.motion);
        motion.history.previous = None;
        if model.moving_pins().next().is_none() {
            return 0.0;
        }
        let State { t, v, .. } = &mut motion.state;
        let before = model.kinetic_energy(v);
        model.set_pin_velocities(*t, h, v);
        model.kinetic_energy(v) - before
    }

    /// Advances by `h` seconds in which nothing breaks.
    fn advance_between(&mut self, h: f64, totals: &mut StepTotals<'_>) -> Result<(), StepError> {
        let mut lengths = Subdivision::new(self.state().t, h, PATIENCE);
        if let (Some(_), Some(longest)) = (self.control.accuracy, self.motion.history.longest) {
            lengths.limit(longest.max(lengths.part(self.control.min_fraction)));
        }
        let mut run = Substeps {
            limit: self.work_limit(self.state().t + h),
            engine: self,
            lengths,
            memory: Memory::All,
            proposer: Proposer::Method,
            exchange: Exchange::default(),
            totals,
        };
        run.totals.effort.begin(run.limit);
        while !run.lengths.is_finished() {
            let h = run.lengths.length();
            match run.take(h) {
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
        !self.model.rods().is_empty() && self.model.supported_vertex_count() > 1
    }

    /// By how much moving supports and bodies ask for more than the lengths or the limit of the strain allow
    /// until time `t`, if they do.
    fn infeasibility(&mut self, t: f64) -> Option<Infeasibility> {
        if self.surroundings_rest(t) {
            return None;
        }
        let Motion {
            state, contacts, ..
        } = &self.motion;
        let contact = self.objective.get_mut().zip(contacts.as_ref());
        infeasibility(&self.model, contact, state, t)
    }

    /// The body that presses the sheet most while it moves on until time `end`, seconds, if one does.
    fn pressing(&mut self, end: f64) -> Option<Pressing> {
        let t0 = self.state().t;
        let contact = self.objective.get_mut();
        let (contact, contacts) = contact.zip(self.motion.contacts.as_ref())?;
        pressing(contact, contacts, StepSpan { t0, h: end - t0 })
    }

    /// Whether supports and bodies rest until time `end`, seconds.
    fn surroundings_rest(&mut self, end: f64) -> bool {
        let span = [self.state().t, end];
        !self.model.has_drives() && self.objective.rests(span)
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
    /// The energy exchanged in the proposed sub-step.
    exchange: Exchange,
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

/// Why a step ends early.
enum Stop {
    /// At a taut state, as the step control allows.
    Taut(Infeasibility),
    Error(StepError),
}

impl Substeps<'_, '_> {
    /// Why no sub-step was found: supports or bodies that ask for too much, rods that lock or depend on each
    /// other, or as the integrator said.
    fn stop(&mut self, cause: StepError) -> Stop {
        if matches!(
            cause,
            StepError::NonFiniteForce { .. }
                | StepError::Potential { .. }
                | StepError::FrictionLaw { .. }
                | StepError::NoEquilibrium { .. }
        ) {
            return Stop::Error(cause);
        }
        if let Some(bad) = self.wrong_potential().or_else(|| self.wrong_friction()) {
            return Stop::Error(bad);
        }
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
        let known = self
            .locked()
            .or_else(|| self.engine.rank_deficient())
            .or_else(|| self.at_limit(&cause));
        Stop::Error(known.unwrap_or_else(|| StepError::StepTooSmall {
            t,
            min_step: self.lengths.part(self.engine.control.min_fraction),
            pressing: self.engine.pressing(self.lengths.end()).map(Box::new),
            cause: Box::new(cause),
        }))
    }

    /// The error of an elastic sheet that is stretched so near to its limit that the numbers of its barrier
    /// are too large for the arithmetic, if the linear algebra failed.
    fn at_limit(&self, cause: &StepError) -> Option<StepError> {
        let reason = Reason::LinearAlgebra;
        if !matches!(cause, StepError::NotConverged { reason: found, .. } if *found == reason) {
            return None;
        }
        let Engine { model, motion, .. } = &*self.engine;
        let State { t, x, .. } = &motion.state;
        let worst = model.elastic_sheet()?.worst(At::new(*t, x))?;
        // The barrier acts from half of the limit on, and grows without bound in its last hundredth.
        (worst.strain > 0.99 * worst.limit).then_some(StepError::AtStrainLimit {
            face: worst.face,
            strain: worst.strain,
            limit: worst.limit,
            t: *t,
        })
    }

    /// The error of a potential whose gradient is not the derivative of its energy, if there is one: no
    /// search can succeed with it.
    fn wrong_potential(&self) -> Option<StepError> {
        let Motion {
            state, memories, ..
        } = &self.engine.motion;
        let here = (state.t, &state.x[..]);
        let bad = find_fault(&self.engine.model, memories, here, Differences::Compare)
            .filter(|bad| matches!(bad.fault, PotentialFault::Gradient { .. }))?;
        Some(StepError::Potential {
            t: state.t,
            bad: Box::new(bad),
        })
    }

    /// The error of a law of friction from outside that is wrong at a contact, if there is one.
    fn wrong_friction(&self) -> Option<StepError> {
        let term: &ContactTerm = self.engine.objective.get()?;
        Some(StepError::FrictionLaw {
            t: self.engine.state().t,
            error: Box::new(term.friction_fault(check_at)?),
        })
    }

    /// The error of a sheet that may lock, if rods block its motion, or depend on each other while supports
    /// and bodies rest. (A sheet has to follow what moves: many steps are divided before it buckles.)
    fn locked(&mut self) -> Option<StepError> {
        if !self.engine.may_lock() {
            return None;
        }
        let rests = self.engine.surroundings_rest(self.lengths.end());
        let Engine { model, motion, .. } = &*self.engine;
        let state = &motion.state;
        let mut vertices = blocked_vertices(model, &motion.memories, state, self.lengths.length());
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
            objective,
            integrator,
            fallback,
            motion,
            proposal,
            control,
            recorder,
            ..
        } = &mut *self.engine;
        let t = motion.state.t + h;
        if let Some((support, value)) = model.find_bad_motion(t) {
            return Err(StepError::NonFiniteMotion { support, value, t });
        }
        objective.check([motion.state.t, t], &motion.state.x)?;
        let scene = Scene {
            model,
            objective: &mut *objective,
        };
        let recording = match recorder {
            Some(_) => Recording::On,
            None => Recording::Off,
        };
        let attempt = Attempt::new(motion, h, self.memory)
            .with(phases)
            .recorded(recording);
        let effort = &mut self.totals.effort;
        let is_fallback = self.proposer == Proposer::Fallback;
        effort.t = motion.state.t;
        let proposed = match fallback {
            Some(fallback) if is_fallback => fallback.propose(scene, attempt, proposal, effort),
            _ => integrator.propose(scene, attempt, proposal, effort),
        };
        if effort.is_interrupted() {
            return Err(StepError::Interrupted { t: motion.state.t });
        }
        proposed?;
        let (before, after) = (&motion.state, &proposal.motion.state);
        objective.check_end(before.t, &after.x)?;
        let mut exchange = proposal.account.exchange;
        if model.has_drives() {
            let kept = motion.has_moved.then_some(&motion.balance);
            let ends = ((before.t, &before.x[..]), (after.t, &after.x[..]));
            let balance = &proposal.motion.balance;
            let supports = balance.drive_work(model, kept, ends.0, ends.1);
            exchange.add(Exchange::driven(supports));
            exchange.work += model.applied_work_at_pins(before, after);
        }
        self.exchange = exchange;
        if let (Some(error), Some(accuracy)) = (proposal.account.error, control.accuracy)
            && error.size > accuracy
            && can_be_divided
            && !is_fallback
        {
            return Err(StepError::Inaccurate {
                t: before.t,
                h,
                error: error.size,
                accuracy,
            });
        }
        if let Some(settled) = proposal.settled {
            // Whatever energy an equilibrium has less than its start and what was given is lost on the way.
            let memories = [&motion.memories, &proposal.motion.memories];
            let ends = [before, after].map(|s| (s.t, &s.x[..]));
            let [first, last] =
                [0, 1].map(|i| model.energy_with(memories[i], ends[i].0, ends[i].1));
            let driven = match model.has_driven_potentials() {
                true => model.potential_work(memories[0], ends[0], ends[1]),
                false => 0.0,
            };
            let given = exchange.work + exchange.driven + driven + settled.work - exchange.stored;
            let lost = first + model.kinetic_energy(&before.v) + given
                - last
                - exchange.friction
                - settled.dissipated;
            check_energy(model, &proposal.motion.memories, after)?;
            proposal.account.damped = lost.max(0.0);
            proposal.motion.account = motion.account;
            return Ok(());
        }
        // The conservative methods keep the energy by themselves.
        let damps = integrator.traits().demand == RodDemand::Nothing || is_fallback;
        let account = match damps {
            true => {
                let potential =
                    [before, after].map(|s| model.energy_with(&motion.memories, after.t, &s.x));
                let force = || force_sum(model, &motion.memories, after);
                let exchange = Exchange {
                    work: exchange.work - proposal.account.damped,
                    ..exchange
                };
                motion
                    .account
                    .after(model, [before, after], potential, force, &exchange)?
            }
            false => {
                check_energy(model, &motion.memories, after)?;
                motion.account
            }
        };
        proposal.motion.account = account;
        Ok(())
    }

    /// What follows from a refusal that another sub-step may mend:
    ///
    /// | refused | with a history | without | by the fallback |
    /// |---|---|---|---|
    /// | since it would create energy | restart as a one-step method | halve | stop |
    /// | since it is not accurate enough | halve, remembering all | halve | |
    /// | for any other reason | halve | halve | stop |
    ///
    /// Where the step is not to be halved any more, the fallback takes it if there is one.
    fn follow(&mut self, refusal: StepError) -> Decision {
        let looks_back = self.memory > Memory::Restart && self.engine.motion.history.looks_back();
        let gains_energy = matches!(refusal, StepError::EnergyGain { .. });
        if self.proposer == Proposer::Fallback {
            Decision::Stop(self.stop(refusal))
        } else if gains_energy && looks_back {
            // Contact came or went, or rods snapped through: the history of the motion does not continue.
            Decision::Restart
        } else if let Some(shorter) = self.lengths.halve(self.engine.control.min_fraction) {
            if !matches!(refusal, StepError::Inaccurate { .. }) {
                self.memory = self.memory.min(Memory::State);
            }
            Decision::Shorten(shorter)
        } else if self.engine.fallback.is_some() {
            Decision::FallBack(self.lengths.lengthen())
        } else {
            Decision::Stop(self.stop(refusal))
        }
    }
}

/// What follows from a refusal.
enum Decision {
    /// The sub-step is proposed again without history.
    Restart,
    /// One of this length, seconds.
    Shorten(f64),
    /// One of this length, seconds, by the fallback.
    FallBack(f64),
    /// There is none.
    Stop(Stop),
}

impl Decision {
    /// Its name in a trace.
    fn name(&self) -> &'static str {
        match self {
            Self::Restart => "restart",
            Self::Shorten(_) => "shorten",
            Self::FallBack(_) => "fall back",
            Self::Stop(_) => "stop",
        }
    }
}

impl Substeps<'_, '_> {
    /// Takes a sub-step of at most `h` seconds.
    fn take(&mut self, mut h: f64) -> Result<(), Stop> {
        loop {
            let Err(refusal) = self.propose(h) else {
                self.commit(h);
                return Ok(());
            };
            match self.decide(refusal, h) {
                Decision::Restart => self.memory = Memory::Restart,
                Decision::Shorten(shorter) => h = shorter,
                Decision::FallBack(length) => {
                    h = length;
                    self.memory = Memory::Restart;
                    self.proposer = Proposer::Fallback;
                }
                Decision::Stop(stop) => return Err(stop),
            }
        }
    }

    /// Proposes a sub-step of `h` seconds; the state does not change. An attempt that the limit ends is made
    /// again without a limit, unless the sheet locks, or has nowhere to go: what is accepted does not depend
    /// on the effort.
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

    /// Decides what follows from the refusal of a sub-step of `h` seconds.
    fn decide(&mut self, refusal: StepError, h: f64) -> Decision {
        if matches!(
            refusal,
            StepError::NonFiniteMotion { .. }
                | StepError::Limit(LimitError::Swelling { .. })
                | StepError::Body(_)
                | StepError::Interrupted { .. }
                | StepError::Locked { .. }
                | StepError::NoEquilibrium { .. }
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

    /// Makes the proposal of `h` seconds the state.
    fn commit(&mut self, h: f64) {
        let engine = &mut *self.engine;
        let (step, exchange) = (engine.proposal.account, self.exchange);
        let settled = engine.proposal.settled.take();
        std::mem::swap(&mut engine.motion, &mut engine.proposal.motion);
        let (model, before, motion) = (&engine.model, &engine.proposal.motion, &mut engine.motion);
        motion.has_moved = true;
        if let (Some(error), Some(accuracy)) = (step.error, engine.control.accuracy) {
            let growth = if error.of_twice() <= accuracy {
                2.0
            } else {
                1.0
            };
            self.lengths.limit(growth * h);
            motion.history.longest = Some(growth * h);
        }
        // Free of accumulated round-off, for the pins in motion too.
        motion.state.t = self.lengths.advance();
        model.place_pins(motion.state.t, &mut motion.state.x);
        let totals = &mut *self.totals;
        if model.has_driven_potentials() {
            let ends = [&before.state, &motion.state].map(|s| (s.t, &s.x[..]));
            totals.work += model.potential_work(&before.memories, ends[0], ends[1]);
        }
        totals.substeps += 1;
        totals.residual = totals.residual.max(step.residual);
        totals.outcome = totals.outcome.max(step.outcome);
        totals.lowest_frequency = step.lowest_frequency;
        if let Some(error) = step.error {
            totals.error = Some(totals.error.unwrap_or(0.0).max(error.size));
        }
        totals.work += exchange.work + exchange.driven;
        totals.friction += exchange.friction;
        totals.dissipated += step.damped;
        motion.account.spend(step.damped);
        let settled = settled.unwrap_or_else(|| {
            motion.memories.copy_from(&before.memories);
            model.settle(&motion.state, &mut motion.memories)
        });
        totals.plastic += settled.dissipated;
        totals.work += settled.work;
        if let Some(recorder) = &mut engine.recorder {
            let taken = engine.proposal.taken.take();
            let taken = taken.map(|taken| accepted(*taken, before, motion, self.proposer));
            let search = std::mem::take(&mut engine.proposal.search);
            search.into_iter().chain(taken).for_each(recorder);
        }
        if self.proposer == Proposer::Fallback {
            // What the fallback remembers means nothing to the method that was asked for.
            motion.history.previous = None;
            motion.history.multipliers.clear();
            totals.outcome = totals.outcome.max(StepOutcome::Fallback);
        }
        let (t, factorisations) = (motion.state.t, totals.effort.spent());
        totals.effort.trace(|| TraceEvent::Accepted {
            t,
            h,
            factorisations,
        });
        totals.effort.begin(self.limit);
        (self.memory, self.proposer) = (Memory::All, Proposer::Method);
    }
}

/// An accepted sub-step between two points of a motion.
fn accepted(taken: Taken, before: &Motion, after: &Motion, proposer: Proposer) -> AcceptedStep {
    let mut events = taken.events;
    if proposer == Proposer::Fallback {
        events.push(StepEvent::Fallback);
    }
    AcceptedStep {
        kind: StepKind::Motion,
        start: before.state.clone(),
        before: taken.before,
        end: after.state.clone(),
        span: taken.span,
        sliding_time: taken.span,
        h: taken.h,
        back: taken.back,
        memories: before.memories.clone(),
        rods: after.history.multipliers.rods.clone(),
        constraints: after.history.multipliers.constraints.clone(),
        lags: taken.lags,
        events,
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
fn check_energy(model: &SheetModel, memories: &Memories, state: &State) -> Result<(), StepError> {
    let value = model.kinetic_energy(&state.v) + model.energy_with(memories, state.t, &state.x);
    if value.is_finite() {
        return Ok(());
    }
    Err(StepError::NonFiniteEnergy {
        quantity: "the energy",
        value,
        t: state.t,
    })
}

/// Sum of the magnitudes of the components of the conservative forces, newtons.
fn force_sum(model: &SheetModel, memories: &Memories, state: &State) -> f64 {
    let mut force = vec![0.0; state.x.len()];
    model.acting_force(memories, state.t, &state.x, &mut force);
    force.iter().map(|f| f.abs()).sum()
}

#[cfg(test)]
mod tests;
