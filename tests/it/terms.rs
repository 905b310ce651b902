//! Terms of the objective, potentials and forces that are written outside: they move a sheet as theory says,
//! or are refused with their names.

use isosheet_dynamics::term::{
    Barrier, BlockSink, Exchange, HessianPart, ImplicitForce, Iterate, StepStart, Term, Value,
};
use isosheet_dynamics::{
    At, CreaseSprings, Force, HessianSink, Method, Potential, PotentialFault, SheetModel,
    Simulation, SimulationError, State, StepError, check_derivatives,
};
use isosheet_mesh::{MassKind, Sheet, VertexId, generate};
use nalgebra::Matrix3;
use std::sync::Arc;

const G: f64 = 9.8;
const MASS: f64 = 0.02;

fn square() -> Sheet {
    generate::isotropic_square(1, 0.2).expect("a square")
}

fn model(sheet: &Sheet) -> SheetModel {
    let model = SheetModel::new(sheet, MASS, MassKind::Lumped).expect("masses");
    model.with_gravity()
}

fn fall(sheet: &Sheet, model: SheetModel, h: f64, steps: usize) -> Result<Simulation, StepError> {
    let start = State::at_rest(sheet.positions().to_vec());
    let mut run = Simulation::new(model, start, Method::default()).expect("a simulation");
    for _ in 0..steps {
        run.step(h)?;
    }
    Ok(run)
}

/// Quadratic drag `-k |v| v` of each kilogram, with `k` in 1/m.
#[derive(Clone, Debug)]
struct Drag {
    masses: Vec<f64>,
    k: f64,
}

impl Drag {
    fn new(model: &SheetModel, k: f64) -> Self {
        let masses = model.mass().row_sums(model.topology());
        Self { masses, k }
    }

    /// The velocity of a fall from rest, metres per second: `-u tanh(g t / u)` with `u^2 = g / k`.
    fn exact(&self, t: f64) -> f64 {
        let u = (G / self.k).sqrt();
        -u * (G * t / u).tanh()
    }

    fn each<'a>(&'a self, v: &'a [f64]) -> impl Iterator<Item = (f64, [f64; 3], f64)> + 'a {
        let rows = v.as_chunks::<3>().0.iter().zip(&self.masses);
        rows.map(|(v, m)| {
            let speed = v.iter().map(|v| v * v).sum::<f64>().sqrt();
            (m * self.k, *v, speed)
        })
    }
}

impl Force for Drag {
    fn add_force(&self, _t: f64, _x: &[f64], v: &[f64], force: &mut [f64]) {
        for ((c, v, speed), out) in self.each(v).zip(force.as_chunks_mut::<3>().0) {
            for k in 0..3 {
                out[k] -= c * speed * v[k];
            }
        }
    }
}

impl ImplicitForce for Drag {
    fn term(&self, free: Arc<[bool]>) -> Box<dyn Term> {
        Box::new(DragInStep {
            drag: self.clone(),
            free,
            rest: Vec::new(),
            h: 1.0,
        })
    }
}

/// `h k m |v|^3 / 3` with `v = (x - y) / h`.
struct DragInStep {
    drag: Drag,
    free: Arc<[bool]>,
    rest: Vec<f64>,
    h: f64,
}

impl DragInStep {
    fn velocities(&self, x: &[f64]) -> Vec<f64> {
        let pairs = x.iter().zip(&self.rest);
        pairs.map(|(x, y)| (x - y) / self.h).collect()
    }
}

impl Term for DragInStep {
    fn begin(&mut self, step: &StepStart<'_>) -> Result<(), StepError> {
        self.rest = step.rest.to_vec();
        self.h = step.h;
        Ok(())
    }

    fn value(&mut self, at: Iterate<'_>) -> Value {
        let v = self.velocities(at.x);
        let sum: f64 = self.drag.each(&v).map(|(c, _, s)| c * s.powi(3)).sum();
        Value::of(self.h * sum / 3.0)
    }

    fn add_gradient(&mut self, at: Iterate<'_>, scale: f64, out: &mut [f64]) {
        let v = self.velocities(at.x);
        for ((c, v, speed), out) in self.drag.each(&v).zip(out.as_chunks_mut::<3>().0) {
            for k in 0..3 {
                out[k] += scale * c * speed * v[k];
            }
        }
    }

