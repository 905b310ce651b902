//! The energy-momentum integrator.

use super::newton::{Newton, Terms};
use crate::report::effort::SolverEffort;
use crate::report::step_report::StepOutcome;
use crate::report::totals::not_converged;
use crate::step::integrator::{Attempt, Integrator, MethodTraits, Proposal, Scene, StepAccount};
use crate::step::reaction::Balance;
use crate::{SheetModel, State};
use isosheet_linalg::{LinalgError, norm_inf};
use isosheet_materials::OptionsError;
use isosheet_materials::potential::Memories;
use isosheet_materials::vectors::dot;
use isosheet_model::Reason;
use isosheet_model::StepError;
use isosheet_model::strain_floor;
use serde::{Deserialize, Serialize};

/// Options of [`Method::EnergyMomentum`](crate::Method::EnergyMomentum).
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub struct EnergyMomentumOptions {
    /// Largest relative residual of the momentum balance. Default 1e-12: the energy error of a
    /// step is about this fraction of the energy that changes hands in it.
    pub tolerance: f64,
    /// Largest relative edge length error of an accepted step. Default 2e-13.
    pub strain_tolerance: f64,
    /// Most Newton iterations. Default 15: a step that needs more is better halved.
    pub max_iterations: usize,
}

impl Default for EnergyMomentumOptions {
    fn default() -> Self {
        Self {
            tolerance: 1e-12,
            strain_tolerance: 2e-13,
            max_iterations: 15,
        }
    }
}

impl EnergyMomentumOptions {
    /// # Errors
    /// [`OptionsError`] naming the option that makes no sense.
    pub fn validate(&self) -> Result<(), OptionsError> {
        OptionsError::check_range("tolerance", self.tolerance, 1e-15, 1e-2)?;
        OptionsError::check_range("strain_tolerance", self.strain_tolerance, 1e-15, 1e-2)?;
        OptionsError::check_count("max_iterations", self.max_iterations)
    }
}

/// Residual at which an iteration that has stopped improving counts as converged: round-off in
/// the multipliers of nearly dependent rods can keep it above the tolerance.
const STALLED_RESIDUAL: f64 = 1e-9;

/// Newton iterations that converge at all are in their quadratic phase after this many: a residual
/// still above [`QUADRATIC_BELOW`] then never recovered in the falls of M^1 to M^3, and a step is
/// halved sooner.
const QUADRATIC_FROM: usize = 6;
/// See [`QUADRATIC_FROM`].
const QUADRATIC_BELOW: f64 = 1e-2;

/// The energy-momentum method, see [`Method::EnergyMomentum`](crate::Method::EnergyMomentum).
pub(crate) struct EnergyMomentum {
    options: EnergyMomentumOptions,
    /// Its velocity is that at the middle of the step.
    newton: Newton,
    /// What the potentials remember.
    memories: Memories,
    density: Vec<f64>,
    xm: Vec<f64>,
    force: Vec<f64>,
    applied: Vec<f64>,
    difference: Vec<f64>,
}

impl EnergyMomentum {
    /// Analyses the model.
    ///
    /// # Errors
    /// [`LinalgError::Symbolic`] if memory runs out.
    pub(crate) fn new(
        model: &SheetModel,
        options: EnergyMomentumOptions,
    ) -> Result<Self, LinalgError> {
        let (n, m) = (model.coordinate_count(), model.rods().len());
        Ok(Self {
            options,
            newton: Newton::new(model)?,
            memories: model.memories(),
            density: vec![0.0; m],
            xm: vec![0.0; n],
            force: vec![0.0; n],
            applied: vec![0.0; n],
            difference: vec![0.0; n],
        })
    }

    /// Force over the step from the potentials at the current iterate.
    fn discrete_force(&mut self, model: &SheetModel, state: &State, h: f64) {
        let t = state.t + 0.5 * h;
        model.acting_force(&self.memories, t, &self.xm, &mut self.force);
        if model.has_constant_forces() {
            return;
        }
        // Gonzalez: correct the midpoint force along M dx so that its work is exactly -dV.
        for i in 0..self.newton.u.len() {
            self.difference[i] = self.newton.x1[i] - state.x[i];
        }
        model.apply_mass(&self.difference, &mut self.newton.momentum);
        let squared = dot(&self.difference, &self.newton.momentum);
        if squared > 0.0 {
            let change = model.energy_with(&self.memories, t, &self.newton.x1)
                - model.energy_with(&self.memories, t, &state.x);
            let correction = (change + dot(&self.force, &self.difference)) / squared;
            for (f, m) in self.force.iter_mut().zip(&self.newton.momentum) {
                *f -= correction * m;
            }
        }
    }

