use super::*;
use crate::hessian::HessianPart;
use crate::linear::primal::PrimalMatrix;
use crate::linear::primal::testing::{add_potentials, add_potentials_with};
use crate::potential::Memories;
use crate::{
    CreaseSprings, ImplicitOptions, Method, PlateBending, SheetModel, Simulation, SimulationError,
    State, StepError,
};
use isosheet_mesh::{MassKind, VertexId, generate};
use nalgebra::{Matrix2, Vector2, Vector3};
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
    let model = SheetModel::new(&sheet, 1.0, MassKind::Lumped).unwrap();
    let model = model.with_elastic_sheet(elastic()).unwrap();
    let none = vec![0.0; model.rods().len()];
    let mut matrix = PrimalMatrix::new(&model).unwrap();
    let mut products = Vec::new();
    let memories = Memories::of_lists([barrier.to_vec()]);
    for part in [HessianPart::Full, HessianPart::PositiveSemidefinite] {
        matrix.assemble(&model, &x, &none, &none);
        add_potentials_with(&mut matrix, &model, (0.0, &x, &memories), part, 1.0);
        products.push(matrix.product(&model, &along));
    }
    let steepest = products[0].iter().fold(0.0_f64, |m, p| m.max(p.abs()));
    for i in 0..x.len() {
        let inertia = model.mass().vertex[i / 3] * along[i];
        let exact = (plus[i] - minus[i]) / (2.0 * d);
        let difference = products[0][i] - inertia - exact;
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
    let model = SheetModel::new(&sheet, 1e-9, MassKind::Lumped).unwrap();
    let model = model.with_elastic_sheet(elastic.clone()).unwrap();
    let dx: Vec<f64> = (x.as_chunks::<3>().0.iter())
        .flat_map(|p| [0.0, 0.0, p[0]])
        .collect();
    let none = vec![0.0; model.rods().len()];
    let mut matrix = PrimalMatrix::new(&model).unwrap();
    matrix.assemble(&model, x, &none, &none);
    add_potentials(&mut matrix, &model, 0.0, x, 1.0);
    matrix.factorize().unwrap();
    let (mut force, mut curved) = (vec![0.0; x.len()], vec![0.0; x.len()]);
    elastic.add_second_order(At::new(0.0, x), &dx, 1.0, &mut force);
    matrix.solve(&model, &force, &mut curved);
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

/// A sheet rolled onto a cylinder: each face bends by its size over the radius, up to the faces at the free
/// edges.
#[test]
fn faces_bend_by_their_size_over_the_radius() {
    let (rigidity, radius) = (0.3, 2.0);
    let sheet = generate::isotropic_square(3, 1.0).unwrap();
    let plate = PlateBending::new(&sheet, rigidity).unwrap();
    let elastic = ElasticSheet::new(&sheet, 1e3, 0.3).unwrap();
    let model = SheetModel::new(&sheet, 0.1, MassKind::Lumped)
        .unwrap()
        .with_elastic_sheet(elastic.beside(&sheet, &plate))
        .unwrap()
        .with_potential(plate);
    let rolled = |p: &[f64; 3]| {
        let angle = p[0] / radius;
        [radius * angle.sin(), p[1], radius * angle.cos()]
    };
    let x: Vec<f64> = sheet
        .positions()
        .as_chunks::<3>()
        .0
        .iter()
        .flat_map(rolled)
        .collect();
    let memories = model.memories();
    let deformation = model.elastic_deformation(0.0, &x, &memories).unwrap();
    let squared = (1.0_f64 / 16.0).powi(2) * 4.0 / 3.0;
    let (_, sharpest) = deformation.sharpest().unwrap();
    assert!(
        (sharpest / (squared.sqrt() / radius) - 1.0).abs() < 0.02,
        "{sharpest}"
    );
    let total: f64 = deformation.bending.iter().sum();
    let plate = model.potentials().next().unwrap().energy(At::new(0.0, &x));
    assert!((total / plate - 1.0).abs() < 1e-12);
    assert!(
        deformation.total_share() < 0.05,
        "{}",
        deformation.total_share()
    );
    let flat = model
        .elastic_deformation(0.0, sheet.positions(), &memories)
        .unwrap();
    assert!(flat.angle.iter().all(|a| *a < 1e-6) && flat.strain.iter().all(|s| *s < 1e-12));
}

/// A sheet with springs at its edges that is rolled onto a cylinder: the energy of springs is exact on a grid
/// that bends along its lines, and to the error of chords, `(k h)^2 / 24`, each face inside bends by its size
/// over the radius.
#[test]
fn faces_bend_alike_with_springs_at_their_edges() {
    let (rigidity, radius, step) = (0.3, 2.0, 0.125);
    let sheet = generate::grid(8, 8, 1.0, 1.0, generate::Diagonals::UnionJack).unwrap();
    let plate = PlateBending::new(&sheet, rigidity).unwrap();
    let elastic = ElasticSheet::new(&sheet, 1e3, 0.3).unwrap();
    let springs = CreaseSprings::bending(&sheet, rigidity).unwrap();
    let model = SheetModel::new(&sheet, 0.1, MassKind::Lumped)
        .and_then(|m| m.with_elastic_sheet(elastic.beside(&sheet, &plate)))
        .unwrap()
        .with_potential(springs);
    let points = sheet.positions().as_chunks::<3>().0.iter();
    let x: Vec<f64> = points
        .flat_map(|[x, y, _]| [radius * (x / radius).sin(), *y, radius * (x / radius).cos()])
        .collect();
    let deformation = model.elastic_deformation(0.0, &x, &model.memories());
    let deformation = deformation.unwrap();
    let expected = step * (4.0_f64 / 3.0).sqrt() / radius;
    let tolerance = (step / radius).powi(2) / 24.0;
    for (corners, angle) in sheet.topology().faces().iter().zip(&deformation.angle) {
        let is_inside = |v: &VertexId| (0.01..0.99).contains(&sheet.positions()[3 * v.index()]);
        let inside = corners.iter().filter(|v| is_inside(v)).count();
        // Faces with an edge on the free ends have half the energy or, in their triangles there, none.
        if inside == 3 || inside == 2 && *angle > 0.9 * expected {
            assert!(
                (angle / expected - 1.0).abs() < tolerance,
                "{angle} {expected}"
            );
        }
    }
    let total: f64 = deformation.bending.iter().sum();
    let springs = model.potentials().next().unwrap().energy(At::new(0.0, &x));
    assert!((total / springs - 1.0).abs() < 1e-12);
}

/// A sheet that hangs by one end: its weight stretches it by `rho g L / (2 E h)` to first order, an eighth of
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
            .with_elastic_sheet(ElasticSheet::new(&sheet, stiffness, 0.0).unwrap())
            .unwrap();
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

/// A sheet of soft material that falls into its two supports: the limit holds it at every step.
#[test]
fn no_accepted_step_is_beyond_the_limit() {
    let sheet = generate::isotropic_square(1, 1.0).unwrap();
    let corner =
        |v: &VertexId| sheet.position(*v)[1] > 0.99 && (sheet.position(*v)[0] - 0.5).abs() > 0.49;
    let pins: Vec<_> = sheet.topology().vertex_ids().filter(corner).collect();
    assert_eq!(pins.len(), 2);
    for method in [
        Method::default(),
        Method::ImplicitEuler(ImplicitOptions::default()),
    ] {
        let elastic = ElasticSheet::new(&sheet, 1.0, 0.3).unwrap();
        let model = SheetModel::new(&sheet, 0.1, MassKind::Lumped)
            .unwrap()
            .with_gravity()
            .with_pins(&pins)
            .unwrap()
            .with_elastic_sheet(elastic.with_limit(0.02).unwrap())
            .unwrap();
        let start = State::at_rest(sheet.positions().to_vec());
        let mut run = Simulation::new(model, start, method).unwrap();
        let mut largest = 0.0_f64;
        for _ in 0..60 {
            run.step(1.0 / 60.0).unwrap();
            let elastic = run.model().elastic_sheet().unwrap();
            largest = elastic
                .strains(At::new(0.0, &run.state().x))
                .fold(largest, f64::max);
        }
        assert!(largest > 0.01 && largest < 0.02, "{largest}");
    }
}

/// A sheet clamped along a line that is no line of the mesh: rods lock, an elastic sheet does not.
#[test]
fn a_clamped_sheet_hangs() {
    let sheet = generate::delaunay(&SQUARE, 0.2, 3).unwrap();
    let x = sheet.positions();
    let pins: Vec<_> = (0..sheet.topology().vertex_count())
        .filter(|v| x[3 * v] + 0.4 * x[3 * v + 1] < 0.4)
        .map(|v| VertexId(u32::try_from(v).unwrap()))
        .collect();
    for method in [
        Method::default(),
        Method::ImplicitEuler(ImplicitOptions::default()),
    ] {
        let elastic = ElasticSheet::new(&sheet, 3e5, 0.3).unwrap();
        let plate = PlateBending::clamped(&sheet, 5e-3, &pins).unwrap();
        let model = SheetModel::new(&sheet, 0.1, MassKind::Lumped)
            .unwrap()
            .with_gravity()
            .with_damping(2.0)
            .unwrap()
            .with_pins(&pins)
            .unwrap()
            .with_elastic_sheet(elastic.beside(&sheet, &plate))
            .unwrap()
            .with_potential(plate);
        let start = State::at_rest(x.to_vec());
        let mut run = Simulation::new(model, start, method).unwrap();
        for _ in 0..60 {
            run.step(1.0 / 60.0).unwrap();
        }
        let z = run.state().x.as_chunks::<3>().0.iter().map(|p| p[2]);
        let lowest = z.fold(f64::INFINITY, f64::min);
        assert!(lowest < -0.3, "{lowest}");
    }
}

/// A clamp that turns takes the sheet along, as pins without a limit do.
#[test]
fn pins_in_motion_stay_within_the_limit() {
    let sheet = generate::grid(8, 2, 0.4, 0.1, generate::Diagonals::UnionJack).unwrap();
    let clamp: Vec<_> = sheet
        .topology()
        .vertex_ids()
        .filter(|v| sheet.position(*v)[0] < 0.06)
        .collect();
    let turn = |t: f64| 2.0 * t;
    let plate = PlateBending::clamped(&sheet, 5e-4, &clamp).unwrap();
    let elastic = ElasticSheet::new(&sheet, 3e5, 0.3).unwrap();
    let mut model = SheetModel::new(&sheet, 3.2e-3, MassKind::Lumped)
        .unwrap()
        .with_elastic_sheet(elastic.beside(&sheet, &plate))
        .unwrap()
        .with_potential(plate);
    for &v in &clamp {
        let [x, y, _] = sheet.position(v);
        let motion = move |t: f64| [x * turn(t).cos(), y, x * turn(t).sin()];
        model = model.with_moving_pin(v, motion).unwrap();
    }
    let start = State::at_rest(sheet.positions().to_vec());
    let mut run = Simulation::new(model, start, Method::default()).unwrap();
    for _ in 0..45 {
        let report = run.step(1.0 / 60.0).unwrap();
        assert_eq!(report.substeps, 1);
        assert!(report.strain < ElasticSheet::LIMIT);
    }
    let end = VertexId(0);
    let angle = turn(0.75);
    let want = [
        sheet.position(end)[0] * angle.cos(),
        sheet.position(end)[0] * angle.sin(),
    ];
    let x = &run.state().x;
    assert!((x[0] - want[0]).abs() < 1e-12 && (x[2] - want[1]).abs() < 1e-12);
}

/// A disk 11 cm across, so stiff that the stored energy of a step drowns in the round-off of its stretching:
/// an iteration that has converged ends, although noise cuts its last step in line searches for ever.
#[test]
fn the_noise_of_a_stiff_sheet_does_not_keep_a_step_from_ending() {
    let sheet = generate::disk(5, 0.057_444_895_105_385_91).unwrap();
    let (bending, stretching) = (0.001_061_624_497_071_381_2, 16_838_744.203_446_563);
    let elastic = ElasticSheet::new(&sheet, stretching, 0.3).unwrap();
    let mass = 0.094_084_313_620_295_9 * sheet.face_areas().iter().sum::<f64>();
    let model = SheetModel::new(&sheet, mass, MassKind::Lumped).unwrap();
    let model = model.with_gravity().with_damping(0.5).unwrap();
    let model = model.with_pins(&[VertexId(77), VertexId(62)]).unwrap();
    let plate = PlateBending::new(&sheet, bending).unwrap();
    let model = model
        .with_elastic_sheet(elastic.beside(&sheet, &plate))
        .unwrap()
        .with_potential(plate);
    let start = State::at_rest(sheet.positions().to_vec());
    let mut run = Simulation::new(model, start, Method::default()).unwrap();
    for _ in 0..48 {
        run.step(1.0 / 60.0).unwrap();
    }
}

/// The stiffness of the barrier is that of the start also after a resume elsewhere.
#[test]
fn a_run_resumes_to_the_bit() {
    let sheet = generate::isotropic_square(1, 1.0).unwrap();
    let model = || {
        let elastic = ElasticSheet::new(&sheet, 100.0, 0.3).unwrap();
        let pins = [VertexId(0), VertexId(4)];
        let model = SheetModel::new(&sheet, 0.1, MassKind::Lumped).unwrap();
        let model = model.with_gravity().with_pins(&pins).unwrap();
        model.with_elastic_sheet(elastic).unwrap()
    };
    let start = State::at_rest(sheet.positions().to_vec());
    let mut run = Simulation::new(model(), start, Method::default()).unwrap();
    for _ in 0..20 {
        run.step(1.0 / 60.0).unwrap();
    }
    let mut resumed = Simulation::resume(model(), None, run.checkpoint()).unwrap();
    assert!(run.memories().lists().last().unwrap()[0] > 0.0);
    assert_eq!(run.memories(), resumed.memories());
    for _ in 0..10 {
        let (a, b) = (
            run.step(1.0 / 60.0).unwrap(),
            resumed.step(1.0 / 60.0).unwrap(),
        );
        assert_eq!((a.energy_drift, a.strain), (b.energy_drift, b.strain));
        assert_eq!(run.state().x, resumed.state().x);
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
    let start = |x: Vec<f64>, method: Method| {
        let model = SheetModel::new(&sheet, 0.1, MassKind::Lumped).unwrap();
        let model = model.with_elastic_sheet(good()).unwrap();
        Simulation::new(model, State::at_rest(x), method)
            .err()
            .unwrap()
    };
    for method in [
        Method::EnergyMomentum(Default::default()),
        Method::Rattle(Default::default()),
    ] {
        let refused = start(sheet.positions().to_vec(), method);
        assert_eq!(refused, SimulationError::Elastic);
    }
    // One vertex in the middle moves by 50 mm.
    let mut x = sheet.positions().to_vec();
    x[3 * 12] += 0.05;
    let refused = start(x, Method::default());
    let SimulationError::Start(StepError::BeyondStrainLimit {
        face,
        strain,
        limit,
        ..
    }) = refused
    else {
        panic!("{refused:?}");
    };
    assert!(sheet.topology().faces()[face.index()].contains(&VertexId(12)));
    assert!(strain > limit && limit == ElasticSheet::LIMIT);
}