    fn add_hessian(&mut self, at: Iterate<'_>, _part: HessianPart, sink: &mut dyn BlockSink) {
        let v = self.velocities(at.x);
        for (i, (c, v, speed)) in self.drag.each(&v).enumerate().filter(|(_, e)| e.2 > 0.0) {
            let v = nalgebra::Vector3::from(v);
            let block = (speed * Matrix3::identity() + v * v.transpose() / speed) * c / self.h;
            sink.add_vertex(VertexId::from_index(i), &block);
        }
    }

    fn finish(&mut self, step: &StepStart<'_>, at: Iterate<'_>) -> Result<Exchange, StepError> {
        let mut end = vec![0.0; at.x.len()];
        self.add_gradient(at, -1.0, &mut end);
        Ok(step.implicit_work(&self.drag, &self.free, at.x, &mut end))
    }
}

/// A fall in a drag that stops it within a twentieth of a step: as a term it has the order of the method, and
/// as a plain force it is divided until it is right, or refused.
#[test]
fn stiff_drag_is_a_term_or_is_divided() {
    let sheet = square();
    let velocity = |model: SheetModel, h: f64, steps: usize| {
        let run = fall(&sheet, model, h, steps)?;
        Ok::<f64, StepError>(run.state().v[2])
    };
    let drag = Drag::new(&model(&sheet), 4.0);
    let error = |h: f64| {
        let steps = (0.3 / h).round() as usize;
        let v = velocity(model(&sheet).with_implicit_force(drag.clone()), h, steps);
        (v.expect("a fall") - drag.exact(0.3)).abs()
    };
    let errors = [0.02, 0.01, 0.005].map(error);
    assert!(
        errors[0] / errors[1] > 3.3 && errors[1] / errors[2] > 3.3,
        "{errors:?}"
    );

    let stiff = Drag::new(&model(&sheet), 2e4);
    let terminal = stiff.exact(1.0);
    let v = velocity(model(&sheet).with_implicit_force(stiff.clone()), 0.02, 20);
    assert!((v.expect("a fall") / terminal - 1.0).abs() < 1e-3);
    // A plain force of this size explodes in steps that take it as it was; whatever is accepted is the fall.
    match velocity(model(&sheet).with_force(stiff), 0.02, 20) {
        Ok(v) => assert!((v / terminal - 1.0).abs() < 0.02, "{v} {terminal}"),
        Err(StepError::StepTooSmall { cause, .. }) => {
            assert!(matches!(*cause, StepError::StiffForce { .. }), "{cause}");
        }
        Err(other) => panic!("{other}"),
    }
}

/// A floor at `z = 0`: `-k ln(z)` of each vertex, infinite below.
#[derive(Clone, Debug)]
struct Floor(f64);

impl Force for Floor {
    fn add_force(&self, _t: f64, _x: &[f64], _v: &[f64], _force: &mut [f64]) {}
}

impl ImplicitForce for Floor {
    fn term(&self, _free: Arc<[bool]>) -> Box<dyn Term> {
        Box::new(self.clone())
    }

    fn needs_minimising(&self) -> bool {
        true
    }
}

fn heights(x: &[f64]) -> impl Iterator<Item = f64> + '_ {
    x.as_chunks::<3>().0.iter().map(|p| p[2])
}

impl Term for Floor {
    fn begin(&mut self, _step: &StepStart<'_>) -> Result<(), StepError> {
        Ok(())
    }

    fn value(&mut self, at: Iterate<'_>) -> Value {
        Value::of(heights(at.x).map(|z| -self.0 * z.ln()).sum())
    }

    fn add_gradient(&mut self, at: Iterate<'_>, scale: f64, out: &mut [f64]) {
        for (z, out) in heights(at.x).zip(out.as_chunks_mut::<3>().0) {
            out[2] -= scale * self.0 / z;
        }
    }

    fn add_hessian(&mut self, at: Iterate<'_>, _part: HessianPart, sink: &mut dyn BlockSink) {
        for (i, z) in heights(at.x).enumerate() {
            let block = Matrix3::from_diagonal(&[0.0, 0.0, self.0 / (z * z)].into());
            sink.add_vertex(VertexId::from_index(i), &block);
        }
    }

