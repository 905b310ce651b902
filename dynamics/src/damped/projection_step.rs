//! Predict, project onto the lengths, project the velocity.

use crate::damped::iterate::Iterate;
use crate::damped::restoration::{FirstMatrix, Restoration, RestorationGoal};
use crate::linear::primal::PrimalMatrix;
use crate::model::PINNED;
use crate::model::round_off::strain_floor;
use crate::options::OptionsError;
use crate::step::effort::SolverEffort;
use crate::step::integrator::{
    Attempt, ContactSupport, Integrator, MethodTraits, Proposal, RodDemand, Scene, StepAccount,
};
use crate::step::reaction::{Balance, ForceTime};
use crate::step::reason::Reason;
use crate::step::report::{StepError, StepOutcome, not_converged};
use crate::step::tuning::Tuning;
use crate::{SheetModel, State};
use isosheet_coords::linalg::LinalgError;
use serde::{Deserialize, Serialize};

/// Options of [`Method::Projection`](crate::Method::Projection).
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub struct ProjectionStepOptions {
    /// Largest relative edge length error of an accepted step. Default 1e-12.
    pub strain_tolerance: f64,
    /// Most iterations of the projection onto the lengths. Default 400.
    pub max_projections: usize,
}

impl Default for ProjectionStepOptions {
    fn default() -> Self {
        Self {
            strain_tolerance: 1e-12,
            max_projections: 400,
        }
    }
}

impl ProjectionStepOptions {
    /// # Errors
    /// [`OptionsError`] naming the option that makes no sense.
    pub fn validate(&self) -> Result<(), OptionsError> {
        OptionsError::check_range("strain_tolerance", self.strain_tolerance, 1e-15, 1e-2)?;
        OptionsError::check_count("max_projections", self.max_projections)
    }
}

/// Allowance for round-off and for the tolerance of the lengths when two distances are compared.
const DISTANCE_SLACK: f64 = 1e-6;

/// Prediction and projection, see [`Method::Projection`](crate::Method::Projection).
pub(crate) struct ProjectionStep {
    options: ProjectionStepOptions,
    matrix: PrimalMatrix,
    restoration: Restoration,
    force: Vec<f64>,
    applied: Vec<f64>,
    acceleration: Vec<f64>,
    predicted: Vec<f64>,
    x: Vec<f64>,
    v: Vec<f64>,
    none: Vec<f64>,
    balance: Balance,
}

impl ProjectionStep {
    /// Analyses the model.
    ///
    /// # Errors
    /// [`LinalgError::Symbolic`] if memory runs out.
    pub(crate) fn new(
        model: &SheetModel,
        options: ProjectionStepOptions,
        tuning: &Tuning,
    ) -> Result<Self, LinalgError> {
        let n = model.coordinate_count();
        Ok(Self {
            options,
            matrix: PrimalMatrix::of_rods(model)?,
            restoration: Restoration::new(model, *tuning),
            force: vec![0.0; n],
            applied: vec![0.0; n],
            acceleration: vec![0.0; n],
            predicted: vec![0.0; n],
            x: vec![0.0; n],
            v: vec![0.0; n],
            none: vec![0.0; model.rods().len()],
            balance: Balance::with_residual(model, ForceTime::End),
        })
    }

    /// Mean forces of the supports over the step: what forces and inertia, up to the prediction, ask for at
    /// the supports themselves, and their share in the projections. Pins move at the speed that they end
    /// with.
    fn set_balance(&mut self, model: &SheetModel, state: &State, h: f64) {
        let (free, v) = (model.free_index(), &self.v);
        let predicted = |i: usize| (self.predicted[i] - state.x[i]) / h;
        let end = |i: usize| {
            if free[i / 3] == PINNED {
                v[i]
            } else {
                predicted(i)
            }
        };
        if !self.balance.begin(model, |i| (end(i) - state.v[i]) / h) {
            return;
        }
        self.balance.add_potentials(model, state.t, &state.x, 1.0);
        self.balance
            .add_applied(model, state.t, &state.x, &state.v, 1.0);
        self.balance.finish(model);
        let residual_momentum = &mut self.balance.residual_momentum;
        residual_momentum.append(&self.restoration.residual_momentum, 1.0 / (h * h));
        for i in 0..self.x.len() {
            self.acceleration[i] = if free[i / 3] == PINNED {
                0.0
            } else {
                (v[i] - (self.x[i] - state.x[i]) / h) / h
            };
        }
        let mass = model.mass();
        mass.apply(model.topology(), &self.acceleration, &mut self.force);
        let equalities = &self.restoration.vertex_rows.equality;
        residual_momentum.push(&self.x, equalities, self.force.iter().copied());
        if model.has_drives() {
            // The work of what moves needs them.
            self.balance.settle(model, state.t + h);
        }
    }

    /// `acceleration = M^-1 force`.
    fn accelerate(
        &mut self,
        model: &SheetModel,
        effort: &mut SolverEffort<'_>,
    ) -> Result<(), LinalgError> {
        if model.mass().edge.is_none() {
            for (i, a) in self.acceleration.iter_mut().enumerate() {
                *a = self.force[i] / model.mass().vertex[i / 3];
            }
            return Ok(());
        }
        effort.factorisations += 1;
        self.matrix.assemble(model, &self.x, &self.none, &self.none);
        self.matrix.factorize()?;
        self.matrix
            .solve(model, &self.force, &mut self.acceleration);
        Ok(())
    }
}

