//! Equilibria, see [`Method::Equilibrium`](crate::Method::Equilibrium).

use crate::contact::ContactTerm;
use crate::damped::minimiser::problem::StepProblem;
use crate::damped::minimiser::{Minimiser, Stability};
use crate::report::effort::SolverEffort;
use crate::report::step_report::StepOutcome;
use crate::step::accepted::{AcceptedStep, Recording, StepKind};
use crate::step::integrator::{
    Attempt, Integrator, MethodTraits, Phases, Proposal, Scene, StepAccount,
};
use crate::step::tuning::Tuning;
use crate::{ImplicitOptions, SheetModel, State};
use isosheet_linalg::LinalgError;
use isosheet_materials::potential::{Memories, Settled};
use isosheet_materials::vectors::{diameter, largest_norm};
use isosheet_model::NoEquilibrium;
use isosheet_model::StepError;
use isosheet_model::term::{Exchange, Formula, StepStart};

/// Part of the largest forces that is left of them in an equilibrium, and part of the energy that the last
/// step still changes.
const TOLERANCE: f64 = 1e-6;

/// Part of the energy below which a change of it is none, and part of the size of the sheet below which
/// it has not moved: a step of the scene may hardly change the loads.
const ENERGY_TOLERANCE: f64 = 1e-9;

/// Part of the mean edge by which the forces at the start move the sheet in the first step of a search.
const FIRST_PART: f64 = 0.1;

/// Growth of the step after one that took no more iterations than [`FEW`]. A step that fails is followed by
/// one that is shorter by the square of it.
const GROWTH: f64 = 4.0;

/// Iterations after which a step has not been too long.
const FEW: usize = 20;

/// How many times the first step the longest one is.
const LONGEST: f64 = 1e4;

/// How many times the first step the time is in which a disturbance of an equilibrium must not grow. (In ten
/// times that the round-off of the stiffness of faces hides what a motion without a force has.)
const STABLE: f64 = 1e3;

/// Part of the edges by which a state is disturbed that is not stable.
const DISTURBANCE: f64 = 1e-2;

/// Most steps of a search.
const STEPS: usize = 200;

/// Most steps of a search that failed, or ended where a disturbance grows. Elastic sheets need none to three.
const SETBACKS: usize = 20;

/// Displacement, in sizes of the sheet, from which nothing holds it.
const UNHELD: f64 = 100.0;

/// Finds equilibria by steps from rest that grow.
pub(crate) struct Equilibrium {
    minimiser: Minimiser,
}

/// Lengths of a step of a search, seconds.
#[derive(Clone, Copy)]
struct Lengths {
    /// The time that goes by: pins and bodies are driven in the first step, and rest in the others.
    span: f64,
    /// The effective step.
    h: f64,
    /// The first effective step of the search.
    first: f64,
}

impl Lengths {
    fn longest(self) -> f64 {
        LONGEST * self.first
    }
}

/// Where a search has come to.
struct Reached {
    state: State,
    memories: Memories,
    /// What happened on the way.
    exchange: Exchange,
    settled: Settled,
    /// The largest acceleration that forces would have given, m/s2.
    largest: f64,
    /// Sum of the sizes of the changes of the energy, joules.
    changed: f64,
    residual: f64,
    outcome: StepOutcome,
    /// The steps so far, where they are handed out.
    steps: Vec<AcceptedStep>,
}

impl Reached {
    /// At rest at the start of an attempt.
    fn start(attempt: &Attempt<'_>) -> Self {
        let start = attempt.state;
        Self {
            state: State {
                v: vec![0.0; start.v.len()],
                ..start.clone()
            },
            memories: attempt.memories.clone(),
            exchange: Exchange::default(),
            settled: Settled::default(),
            largest: 0.0,
            changed: 0.0,
            residual: 0.0,
            outcome: StepOutcome::Newton,
            steps: Vec::new(),
        }
    }
}

