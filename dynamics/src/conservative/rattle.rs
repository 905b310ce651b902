//! RATTLE and its fourth-order composition.

use super::newton::{Newton, Terms};
use crate::report::effort::SolverEffort;
use crate::report::step_report::StepOutcome;
use crate::report::totals::not_converged;
use crate::step::history::Multipliers;
use crate::step::integrator::{Attempt, Integrator, MethodTraits, Proposal, Scene, StepAccount};
use crate::step::reaction::{Balance, ForceTime};
use crate::{SheetModel, State};
use isosheet_linalg::{LinalgError, norm_inf};
use isosheet_materials::OptionsError;
use isosheet_materials::potential::Memories;
use isosheet_materials::vectors::dot;
use isosheet_model::Reason;
use isosheet_model::StepError;
use isosheet_model::{strain_floor, velocity_round_off};
use nalgebra::Vector2;
use serde::{Deserialize, Serialize};

/// Options of [`Method::Rattle`](crate::Method::Rattle) and
/// [`Method::RattleComposition`](crate::Method::RattleComposition).
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub struct RattleOptions {
    /// Largest relative edge length error of an accepted step. Default 2e-13.
    pub strain_tolerance: f64,
    /// Most Newton iterations for the positions. Default 15: a step that needs more is better
    /// halved.
    pub max_iterations: usize,
}

impl Default for RattleOptions {
    fn default() -> Self {
        Self {
            strain_tolerance: 2e-13,
            max_iterations: 15,
        }
    }
}

impl RattleOptions {
    /// # Errors
    /// [`OptionsError`] naming the option that makes no sense.
    pub fn validate(&self) -> Result<(), OptionsError> {
        OptionsError::check_range("strain_tolerance", self.strain_tolerance, 1e-15, 1e-2)?;
        OptionsError::check_count("max_iterations", self.max_iterations)
    }
}

/// RATTLE and Suzuki's composition of its steps, see [`Method::Rattle`](crate::Method::Rattle) and
/// [`Method::RattleComposition`](crate::Method::RattleComposition).
pub(crate) struct Rattle {
    options: RattleOptions,
    /// The parts of a step, one of which may be negative.
    parts: Vec<f64>,
    /// Its velocity is that after the first half of the forces.
    newton: Newton,
    /// What the potentials remember.
    memories: Memories,
    rates: Vec<f64>,
    none: Vec<f64>,
    force: Vec<f64>,
    applied: Vec<f64>,
    kick: Vec<f64>,
    difference: Vec<f64>,
    change: Vec<f64>,
    /// Impulses of the vertex constraints on the velocity.
    pushes: Vec<Vector2<f64>>,
    balance: Balance,
}

impl Rattle {
    /// Analyses the model.
    ///
    /// # Errors
    /// [`LinalgError::Symbolic`] if memory runs out.
    pub(crate) fn new(model: &SheetModel, options: RattleOptions) -> Result<Self, LinalgError> {
        Self::of_parts(vec![1.0], model, options)
    }

    /// The composition of fourth order.
    ///
    /// # Errors
    /// [`LinalgError::Symbolic`] if memory runs out.
    pub(crate) fn composed(
        model: &SheetModel,
        options: RattleOptions,
    ) -> Result<Self, LinalgError> {
        let a = 1.0 / (4.0 - 4.0_f64.cbrt());
        Self::of_parts(vec![a, a, 1.0 - 4.0 * a, a, a], model, options)
    }

    fn of_parts(
        parts: Vec<f64>,
        model: &SheetModel,
        options: RattleOptions,
    ) -> Result<Self, LinalgError> {
        let (n, m) = (model.coordinate_count(), model.rods().len());
        Ok(Self {
            options,
            parts,
            newton: Newton::new(model)?,
            memories: model.memories(),
            rates: vec![0.0; m],
            none: vec![0.0; m],
            force: vec![0.0; n],
            applied: vec![0.0; n],
            kick: vec![0.0; n],
            difference: vec![0.0; n],
            change: vec![0.0; n],
            pushes: Vec::new(),
            balance: Balance::new(model, ForceTime::Mean),
        })
    }

