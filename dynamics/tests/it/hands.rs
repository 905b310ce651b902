//! Hands that hold a sheet.

use isosheet_dynamics::nalgebra::Vector3;
use isosheet_dynamics::{Checkpoint, Hand, Method, SheetModel, Simulation, State};
use isosheet_mesh::{MassKind, Sheet, VertexId, generate};

const CORNER: VertexId = VertexId(20);

fn sheet() -> Sheet {
    generate::isotropic_square(1, 0.2).expect("a mesh")
}

fn hand(sheet: &Sheet, stiffness: f64) -> Hand {
    let at = sheet.position(CORNER);
    Hand::new(sheet.topology(), CORNER, stiffness, at).expect("a hand")
}

const STEP: f64 = 1.0 / 60.0;

/// Under its weight a sheet hangs from a hand at rest by `m g / k`, exactly in equilibrium.
#[test]
fn the_weight_stretches_the_spring() {
    let (sheet, mass) = (sheet(), 1e-3);
    let hand = hand(&sheet, 3.0);
    let model = SheetModel::new(&sheet, mass, MassKind::Lumped).expect("a model");
    let model = model.with_acceleration([0.0, 0.0, -9.81]);
    let model = model.with_hand(hand);
    let model = model.with_damping(20.0).expect("positive");
    let start = State::at_rest(sheet.positions().to_vec());
    let mut simulation = Simulation::new(model, start, Method::default()).expect("valid");
    for _ in 0..600 {
        simulation.step(STEP).expect("accepted");
    }
    let held = Vector3::from(simulation.hand_target(CORNER).expect("a hand"));
    let stretch = Vector3::from(simulation.state().vertex_positions()[CORNER.index()]) - held;
    let want = Vector3::new(0.0, 0.0, -mass * 9.81 / 3.0);
    assert!((stretch - want).norm() < 1e-6, "{stretch}, {want}");
}

/// A run that goes on from a checkpoint on the way of the hand moves as if it had not been interrupted.
#[test]
fn a_hand_on_its_way_goes_on_after_a_checkpoint() {
    let sheet = sheet();
    let model = || {
        let model = SheetModel::new(&sheet, 1e-2, MassKind::Lumped).expect("a model");
        model.with_gravity().with_hand(hand(&sheet, 2.0))
    };
    let start = State::at_rest(sheet.positions().to_vec());
    let mut run = Simulation::new(model(), start, Method::default()).expect("valid");
    let (to, end) = ([0.3, 0.1, 0.2], 6.0 * STEP);
    run.lead_hand(CORNER, to, end).expect("finite");
    for _ in 0..2 {
        run.step(STEP).expect("accepted");
    }
    let on_its_way = run.hand_target(CORNER).expect("a hand");
    assert!(on_its_way != to && on_its_way != sheet.position(CORNER));
    let written = run.checkpoint().to_bytes().expect("serialised");
    let read = Checkpoint::from_bytes(&written).expect("what was written");
    let mut resumed = Simulation::resume(model(), None, read).expect("the same model");
    assert_eq!(resumed.hand_target(CORNER), Ok(on_its_way));
    for _ in 0..8 {
        let reports = [&mut run, &mut resumed].map(|run| run.step(STEP).expect("accepted"));
        assert_eq!(reports[0], reports[1]);
        assert_eq!(run.state(), resumed.state());
    }
    assert_eq!(resumed.hand_target(CORNER), Ok(to));
}

/// Between two steps hands come and go, and potentials with them; a hand that stays goes on where it is.
#[test]
fn hands_come_and_go_between_steps() {
    let sheet = sheet();
    let base = || SheetModel::new(&sheet, 1e-2, MassKind::Lumped).expect("a model");
    let other = VertexId(0);
    let second = || {
        let at = sheet.position(other);
        Hand::new(sheet.topology(), other, 5.0, at).expect("a hand")
    };
    let start = State::at_rest(sheet.positions().to_vec());
    let model = base().with_hand(hand(&sheet, 2.0));
    let mut run = Simulation::new(model, start, Method::default()).expect("valid");
    run.lead_hand(CORNER, [0.3, 0.1, 0.2], 6.0 * STEP)
        .expect("finite");
    run.step(STEP).expect("accepted");
    let on_its_way = run.hand_target(CORNER);
    let changed = |model: SheetModel, run: &Simulation| {
        let next = Simulation::resume(model, None, run.checkpoint());
        next.and_then(|next| next.changed_from(run))
            .expect("the same sheet")
    };
    let both = base().with_hand(second()).with_gravity();
    let mut run = changed(both.with_hand(hand(&sheet, 2.0)), &run);
    assert_eq!(run.hand_target(CORNER), on_its_way);
    assert_eq!(run.hand_target(other), Ok(sheet.position(other)));
    run.step(STEP).expect("accepted");
    let still = run.hand_target(other);
    let mut run = changed(base().with_gravity().with_hand(second()), &run);
    assert_eq!(run.hand_target(other), still);
    assert!(run.hand_target(CORNER).is_err());
    run.step(STEP).expect("accepted");
    changed(base(), &run).step(STEP).expect("accepted");
}

/// The work of the hand that drags a sheet is the energy of the sheet and the spring, up to what the
/// method damps, which vanishes with the step.
#[test]
fn the_work_of_the_hand_is_counted() {
    let drift = |parts: u32| {
        let sheet = sheet();
        let hand = hand(&sheet, 2.0);
        let model = SheetModel::new(&sheet, 1e-2, MassKind::Lumped).expect("a model");
        let model = model.with_hand(hand);
        let start = State::at_rest(sheet.positions().to_vec());
        let mut simulation = Simulation::new(model, start, Method::default()).expect("valid");
        let (mut largest, mut work) = (0.0_f64, 0.0);
        for step in 0..30 {
            let t = simulation.state().t;
            let to = Vector3::from(sheet.position(CORNER))
                + 0.1 * (f64::from(step) * STEP) * Vector3::new(1.0, 1.0, 0.0);
            simulation
                .lead_hand(CORNER, to.into(), t + STEP)
                .expect("finite");
            for _ in 0..parts {
                let report = simulation.step(STEP / f64::from(parts)).expect("accepted");
                largest = largest.max(report.energy_drift.abs());
                work = report.work;
            }
        }
        (largest, work)
    };
    let [(coarse, _), (fine, work)] = [4, 16].map(drift);
    assert!(work > 0.0 && fine < 0.02 * work, "{fine}, work {work}");
    assert!(coarse > 4.0 * fine, "{coarse}, {fine}");
}
