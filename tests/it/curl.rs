//! Sheets that are not flat without stress, in motion: against closed forms.

use isosheet_dynamics::{
    Curl, Curvature, Isometry, Material, MaterialDirection, Method, NaturalTensor, PlateBending,
    Profile, SheetModel, Simulation, State, VertexLoad,
};
use isosheet_mesh::{MassKind, Sheet, VertexId, fold_angle, generate};

fn along(along: f64) -> NaturalTensor {
    let none = Curvature::default();
    Curvature { along, ..none }.into()
}

/// Until nothing moves: without the energy of motion that a step of a second would notice.
fn at_rest(model: SheetModel, sheet: &Sheet, seconds: f64) -> Simulation {
    let start = State::at_rest(sheet.positions().to_vec());
    let mut run = Simulation::new(model, start, Method::default()).expect("a start");
    let h = 1.0 / 120.0;
    for _ in 0..(seconds / h) as usize {
        run.step(h).expect("a step");
    }
    let speed = run.state().v.iter().fold(0.0_f64, |m, v| m.max(v.abs()));
    assert!(speed < 1e-5, "it is still moving: {speed} m/s");
    run
}

/// A poster off a roll of 5 cm, which is flat at first and begins to curl: it ends as that roll. All its
/// cells bend alike.
#[test]
fn a_poster_curls_to_its_roll() {
    let (length, radius, cells) = (0.24, 0.05, 24);
    let sheet = generate::anisotropic_grid(cells, 2, length, 0.04).expect("a strip");
    let clamp = sheet.vertices_where(|[x, ..]| x < 0.015);
    let curl = Curl {
        direction: MaterialDirection::Uniform([1.0, 0.0, 0.0]),
        curvature: along(1.0 / radius),
        profile: Profile::Ramp {
            from: 0.0,
            to: 1.0,
            begin: 0.0,
            end: 0.5,
        },
    };
    for isometry in [Isometry::Rods, Isometry::Elastic] {
        let model = SheetModel::of_material(&sheet, &Material::office_paper())
            .with_isometry(isometry)
            .clamped(&clamp)
            .curled(curl.clone())
            .build()
            .and_then(|model| Ok(model.with_damping(20.0)?))
            .expect("a model");
        let run = at_rest(model, &sheet, 4.0);
        // The free part as an arc: its end by the angle that it has turned.
        let last = sheet.topology().vertex_ids().last().expect("vertices");
        let free = length - 0.01;
        let turned = free / radius;
        let [x, _, z] = run.state().vertex_positions()[last.index()];
        let expected = [0.01 + radius * turned.sin(), radius * (1.0 - turned.cos())];
        let error = (x - expected[0]).hypot(z - expected[1]) / radius;
        assert!(error < 0.05, "{isometry:?}: {x} {z} {expected:?}");
        let t = sheet.topology();
        let across = t.edge_ids().filter(|e| {
            let [a, b] = t.edges()[e.index()].map(|v| sheet.positions()[3 * v.index()]);
            (a - b).abs() < 1e-9 && (0.03..length - 0.03).contains(&a)
        });
        for edge in across {
            let angle = fold_angle(t, &run.state().x, edge).expect("an inner edge");
            let expected = length / cells as f64 / radius;
            // To second order in the angle of a cell.
            assert!(
                (angle / expected - 1.0).abs() < expected * expected,
                "{isometry:?} {angle} {expected}"
            );
        }
    }
}

/// A ring with a slit is round without stress. Forces `P` that pull its ends apart open the slit
/// by `3 pi P R^3 / (E I)` (bending theory of curved beams, moment `P R (1 - cos t)`).
#[test]
fn a_ring_with_a_slit_opens_as_a_curved_beam() {
    let (radius, width, rigidity) = (0.05, 0.01, 5e-4);
    let cells = 64;
    let arc = std::f64::consts::TAU * radius;
    let flat = generate::anisotropic_grid(cells, 2, arc, width).expect("a strip");
    let round = |[x, y, _]: [f64; 3]| {
        let angle = x / radius;
        [radius * angle.sin(), y, radius * (1.0 - angle.cos())]
    };
    let ring = flat.map_positions(round).expect("a ring");
    let first = arc / cells as f64;
    let clamp: Vec<VertexId> = flat.vertices_where(|[x, ..]| x < 1.5 * first);
    let end: Vec<VertexId> = flat.vertices_where(|[x, ..]| x > arc - 0.5 * first);
    // A hundredth of the radius: small against it.
    let opening = 0.01 * radius;
    let force = opening * rigidity * width / (3.0 * std::f64::consts::PI * radius.powi(3));
    let model = SheetModel::new(&ring, 1e-4, MassKind::Lumped)
        .and_then(|m| m.with_pins(&clamp))
        .and_then(|m| m.with_damping(30.0))
        .expect("a model");
    let plate = PlateBending::clamped(&ring, rigidity, &clamp).expect("a plate");
    let count = end.len() as f64;
    let size = Profile::Constant(force / count);
    let load = VertexLoad::new(ring.topology(), &end, [-1.0, 0.0, 0.0], size).expect("a load");
    let model = model.with_potential(plate.curved(&ring)).with_force(load);
    let run = at_rest(model, &ring, 4.0);
    let moved = end
        .iter()
        .map(|v| ring.positions()[3 * v.index()] - run.state().x[3 * v.index()]);
    let moved = moved.sum::<f64>() / count;
    assert!((moved / opening - 1.0).abs() < 0.03, "{moved} {opening}");
}

/// A narrow strip that wants to be twisted alone becomes a helicoid: its end has turned by the twist times
/// its length.
#[test]
fn a_narrow_strip_with_a_twist_is_a_helicoid() {
    let (length, width, twist) = (0.1, 0.004, 4.0);
    let sheet = generate::anisotropic_grid(100, 4, length, width).expect("a strip");
    let clamp = sheet.vertices_where(|[x, ..]| x < 0.0015);
    let none = Curvature::default();
    let curl = Curl {
        direction: MaterialDirection::Uniform([1.0, 0.0, 0.0]),
        curvature: Curvature { twist, ..none }.into(),
        profile: Profile::Ramp {
            from: 0.0,
            to: 1.0,
            begin: 0.0,
            end: 0.5,
        },
    };
    let model = SheetModel::of_material(&sheet, &Material::office_paper())
        .clamped(&clamp)
        .curled(curl)
        .build()
        .and_then(|model| Ok(model.with_damping(20.0)?))
        .expect("a model");
    let run = at_rest(model, &sheet, 3.0);
    let turned = |from: f64| {
        let line = sheet.vertices_where(|[x, ..]| (x - from).abs() < 1e-9);
        let at = |v: &VertexId| run.state().vertex_positions()[v.index()];
        let (first, last) = (at(&line[0]), at(&line[line.len() - 1]));
        (last[2] - first[2]).atan2(last[1] - first[1])
    };
    // Between two lines away from the ends.
    let (from, to) = (0.02, 0.09);
    let found = (turned(to) - turned(from)) / (to - from);
    assert!((found / twist - 1.0).abs() < 0.02, "{found} {twist}");
}
