//! Steps and multipliers against the equations of the saddle-point system.

use super::{ConstrainedSolver, ConstrainedSystem, MultiplierGoal, SupportRows};
use crate::SheetModel;
use crate::linear::constraint_rows::VertexRows;
use crate::linear::free::penalties;
use crate::linear::primal::PrimalMatrix;
use isosheet_materials::vectors::{add, point};
use isosheet_mesh::{MassKind, Sheet, VertexId, generate};
use nalgebra::Vector3;

/// A square of 25 vertices, pinned at a corner, and crumpled by random displacements of a given size
/// (metres).
fn model(crumple: f64) -> (SheetModel, Vec<f64>) {
    let flat = generate::isotropic_square(1, 1.0).unwrap();
    let mut x = flat.positions().to_vec();
    for (i, x) in x.iter_mut().enumerate().skip(3) {
        *x += crumple * (1.7 * i as f64).sin();
    }
    let sheet = Sheet::new(x.clone(), &flat.face_indices()).unwrap();
    let model = SheetModel::new(&sheet, 0.2, MassKind::Lumped).unwrap();
    (model.with_pins(&[VertexId(0)]).unwrap(), x)
}

/// What the solver makes of a step `-dx`.
struct Outcome {
    dx: Vec<f64>,
    multipliers: Vec<f64>,
    violation: f64,
}

/// The step for a force and for values of the equations, with rods so many times as stiff as the masses.
fn solve(
    model: &SheetModel,
    x: &[f64],
    (force, values): (&[f64], &[f64]),
    stiffness: f64,
    max_iterations: usize,
) -> Outcome {
    let unit_penalty = penalties(model, 1.0);
    let axial: Vec<f64> = unit_penalty.iter().map(|u| stiffness * u).collect();
    let edges = model.rods().len();
    let mut matrix = PrimalMatrix::new(model).unwrap();
    matrix.assemble(model, x, &axial, &vec![0.0; edges]);
    matrix.factorize().unwrap();
    let rods = model.rods();
    let weighted: Vec<f64> = axial.iter().zip(values).map(|(r, c)| r * c).collect();
    let mut right = force.to_vec();
    rods.apply_transpose_add(x, &weighted, &mut right);
    model.clear_pinned(&mut right);
    let mut dx = vec![0.0; x.len()];
    matrix.solve(model, &right, &mut dx);
    let mut system = ConstrainedSystem {
        model,
        matrix: &mut matrix,
        supports: SupportRows::None,
    };
    let goal = MultiplierGoal {
        max_iterations,
        violation: 1e-14,
        change: 0.0,
        longest: f64::INFINITY,
    };
    let mut solver = ConstrainedSolver::new(model);
    solver.residual.rods.copy_from_slice(values);
    solver.subtract(&system, &dx);
    let violation = solver.improve(&mut system, &mut dx, goal);
    Outcome {
        dx,
        multipliers: solver.multipliers.rods,
        violation,
    }
}

/// Largest entries of `M dx - G^T L - f` and of `G dx - c`, relative to the entries of `f` and `c`: both
/// vanish for the solution of the saddle-point system and for nothing else.
fn residuals(
    model: &SheetModel,
    x: &[f64],
    (force, values): (&[f64], &[f64]),
    outcome: &Outcome,
) -> [f64; 2] {
    let rods = model.rods();
    let mut balance = vec![0.0; x.len()];
    model.apply_mass(&outcome.dx, &mut balance);
    let down: Vec<f64> = outcome.multipliers.iter().map(|l| -l).collect();
    rods.apply_transpose_add(x, &down, &mut balance);
    model.clear_pinned(&mut balance);
    let mut change = vec![0.0; rods.len()];
    rods.apply(x, &outcome.dx, &mut change);
    [apart(&balance, force), apart(&change, values)]
}

/// A force on each coordinate, and values of the equations that a displacement has (dependent equations have
/// no solution otherwise).
fn load(model: &SheetModel, x: &[f64]) -> (Vec<f64>, Vec<f64>) {
    let wave = |k: f64| (0..x.len()).map(move |i| (k * i as f64).cos()).collect();
    let (mut force, mut displacement): (Vec<f64>, Vec<f64>) = (wave(2.3), wave(0.7));
    model.clear_pinned(&mut force);
    model.clear_pinned(&mut displacement);
    let rods = model.rods();
    let mut values = vec![0.0; rods.len()];
    rods.apply(x, &displacement, &mut values);
    (force, values)
}

fn apart(a: &[f64], b: &[f64]) -> f64 {
    let size = b.iter().fold(0.0_f64, |m, b| m.max(b.abs()));
    let differences = a.iter().zip(b).map(|(a, b)| (a - b).abs());
    differences.fold(0.0, f64::max) / size
}

#[test]
fn steps_and_multipliers_solve_the_saddle_point_system() {
    // Rods that are hardly stiffer than the masses, so that nearly all is left to the iterations.
    let (model, x) = model(0.05);
    let (force, values) = load(&model, &x);
    let load = (&force[..], &values[..]);
    let first = solve(&model, &x, load, 10.0, 0);
    let [balance, rates] = residuals(&model, &x, load, &first);
    assert!(balance < 1e-13, "out of balance by {balance}");
    assert!(rates > 1e-3 && first.violation > 1e-3, "{rates}");
    let last = solve(&model, &x, load, 10.0, 100);
    let errors = residuals(&model, &x, load, &last);
    assert!(errors.iter().all(|e| *e < 1e-12), "{errors:?}");
}