impl Integrator for ProjectionStep {
    fn traits(&self) -> MethodTraits {
        MethodTraits {
            demand: RodDemand::Nothing,
            contact: ContactSupport::None,
        }
    }

    fn propose(
        &mut self,
        scene: Scene<'_>,
        attempt: Attempt<'_>,
        proposal: &mut Proposal,
        effort: &mut SolverEffort<'_>,
    ) -> Result<(), StepError> {
        let (model, state, h) = (scene.model, attempt.state, attempt.h);
        self.predict(model, state, h, effort)?;
        let end = state.t + h;
        let strain = self.project(model, state, h, effort)?;
        let mut work = 0.0;
        for i in 0..self.x.len() {
            let dx = self.x[i] - state.x[i];
            work += self.applied[i] * dx;
            self.v[i] = dx / h;
        }
        model.set_pin_velocities(end, h, &mut self.v);
        let rates = model.constraint_rates(end, h, &self.x);
        self.restoration.release(model);
        let residual = self.restoration.velocities(
            model,
            &mut self.matrix,
            &self.x,
            &mut self.v,
            &rates,
            effort,
        );
        if !residual.is_finite() {
            return Err(not_converged(
                state.t,
                h,
                effort,
                Reason::LinearAlgebra,
                residual,
                strain,
            ));
        }
        self.set_balance(model, state, h);
        let solver = &mut proposal.solver;
        solver.balance.copy_from(&self.balance);
        solver.state.x.copy_from_slice(&self.x);
        solver.state.v.copy_from_slice(&self.v);
        solver.state.t = end;
        proposal.account = StepAccount::without_contact(residual, work, StepOutcome::Newton);
        Ok(())
    }
}

impl ProjectionStep {
    /// Sets `x` and `predicted` to where forces and inertia alone would take the sheet.
    fn predict(
        &mut self,
        model: &SheetModel,
        state: &State,
        h: f64,
        effort: &mut SolverEffort<'_>,
    ) -> Result<(), StepError> {
        model.potential_force(state.t, &state.x, &mut self.force);
        model.applied_force(state.t, &state.x, &state.v, &mut self.applied);
        for (f, a) in self.force.iter_mut().zip(&self.applied) {
            *f += a;
        }
        let end = state.t + h;
        if model.moving_pins().next().is_some() {
            // The accelerations of the pins load their neighbours through a consistent mass matrix.
            self.x.copy_from_slice(&state.x);
            model.place_pins(end, &mut self.x);
            self.acceleration.fill(0.0);
            for i in model.moving_pins().flat_map(|v| 3 * v..3 * v + 3) {
                self.acceleration[i] = ((self.x[i] - state.x[i]) / h - state.v[i]) / h;
            }
            model.apply_mass(&self.acceleration, &mut self.v);
            for (f, m) in self.force.iter_mut().zip(&self.v) {
                *f -= m;
            }
        }
        self.x.copy_from_slice(&state.x);
        self.accelerate(model, effort)
            .map_err(|source| StepError::Linalg { t: state.t, source })?;
        for i in 0..self.x.len() {
            self.x[i] = state.x[i] + h * (state.v[i] + h * self.acceleration[i]);
        }
        model.place_pins(end, &mut self.x);
        self.predicted.copy_from_slice(&self.x);
        Ok(())
    }

    /// Projects `x` onto the lengths; returns the strain reached.
    fn project(
        &mut self,
        model: &SheetModel,
        state: &State,
        h: f64,
        effort: &mut SolverEffort<'_>,
    ) -> Result<f64, StepError> {
        let tolerance = self
            .options
            .strain_tolerance
            .max(strain_floor(model, state));
        let mut iterate = Iterate::without_contact(std::mem::take(&mut self.x));
        let strain = self.restoration.positions(
            model,
            &mut self.matrix,
            None,
            &mut iterate,
            RestorationGoal {
                tolerance,
                max_iterations: self.options.max_projections,
                may_be_far: false,
                t: state.t + h,
                loads: &[],
                matrix: FirstMatrix::Assembled,
            },
            effort,
        );
        self.x = iterate.into_x();
        if strain > tolerance || strain.is_nan() {
            return Err(not_converged(
                state.t,
                h,
                effort,
                Reason::DependentRods,
                0.0,
                strain,
            ));
        }
        // Where nothing moves that holds it, the start has the rest lengths too: a projection that ends
        // further away than it is not the nearest point, and would create energy.
        let distance = |x: &[f64], v: &mut Vec<f64>, predicted: &[f64]| {
            for i in 0..x.len() {
                v[i] = x[i] - predicted[i];
            }
            model.kinetic_energy(v)
        };
        let to_result = distance(&self.x, &mut self.v, &self.predicted);
        let to_start = distance(&state.x, &mut self.v, &self.predicted);
        if !model.has_drives() && to_result > to_start * (1.0 + DISTANCE_SLACK) {
            return Err(not_converged(
                state.t,
                h,
                effort,
                Reason::AboveStart,
                0.0,
                strain,
            ));
        }
        Ok(strain)
    }
}
