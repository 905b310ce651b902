//! Conjugate gradients on a matrix that differs from a factorised one by its far couplings.

use super::far::FarCouplings;
use isosheet_materials::vectors::dot;

/// Working memory, in free coordinates.
#[derive(Debug)]
pub(super) struct ConjugateGradients {
    /// The solution.
    pub(super) x: Vec<f64>,
    residual: Vec<f64>,
    /// The factorised matrix applied inversely to the residual.
    preconditioned: Vec<f64>,
    direction: Vec<f64>,
    /// The factorised matrix times the direction.
    near_image: Vec<f64>,
    /// The whole matrix times the direction.
    image: Vec<f64>,
}

/// How an iteration ended.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum IterationEnd {
    /// With a solution of the accuracy wanted.
    Solved,
    /// The number of iterations did not suffice.
    TooSlow,
    /// The whole matrix is not positive definite.
    NotDefinite,
}

/// When the iteration ends.
#[derive(Debug, Clone, Copy)]
pub(super) struct Goal {
    /// Error of the solution in the norm of the matrix, relative to what the factorised matrix alone makes.
    pub(super) relative: f64,
    pub(super) max_iterations: usize,
}

impl ConjugateGradients {
    pub(super) fn new(order: usize) -> Self {
        let zeros = || vec![0.0; order];
        Self {
            x: zeros(),
            residual: zeros(),
            preconditioned: zeros(),
            direction: zeros(),
            near_image: zeros(),
            image: zeros(),
        }
    }

    /// Solves `(M + E) x = b` with `M`, not less than `M + E`, which `solve` applies inversely, and the
    /// difference `E` that the far couplings make.
    ///
    /// The iteration starts at `x = M^-1 b`, which is exact where `E` does not matter, as along stiff rods:
    /// the residual is `-E x`, and what is measured from there on is the error in soft directions. Since
    /// directions are `p = M^-1 r + beta p`, their products `M p = r + beta M p` need no multiplication by
    /// `M`. Each iteration takes `alpha r . M^-1 r` off the square of the error in the norm of `M + E`; the
    /// iteration ends where that falls below a part of what all iterations have taken off, and of `-x . E x`,
    /// what `M` was too stiff by for the first `x`. (S. G. Nash and A. Sofer, "Assessing a search direction
    /// within a truncated-Newton method", Oper. Res. Lett. 9, 1990.)
    pub(super) fn solve(
        &mut self,
        solve: &mut impl FnMut(&mut [f64]),
        far: &FarCouplings,
        b: &[f64],
        goal: Goal,
    ) -> (IterationEnd, usize) {
        self.x.copy_from_slice(b);
        solve(&mut self.x);
        self.residual.fill(0.0);
        far.add_difference(&self.x, &mut self.residual);
        self.residual.iter_mut().for_each(|r| *r = -*r);
        let mut gained = dot(&self.x, &self.residual);
        let mut previous = f64::INFINITY;
        self.direction.fill(0.0);
        self.near_image.fill(0.0);
        for iteration in 0..goal.max_iterations {
            self.preconditioned.copy_from_slice(&self.residual);
            solve(&mut self.preconditioned);
            let square = dot(&self.residual, &self.preconditioned);
            if square == 0.0 {
                return (IterationEnd::Solved, iteration);
            }
            let beta = square / previous;
            previous = square;
            for i in 0..b.len() {
                self.direction[i] = self.preconditioned[i] + beta * self.direction[i];
                self.near_image[i] = self.residual[i] + beta * self.near_image[i];
            }
            self.image.copy_from_slice(&self.near_image);
            far.add_difference(&self.direction, &mut self.image);
            let curvature = dot(&self.direction, &self.image);
            if !(curvature > 0.0 && square > 0.0) {
                return (IterationEnd::NotDefinite, iteration + 1);
            }
            let length = square / curvature;
            for i in 0..b.len() {
                self.x[i] += length * self.direction[i];
                self.residual[i] -= length * self.image[i];
            }
            let gain = length * square;
            gained += gain;
            if gain <= goal.relative * goal.relative * gained {
                return (IterationEnd::Solved, iteration + 1);
            }
        }
        (IterationEnd::TooSlow, goal.max_iterations)
    }
}
