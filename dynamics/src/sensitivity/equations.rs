//! The equations of an accepted sub-step, and how they depend on what it started from.

use crate::contact::{ContactTerm, LagAt, ReachedPairs};
use crate::damped::formula::StepFormula;
use crate::damped::turning::Turning;
use crate::objective::Objective;
use crate::step::accepted::{AcceptedStep, OfPlaces, OfState, StepKind};
use crate::{SheetModel, StepError};
use isosheet_linalg::norm_inf;
use isosheet_materials::hessian::{
    BlockSink, CouplingSink, HessianPart, HessianProduct, HessianSink,
};
use isosheet_materials::vectors::diameter;
use isosheet_materials::{At, Difference, HessianKind, NoDerivative, Potential};
use isosheet_mesh::{EdgeId, VertexId};
use isosheet_model::term::{Formula, Iterate, Lagging, StartProducts, StepStart};
use nalgebra::{Matrix3, Vector3};
use std::sync::Arc;

/// The equations of a sub-step
///
/// ```text
/// R = M (x1 - x^) + h^2 sum_k dT_k/dx + G^T L = 0,   c = 0,
/// ```
///
/// evaluated where and with what model anybody likes: those of a run with other numbers at the states of this
/// run say how the residual depends on the numbers.
///
/// Contact is at the ends of the motions of its bodies, and friction is as it was lagged.
pub struct StepEquations<'a> {
    model: &'a Arc<SheetModel>,
    objective: &'a mut Objective,
    turning: Turning,
    places: [Vec<f64>; 3],
}

/// Part of the size of a sheet over which derivatives of a gradient are central differences.
const DIFFERENCE: f64 = 1e-6;

/// Where friction was lagged for the last time in the step that is differentiated.
#[derive(Debug, Clone, Copy)]
pub enum FrictionLag<'a> {
    /// At its start.
    Start,
    /// At these positions (`3V`, metres).
    Places(&'a [f64]),
}

impl<'a> StepEquations<'a> {
    pub(crate) fn new(model: &'a Arc<SheetModel>, objective: &'a mut Objective) -> Self {
        let n = model.coordinate_count();
        Self {
            model,
            objective,
            turning: Turning::new(model),
            places: [(); 3].map(|()| vec![0.0; n]),
        }
    }

    /// The model.
    pub fn model(&self) -> &SheetModel {
        self.model
    }

    /// Prepares the equations of a step at positions `x` (`3V`, metres) near its end.
    ///
    /// # Errors
    /// [`StepError`], if what acts in the step is not finite for instance.
    pub fn begin(
        &mut self,
        step: &AcceptedStep,
        lag: FrictionLag<'_>,
        x: &[f64],
    ) -> Result<(), StepError> {
        self.begin_with(step, lag, x, None)
    }

    /// As [`StepEquations::begin`], with the pairs of contact of equations that are nearly the same.
    ///
    /// # Errors
    /// As [`StepEquations::begin`].
    pub fn begin_like(
        &mut self,
        step: &AcceptedStep,
        lag: FrictionLag<'_>,
        x: &[f64],
        pairs: &ReachedPairs,
    ) -> Result<(), StepError> {
        self.begin_with(step, lag, x, Some(pairs))
    }

    /// The pairs of contact that were found.
    pub fn pairs(&self) -> ReachedPairs {
        let contact: Option<&ContactTerm> = self.objective.get();
        contact.map_or_else(ReachedPairs::default, ContactTerm::reached_pairs)
    }

    /// Goes on with equations that were prepared for the same step at the same place.
    pub fn go_on(&mut self, step: &AcceptedStep) {
        match step.kind {
            StepKind::Motion => {
                formula(step).place(self.model, &self.turning, &mut self.places);
            }
            StepKind::Search => {
                for place in &mut self.places {
                    place.copy_from_slice(&step.start.x);
                }
                let [_, _, ahead] = &mut self.places;
                self.model.place_pins(step.start.t + step.span, ahead);
            }
        }
    }

    fn begin_with(
        &mut self,
        step: &AcceptedStep,
        lag: FrictionLag<'_>,
        x: &[f64],
        pairs: Option<&ReachedPairs>,
    ) -> Result<(), StepError> {
        self.go_on(step);
        let start = start(step, &self.places);
        self.objective.begin_without_contact(&start)?;
        if let Some(contact) = self.objective.get_mut::<ContactTerm>() {
            let lag = match lag {
                FrictionLag::Start => LagAt::Start,
                FrictionLag::Places(y) => LagAt::Places(y),
            };
            contact.arrive(&start, lag, x, pairs);
        }
        let at = at(step, x);
        for term in self.objective.without_contact() {
            term.renew(at, Lagging::NOT_AT_ALL);
        }
        Ok(())
    }

    /// As [`StepEquations::residual`], of some parts of the potentials alone, one entry for each; of all
    /// where there is no list. Models that are compared differ by these.
    pub fn residual_of(
        &mut self,
        parts: &[Difference],
        step: &AcceptedStep,
        x: &[f64],
        out: &mut [f64],
    ) {
        self.objective.restrict(parts);
        self.residual(step, x, out);
        self.objective.restrict(&[]);
    }

