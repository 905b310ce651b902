//! The equations of all vertex constraints of a model, beside the rods.

use isosheet_materials::hessian::{HessianPart, HessianSink};
use isosheet_materials::vectors::{add, point};
use isosheet_mesh::VertexId;
use isosheet_model::constraint::{ConstrainedVertex, LocalEquations, VertexConstraint};
use nalgebra::{Matrix3, SymmetricEigen, Vector3};

/// Equations `c_i(x, t)` with multipliers `L_i` and penalties `p_i`: the augmented Lagrangian
///
/// ```text
/// L_i . c_i + p_i |c_i|^2 / 2,      one-sided (c_i >= 0):  (min(0, L_i + p_i c_i)^2 - L_i^2) / (2 p_i)
/// ```
///
/// with its derivatives (Rockafellar 1973 for the one-sided form). Empty, and free of cost, in scenes without
/// constraints.
pub(crate) struct VertexRows {
    vertices: Vec<ConstrainedVertex>,
    /// Kilograms; zero at pinned vertices.
    penalties: Vec<f64>,
    /// Kilogram metres.
    pub(crate) multipliers: Vec<Vector3<f64>>,
    local: Vec<LocalEquations>,
    /// Whether a projection has corrected the equation since this was cleared.
    pub(crate) corrected: Vec<bool>,
    /// Whether the equation took part in the last system of a projection or the last update of the
    /// multipliers.
    pub(crate) active: Vec<bool>,
    /// Whether the constraint is treated as an equality: always, unless it is one-sided.
    pub(crate) equality: Vec<bool>,
    /// Whether a one-sided constraint is an equality of the present linear system.
    held: Vec<bool>,
}

/// Which load of an equation its curvature enters a Hessian with.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum RowLoad {
    /// The multipliers: for steps of sequential quadratic programming.
    Multipliers,
    /// The multiplier estimates `L + r c`: for Newton's method on the augmented Lagrangian.
    Estimates,
}

impl VertexRows {
    /// With penalties of `kappa` times the mass of the vertex: like the rods, `kappa` times as stiff as
    /// inertia.
    pub(crate) fn new(
        constraints: &[VertexConstraint],
        vertices: Vec<ConstrainedVertex>,
        kappa: f64,
    ) -> Self {
        let m = constraints.len();
        Self {
            penalties: vertices.iter().map(|v| kappa * v.mass).collect(),
            vertices,
            multipliers: vec![Vector3::zeros(); m],
            local: Vec::with_capacity(m),
            corrected: vec![false; m],
            active: vec![false; m],
            equality: constraints.iter().map(|c| !c.is_one_sided()).collect(),
            held: vec![false; m],
        }
    }

    /// Sets penalties of `kappa` times the mass of the vertex.
    pub(crate) fn set_stiffness(&mut self, kappa: f64) {
        for (p, v) in self.penalties.iter_mut().zip(&self.vertices) {
            *p = kappa * v.mass;
        }
        self.held.fill(false);
    }

    /// Raises the penalties of active constraints to `kappa` times the stiffness of what a linear system has
    /// at the vertex, the largest diagonal entry of its block (kilograms): equations that are solved for are
    /// kept to `1 / kappa` by it alone. One-sided constraints are active by the penalties that they have,
    /// which do not mistake round-off for a gap, and are equalities of the system then.
    pub(crate) fn stiffen(&mut self, kappa: f64, stiffness: impl Fn(VertexId) -> f64) {
        for i in 0..self.vertices.len() {
            if self.penalties[i] > 0.0 && self.is_active(i) {
                let raised = kappa * stiffness(self.vertices[i].vertex);
                self.held[i] = !self.equality[i];
                self.penalties[i] = raised.max(self.penalties[i]);
            }
        }
    }

