//! What all phases of a minimisation work on.

use super::lagrangian::Lagrangian;
use super::problem::StepProblem;
use crate::damped::restoration::{Barriers, FirstMatrix, Restoration, RestorationGoal};
use crate::report::effort::SolverEffort;
use crate::step::reaction::{Balance, ForceTime};
use crate::step::tuning::Tuning;
use crate::{ImplicitOptions, SheetModel};
use isosheet_linalg::LinalgError;
use isosheet_model::StepError;
use isosheet_model::strain_floor;

/// The Lagrangian at the iterate, the restoration of the lengths, and what one step leaves to the next.
pub(crate) struct Workspace {
    pub(super) options: ImplicitOptions,
    /// Relative to the inertia term, the decrease below which a search has converged.
    pub(super) tolerance: f64,
    pub(super) tuning: Tuning,
    pub(super) lagrangian: Lagrangian,
    pub(super) restoration: Restoration,
    /// What a term or a potential refused in the present step.
    pub(super) refusal: Option<StepError>,
    /// Forces of the supports at the result.
    pub(crate) balance: Balance,
    /// Multipliers of the step before, scaled to this one; zero where there are none.
    pub(super) remembered: Vec<f64>,
    /// Stiffness of the rods in the linear systems, in units of that of the masses: that of the step before,
    /// and after a minimisation that of this one. Zero where there was none.
    pub(super) rod_stiffness: f64,
}

/// What a restoration of the lengths is to reach.
#[derive(Debug, Clone, Copy)]
pub(super) struct LengthGoal {
    /// Largest strain of the isometry.
    pub(super) strain: f64,
    pub(super) max_iterations: usize,
    pub(super) matrix: FirstMatrix,
}

impl Workspace {
    pub(super) fn new(
        model: &SheetModel,
        options: ImplicitOptions,
        tuning: Tuning,
    ) -> Result<Self, LinalgError> {
        Ok(Self {
            lagrangian: Lagrangian::new(model, tuning)?,
            restoration: Restoration::new(model, tuning),
            refusal: None,
            balance: Balance::with_residual(model, ForceTime::End),
            remembered: vec![0.0; model.rods().len()],
            rod_stiffness: 0.0,
            tolerance: options.tolerance_of(model),
            options,
            tuning,
        })
    }

    /// Restores the lengths at the iterate against the given loads of the supports and the contact forces.
    /// Returns the strain reached. The forces of the supports are those before, with their share in the
    /// restoration.
    pub(super) fn restore(
        &mut self,
        problem: &mut StepProblem<'_>,
        to: LengthGoal,
        effort: &mut SolverEffort<'_>,
    ) -> f64 {
        let per = 1.0 / problem.h().powi(2);
        let is_last = to.strain <= self.strain_tolerance(problem);
        if is_last {
            self.set_balance(problem);
        }
        let (model, t) = (problem.model, problem.t());
        let lagrangian = &mut self.lagrangian;
        let goal = RestorationGoal {
            tolerance: to.strain,
            max_iterations: to.max_iterations.min(self.options.max_projections),
            may_be_far: !is_last,
            t,
            loads: &lagrangian.vertex_rows.multipliers,
            matrix: to.matrix,
        };
        let barriers = Barriers {
            objective: problem.objective,
            memories: problem.memories,
            scale: 1.0 / per,
        };
        let (matrix, x) = (&mut lagrangian.matrix, &mut lagrangian.x);
        let strain = self
            .restoration
            .positions(model, matrix, Some(barriers), x, goal, effort);
        if is_last {
            self.balance
                .residual_momentum
                .append(&self.restoration.residual_momentum, per);
        }
        strain
    }

    /// Edge strain that accepted positions may have.
    pub(super) fn strain_tolerance(&self, problem: &StepProblem<'_>) -> f64 {
        let floor = strain_floor(problem.model, problem.state());
        self.options.strain_tolerance.max(floor)
    }

    /// Forces of the supports at the iterate, with what it leaves unbalanced.
    fn set_balance(&mut self, problem: &mut StepProblem<'_>) {
        let (model, h) = (problem.model, problem.h());
        let per = 1.0 / (h * h);
        let lagrangian = &mut self.lagrangian;
        let (objective, at) = problem.objective_at(&lagrangian.x);
        let add = |out: &mut [f64]| objective.add_unbalanced(at, h, out);
        if !self.balance.begin_with(add) {
            return;
        }
        let (rows, x) = (&lagrangian.vertex_rows, &lagrangian.x);
        self.balance
            .add_rods(model, x, &lagrangian.multipliers, per);
        self.balance.add_constraints(rows, &rows.multipliers, per);
        self.balance.leave(model, x, &rows.active);
    }
}