    /// Sets the residual (`3V`, kilogram metres) at positions `x`, at pinned
    /// vertices too.
    pub fn residual(&mut self, step: &AcceptedStep, x: &[f64], out: &mut [f64]) {
        let at = at(step, x);
        self.objective.set_gradient(at, step.h, out);
        if !step.rods.is_empty() {
            self.model.rods().apply_transpose_add(x, &step.rods, out);
        }
        for (c, l) in self.model.constraints().iter().zip(&step.constraints) {
            let local = c.at(at.t, &place(x, c.vertex()));
            let force = local.jacobian.tr_mul(l);
            for k in 0..3 {
                out[3 * c.vertex().index() + k] += force[k];
            }
        }
    }

    /// Adds the derivative of the residual by the positions at the end, at pinned vertices too, but for what
    /// friction has by [lag](StepEquations::add_lag_products), and forces without energy by
    /// [`StartProducts::end`].
    pub fn add_hessian(&mut self, step: &AcceptedStep, x: &[f64], sink: &mut dyn BlockSink) {
        let at = at(step, x);
        let forces = step.h * step.h;
        self.objective.add_inertia_hessian(at, sink);
        let mut scaled = Scaled {
            sink: &mut *sink,
            scale: forces,
        };
        for term in self.objective.without_contact() {
            term.add_hessian(at, HessianPart::Full, &mut scaled);
        }
        if let Some(contact) = self.objective.get_mut::<ContactTerm>() {
            contact.add_tangent(x, &mut scaled);
        }
        let rods = self.model.rod_edges().iter().zip(self.model.rods().edges());
        for ((edge, ends), l) in rods.zip(&step.rods) {
            let block = Matrix3::from_diagonal_element(*l);
            for v in ends {
                sink.add_vertex(VertexId::from_index(*v), &block);
            }
            sink.add_edge(*edge, &-block);
        }
        for (c, l) in self.model.constraints().iter().zip(&step.constraints) {
            let local = c.at(at.t, &place(x, c.vertex()));
            sink.add_vertex(c.vertex(), &local.hessian(l));
        }
    }

    /// Adds to `out` (`3V`) the derivatives of `w . R` by the positions at which friction was lagged.
    pub fn add_lag_products(&mut self, step: &AcceptedStep, x: &[f64], w: &[f64], out: &mut [f64]) {
        let forces = step.h * step.h;
        if let Some(contact) = self.objective.get_mut::<ContactTerm>() {
            contact.add_lag_products(x, w, forces, out);
        }
    }

    /// Adds to `out` (`3V`) the derivatives of `w . R` by the positions at the end that the Hessian does not
    /// have, but for friction.
    ///
    /// # Errors
    /// [`NoDerivative`] of a term.
    pub fn add_end_products(
        &mut self,
        step: &AcceptedStep,
        x: &[f64],
        w: &[f64],
        out: &mut [f64],
    ) -> Result<(), NoDerivative> {
        let t = step.start.t + step.span;
        let potentials = self.model.potentials_at(t, x, &step.memories);
        for (potential, here) in potentials {
            if potential.hessian_kind() == HessianKind::Partial {
                let edges = self.model.edges().edges();
                add_rest(potential, here, edges, (w, step.h * step.h), out);
            }
        }
        if !self.objective.has_others() {
            return Ok(());
        }
        let products = self.products(step, x, w)?;
        out.iter_mut().zip(&products.end).for_each(|(o, p)| *o += p);
        Ok(())
    }

    /// The derivatives of `w . R` by what its terms see of the start, but for inertia and the lag of
    /// friction.
    fn products(
        &mut self,
        step: &AcceptedStep,
        x: &[f64],
        w: &[f64],
    ) -> Result<StartProducts, NoDerivative> {
        let at = at(step, x);
        let forces = step.h * step.h;
        let start = start(step, &self.places);
        let mut products = StartProducts::zeros(x.len());
        for term in self.objective.others_without_contact() {
            term.add_start_products(&start, at, w, forces, &mut products)?;
        }
        Ok(products)
    }