    /// Whether the forces alone leave the rods as they are, as in free fall: then the midpoint velocity is
    /// what they make of it, the impulses are zero, and there is no system to solve, whose rods, dependent in
    /// a flat sheet, would answer round-off in their lengths with impulses. Asked of lumped masses only.
    fn falls_freely(&mut self, model: &SheetModel, state: &State, h: f64) -> bool {
        if model.mass().edge.is_some() || model.has_drives() || !model.constraints().is_empty() {
            return false;
        }
        let t = state.t + 0.5 * h;
        model.acting_force(&self.memories, t, &state.x, &mut self.force);
        model.applied_force(t, &state.x, &state.v, &mut self.applied);
        let mass = &model.mass().vertex;
        for i in 0..self.newton.u.len() {
            self.newton.u[i] =
                state.v[i] + 0.5 * h * (self.force[i] + self.applied[i]) / mass[i / 3];
            self.xm[i] = state.x[i] + 0.5 * h * self.newton.u[i];
        }
        let rods = model.rods();
        rods.apply(&self.xm, &self.newton.u, &mut self.newton.rods);
        let round_off = 16.0 * f64::EPSILON * norm_inf(&self.newton.u);
        self.newton
            .rods
            .iter()
            .zip(rods.lengths())
            .all(|(r, l)| r.abs() <= round_off * l)
    }

    /// Mean forces of the supports over the step.
    fn set_balance(&self, model: &SheetModel, state: &State, h: f64, balance: &mut Balance) {
        let (w, v) = (&self.newton.u, &state.v);
        if !balance.begin(model, |i| 2.0 * (w[i] - v[i]) / h) {
            return;
        }
        let t = state.t + 0.5 * h;
        balance.add_potentials(model, &self.memories, (t, &self.xm), 1.0);
        balance.add_applied(model, t, &self.xm, &self.newton.u, 1.0);
        balance.add_rods(model, &self.xm, &self.newton.impulse, -1.0 / h);
        balance.add_loads(
            self.newton
                .constraints
                .loads(&self.newton.constraints.impulses, 1.0 / h),
        );
        balance.finish(model);
    }

    /// Sets the negative residuals; returns the relative momentum residual and the strain.
    fn residuals(&mut self, model: &SheetModel, state: &State, h: f64) -> (f64, f64) {
        self.newton.set_end(model, state, h);
        for i in 0..self.xm.len() {
            self.xm[i] = state.x[i] + 0.5 * h * self.newton.u[i];
        }
        self.discrete_force(model, state, h);
        model.applied_force(
            state.t + 0.5 * h,
            &self.xm,
            &self.newton.u,
            &mut self.applied,
        );
        for i in 0..self.newton.u.len() {
            self.difference[i] = 2.0 * (self.newton.u[i] - state.v[i]);
        }
        model.apply_mass(&self.difference, &mut self.newton.momentum);
        let mass = &model.mass().vertex;
        let mut scale = 0.0_f64;
        for i in 0..self.newton.u.len() {
            let f = h * (self.force[i] + self.applied[i]);
            scale = scale.max((self.newton.momentum[i].abs() + f.abs()) / mass[i / 3]);
            self.newton.momentum[i] = f - self.newton.momentum[i];
        }
        self.newton.constraints.push_between(
            model.constraints(),
            state.t + 0.5 * h,
            (&state.x, &self.xm, &self.newton.x1),
            -0.5 * h,
        );
        // Where nothing pushes, the speed sets the scale.
        let speed = norm_inf(&self.newton.u).max(norm_inf(&state.v));
        self.newton
            .close(model, state, h, &self.xm, scale + 1e-3 * speed)
    }
}

impl Integrator for EnergyMomentum {
    fn traits(&self) -> MethodTraits {
        MethodTraits::conservative()
    }

