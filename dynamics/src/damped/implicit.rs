//! The damped methods: implicit Euler and BDF2 with the constraints in the step.

use crate::damped::minimiser::Minimiser;
use crate::damped::minimiser::problem::StepProblem;
use crate::options::OptionsError;
use crate::step::effort::SolverEffort;
use crate::step::integrator::{Attempt, Integrator, MethodTraits, Proposal, Scene, StepAccount};
use crate::step::report::StepError;
use crate::{SheetModel, State};
use isosheet_coords::linalg::LinalgError;
use serde::{Deserialize, Serialize};

/// Options of [`Method::ImplicitEuler`](crate::Method::ImplicitEuler) and
/// [`Method::Bdf2`](crate::Method::Bdf2).
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub struct ImplicitOptions {
    /// Penalty of the rods in the augmented Lagrangian, relative to the masses: rods are `stiffness` times as
    /// stiff as the inertia term. Default 1e4: where steps along the manifold fail, a hundred times more
    /// needs several times the Newton iterations, a hundred times less twice the projections.
    pub stiffness: f64,
    /// Newton's method stops when the decrease it still promises is this fraction of the
    /// inertia term of the incremental potential. Default 1e-4, far below the error of the
    /// method itself; the lengths do not depend on it.
    pub tolerance: f64,
    /// Largest relative edge length error of an accepted step. Default 1e-12. Round-off sets a floor of a
    /// few units in the last place of the coordinates.
    pub strain_tolerance: f64,
    /// Largest number of Newton iterations of one minimisation: of sequential quadratic programming (a
    /// quarter of this number in contact; the count begins anew after a renewal of friction or a perturbation
    /// of a saddle), or of one round of the augmented Lagrangian. Default 80.
    pub max_iterations: usize,
    /// Largest number of iterations of one restoration of the lengths. Default 400; sequential quadratic
    /// programming gives up after at most 20 of these.
    pub max_projections: usize,
    /// Largest change of a normal force of friction, relative to the largest normal force, between its last
    /// two evaluations in a step. Default 1e-3. With 1e-5 sheets that drape need a fifth more factorisations;
    /// with 0.05 they need as many as with 1e-3. Steps for which the augmented Lagrangian takes over may end
    /// with changes of up to 0.05 ([`StepOutcome`](crate::StepOutcome) names them).
    pub friction_tolerance: f64,
    /// How often an iteration that has converged goes on because friction exceeds its tolerance. Default 5;
    /// without friction it never does.
    pub max_friction_updates: usize,
    /// Seed of the perturbation that decides which way a sheet folds that sits on a saddle of
    /// the incremental potential. Default 0.
    pub seed: u64,
}

impl Default for ImplicitOptions {
    fn default() -> Self {
        Self {
            stiffness: 1e4,
            tolerance: 1e-4,
            strain_tolerance: 1e-12,
            max_iterations: 80,
            max_projections: 400,
            friction_tolerance: 1e-3,
            max_friction_updates: 5,
            seed: 0,
        }
    }
}

impl ImplicitOptions {
    /// # Errors
    /// [`OptionsError`] naming the option that makes no sense.
    pub fn validate(&self) -> Result<(), OptionsError> {
        OptionsError::check_range("stiffness", self.stiffness, 1.0, 1e8)?;
        OptionsError::check_range("tolerance", self.tolerance, 1e-14, 0.1)?;
        OptionsError::check_range("strain_tolerance", self.strain_tolerance, 1e-15, 1e-2)?;
        OptionsError::check_range("friction_tolerance", self.friction_tolerance, 1e-12, 1.0)?;
        OptionsError::check_count("max_iterations", self.max_iterations)?;
        OptionsError::check_count("max_projections", self.max_projections)
    }
}

/// Implicit Euler, see [`Method::ImplicitEuler`](crate::Method::ImplicitEuler).
pub(crate) struct ImplicitEuler {
    minimiser: Minimiser,
}

impl ImplicitEuler {
    /// Analyses the model.
    ///
    /// # Errors
    /// [`LinalgError::Symbolic`] if memory runs out.
    pub(crate) fn new(model: &SheetModel, options: ImplicitOptions) -> Result<Self, LinalgError> {
        Ok(Self {
            minimiser: Minimiser::new(model, options)?,
        })
    }
}