    fn barrier(&self) -> Option<Barrier> {
        Some(Barrier::Other("floor"))
    }

    fn safe_part(&mut self, at: Iterate<'_>, dx: &[f64]) -> f64 {
        let parts = heights(at.x)
            .zip(heights(dx))
            .map(|(z, d)| 0.9 * z / -d.min(-0.0));
        parts.filter(|part| *part > 0.0).fold(1.0, f64::min)
    }

    fn finish(&mut self, step: &StepStart<'_>, at: Iterate<'_>) -> Result<Exchange, StepError> {
        let energy = |x: &[f64]| heights(x).map(|z| -self.0 * z.ln()).sum::<f64>();
        let stored = energy(at.x) - energy(&step.state.x);
        Ok(Exchange::driven(-stored))
    }
}

/// A sheet that falls comes to rest where the force of the barrier is its weight, and never is below it.
#[test]
fn a_barrier_from_outside_holds_a_sheet() {
    let sheet = square()
        .map_positions(|[x, y, z]| [x, y, z + 0.1])
        .expect("raised");
    let (k, step) = (1e-4, 0.01);
    let model = model(&sheet).with_implicit_force(Floor(k));
    let model = model.with_damping(8.0).expect("damping");
    let vertices = sheet.positions().len() as f64 / 3.0;
    let start = State::at_rest(sheet.positions().to_vec());
    let mut run = Simulation::new(model, start, Method::default()).expect("a simulation");
    for _ in 0..200 {
        run.step(step).expect("a step");
        assert!(heights(&run.state().x).all(|z| z > 0.0));
    }
    // The sum of k / z over the vertices is the weight; masses at corners are less, and those vertices
    // higher.
    let push: f64 = heights(&run.state().x).map(|z| k / z).sum();
    assert!((push / (MASS * G) - 1.0).abs() < 1e-3, "{push} {vertices}");
}

/// A spring of no length between two vertices, which is named or not, with the gradient of another stiffness.
#[derive(Debug)]
struct Spring {
    ends: [VertexId; 2],
    is_named_from: f64,
    stiffness: [f64; 3],
}

impl Spring {
    fn right(stiffness: f64) -> Self {
        Self {
            ends: [VertexId(0), VertexId(24)],
            is_named_from: f64::INFINITY,
            stiffness: [stiffness; 3],
        }
    }

    fn along(&self, x: &[f64]) -> nalgebra::Vector3<f64> {
        let [a, b] = self
            .ends
            .map(|v| nalgebra::Vector3::from(x.as_chunks::<3>().0[v.index()]));
        b - a
    }
}

impl Potential for Spring {
    fn energy(&self, at: At<'_>) -> f64 {
        0.5 * self.stiffness[0] * self.along(at.x).norm_squared()
    }

    fn add_gradient(&self, at: At<'_>, gradient: &mut [f64]) {
        let force = self.stiffness[1] * self.along(at.x);
        for k in 0..3 {
            gradient[3 * self.ends[0].index() + k] -= force[k];
            gradient[3 * self.ends[1].index() + k] += force[k];
        }
    }

    fn add_hessian(&self, at: At<'_>, hessian: &mut dyn HessianSink) {
        let block = self.stiffness[2] * Matrix3::identity();
        let [a, b] = self.ends;
        hessian.add_vertex(a, &block);
        hessian.add_vertex(b, &block);
        if at.t >= self.is_named_from {
            hessian.add_pair(a, b, &-block);
        }
    }
}

fn fault(error: Option<StepError>) -> (String, PotentialFault) {
    match error {
        Some(StepError::Potential { bad, .. }) => (bad.name.clone(), bad.fault),
        other => panic!("{other:?}"),
    }
}

#[test]
fn a_pair_that_comes_later_and_is_not_named_is_refused() {
    let sheet = square();
    let late = Spring {
        is_named_from: 0.05,
        ..Spring::right(1.0)
    };
    let error = fall(&sheet, model(&sheet).with_potential(late), 0.01, 20).err();
    let block = "the pair of vertex 0 and vertex 24".to_owned();
    assert_eq!(
        fault(error),
        ("Spring".to_owned(), PotentialFault::Block { block })
    );
}

