//! The equations of all vertex constraints of a model, beside those of the rods.

use super::Local;
use crate::SheetModel;
use crate::primal::PrimalMatrix;
use isosheet_mesh::VertexId;
use nalgebra::{Matrix3, SymmetricEigen, Vector3};

/// Equations `c_i(x, t)` with multipliers and penalties: the augmented Lagrangian
///
/// ```text
/// L_i . c_i + p_i |c_i|^2 / 2,      one-sided (c_i >= 0):  (min(0, L_i + p_i c_i)^2 - L_i^2) / (2 p_i)
/// ```
///
/// with its derivatives (Rockafellar 1973 for the one-sided form). Empty, and free of cost, in scenes without
/// constraints.
pub(crate) struct VertexRows {
    /// Kilograms; zero at pinned vertices.
    penalties: Vec<f64>,
    /// Kilogram metres.
    pub(crate) multipliers: Vec<Vector3<f64>>,
    local: Vec<Local>,
    /// Whether a one-sided equation had to be mended since it was cleared.
    pub(crate) mended: Vec<bool>,
    /// Whether the equation took part in the last system of a projection or the last update of the
    /// multipliers.
    pub(crate) active: Vec<bool>,
    /// Whether the equation holds as an equality: always, unless it is one-sided.
    pub(crate) bound: Vec<bool>,
}

/// What to do with the curvature of constraints under load.
#[derive(Clone, Copy, PartialEq, Eq)]
pub(crate) enum Bending {
    /// As it is.
    Full,
    /// Its positive part.
    Positive,
}

impl VertexRows {
    /// With penalties of `kappa` times the mass of the vertex: like the rods, `kappa` times as stiff as
    /// inertia.
    pub(crate) fn new(model: &SheetModel, kappa: f64) -> Self {
        let constraints = model.constraints();
        Self {
            penalties: constraints
                .iter()
                .map(|c| {
                    if model.is_pinned(c.vertex()) {
                        0.0
                    } else {
                        kappa * model.mass().vertex[c.vertex().index()]
                    }
                })
                .collect(),
            multipliers: vec![Vector3::zeros(); constraints.len()],
            local: Vec::with_capacity(constraints.len()),
            mended: vec![false; constraints.len()],
            active: vec![false; constraints.len()],
            bound: constraints.iter().map(|c| !c.is_one_sided()).collect(),
        }
    }

    pub(crate) fn evaluate(&mut self, model: &SheetModel, t: f64, x: &[f64]) {
        self.local.clear();
        for c in model.constraints() {
            self.local.push(c.at(t, &point(x, c.vertex())));
        }
    }

    /// Kilogram metres: the force on the vertex is `-J^T density`, per squared step.
    pub(crate) fn density(&self, i: usize) -> Vector3<f64> {
        let d = self.multipliers[i] + self.penalties[i] * self.local[i].value;
        if self.bound[i] {
            d
        } else {
            Vector3::new(d.x.min(0.0), 0.0, 0.0)
        }
    }

    /// Whether a one-sided equation is at its bound.
    fn presses(&self, i: usize) -> bool {
        self.bound[i] || self.density(i).x < 0.0
    }

    pub(crate) fn value(&self) -> f64 {
        let mut sum = 0.0;
        for (i, local) in self.local.iter().enumerate() {
            let (l, p, c) = (&self.multipliers[i], self.penalties[i], &local.value);
            if self.bound[i] || p == 0.0 {
                sum += l.dot(c) + 0.5 * p * c.norm_squared();
            } else {
                let d = self.density(i).x;
                sum += (d * d - l.x * l.x) / (2.0 * p);
            }
        }
        sum
    }

    /// Size of the multipliers' terms, and energy of the round-off of positions of the given size.
    pub(crate) fn scales(&self, model: &SheetModel, size: f64) -> (f64, f64) {
        let (mut load, mut still) = (0.0, 0.0);
        for (i, c) in model.constraints().iter().enumerate() {
            let l = model.shortest_rod(c.vertex().index());
            load += self.multipliers[i].norm() * l;
            still += self.penalties[i] * (f64::EPSILON * (size + l)).powi(2);
        }
        (load, still)
    }

    pub(crate) fn add_gradient(&self, model: &SheetModel, out: &mut [f64]) {
        for (i, c) in model.constraints().iter().enumerate() {
            let g = self.local[i].jacobian.tr_mul(&self.density(i));
            add(out, c.vertex(), &g);
        }
    }

    pub(crate) fn add_hessian(
        &self,
        model: &SheetModel,
        matrix: &mut PrimalMatrix,
        bending: Bending,
    ) {
        for (i, c) in model.constraints().iter().enumerate() {
            if !self.presses(i) {
                continue;
            }
            let local = &self.local[i];
            let mut bent = local.hessian(&self.density(i));
            if bending == Bending::Positive {
                bent = positive(&bent);
            }
            let block = self.penalties[i] * local.jacobian.tr_mul(&local.jacobian) + bent;
            matrix.add_block(model, c.vertex(), &block);
        }
    }

    /// Adds `J^T multipliers`.
    pub(crate) fn add_loads(
        &self,
        model: &SheetModel,
        multipliers: &[Vector3<f64>],
        out: &mut [f64],
    ) {
        for (i, c) in model.constraints().iter().enumerate() {
            let g = self.local[i].jacobian.tr_mul(&multipliers[i]);
            add(out, c.vertex(), &g);
        }
    }

