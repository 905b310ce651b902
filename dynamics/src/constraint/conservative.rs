//! The independent equations of vertex constraints, for the saddle-point matrix.

use super::Local;
use super::rows::{add, point};
use crate::SheetModel;
use nalgebra::{Matrix2x3, Matrix3, Vector2, Vector3};

/// What a vertex constraint adds to a [`SaddleMatrix`](crate::saddle::SaddleMatrix).
#[derive(Debug, Clone, Copy)]
pub(crate) struct Entry {
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
    frames: Vec<Matrix2x3<f64>>,
    /// Impulses of this step, kilogram metres per second.
    pub(crate) impulses: Vec<Vector2<f64>>,
    pub(crate) rhs: Vec<Vector2<f64>>,
    pub(crate) entries: Vec<Entry>,
    violation: f64,
}

impl ConservativeRows {
    pub(crate) fn new(model: &SheetModel) -> Self {
        let m = model.constraints().len();
        Self {
            frames: Vec::with_capacity(m),
            impulses: vec![Vector2::zeros(); m],
            rhs: vec![Vector2::zeros(); m],
            entries: vec![
                Entry {
                    left: Matrix2x3::zeros(),
                    right: Matrix2x3::zeros(),
                    block: Matrix3::zeros(),
                };
                m
            ],
            violation: 0.0,
        }
    }

    /// Begins a step at `x0` with `ratio` times the impulses `last`, in the space of all equations; none if `last` is empty.
    pub(crate) fn begin(
        &mut self,
        model: &SheetModel,
        t0: f64,
        x0: &[f64],
        ratio: f64,
        last: &[Vector3<f64>],
    ) {
        self.frames.clear();
        for (i, c) in model.constraints().iter().enumerate() {
            let frame = c.at(t0, &point(x0, c.vertex())).independent();
            self.impulses[i] = last
                .get(i)
                .map_or(Vector2::zeros(), |l| ratio * (frame * l));
            self.frames.push(frame);
        }
    }

    /// Lets the impulses act along the gradients at `x`.
    pub(crate) fn push_at(&mut self, model: &SheetModel, t: f64, x: &[f64]) {
        for (i, c) in model.constraints().iter().enumerate() {
            self.entries[i].left = self.frames[i] * c.at(t, &point(x, c.vertex())).jacobian;
        }
    }

    /// Lets the impulses act along Gonzalez' discrete gradient between `x0` and `x1`, midpoint `xm`, that
    /// does the work `c(x1) - c(x0)` exactly; `scale` weighs the curvature.
    pub(crate) fn push_between(
        &mut self,
        model: &SheetModel,
        t: f64,
        (x0, xm, x1): (&[f64], &[f64], &[f64]),
        scale: f64,
    ) {
        for (i, c) in model.constraints().iter().enumerate() {
            let v = c.vertex();
            let (p0, p1) = (point(x0, v), point(x1, v));
            let (frame, middle) = (self.frames[i], c.at(t, &point(xm, v)));
            let entry = &mut self.entries[i];
            entry.left = frame * middle.jacobian;
            let dx = p1 - p0;
            let squared = dx.norm_squared();
            if squared > 0.0 {
                let change = frame * (c.at(t, &p1).value - c.at(t, &p0).value);
                entry.left += (change - entry.left * dx) * dx.transpose() / squared;
            }
            entry.block = middle.hessian(&(scale * frame.tr_mul(&self.impulses[i])));
        }
    }

    /// Linearises at `x`: gradients and right-hand sides `-c per`.
    pub(crate) fn linearise(&mut self, model: &SheetModel, t: f64, x: &[f64], per: f64) {
        self.violation = 0.0;
        for (i, c) in model.constraints().iter().enumerate() {
            let Local {
                value, jacobian, ..
            } = c.at(t, &point(x, c.vertex()));
            self.entries[i].right = self.frames[i] * jacobian;
            self.rhs[i] = -per * (self.frames[i] * value);
            let broken = value.norm() / model.shortest_rod(c.vertex().index());
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

    /// Asks for velocities that keep the equations: right-hand sides `-(J v + rate)`.
    pub(crate) fn ask_rates(&mut self, model: &SheetModel, v: &[f64], rates: &[Vector3<f64>]) {
        for (i, c) in model.constraints().iter().enumerate() {
            self.rhs[i] =
                -(self.entries[i].right * point(v, c.vertex()) + self.frames[i] * rates[i]);
        }
    }

    /// Largest rate left after [`ConservativeRows::ask_rates`].
    pub(crate) fn largest_rate(&self, model: &SheetModel) -> f64 {
        self.rhs
            .iter()
            .zip(model.constraints())
            .filter(|(_, c)| !model.is_pinned(c.vertex()))
            .fold(0.0, |m: f64, (r, _)| m.max(r.norm()))
    }

    /// Adds `left^T impulses`.
    pub(crate) fn add_impulses(
        &self,
        model: &SheetModel,
        impulses: &[Vector2<f64>],
        out: &mut [f64],
    ) {
        for (i, c) in model.constraints().iter().enumerate() {
            add(out, c.vertex(), &self.entries[i].left.tr_mul(&impulses[i]));
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
            .zip(&self.entries)
            .zip(impulses)
            .map(move |((frame, entry), l)| (-per * frame.tr_mul(l), per * entry.left.tr_mul(l)))
    }
}