    /// Replaces the multipliers of one-sided constraints that are equalities of the linear system by their
    /// first-order estimates after the step `-dx`, the equations being linearised: the negative part of
    /// `L + p (c - J dx)`. Others have none. Returns the largest change and the largest of them, kilogram
    /// metres.
    pub(crate) fn update_one_sided(&mut self, dx: &[f64]) -> [f64; 2] {
        let mut largest = [0.0_f64; 2];
        for i in 0..self.multipliers.len() {
            if self.equality[i] {
                self.active[i] = true;
                continue;
            }
            if !self.held[i] {
                self.multipliers[i] = Vector3::zeros();
                self.active[i] = false;
                continue;
            }
            let (local, vertex) = (&self.local[i], self.vertices[i].vertex);
            let left = local.value - local.jacobian * point(dx, vertex);
            let new = self.multipliers[i] + self.penalties[i] * left;
            let new = Vector3::new(new.x.min(0.0), 0.0, 0.0);
            largest[0] = largest[0].max((new - self.multipliers[i]).norm());
            largest[1] = largest[1].max(new.norm());
            self.multipliers[i] = new;
            self.active[i] = new.x < 0.0;
            self.held[i] &= self.active[i];
        }
        largest
    }

    /// Evaluates the equations and their derivatives at time `t` (seconds) and positions `x` (`3V`, metres).
    pub(crate) fn evaluate(&mut self, constraints: &[VertexConstraint], t: f64, x: &[f64]) {
        self.local.clear();
        for c in constraints {
            self.local.push(c.at(t, &point(x, c.vertex())));
        }
    }

    /// The equations of a constraint at the last evaluation.
    pub(crate) fn local(&self, i: usize) -> &LocalEquations {
        &self.local[i]
    }

    pub(crate) fn vertex(&self, i: usize) -> VertexId {
        self.vertices[i].vertex
    }

    /// Length of the shortest rod at the vertex of a constraint, metres.
    pub(crate) fn length(&self, i: usize) -> f64 {
        self.vertices[i].length
    }

    /// Penalty of a constraint, if it is an equality of a vertex that is free.
    pub(crate) fn equality_penalty(&self, i: usize) -> Option<f64> {
        (self.equality[i] && self.penalties[i] > 0.0).then_some(self.penalties[i])
    }

    /// The equations of such a constraint at the last evaluation; zero for others.
    pub(crate) fn equality_value(&self, i: usize) -> Vector3<f64> {
        match self.equality_penalty(i) {
            Some(_) => self.local[i].value,
            None => Vector3::zeros(),
        }
    }

