use super::*;
use crate::primal::PrimalMatrix;
use crate::{
    ImplicitOptions, Method, PlateBending, SheetModel, Simulation, SimulationError, State,
};
use isosheet_mesh::{MassKind, generate};
use nalgebra::Matrix2;
use rand::{RngExt, SeedableRng};
use rand_chacha::ChaCha8Rng;

fn crumpled() -> (Sheet, Vec<f64>) {
    let outline = [[0.0, 0.0], [1.0, 0.0], [1.0, 1.0], [0.0, 1.0]];
    let sheet = generate::delaunay(&outline, 0.3, 2).unwrap();
    let mut rng = ChaCha8Rng::seed_from_u64(5);
    let x = sheet.positions().iter();
    let x = x.map(|p| p + rng.random_range(-0.05..0.05)).collect();
    (sheet, x)
}

/// A homogeneous deformation `F` of the plane: `V = A K / 2 [(1 - nu) |E|^2 + nu (tr E)^2]`, `E = (F^T F - 1)
/// / 2`.
#[test]
fn homogeneous_deformations_have_the_energy_of_the_material() {
    let (sheet, _) = crumpled();
    let (stiffness, nu) = (700.0, 0.3);
    let membrane = Membrane::new(&sheet, stiffness, nu).unwrap();
    let f = Matrix2::new(1.1, 0.2, -0.05, 0.93);
    let turn = nalgebra::Rotation3::from_euler_angles(0.3, 1.2, -0.7);
    let mut x = Vec::new();
    for p in sheet.positions().as_chunks::<3>().0 {
        let q = f * Vector2::new(p[0], p[1]);
        x.extend((turn * Vector3::new(q.x, q.y, 0.4)).iter());
    }
    let e = 0.5 * (f.transpose() * f - Matrix2::identity());
    let k = stiffness / (1.0 - nu * nu);
    let exact = 0.5 * k * ((1.0 - nu) * e.norm_squared() + nu * e.trace().powi(2));
    let energy = membrane.energy(0.0, &x);
    assert!((energy / exact - 1.0).abs() < 1e-12, "{energy} {exact}");
    assert!(membrane.energy(0.0, sheet.positions()) < 1e-25);
}

