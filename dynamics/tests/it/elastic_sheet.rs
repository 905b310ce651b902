//! Elastic sheets in motion and at rest, against closed forms.

use isosheet_dynamics::{
    At, CreaseSprings, ElasticSheet, ImplicitOptions, Method, PlateBending, SheetModel, Simulation,
    SimulationError, State, StepError,
};
use isosheet_mesh::{MassKind, VertexId, generate};

const SQUARE: [[f64; 2]; 4] = [[0.0, 0.0], [1.0, 0.0], [1.0, 1.0], [0.0, 1.0]];

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
fn starts_that_make_no_sense_are_refused() {
    let sheet = generate::isotropic_square(1, 1.0).unwrap();
    let good = || ElasticSheet::new(&sheet, 1e3, 0.3).unwrap();
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