impl Integrator for ImplicitEuler {
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
        proposal.moment.history.previous = None;
        two_step(&mut self.minimiser, scene, attempt, None, proposal, effort)
    }
}

/// Largest growth of the step that the two-step formula is used over: variable-step BDF2 is
/// unstable from 1 + sqrt 2 on.
const MAX_STEP_RATIO: f64 = 2.0 + 1e-9;

/// The second-order backward differentiation formula, see [`Method::Bdf2`](crate::Method::Bdf2).
pub(crate) struct Bdf2 {
    minimiser: Minimiser,
}

impl Bdf2 {
    /// Analyses the model.
    ///
    /// # Errors
    /// [`LinalgError::Symbolic`] if memory runs out.
    pub(crate) fn new(model: &SheetModel, options: ImplicitOptions) -> Result<Self, LinalgError> {
        Ok(Self {
            minimiser: Minimiser::new(model, options)?,
        })
    }
}

impl Integrator for Bdf2 {
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
        let previous = attempt
            .previous()
            .filter(|before| h <= MAX_STEP_RATIO * (state.t - before.t));
        let damping = (-scene.model.damping() * h).exp();
        two_step(
            &mut self.minimiser,
            scene,
            attempt,
            previous,
            proposal,
            effort,
        )?;
        let history = &mut proposal.moment.history;
        history.set_previous(Some(state));
        // The damping that follows the step acts on the whole history, or a rate `gamma` would act as
        // `3/2 gamma`: `v1 = 4/3 v0 - 1/3 v_` amplifies what is taken from `v0` alone.
        if let Some(before) = &mut history.previous {
            before.v.iter_mut().for_each(|v| *v *= damping);
        }
        Ok(())
    }
}

/// Proposes the step of the two-step formula, or of implicit Euler where there is no state before the present
/// one.
fn two_step(
    minimiser: &mut Minimiser,
    scene: Scene<'_>,
    attempt: Attempt<'_>,
    previous: Option<&State>,
    proposal: &mut Proposal,
    effort: &mut SolverEffort<'_>,
) -> Result<(), StepError> {
    let (state, h) = (attempt.state, attempt.h);
    let w = previous.map_or(0.0, |before| h / (state.t - before.t));
    // a = 1 + b: differences keep pinned vertices where they are to the last bit.
    let b = w * w / (1.0 + 2.0 * w);
    let k = (1.0 + w) / (1.0 + 2.0 * w);
    let before = previous.unwrap_or(state);
    let model = scene.model;
    // The minimiser lends its arrays to the problem.
    let mut applied = std::mem::take(&mut minimiser.applied);
    let mut prediction = std::mem::take(&mut minimiser.prediction);
    model.applied_force(state.t, &state.x, &state.v, &mut applied);
    for i in 0..state.x.len() {
        let (x, v) = (state.x[i], state.v[i]);
        prediction[i] = x + b * (x - before.x[i]) + k * h * (v + b * (v - before.v[i]));
    }
    minimiser
        .recall(model, &attempt, k * h)
        .map_err(|source| StepError::Linalg { t: state.t, source })?;
    let problem = StepProblem {
        model,
        contact: scene.contact,
        state,
        span: h,
        h: k * h,
        prediction: &prediction,
        applied: &applied,
    };
    let outcome = minimiser.minimise(problem, effort);
    (minimiser.applied, minimiser.prediction) = (applied, prediction);
    let (minimum, contact) = outcome?;
    let moment = &mut proposal.moment;
    let mut work = 0.0;
    for i in 0..state.x.len() {
        let dx = minimiser.x()[i] - state.x[i];
        work += minimiser.applied[i] * dx;
        moment.state.v[i] = (dx - b * (state.x[i] - before.x[i])) / (k * h);
    }
    moment.state.x.copy_from_slice(minimiser.x());
    moment.state.t = state.t + h;
    moment.balance.copy_from(&minimiser.balance);
    moment.set_contacts(minimiser.contact_state());
    minimiser.remember(k * h, &mut moment.history);
    proposal.account = StepAccount {
        residual: minimum.residual,
        work,
        outcome: minimum.outcome,
        contact,
    };
    Ok(())
}
