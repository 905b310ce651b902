use super::testing::{add_potentials, add_potentials_with};
use super::*;
use crate::linear::free::penalties;
use crate::{CreaseSprings, ElasticSheet, PlateBending};
use isosheet_linalg::norm_inf;
use isosheet_materials::hessian::HessianPart;
use isosheet_materials::vectors::dot;
use isosheet_mesh::{MassKind, Sheet, generate};
use rand::{RngExt, SeedableRng};
use rand_chacha::ChaCha8Rng;

/// The square of the factor of forces in a step of BDF2 at 1/60 s.
const SCALE: f64 = 1.2e-4;

/// A crumpled square of office paper that hangs by a corner, with one edge long.
fn paper(level: u32, bending: impl Fn(&Sheet, SheetModel) -> SheetModel) -> (SheetModel, Vec<f64>) {
    let flat = generate::isotropic_square(level, 1.0).unwrap();
    let mut rng = ChaCha8Rng::seed_from_u64(7);
    let size = 0.1 / f64::from(1 << level);
    let x: Vec<f64> = flat
        .positions()
        .iter()
        .map(|x| x + rng.random_range(-size..size))
        .collect();
    let sheet = Sheet::new(x.clone(), &flat.face_indices()).unwrap();
    let model = SheetModel::new(&sheet, 0.1, MassKind::Lumped)
        .unwrap()
        .with_pins(&[VertexId(0), VertexId(9)])
        .unwrap();
    (bending(&sheet, model), x)
}

fn plate(rigidity: f64) -> impl Fn(&Sheet, SheetModel) -> SheetModel {
    move |sheet, model| model.with_potential(PlateBending::new(sheet, rigidity).unwrap())
}

fn hinges(sheet: &Sheet, model: SheetModel) -> SheetModel {
    model.with_potential(CreaseSprings::bending(sheet, 5e-4).unwrap())
}

fn membrane_and_all(sheet: &Sheet, model: SheetModel) -> SheetModel {
    let model = model
        .with_elastic_sheet(ElasticSheet::new(sheet, 3e5, 0.3).unwrap())
        .unwrap();
    hinges(sheet, plate(5e-4)(sheet, model))
}

/// The matrix with rods `stiffness` times as stiff as the masses and densities `density`.
fn assembled(model: &SheetModel, x: &[f64], (stiffness, density): (f64, f64)) -> PrimalMatrix {
    let mut matrix = PrimalMatrix::new(model).unwrap();
    let axial = penalties(model, stiffness);
    matrix.assemble(model, x, &axial, &vec![density; model.rods().len()]);
    let (at, part) = (
        (0.0, x, &model.memories()),
        HessianPart::PositiveSemidefinite,
    );
    add_potentials_with(&mut matrix, model, at, part, SCALE);
    matrix
}

fn wave(model: &SheetModel, k: f64) -> Vec<f64> {
    let mut wave: Vec<f64> = (0..model.coordinate_count())
        .map(|i| (k * i as f64).cos())
        .collect();
    model.clear_pinned(&mut wave);
    wave
}

/// The matrix with substitutes is never less than the whole one, and as stiff against translations of what
/// bending couples.
#[test]
fn substitutes_are_never_less_than_what_they_replace() {
    for (model, x) in [
        paper(2, plate(5e-4)),
        paper(2, hinges),
        paper(2, membrane_and_all),
    ] {
        let matrix = assembled(&model, &x, (0.0, 0.0));
        assert!(!matrix.far.are_zero());
        let order = 3 * model.free_count();
        let difference = |v: &[f64]| {
            let mut image = vec![0.0; order];
            matrix.far.add_difference(v, &mut image);
            dot(v, &image)
        };
        for k in 1..200 {
            let v: Vec<f64> = (0..order)
                .map(|i| (0.37 * f64::from(k) * i as f64).cos())
                .collect();
            let size = matrix.far.substitute_norm();
            assert!(difference(&v) <= 1e-12 * size, "{k}: {}", difference(&v));
        }
    }
    // A plate with no pins: far couplings push, so that translations do not feel the substitutes.
    let (model, x) = paper(2, hinges);
    let matrix = assembled(&model, &x, (0.0, 0.0));
    let mut blocks = 0;
    matrix.far.for_each(|_, block| {
        blocks += usize::from(block.norm() > 0.0);
    });
    assert!(blocks > 100, "{blocks}");
}

