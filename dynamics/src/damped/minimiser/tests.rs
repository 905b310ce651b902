//! The pieces of the minimiser, each against something independent of it.

use super::Minimiser;
use super::lagrangian::{Definiteness, Lagrangian};
use super::problem::StepProblem;
use crate::damped::restoration::{FirstMatrix, Restoration, RestorationGoal};
use crate::linear::constraint_rows::RowLoad;
use crate::linear::primal::PrimalMatrix;
use crate::objective::Objective;
use crate::report::effort::SolverEffort;
use crate::step::integrator::Phases;
use crate::step::tuning::Tuning;
use crate::{CreaseSprings, ElasticSheet, ImplicitOptions, PlateBending, SheetModel, State};
use isosheet_materials::hessian::HessianPart;
use isosheet_materials::potential::Memories;
use isosheet_mesh::{MassKind, Sheet, VertexId, generate};
use isosheet_model::term::{Formula, StepStart};
use nalgebra::DMatrix;
use std::sync::Arc;

const H: f64 = 0.01;

/// A crumpled sheet of 25 vertices with bending stiffness, pinned at a corner, and positions off its lengths.
struct Scene {
    model: Arc<SheetModel>,
    memories: Memories,
    objective: Objective,
    state: State,
    prediction: Vec<f64>,
}

/// A step from a state at rest.
fn step<'a>(state: &'a State, memories: &'a Memories, prediction: &'a [f64]) -> StepStart<'a> {
    StepStart {
        state,
        memories,
        span: H,
        sliding_time: H,
        h: H,
        formula: Formula::OneStep,
        back: 0.0,
        before: None,
        rest: &state.x,
        prediction,
        ahead: &state.x,
    }
}

impl Scene {
    fn new(crumple: f64) -> Self {
        let flat = generate::isotropic_square(1, 1.0).unwrap();
        let mut x = flat.positions().to_vec();
        for (i, x) in x.iter_mut().enumerate() {
            *x += crumple * (1.7 * i as f64).sin();
        }
        let sheet = Sheet::new(x, &flat.face_indices()).unwrap();
        let model = SheetModel::new(&sheet, 0.2, MassKind::Lumped)
            .unwrap()
            .with_gravity()
            .with_pins(&[VertexId(0)])
            .unwrap()
            .with_potential(CreaseSprings::bending(&sheet, 1e-3).unwrap());
        let state = State::at_rest(sheet.positions().to_vec());
        let mut prediction = state.x.clone();
        for (i, x) in prediction.iter_mut().enumerate().skip(3) {
            *x += 2e-3 * (2.3 * i as f64).cos();
        }
        Self::of(model, state, prediction)
    }

    fn of(model: SheetModel, state: State, prediction: Vec<f64>) -> Self {
        let model = Arc::new(model);
        Self {
            memories: model.memories(),
            objective: Objective::new(&model),
            model,
            state,
            prediction,
        }
    }

    fn problem(&mut self) -> StepProblem<'_> {
        StepProblem {
            model: &self.model,
            memories: &self.memories,
            objective: &mut self.objective,
            start: step(&self.state, &self.memories, &self.prediction),
            phases: Phases::All,
        }
    }
}

/// The augmented Lagrangian at the prediction, with multipliers of both signs.
fn lagrangian(problem: &mut StepProblem<'_>, stiffness: f64) -> Lagrangian {
    let mut lagrangian = Lagrangian::new(problem.model, Tuning::default()).unwrap();
    lagrangian.begin(problem).unwrap();
    lagrangian.set_stiffness(stiffness, stiffness);
    for (e, l) in lagrangian.multipliers.iter_mut().enumerate() {
        *l = 1e-4 * (3.1 * e as f64).sin();
    }
    lagrangian.predict(problem);
    lagrangian.merit(problem);
    lagrangian
}

#[test]
fn the_gradient_is_the_derivative_of_the_value() {
    let mut scene = Scene::new(0.02);
    let problem = &mut scene.problem();
    let mut lagrangian = lagrangian(problem, 100.0);
    lagrangian.set_gradient(problem);
    let gradient = lagrangian.gradient.clone();
    let d = 1e-6;
    let largest = gradient.iter().fold(0.0_f64, |m, g| m.max(g.abs()));
    for i in (3..gradient.len()).step_by(4) {
        let mut value = |s: f64| {
            lagrangian.x[i] += s * d;
            let value = lagrangian.merit(problem).value;
            lagrangian.x[i] -= s * d;
            value
        };
        let slope = (value(1.0) - value(-1.0)) / (2.0 * d);
        assert!(
            (slope - gradient[i]).abs() < 1e-6 * largest,
            "{i}: {slope} {}",
            gradient[i]
        );
    }
    assert!(
        gradient[..3].iter().all(|g| *g == 0.0),
        "a pinned vertex has no gradient"
    );
}

