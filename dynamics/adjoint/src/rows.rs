//! The equations of rods and supports of a step, linearised at its end.

use isosheet_dynamics::sensitivity::AcceptedStep;
use isosheet_materials::vectors::{add, point};
use isosheet_mesh::VertexId;
use isosheet_model::{PINNED, SheetModel};
use nalgebra::{Matrix3, Vector3};

/// The Jacobian `G` of the equations: a row for each rod, and three for each vertex constraint, which are
/// zero where it has fewer equations or takes no part.
#[derive(Debug, Clone)]
pub(crate) struct Rows<'a> {
    model: &'a SheetModel,
    x: &'a [f64],
    supports: Vec<(VertexId, Matrix3<f64>)>,
}

impl<'a> Rows<'a> {
    /// At a place `x` of a step (`3V`, metres).
    pub(crate) fn at(model: &'a SheetModel, step: &AcceptedStep, x: &'a [f64]) -> Self {
        let t = step.start.t + step.span;
        let supports = model.constraints().iter().zip(&step.constraints);
        let supports = supports.map(|(c, l)| {
            let takes_part = !c.is_one_sided() || *l != Vector3::zeros();
            let local = c.at(t, &point(x, c.vertex()));
            let jacobian = match takes_part {
                true => local.jacobian,
                false => Matrix3::zeros(),
            };
            (c.vertex(), jacobian)
        });
        let supports = supports.collect();
        Self { model, x, supports }
    }

    /// Number of rows.
    pub(crate) fn len(&self) -> usize {
        self.model.rods().len() + 3 * self.supports.len()
    }

    /// Whether a row is that of a rod between two pins, which has no part in a step: its multiplier is zero.
    pub(crate) fn is_between_pins(&self, row: usize) -> bool {
        let rod = self.model.rods().edges().get(row);
        let free = self.model.free_index();
        rod.is_some_and(|ends| ends.iter().all(|v| free[*v] == PINNED))
    }

    /// The vertex constraints, with their Jacobians.
    pub(crate) fn supports(&self) -> &[(VertexId, Matrix3<f64>)] {
        &self.supports
    }

    /// The vector of a rod from its second to its first end, metres.
    pub(crate) fn rod(&self, e: usize) -> Vector3<f64> {
        let [a, b] = self.model.rods().edges()[e];
        let at = |v: usize| Vector3::from_column_slice(&self.x[3 * v..3 * v + 3]);
        at(a) - at(b)
    }

    /// Writes `G w` to `out`.
    pub(crate) fn apply(&self, w: &[f64], out: &mut [f64]) {
        let (rods, supports) = out.split_at_mut(self.model.rods().len());
        if !rods.is_empty() {
            self.model.rods().apply(self.x, w, rods);
        }
        let rows = supports.as_chunks_mut::<3>().0.iter_mut();
        for (row, (v, jacobian)) in rows.zip(&self.supports) {
            *row = (jacobian * point(w, *v)).into();
        }
    }

    /// Adds `G^T m` to `out` (`3V`).
    pub(crate) fn add_transpose(&self, m: &[f64], out: &mut [f64]) {
        let (rods, supports) = m.split_at(self.model.rods().len());
        if !rods.is_empty() {
            self.model.rods().apply_transpose_add(self.x, rods, out);
        }
        let rows = supports.as_chunks::<3>().0.iter();
        for (row, (v, jacobian)) in rows.zip(&self.supports) {
            add(out, *v, &jacobian.tr_mul(&Vector3::from(*row)));
        }
    }

    /// The forces `-J^T L / h^2` of the vertex constraints of a model at positions `x` and the time of the
    /// end of a step (`3V`, newtons).
    pub(crate) fn forces(model: &SheetModel, step: &AcceptedStep, x: &[f64]) -> Vec<f64> {
        let t = step.start.t + step.span;
        let scale = -1.0 / (step.h * step.h);
        let mut forces = vec![0.0; x.len()];
        for (c, l) in model.constraints().iter().zip(&step.constraints) {
            let local = c.at(t, &point(x, c.vertex()));
            add(&mut forces, c.vertex(), &(scale * local.jacobian.tr_mul(l)));
        }
        forces
    }

    /// With derivatives `of_forces` of a number by the forces of vertex constraints: those by the multipliers
    /// of all rows, and adds those by the positions to `of_x`.
    pub(crate) fn pull_forces(
        &self,
        step: &AcceptedStep,
        of_forces: &[f64],
        of_x: &mut [f64],
    ) -> Vec<f64> {
        let t = step.start.t + step.span;
        let scale = -1.0 / (step.h * step.h);
        let mut of_multipliers = vec![0.0; self.model.rods().len()];
        let constraints = self.model.constraints().iter().zip(&step.constraints);
        for ((c, l), (v, jacobian)) in constraints.zip(&self.supports) {
            let of = scale * point(of_forces, *v);
            of_multipliers.extend((jacobian * of).iter());
            let hessian = c.at(t, &point(self.x, *v)).hessian(l);
            add(of_x, *v, &(hessian * of));
        }
        of_multipliers
    }

    /// The equations of a model that is like this one, at positions `x` and the time of the end of a step.
    pub(crate) fn values(model: &SheetModel, step: &AcceptedStep, x: &[f64]) -> Vec<f64> {
        let t = step.start.t + step.span;
        let mut values = vec![0.0; model.rods().len()];
        if !values.is_empty() {
            model.rods().residual_into(x, &mut values);
        }
        for c in model.constraints() {
            let local = c.at(t, &point(x, c.vertex()));
            values.extend(local.value.iter());
        }
        values
    }
}