#[test]
fn dependent_equations_have_a_step_too() {
    // In a flat sheet one equation for each interior vertex depends on the others.
    let (model, x) = model(0.0);
    let (force, values) = load(&model, &x);
    let load = (&force[..], &values[..]);
    let last = solve(&model, &x, load, 10.0, 100);
    let errors = residuals(&model, &x, load, &last);
    assert!(errors.iter().all(|e| *e < 1e-12), "{errors:?}");
}

#[test]
fn nearly_dependent_equations_take_as_many_iterations_as_there_are_of_them() {
    // Nine interior vertices: the dual matrix has nine small eigenvalues, of the order of the square of the
    // fold angles.
    let (model, x) = model(1e-5);
    let (force, values) = load(&model, &x);
    let violation = |iterations| solve(&model, &x, (&force, &values), 1e8, iterations).violation;
    let [first, after_four, after_twelve] = [0, 4, 12].map(violation);
    assert!(first > 1e-3, "{first} before the first iteration");
    assert!(
        after_four > 1e-3 * first,
        "{after_four} after four iterations"
    );
    assert!(
        after_twelve < 1e-6 * first,
        "{after_twelve} after twelve iterations"
    );
}

#[test]
fn supports_are_equations_like_rods() {
    use isosheet_model::constraint::{Plane, Side, VertexConstraint};
    let (model, x) = model(0.05);
    let corner = VertexId(24);
    let at = [x[72], x[73], x[74]];
    let plane = Plane::new(at, [0.6, 0.0, 0.8]).unwrap();
    let model = model
        .with_constraint(VertexConstraint::on_surface(corner, plane, Side::On))
        .unwrap();
    let (force, values) = load(&model, &x);
    // As for rods, values that a displacement has.
    let asked = 0.6 * (0.7 * 72.0_f64).cos() + 0.8 * (0.7 * 74.0_f64).cos();
    let mut rows = VertexRows::new(model.constraints(), model.constrained_vertices(), 10.0);
    rows.evaluate(model.constraints(), 0.0, &x);
    let penalties: Vec<f64> = penalties(&model, 10.0);
    let mut matrix = PrimalMatrix::new(&model).unwrap();
    matrix.assemble(&model, &x, &penalties, &vec![0.0; penalties.len()]);
    rows.add_equalities(1.0, &mut matrix.sink(&model));
    matrix.factorize().unwrap();
    let rods = model.rods();
    let weighted: Vec<f64> = penalties.iter().zip(&values).map(|(r, c)| r * c).collect();
    let normal = Vector3::new(0.6, 0.0, 0.8);
    let mut right = force.clone();
    rods.apply_transpose_add(&x, &weighted, &mut right);
    let weight = rows.equality_penalty(0).unwrap() * asked;
    add(&mut right, corner, &(weight * normal));
    model.clear_pinned(&mut right);
    let mut dx = vec![0.0; x.len()];
    matrix.solve(&model, &right, &mut dx);
    let mut system = ConstrainedSystem {
        model: &model,
        matrix: &mut matrix,
        supports: SupportRows::Equalities {
            rows: &rows,
            penalty: 1.0,
        },
    };
    let mut solver = ConstrainedSolver::new(&model);
    solver.residual.rods.copy_from_slice(&values);
    solver.residual.supports[0].x = asked;
    solver.subtract(&system, &dx);
    let goal = MultiplierGoal {
        max_iterations: 100,
        violation: 1e-14,
        change: 0.0,
        longest: f64::INFINITY,
    };
    solver.improve(&mut system, &mut dx, goal);
    let moved = normal.dot(&point(&dx, corner));
    assert!((moved - asked).abs() < 1e-12, "{moved} {asked}");
    // The support's force is part of the balance.
    let mut loaded = force.clone();
    add(
        &mut loaded,
        corner,
        &(solver.multipliers.supports[0].x * normal),
    );
    let outcome = Outcome {
        dx,
        multipliers: solver.multipliers.rods,
        violation: 0.0,
    };
    let errors = residuals(&model, &x, (&loaded, &values), &outcome);
    assert!(errors.iter().all(|e| *e < 1e-11), "{errors:?}");
}

#[test]
fn a_broken_system_leaves_nothing_behind() {
    let (model, x) = model(0.05);
    let (_, values) = load(&model, &x);
    let penalties = penalties(&model, 10.0);
    let mut matrix = PrimalMatrix::new(&model).unwrap();
    matrix.assemble(&model, &x, &penalties, &vec![0.0; penalties.len()]);
    matrix.factorize().unwrap();
    let mut system = ConstrainedSystem {
        model: &model,
        matrix: &mut matrix,
        supports: SupportRows::None,
    };
    let pass = |solver: &mut ConstrainedSolver, system: &mut ConstrainedSystem<'_>| {
        let mut y = vec![0.0; x.len()];
        solver.residual.rods.copy_from_slice(&values);
        solver.pass(system, &mut y);
        y
    };
    let mut solver = ConstrainedSolver::new(&model);
    let first = pass(&mut solver, &mut system);
    solver.residual.rods.fill(f64::NAN);
    solver.pass(&mut system, &mut vec![0.0; x.len()]);
    assert_eq!(pass(&mut solver, &mut system), first);
}
