use super::*;
use crate::hessian::HessianPart;
use crate::testing::{hessian, product};
use isosheet_mesh::generate;
use nalgebra::{DMatrix, DVector, Matrix2, Vector2, Vector3};
use proptest::prelude::*;
use rand::{RngExt, SeedableRng};
use rand_chacha::ChaCha8Rng;

const SQUARE: [[f64; 2]; 4] = [[0.0, 0.0], [1.0, 0.0], [1.0, 1.0], [0.0, 1.0]];

fn delaunay(size: f64) -> Sheet {
    generate::delaunay(&SQUARE, size, 2).unwrap()
}

/// Positions each of which is displaced by up to `size`.
fn displaced(sheet: &Sheet, size: f64, seed: u64) -> Vec<f64> {
    let mut rng = ChaCha8Rng::seed_from_u64(seed);
    let x = sheet.positions().iter();
    x.map(|p| p + rng.random_range(-size..size)).collect()
}

/// The positions of a plane sheet that is deformed by `f` and turned.
fn deformed(sheet: &Sheet, f: Matrix2<f64>) -> Vec<f64> {
    let turn = nalgebra::Rotation3::from_euler_angles(0.3, 1.2, -0.7);
    let mut x = Vec::new();
    for p in sheet.positions().as_chunks::<3>().0 {
        let q = f * Vector2::new(p[0], p[1]);
        x.extend((turn * Vector3::new(q.x, q.y, 0.4)).iter());
    }
    x
}

/// `V = A { K / 2 [(1 - nu) |E|^2 + nu (tr E)^2] + kappa b }`, `E = (F^T F - 1) / 2`, below half the limit
/// and above.
#[test]
fn homogeneous_deformations_have_the_energy_of_the_material() {
    let sheet = delaunay(0.3);
    let (stiffness, nu, kappa) = (700.0, 0.3, 5.0);
    let f = Matrix2::new(1.1, 0.2, -0.05, 0.93);
    let x = deformed(&sheet, f);
    let e = 0.5 * (f.transpose() * f - Matrix2::identity());
    let k = stiffness / (1.0 - nu * nu);
    let elastic = 0.5 * k * ((1.0 - nu) * e.norm_squared() + nu * e.trace().powi(2));
    for (limit, factor) in [(0.45, 0.0), (0.2, 1.0)] {
        let mut sheet_of_limit = ElasticSheet::new(&sheet, stiffness, nu).unwrap();
        sheet_of_limit = sheet_of_limit.with_limit(limit).unwrap();
        let p = (4.0 * e.norm_squared() / (limit * limit) - 1.0) / 3.0;
        assert_eq!(p > 0.0, factor > 0.0, "{p}");
        let exact = elastic - factor * kappa * p * p * (1.0 - p).ln();
        let energy = sheet_of_limit.energy(At::new(0.0, &x).with_memory(&[kappa]));
        assert!((energy / exact - 1.0).abs() < 1e-12, "{energy} {exact}");
        let rest = At::new(0.0, sheet.positions());
        assert!(sheet_of_limit.energy(rest.with_memory(&[kappa])) < 1e-25);
        for strain in sheet_of_limit.strains(At::new(0.0, &x)) {
            assert!((strain - e.norm()).abs() < 1e-13);
        }
    }
}

#[test]
fn gradient_and_hessian_are_derivatives_of_the_energy() {
    let sheet = delaunay(0.3);
    let x = displaced(&sheet, 0.01, 5);
    let elastic = || {
        let new = ElasticSheet::new(&sheet, 3.0, 0.25).unwrap();
        new.with_limit(0.1).unwrap()
    };
    let barrier = [0.02];
    let loaded = elastic()
        .strains(At::new(0.0, &x))
        .filter(|s| *s > 0.05)
        .count();
    assert!(
        loaded > 5 && elastic().beyond_limit(At::new(0.0, &x)).is_none(),
        "{loaded}"
    );
    let gradient = |x: &[f64]| {
        let mut g = vec![0.0; x.len()];
        elastic().add_gradient(At::new(0.0, x).with_memory(&barrier), &mut g);
        g
    };
    let g = gradient(&x);
    let largest = g.iter().fold(0.0_f64, |m, g| m.max(g.abs()));
    // (Third derivatives jump where the barrier begins.)
    let d = 1e-7;
    for i in 0..x.len() {
        let at = |s: f64| {
            let mut y = x.clone();
            y[i] += s;
            elastic().energy(At::new(0.0, &y).with_memory(&barrier))
        };
        let slope = (at(d) - at(-d)) / (2.0 * d);
        assert!(
            (slope - g[i]).abs() < 1e-7 * largest,
            "{i}: {slope} {}",
            g[i]
        );
    }
    let along: Vec<f64> = (0..x.len()).map(|i| (1.3 * i as f64).sin()).collect();
    let moved = |s: f64| -> Vec<f64> { x.iter().zip(&along).map(|(x, a)| x + s * a).collect() };
    let (plus, minus) = (gradient(&moved(d)), gradient(&moved(-d)));
    let parts = [HessianPart::Full, HessianPart::PositiveSemidefinite];
    let at = At::new(0.0, &x).with_memory(&barrier);
    let products = parts.map(|part| product(sheet.topology(), &elastic(), (at, part), &along));
    let steepest = products[0].iter().fold(0.0_f64, |m, p| m.max(p.abs()));
    for i in 0..x.len() {
        let exact = (plus[i] - minus[i]) / (2.0 * d);
        let difference = products[0][i] - exact;
        assert!(difference.abs() < 1e-6 * steepest, "{i}: {difference}");
    }
    // What is left out of the semidefinite part is curvature of edges under pressure.
    let left: f64 = (0..x.len())
        .map(|i| along[i] * (products[1][i] - products[0][i]))
        .sum();
    assert!(left > 0.0, "{left}");
}

