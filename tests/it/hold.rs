//! Sheets that are held where their rods lock.

use isosheet_collide::{Coefficients, ContactOptions, Contacts, Keyframe, Obstacle, Shape};
use isosheet_dynamics::{
    Checkpoint, Fallback, Method, SheetModel, Simulation, State, StepControl, StepError,
    StepOutcome,
};
use isosheet_mesh::{MassKind, Sheet, VertexId, generate};
use nalgebra::Isometry3;

const H: f64 = 1.0 / 60.0;

fn flat() -> Sheet {
    generate::isotropic_square(1, 1.0).expect("valid")
}

/// Held at two opposite corners from flat: the halves fall shut, hang taut, and lock.
fn hanging(sheet: &Sheet) -> SheetModel {
    SheetModel::new(sheet, 0.1, MassKind::Lumped)
        .and_then(|m| m.with_gravity().with_pins(&[VertexId(0), VertexId(24)]))
        .expect("valid")
}

fn control(fallback: Fallback) -> StepControl {
    StepControl {
        min_fraction: 1.0 / 16.0,
        fallback,
        ..StepControl::default()
    }
}

fn run(model: SheetModel, sheet: &Sheet, fallback: Fallback) -> Simulation {
    let start = State::at_rest(sheet.positions().to_vec());
    Simulation::new(model, start, Method::default())
        .and_then(|s| s.with_control(control(fallback)))
        .expect("valid")
}

#[test]
fn a_sheet_whose_rods_lock_is_held_and_says_so() {
    let sheet = flat();
    let mut refusing = run(hanging(&sheet), &sheet, Fallback::Refuse);
    let error = (0..60).find_map(|_| refusing.step(H).err());
    assert!(
        matches!(error, Some(StepError::StepTooSmall { .. })),
        "{error:?}"
    );
    let mut run = run(hanging(&sheet), &sheet, Fallback::Hold);
    let (start, mut held) = (run.energy(), 0);
    for step in 0..60 {
        let (before, energy) = (run.state().clone(), run.energy());
        let report = run
            .step(H)
            .unwrap_or_else(|error| panic!("step {step}: {error}"));
        assert!(report.strain < 1e-12, "step {step}: {:e}", report.strain);
        assert!((run.state().t - f64::from(step + 1) * H).abs() < 1e-12);
        assert!(report.hamiltonian() <= energy + 1e-3, "step {step}");
        if report.outcome != StepOutcome::Held {
            continue;
        }
        held += 1;
        assert_eq!(report.residual, 1.0);
        if report.substeps == 1 {
            assert_eq!(report.kinetic, 0.0);
            assert!(run.state().v.iter().all(|v| *v == 0.0));
            assert_eq!(run.state().x, before.x, "step {step}");
            let forces = run.reactions();
            assert!(forces.iter().all(|r| r.force.norm() == 0.0), "{forces:?}");
        }
    }
    assert!(held > 0);
    // What it lost is accounted for.
    let report = run.step(H).expect("goes on");
    let fallen = start - report.hamiltonian();
    // (How far the sheet falls before it is held depends on round-off.)
    assert!(report.dissipated > 0.0 && fallen > 0.01, "{report:?}");
    assert!(
        report.energy_drift <= 1e-9 * fallen && report.energy_drift > -0.5 * fallen,
        "{report:?}"
    );
}

/// Checkpoints before and after held steps continue to the same bits.
#[test]
fn held_steps_are_resumed_to_the_same_bits() {
    let sheet = flat();
    let mut run = run(hanging(&sheet), &sheet, Fallback::Hold);
    let mut resumed: Option<Simulation> = None;
    let mut held = 0;
    for step in 0..30 {
        let bytes = run.checkpoint().to_bytes().expect("written");
        let report = run.step(H).expect("held where it locks");
        held += u32::from(report.outcome == StepOutcome::Held);
        // One that was resumed a step ago takes another step.
        if let Some(mut other) = resumed.take() {
            other.step(H).expect("as the run");
            assert_eq!(other.state(), run.state(), "step {step}");
        }
        let checkpoint = Checkpoint::from_bytes(&bytes).expect("read");
        let mut other = Simulation::resume(hanging(&sheet), None, checkpoint).expect("resumed");
        assert_eq!(other.step(H).expect("as the run"), report, "step {step}");
        assert_eq!(other.state(), run.state(), "step {step}");
        resumed = Some(other);
    }
    assert!(held > 0);
}

#[test]
fn a_held_sheet_yields_neither_to_pins_nor_to_bodies() {
    let sheet = flat();
    // The pins move apart by a centimetre: no sheet that stays where it is follows them.
    let x = sheet.position(VertexId(24));
    let apart = move |t: f64| {
        let d = 0.01 * t;
        [x[0] + d, x[1] + d, x[2]]
    };
    let model = SheetModel::new(&sheet, 0.1, MassKind::Lumped)
        .and_then(|m| m.with_gravity().with_pins(&[VertexId(0)]))
        .and_then(|m| m.with_moving_pin(VertexId(24), apart))
        .expect("valid");
    let mut pulled = run(model, &sheet, Fallback::Hold);
    let error = (0..120).find_map(|_| pulled.step(H).err());
    assert!(error.is_some());
    // A plate at rest below changes nothing.
    let model = hanging(&sheet);
    let pose = |z: f64| Isometry3::translation(0.5, 0.5, z);
    let keys = [0.0, 1.0].map(|t| Keyframe {
        t,
        pose: pose(-0.9),
    });
    let plate = Shape::Cuboid {
        half: [1.0, 1.0, 0.01],
    };
    let contacts = Contacts::new(&model, ContactOptions::for_sheet(&model))
        .expect("valid")
        .with_body(
            Obstacle::new(plate, keys.to_vec()).expect("valid"),
            Coefficients::equal(0.3),
        )
        .expect("valid");
    let mut run = run(model, &sheet, Fallback::Hold)
        .with_contact(contacts)
        .expect("nothing touches");
    let held = (0..60)
        .map(|step| {
            let report = run.step(H);
            report.unwrap_or_else(|error| panic!("step {step}: {error}"))
        })
        .filter(|report| report.outcome == StepOutcome::Held)
        .inspect(|report| assert!(report.gap.is_none_or(|g| g > 0.0)))
        .count();
    assert!(held > 0);
}
