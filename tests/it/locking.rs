//! Rods that fixed vertices hold in place.

use isosheet_collide::{Coefficients, ContactOptions, Contacts, Obstacle, Shape};
use isosheet_dynamics::{
    CreaseSprings, ImplicitOptions, Method, PlateBending, SheetModel, Simulation, State,
    StepControl, StepError, StepProgress, leave_flat,
};
use isosheet_mesh::{Advice, MassKind, Sheet, VertexId, generate};
use nalgebra::Isometry3;
use std::ops::ControlFlow;

const STEP: f64 = 1.0 / 60.0;

fn clamped(sheet: &Sheet, pins: &[VertexId], rigidity: f64) -> Simulation {
    let model = SheetModel::new(sheet, 0.1, MassKind::Lumped)
        .and_then(|m| m.with_gravity().with_damping(2.0))
        .and_then(|m| m.with_pins(pins))
        .expect("valid");
    let springs = CreaseSprings::bending(sheet, rigidity).expect("valid");
    let start = State::at_rest(sheet.positions().to_vec());
    Simulation::new(model.with_potential(springs), start, Method::default()).expect("valid")
}

/// A side of a square and the next vertex of the side beside it: three more vertices cannot move, the last of
/// them because a straight line of rods would have to stretch.
#[test]
fn immobile_vertices_are_held_and_named() {
    let sheet = generate::isotropic_square(1, 1.0).expect("valid");
    let pins: Vec<VertexId> = (0..6).map(VertexId).collect();
    let mut run = clamped(&sheet, &pins, 1e-3);
    let mut immobile = run.immobile_vertices().to_vec();
    immobile.sort_unstable();
    assert_eq!(immobile, [6, 7, 8].map(VertexId));
    for _ in 0..120 {
        let report = run.step(STEP).expect("accepted");
        assert!(report.strain <= 1e-12, "{report:?}");
    }
    let x = &run.state().x;
    for v in immobile {
        let k = 3 * v.index();
        assert_eq!(x[k..k + 3], sheet.positions()[k..k + 3]);
    }
    // The rest hangs down.
    let low = x.iter().skip(2).step_by(3).fold(0.0, |m: f64, z| m.min(*z));
    assert!(low < -0.3, "{low}");
}

fn irregular() -> Sheet {
    let square = [[0.0, 0.0], [1.0, 0.0], [1.0, 1.0], [0.0, 1.0]];
    generate::delaunay(&square, 0.16, 7).expect("valid")
}

/// A quarter of the vertices, on one side of a line that is no mesh line.
fn quarter(sheet: &Sheet) -> Vec<VertexId> {
    let along = |v: &VertexId| {
        let p = sheet.position(*v);
        p[0] + 0.4 * p[1]
    };
    let mut pins: Vec<VertexId> = sheet.topology().vertex_ids().collect();
    pins.sort_by(|a, b| along(a).total_cmp(&along(b)));
    pins.truncate(pins.len() / 4);
    pins
}

/// The number of factorisations that a watch has seen in a step that is refused.
fn refused(run: &mut Simulation, steps: usize) -> Option<(StepError, usize)> {
    (0..steps).find_map(|_| {
        let mut most = 0;
        let mut watch = |progress: &StepProgress| {
            most = most.max(progress.factorisations);
            ControlFlow::Continue(())
        };
        let step = run.step_watched(STEP, &mut watch);
        Some((step.err()?, most))
    })
}

/// Rods of an irregular sheet that is clamped over a quarter lock: the step is refused after a bounded
/// effort, and the error names the vertices and the remedy.
#[test]
fn sheets_that_lock_are_refused_with_a_remedy() {
    let sheet = irregular();
    let pins = quarter(&sheet);
    let mut run = clamped(&sheet, &pins, 1e-2);
    assert_eq!(
        run.model().clamps_across_the_mesh(sheet.positions()).len(),
        1
    );
    let (error, most) = refused(&mut run, 120).expect("locks");
    let StepError::Locked {
        factorisations,
        vertices,
        ..
    } = &error
    else {
        panic!("{error}");
    };
    assert_eq!(*factorisations, StepControl::default().max_factorisations);
    assert!(most <= *factorisations, "{most}");
    assert!(!vertices.is_empty());
    assert!(vertices.iter().all(|v| !run.model().is_pinned(*v)));
    let advice = error.advice().expect("there are other models");
    assert!(advice.contains("with_elastic_sheet"), "{advice}");
}

