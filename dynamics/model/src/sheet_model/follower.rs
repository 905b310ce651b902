//! Loads on faces that follow these, as terms of a damped step.

#[cfg(test)]
pub(super) mod tests;

use super::loaded_faces::Corners;
use crate::StepError;
use crate::term::{
    Exchange, ImplicitForce, Iterate, Lagging, StartProducts, StepStart, Term, Value,
};
use isosheet_materials::NoDerivative;
use isosheet_materials::hessian::{BlockSink, HessianPart};
use isosheet_materials::potential::Force;
use isosheet_materials::vectors::{add, point};
use nalgebra::{Matrix3, SMatrix, SVector, Vector3};
use std::fmt::Debug;
use std::sync::Arc;

/// Part of the largest load by which loads may differ from the loads at the place of the sheet before they
/// are renewed.
const SETTLED: f64 = 1e-3;
/// Part of the largest load by which loads may differ from the loads at the place of the sheet at the end of
/// a step; beyond it the step is refused, as it takes more than the updates that a step has.
const UNSETTLED: f64 = 0.05;

/// The corners of a face, in metres, or the forces on them, in newtons.
pub(super) type OfCorners = [Vector3<f64>; 3];

/// Loads on the corners of faces that depend on where these are, one face at a time.
pub(super) trait FaceLoad: Debug + Send + Sync + 'static {
    /// The faces.
    fn faces(&self) -> &[Corners];

    /// The forces on the corners of the face of this number at a time (seconds), newtons.
    fn forces(&self, number: usize, t: f64, x: &OfCorners) -> OfCorners;

    /// The derivatives of the forces, newtons per metre: of that on the corner of the first index by the
    /// place of the corner of the second one.
    fn derivatives(&self, number: usize, t: f64, x: &OfCorners) -> [[Matrix3<f64>; 3]; 3];
}

/// The force of loads that follow the sheet.
#[derive(Debug)]
pub(super) struct Follower<L>(pub(super) Arc<L>);

fn places(face: &Corners, x: &[f64]) -> OfCorners {
    face.vertices.map(|v| point(x, v))
}

impl<L: FaceLoad> Force for Follower<L> {
    fn add_force(&self, t: f64, x: &[f64], _v: &[f64], force: &mut [f64]) {
        for (number, face) in self.0.faces().iter().enumerate() {
            let forces = self.0.forces(number, t, &places(face, x));
            for (v, f) in face.vertices.iter().zip(&forces) {
                add(force, *v, f);
            }
        }
    }
}

impl<L: FaceLoad> ImplicitForce for Follower<L> {
    fn term(&self, free: Arc<[bool]>) -> Box<dyn Term> {
        Box::new(FollowerStep {
            load: Self(Arc::clone(&self.0)),
            free,
            start: Vec::new(),
            lagged: Vec::new(),
            force: Vec::new(),
        })
    }
}

/// The loads in a step, as the energy of second order
///
/// ```text
/// U(x) = -sum_f (f . d + d . S d / 2),   d = x - y,   S = (J + J^T) / 2,
/// ```
///
/// less that at the start of the step, with the forces `f` on the corners of each face and their derivative
/// `J` at lagged positions `y`. Loads that follow a sheet have no energy as a rule: the part of `J` that has
/// none lags behind. The positions `y` are first where the velocities at the start lead. They are renewed
/// where the minimisation has converged, until `U` has the forces of the end of the step.
#[derive(Debug)]
struct FollowerStep<L> {
    load: Follower<L>,
    /// Which vertices are free.
    free: Arc<[bool]>,
    /// Positions at the start of the step, `3V`, metres.
    start: Vec<f64>,
    lagged: Vec<Lagged>,
    /// `3V`.
    force: Vec<f64>,
}

/// The loads of a face at lagged positions.
#[derive(Debug, Clone, Copy)]
struct Lagged {
    face: Corners,
    /// `y`.
    at: SVector<f64, 9>,
    /// `f`.
    force: SVector<f64, 9>,
    /// `S`.
    stiffness: SMatrix<f64, 9, 9>,
}

fn joined(corners: &OfCorners) -> SVector<f64, 9> {
    SVector::from_fn(|i, _| corners[i / 3][i % 3])
}

fn of_corner(vector: &SVector<f64, 9>, corner: usize) -> Vector3<f64> {
    vector.fixed_rows::<3>(3 * corner).into()
}

impl Lagged {
    fn new(load: &impl FaceLoad, number: usize, t: f64, x: &[f64]) -> Self {
        let face = load.faces()[number];
        let corners = places(&face, x);
        let derivatives = load.derivatives(number, t, &corners);
        let whole: SMatrix<f64, 9, 9> =
            SMatrix::from_fn(|i, j| derivatives[i / 3][j / 3][(i % 3, j % 3)]);
        Self {
            face,
            at: joined(&corners),
            force: joined(&load.forces(number, t, &corners)),
            stiffness: 0.5 * (whole + whole.transpose()),
        }
    }

    /// `x - y` of the corners.
    fn moved(&self, x: &[f64]) -> SVector<f64, 9> {
        joined(&places(&self.face, x)) - self.at
    }

    /// `f + S d`.
    fn forces(&self, x: &[f64]) -> SVector<f64, 9> {
        self.force + self.stiffness * self.moved(x)
    }

    /// A part of `-S`.
    fn hessian(&self, part: HessianPart) -> Option<SMatrix<f64, 9, 9>> {
        match part {
            HessianPart::Full => Some(-self.stiffness),
            HessianPart::PositiveSemidefinite => {
                let eigen = (-self.stiffness).symmetric_eigen();
                let positive = eigen.eigenvalues.map(|value| value.max(0.0));
                let vectors = eigen.eigenvectors;
                Some(vectors * SMatrix::from_diagonal(&positive) * vectors.transpose())
            }
            HessianPart::Certain => None,
        }
    }
}