/// Along a straight displacement that turns a sheet the strain grows with the square of its length, along the
/// curved one of a step with the fourth power.
#[test]
fn a_displacement_that_turns_is_curved_so_that_it_does_not_stretch() {
    let sheet = delaunay(0.3);
    let x = sheet.positions();
    let elastic = ElasticSheet::new(&sheet, 3.0, 0.25).unwrap();
    let dx: Vec<f64> = (x.as_chunks::<3>().0.iter())
        .flat_map(|p| [0.0, 0.0, p[0]])
        .collect();
    // Rigid motions cost next to nothing.
    let rigid = DMatrix::from_diagonal_element(x.len(), x.len(), 1e-9);
    let matrix = hessian(sheet.topology(), &elastic, At::new(0.0, x)) + rigid;
    let mut force = vec![0.0; x.len()];
    elastic.add_second_order(At::new(0.0, x), &dx, 1.0, &mut force);
    let curved = matrix.cholesky().unwrap().solve(&DVector::from(force));
    let energy = |s: f64, square: f64| {
        let end = (0..x.len()).map(|i| x[i] - s * (dx[i] + s * square * curved[i]));
        elastic.energy(At::new(0.0, &end.collect::<Vec<f64>>()))
    };
    // Energies grow with the square of the strain.
    let [straight, bent] =
        [0.0, 1.0].map(|square| (energy(0.1, square) / energy(0.05, square)).log2());
    assert!((straight - 4.0).abs() < 0.01, "{straight}");
    assert!((bent - 8.0).abs() < 0.01, "{bent}");
    assert!(energy(0.1, 1.0) < 0.01 * energy(0.1, 0.0));
}

/// The faces where the barrier begins have continuous second derivatives, and those at the limit no finite
/// energy.
#[test]
fn the_barrier_begins_at_half_the_limit_and_ends_at_it() {
    let sheet = generate::isotropic_square(0, 1.0).unwrap();
    let elastic = ElasticSheet::new(&sheet, 1e-9, 0.0).unwrap();
    let elastic = elastic.with_limit(0.01).unwrap();
    let energy = |stretch: f64| {
        // `|E| = e` for a stretch in one direction.
        let f = Matrix2::new((1.0 + 2.0 * stretch).sqrt(), 0.0, 0.0, 1.0);
        elastic.energy(At::new(0.0, &deformed(&sheet, f)).with_memory(&[1.0]))
    };
    assert!(energy(0.4999e-2) < 1e-12 && energy(0.501e-2) > 1e-12);
    // To third order: with `p` = 8 d / 3 the energy is `p^3`.
    let ratio = energy(0.502e-2) / energy(0.501e-2);
    assert!((ratio - 8.0).abs() < 0.1, "{ratio}");
    assert!(energy(0.999e-2).is_finite());
    assert_eq!(energy(1.001e-2), f64::INFINITY);
}

proptest! {
    #![proptest_config(isosheet_random::cases(256))]

    /// Along the part of a displacement that is called safe no strain comes near the limit, and the part is
    /// as large as it can be to a few per cent.
    #[test]
    fn displacements_stay_within_the_limit(
        seed in 0..1000u64, strained in 0.0..0.002_f64, size in -4.0..1.0_f64,
    ) {
        let sheet = generate::isotropic_square(1, 1.0).unwrap();
        let elastic = ElasticSheet::new(&sheet, 1.0, 0.3).unwrap();
        let elastic = elastic.with_limit(0.01).unwrap();
        let x = displaced(&sheet, strained.max(1e-9), seed);
        prop_assume!(elastic.beyond_limit(At::new(0.0, &x)).is_none());
        let scale = 10f64.powf(size);
        let dx: Vec<f64> = displaced(&sheet, scale, seed + 1).iter().zip(sheet.positions()).map(|(a, b)| a - b).collect();
        let part = elastic.safe_part(At::new(0.0, &x), &dx);
        prop_assert!(part > 0.0 && part <= 1.0);
        let at = |s: f64| -> Vec<f64> { x.iter().zip(&dx).map(|(x, d)| x + s * d).collect() };
        let left = |s: f64| {
            let y = at(s);
            let before = elastic.strains(At::new(0.0, &x)).collect::<Vec<_>>();
            let left = elastic.strains(At::new(0.0, &y)).zip(before).map(|(now, was)| (0.01 - now) / (0.01 - was));
            left.fold(f64::INFINITY, f64::min)
        };
        for k in 0..=20 {
            prop_assert!(left(part * f64::from(k) / 20.0) >= 0.1 - 1e-9);
        }
        if part < 1.0 {
            prop_assert!(left(1.05 * part) < 0.15, "{}", left(1.05 * part));
        }
    }
}

#[test]
fn what_makes_no_sense_is_refused() {
    let sheet = generate::isotropic_square(1, 1.0).unwrap();
    for bad in [0.0, -1.0, f64::NAN, f64::INFINITY] {
        let refused = ElasticSheet::new(&sheet, bad, 0.0).unwrap_err();
        assert!(matches!(refused, ElasticSheetError::Stiffness { .. }));
    }
    for bad in [-0.1, 0.6, f64::NAN] {
        let refused = ElasticSheet::new(&sheet, 1.0, bad).unwrap_err();
        assert!(matches!(refused, ElasticSheetError::Poisson { .. }));
    }
    let good = || ElasticSheet::new(&sheet, 1e3, 0.3).unwrap();
    for bad in [0.0, 0.5, -0.1, f64::NAN] {
        let refused = good().with_limit(bad).unwrap_err();
        assert!(matches!(refused, ElasticSheetError::Limit { .. }));
    }
}
