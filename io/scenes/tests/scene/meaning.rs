//! A scene is the simulation that it says.

use crate::skip::data_folder;
use crate::{parse, simulation};
use isosheet_dynamics::nalgebra::Vector3;
use isosheet_dynamics::{Air, At, Method, PointProfile, Profile, SheetModel, Simulation, State};
use isosheet_mesh::{MassKind, VertexId, fold_angle, generate};
use isosheet_scenes::{Scene, SceneFile, StartingPoint};
use std::path::Path;

/// The scene of the first program of docs/rust.md gives the bits of that program.
#[test]
fn a_scene_is_the_simulation_that_it_says() {
    let text = "version = 1
        [sheet]
        mesh = { square = { side = 0.21, level = 2 } }
        density = 0.08
        damping = 0.5
        [[support]]
        at = { vertices = [72] }
        hold = { moving_pin = { z = { smooth_step = { to = 0.02, end = 0.5 } } } }
        [forces]
        gravity = [0, 0, -9.8]";
    let mut of_scene = simulation(text);
    let sheet = generate::isotropic_square(2, 0.21).unwrap();
    let lift = PointProfile {
        offset: sheet.position(VertexId(72)),
        z: Profile::SmoothStep {
            from: 0.0,
            to: 0.02,
            begin: 0.0,
            end: 0.5,
        },
        ..PointProfile::default()
    };
    let model = SheetModel::new(&sheet, 0.08 * sheet.area(), MassKind::Lumped)
        .and_then(|m| m.with_damping(0.5))
        .and_then(|m| m.with_gravity().with_moving_pin(VertexId(72), lift))
        .unwrap();
    let start = State::at_rest(sheet.positions().to_vec());
    let mut by_hand = Simulation::new(model, start, Method::default()).unwrap();
    for _ in 0..10 {
        let h = 1.0 / 60.0;
        assert_eq!(of_scene.step(h).unwrap(), by_hand.step(h).unwrap());
    }
    assert_eq!(of_scene.state(), by_hand.state());
}

/// A crease between two triangles, held at one of them and free of other forces, comes to rest at its rest
/// angle, which is given in degrees and positive for a valley.
#[test]
fn a_crease_folds_to_its_angle_in_degrees() {
    for angle in [70.0_f64, -70.0] {
        let text = format!(
            "version = 1
            [sheet]
            mesh = {{ rectangle = {{ width = 0.1, height = 0.1, columns = 1, rows = 1 }} }}
            damping = 60.0
            [[crease]]
            at = {{ line = {{ from = [0.0, 0.0, 0.0], to = [0.1, 0.1, 0.0] }} }}
            stiffness = 0.02
            angle = {{ ramp = {{ to = {angle}, end = 0.2 }} }}
            [[support]]
            at = {{ vertices = [0, 1, 3] }}
            [method]
            step = 0.01"
        );
        let mut run = simulation(&text);
        for _ in 0..150 {
            run.step(0.01).unwrap();
        }
        let t = run.model().topology();
        let crease = t.edge_ids().find(|&e| !t.is_boundary_edge(e)).unwrap();
        let fold = fold_angle(t, &run.state().x, crease).unwrap().to_degrees();
        assert!((fold - angle).abs() < 1e-3, "{fold} degrees");
    }
}

/// Poses and rotations by the right-hand rule, in degrees: x goes to y about z.
#[test]
fn placements_and_rotations_turn_as_written() {
    let text = "version = 1
        [sheet]
        mesh = { rectangle = { width = 1.0, height = 2.0, columns = 1, rows = 1 } }
        placement = { position = [10, 0, 0], turn = { axis = [0, 0, 3], angle = 90 } }
        [[support]]
        at = \"all\"
        [[obstacle]]
        shape = \"half_space\"
        pose = { position = [0, 0, -1], turn = { axis = [0, 1, 0], angle = 90 } }
        motion = { x = 0.5, rotation = { centre = [0, 0, 0], axis = [0, 0, 1], angle = 90 } }";
    let setup = parse(text).unwrap().build().unwrap();
    // The corner (1, 0) goes to (0, 1) and is moved by 10 along x; (1, 2) goes to (-2, 1).
    let expected = [
        [10.0, 0.0, 0.0],
        [10.0, 1.0, 0.0],
        [8.0, 0.0, 0.0],
        [8.0, 1.0, 0.0],
    ];
    for (p, q) in setup.start.x.as_chunks::<3>().0.iter().zip(&expected) {
        assert!(
            p.iter().zip(q).all(|(a, b)| (a - b).abs() < 1e-14),
            "{p:?}, {q:?}"
        );
    }
    // The normal z of the half-space becomes x by the pose and y by the motion; its point (0, 0, -1) stays on
    // the axis and is moved by 0.5.
    let pose = setup.obstacles[0].motion().pose(0.3);
    let normal: [f64; 3] = (pose.rotation * Vector3::z()).into();
    let place: [f64; 3] = pose.translation.vector.into();
    for (found, want) in normal.iter().zip([0.0, 1.0, 0.0]) {
        assert!((found - want).abs() < 1e-14, "{normal:?}");
    }
    for (found, want) in place.iter().zip([0.5, 0.0, -1.0]) {
        assert!((found - want).abs() < 1e-14, "{place:?}");
    }
}