    fn propose(
        &mut self,
        scene: Scene<'_>,
        attempt: Attempt<'_>,
        proposal: &mut Proposal,
        effort: &mut SolverEffort<'_>,
    ) -> Result<(), StepError> {
        let (model, h) = (scene.model, attempt.h);
        let mut damped = model.damping_loss(&attempt.state.v, 0.5 * h);
        let start = (damped != 0.0).then(|| {
            let mut start = attempt.state.clone();
            model.damp(&mut start.v, 0.5 * h);
            start
        });
        let state = start.as_ref().unwrap_or(attempt.state);
        let attempt = attempt.from(state);
        self.memories.copy_from(attempt.memories);
        self.begin(model, &attempt);
        let (residual, outcome) = self.solve(model, state, h, effort)?;
        let motion = &mut proposal.motion;
        motion.history.forget_systems();
        // Impulses of dependent rods are not unique, and what a regularised solve makes of round-off in their
        // lengths would buckle the next step: they are found anew there.
        if outcome == StepOutcome::Newton {
            let constraints = self.newton.constraints.full_impulses();
            motion
                .history
                .multipliers
                .set(h, &self.newton.impulse, constraints);
        } else {
            motion.history.multipliers.clear();
        }
        self.set_balance(model, state, h, &mut motion.balance);
        for i in 0..self.newton.u.len() {
            motion.state.v[i] = 2.0 * self.newton.u[i] - state.v[i];
        }
        model.set_pin_velocities(state.t + h, h, &mut motion.state.v);
        motion.state.x.copy_from_slice(&self.newton.x1);
        motion.state.t = state.t + h;
        damped += model.brake(&mut motion.state.v, 0.5 * h);
        let work = h * dot(&self.applied, &self.newton.u);
        proposal.account = StepAccount {
            damped,
            ..StepAccount::of_forces(residual, work, outcome)
        };
        Ok(())
    }
}

impl EnergyMomentum {
    /// First guess: the impulses of the step before, scaled to this one, and the velocity at the start.
    fn begin(&mut self, model: &SheetModel, attempt: &Attempt<'_>) {
        let (state, h) = (attempt.state, attempt.h);
        self.newton
            .begin(model, state, attempt.scaled_multipliers());
        if self.falls_freely(model, state, h) {
            self.newton.impulse.fill(0.0);
        } else {
            self.newton.u.copy_from_slice(&state.v);
        }
        self.newton.set_pins(model, state, h);
    }

    /// Newton's method; returns the relative residual and how it was reached.
    fn solve(
        &mut self,
        model: &SheetModel,
        state: &State,
        h: f64,
        effort: &mut SolverEffort<'_>,
    ) -> Result<(f64, StepOutcome), StepError> {
        let strain_tolerance = self
            .options
            .strain_tolerance
            .max(strain_floor(model, state));
        let (mut residual, mut strain) = self.residuals(model, state, h);
        let mut previous = f64::INFINITY;
        let mut outcome = StepOutcome::Newton;
        let mut iterations = 0;
        let converged = loop {
            if residual <= self.options.tolerance && strain <= strain_tolerance {
                break true;
            }
            if residual <= STALLED_RESIDUAL
                && strain <= strain_tolerance
                && residual > 0.3 * previous
            {
                break true;
            }
            let lost = iterations >= QUADRATIC_FROM && residual > QUADRATIC_BELOW;
            if iterations == self.options.max_iterations
                || lost
                || !effort.goes_on()
                || !(residual.is_finite() && strain < 1.0)
            {
                break false;
            }
            previous = residual;
            iterations += 1;
            for (d, l) in self.density.iter_mut().zip(&self.newton.impulse) {
                *d = -0.5 * h * l;
            }
            let terms = Terms {
                mass: 2.0,
                density: &self.density,
                left: Some(&self.xm),
                potentials: Some((&self.memories, state.t + 0.5 * h, &self.xm, 0.5 * h * h)),
            };
            let used = self.newton.correct(model, state.t, &terms, effort)?;
            outcome = outcome.max(used);
            (residual, strain) = self.residuals(model, state, h);
        };
        if !converged {
            return Err(not_converged(
                state.t,
                h,
                effort,
                Reason::Iterations,
                residual,
                strain,
            ));
        }
        Ok((residual, outcome))
    }
}
