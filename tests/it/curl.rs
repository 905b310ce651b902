//! Sheets that are not flat without stress, in motion: against closed forms.

use isosheet_dynamics::{
    Curl, Curvature, Isometry, Material, MaterialDirection, Method, NaturalTensor, Profile,
    SheetModel, Simulation, State,
};
use isosheet_mesh::{Sheet, VertexId, fold_angle, generate};

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