/// What a step of a search has found.
enum Found {
    /// A state with forces that are not balanced.
    Unbalanced,
    /// A state with balanced forces that a disturbance leaves.
    Unstable,
    /// An equilibrium, with the lowest frequency about it, hertz.
    Equilibrium(Option<f64>),
}

impl Equilibrium {
    /// Analyses the model.
    ///
    /// # Errors
    /// [`LinalgError::Symbolic`] if memory runs out.
    pub(crate) fn new(
        model: &SheetModel,
        options: ImplicitOptions,
        tuning: &Tuning,
    ) -> Result<Self, LinalgError> {
        let minimiser = Minimiser::new(model, options, tuning)?;
        Ok(Self { minimiser })
    }

    /// One step from rest.
    fn step(
        &mut self,
        scene: &mut Scene<'_>,
        lengths: Lengths,
        from: &mut Reached,
        recording: Recording,
        effort: &mut SolverEffort<'_>,
    ) -> Result<Found, StepError> {
        let Lengths { span, h, first } = lengths;
        let model = scene.model;
        let minimiser = &mut self.minimiser;
        // The minimiser lends its arrays to the problem.
        let [rest, mut prediction, mut ahead] = std::mem::take(&mut minimiser.start);
        let start = &from.state;
        prediction.copy_from_slice(&start.x);
        ahead.copy_from_slice(&start.x);
        model.place_pins(start.t + span, &mut ahead);
        let mut problem = StepProblem {
            model,
            memories: &from.memories,
            objective: &mut *scene.objective,
            start: StepStart {
                state: start,
                memories: &from.memories,
                before: None,
                span,
                sliding_time: first,
                h,
                formula: Formula::OneStep,
                back: 0.0,
                rest: &start.x,
                prediction: &prediction,
                ahead: &ahead,
            },
            phases: match span > 0.0 {
                true => Phases::All,
                false => Phases::Search,
            },
        };
        let outcome = minimiser.minimise(&mut problem, effort);
        let mut found = Found::Unbalanced;
        let outcome = outcome.map(|(minimum, exchange)| {
            let mut state = State {
                t: start.t + span,
                x: minimiser.x().to_vec(),
                v: start.v.clone(),
            };
            let mut steps = std::mem::take(&mut from.steps);
            if recording == Recording::On {
                let contact: Option<&ContactTerm> = problem.objective.get();
                let (rods, constraints) = minimiser.multipliers();
                steps.push(AcceptedStep {
                    kind: StepKind::Search,
                    start: start.clone(),
                    before: None,
                    end: state.clone(),
                    span,
                    sliding_time: first,
                    h,
                    back: 0.0,
                    memories: from.memories.clone(),
                    rods,
                    constraints,
                    lags: contact.map_or_else(Vec::new, ContactTerm::lags),
                    events: Vec::new(),
                });
            }
            let unbalanced = acceleration(model, &start.x, &state.x, h);
            // In steps that are shorter than the first one a disturbance seems to be a large force.
            let largest = match h >= first {
                true => from.largest.max(unbalanced),
                false => from.largest,
            };
            let mut memories = from.memories.clone();
            let Settled { dissipated, work } = model.settle(&state, &mut memories);
            // Slack and bends that have yielded follow after the step. What friction holds creeps, and may
            // rest at many places.
            let energy = |memories, x| model.energy_with(memories, state.t, x);
            let after = energy(&memories, &state.x);
            let change = after - energy(&from.memories, &start.x) + exchange.stored - exchange.work;
            let changed = from.changed + change.abs();
            // The residual is zero where the last iteration could gain no more than round-off.
            let stays = || distance(start, &state) <= ENERGY_TOLERANCE * diameter(&start.x);
            let is_none = change.abs() <= ENERGY_TOLERANCE * after.abs()
                || minimum.residual == 0.0 && stays();
            let is_balanced =
                unbalanced <= TOLERANCE * largest || is_none && h >= lengths.longest();
            let size = changed.max(after.abs());
            let has_settled =
                is_none || change.abs() <= TOLERANCE * size || exchange.friction > 0.0;
            if minimum.has_converged && is_balanced && has_settled {
                found = match minimiser.stability(&mut problem, STABLE * first, effort) {
                    Stability::Unstable => Found::Unstable,
                    Stability::Free => Found::Equilibrium(None),
                    Stability::Stable { frequency } => Found::Equilibrium(Some(frequency)),
                };
            }
            if matches!(found, Found::Unstable) {
                minimiser.disturb(&mut problem, DISTURBANCE);
                state.x.copy_from_slice(minimiser.x());
            }
            let mut sum = from.exchange;
            sum.add(exchange);
            Reached {
                state,
                memories,
                exchange: sum,
                settled: Settled {
                    dissipated: from.settled.dissipated + dissipated,
                    work: from.settled.work + work,
                },
                largest,
                changed,
                residual: minimum.residual,
                outcome: from.outcome.max(minimum.outcome),
                steps,
            }
        });
        minimiser.start = [rest, prediction, ahead];
        *from = outcome?;
        Ok(found)
    }
}