/// Whichever way a sheet is solved with, the direction is that of the whole matrix to the accuracy asked for,
/// in the norm of the matrix.
#[test]
fn directions_are_those_of_the_whole_matrix() {
    for (model, x) in [
        paper(3, plate(5e-4)),
        paper(3, hinges),
        paper(3, membrane_and_all),
    ] {
        for stiffness in [1.0, 1e6] {
            let b = wave(&model, 1.3);
            let mut effort = SolverEffort::default();
            let mut matrix = assembled(&model, &x, (stiffness, 0.0));
            matrix.factorize().unwrap();
            assert_eq!(matrix.factorised, Factorised::Substituted);
            let mut direction = vec![0.0; b.len()];
            matrix
                .solve_whole(&model, &b, &mut direction, &mut effort)
                .unwrap();
            let mut first = vec![0.0; b.len()];
            matrix.solve(&model, &b, &mut first);

            let mut whole = assembled(&model, &x, (stiffness, 0.0));
            whole.leave_iteration();
            whole.factorize().unwrap();
            assert_eq!(whole.factorised, Factorised::Whole);
            let mut exact = vec![0.0; b.len()];
            whole
                .solve_whole(&model, &b, &mut exact, &mut effort)
                .unwrap();
            let residual = whole.product(&model, &exact);
            let worst = residual.iter().zip(&b).map(|(r, b)| (r - b).abs());
            assert!(worst.fold(0.0, f64::max) < 1e-6);

            let mut error = |d: &[f64]| {
                let e: Vec<f64> = d.iter().zip(&exact).map(|(a, b)| a - b).collect();
                dot(&e, &whole.product(&model, &e)).sqrt()
            };
            let (left, before) = (error(&direction), error(&first));
            assert!(left < GRADIENT_ACCURACY * before, "{left} of {before}");
            // The same product by either way.
            let [a, b] = [
                matrix.product(&model, &first),
                whole.product(&model, &first),
            ];
            let size = norm_inf(&a);
            let apart = a
                .iter()
                .zip(&b)
                .map(|(a, b)| (a - b).abs())
                .fold(0.0, f64::max);
            assert!(apart < 1e-10 * size, "{apart} of {size}");
            assert_eq!(effort.factorisations, 0);
        }
    }
}

/// Small and stiff sheets are factorised whole.
#[test]
fn the_way_follows_from_size_and_stiffness() {
    for (level, rigidity, expected) in [
        (3, 5e-4, Factorised::Substituted),
        (3, 5e4, Factorised::Whole),
        (1, 5.0, Factorised::Whole),
    ] {
        let (model, x) = paper(level, plate(rigidity));
        let mut matrix = assembled(&model, &x, (1e4, 0.0));
        matrix.factorize().unwrap();
        assert_eq!(matrix.factorised, expected, "{level} {rigidity}");
    }
}