    /// Sets `momentum` and `rods` to the negative residuals at the iterate; returns the
    /// relative momentum residual and the strain.
    fn residuals(&mut self, model: &SheetModel, state: &State, h: f64) -> (f64, f64) {
        self.newton.set_end(model, state, h);
        for i in 0..self.difference.len() {
            self.difference[i] = self.newton.u[i] - state.v[i];
        }
        model.apply_mass(&self.difference, &mut self.newton.momentum);
        let mass = &model.mass().vertex;
        // The speed sets the scale, not the impulses: impulses of nearly dependent rods can be as large as
        // they are wrong.
        let mut scale = 0.0_f64;
        for i in 0..self.newton.u.len() {
            let change = self.newton.momentum[i].abs() / mass[i / 3];
            scale = scale.max(
                state.v[i].abs() + self.kick[i].abs() / mass[i / 3] + IMPULSE_ROUND_OFF * change,
            );
            self.newton.momentum[i] = self.kick[i] - self.newton.momentum[i];
        }
        self.newton.close(model, state, h, &state.x, scale)
    }

    /// Finds `u`, `L` and `x1`.
    fn solve_positions(
        &mut self,
        model: &SheetModel,
        state: &State,
        multipliers: &mut Multipliers,
        h: f64,
        effort: &mut SolverEffort<'_>,
    ) -> Result<(f64, StepOutcome), StepError> {
        let tolerance = self
            .options
            .strain_tolerance
            .max(strain_floor(model, state));
        // The impulse grows with h while motion is smooth; h < 0 occurs inside compositions.
        let ratio = if multipliers.step == 0.0 {
            0.0
        } else {
            h / multipliers.step
        };
        self.newton.begin(model, state, (ratio, multipliers));
        self.newton
            .constraints
            .push_at(model.constraints(), state.t, &state.x);
        self.newton.u.copy_from_slice(&state.v);
        self.newton.set_pins(model, state, h);
        let (mut residual, mut strain) = self.residuals(model, state, h);
        let mut outcome = StepOutcome::Newton;
        let mut iterations = 0;
        // At least one iteration, unless there is nothing but round-off to correct.
        let floor = strain_floor(model, state);
        while residual > MOMENTUM_TOLERANCE
            || strain > tolerance
            || (iterations == 0 && strain > floor)
        {
            if iterations == self.options.max_iterations
                || !effort.goes_on()
                || !(residual.is_finite() && strain < 1.0)
            {
                return Err(not_converged(
                    state.t,
                    h,
                    effort,
                    Reason::Iterations,
                    residual,
                    strain,
                ));
            }
            iterations += 1;
            let terms = Terms {
                mass: 1.0,
                density: &self.none,
                left: Some(&state.x),
                potentials: None,
            };
            let used = self.newton.correct(model, state.t, &terms, effort)?;
            outcome = outcome.max(used);
            (residual, strain) = self.residuals(model, state, h);
        }
        let constraints = self.newton.constraints.full_impulses();
        multipliers.set(h, &self.newton.impulse, constraints);
        Ok((residual, outcome))
    }

    /// How far the velocity in `momentum`, with the impulses in `rods`, is from solving its two
    /// equations: the largest rate of a rod and the largest velocity not accounted for, both
    /// relative to the speed before and after.
    fn velocity_errors(&mut self, model: &SheetModel, state: &State, h: f64) -> (f64, f64) {
        for i in 0..self.newton.u.len() {
            self.kick[i] = 0.5 * h * (self.force[i] + self.applied[i]);
        }
        let speed = norm_inf(&self.newton.u)
            + norm_inf(&self.newton.momentum)
            + model.largest_acceleration(&self.kick)
            + velocity_round_off(state, h) / VELOCITY_TOLERANCE;
        let rods = model.rods();
        rods.apply(&self.newton.x1, &self.newton.momentum, &mut self.rates);
        let rate = self
            .rates
            .iter()
            .zip(rods.lengths())
            .fold(0.0_f64, |m, (r, l)| m.max(r.abs() / l))
            .max(self.constraint_rate(model, state.t + h, h));
        for i in 0..self.newton.u.len() {
            self.difference[i] = self.newton.momentum[i] - self.newton.u[i];
        }
        self.kick.iter_mut().for_each(|k| *k = -*k);
        model.apply_mass(&self.difference, &mut self.change);
        for (k, c) in self.kick.iter_mut().zip(&self.change) {
            *k += c;
        }
        self.rates
            .iter_mut()
            .zip(&self.newton.rods)
            .for_each(|(t, r)| *t = -r);
        rods.apply_transpose_add(&self.newton.x1, &self.rates, &mut self.kick);
        self.pushes.iter_mut().for_each(|p| *p = -*p);
        self.newton
            .constraints
            .add_impulses(&self.pushes, &mut self.kick);
        self.pushes.iter_mut().for_each(|p| *p = -*p);
        model.clear_pinned(&mut self.kick);
        (rate / speed, model.largest_acceleration(&self.kick) / speed)
    }

