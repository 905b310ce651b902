//! The independent equations of vertex constraints, for the saddle-point matrix.

use isosheet_materials::vectors::{add, point};
use isosheet_model::constraint::{ConstrainedVertex, LocalEquations, VertexConstraint};
use nalgebra::{Matrix2x3, Matrix3, Vector2, Vector3};

/// What a vertex constraint adds to a saddle-point matrix.
#[derive(Debug, Clone, Copy)]
pub(crate) struct SaddleBlocks {
    /// Gradients that the multipliers act along.
    pub(crate) left: Matrix2x3<f64>,
    /// Gradients that the equations are linearised with.
    pub(crate) right: Matrix2x3<f64>,
    /// Curvature under load.
    pub(crate) block: Matrix3<f64>,
}

/// The equations `N c = 0` of each vertex constraint with the rows `N` that are independent at the start of a
/// step: one for a surface, two for a curve.
pub(crate) struct ConservativeRows {
    vertices: Vec<ConstrainedVertex>,
    /// The rows `N` of each constraint; for a surface the second is zero.
    frames: Vec<Matrix2x3<f64>>,
    /// Impulses of this step, kilogram metres per second.
    pub(crate) impulses: Vec<Vector2<f64>>,
    /// Right-hand sides, and after the solution of the linear system the correction of the impulses.
    pub(crate) rhs: Vec<Vector2<f64>>,
    pub(crate) blocks: Vec<SaddleBlocks>,
    /// Largest violation at the last linearisation, relative to the shortest rod at the vertex.
    violation: f64,
}

impl ConservativeRows {
    pub(crate) fn new(vertices: Vec<ConstrainedVertex>) -> Self {
        let m = vertices.len();
        Self {
            vertices,
            frames: Vec::with_capacity(m),
            impulses: vec![Vector2::zeros(); m],
            rhs: vec![Vector2::zeros(); m],
            blocks: vec![
                SaddleBlocks {
                    left: Matrix2x3::zeros(),
                    right: Matrix2x3::zeros(),
                    block: Matrix3::zeros(),
                };
                m
            ],
            violation: 0.0,
        }
    }

    /// Begins a step at `x0` with `ratio` times the impulses `last`, in the space of all equations; none if
    /// `last` is empty.
    pub(crate) fn begin(
        &mut self,
        constraints: &[VertexConstraint],
        t0: f64,
        x0: &[f64],
        ratio: f64,
        last: &[Vector3<f64>],
    ) {
        self.frames.clear();
        for (i, c) in constraints.iter().enumerate() {
            let frame = c.at(t0, &point(x0, c.vertex())).independent();
            self.impulses[i] = last
                .get(i)
                .map_or(Vector2::zeros(), |l| ratio * (frame * l));
            self.frames.push(frame);
        }
    }

    /// Lets the impulses act along the gradients at `x`.
    pub(crate) fn push_at(&mut self, constraints: &[VertexConstraint], t: f64, x: &[f64]) {
        for (i, c) in constraints.iter().enumerate() {
            self.blocks[i].left = self.frames[i] * c.at(t, &point(x, c.vertex())).jacobian;
        }
    }

    /// Lets the impulses act along Gonzalez' discrete gradient between `x0` and `x1`, midpoint `xm`, that
    /// does the work `c(x1) - c(x0)` exactly; `scale` weighs the curvature.
    pub(crate) fn push_between(
        &mut self,
        constraints: &[VertexConstraint],
        t: f64,
        (x0, xm, x1): (&[f64], &[f64], &[f64]),
        scale: f64,
    ) {
        for (i, c) in constraints.iter().enumerate() {
            let v = c.vertex();
            let (p0, p1) = (point(x0, v), point(x1, v));
            let (frame, middle) = (self.frames[i], c.at(t, &point(xm, v)));
            let blocks = &mut self.blocks[i];
            blocks.left = frame * middle.jacobian;
            let dx = p1 - p0;
            let squared = dx.norm_squared();
            if squared > 0.0 {
                let change = frame * (c.at(t, &p1).value - c.at(t, &p0).value);
                blocks.left += (change - blocks.left * dx) * dx.transpose() / squared;
            }
            blocks.block = middle.hessian(&(scale * frame.tr_mul(&self.impulses[i])));
        }
    }

    /// Linearises at `x`: gradients and right-hand sides `-c per`.
    pub(crate) fn linearise(
        &mut self,
        constraints: &[VertexConstraint],
        t: f64,
        x: &[f64],
        per: f64,
    ) {
        self.violation = 0.0;
        for (i, c) in constraints.iter().enumerate() {
            let LocalEquations {
                value, jacobian, ..
            } = c.at(t, &point(x, c.vertex()));
            self.blocks[i].right = self.frames[i] * jacobian;
            self.rhs[i] = -per * (self.frames[i] * value);
            let broken = value.norm() / self.vertices[i].length;
            // `max` would pass over a value that is not a number.
            if broken.is_nan() || broken > self.violation {
                self.violation = broken;
            }
        }
    }

    /// The larger of the strain and of the violation at the last linearisation, relative to the shortest rod.
    pub(crate) fn worst(&self, strain: f64) -> f64 {
        if self.violation.is_nan() {
            self.violation
        } else {
            strain.max(self.violation)
        }
    }

    /// Right-hand sides `-(J v + rate)` of a correction of the velocities `v`, after which they keep the
    /// equations.
    pub(crate) fn set_rates(&mut self, v: &[f64], rates: &[Vector3<f64>]) {
        for (i, at) in self.vertices.iter().enumerate() {
            let normal = self.blocks[i].right * point(v, at.vertex);
            self.rhs[i] = -(normal + self.frames[i] * rates[i]);
        }
    }

    /// Largest of the rates of [`ConservativeRows::set_rates`] at vertices that are not pinned, metres per
    /// second.
    pub(crate) fn largest_rate(&self) -> f64 {
        let rates = self.rhs.iter().zip(&self.vertices);
        rates
            .filter(|(_, v)| v.mass > 0.0)
            .fold(0.0, |m: f64, (r, _)| m.max(r.norm()))
    }

    /// Adds `left^T impulses`.
    pub(crate) fn add_impulses(&self, impulses: &[Vector2<f64>], out: &mut [f64]) {
        for (i, at) in self.vertices.iter().enumerate() {
            add(out, at.vertex, &self.blocks[i].left.tr_mul(&impulses[i]));
        }
    }

    /// Adds the solution of the linear system, in `rhs`, to the impulses.
    pub(crate) fn correct(&mut self) {
        for (l, d) in self.impulses.iter_mut().zip(&self.rhs) {
            *l += d;
        }
    }

    /// The impulses in the space of all equations.
    pub(crate) fn full_impulses(&self) -> impl Iterator<Item = Vector3<f64>> + '_ {
        let pairs = self.frames.iter().zip(&self.impulses);
        pairs.map(|(frame, l)| frame.tr_mul(l))
    }

    /// The impulses in the space of all equations and as forces, per time, with their sign as multipliers.
    pub(crate) fn loads<'a>(
        &'a self,
        impulses: &'a [Vector2<f64>],
        per: f64,
    ) -> impl Iterator<Item = (Vector3<f64>, Vector3<f64>)> + 'a {
        self.frames
            .iter()
            .zip(&self.blocks)
            .zip(impulses)
            .map(move |((frame, blocks), l)| (-per * frame.tr_mul(l), per * blocks.left.tr_mul(l)))
    }
}