/// Where the iteration takes longer than a factorisation of the whole matrix, that takes its place until the
/// next step.
#[test]
fn slow_iterations_end_with_the_whole_matrix() {
    let (model, x) = paper(3, plate(5e3));
    let b = wave(&model, 0.01);
    let mut matrix = assembled(&model, &x, (1e2, 0.0));
    // As if the sheet were heavy.
    matrix.masses = 1e12;
    matrix.factorize().unwrap();
    assert_eq!(matrix.factorised, Factorised::Substituted);
    let mut effort = SolverEffort::default();
    let mut solution = vec![0.0; b.len()];
    matrix
        .solve_whole(&model, &b, &mut solution, &mut effort)
        .unwrap();
    assert_eq!(matrix.factorised, Factorised::Whole);
    assert_eq!(effort.factorisations, 1);
    let mut direct = assembled(&model, &x, (1e2, 0.0));
    direct.factorize().unwrap();
    assert_eq!(direct.factorised, Factorised::Whole);
    let mut expected = vec![0.0; b.len()];
    direct.solve(&model, &b, &mut expected);
    let size = norm_inf(&expected);
    for (a, b) in solution.iter().zip(&expected) {
        assert!((a - b).abs() < 1e-9 * size, "{a} {b}");
    }
    let axial = penalties(&model, 1e2);
    let again = |matrix: &mut PrimalMatrix| {
        matrix.assemble(&model, &x, &axial, &vec![0.0; model.rods().len()]);
        add_potentials(matrix, &model, 0.0, &x, SCALE);
        matrix.factorize().unwrap();
        matrix.factorised
    };
    assert_eq!(again(&mut matrix), Factorised::Whole);
    matrix.begin();
    assert_eq!(again(&mut matrix), Factorised::Substituted);
}

/// A matrix that is not positive definite is found by the iteration where substitutes hide it from the
/// factorisation.
#[test]
fn indefinite_matrices_are_found() {
    let (model, x) = paper(3, plate(1e-2));
    let b = wave(&model, 0.7);
    let mut found = 0;
    for k in 0..60 {
        let pressure = -1e-6 * 1.2_f64.powi(k);
        let mut whole = assembled(&model, &x, (0.0, pressure));
        whole.leave_iteration();
        let is_definite = whole.factorize().is_ok();
        let mut matrix = assembled(&model, &x, (0.0, pressure));
        let factorised = matrix.factorize();
        if is_definite {
            factorised.unwrap();
            continue;
        }
        if factorised.is_err() {
            break;
        }
        let mut effort = SolverEffort::default();
        let mut solution = vec![0.0; b.len()];
        let solved = matrix.solve_whole(&model, &b, &mut solution, &mut effort);
        found += usize::from(matches!(
            solved,
            Err(LinalgError::NotPositiveDefinite { .. })
        ));
    }
    assert!(found > 0);
}

/// Terms of rank one enter solutions exactly, whichever way a sheet is solved with.
#[test]
fn terms_of_rank_one_are_solved_for_exactly() {
    let (model, x) = paper(3, plate(5e-4));
    let all = |k: f64| {
        let wave = wave(&model, k);
        let vertices = model.topology().vertex_ids();
        let all = vertices.map(|v| (v, isosheet_materials::vectors::point(&wave, v)));
        all.collect::<Vec<_>>()
    };
    let b = wave(&model, 1.3);
    for is_whole in [false, true] {
        let mut matrix = assembled(&model, &x, (1.0, 0.0));
        for k in [0.1, 0.7] {
            matrix.scaled_sink(&model, 0.5).add_square(40.0, &all(k));
        }
        if is_whole {
            matrix.leave_iteration();
        }
        matrix.factorize().unwrap();
        assert_eq!(matrix.is_iterative(), !is_whole);
        let mut found = vec![0.0; b.len()];
        matrix.solve(&model, &b, &mut found);
        let mut image = matrix.product(&model, &found);
        if !is_whole {
            // What is factorised has the substitutes of far couplings in their place.
            let [mut free, mut difference] = [(); 2].map(|()| vec![0.0; 3 * model.free_count()]);
            gather(&model, &found, &mut free);
            matrix.far.add_difference(&free, &mut difference);
            let mut full = vec![0.0; b.len()];
            scatter(&model, &difference, &mut full);
            image.iter_mut().zip(&full).for_each(|(i, f)| *i -= f);
        }
        let worst = image.iter().zip(&b).map(|(r, b)| (r - b).abs());
        assert!(worst.fold(0.0, f64::max) < 1e-9, "{is_whole}");
    }
}