/// Without creases, whose Hessian is not the full one.
#[test]
fn the_hessian_is_the_derivative_of_the_gradient() {
    let Scene {
        state, prediction, ..
    } = Scene::new(0.02);
    let sheet = generate::isotropic_square(1, 1.0).unwrap();
    let sheet = Sheet::new(state.x.clone(), &sheet.face_indices()).unwrap();
    let model = SheetModel::new(&sheet, 0.2, MassKind::Lumped)
        .unwrap()
        .with_gravity()
        .with_pins(&[VertexId(0)])
        .unwrap();
    let mut scene = Scene::of(model, state, prediction);
    let problem = &mut scene.problem();
    let mut lagrangian = lagrangian(problem, 1.0);
    lagrangian.set_gradient(problem);
    let mut effort = SolverEffort::default();
    let definite = lagrangian
        .factorize(problem, RowLoad::Estimates, HessianPart::Full, &mut effort)
        .unwrap();
    assert_eq!(
        (definite, effort.factorisations),
        (Definiteness::Definite, 1)
    );
    let mut along: Vec<f64> = (0..lagrangian.x.len())
        .map(|i| (0.7 * i as f64).cos())
        .collect();
    problem.model.clear_pinned(&mut along);
    let product = lagrangian.matrix.product(problem.model, &along);
    let d = 1e-6;
    let mut gradient = |s: f64| {
        for (x, a) in lagrangian.x.iter_mut().zip(&along) {
            *x += s * d * a;
        }
        lagrangian.merit(problem);
        lagrangian.set_gradient(problem);
        let gradient = lagrangian.gradient.clone();
        for (x, a) in lagrangian.x.iter_mut().zip(&along) {
            *x -= s * d * a;
        }
        gradient
    };
    let (plus, minus) = (gradient(1.0), gradient(-1.0));
    let largest = product.iter().fold(0.0_f64, |m, p| m.max(p.abs()));
    for i in 0..along.len() {
        let difference = (plus[i] - minus[i]) / (2.0 * d);
        assert!((difference - product[i]).abs() < 1e-7 * largest, "{i}");
    }
}

/// A flat sheet under pressure in its plane is a saddle: it buckles, and the value falls.
#[test]
fn a_saddle_is_left_downwards_and_a_minimum_is_not() {
    let mut scene = Scene::new(0.0);
    scene.prediction = scene.state.x.clone();
    for (pressure, leaves) in [(-1e-2, true), (1e-2, false), (0.0, false)] {
        let problem = &mut scene.problem();
        let mut lagrangian = lagrangian(problem, 1e4);
        lagrangian.multipliers.fill(pressure);
        let before = lagrangian.merit(problem).value;
        lagrangian.set_gradient(problem);
        let mut effort = SolverEffort::default();
        let hessian = lagrangian
            .factorize(
                problem,
                RowLoad::Multipliers,
                HessianPart::Full,
                &mut effort,
            )
            .unwrap();
        assert_eq!(
            hessian == Definiteness::Modified,
            leaves,
            "pressure {pressure}"
        );
        let start = lagrangian.x.clone();
        assert_eq!(
            lagrangian.leave_saddle(problem, 0, 0.0, &mut effort),
            leaves
        );
        let after = lagrangian.merit(problem).value;
        assert_eq!(after < before, leaves, "{before} {after}");
        assert_eq!(lagrangian.x != start, leaves);
        assert_eq!(lagrangian.x[..3], start[..3], "pinned");
    }
}

