//! Rods that fixed vertices hold in place.

use isosheet_dynamics::{
    CreaseSprings, Fallback, Method, SheetModel, Simulation, State, StepControl, StepError,
};
use isosheet_mesh::{Advice, MassKind, Sheet, VertexId, generate};

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

/// A sheet that locks is held, and says so.
#[test]
fn sheets_that_lock_reach_the_end() {
    let sheet = irregular();
    let mut run = clamped(&sheet, &quarter(&sheet), 1e-2);
    let mut unsolved = 0;
    for _ in 0..120 {
        let report = run.step(STEP).expect("goes on");
        assert!(report.strain <= 1e-12, "{report:?}");
        unsolved += u32::from(!report.outcome.is_solved());
    }
    assert!(unsolved > 0);
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

/// Rods of an irregular sheet that is clamped over a quarter lock; the error names the remedy.
#[test]
fn sheets_that_lock_may_be_refused_with_a_remedy() {
    let sheet = irregular();
    let refusing = StepControl {
        fallback: Fallback::Refuse,
        ..StepControl::default()
    };
    let mut run = clamped(&sheet, &quarter(&sheet), 1e-2)
        .with_control(refusing)
        .expect("valid");
    let error = (0..120).find_map(|_| run.step(STEP).err()).expect("locks");
    let StepError::StepTooSmall { dependent_rods, .. } = &error else {
        panic!("{error}");
    };
    assert!(*dependent_rods > 0);
    assert!(error.to_string().contains("may lock"), "{error}");
    let advice = error.advice().expect("there are other models");
    assert!(advice.contains("with_membrane"), "{advice}");
}