    /// Takes the densities for new multipliers.
    pub(crate) fn update(&mut self) {
        for i in 0..self.multipliers.len() {
            self.active[i] = self.presses(i);
            self.multipliers[i] = self.density(i);
        }
    }

    pub(crate) fn scale(&mut self, ratio: f64) {
        self.multipliers.iter_mut().for_each(|m| *m *= ratio);
    }

    pub(crate) fn clear(&mut self) {
        self.scale(0.0);
    }

    /// Largest violation relative to the shortest rod at the vertex.
    pub(crate) fn largest_violation(&self, model: &SheetModel) -> f64 {
        model
            .constraints()
            .iter()
            .enumerate()
            .map(|(i, c)| self.violation(i).norm() / model.shortest_rod(c.vertex().index()))
            // `max` would pass over a value that is not a number.
            .fold(0.0, |m: f64, v| if v.is_nan() { v } else { m.max(v) })
    }

    /// Sum of the squares of the relative violations.
    pub(crate) fn squared_error(&self, model: &SheetModel) -> f64 {
        model
            .constraints()
            .iter()
            .enumerate()
            .map(|(i, c)| {
                (self.violation(i).norm() / model.shortest_rod(c.vertex().index())).powi(2)
            })
            .sum()
    }

    /// What is broken of an equation: all of a bound one, the negative part of another.
    fn violation(&self, i: usize) -> Vector3<f64> {
        let c = self.local[i].value;
        if self.bound[i] || c.x.is_nan() {
            c
        } else {
            Vector3::new(c.x.min(0.0), 0.0, 0.0)
        }
    }

    /// Adds to a projection's system `(M + p J^T J) dx = -p J^T c`, `p` being `penalty` times the vertex
    /// mass.
    pub(crate) fn add_projection(
        &mut self,
        model: &SheetModel,
        penalty: f64,
        matrix: &mut PrimalMatrix,
        rhs: &mut [f64],
    ) {
        for (i, c) in model.constraints().iter().enumerate() {
            self.active[i] = self.is_broken_or_bound(i);
            if !self.active[i] {
                continue;
            }
            self.mended[i] = true;
            let (p, j) = (penalty * self.penalties[i], &self.local[i].jacobian);
            matrix.add_block(model, c.vertex(), &(p * j.tr_mul(j)));
            add(rhs, c.vertex(), &(-p * j.tr_mul(&self.violation(i))));
        }
    }

    fn is_broken_or_bound(&self, i: usize) -> bool {
        self.bound[i] || self.local[i].value.x < 0.0
    }

    /// Adds what the bound equations answer to a displacement `y` to the multipliers, `-p J y`.
    pub(crate) fn answer(&mut self, model: &SheetModel, penalty: f64, y: &[f64]) {
        for (i, c) in model.constraints().iter().enumerate() {
            if self.bound[i] {
                let p = penalty * self.penalties[i];
                self.multipliers[i] -= p * (self.local[i].jacobian * point(y, c.vertex()));
            }
        }
    }

    /// Adds `p J^T J` for the bound equations, for velocities.
    pub(crate) fn add_bound(&self, model: &SheetModel, penalty: f64, matrix: &mut PrimalMatrix) {
        for (i, c) in model.constraints().iter().enumerate() {
            if self.bound[i] {
                let j = &self.local[i].jacobian;
                matrix.add_block(
                    model,
                    c.vertex(),
                    &(penalty * self.penalties[i] * j.tr_mul(j)),
                );
            }
        }
    }

    /// Adds `-p J^T (J v + rate)` for the bound equations; returns the largest `|J v + rate|`, metres per
    /// second.
    pub(crate) fn add_rates(
        &self,
        model: &SheetModel,
        penalty: f64,
        rates: &[Vector3<f64>],
        v: &[f64],
        rhs: &mut [f64],
    ) -> f64 {
        let mut largest = 0.0_f64;
        for (i, c) in model.constraints().iter().enumerate() {
            if self.bound[i] && self.penalties[i] > 0.0 {
                let j = &self.local[i].jacobian;
                let rate = j * point(v, c.vertex()) + rates[i];
                largest = largest.max(rate.norm());
                add(
                    rhs,
                    c.vertex(),
                    &(-penalty * self.penalties[i] * j.tr_mul(&rate)),
                );
            }
        }
        largest
    }

    /// The equations at the last evaluation.
    pub(crate) fn local(&self, i: usize) -> &Local {
        &self.local[i]
    }
}

/// The coordinates of a vertex.
pub(crate) fn point(x: &[f64], v: VertexId) -> Vector3<f64> {
    let i = 3 * v.index();
    Vector3::new(x[i], x[i + 1], x[i + 2])
}

/// Adds to the coordinates of a vertex.
pub(crate) fn add(x: &mut [f64], v: VertexId, d: &Vector3<f64>) {
    for k in 0..3 {
        x[3 * v.index() + k] += d[k];
    }
}

/// The nearest positive semidefinite matrix.
fn positive(m: &Matrix3<f64>) -> Matrix3<f64> {
    let eigen = SymmetricEigen::new(*m);
    let kept = eigen.eigenvalues.map(|e| e.max(0.0));
    eigen.eigenvectors * Matrix3::from_diagonal(&kept) * eigen.eigenvectors.transpose()
}
