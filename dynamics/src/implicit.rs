//! The damped methods: implicit Euler and BDF2 with the constraints in the step.

use crate::contact::ContactState;
use crate::integrator::{Integrator, OptionsError, RodDemand, Scene};
use crate::minimiser::Minimiser;
use crate::reaction::Balance;
use crate::report::{Accepted, Effort, StepError};
use crate::{SheetModel, State};
use isosheet_coords::linalg::LinalgError;

/// Options of [`ImplicitEuler`] and [`Bdf2`].
#[derive(Debug, Clone, PartialEq)]
pub struct ImplicitOptions {
    /// Penalty of the rods in the augmented Lagrangian, relative to the masses: rods are
    /// `stiffness` times as stiff as the inertia term. Default 1e4: where steps along the manifold fail, a hundred times
    /// more needs several times the Newton iterations, a hundred times less twice the projections.
    pub stiffness: f64,
    /// Newton's method stops when the decrease it still promises is this fraction of the
    /// inertia term of the incremental potential. Default 1e-4, far below the error of the
    /// method itself; the lengths do not depend on it.
    pub tolerance: f64,
    /// Largest relative edge length error of an accepted step. Default 1e-12. Round-off sets a
    /// floor of a few units in the last place of the coordinates.
    pub strain_tolerance: f64,
    /// Most Newton iterations in a step. Default 80.
    pub max_iterations: usize,
    /// Most iterations of the projection onto the lengths. Default 400.
    pub max_projections: usize,
    /// Most renewals of friction's normal forces within a step, beyond the ones at its start. Default 2;
    /// without friction there are none.
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
            max_friction_updates: 2,
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
        OptionsError::check_count("max_iterations", self.max_iterations)?;
        OptionsError::check_count("max_projections", self.max_projections)
    }
}

/// Implicit Euler, `M (v1 - v0) = h f(x1) + G(x1)^T L, x1 = x0 + h v1, c(x1) = 0`.
///
/// Equivalently `x1` minimises the incremental potential `|x - x0 - h v0|_M^2 / 2 + h^2 V(x)`
/// over all positions with the rest lengths, which is how it is found: by sequential quadratic programming along
/// the manifold of rest lengths, and where that fails by an augmented Lagrangian, minimised by Newton's method with line search (without
/// contact, fine sheets and slivers the other way round); then a projection that makes the lengths exact. Non-conservative forces are taken at the start of the step.
///
/// First order, strongly dissipative, stable at any step. A sheet that starts exactly flat
/// needs no special treatment.
pub struct ImplicitEuler {
    minimiser: Minimiser,
}

impl ImplicitEuler {
    /// Analyses the model.
    ///
    /// # Errors
    /// [`LinalgError::Symbolic`] if memory runs out.
    pub fn new(model: &SheetModel, options: ImplicitOptions) -> Result<Self, LinalgError> {
        Ok(Self {
            minimiser: Minimiser::new(model, options)?,
        })
    }
}

impl Integrator for ImplicitEuler {
    fn demand(&self) -> RodDemand {
        RodDemand::Nothing
    }

    fn takes_contact(&self) -> bool {
        true
    }

    fn balance(&self) -> &Balance {
        &self.minimiser.balance
    }

    fn contact_state(&self) -> Option<&ContactState> {
        self.minimiser.contact_state()
    }

    fn step(
        &mut self,
        scene: Scene<'_>,
        state: &mut State,
        h: f64,
        effort: &mut Effort,
    ) -> Result<Accepted, StepError> {
        let m = &mut self.minimiser;
        scene
            .model
            .applied_force(state.t, &state.x, &state.v, &mut m.applied);
        for i in 0..m.x().len() {
            m.target[i] = state.x[i] + h * state.v[i];
        }
        let (residual, path, contact) = m.minimise(scene, state, h, h, effort)?;
        let mut work = 0.0;
        for i in 0..m.x().len() {
            let dx = m.x()[i] - state.x[i];
            work += m.applied[i] * dx;
            state.v[i] = dx / h;
        }
        state.x.copy_from_slice(m.x());
        state.t += h;
        Ok(Accepted {
            residual,
            work,
            driven: 0.0,
            path,
            contact,
        })
    }
}

/// Largest growth of the step that the two-step formula is used over: variable-step BDF2 is
/// unstable from 1 + sqrt 2 on.
const MAX_STEP_RATIO: f64 = 2.0 + 1e-9;

