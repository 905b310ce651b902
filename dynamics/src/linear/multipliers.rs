//! Multipliers of linearised equations of isometry, by conjugate gradients.

use crate::SheetModel;
use crate::linear::primal::PrimalMatrix;
use crate::vectors::dot;

/// Improves the multipliers of a linearised step.
///
/// With the penalties `R` of the equations and the factorised matrix `K = H + G^T R G` a step `-dx` for
/// given multipliers `L` is `K dx = g + G^T (L + R c)`, and leaves the violation `c - G dx`. It vanishes
/// for `L + dL` with
///
/// ```text
/// S dL = c - G dx,   S = G K^-1 G^T.
/// ```
///
/// The eigenvalues of `R S` lie between 0 and 1, nearly all of them close to 1: the method of multipliers,
/// `dL = R (c - G dx)`, is one Richardson iteration. Conjugate gradients preconditioned by `R` need about one
/// iteration, which is one solve with the factorisation at hand, for each eigenvalue that is not close to 1.
/// These belong to nearly dependent equations. Where `K` is factorised without its far couplings, the corrections
/// are those of that matrix, which differs from `K` across the rods alone. (M. Fortin and R. Glowinski, "Augmented Lagrangian Methods",
/// 1983, chapter 2.)
#[derive(Debug)]
pub(crate) struct MultiplierSolver {
    /// `c - G dx`.
    residual: Vec<f64>,
    direction: Vec<f64>,
    /// `S` times the direction.
    image: Vec<f64>,
    /// `G^T` times the direction (`3V`).
    force: Vec<f64>,
    /// `K^-1` times that (`3V`).
    step: Vec<f64>,
}

/// The linearised equations and the factorised matrix.
pub(crate) struct LinearisedRows<'a> {
    pub(crate) model: &'a SheetModel,
    /// `K`, factorised.
    pub(crate) matrix: &'a mut PrimalMatrix,
    /// Where the equations are linearised (`3V`, metres).
    pub(crate) x: &'a [f64],
    /// Their values there, which the step is to take to zero.
    pub(crate) values: &'a [f64],
    /// The penalties `R`: this factor times the penalties of equations that are as stiff as the masses.
    pub(crate) stiffness: f64,
    pub(crate) unit_penalty: &'a [f64],
}

/// When the iteration ends.
#[derive(Debug, Clone, Copy)]
pub(crate) struct MultiplierGoal {
    pub(crate) max_iterations: usize,
    /// Violation that is small enough, as a strain.
    pub(crate) violation: f64,
    /// Change of the multipliers, relative to the largest, from which an iteration is not worth its solve.
    pub(crate) change: f64,
    /// Length of an iteration from which equations count as dependent, and the iteration ends: the inverse
    /// of an eigenvalue.
    pub(crate) longest: f64,
}

impl MultiplierSolver {
    pub(crate) fn new(model: &SheetModel) -> Self {
        let (n, m) = (model.coordinate_count(), model.rods().len());
        Self {
            residual: vec![0.0; m],
            direction: vec![0.0; m],
            image: vec![0.0; m],
            force: vec![0.0; n],
            step: vec![0.0; n],
        }
    }

    /// Improves multipliers and the step `-dx` that was solved for with them. The step becomes stationary
    /// with the multipliers. Returns the violation that the step leaves, as a strain.
    pub(crate) fn improve(
        &mut self,
        system: &mut LinearisedRows<'_>,
        multipliers: &mut [f64],
        dx: &mut [f64],
        goal: MultiplierGoal,
    ) -> f64 {
        let rods = system.model.rods();
        rods.apply(system.x, dx, &mut self.residual);
        for (r, c) in self.residual.iter_mut().zip(system.values) {
            *r = c - *r;
        }
        let mut previous = f64::INFINITY;
        self.direction.fill(0.0);
        for _ in 0..goal.max_iterations {
            if self.violation(system) <= goal.violation {
                break;
            }
            let mut square = 0.0;
            for (e, r) in self.residual.iter().enumerate() {
                square += system.penalty(e) * r * r;
            }
            for (e, d) in self.direction.iter_mut().enumerate() {
                *d = system.penalty(e) * self.residual[e] + square / previous * *d;
            }
            previous = square;
            let length = square / self.apply(system);
            if !(length > 0.0 && length <= goal.longest) {
                break;
            }
            let (mut change, mut largest) = (0.0_f64, 0.0_f64);
            for (e, d) in self.direction.iter().enumerate() {
                multipliers[e] += length * d;
                self.residual[e] -= length * self.image[e];
                change = change.max((length * d).abs());
                largest = largest.max(multipliers[e].abs());
            }
            for (d, s) in dx.iter_mut().zip(&self.step) {
                *d += length * s;
            }
            if change <= goal.change * largest {
                break;
            }
        }
        for (e, r) in self.residual.iter().enumerate() {
            multipliers[e] += system.penalty(e) * r;
        }
        self.violation(system)
    }

    /// Sets `image = S direction` and `step = K^-1 G^T direction`; the product of direction and image.
    fn apply(&mut self, system: &mut LinearisedRows<'_>) -> f64 {
        let (model, x) = (system.model, system.x);
        let rods = model.rods();
        self.force.fill(0.0);
        rods.apply_transpose_add(x, &self.direction, &mut self.force);
        model.clear_pinned(&mut self.force);
        system.matrix.solve(model, &self.force, &mut self.step);
        rods.apply(x, &self.step, &mut self.image);
        dot(&self.direction, &self.image)
    }

    /// Largest violation that the step leaves, as a strain.
    fn violation(&self, system: &LinearisedRows<'_>) -> f64 {
        let strains = self.residual.iter().zip(system.model.rods().lengths());
        strains.fold(0.0, |m: f64, (r, l)| m.max(r.abs() / (l * l)))
    }
}

impl LinearisedRows<'_> {
    fn penalty(&self, e: usize) -> f64 {
        self.stiffness * self.unit_penalty[e]
    }
}

#[cfg(test)]
mod tests;
