//! The damped methods: implicit Euler and BDF2 with the constraints in the step.

use crate::contact::ContactTerm;
use crate::damped::formula::StepFormula;
use crate::damped::minimiser::Minimiser;
use crate::damped::minimiser::problem::StepProblem;
use crate::damped::restitution::{FormulaStep, Outcome, handed_on};
use crate::damped::turning::Turning;
use crate::report::effort::SolverEffort;
use crate::step::accepted::{StepEvent, Taken};
use crate::step::integrator::{Attempt, Integrator, MethodTraits, Proposal, Scene, StepAccount};
use crate::step::local_error::LocalError;
use crate::step::tuning::Tuning;
use crate::{ImplicitOptions, SheetModel, State};
use isosheet_linalg::LinalgError;
use isosheet_model::StepError;
use isosheet_model::term::{Formula, StepStart};

/// Largest growth of the step that the two-step formula is used over: variable-step BDF2 is
/// unstable from 1 + sqrt 2 on.
const MAX_STEP_RATIO: f64 = 2.0 + 1e-9;

/// Implicit Euler and the second-order backward differentiation formula, see
/// [`Method::ImplicitEuler`](crate::Method::ImplicitEuler) and [`Method::Bdf2`](crate::Method::Bdf2).
pub(crate) struct Implicit {
    formula: Formula,
    minimiser: Minimiser,
    turning: Turning,
}

impl Implicit {
    /// Analyses the model.
    ///
    /// # Errors
    /// [`LinalgError::Symbolic`] if memory runs out.
    pub(crate) fn new(
        formula: Formula,
        model: &SheetModel,
        options: ImplicitOptions,
        tuning: &Tuning,
    ) -> Result<Self, LinalgError> {
        let minimiser = Minimiser::new(model, options, tuning)?;
        Ok(Self {
            formula,
            minimiser,
            turning: Turning::new(model),
        })
    }
}

impl Integrator for Implicit {
    fn traits(&self) -> MethodTraits {
        MethodTraits::minimising()
    }

    fn propose(
        &mut self,
        scene: Scene<'_>,
        attempt: Attempt<'_>,
        proposal: &mut Proposal,
        effort: &mut SolverEffort<'_>,
    ) -> Result<(), StepError> {
        let (state, h) = (attempt.state, attempt.h);
        let minimiser = (&mut self.minimiser, &self.turning);
        if self.formula == Formula::OneStep {
            proposal.motion.history.previous = None;
            proposal.motion.history.body_changes.clear();
            return minimised(minimiser, scene, attempt, Reach::NONE, proposal, effort);
        }
        let previous = attempt
            .previous()
            .filter(|before| h <= MAX_STEP_RATIO * (state.t - before.t));
        let Scene { model, objective } = scene;
        let inner = Scene {
            model,
            objective: &mut *objective,
        };
        let reach = previous.map_or(Reach::NONE, |before| Reach::of_steps(before, state, h));
        let formula = [reach.b, reach.k];
        let ends = previous.map(|before| [before, state]);
        let repeated = handed_on(model, ends, attempt.body_changes(), reach.b);
        let eased = repeated.before.as_ref().or(previous);
        let reach = Reach {
            before: eased,
            ..reach
        };
        minimised(minimiser, inner, attempt, reach, proposal, effort)?;
        if repeated.before.is_some() {
            let error = LocalError::of(model, previous, state, &proposal.motion.state);
            proposal.account.error = Some(error);
        }
        let points = objective.get().and_then(ContactTerm::points);
        let outcome = match (points, attempt.contacts, &proposal.motion.contacts) {
            (Some(points), Some(before), Some(after)) => FormulaStep {
                model,
                points,
                span: h,
                formula,
                before: eased.unwrap_or(state),
                start: state,
                end: &proposal.motion.state,
                contacts: [before, after],
            }
            .outcome(repeated.changes),
            _ => Outcome::default(),
        };
        let is_eased = repeated.before.is_some() || !outcome.corrections.is_empty();
        if let (Some(taken), true) = (&mut proposal.taken, is_eased) {
            taken.events.push(StepEvent::Restitution);
        }
        let history = &mut proposal.motion.history;
        history.set_previous(Some(state));
        if let Some(before) = &mut history.previous {
            for (v, change) in outcome.corrections {
                for k in 0..3 {
                    before.v[3 * v + k] += change[k];
                }
            }
        }
        history.body_changes = outcome.changes;
        Ok(())
    }
}

