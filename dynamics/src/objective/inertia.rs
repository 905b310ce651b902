//! The inertia of a step.

use crate::SheetModel;
use crate::hessian::{BlockSink, HessianPart};
use crate::term::{Exchange, Iterate, Refusal, StepStart, Term, Value};
use isosheet_mesh::{EdgeId, VertexId};
use nalgebra::Matrix3;
use std::sync::Arc;

/// `|x - x^|_M^2 / 2`, with the prediction `x^`; joules times squared seconds.
pub(super) struct Inertia {
    model: Arc<SheetModel>,
    prediction: Vec<f64>,
    difference: Vec<f64>,
    product: Vec<f64>,
}

impl Inertia {
    pub(super) fn new(model: &Arc<SheetModel>) -> Self {
        let n = model.coordinate_count();
        Self {
            model: Arc::clone(model),
            prediction: vec![0.0; n],
            difference: vec![0.0; n],
            product: vec![0.0; n],
        }
    }

    fn set_difference(&mut self, x: &[f64]) {
        for (d, (x, p)) in self
            .difference
            .iter_mut()
            .zip(x.iter().zip(&self.prediction))
        {
            *d = x - p;
        }
    }
}

impl Term for Inertia {
    fn begin(&mut self, step: &StepStart<'_>) -> Result<(), Refusal> {
        self.prediction.copy_from_slice(step.prediction);
        Ok(())
    }

    fn value(&mut self, at: Iterate<'_>) -> Value {
        self.set_difference(at.x);
        Value::of(self.model.kinetic_energy(&self.difference))
    }

    fn add_gradient(&mut self, at: Iterate<'_>, scale: f64, out: &mut [f64]) {
        self.set_difference(at.x);
        let mass = self.model.mass();
        mass.apply(self.model.topology(), &self.difference, &mut self.product);
        for (o, p) in out.iter_mut().zip(&self.product) {
            *o += scale * p;
        }
    }

    fn add_hessian(&mut self, _at: Iterate<'_>, _part: HessianPart, sink: &mut dyn BlockSink) {
        let mass = self.model.mass();
        for (v, m) in mass.vertex.iter().enumerate() {
            sink.add_vertex(VertexId::from_index(v), &Matrix3::from_diagonal_element(*m));
        }
        for (e, m) in mass.edge.iter().flatten().enumerate() {
            sink.add_edge(EdgeId::from_index(e), &Matrix3::from_diagonal_element(*m));
        }
    }

    fn finish(&mut self, _: &StepStart<'_>, _: Iterate<'_>) -> Result<Exchange, Refusal> {
        Ok(Exchange::default())
    }
}
