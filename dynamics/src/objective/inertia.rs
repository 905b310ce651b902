//! The inertia of a step.

use crate::PotentialShape;
use crate::{SheetModel, StepError};
use isosheet_materials::hessian::{BlockSink, HessianPart};
use isosheet_materials::potential::At;
use isosheet_mesh::{EdgeId, VertexId};
use isosheet_model::PINNED;
use isosheet_model::term::{Exchange, Iterate, StepStart, Term, Value};
use nalgebra::{Matrix3, Vector3};
use std::sync::Arc;

/// `|x - x^|_M^2 / 2`, with the prediction `x^`; joules times squared seconds.
pub(super) struct Inertia {
    model: Arc<SheetModel>,
    prediction: Vec<f64>,
    difference: Vec<f64>,
    product: Vec<f64>,
    falling: Falling,
}

/// The connected parts of a model that nothing holds.
struct Falling {
    /// The mass of each connected part, kilograms; `None` if a support holds the part.
    masses: Vec<Option<f64>>,
    /// The way that its weight alone takes it in the step, metres.
    ways: Vec<Vector3<f64>>,
    /// Room for the sums of `M d` over them.
    sums: Vec<Vector3<f64>>,
    /// Whether there is such a way.
    any: bool,
}

impl Falling {
    fn new(model: &SheetModel) -> Self {
        let t = model.topology();
        let all = model.mass().row_sums(t);
        let mut masses = vec![Some(0.0); t.components().len()];
        for (v, m) in t.vertex_ids().zip(all) {
            let of_part = &mut masses[t.vertex_component(v)];
            *of_part = match model.free_index()[v.index()] {
                PINNED => None,
                _ => of_part.map(|sum| sum + m),
            };
        }
        for constraint in model.constraints() {
            masses[t.vertex_component(constraint.vertex())] = None;
        }
        Self {
            ways: vec![Vector3::zeros(); masses.len()],
            sums: vec![Vector3::zeros(); masses.len()],
            masses,
            any: false,
        }
    }

    /// Sets the ways of a step; `force` is room.
    fn begin(&mut self, model: &SheetModel, step: &StepStart<'_>, force: &mut [f64]) {
        self.any = false;
        self.ways.fill(Vector3::zeros());
        let mut weights = model
            .potentials()
            .filter(|p| p.shape() == PotentialShape::Linear)
            .peekable();
        if weights.peek().is_none() || self.masses.iter().all(Option::is_none) {
            return;
        }
        force.fill(0.0);
        let end = At::new(step.state.t + step.span, &step.state.x);
        weights.for_each(|p| p.add_gradient(end, force));
        let t = model.topology();
        for (v, gradient) in t.vertex_ids().zip(force.as_chunks::<3>().0) {
            self.ways[t.vertex_component(v)] -= Vector3::from(*gradient);
        }
        for (way, mass) in self.ways.iter_mut().zip(&self.masses) {
            *way *= mass.map_or(0.0, |m| step.h * step.h / m);
            self.any |= *way != Vector3::zeros();
        }
    }
}

impl Inertia {
    pub(super) fn new(model: &Arc<SheetModel>) -> Self {
        let n = model.coordinate_count();
        Self {
            model: Arc::clone(model),
            prediction: vec![0.0; n],
            difference: vec![0.0; n],
            product: vec![0.0; n],
            falling: Falling::new(model),
        }
    }

    /// How much less than the inertia term it is in the frames of the parts that fall, at the last value:
    ///
    /// ```text
    /// sum_k max(0, |d|_M^2 / 2 - |d - c_k|_M^2 / 2),     d = x - x^,
    /// ```
    ///
    /// over the connected parts `k` that nothing holds, with the way `c_k = h^2 F_k / m_k` that the weight
    /// `F_k` of the part alone takes it.
    pub(super) fn of_fall(&mut self) -> f64 {
        let Falling {
            masses,
            ways,
            sums,
            any,
        } = &mut self.falling;
        if !*any {
            return 0.0;
        }
        let t = self.model.topology();
        let mass = self.model.mass();
        mass.apply(t, &self.difference, &mut self.product);
        sums.fill(Vector3::zeros());
        for (v, p) in t.vertex_ids().zip(self.product.as_chunks::<3>().0) {
            sums[t.vertex_component(v)] += Vector3::from(*p);
        }
        let parts = ways.iter().zip(masses).zip(sums);
        let less = parts.filter_map(|((way, mass), sum)| {
            let of_part = sum.dot(way) - 0.5 * (*mass)? * way.norm_squared();
            Some(of_part.max(0.0))
        });
        less.sum()
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
    fn begin(&mut self, step: &StepStart<'_>) -> Result<(), StepError> {
        self.prediction.copy_from_slice(step.prediction);
        self.falling.begin(&self.model, step, &mut self.product);
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

    fn finish(&mut self, _: &StepStart<'_>, _: Iterate<'_>) -> Result<Exchange, StepError> {
        Ok(Exchange::default())
    }
}
