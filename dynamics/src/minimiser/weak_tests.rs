//! The augmented Lagrangian of a sheet that is isometric in weak form, against finite differences.

use super::lagrangian::{Lagrangian, RodLoad};
use super::problem::StepProblem;
use crate::constraint::rows::HessianPart;
use crate::effort::SolverEffort;
use crate::{PlateBending, SheetModel, State, WeakIsometry};
use isosheet_mesh::{MassKind, Sheet, VertexId, generate};

const H: f64 = 0.01;
const PIN: VertexId = VertexId(6);

fn sheet() -> Sheet {
    generate::isotropic_square(1, 1.0).unwrap()
}

/// With a pin that moves by `shift` metres in the step, and a membrane of the given stiffness.
fn model(stiffness: f64, shift: f64) -> SheetModel {
    let sheet = sheet();
    let [x, y, z] = sheet.position(PIN);
    SheetModel::new(&sheet, 0.2, MassKind::Lumped)
        .unwrap()
        .with_gravity()
        .with_moving_pin(PIN, move |t: f64| {
            let s = shift * t / H;
            [x + 0.3 * s, y - 0.5 * s, z + s]
        })
        .unwrap()
        .with_weak_isometry(WeakIsometry::new(&sheet, stiffness).unwrap())
        .unwrap()
}

/// A step of a crumpled sheet.
struct Scene {
    model: SheetModel,
    state: State,
    prediction: Vec<f64>,
}

impl Scene {
    fn new(model: SheetModel) -> Self {
        let mut x = sheet().positions().to_vec();
        for (i, x) in x.iter_mut().enumerate() {
            if i / 3 != PIN.index() {
                *x += 0.02 * (1.7 * i as f64).sin();
            }
        }
        Self {
            model,
            prediction: x.iter().map(|x| x + 1e-3).collect(),
            state: State::at_rest(x),
        }
    }

    fn problem(&self) -> StepProblem<'_> {
        StepProblem {
            model: &self.model,
            contact: None,
            state: &self.state,
            span: H,
            h: H,
            prediction: &self.prediction,
            applied: &self.state.v,
        }
    }

    /// The augmented Lagrangian at the start, with multipliers of both signs.
    fn lagrangian(&self) -> Lagrangian {
        let mut problem = self.problem();
        let mut lagrangian = Lagrangian::new(&self.model).unwrap();
        lagrangian.begin(&mut problem);
        lagrangian.set_stiffness(1.0, 1.0);
        for (r, l) in lagrangian.multipliers.iter_mut().enumerate() {
            *l = 1e-6 * (3.1 * r as f64).sin();
        }
        lagrangian.merit(&problem);
        lagrangian
    }
}

fn largest(values: &[f64]) -> f64 {
    values.iter().fold(0.0, |m: f64, v| m.max(v.abs()))
}

#[test]
fn gradient_and_hessian_are_derivatives_of_the_value() {
    let plate = PlateBending::new(&sheet(), 1e-3).unwrap();
    let scene = Scene::new(model(50.0, 0.0).with_potential(plate));
    let problem = scene.problem();
    let mut lagrangian = scene.lagrangian();
    lagrangian.set_gradient(&problem);
    let gradient = lagrangian.gradient.clone();
    let mut effort = SolverEffort::default();
    lagrangian
        .factorize(&problem, RodLoad::Estimates, HessianPart::Full, &mut effort)
        .unwrap();
    assert_eq!(effort.factorisations, 1, "the whole Hessian");
    let mut along: Vec<f64> = (0..gradient.len())
        .map(|i| (0.7 * i as f64).cos())
        .collect();
    scene.model.clear_pinned(&mut along);
    let product = lagrangian.matrix.product(&scene.model, &along);
    let d = 1e-6;
    let mut at = |s: f64| {
        for (x, a) in lagrangian.iterate.x_mut().iter_mut().zip(&along) {
            *x += s * a;
        }
        let value = lagrangian.merit(&problem).value;
        lagrangian.set_gradient(&problem);
        for (x, a) in lagrangian.iterate.x_mut().iter_mut().zip(&along) {
            *x -= s * a;
        }
        (value, lagrangian.gradient.clone())
    };
    let (plus, minus) = (at(d), at(-d));
    let slope: f64 = gradient.iter().zip(&along).map(|(g, a)| g * a).sum();
    let difference = (plus.0 - minus.0) / (2.0 * d);
    assert!((slope - difference).abs() < 1e-6 * slope.abs());
    for i in 0..along.len() {
        let difference = (plus.1[i] - minus.1[i]) / (2.0 * d);
        let error = (difference - product[i]).abs();
        assert!(error < 1e-7 * largest(&product), "{i}: {error}");
    }
}

/// While a pin is on its way the gradient has what the rest of the way will change it by, but for the share
/// of the potentials: here next to nothing.
#[test]
fn the_gradient_knows_the_rest_of_the_motion_of_a_pin() {
    let left = |shift: f64| {
        let scene = Scene::new(model(1e-9, shift));
        let problem = scene.problem();
        let mut lagrangian = scene.lagrangian();
        assert!(lagrangian.is_driven(&problem));
        lagrangian.set_gradient(&problem);
        let foreseen = lagrangian.gradient.clone();
        lagrangian.place_pins(&problem);
        assert!(!lagrangian.is_driven(&problem));
        lagrangian.merit(&problem);
        lagrangian.set_gradient(&problem);
        let differences = lagrangian.gradient.iter().zip(&foreseen);
        let differences: Vec<f64> = differences.map(|(a, b)| a - b).collect();
        largest(&differences)
    };
    // What is left is of second order.
    let (one, half) = (left(1e-3), left(5e-4));
    let order = (one / half).log2();
    assert!((1.95..2.05).contains(&order), "{one} {half}");
}