impl<L: FaceLoad> FollowerStep<L> {
    fn lag(&mut self, t: f64, x: &[f64]) {
        let load = &*self.load.0;
        let numbers = 0..load.faces().len();
        self.lagged.clear();
        self.lagged
            .extend(numbers.map(|number| Lagged::new(load, number, t, x)));
    }

    /// By how much the forces at free vertices differ from the forces at an iterate, as a part of the
    /// largest.
    fn error(&mut self, at: Iterate<'_>) -> f64 {
        let mut here = std::mem::take(&mut self.force);
        here.clear();
        here.resize(at.x.len(), 0.0);
        self.load.add_force(at.t, at.x, &[], &mut here);
        let largest = self.largest(&here);
        self.add_gradient(at, 1.0, &mut here);
        let error = self.largest(&here);
        self.force = here;
        if largest > 0.0 { error / largest } else { 0.0 }
    }

    /// The largest force on a free vertex, not a number if one of them is not.
    fn largest(&self, forces: &[f64]) -> f64 {
        let rows = forces.as_chunks::<3>().0.iter().zip(&*self.free);
        let sizes = rows.filter(|(_, is_free)| **is_free);
        let sizes = sizes.map(|(row, _)| Vector3::from(*row).norm());
        sizes.fold(
            0.0,
            |m: f64, size| if m >= size || m.is_nan() { m } else { size },
        )
    }
}

impl<L: FaceLoad> Term for FollowerStep<L> {
    fn begin(&mut self, step: &StepStart<'_>) -> Result<(), StepError> {
        self.start.clear();
        self.start.extend_from_slice(&step.state.x);
        self.lag(step.t(), step.ahead);
        for lagged in &self.lagged {
            if let Some(i) = lagged.force.iter().position(|f| !f.is_finite()) {
                let (vertex, value, t) = (lagged.face.vertices[i / 3], lagged.force[i], step.t());
                return Err(StepError::NonFiniteForce { vertex, value, t });
            }
        }
        Ok(())
    }

    fn value(&mut self, at: Iterate<'_>) -> Value {
        let mut sum = Value::default();
        for lagged in &self.lagged {
            let [before, now] = [&self.start, at.x].map(|x| lagged.moved(x));
            let mean = lagged.force + 0.5 * lagged.stiffness * (before + now);
            let work = mean.component_mul(&(now - before));
            sum.energy -= work.sum();
            sum.size += work.abs().sum();
        }
        sum
    }

    fn add_gradient(&mut self, at: Iterate<'_>, scale: f64, out: &mut [f64]) {
        for lagged in &self.lagged {
            let forces = -scale * lagged.forces(at.x);
            for (k, v) in lagged.face.vertices.iter().enumerate() {
                add(out, *v, &of_corner(&forces, k));
            }
        }
    }

    fn add_hessian(&mut self, _at: Iterate<'_>, part: HessianPart, sink: &mut dyn BlockSink) {
        for lagged in &self.lagged {
            let Some(whole) = lagged.hessian(part) else {
                return;
            };
            let block = |i: usize, j: usize| whole.fixed_view::<3, 3>(3 * i, 3 * j).into_owned();
            for (k, v) in lagged.face.vertices.iter().enumerate() {
                sink.add_vertex(*v, &block(k, k));
                let (side, next) = (lagged.face.sides[k], (k + 1) % 3);
                match side.is_forward {
                    true => sink.add_edge(side.edge, &block(k, next)),
                    false => sink.add_edge(side.edge, &block(next, k)),
                }
            }
        }
    }

    fn renew(&mut self, at: Iterate<'_>, settled: Lagging) -> bool {
        if self.error(at) <= settled.loads.min(SETTLED) {
            return false;
        }
        self.lag(at.t, at.x);
        true
    }

    /// By the positions at the end, through the part of the derivative that has no energy: loads that have
    /// settled are those of the iterate.
    fn add_start_products(
        &mut self,
        _step: &StepStart<'_>,
        at: Iterate<'_>,
        w: &[f64],
        scale: f64,
        out: &mut StartProducts,
    ) -> Result<(), NoDerivative> {
        let load = &*self.load.0;
        for (number, lagged) in self.lagged.iter().enumerate() {
            let derivatives = load.derivatives(number, at.t, &places(&lagged.face, at.x));
            let weights = joined(&places(&lagged.face, w));
            let whole: SMatrix<f64, 9, 9> =
                SMatrix::from_fn(|i, j| derivatives[i / 3][j / 3][(i % 3, j % 3)]);
            let products = -scale * (whole - lagged.stiffness).tr_mul(&weights);
            for (k, v) in lagged.face.vertices.iter().enumerate() {
                add(&mut out.end, *v, &of_corner(&products, k));
            }
        }
        Ok(())
    }

    fn finish(&mut self, step: &StepStart<'_>, at: Iterate<'_>) -> Result<Exchange, StepError> {
        let error = self.error(at);
        if error.is_nan() || error > UNSETTLED {
            return Err(StepError::UnsettledLoads {
                t: step.state.t,
                h: step.span,
                error,
            });
        }
        let mut force = std::mem::take(&mut self.force);
        force.fill(0.0);
        self.add_gradient(at, -1.0, &mut force);
        let work = step.implicit_work(&self.load, &self.free, at.x, &mut force);
        self.force = force;
        Ok(work)
    }
}
