//! Corrections of small length errors with a matrix that is factorised already.

use super::{Barriers, Restoration};
use crate::SheetModel;
use crate::linear::constrained::{ConstrainedSystem, SupportRows};
use crate::linear::primal::PrimalMatrix;

impl Restoration {
    /// Brings the largest strain towards `target` with the matrix `K = H + G^T r G` that was factorised last,
    /// by corrections
    ///
    /// ```text
    /// K dx = -G^T r c(x)
    /// ```
    ///
    /// with the `G` of the matrix: the chord method. Each leaves a part of the error that is as small as the
    /// displacement from where the matrix was assembled. After a step of Newton's method on the incremental
    /// potential `H` is its Hessian, and a correction is the displacement that raises the potential least.
    /// Ends where a correction gains too little, and stays where the best one has led. The constraints have
    /// to be evaluated at `x`, and there must be none at vertices.
    pub(super) fn correct(
        &mut self,
        model: &SheetModel,
        matrix: &mut PrimalMatrix,
        mut barriers: Option<&mut Barriers<'_>>,
        x: &mut [f64],
        (t, target): (f64, f64),
    ) {
        let mut strain = self.worst(model, x);
        loop {
            if strain <= target || strain.is_nan() {
                return;
            }
            if matrix.linearisation().is_none() {
                return;
            }
            for (r, c) in self.solver.residual.rods.iter_mut().zip(&self.c) {
                *r = -c;
            }
            let mut system = ConstrainedSystem {
                model,
                matrix,
                supports: SupportRows::None,
            };
            self.dx.fill(0.0);
            self.solver.pass(&mut system, &mut self.dx);
            self.start.copy_from_slice(x);
            self.keep_barrier_forces(barriers.as_deref_mut(), t, x);
            if self.safe_part(barriers.as_deref_mut(), t, x) < 1.0 {
                return;
            }
            for (x, d) in x.iter_mut().zip(&self.dx) {
                *x += d;
            }
            self.evaluate(model, t, x);
            let before = strain;
            strain = self.worst(model, x);
            if strain >= before || strain.is_nan() {
                x.copy_from_slice(&self.start);
                self.evaluate(model, t, x);
                return;
            }
            let rods_at = matrix.linearisation().map(|l| l.x);
            self.keep_momentum(model, barriers.as_deref_mut(), (t, x), rods_at);
            if strain > self.tuning.contraction() * before {
                return;
            }
        }
    }
}
