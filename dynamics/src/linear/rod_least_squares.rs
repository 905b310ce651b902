//! Least squares with the rigidity matrix of rods that may depend on each other.

use crate::SheetModel;
use crate::linear::constrained::{ConstrainedSolver, ConstrainedSystem, SupportRows};
use crate::linear::primal::PrimalMatrix;

/// Passes of the regularisation. Of a singular value `s` the part `(s0^2 / (s^2 + s0^2))^4` is left over: of
/// ten times the bound 1e-8.
const PASSES: usize = 4;

/// Least-squares solutions of `A y = r` with the rigidity matrix `A` of unit rods, whose rows are
/// `a_e = (x_a - x_b) / l_e`, by iterated Tikhonov regularisation: `(s0^2 M / m + A^T A) y = A^T r` with a
/// bound `s0` of singular values and the mean mass `m`, see [`ConstrainedSolver`].
pub(crate) struct RodLeastSquares<'a> {
    model: &'a SheetModel,
    matrix: PrimalMatrix,
    solver: ConstrainedSolver,
}

impl<'a> RodLeastSquares<'a> {
    /// At positions `x` (`3V`, metres) with the bound `smallest` of singular values. Nothing if the memory
    /// for the matrix runs out, or a position is not finite.
    pub(crate) fn new(model: &'a SheetModel, x: &[f64], smallest: f64) -> Option<Self> {
        let lengths = model.rods().lengths();
        let unit = model.mean_mass() / (smallest * smallest);
        let mut matrix = PrimalMatrix::of_rods(model).ok()?;
        let axial: Vec<f64> = lengths.iter().map(|l| unit / (l * l)).collect();
        matrix.assemble(model, x, &axial, &vec![0.0; lengths.len()]);
        matrix.factorize().ok()?;
        let solver = ConstrainedSolver::new(model);
        Some(Self {
            model,
            matrix,
            solver,
        })
    }

    /// Splits `r` into `A y` and the part that no `y` reaches; returns `y`, and sets `r` to that part.
    pub(crate) fn reduce(&mut self, r: &mut [f64]) -> Vec<f64> {
        let lengths = self.model.rods().lengths();
        let solver = &mut self.solver;
        for (left, (r, l)) in solver.residual.rods.iter_mut().zip(r.iter().zip(lengths)) {
            *left = r * l;
        }
        let mut system = ConstrainedSystem {
            model: self.model,
            matrix: &mut self.matrix,
            supports: SupportRows::None,
        };
        let mut y = vec![0.0; self.model.coordinate_count()];
        for _ in 0..PASSES {
            solver.pass(&mut system, &mut y);
        }
        for (r, (left, l)) in r.iter_mut().zip(solver.residual.rods.iter().zip(lengths)) {
            *r = left / l;
        }
        y
    }
}
