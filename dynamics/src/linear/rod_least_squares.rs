//! Least squares with the rigidity matrix of rods that may depend on each other.

use crate::SheetModel;
use crate::linear::primal::PrimalMatrix;

/// Least-squares solutions of `A y = r` with the rigidity matrix `A` of unit rods, whose rows are
/// `a_e = (x_a - x_b) / l_e`, by iterated Tikhonov regularisation: `(s0^2 M / m + A^T A) y = A^T r` with a bound `s0` of
/// singular values and the mean mass `m` (Engl, Hanke and Neubauer, "Regularization of Inverse Problems", 1996,
/// Sec. 5.1).
pub(crate) struct RodLeastSquares {
    matrix: PrimalMatrix,
    /// `m / s0^2`.
    unit: f64,
    w: Vec<f64>,
    load: Vec<f64>,
    y: Vec<f64>,
}

impl RodLeastSquares {
    /// At positions `x` (`3V`, metres) with the bound `smallest` of singular values. Nothing if the memory for the
    /// matrix runs out, or a position is not finite.
    pub(crate) fn new(model: &SheetModel, x: &[f64], smallest: f64) -> Option<Self> {
        let rods = model.rods();
        let unit = model.mean_mass() / (smallest * smallest);
        let mut matrix = PrimalMatrix::of_rods(model).ok()?;
        let axial: Vec<f64> = rods.lengths().iter().map(|l| unit / (l * l)).collect();
        matrix.assemble(model, x, &axial, &vec![0.0; rods.len()]);
        matrix.factorize().ok()?;
        Some(Self {
            matrix,
            unit,
            w: vec![0.0; rods.len()],
            load: vec![0.0; x.len()],
            y: vec![0.0; x.len()],
        })
    }

    /// Subtracts the solution `y` of `A y = r` from `d`, and `A y` from `r`, which keeps the part that no `y`
    /// reaches. Of a singular value `s` the part `(s0^2 / (s^2 + s0^2))^passes` is left over.
    pub(crate) fn reduce(
        &mut self,
        model: &SheetModel,
        x: &[f64],
        passes: usize,
        r: &mut [f64],
        d: &mut [f64],
    ) {
        let rods = model.rods();
        for _ in 0..passes {
            for (w, (r, l)) in self.w.iter_mut().zip(r.iter().zip(rods.lengths())) {
                *w = self.unit * r / l;
            }
            self.load.fill(0.0);
            rods.apply_transpose_add(x, &self.w, &mut self.load);
            model.clear_pinned(&mut self.load);
            self.matrix.solve(model, &self.load, &mut self.y);
            rods.apply(x, &self.y, &mut self.w);
            for (r, (w, l)) in r.iter_mut().zip(self.w.iter().zip(rods.lengths())) {
                *r -= w / l;
            }
            for (d, y) in d.iter_mut().zip(&self.y) {
                *d -= y;
            }
        }
    }
}