impl Integrator for Equilibrium {
    fn traits(&self) -> MethodTraits {
        MethodTraits::minimising()
    }

    fn propose(
        &mut self,
        mut scene: Scene<'_>,
        attempt: Attempt<'_>,
        proposal: &mut Proposal,
        effort: &mut SolverEffort<'_>,
    ) -> Result<(), StepError> {
        let (start, model) = (attempt.state, scene.model);
        // Here, before the search takes its time; and where it ends, as such a force may act there alone.
        let resting = State {
            t: start.t + attempt.h,
            v: vec![0.0; start.v.len()],
            ..start.clone()
        };
        check_forces(model, &resting)?;
        let first = first_step(model, &attempt);
        let mut lengths = Lengths {
            span: attempt.h,
            h: first,
            first,
        };
        self.minimiser
            .recall(model, &attempt, first)
            .map_err(|source| StepError::Linalg { t: start.t, source })?;
        let end = start.t + attempt.h;
        let is_driven = model.has_drives() || !scene.objective.rests([start.t, end]);
        let mut reached = Reached::start(&attempt);
        let mut setbacks = 0;
        let none = |why| StepError::NoEquilibrium { t: end, why };
        for _ in 0..STEPS {
            let before = effort.iterations;
            let found = match self.step(
                &mut scene,
                lengths,
                &mut reached,
                attempt.recording(),
                effort,
            ) {
                Ok(found) => found,
                // Of a step that moves pins or bodies a part may be easier, and no other length.
                Err(StepError::NotConverged { .. }) if lengths.span == 0.0 || !is_driven => {
                    setbacks += 1;
                    lengths.h /= GROWTH * GROWTH;
                    self.minimiser.forget();
                    if setbacks > SETBACKS {
                        return Err(none(NoEquilibrium::NotFound));
                    }
                    continue;
                }
                Err(error) => return Err(error),
            };
            check_held(start, &reached.state)?;
            lengths.span = 0.0;
            let next = match found {
                Found::Equilibrium(lowest_frequency) => {
                    check_forces(model, &reached.state)?;
                    self.propose_equilibrium(
                        &scene,
                        lengths.h,
                        reached,
                        lowest_frequency,
                        proposal,
                    );
                    return Ok(());
                }
                Found::Unstable => {
                    setbacks += 1;
                    STABLE * first
                }
                Found::Unbalanced => match effort.iterations - before {
                    few if few <= FEW => (GROWTH * lengths.h).min(lengths.longest()),
                    some if some <= 2 * FEW => lengths.h,
                    _ => lengths.h / GROWTH,
                },
            };
            if setbacks > SETBACKS {
                return Err(none(NoEquilibrium::Unstable));
            }
            self.minimiser.recall_last(next / lengths.h);
            lengths.h = next;
        }
        Err(none(NoEquilibrium::NotFound))
    }
}