    /// Hands the derivatives `-w . dR` of a number on to what a step started from, and those by the
    /// velocities at its end as far as these are made of positions before.
    ///
    /// # Errors
    /// [`NoDerivative`] of a term or a force.
    pub fn pull_back(
        &mut self,
        step: &AcceptedStep,
        x: &[f64],
        w: &[f64],
        of_velocities: &[f64],
        of_start: &mut OfState,
        of_before: &mut OfState,
    ) -> Result<(), NoDerivative> {
        let n = x.len();
        let forces = step.h * step.h;
        let mut products = self.products(step, x, w)?;
        if let Some(contact) = self.objective.get_mut::<ContactTerm>() {
            contact.add_slip_products(x, w, forces, &mut products);
        }
        let mut of = OfPlaces {
            rest: products.rest.iter().map(|p| -p).collect(),
            prediction: vec![0.0; n],
            ahead: products.ahead.iter().map(|p| -p).collect(),
        };
        for (own, p) in of_start.x.iter_mut().zip(&products.start) {
            *own -= p;
        }
        let model = self.model;
        model.mass().apply(model.topology(), w, &mut of.prediction);
        for (rest, v) in of.rest.iter_mut().zip(of_velocities) {
            *rest -= v / step.h;
        }
        let is_search = step.kind == StepKind::Search;
        if !model.forces().is_empty() {
            let start = start(step, &self.places);
            let mut speeds = vec![0.0; n];
            start.add_velocity_ahead(&mut speeds);
            let mut of_speeds = vec![0.0; n];
            let weights: Vec<f64> = w.iter().map(|w| forces * w).collect();
            for force in model.forces() {
                let (t, ahead) = (start.t(), start.ahead);
                force.add_state_products(
                    t,
                    ahead,
                    &speeds,
                    &weights,
                    &mut of.ahead,
                    &mut of_speeds,
                )?;
            }
            let before = step.before.as_ref();
            if is_search {
                of_speeds.fill(0.0);
            }
            let ratio = before.map_or(0.0, |b| step.span / (step.start.t - b.t));
            for i in 0..n {
                of_start.v[i] += (1.0 + ratio) * of_speeds[i];
                of_before.v[i] -= ratio * of_speeds[i];
            }
        }
        match step.kind {
            StepKind::Motion => {
                formula(step).pull_back(model, &self.turning, &of, of_start, of_before);
            }
            StepKind::Search => {
                for v in model.moving_pins() {
                    of.ahead[3 * v..3 * v + 3].fill(0.0);
                }
                for i in 0..n {
                    of_start.x[i] += of.rest[i] + of.prediction[i] + of.ahead[i];
                }
            }
        }
        Ok(())
    }
}

/// Adds `scale` times the product of `w` and the second derivatives of a potential that are not in its
/// Hessian, by central differences of its gradient.
fn add_rest(
    potential: &dyn Potential,
    here: At<'_>,
    edges: &[[usize; 2]],
    (w, scale): (&[f64], f64),
    out: &mut [f64],
) {
    let largest = norm_inf(w);
    if largest == 0.0 {
        return;
    }
    let mut product = HessianProduct {
        edges,
        scale: -scale,
        vector: w,
        product: &mut *out,
    };
    potential.add_hessian(here, &mut product);
    let step = DIFFERENCE * diameter(here.x) / largest;
    let mut gradient = vec![0.0; out.len()];
    for side in [1.0, -1.0] {
        let moved = here.x.iter().zip(w).map(|(x, w)| x + side * step * w);
        let moved: Vec<f64> = moved.collect();
        gradient.fill(0.0);
        potential.add_gradient(At { x: &moved, ..here }, &mut gradient);
        let scale = 0.5 * side * scale / step;
        out.iter_mut()
            .zip(&gradient)
            .for_each(|(o, g)| *o += scale * g);
    }
}

fn formula(step: &AcceptedStep) -> StepFormula<'_> {
    StepFormula {
        start: &step.start,
        before: step.before.as_ref(),
        span: step.span,
        back: step.back,
        k: step.h / step.span,
    }
}

fn at<'a>(step: &'a AcceptedStep, x: &'a [f64]) -> Iterate<'a> {
    Iterate {
        t: step.start.t + step.span,
        x,
        memories: &step.memories,
    }
}

fn start<'a>(
    step: &'a AcceptedStep,
    [rest, prediction, ahead]: &'a [Vec<f64>; 3],
) -> StepStart<'a> {
    StepStart {
        state: &step.start,
        memories: &step.memories,
        before: step.before.as_ref(),
        span: step.span,
        sliding_time: step.sliding_time,
        h: step.h,
        formula: match step.before {
            Some(_) => Formula::TwoStep,
            None => Formula::OneStep,
        },
        back: step.back,
        rest,
        prediction,
        ahead,
    }
}

fn place(x: &[f64], v: VertexId) -> Vector3<f64> {
    isosheet_materials::vectors::point(x, v)
}

/// Hands blocks on, multiplied by a factor.
struct Scaled<'a> {
    sink: &'a mut dyn BlockSink,
    scale: f64,
}

impl HessianSink for Scaled<'_> {
    fn add_vertex(&mut self, v: VertexId, block: &Matrix3<f64>) {
        self.sink.add_vertex(v, &(self.scale * block));
    }

    fn add_edge(&mut self, e: EdgeId, block: &Matrix3<f64>) {
        self.sink.add_edge(e, &(self.scale * block));
    }

    fn add_pair(&mut self, a: VertexId, b: VertexId, block: &Matrix3<f64>) {
        self.sink.add_pair(a, b, &(self.scale * block));
    }

    fn add_square(&mut self, factor: f64, gradient: &[(VertexId, Vector3<f64>)]) {
        self.sink.add_square(self.scale * factor, gradient);
    }
}

impl CouplingSink for Scaled<'_> {
    fn add(&mut self, a: u32, b: u32, block: &Matrix3<f64>) {
        self.sink.add(a, b, &(self.scale * block));
    }
}
