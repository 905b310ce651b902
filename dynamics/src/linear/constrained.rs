//! Linear systems with the equations of rods and supports: the one solver for search directions, projections
//! of velocities, forces of supports and certificates.

use crate::SheetModel;
use crate::linear::constraint_rows::VertexRows;
use crate::linear::primal::PrimalMatrix;
use isosheet_materials::vectors::{add, dot, point};
use nalgebra::Vector3;

#[cfg(test)]
mod tests;

/// One number for each rod, and three for each vertex constraint.
#[derive(Debug, Clone)]
pub(crate) struct RowValues {
    pub(crate) rods: Vec<f64>,
    pub(crate) supports: Vec<Vector3<f64>>,
}

impl RowValues {
    pub(crate) fn new(model: &SheetModel) -> Self {
        Self {
            rods: vec![0.0; model.rods().len()],
            supports: vec![Vector3::zeros(); model.constraints().len()],
        }
    }

    pub(crate) fn clear(&mut self) {
        self.rods.fill(0.0);
        self.supports.fill(Vector3::zeros());
    }

    fn scale(&mut self, factor: f64) {
        self.rods.iter_mut().for_each(|a| *a *= factor);
        self.supports.iter_mut().for_each(|a| *a *= factor);
    }

    /// Adds a multiple of other values.
    fn add(&mut self, factor: f64, other: &Self) {
        for (a, b) in self.rods.iter_mut().zip(&other.rods) {
            *a += factor * b;
        }
        for (a, b) in self.supports.iter_mut().zip(&other.supports) {
            *a += factor * b;
        }
    }

    fn dot(&self, other: &Self) -> f64 {
        let supports = self.supports.iter().zip(&other.supports);
        dot(&self.rods, &other.rods) + supports.map(|(a, b)| a.dot(b)).sum::<f64>()
    }

    /// Largest values of rods and of supports.
    fn largest(&self) -> [f64; 2] {
        let rods = self.rods.iter().fold(0.0, |m: f64, a| m.max(a.abs()));
        let supports = self.supports.iter().fold(0.0, |m: f64, a| m.max(a.norm()));
        [rods, supports]
    }
}

/// Solves
///
/// ```text
/// H y - A^T m = f,   A y = r
/// ```
///
/// for `y` (`3V`, zero at pinned vertices) and the multipliers `m`, where `A` has the rows `G` of the rods
/// and `J` of those vertex constraints that are equalities, by way of the factorised matrix `K = H + A^T R A`
/// with penalties `R`.
///
/// With `K y = f + A^T (m + R r)` for given multipliers the equations have the residual `r - A y`. It
/// vanishes for `m + dm` with
///
/// ```text
/// S dm = r - A y,   S = A K^-1 A^T.
/// ```
///
/// The eigenvalues of `R S` lie between 0 and 1, nearly all of them close to 1: the method of multipliers,
/// `dm = R (r - A y)`, is one Richardson iteration ([`ConstrainedSolver::pass`]). Conjugate gradients
/// preconditioned by `R` ([`ConstrainedSolver::improve`]) need about one iteration, which is one solve with
/// the factorisation at hand, for each eigenvalue that is not close to 1. These belong to nearly dependent
/// equations. (M. Fortin and R. Glowinski, "Augmented Lagrangian Methods", 1983, chapter 2.)
///
/// Where the equations depend on each other and `H = s^2 M`, passes are iterated Tikhonov regularisation of
/// the least squares of `r - A y` (Engl, Hanke and Neubauer, "Regularization of Inverse Problems", 1996, Sec.
/// 5.1).
///
/// Where `K` is factorised without its far couplings, the iterations use that matrix, which differs from `K`
/// across the rods alone.
#[derive(Debug)]
pub(crate) struct ConstrainedSolver {
    /// `r - A y`.
    pub(crate) residual: RowValues,
    /// `m`.
    pub(crate) multipliers: RowValues,
    /// The change of the multipliers that is tried.
    direction: RowValues,
    /// `A` times the change of `y` for that.
    image: RowValues,
    /// `A^T` times the direction (`3V`).
    force: Vec<f64>,
    /// The change of `y` for the direction (`3V`).
    step: Vec<f64>,
}

/// The linearised equations and the factorised matrix, which has the positions and the penalties of the rods.
pub(crate) struct ConstrainedSystem<'a> {
    pub(crate) model: &'a SheetModel,
    /// `K`, factorised.
    pub(crate) matrix: &'a mut PrimalMatrix,
    pub(crate) supports: SupportRows<'a>,
}

/// The equations of vertex constraints, as last evaluated.
#[derive(Clone, Copy)]
pub(crate) enum SupportRows<'a> {
    /// None take part.
    None,
    /// The equalities, with these times their own penalties.
    Equalities { rows: &'a VertexRows, penalty: f64 },
}

/// When conjugate gradients end.
#[derive(Debug, Clone, Copy)]
pub(crate) struct MultiplierGoal {
    pub(crate) max_iterations: usize,
    /// Residual that is small enough, as a strain.
    pub(crate) violation: f64,
    /// Change of the multipliers, relative to the largest, from which an iteration is not worth its solve.
    pub(crate) change: f64,
    /// Length of an iteration from which equations count as dependent, and the iteration ends: the inverse
    /// of an eigenvalue.
    pub(crate) longest: f64,
}

impl ConstrainedSolver {
    pub(crate) fn new(model: &SheetModel) -> Self {
        let n = model.coordinate_count();
        let rows = RowValues::new(model);
        Self {
            residual: rows.clone(),
            multipliers: rows.clone(),
            direction: rows.clone(),
            image: rows,
            force: vec![0.0; n],
            step: vec![0.0; n],
        }
    }