#[test]
fn what_is_not_a_number_is_named() {
    let sheet = square();
    for (which, quantity) in ["energy", "gradient", "Hessian"].into_iter().enumerate() {
        let mut spring = Spring::right(1.0);
        spring.stiffness[which] = f64::NAN;
        let model =
            model(&sheet).with_potential(CreaseSprings::bending(&sheet, 1e-4).expect("a plate"));
        let start = State::at_rest(sheet.positions().to_vec());
        let refused = Simulation::new(model.with_potential(spring), start, Method::default()).err();
        let Some(SimulationError::Start(error)) = refused else {
            panic!("{refused:?}");
        };
        let (name, found) = fault(Some(error));
        assert_eq!(name, "Spring");
        assert!(
            matches!(found, PotentialFault::NotFinite { quantity: q, .. } if q == quantity),
            "{found}"
        );
    }
}

/// A gradient that is 1 % too large is told by the check of derivatives, and one that no search succeeds with
/// by the error.
#[test]
fn a_gradient_that_is_no_derivative_is_found() {
    let sheet = square();
    let mut wrong = Spring::right(1.0);
    wrong.stiffness[1] = 1.01;
    let errors = check_derivatives(&wrong, sheet.topology(), At::new(0.0, sheet.positions()));
    assert!((errors.gradient - 0.01 / 1.01).abs() < 1e-3, "{errors:?}");
    let right = check_derivatives(
        &Spring::right(1.0),
        sheet.topology(),
        At::new(0.0, sheet.positions()),
    );
    assert!(right.gradient < 1e-7, "{right:?}");

    let wrong = model(&sheet).with_potential(Well);
    let (name, found) = fault(fall(&sheet, wrong, 0.01, 20).err());
    assert_eq!(name, "Well");
    assert!(
        matches!(found, PotentialFault::Gradient { part } if (part - 2.0).abs() < 0.1),
        "{found}"
    );
}

/// `k (z - 1)^2 / 2` of each vertex, with a gradient of the wrong sign.
#[derive(Debug)]
struct Well;

impl Potential for Well {
    fn energy(&self, at: At<'_>) -> f64 {
        heights(at.x).map(|z| 5.0 * (z - 1.0).powi(2)).sum()
    }

    fn add_gradient(&self, at: At<'_>, gradient: &mut [f64]) {
        for (z, g) in heights(at.x).zip(gradient.as_chunks_mut::<3>().0) {
            g[2] -= 10.0 * (z - 1.0);
        }
    }
}

/// Couples two vertices without saying so.
#[derive(Clone, Debug)]
struct Silent;

impl Force for Silent {
    fn add_force(&self, _t: f64, _x: &[f64], _v: &[f64], _force: &mut [f64]) {}
}

impl ImplicitForce for Silent {
    fn term(&self, _free: Arc<[bool]>) -> Box<dyn Term> {
        Box::new(self.clone())
    }
}

impl Term for Silent {
    fn begin(&mut self, _step: &StepStart<'_>) -> Result<(), StepError> {
        Ok(())
    }

    fn value(&mut self, _at: Iterate<'_>) -> Value {
        Value::of(0.0)
    }

    fn add_gradient(&mut self, _at: Iterate<'_>, _scale: f64, _out: &mut [f64]) {}

    fn add_hessian(&mut self, _at: Iterate<'_>, _part: HessianPart, sink: &mut dyn BlockSink) {
        sink.add(0, 24, &Matrix3::identity());
    }

    fn finish(&mut self, _step: &StepStart<'_>, _at: Iterate<'_>) -> Result<Exchange, StepError> {
        Ok(Exchange::default())
    }
}

#[test]
fn a_term_that_does_not_name_a_pair_is_refused() {
    let sheet = square();
    let error = fall(&sheet, model(&sheet).with_implicit_force(Silent), 0.01, 1).err();
    let Some(StepError::StepTooSmall { cause, .. }) = error else {
        panic!("{error:?}");
    };
    assert!(matches!(*cause, StepError::Refused { .. }), "{cause}");
}