/// The second-order backward differentiation formula, with the ratio `w = h / h_previous`:
///
/// ```text
/// x1 = a x0 - b x_ + k h v1,   M v1 = M (a v0 - b v_) + k h f(x1) + G(x1)^T L,   c(x1) = 0,
/// a = (1 + w)^2 / (1 + 2w),  b = w^2 / (1 + 2w),  k = (1 + w) / (1 + 2w)
/// ```
///
/// (`x_`, `v_` one step before `x0`, `v0`). The same minimisation as [`ImplicitEuler`] with the
/// effective step `k h`, at the same price, but second order and far less dissipative: it
/// keeps the motions that the step resolves and damps the ones that it does not. The first
/// step, the first after the state was changed from outside, and one that is more than twice as
/// long as the one before are implicit Euler (`w = 0`).
/// Non-conservative forces are taken at the start of the step, which makes them first order.
pub struct Bdf2 {
    minimiser: Minimiser,
    previous: State,
    last: State,
}

impl Bdf2 {
    /// Analyses the model.
    ///
    /// # Errors
    /// [`LinalgError::Symbolic`] if memory runs out.
    pub fn new(model: &SheetModel, options: ImplicitOptions) -> Result<Self, LinalgError> {
        let nowhere = State {
            t: f64::NAN,
            ..State::at_rest(vec![0.0; model.coordinate_count()])
        };
        Ok(Self {
            minimiser: Minimiser::new(model, options)?,
            previous: nowhere.clone(),
            last: nowhere,
        })
    }
}

impl Integrator for Bdf2 {
    fn demand(&self) -> RodDemand {
        RodDemand::Nothing
    }

    fn restart(&mut self) -> bool {
        let has_history = self.previous.t.is_finite();
        self.previous.t = f64::NAN;
        has_history
    }

    fn takes_contact(&self) -> bool {
        true
    }

    fn balance(&self) -> &Balance {
        &self.minimiser.balance
    }

    fn contact_state(&self) -> Option<&ContactState> {
        self.minimiser.contact_state()
    }

    fn step(
        &mut self,
        scene: Scene<'_>,
        state: &mut State,
        h: f64,
        effort: &mut Effort,
    ) -> Result<Accepted, StepError> {
        // Velocity damping after the steps changes `v` but not `x`.
        let continued = self.last.x == state.x && self.previous.t < state.t;
        let w = if continued {
            h / (state.t - self.previous.t)
        } else {
            0.0
        };
        let w = if w <= MAX_STEP_RATIO { w } else { 0.0 };
        // a = 1 + b: differences keep pinned vertices where they are to the last bit.
        let b = w * w / (1.0 + 2.0 * w);
        let k = (1.0 + w) / (1.0 + 2.0 * w);
        let m = &mut self.minimiser;
        scene
            .model
            .applied_force(state.t, &state.x, &state.v, &mut m.applied);
        let before = &self.previous;
        for i in 0..m.x().len() {
            let (x, v) = (state.x[i], state.v[i]);
            m.target[i] = x + b * (x - before.x[i]) + k * h * (v + b * (v - before.v[i]));
        }
        // The damping that follows the step acts on the whole history, or a rate `gamma` would act as
        // `3/2 gamma`: `v1 = 4/3 v0 - 1/3 v_` amplifies what is taken from `v0` alone.
        let damping = (-scene.model.damping() * h).exp();
        let (residual, path, contact) = m.minimise(scene, state, h, k * h, effort)?;
        let mut work = 0.0;
        for i in 0..m.x().len() {
            work += m.applied[i] * (m.x()[i] - state.x[i]);
            // The old history has served: it becomes the velocity at the end.
            let x = state.x[i];
            self.previous.v[i] = ((m.x()[i] - x) - b * (x - self.previous.x[i])) / (k * h);
        }
        std::mem::swap(&mut self.previous.v, &mut state.v);
        self.previous.v.iter_mut().for_each(|v| *v *= damping);
        self.previous.x.copy_from_slice(&state.x);
        self.previous.t = state.t;
        state.x.copy_from_slice(m.x());
        state.t += h;
        self.last.x.copy_from_slice(&state.x);
        Ok(Accepted {
            residual,
            work,
            driven: 0.0,
            path,
            contact,
        })
    }
}