/// So are sheets in a clamp that moves, and sheets above a floor; and a sheet that hangs taut by two opposite
/// corners, where it is folded and its clamp is none.
#[test]
fn locks_are_told_in_moving_clamps_above_floors_and_where_sheets_hang_taut() {
    let sheet = irregular();
    let springs = CreaseSprings::bending(&sheet, 1e-2).expect("valid");
    let mut lifted = SheetModel::new(&sheet, 0.1, MassKind::Lumped)
        .map(|m| m.with_gravity().with_potential(springs))
        .expect("valid");
    for v in quarter(&sheet) {
        let [x, y, z] = sheet.position(v);
        let up = move |t: f64| [x, y, z + 0.1 * t * t];
        lifted = lifted.with_moving_pin(v, up).expect("valid");
    }
    let start = State::at_rest(sheet.positions().to_vec());
    let lifted = Simulation::new(lifted, start, Method::default()).expect("valid");
    let low = clamped(&sheet, &quarter(&sheet), 1e-2);
    let floor = Isometry3::translation(0.0, 0.0, -0.1);
    let floor = Obstacle::fixed(Shape::HalfSpace, floor).expect("valid");
    let contacts = Contacts::new(low.model(), ContactOptions::for_sheet(low.model()))
        .and_then(|c| c.with_body(floor, Coefficients::equal(0.3)))
        .expect("valid");
    let low = low.with_contact(contacts).expect("nothing touches");
    let square = generate::isotropic_square(1, 1.0).expect("valid");
    let taut = clamped(&square, &[VertexId(0), VertexId(24)], 1e-9);
    for (what, mut run) in [("lifted", lifted), ("floor", low), ("taut", taut)] {
        let (error, _) = refused(&mut run, 120).unwrap_or_else(|| panic!("{what}"));
        let most = StepControl::default().max_factorisations;
        assert!(
            matches!(&error, StepError::Locked { factorisations, .. } if *factorisations <= most),
            "{what}: {error}"
        );
    }
}

/// A sheet of rods that is pushed against a wall jams. Rounds of multipliers that rods which depend on each
/// other do not have end early: in the mean a step takes no more than one restoration that fails, and a run
/// that ends before its time says that the sheet locks.
#[test]
fn a_sheet_that_jams_is_moved_or_refused_with_bounded_effort() {
    const STARTS: u64 = 8;
    const STEPS: usize = 60;
    let restoration = ImplicitOptions::default().max_projections;
    let sheet = generate::isotropic_square(2, 0.2).expect("valid");
    let sheet = sheet.map_positions(|[x, y, z]| [x, y, z + 0.004]);
    let sheet = sheet.expect("the same lengths");
    let model = || {
        let model = SheetModel::new(&sheet, 3.2e-3, MassKind::Lumped).expect("valid");
        let plate = PlateBending::new(&sheet, 1e-3).expect("valid");
        let model = model.with_gravity().with_potential(plate);
        let clamp = sheet.topology().vertex_ids();
        let clamp = clamp.filter(|v| sheet.position(*v)[0] > 0.199);
        clamp.fold(model, |model, v| {
            let [x, y, z] = sheet.position(v);
            let pushed = move |t: f64| [x - 0.05 * t, y, z];
            model.with_moving_pin(v, pushed).expect("valid")
        })
    };
    let solid = |half: [f64; 3], at: [f64; 3]| {
        let pose = Isometry3::translation(at[0], at[1], at[2]);
        Obstacle::fixed(Shape::Cuboid { half }, pose).expect("valid")
    };
    let contacts = |model: &SheetModel| {
        let friction = Coefficients::equal(0.3);
        Contacts::new(model, ContactOptions::for_sheet(model))
            .and_then(|c| c.with_body(solid([0.3, 0.3, 0.02], [0.0, 0.1, -0.02]), friction))
            .and_then(|c| c.with_body(solid([0.02, 0.3, 0.05], [-0.03, 0.1, 0.05]), friction))
            .expect("valid")
    };
    let mut spent = 0;
    for seed in 1..=STARTS {
        let model = model();
        let mut x = sheet.positions().to_vec();
        leave_flat(&model, &mut x, 1e-4, seed).expect("positions with the lengths");
        let contacts = contacts(&model);
        let run = Simulation::new(model, State::at_rest(x), Method::default());
        let run = run.expect("valid").with_contact(contacts);
        let mut run = run.expect("nothing touches");
        for _ in 0..STEPS {
            let mut in_step = 0;
            let mut watch = |progress: &StepProgress| {
                in_step = progress.factorisations;
                ControlFlow::Continue(())
            };
            let step = run.step_watched(STEP, &mut watch);
            spent += in_step;
            if let Err(error) = step {
                assert!(matches!(error, StepError::Locked { .. }), "{seed}: {error}");
                break;
            }
        }
    }
    assert!(spent < STARTS as usize * STEPS * restoration, "{spent}");
}