/// A strip that hangs at rest pulls at its support with its weight and the load on it.
#[test]
fn supports_carry_weight_and_loads() {
    let text = "version = 1
        [sheet]
        mesh = { rectangle = { width = 0.1, height = 0.2, columns = 1, rows = 2 } }
        placement = { turn = { axis = [1, 0, 0], angle = 90 } }
        density = 2.0
        damping = 50.0
        [[support]]
        at = { half_space = { point = [0, 0, 0.2], normal = [0, 0, 1] } }
        [forces]
        gravity = [0, 0, -10]
        [[forces.load]]
        at = { box = { min = [-1, -1, -1], max = [1, 1, 0] } }
        direction = [0, 0, -7]
        size = 0.6";
    let mut run = simulation(text);
    for _ in 0..60 {
        run.step(0.01).unwrap();
    }
    let carried: f64 = run.reactions().iter().map(|r| r.force.z).sum();
    // 0.02 m2 of 2 kg/m2 at 10 m/s2, and 0.6 N.
    assert!((carried - 1.0).abs() < 1e-9, "{carried} N");
}

/// A table without keys is still air with the numbers of the engine, and a wind has its profiles.
#[test]
fn air_is_the_air_that_it_says() {
    let of = |air: &str| {
        let scene = format!(
            "version = 1
            [sheet]
            mesh = {{ square = {{ side = 0.2, level = 0 }} }}
            density = 0.08
            {air}"
        );
        simulation(&scene)
    };
    // Forces at two times on a sheet that turns, of the model of a scene, and of one that is made by hand.
    let sheet = generate::isotropic_square(0, 0.2).expect("a mesh");
    let x = sheet.positions();
    let v: Vec<f64> = (0..x.len()).map(|i| (1.7 * i as f64).sin()).collect();
    let forces = |model: &SheetModel| {
        [0.0, 1.0].map(|t| {
            let mut force = vec![0.0; x.len()];
            model.applied_force(t, x, &v, &mut force);
            force
        })
    };
    let in_air = |air: Air| {
        let model = SheetModel::new(&sheet, 0.08 * 0.2 * 0.2, MassKind::Lumped).expect("a mass");
        forces(&model.with_air(air).expect("in range"))
    };
    assert_eq!(
        forces(of("").model()),
        [vec![0.0; x.len()], vec![0.0; x.len()]]
    );
    assert_eq!(forces(of("[air]").model()), in_air(Air::default()));
    let gusts = "[air]
        density = 1000
        normal = 2
        tangential = 0
        wind = [
            { sine = { mean = 4, amplitude = 2, frequency = 0.5, phase = 90 } },
            -1,
            { ramp = { to = 3, end = 2 } },
        ]";
    let found = forces(of(gusts).model());
    for (k, wind) in [[6.0, -1.0, 0.0], [2.0, -1.0, 1.5]].into_iter().enumerate() {
        let want = in_air(Air {
            density: 1000.0,
            normal: 2.0,
            tangential: 0.0,
            wind: wind.into(),
        });
        for (found, want) in found[k].iter().zip(&want[k]) {
            assert!(
                (found - want).abs() < 1e-12 * want.abs().max(1.0),
                "{found} {want}"
            );
        }
    }
}

/// The scenes to start from keep what is promised: lengths of rods to 1e-12, elastic sheets within their
/// limit of strain, and open gaps.
#[test]
fn starting_points_run_and_keep_their_promises() {
    for kind in StartingPoint::ALL {
        let scene = SceneFile::parse(kind.text().into(), Path::new(kind.name()), &[]).unwrap();
        let mut run = scene.build().unwrap().start().unwrap();
        let h = scene.scene().method.step;
        let elastic = run.model().elastic_sheet().cloned();
        for _ in 0..(scene.scene().stop.time / h).round() as usize {
            let report = run
                .step(h)
                .unwrap_or_else(|e| panic!("{}: {e}", kind.name()));
            let beyond = match &elastic {
                None => (report.strain >= 2e-12).then_some(report.strain),
                Some(elastic) => elastic
                    .beyond_limit(At::new(run.state().t, &run.state().x))
                    .map(|worst| worst.strain),
            };
            assert_eq!(beyond, None, "{}", kind.name());
            assert!(report.gap.is_none_or(|gap| gap > 0.0), "{}", kind.name());
            assert_eq!(report.gap.is_some(), scene.scene().has_contact());
        }
    }
}

#[test]
fn a_scene_written_by_a_program_is_read_as_the_same() {
    for kind in StartingPoint::ALL {
        let read = parse(kind.text()).unwrap();
        let written = SceneFile::of(read.scene().clone(), Path::new("")).unwrap();
        let again: Scene = parse(&written.text().text).unwrap().scene().clone();
        assert_eq!(&again, read.scene());
    }
}

/// Somebody else's sheet over somebody else's tool.
#[test]
fn an_obj_sheet_drapes_over_a_tool_mesh() {
    let Some(data) = data_folder() else {
        return;
    };
    let text = "version = 1
        [sheet]
        mesh = { file = { path = \"planar/square_delaunay_102v.obj\" } }
        damping = 2.0
        placement = { position = [0.0, -0.5, 0.51] }
        [[obstacle]]
        shape = { file = { path = \"tools/sphere_1k.obj\" } }
        friction = 0.3
        [contact]
        self_contact = true
        [forces]
        gravity = [0, 0, -9.81]";
    let scene = SceneFile::parse(text.into(), &data.join("drape.toml"), &[]).unwrap();
    let mut run = scene.build().unwrap().start().unwrap();
    for _ in 0..20 {
        let report = run.step(1.0 / 60.0).unwrap();
        assert!(
            report.strain < 2e-12 && report.gap.unwrap() > 0.0,
            "{report:?}"
        );
    }
    // It hangs over the ball of radius 0.5 and does not fall past it.
    let heights: Vec<f64> = run.state().x.iter().skip(2).step_by(3).copied().collect();
    let top = heights.iter().copied().fold(f64::NEG_INFINITY, f64::max);
    let low = heights.iter().copied().fold(f64::INFINITY, f64::min);
    assert!(top > 0.4 && low < 0.3, "{low} to {top}");
    assert!(run.body_loads()[0].force.z < 0.0);
}