    /// Sets the residual, which holds `r`, to `r - A y`.
    pub(crate) fn subtract(&mut self, system: &ConstrainedSystem<'_>, y: &[f64]) {
        system.apply(y, &mut self.image);
        self.residual.add(-1.0, &self.image);
    }

    /// Improves multipliers and `y` by conjugate gradients. `y` and the residual belong to the multipliers;
    /// `y` becomes stationary with the multipliers. Returns the residual that is left, as a strain.
    pub(crate) fn improve(
        &mut self,
        system: &mut ConstrainedSystem<'_>,
        y: &mut [f64],
        goal: MultiplierGoal,
    ) -> f64 {
        let mut previous = f64::INFINITY;
        self.direction.clear();
        for _ in 0..goal.max_iterations {
            if self.violation(system) <= goal.violation {
                break;
            }
            system.weigh(&self.residual, &mut self.image);
            let square = self.image.dot(&self.residual);
            self.direction.scale(square / previous);
            self.direction.add(1.0, &self.image);
            previous = square;
            let length = square / self.respond(system);
            if !(length > 0.0 && length <= goal.longest) {
                break;
            }
            self.advance(length, y);
            let change = self.direction.largest().map(|c| length * c);
            let largest = self.multipliers.largest();
            if (0..2).all(|i| change[i] <= goal.change * largest[i]) {
                break;
            }
        }
        self.update(system);
        self.violation(system)
    }

    /// Replaces the multipliers by their first-order estimates, `m + R (r - A y)`.
    pub(crate) fn update(&mut self, system: &ConstrainedSystem<'_>) {
        system.weigh(&self.residual, &mut self.direction);
        self.multipliers.add(1.0, &self.direction);
    }

    /// Improves multipliers and `y` by one iteration of the method of multipliers. Of an error in the
    /// direction of a singular value `s` of `R^1/2 A H^-1/2` the part `1 / (1 + s^2)` is left.
    pub(crate) fn pass(&mut self, system: &mut ConstrainedSystem<'_>, y: &mut [f64]) {
        system.weigh(&self.residual, &mut self.direction);
        self.respond(system);
        self.advance(1.0, y);
    }

    /// Sets the change of `y` and of `A y` for the direction; the product of the latter and the direction.
    fn respond(&mut self, system: &mut ConstrainedSystem<'_>) -> f64 {
        self.force.fill(0.0);
        system.apply_transpose_add(&self.direction, &mut self.force);
        system
            .matrix
            .solve(system.model, &self.force, &mut self.step);
        system.apply(&self.step, &mut self.image);
        self.direction.dot(&self.image)
    }

    fn advance(&mut self, length: f64, y: &mut [f64]) {
        self.multipliers.add(length, &self.direction);
        self.residual.add(-length, &self.image);
        for (y, s) in y.iter_mut().zip(&self.step) {
            *y += length * s;
        }
    }

    /// Largest residual, as a strain.
    fn violation(&self, system: &ConstrainedSystem<'_>) -> f64 {
        let rods = self.residual.rods.iter().zip(system.model.rods().lengths());
        let strain = rods.fold(0.0, |m: f64, (r, l)| m.max(r.abs() / (l * l)));
        match system.supports {
            SupportRows::None => strain,
            SupportRows::Equalities { rows, .. } => {
                let supports = self.residual.supports.iter().enumerate();
                supports.fold(strain, |m, (i, r)| m.max(r.norm() / rows.length(i)))
            }
        }
    }
}

impl ConstrainedSystem<'_> {
    /// Where the rods are linearised, and their penalties.
    fn rods(&self) -> [&[f64]; 2] {
        let linearisation = self.matrix.linearisation();
        let linearisation = linearisation.expect("the matrix is factorised");
        [linearisation.x, linearisation.penalties]
    }

    /// Sets `out = A y`, zero where a vertex constraint takes no part.
    pub(crate) fn apply(&self, y: &[f64], out: &mut RowValues) {
        let [x, _] = self.rods();
        self.model.rods().apply(x, y, &mut out.rods);
        for (i, o) in out.supports.iter_mut().enumerate() {
            *o = match self.supports {
                SupportRows::Equalities { rows, .. } if rows.equality_penalty(i).is_some() => {
                    rows.local(i).jacobian * point(y, rows.vertex(i))
                }
                _ => Vector3::zeros(),
            };
        }
    }

    /// Adds `A^T m` to `out`.
    pub(crate) fn apply_transpose_add(&self, m: &RowValues, out: &mut [f64]) {
        let [x, _] = self.rods();
        self.model.rods().apply_transpose_add(x, &m.rods, out);
        if let SupportRows::Equalities { rows, .. } = self.supports {
            for (i, m) in m.supports.iter().enumerate() {
                if rows.equality_penalty(i).is_some() {
                    add(out, rows.vertex(i), &rows.local(i).jacobian.tr_mul(m));
                }
            }
        }
    }

    /// Sets `out = R values`.
    fn weigh(&self, values: &RowValues, out: &mut RowValues) {
        let [_, penalties] = self.rods();
        for (o, (v, r)) in out.rods.iter_mut().zip(values.rods.iter().zip(penalties)) {
            *o = r * v;
        }
        match self.supports {
            SupportRows::None => out.supports.fill(Vector3::zeros()),
            SupportRows::Equalities { rows, penalty } => {
                for (i, o) in out.supports.iter_mut().enumerate() {
                    let own = rows.equality_penalty(i).unwrap_or(0.0);
                    *o = penalty * own * values.supports[i];
                }
            }
        }
    }
}