    /// Largest rate of a vertex constraint with the velocity in `momentum`.
    fn constraint_rate(&mut self, model: &SheetModel, t: f64, h: f64) -> f64 {
        if model.constraints().is_empty() {
            return 0.0;
        }
        let rates = model.constraint_rates(t, h, &self.newton.x1);
        self.newton
            .constraints
            .set_rates(&self.newton.momentum, &rates);
        self.newton.constraints.largest_rate()
    }

    /// Right-hand sides of the rods' rates, the velocities of moving pins at the end being given.
    fn ask_rod_rates(&mut self, model: &SheetModel, t: f64, h: f64) {
        if model.moving_pins().next().is_some() {
            self.difference.fill(0.0);
            model.set_pin_velocities(t, h, &mut self.difference);
            for i in model.moving_pins().flat_map(|v| 3 * v..3 * v + 3) {
                self.difference[i] -= self.newton.u[i];
            }
            model.apply_mass(&self.difference, &mut self.change);
            for (m, c) in self.newton.momentum.iter_mut().zip(&self.change) {
                *m -= c;
            }
        }
        self.difference.copy_from_slice(&self.newton.u);
        model.set_pin_velocities(t, h, &mut self.difference);
        model
            .rods()
            .apply(&self.newton.x1, &self.difference, &mut self.newton.rods);
    }

    /// Mean forces of the supports over the step, up to the velocity `u`; the velocities at the end, as they
    /// are foretold, are in `difference`.
    fn begin_balance(&mut self, model: &SheetModel, state: &State, h: f64) {
        let (u, v) = (&self.newton.u, &state.v);
        if !self.balance.begin(model, |i| (u[i] - v[i]) / h) {
            return;
        }
        let (t, end) = (state.t, state.t + h);
        let balance = &mut self.balance;
        balance.add_potentials(model, &self.memories, (t, &state.x), 0.5);
        balance.add_potentials(model, &self.memories, (end, &self.newton.x1), 0.5);
        balance.add_applied(model, t, &state.x, &state.v, 0.5);
        balance.add_applied(model, end, &self.newton.x1, &self.difference, 0.5);
        balance.add_rods(model, &state.x, &self.newton.impulse, -1.0 / h);
        balance.add_loads(
            self.newton
                .constraints
                .loads(&self.newton.constraints.impulses, 1.0 / h),
        );
    }

    /// The rest of them, up to the velocity in `momentum`.
    fn finish_balance(&mut self, model: &SheetModel, h: f64) {
        let (u, v) = (&self.newton.u, &self.newton.momentum);
        let balance = &mut self.balance;
        balance.add_inertia(model, |i| (v[i] - u[i]) / h);
        if !model.has_supports() {
            return;
        }
        balance.add_rods(model, &self.newton.x1, &self.newton.rods, -1.0 / h);
        balance.add_loads(self.newton.constraints.loads(&self.pushes, 1.0 / h));
        balance.finish(model);
    }