/// How a step makes positions and velocities of those before: with the state `_` before its start `0`,
///
/// ```text
/// x1 = x0 + b (x0 - x_) + k h v1,   v1 = v0 + b (v0 - v_) + k h a1.
/// ```
#[derive(Debug, Clone, Copy)]
struct Reach<'a> {
    before: Option<&'a State>,
    b: f64,
    k: f64,
}

impl<'a> Reach<'a> {
    /// Implicit Euler.
    const NONE: Self = Self {
        before: None,
        b: 0.0,
        k: 1.0,
    };

    /// The backward differentiation formula of second order, with steps of any lengths.
    fn of_steps(before: &'a State, start: &State, h: f64) -> Self {
        let w = h / (start.t - before.t);
        let [b, k] = [w * w, 1.0 + w].map(|c| c / (1.0 + 2.0 * w));
        let before = Some(before);
        Self { before, b, k }
    }
}

/// Proposes the step of a formula.
fn minimised(
    (minimiser, turning): (&mut Minimiser, &Turning),
    scene: Scene<'_>,
    attempt: Attempt<'_>,
    reach: Reach<'_>,
    proposal: &mut Proposal,
    effort: &mut SolverEffort<'_>,
) -> Result<(), StepError> {
    let (state, h) = (attempt.state, attempt.h);
    let Reach {
        before: previous,
        b,
        k,
    } = reach;
    let formula = previous.map_or(Formula::OneStep, |_| Formula::TwoStep);
    let model = scene.model;
    minimiser
        .recall(model, &attempt, k * h)
        .map_err(|source| StepError::Linalg { t: state.t, source })?;
    // The minimiser lends its arrays to the problem.
    let mut places = std::mem::take(&mut minimiser.start);
    let formula_of_step = StepFormula {
        start: state,
        before: previous,
        span: h,
        back: b,
        k,
    };
    let turned = formula_of_step.place(model, turning, &mut places);
    let [rest, prediction, ahead] = places;
    let start = StepStart {
        state,
        memories: attempt.memories,
        before: previous,
        span: h,
        sliding_time: h,
        h: k * h,
        formula,
        back: b,
        rest: &rest,
        prediction: &prediction,
        ahead: &ahead,
    };
    let mut problem = StepProblem {
        model,
        memories: attempt.memories,
        objective: scene.objective,
        start,
        phases: attempt.phases,
    };
    let outcome = minimiser.minimise(&mut problem, effort);
    minimiser.start = [rest, prediction, ahead];
    let (minimum, exchange) = outcome?;
    let motion = &mut proposal.motion;
    for i in 0..state.x.len() {
        let before = previous.unwrap_or(state);
        let dx = minimiser.x()[i] - state.x[i];
        motion.state.v[i] = (dx - b * (state.x[i] - before.x[i])) / (k * h);
    }
    for (i, change) in turned {
        motion.state.v[i] -= change / (k * h);
    }
    motion.state.x.copy_from_slice(minimiser.x());
    motion.state.t = state.t + h;
    motion.balance.copy_from(minimiser.balance());
    motion.set_contacts(scene.objective.get().and_then(ContactTerm::state));
    minimiser.remember(k * h, &mut motion.history);
    proposal.taken = attempt.is_recorded().then(|| {
        let contact: Option<&ContactTerm> = scene.objective.get();
        Box::new(Taken {
            before: previous.cloned(),
            span: h,
            h: k * h,
            back: b,
            lags: contact.map_or_else(Vec::new, ContactTerm::lags),
            events: Vec::new(),
        })
    });
    proposal.account = StepAccount {
        residual: minimum.residual,
        outcome: minimum.outcome,
        exchange,
        damped: model.damping_loss(&state.v, h),
        error: Some(LocalError::of(model, previous, state, &motion.state)),
        lowest_frequency: None,
    };
    Ok(())
}