#[test]
fn gradient_and_hessian_are_derivatives_of_the_energy() {
    let (sheet, x) = crumpled();
    let membrane = Membrane::new(&sheet, 3.0, 0.25).unwrap();
    let gradient = |x: &[f64]| {
        let mut g = vec![0.0; x.len()];
        membrane.add_gradient(0.0, x, &mut g);
        g
    };
    let g = gradient(&x);
    let largest = g.iter().fold(0.0_f64, |m, g| m.max(g.abs()));
    let d = 1e-5;
    for i in 0..x.len() {
        let at = |s: f64| {
            let mut y = x.clone();
            y[i] += s;
            membrane.energy(0.0, &y)
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
    let model = SheetModel::new(&sheet, 1.0, MassKind::Lumped)
        .unwrap()
        .with_membrane(Membrane::new(&sheet, 3.0, 0.25).unwrap());
    let none = vec![0.0; model.rods().len()];
    let mut matrix = PrimalMatrix::new(&model).unwrap();
    let mut products = Vec::new();
    for semidefinite in [false, true] {
        matrix.assemble(&model, &x, &none, &none);
        if semidefinite {
            matrix.add_semidefinite_potentials(&model, 0.0, &x, 1.0);
        } else {
            matrix.add_potentials(&model, 0.0, &x, 1.0);
        }
        products.push(matrix.product(&model, &along));
    }
    let steepest = products[0].iter().fold(0.0_f64, |m, p| m.max(p.abs()));
    for i in 0..x.len() {
        let inertia = model.mass().vertex[i / 3] * along[i];
        let exact = (plus[i] - minus[i]) / (2.0 * d);
        let difference = products[0][i] - inertia - exact;
        assert!(difference.abs() < 1e-8 * steepest, "{i}: {difference}");
    }
    // What is left out of the semidefinite part is curvature of edges under pressure.
    let left: f64 = (0..x.len())
        .map(|i| along[i] * (products[1][i] - products[0][i]))
        .sum();
    assert!(left > 0.0, "{left}");
}

/// A strip that hangs by one end: its weight stretches it by `rho g L / (2 E h)` to first order, an eighth of
/// the stretch at an eighth of the compliance.
#[test]
fn strains_are_of_first_order_in_the_compliance() {
    let sheet = generate::grid(2, 8, 0.1, 0.8, generate::Diagonals::UnionJack).unwrap();
    let x = sheet.positions();
    let pins: Vec<_> = (0..sheet.topology().vertex_count())
        .filter(|v| x[3 * v + 1] > 0.8 - 1e-9)
        .map(|v| VertexId(u32::try_from(v).unwrap()))
        .collect();
    let (mass, g) = (0.02, 9.8);
    let stretch = |stiffness: f64| {
        let model = SheetModel::new(&sheet, mass, MassKind::Lumped)
            .unwrap()
            .with_acceleration([0.0, -g, 0.0])
            .with_damping(20.0)
            .unwrap()
            .with_pins(&pins)
            .unwrap()
            .with_membrane(Membrane::new(&sheet, stiffness, 0.0).unwrap());
        let method = Method::ImplicitEuler(ImplicitOptions::default());
        let start = State::at_rest(x.to_vec());
        let mut run = Simulation::new(model, start, method).unwrap();
        for _ in 0..60 {
            let report = run.step(0.05).unwrap();
            assert!(report.kinetic.is_finite());
        }
        let low = run.state().x.as_chunks::<3>().0.iter().map(|p| p[1]);
        -low.fold(f64::INFINITY, f64::min)
    };
    // Force `m g (y / L) / b` per width at the height y, strain by `E h`, and the integral over the length.
    let expected = |stiffness: f64| mass * g / 0.1 * 0.8 / (2.0 * stiffness);
    let errors = [800.0, 6400.0].map(|k| (stretch(k) / expected(k) - 1.0).abs());
    assert!(errors[0] < 2e-2 && errors[1] < 1.2e-2, "{errors:?}");
}

/// A sheet clamped along a line that is no line of the mesh: rods lock, a membrane does not.
#[test]
fn a_clamped_elastic_sheet_hangs() {
    let outline = [[0.0, 0.0], [1.0, 0.0], [1.0, 1.0], [0.0, 1.0]];
    let sheet = generate::delaunay(&outline, 0.2, 3).unwrap();
    let x = sheet.positions();
    let pins: Vec<_> = (0..sheet.topology().vertex_count())
        .filter(|v| x[3 * v] + 0.4 * x[3 * v + 1] < 0.4)
        .map(|v| VertexId(u32::try_from(v).unwrap()))
        .collect();
    for method in [
        Method::default(),
        Method::ImplicitEuler(ImplicitOptions::default()),
    ] {
        let model = SheetModel::new(&sheet, 0.1, MassKind::Lumped)
            .unwrap()
            .with_gravity()
            .with_damping(2.0)
            .unwrap()
            .with_pins(&pins)
            .unwrap()
            .with_potential(PlateBending::clamped(&sheet, 5e-3, &pins).unwrap())
            .with_membrane(Membrane::new(&sheet, 100.0, 0.3).unwrap());
        let start = State::at_rest(x.to_vec());
        let mut run = Simulation::new(model, start, method).unwrap();
        let mut factorisations = 0;
        for _ in 0..60 {
            factorisations += run.step(1.0 / 60.0).unwrap().factorisations;
        }
        let z = run.state().x.as_chunks::<3>().0.iter().map(|p| p[2]);
        let lowest = z.fold(f64::INFINITY, f64::min);
        assert!(lowest < -0.3, "{lowest}");
        assert!(factorisations < 60 * 20, "{factorisations}");
    }
}

#[test]
fn what_needs_rods_is_refused() {
    let sheet = generate::isotropic_square(1, 1.0).unwrap();
    for bad in [0.0, -1.0, f64::NAN, f64::INFINITY] {
        assert!(matches!(
            Membrane::new(&sheet, bad, 0.0),
            Err(MembraneError::Stiffness { .. })
        ));
    }
    for bad in [-0.1, 0.6, f64::NAN] {
        assert!(matches!(
            Membrane::new(&sheet, 1.0, bad),
            Err(MembraneError::Poisson { .. })
        ));
    }
    for method in [
        Method::Projection(Default::default()),
        Method::EnergyMomentum(Default::default()),
        Method::Rattle(Default::default()),
    ] {
        let model = SheetModel::new(&sheet, 0.1, MassKind::Lumped)
            .unwrap()
            .with_membrane(Membrane::new(&sheet, 1e3, 0.3).unwrap());
        let start = State::at_rest(sheet.positions().to_vec());
        let refused = Simulation::new(model, start, method).err();
        assert_eq!(refused, Some(SimulationError::Elastic));
    }
}