    /// One step of any sign, of a state and the multipliers that belong to it. The forces of the supports
    /// over the step are in `self.balance` afterwards.
    fn advance(
        &mut self,
        model: &SheetModel,
        state: &mut State,
        multipliers: &mut Multipliers,
        h: f64,
        effort: &mut SolverEffort<'_>,
    ) -> Result<StepAccount, StepError> {
        model.acting_force(&self.memories, state.t, &state.x, &mut self.force);
        model.applied_force(state.t, &state.x, &state.v, &mut self.applied);
        for i in 0..self.newton.u.len() {
            self.kick[i] = 0.5 * h * (self.force[i] + self.applied[i]);
        }
        let mut work: f64 = 0.5 * h * dot(&self.applied, &state.v);
        let (residual, outcome) = self.solve_positions(model, state, multipliers, h, effort)?;
        // Velocity: the momentum after the second half kick, projected onto G(x1) v = 0.
        model.acting_force(
            &self.memories,
            state.t + h,
            &self.newton.x1,
            &mut self.force,
        );
        // Forces of velocities ask for that at the end, which the first half of the step foretells to second
        // order.
        for (d, (u, v)) in self
            .difference
            .iter_mut()
            .zip(self.newton.u.iter().zip(&state.v))
        {
            *d = 2.0 * u - v;
        }
        model.applied_force(
            state.t + h,
            &self.newton.x1,
            &self.difference,
            &mut self.applied,
        );
        // Solved for the change of velocity, so that round-off is relative to it.
        for i in 0..self.newton.u.len() {
            self.newton.momentum[i] = 0.5 * h * (self.force[i] + self.applied[i]);
        }
        self.begin_balance(model, state, h);
        self.ask_rod_rates(model, state.t + h, h);
        let rates = model.constraint_rates(state.t + h, h, &self.newton.x1);
        self.newton
            .constraints
            .push_at(model.constraints(), state.t + h, &self.newton.x1);
        self.newton.constraints.set_rates(&self.newton.u, &rates);
        self.newton.rods.iter_mut().for_each(|r| *r = -*r);
        let terms = Terms {
            mass: 1.0,
            density: &self.none,
            left: None,
            potentials: None,
        };
        let projected = self.newton.solve(model, state.t, &terms, effort)?;
        for (m, u) in self.newton.momentum.iter_mut().zip(&self.newton.u) {
            *m += u;
        }
        model.set_pin_velocities(state.t + h, h, &mut self.newton.momentum);
        self.pushes.clone_from(&self.newton.constraints.rhs);
        let (rate, balance) = self.velocity_errors(model, state, h);
        if rate > VELOCITY_TOLERANCE || balance > VELOCITY_TOLERANCE || rate.is_nan() {
            let strain = model.rods().max_strain(&self.newton.x1);
            return Err(not_converged(
                state.t,
                h,
                effort,
                Reason::Iterations,
                rate.max(balance),
                strain,
            ));
        }
        work += 0.5 * h * dot(&self.applied, &self.newton.momentum);
        self.finish_balance(model, h);
        state.x.copy_from_slice(&self.newton.x1);
        state.v.copy_from_slice(&self.newton.momentum);
        state.t += h;
        Ok(StepAccount::of_forces(
            residual,
            work,
            outcome.max(projected),
        ))
    }
}

/// Largest relative residual of the momentum balance. The balance is linear in the unknowns,
/// so what is left after a Newton step is round-off of the solve.
const MOMENTUM_TOLERANCE: f64 = 1e-10;

/// Share of the impulses' own size that counts as round-off beside the speed, in units of
/// [`MOMENTUM_TOLERANCE`]: together 1e-13, what a refined solve leaves.
const IMPULSE_ROUND_OFF: f64 = 1e-3;

/// Largest relative error of the velocity at the end of a step. A regular solve leaves round-off; one
/// with loaded dependent rods leaves the part of the velocity that they cannot take.
const VELOCITY_TOLERANCE: f64 = 1e-8;

impl Integrator for Rattle {
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
        self.memories.copy_from(attempt.memories);
        let motion = &mut proposal.motion;
        motion.history.forget_systems();
        motion.state.copy_from(attempt.state);
        let multipliers = &mut motion.history.multipliers;
        multipliers.copy_from(attempt.multipliers());
        motion.balance.clear();
        let mut total = StepAccount::of_forces(0.0, 0.0, StepOutcome::Newton);
        for k in 0..self.parts.len() {
            let (part, state) = (self.parts[k], &mut motion.state);
            total.damped += model.brake(&mut state.v, 0.5 * part * h);
            let done = self.advance(model, state, multipliers, part * h, effort)?;
            total.damped += model.brake(&mut state.v, 0.5 * part * h);
            total.residual = total.residual.max(done.residual);
            total.exchange.add(done.exchange);
            total.outcome = total.outcome.max(done.outcome);
            motion.balance.add_share(&self.balance, part);
        }
        motion.state.t = attempt.state.t + h;
        proposal.account = total;
        Ok(())
    }
}