/// The restoration finds the nearest positions with the rest lengths, in the sense of the masses: to first
/// order its displacement lies in the range of `M^-1 G^T`, and its part along the manifold is of second
/// order.
#[test]
fn a_restoration_is_a_projection_to_first_order() {
    let scene = Scene::new(0.1);
    let model = &scene.model;
    let mut left = Vec::new();
    for size in [1e-4, 5e-5] {
        let mut x = scene.state.x.clone();
        for (i, x) in x.iter_mut().enumerate().skip(3) {
            *x += size * (0.9 * i as f64).sin();
        }
        let displaced = x.clone();
        let mut matrix = PrimalMatrix::new(model).unwrap();
        let mut effort = SolverEffort::default();
        let goal = RestorationGoal {
            tolerance: 1e-13,
            max_iterations: 30,
            may_be_far: false,
            t: 0.0,
            loads: &[],
            matrix: FirstMatrix::Assembled,
        };
        let strain = Restoration::new(model, Tuning::default()).positions(
            model,
            &mut matrix,
            None,
            &mut x,
            goal,
            &mut effort,
        );
        assert!(strain <= 1e-13, "{strain}");
        let moved: Vec<f64> = x.iter().zip(&displaced).map(|(a, b)| a - b).collect();
        let mut momentum = vec![0.0; x.len()];
        model.apply_mass(&moved, &mut momentum);
        // What no forces of rods at the result give.
        let mut transposed = DMatrix::zeros(x.len(), model.rods().len());
        for (e, mut column) in transposed.column_iter_mut().enumerate() {
            let mut unit = vec![0.0; model.rods().len()];
            unit[e] = 1.0;
            let column = column.as_mut_slice();
            model.rods().apply_transpose_add(&x, &unit, column);
            model.clear_pinned(column);
        }
        let momentum = DMatrix::from_column_slice(x.len(), 1, &momentum);
        let svd = transposed.clone().svd(true, true);
        let forces = svd.solve(&momentum, 1e-12).unwrap();
        left.push((momentum - transposed * forces).norm());
    }
    assert!(left[1] < 0.3 * left[0], "{left:?}");
}

/// A step of a hanging sheet with bending stiffness ends at the same minimum whether the whole matrix is
/// factorised or far couplings are left to conjugate gradients.
#[test]
fn the_minimum_does_not_depend_on_what_is_factorised() {
    let sheet = generate::isotropic_square(3, 1.0).unwrap();
    let sheet = sheet
        .map_positions(|[x, y, _]| [x, y, 0.05 * (3.0 * x).sin() * (2.0 * y).cos()])
        .unwrap();
    let base = || {
        SheetModel::new(&sheet, 0.1, MassKind::Lumped)
            .unwrap()
            .with_gravity()
            .with_pins(&[VertexId(0), VertexId(1)])
            .unwrap()
    };
    let plate = || PlateBending::new(&sheet, 5e-4).unwrap();
    let models = [
        base().with_potential(plate()),
        base().with_potential(CreaseSprings::bending(&sheet, 5e-4).unwrap()),
        base()
            .with_elastic_sheet(ElasticSheet::new(&sheet, 3e3, 0.3).unwrap())
            .unwrap()
            .with_potential(plate()),
    ];
    for model in &models.map(Arc::new) {
        let state = State::at_rest(sheet.positions().to_vec());
        let options = ImplicitOptions {
            tolerance: Some(1e-12),
            ..ImplicitOptions::default()
        };
        let minimise = |is_iterative: bool| {
            let mut minimiser = Minimiser::new(model, options.clone(), &Tuning::default()).unwrap();
            if !is_iterative {
                minimiser.work.lagrangian.matrix.leave_iteration();
            }
            let memories = model.memories();
            let mut problem = StepProblem {
                model,
                memories: &memories,
                objective: &mut Objective::new(model),
                start: step(&state, &memories, &state.x),
                phases: Phases::All,
            };
            let mut effort = SolverEffort::default();
            minimiser.minimise(&mut problem, &mut effort).unwrap();
            assert_eq!(
                minimiser.work.lagrangian.matrix.is_iterative(),
                is_iterative
            );
            (minimiser.x().to_vec(), effort.factorisations)
        };
        let (iterative, count) = minimise(true);
        let (direct, whole_count) = minimise(false);
        assert!(count <= 2 * whole_count + 2, "{count} and {whole_count}");
        let distance = |a: &[f64], b: &[f64]| {
            let d: Vec<f64> = a.iter().zip(b).map(|(a, b)| a - b).collect();
            model.kinetic_energy(&d).sqrt()
        };
        let (apart, moved) = (distance(&iterative, &direct), distance(&direct, &state.x));
        assert!(apart < 1e-5 * moved, "{apart} of {moved}");
    }
}
