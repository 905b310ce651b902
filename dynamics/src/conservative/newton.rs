//! Newton's method for the velocity of a step and the impulses that keep the lengths in it.

use crate::conservative::constraints::ConservativeRows;
use crate::conservative::saddle::{SaddleMatrix, System};
use crate::report::effort::SolverEffort;
use crate::report::step_report::StepOutcome;
use crate::step::history::Multipliers;
use crate::{SheetModel, State};
use isosheet_linalg::LinalgError;
use isosheet_materials::potential::Memories;
use isosheet_model::StepError;
use isosheet_model::velocity_round_off;

/// The unknowns of a step of `h` seconds from `x0` to `x1 = x0 + h u`, its residuals and its matrix.
pub(super) struct Newton {
    matrix: SaddleMatrix,
    /// Velocity `u` over the step (`3V`), metres per second.
    pub(super) u: Vec<f64>,
    /// Positions `x1` at the end (`3V`), metres.
    pub(super) x1: Vec<f64>,
    /// Impulses of the rods, in units of their equations.
    pub(super) impulse: Vec<f64>,
    /// The vertex constraints with their impulses.
    pub(super) constraints: ConservativeRows,
    /// Negative residuals of the momentum balance (`3V`); after a solution the change of the velocity.
    pub(super) momentum: Vec<f64>,
    /// Negative residuals of the lengths over `h`; after a solution the change of the impulses.
    pub(super) rods: Vec<f64>,
}

/// What the matrix of an iteration has besides the unknowns; see [`System`].
pub(super) struct Terms<'a> {
    pub(super) mass: f64,
    pub(super) density: &'a [f64],
    /// Positions at which the impulses act; those at the end of the step where there are none.
    pub(super) left: Option<&'a [f64]>,
    pub(super) potentials: Option<(&'a Memories, f64, &'a [f64], f64)>,
}

impl Newton {
    /// Analyses the model.
    ///
    /// # Errors
    /// [`LinalgError::Symbolic`] if memory runs out.
    pub(super) fn new(model: &SheetModel) -> Result<Self, LinalgError> {
        let (n, m) = (model.coordinate_count(), model.rods().len());
        Ok(Self {
            matrix: SaddleMatrix::new(model)?,
            u: vec![0.0; n],
            x1: vec![0.0; n],
            impulse: vec![0.0; m],
            constraints: ConservativeRows::new(model.constrained_vertices()),
            momentum: vec![0.0; n],
            rods: vec![0.0; m],
        })
    }

    /// The first guess of the impulses: the impulses of the step before, times a factor.
    pub(super) fn begin(
        &mut self,
        model: &SheetModel,
        state: &State,
        (ratio, last): (f64, &Multipliers),
    ) {
        for (e, l) in self.impulse.iter_mut().enumerate() {
            *l = last.rods.get(e).map_or(0.0, |i| ratio * i);
        }
        let (t, x, before) = (state.t, &state.x, &last.constraints);
        self.constraints
            .begin(model.constraints(), t, x, ratio, before);
    }

    /// Sets the velocities of pins in prescribed motion.
    pub(super) fn set_pins(&mut self, model: &SheetModel, state: &State, h: f64) {
        model.place_pins(state.t + h, &mut self.x1);
        for i in model.moving_pins().flat_map(|v| 3 * v..3 * v + 3) {
            self.u[i] = (self.x1[i] - state.x[i]) / h;
        }
    }

    /// Sets the positions at the end.
    pub(super) fn set_end(&mut self, model: &SheetModel, state: &State, h: f64) {
        for i in 0..self.u.len() {
            self.x1[i] = state.x[i] + h * self.u[i];
        }
        model.place_pins(state.t + h, &mut self.x1);
    }

    /// Adds the impulses, which act along the rods at `left`, to the momentum balance, and sets the residuals
    /// of the lengths; returns the largest residual of the balance relative to a velocity, and the strain.
    pub(super) fn close(
        &mut self,
        model: &SheetModel,
        state: &State,
        h: f64,
        left: &[f64],
        velocity: f64,
    ) -> (f64, f64) {
        let (rods, constraints) = (model.rods(), &mut self.constraints);
        rods.apply_transpose_add(left, &self.impulse, &mut self.momentum);
        constraints.add_impulses(&constraints.impulses, &mut self.momentum);
        constraints.linearise(model.constraints(), state.t + h, &self.x1, 1.0 / h);
        model.clear_pinned(&mut self.momentum);
        rods.residual_into(&self.x1, &mut self.rods);
        self.rods.iter_mut().for_each(|c| *c = -*c / h);
        let worst = model.largest_acceleration(&self.momentum);
        let relative = if worst > velocity_round_off(state, h) {
            worst / velocity.max(f64::MIN_POSITIVE)
        } else {
            0.0
        };
        (relative, constraints.worst(rods.max_strain(&self.x1)))
    }

    /// One iteration: solves the linear system of the residuals and adds the solution to the unknowns.
    ///
    /// # Errors
    /// [`StepError::Linalg`] if the system cannot be solved.
    pub(super) fn correct(
        &mut self,
        model: &SheetModel,
        t: f64,
        terms: &Terms<'_>,
        effort: &mut SolverEffort<'_>,
    ) -> Result<StepOutcome, StepError> {
        effort.iterations += 1;
        let outcome = self.solve(model, t, terms, effort)?;
        for (u, d) in self.u.iter_mut().zip(&self.momentum) {
            *u += d;
        }
        for (l, d) in self.impulse.iter_mut().zip(&self.rods) {
            *l += d;
        }
        self.constraints.correct();
        Ok(outcome)
    }

    /// Solves the linear system with rods linearised at the end of the step; the solution takes the place of
    /// the residuals.
    ///
    /// # Errors
    /// [`StepError::Linalg`] if the system cannot be solved.
    pub(super) fn solve(
        &mut self,
        model: &SheetModel,
        t: f64,
        terms: &Terms<'_>,
        effort: &mut SolverEffort<'_>,
    ) -> Result<StepOutcome, StepError> {
        let ConservativeRows { blocks, rhs, .. } = &mut self.constraints;
        let system = System {
            mass: terms.mass,
            density: terms.density,
            left: terms.left.unwrap_or(&self.x1),
            right: &self.x1,
            potentials: terms.potentials,
            constraints: blocks,
        };
        let (momentum, rods) = (&mut self.momentum, &mut self.rods);
        self.matrix
            .solve(model, &system, momentum, rods, rhs, effort)
            .map_err(|source| StepError::Linalg { t, source })
    }
}