    fn indexed_vertices(&self) -> impl Iterator<Item = (usize, VertexId)> + '_ {
        self.vertices.iter().map(|v| v.vertex).enumerate()
    }

    /// First-order estimate of the multipliers, `L_i + p_i c_i` (one-sided: its negative part), kilogram
    /// metres: the force on the vertex is `-J^T` times it per squared step.
    pub(crate) fn multiplier_estimate(&self, i: usize) -> Vector3<f64> {
        let estimate = self.multipliers[i] + self.penalties[i] * self.local[i].value;
        if self.equality[i] || self.held[i] {
            estimate
        } else {
            Vector3::new(estimate.x.min(0.0), 0.0, 0.0)
        }
    }

    /// Whether the constraint is in the active set: an equality, or one-sided with a multiplier that is not
    /// zero.
    fn is_active(&self, i: usize) -> bool {
        self.equality[i] || self.held[i] || self.multiplier_estimate(i).x < 0.0
    }

    /// The augmented Lagrangian's terms of the constraints, joules times squared step.
    pub(crate) fn value(&self) -> f64 {
        let mut sum = 0.0;
        for (i, local) in self.local.iter().enumerate() {
            let (l, p, c) = (&self.multipliers[i], self.penalties[i], &local.value);
            if self.equality[i] || p == 0.0 {
                sum += l.dot(c) + 0.5 * p * c.norm_squared();
            } else {
                let d = self.multiplier_estimate(i).x;
                sum += (d * d - l.x * l.x) / (2.0 * p);
            }
        }
        sum
    }

    /// Size of the multipliers' terms, and energy of the round-off of positions of the given size.
    pub(crate) fn scales(&self, size: f64) -> (f64, f64) {
        let (mut load, mut round_off) = (0.0, 0.0);
        for (i, v) in self.vertices.iter().enumerate() {
            load += self.multipliers[i].norm() * v.length;
            round_off += self.penalties[i] * (f64::EPSILON * (size + v.length)).powi(2);
        }
        (load, round_off)
    }

    /// Adds the gradient of [`VertexRows::value`].
    pub(crate) fn add_gradient(&self, out: &mut [f64]) {
        for (i, v) in self.indexed_vertices() {
            let g = self.local[i].jacobian.tr_mul(&self.multiplier_estimate(i));
            add(out, v, &g);
        }
    }

    /// Adds the Hessian of [`VertexRows::value`], or a positive semidefinite part of it, with the curvature
    /// of the equations under their multipliers, or under the estimates of these.
    pub(crate) fn add_hessian(
        &self,
        part: HessianPart,
        load: RowLoad,
        hessian: &mut dyn HessianSink,
    ) {
        for (i, v) in self.indexed_vertices() {
            if !self.is_active(i) {
                continue;
            }
            let local = &self.local[i];
            let mut curvature = local.hessian(&match load {
                RowLoad::Multipliers => self.multipliers[i],
                RowLoad::Estimates => self.multiplier_estimate(i),
            });
            if part != HessianPart::Full {
                curvature = positive_semidefinite(&curvature);
            }
            let stiffness = self.penalties[i] * local.jacobian.tr_mul(&local.jacobian);
            hessian.add_vertex(v, &(stiffness + curvature));
        }
    }

    /// Replaces the multipliers by their first-order estimates.
    pub(crate) fn update(&mut self) {
        for i in 0..self.multipliers.len() {
            self.active[i] = self.is_active(i);
            self.multipliers[i] = self.multiplier_estimate(i);
        }
    }

    /// Sets the multipliers to zero.
    pub(crate) fn clear(&mut self) {
        self.multipliers.fill(Vector3::zeros());
    }

    /// Violations relative to the shortest rod at the vertex.
    fn relative_violations(&self) -> impl Iterator<Item = f64> + '_ {
        let vertices = self.vertices.iter().enumerate();
        vertices.map(|(i, v)| self.violation(i).norm() / v.length)
    }

    /// Largest violation relative to the shortest rod at the vertex.
    pub(crate) fn largest_violation(&self) -> f64 {
        self.relative_violations()
            // `max` would pass over a value that is not a number.
            .fold(0.0, |m: f64, v| if v.is_nan() { v } else { m.max(v) })
    }

    /// Sum of the squares of the violations, weighted with the penalties: what a projection decreases.
    pub(crate) fn squared_error(&self) -> f64 {
        let weighted = |(i, p): (usize, &f64)| p * self.violation(i).norm_squared();
        self.penalties.iter().enumerate().map(weighted).sum()
    }

    /// What is violated of an equation: all of an equality, the negative part of an inequality.
    fn violation(&self, i: usize) -> Vector3<f64> {
        let c = self.local[i].value;
        if self.equality[i] || c.x.is_nan() {
            c
        } else {
            Vector3::new(c.x.min(0.0), 0.0, 0.0)
        }
    }

    /// Adds to a projection's system `(M + p J^T J) dx = -p J^T c`, `p` being `penalty` times the vertex
    /// mass: the equalities, and the inequalities that are violated.
    pub(crate) fn add_projection(
        &mut self,
        penalty: f64,
        hessian: &mut dyn HessianSink,
        rhs: &mut [f64],
    ) {
        for i in 0..self.vertices.len() {
            self.active[i] = self.equality[i] || self.local[i].value.x < 0.0;
            if !self.active[i] {
                continue;
            }
            self.corrected[i] = true;
            let v = self.vertices[i].vertex;
            let (p, j) = (penalty * self.penalties[i], &self.local[i].jacobian);
            hessian.add_vertex(v, &(p * j.tr_mul(j)));
            add(rhs, v, &(-p * j.tr_mul(&self.violation(i))));
        }
    }

    /// Adds `p J^T J` for the equalities, for velocities.
    pub(crate) fn add_equalities(&self, penalty: f64, hessian: &mut dyn HessianSink) {
        for (i, v) in self.indexed_vertices() {
            if let Some(own) = self.equality_penalty(i) {
                let j = &self.local[i].jacobian;
                hessian.add_vertex(v, &(penalty * own * j.tr_mul(j)));
            }
        }
    }
}

/// The nearest positive semidefinite matrix in the Frobenius norm: eigenvalues below zero become zero.
fn positive_semidefinite(m: &Matrix3<f64>) -> Matrix3<f64> {
    let eigen = SymmetricEigen::new(*m);
    let clamped = eigen.eigenvalues.map(|e| e.max(0.0));
    eigen.eigenvectors * Matrix3::from_diagonal(&clamped) * eigen.eigenvectors.transpose()
}