impl Equilibrium {
    fn propose_equilibrium(
        &self,
        scene: &Scene<'_>,
        h: f64,
        reached: Reached,
        lowest_frequency: Option<f64>,
        proposal: &mut Proposal,
    ) {
        let motion = &mut proposal.motion;
        motion.state = reached.state;
        motion.memories = reached.memories;
        motion.history.previous = None;
        motion.history.body_changes.clear();
        motion.balance.copy_from(self.minimiser.balance());
        motion.set_contacts(scene.objective.get().and_then(ContactTerm::state));
        self.minimiser.remember(h, &mut motion.history);
        proposal.settled = Some(reached.settled);
        proposal.search = reached.steps;
        proposal.account = StepAccount {
            residual: reached.residual,
            outcome: reached.outcome,
            exchange: reached.exchange,
            damped: 0.0,
            error: None,
            lowest_frequency,
        };
    }
}

/// The acceleration that the forces which a step of `h` seconds from rest leaves would give, `|x1 - x0| /
/// h^2`, m/s2.
fn acceleration(model: &SheetModel, from: &[f64], to: &[f64], h: f64) -> f64 {
    root_mean_square(model, |i, _| to[i] - from[i]) / (h * h)
}

/// The root of the mean square over the mass of vectors of the vertices. `component` has the number of a
/// coordinate and the mass of its vertex.
fn root_mean_square(model: &SheetModel, component: impl Fn(usize, f64) -> f64) -> f64 {
    let masses = model.mass().row_sums(model.topology());
    let (mut squares, mut mass) = (0.0, 0.0);
    for (v, m) in masses.into_iter().enumerate() {
        squares += m * (0..3).map(|k| component(3 * v + k, m).powi(2)).sum::<f64>();
        mass += m;
    }
    (squares / mass).sqrt()
}

/// The time in which the forces at the start of a search move the sheet from rest by a part of an edge,
/// seconds:
///
/// ```text
/// h = sqrt(0.1 l / a),   a^2 = sum_i f_i^2 / m_i / sum_i m_i.
/// ```
///
/// It is no longer than the step of the simulation.
fn first_step(model: &SheetModel, attempt: &Attempt<'_>) -> f64 {
    let mut force = vec![0.0; attempt.state.x.len()];
    let end = attempt.state.t + attempt.h;
    model.acting_force(attempt.memories, end, &attempt.state.x, &mut force);
    let accelerations = |i: usize, m: f64| force[i] / m;
    let acceleration = root_mean_square(model, accelerations);
    let h = (FIRST_PART * model.mean_length() / acceleration).sqrt();
    h.min(attempt.h)
}

/// The largest displacement of a vertex from one state to another, metres.
fn distance(from: &State, to: &State) -> f64 {
    let moved: Vec<f64> = to.x.iter().zip(&from.x).map(|(b, a)| b - a).collect();
    largest_norm(&moved)
}

/// Refuses a search that leads away without an end.
fn check_held(start: &State, reached: &State) -> Result<(), StepError> {
    let distance = distance(start, reached);
    if distance <= UNHELD * diameter(&start.x) {
        return Ok(());
    }
    Err(StepError::NoEquilibrium {
        t: reached.t,
        why: NoEquilibrium::Unheld { distance },
    })
}

/// Refuses forces that depend on velocities and act at rest too, such as wind: they have no term in the
/// search.
fn check_forces(model: &SheetModel, state: &State) -> Result<(), StepError> {
    let mut forces = vec![0.0; state.x.len()];
    for force in model.implicit_forces() {
        force.add_force(state.t, &state.x, &state.v, &mut forces);
    }
    if forces.iter().all(|f| *f == 0.0) {
        return Ok(());
    }
    Err(StepError::NoEquilibrium {
        t: state.t,
        why: NoEquilibrium::Wind,
    })
}
