//! The energy-momentum integrator.

use super::mean_pin_velocities;
use crate::constraint::conservative::ConservativeRows;
use crate::linear::saddle::{SaddleMatrix, System};
use crate::model::round_off::{strain_floor, velocity_round_off};
use crate::options::OptionsError;
use crate::step::effort::SolverEffort;
use crate::step::integrator::{Attempt, Integrator, MethodTraits, Proposal, Scene, StepAccount};
use crate::step::reaction::Balance;
use crate::step::reason::Reason;
use crate::step::report::{StepError, StepOutcome, not_converged};
use crate::vectors::dot;
use crate::{SheetModel, State};
use isosheet_coords::linalg::{LinalgError, norm_inf};
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
    matrix: SaddleMatrix,
    impulse: Vec<f64>,
    density: Vec<f64>,
    w: Vec<f64>,
    x1: Vec<f64>,
    xm: Vec<f64>,
    force: Vec<f64>,
    applied: Vec<f64>,
    momentum: Vec<f64>,
    difference: Vec<f64>,
    rods: Vec<f64>,
    constraints: ConservativeRows,
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
            matrix: SaddleMatrix::new(model)?,
            impulse: vec![0.0; m],
            density: vec![0.0; m],
            w: vec![0.0; n],
            x1: vec![0.0; n],
            xm: vec![0.0; n],
            force: vec![0.0; n],
            applied: vec![0.0; n],
            momentum: vec![0.0; n],
            difference: vec![0.0; n],
            rods: vec![0.0; m],
            constraints: ConservativeRows::new(model.constrained_vertices()),
        })
    }

    /// Force over the step from the potentials at the current iterate.
    fn discrete_force(&mut self, model: &SheetModel, state: &State, h: f64) {
        let t = state.t + 0.5 * h;
        model.potential_force(t, &self.xm, &mut self.force);
        if model.has_constant_forces() {
            return;
        }
        // Gonzalez: correct the midpoint force along M dx so that its work is exactly -dV.
        for i in 0..self.w.len() {
            self.difference[i] = self.x1[i] - state.x[i];
        }
        model.apply_mass(&self.difference, &mut self.momentum);
        let squared = dot(&self.difference, &self.momentum);
        if squared > 0.0 {
            let change = model.potential_energy(t, &self.x1) - model.potential_energy(t, &state.x);
            let correction = (change + dot(&self.force, &self.difference)) / squared;
            for (f, m) in self.force.iter_mut().zip(&self.momentum) {
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
        model.potential_force(t, &state.x, &mut self.force);
        model.applied_force(t, &state.x, &state.v, &mut self.applied);
        let mass = &model.mass().vertex;
        for i in 0..self.w.len() {
            self.w[i] = state.v[i] + 0.5 * h * (self.force[i] + self.applied[i]) / mass[i / 3];
            self.xm[i] = state.x[i] + 0.5 * h * self.w[i];
        }
        let rods = model.rods();
        rods.apply(&self.xm, &self.w, &mut self.rods);
        let round_off = 16.0 * f64::EPSILON * norm_inf(&self.w);
        self.rods
            .iter()
            .zip(rods.lengths())
            .all(|(r, l)| r.abs() <= round_off * l)
    }

    /// Mean forces of the supports over the step.
    fn set_balance(&self, model: &SheetModel, state: &State, h: f64, balance: &mut Balance) {
        let (w, v) = (&self.w, &state.v);
        if !balance.begin(model, |i| 2.0 * (w[i] - v[i]) / h) {
            return;
        }
        let t = state.t + 0.5 * h;
        balance.add_potentials(model, t, &self.xm, 1.0);
        balance.add_applied(model, t, &self.xm, &self.w, 1.0);
        balance.add_rods(model, &self.xm, &self.impulse, -1.0 / h);
        balance.add_loads(self.constraints.loads(&self.constraints.impulses, 1.0 / h));
        balance.finish(model);
    }

    /// Sets the negative residuals; returns the relative momentum residual and the strain.
    fn residuals(&mut self, model: &SheetModel, state: &State, h: f64) -> (f64, f64) {
        for i in 0..self.w.len() {
            self.x1[i] = state.x[i] + h * self.w[i];
            self.xm[i] = state.x[i] + 0.5 * h * self.w[i];
        }
        model.place_pins(state.t + h, &mut self.x1);
        self.discrete_force(model, state, h);
        model.applied_force(state.t + 0.5 * h, &self.xm, &self.w, &mut self.applied);
        for i in 0..self.w.len() {
            self.difference[i] = 2.0 * (self.w[i] - state.v[i]);
        }
        model.apply_mass(&self.difference, &mut self.momentum);
        let mass = &model.mass().vertex;
        let mut scale = 0.0_f64;
        for i in 0..self.w.len() {
            let f = h * (self.force[i] + self.applied[i]);
            scale = scale.max((self.momentum[i].abs() + f.abs()) / mass[i / 3]);
            self.momentum[i] = f - self.momentum[i];
        }
        model
            .rods()
            .apply_transpose_add(&self.xm, &self.impulse, &mut self.momentum);
        self.constraints.push_between(
            model.constraints(),
            state.t + 0.5 * h,
            (&state.x, &self.xm, &self.x1),
            -0.5 * h,
        );
        self.constraints
            .add_impulses(&self.constraints.impulses, &mut self.momentum);
        self.constraints
            .linearise(model.constraints(), state.t + h, &self.x1, 1.0 / h);
        model.clear_pinned(&mut self.momentum);
        let worst = model.largest_acceleration(&self.momentum);
        model.rods().residual_into(&self.x1, &mut self.rods);
        self.rods.iter_mut().for_each(|c| *c = -*c / h);
        // Where nothing pushes, the speed sets the scale.
        let speed = self
            .w
            .iter()
            .chain(&state.v)
            .fold(0.0_f64, |m, v| m.max(v.abs()));
        let relative = if worst > velocity_round_off(state, h) {
            worst / (scale + 1e-3 * speed).max(f64::MIN_POSITIVE)
        } else {
            0.0
        };
        let strain = model.rods().max_strain(&self.x1);
        (relative, self.constraints.worst(strain))
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
        let (model, state, h) = (scene.model, attempt.state, attempt.h);
        self.begin(model, &attempt);
        let (residual, outcome) = self.solve(model, state, h, effort)?;
        let solver = &mut proposal.solver;
        // Impulses of dependent rods are not unique, and what a regularised solve makes of round-off in their
        // lengths would buckle the next step: they are found anew there.
        if outcome == StepOutcome::Newton {
            let constraints = self.constraints.full_impulses();
            solver
                .history
                .multipliers
                .set(h, &self.impulse, constraints);
        } else {
            solver.history.multipliers.clear();
        }
        self.set_balance(model, state, h, &mut solver.balance);
        for i in 0..self.w.len() {
            solver.state.v[i] = 2.0 * self.w[i] - state.v[i];
        }
        model.set_pin_velocities(state.t + h, h, &mut solver.state.v);
        solver.state.x.copy_from_slice(&self.x1);
        solver.state.t = state.t + h;
        let work = h * dot(&self.applied, &self.w);
        proposal.account = StepAccount::without_contact(residual, work, outcome);
        Ok(())
    }
}

impl EnergyMomentum {
    /// First guess: the impulses of the step before, scaled to this one, and the velocity at the start.
    fn begin(&mut self, model: &SheetModel, attempt: &Attempt<'_>) {
        let (state, h) = (attempt.state, attempt.h);
        let (ratio, last) = attempt.scaled_multipliers();
        for (e, l) in self.impulse.iter_mut().enumerate() {
            *l = last.rods.get(e).map_or(0.0, |i| ratio * i);
        }
        self.constraints.begin(
            model.constraints(),
            state.t,
            &state.x,
            ratio,
            &last.constraints,
        );
        if self.falls_freely(model, state, h) {
            self.impulse.fill(0.0);
        } else {
            self.w.copy_from_slice(&state.v);
        }
        mean_pin_velocities(model, state, h, &mut self.x1, &mut self.w);
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
            effort.iterations += 1;
            for (d, l) in self.density.iter_mut().zip(&self.impulse) {
                *d = -0.5 * h * l;
            }
            let system = System {
                mass: 2.0,
                density: &self.density,
                left: &self.xm,
                right: &self.x1,
                potentials: Some((state.t + 0.5 * h, &self.xm, 0.5 * h * h)),
                constraints: &self.constraints.blocks,
            };
            let used = self
                .matrix
                .solve(
                    model,
                    &system,
                    &mut self.momentum,
                    &mut self.rods,
                    &mut self.constraints.rhs,
                    effort,
                )
                .map_err(|source| StepError::Linalg { t: state.t, source })?;
            outcome = outcome.max(used);
            for (w, d) in self.w.iter_mut().zip(&self.momentum) {
                *w += d;
            }
            for (l, d) in self.impulse.iter_mut().zip(&self.rods) {
                *l += d;
            }
            self.constraints.correct();
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
