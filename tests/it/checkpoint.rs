//! Checkpoints: N steps, a checkpoint through a file, N more are 2 N steps, bit for bit.

use isosheet_charts::{ChartMethod, ChartOptions, ChartStepControl};
use isosheet_collide::{Coefficients, ContactOptions, Contacts, Obstacle, Shape};
use isosheet_coords::{CartesianChart, Chart, Choice, RodSystem};
use isosheet_dynamics::constraint::{Line, Plane, Side};
use isosheet_dynamics::contact::Contact;
use isosheet_dynamics::{
    Air, Checkpoint, CheckpointError, CreaseSprings, Fallback, ImplicitOptions, Method,
    PointProfile, Profile, RigidDisplacement, SheetModel, Simulation, SimulationError, State,
    StepControl, VertexConstraint,
};
use isosheet_mesh::{MassKind, Sheet, VertexId, generate};
use isosheet_tests::flag::Flag;
use isosheet_tests::{damped, methods};
use nalgebra::Isometry3;

const STEP: f64 = 1.0 / 120.0;
const STEPS: usize = 12;

/// How a checkpoint travels.
#[derive(Debug, Clone, Copy)]
enum Form {
    Binary,
    Json,
}

fn through_a_file(checkpoint: &Checkpoint, form: Form) -> Checkpoint {
    let folder = tempfile::tempdir().expect("a folder for temporary files");
    let path = folder.path().join("run.checkpoint");
    let bytes = match form {
        Form::Binary => checkpoint.to_bytes().expect("encoded"),
        Form::Json => checkpoint.to_json().expect("encoded").into_bytes(),
    };
    std::fs::write(&path, bytes).expect("written");
    let bytes = std::fs::read(&path).expect("read");
    match form {
        Form::Binary => Checkpoint::from_bytes(&bytes).expect("decoded"),
        Form::Json => {
            Checkpoint::from_json(std::str::from_utf8(&bytes).expect("text")).expect("decoded")
        }
    }
}

fn bits(state: &State) -> Vec<u64> {
    let values = [state.t].into_iter();
    let values = values
        .chain(state.x.iter().copied())
        .chain(state.v.iter().copied());
    values.map(f64::to_bits).collect()
}

/// Compares a resumed simulation of a chart-free method without contact, see [`compare_with`].
pub(super) fn compare(name: &str, start: impl Fn() -> Simulation, model: impl Fn() -> SheetModel) {
    compare_with(name, STEP, start, |checkpoint| {
        Simulation::resume(model(), None, checkpoint).expect("the same model")
    });
}

/// Runs `2 N` steps without interruption, and `N` steps, a checkpoint and `N` more steps; compares states,
/// reports, support forces and loads on bodies.
pub(super) fn compare_with(
    name: &str,
    h: f64,
    start: impl Fn() -> Simulation,
    resume: impl Fn(Checkpoint) -> Simulation,
) {
    for form in [Form::Binary, Form::Json] {
        let mut whole = start();
        let mut first = start();
        for _ in 0..STEPS {
            whole.step(h).expect("accepted");
            first.step(h).expect("accepted");
        }
        let checkpoint = first.checkpoint();
        drop(first);
        let read = through_a_file(&checkpoint, form);
        assert_eq!(read, checkpoint, "{name}, {form:?}");
        let mut second = resume(read);
        let same = |a: &Simulation, b: &Simulation, step: usize| {
            assert_eq!(
                bits(a.state()),
                bits(b.state()),
                "{name}, {form:?}, step {step}"
            );
            assert_eq!(
                a.reactions(),
                b.reactions(),
                "{name}, {form:?}, step {step}"
            );
            assert_eq!(
                a.body_loads(),
                b.body_loads(),
                "{name}, {form:?}, step {step}"
            );
            assert_eq!(
                a.energy().to_bits(),
                b.energy().to_bits(),
                "{name}, {form:?}, step {step}"
            );
        };
        same(&whole, &second, 0);
        for step in 1..=STEPS {
            let (a, b) = (whole.step(h), second.step(h));
            assert_eq!(a, b, "{name}, {form:?}, step {step}");
            same(&whole, &second, step);
        }
    }
}

/// A bumped square, far enough from flat for every method.
fn bumped(level: u32) -> Sheet {
    let flat = generate::isotropic_square(level, 0.2).expect("valid");
    let mut x = flat.positions().to_vec();
    for p in x.chunks_mut(3) {
        p[2] = 0.03 * (15.0 * p[0]).sin() * (13.0 * p[1]).cos();
    }
    Sheet::new(x, &flat.face_indices()).expect("valid")
}

fn plain(sheet: &Sheet) -> SheetModel {
    SheetModel::new(sheet, 3.5e-3, MassKind::Lumped)
        .expect("valid")
        .with_gravity()
        .with_damping(0.5)
        .expect("valid")
}

#[test]
fn a_hanging_sheet_goes_on_bit_for_bit() {
    let sheet = bumped(1);
    let model = || plain(&sheet).with_pins(&[VertexId(20)]).expect("exists");
    for (name, method) in methods() {
        let start = || {
            let state = State::at_rest(sheet.positions().to_vec());
            Simulation::new(model(), state, method.clone()).expect("valid")
        };
        compare(name, start, model);
    }
}

#[test]
fn so_do_drives_constraints_creases_and_a_fallback() {
    let sheet = bumped(1);
    let line = || Line::new(sheet.position(VertexId(0)), [0.1, 1.0, -0.3]).expect("valid");
    let low = sheet
        .positions()
        .iter()
        .skip(2)
        .step_by(3)
        .fold(f64::INFINITY, |m, z| m.min(*z));
    let floor = || Plane::new([0.0, 0.0, low - 2e-3], [0.0, 0.0, 1.0]).expect("valid");
    let creases = |s: &Sheet| CreaseSprings::bending(s, 1e-4).expect("valid");
    for (name, method) in methods() {
        let is_damped = matches!(method, Method::Bdf2(_) | Method::ImplicitEuler(_));
        let corner = sheet.position(VertexId(20));
        let model = || {
            let mut model = plain(&sheet)
                .with_potential(creases(&sheet))
                .with_moving_pin(VertexId(20), move |t: f64| {
                    [corner[0], corner[1], corner[2] - 0.004 * (9.0 * t).sin()]
                })
                .and_then(|m| m.with_constraint(VertexConstraint::on_curve(VertexId(0), line())))
                .expect("exists");
            if is_damped {
                let side = VertexConstraint::on_surface(VertexId(4), floor(), Side::Outside);
                model = model.with_constraint(side).expect("exists");
            }
            model
        };
        let control = StepControl {
            fallback: Fallback::ImplicitEuler(ImplicitOptions::default()),
            ..StepControl::default()
        };
        let start = || {
            let state = State::at_rest(sheet.positions().to_vec());
            Simulation::new(model(), state, method.clone())
                .and_then(|s| s.with_control(control.clone()))
                .expect("valid")
        };
        compare(name, start, model);
    }
}

#[test]
fn a_sheet_in_gusts_goes_on_bit_for_bit() {
    let sheet = bumped(1);
    let gusts = |mean: f64, frequency: f64| Profile::Sine {
        mean,
        amplitude: 3.0,
        frequency,
        phase: 0.3,
    };
    let model = || {
        let wind = [gusts(4.0, 2.0), gusts(0.0, 3.1), 0.5.into()].into();
        let air = Air {
            wind,
            ..Air::default()
        };
        let pinned = plain(&sheet).with_pins(&[VertexId(20)]).expect("exists");
        pinned.with_air(air).expect("valid")
    };
    for (name, method) in methods() {
        let start = || {
            let state = State::at_rest(sheet.positions().to_vec());
            Simulation::new(model(), state, method.clone()).expect("valid")
        };
        compare(name, start, model);
    }
}

/// The wake, the circulation and its rate of change are part of a checkpoint.
#[test]
fn a_flag_in_attached_flow_goes_on_bit_for_bit() {
    let flag = Flag {
        height: 0.1,
        mass: 0.3,
        wind: 30.0,
    };
    let model = || flag.model([6, 2]).0;
    compare("attached flow", || flag.simulation([6, 2]), model);
}

#[test]
fn a_flat_start_and_held_vertices_survive() {
    let sheet = generate::isotropic_square(2, 0.2).expect("valid");
    let model = || {
        plain(&sheet)
            .with_pins(&[VertexId(0), VertexId(8)])
            .expect("exist")
    };
    let start = || {
        let state = State::at_rest(sheet.positions().to_vec());
        Simulation::new(model(), state, Method::default()).expect("valid")
    };
    compare("flat", start, model);
}

#[test]
fn other_sheets_versions_and_damage_are_refused() {
    let sheet = bumped(1);
    let state = State::at_rest(sheet.positions().to_vec());
    let run = Simulation::new(plain(&sheet), state, Method::default()).expect("valid");
    let checkpoint = run.checkpoint();
    let refused = |model: SheetModel| match Simulation::resume(model, None, checkpoint.clone()) {
        Err(SimulationError::Checkpoint(error)) => error,
        Err(error) => panic!("another error: {error}"),
        Ok(_) => panic!("resumed with another model"),
    };
    let finer = refused(plain(&bumped(2)));
    assert!(
        matches!(
            finer,
            CheckpointError::OtherSize {
                expected: [25, 56],
                ..
            }
        ),
        "{finer}"
    );
    let flat = generate::isotropic_square(1, 0.2).expect("valid");
    let other = refused(plain(&flat));
    assert_eq!(
        other,
        CheckpointError::OtherSheet {
            what: "rest lengths or isometry"
        }
    );
    let pinned = refused(plain(&sheet).with_pins(&[VertexId(3)]).expect("exists"));
    assert_eq!(
        pinned,
        CheckpointError::OtherSheet {
            what: "pins or vertex constraints"
        }
    );

    let bytes = checkpoint.to_bytes().expect("encoded");
    let with = |at: usize, change: u8| {
        let mut bytes = bytes.clone();
        bytes[at] ^= change;
        Checkpoint::from_bytes(&bytes).expect_err("damaged")
    };
    assert!(matches!(with(0, 1), CheckpointError::NoCheckpoint { .. }));
    assert!(matches!(
        with(8, 1),
        CheckpointError::Version {
            found: 20,
            supported: 21
        }
    ));
    // Every other byte is under the checksum, the checksum included.
    for at in (12..bytes.len()).step_by(97).chain([bytes.len() - 1]) {
        assert!(
            matches!(with(at, 0x10), CheckpointError::Damaged { .. }),
            "byte {at}"
        );
    }
    for length in 0..64 {
        assert!(Checkpoint::from_bytes(&bytes[..length]).is_err());
    }
    let text = checkpoint.to_json().expect("encoded");
    let other = text.replacen("\"version\":21", "\"version\":9", 1);
    assert_eq!(
        Checkpoint::from_json(&other),
        Err(CheckpointError::Version {
            found: 9,
            supported: 21
        })
    );
    assert!(matches!(
        Checkpoint::from_json(&text[1..]),
        Err(CheckpointError::Decode(_))
    ));
}

/// A table under a sheet, a ball that comes up from below beside it, friction, and the sheet itself.
fn contacts(model: &SheetModel) -> Contacts {
    let table = Shape::Cuboid {
        half: [0.03, 0.03, 0.01],
    };
    let table = Obstacle::fixed(table, Isometry3::translation(0.1, 0.1, -0.0305)).expect("valid");
    let ball = Profile::Ramp {
        from: 0.0,
        to: 0.03,
        begin: 0.0,
        end: 0.15,
    };
    let ball = RigidDisplacement {
        pose: Isometry3::translation(0.03, 0.05, -0.07),
        x: Profile::default(),
        y: Profile::default(),
        z: ball,
        rotation: None,
    };
    let ball = Obstacle::new(Shape::Sphere { radius: 0.02 }, ball).expect("valid");
    Contacts::new(model, ContactOptions::for_sheet(model))
        .and_then(|c| c.with_body(table, Coefficients::equal(0.3)))
        .and_then(|c| c.with_body(ball, Coefficients::equal(0.2)))
        .and_then(|c| c.with_self_contact(Coefficients::equal(0.1)))
        .expect("valid")
}

#[test]
fn contact_friction_and_self_contact_go_on_bit_for_bit() {
    for level in [1, 2] {
        let sheet = generate::isotropic_square(level, 0.2).expect("valid");
        let model = || plain(&sheet);
        for (name, method) in damped() {
            let start = || {
                let mut state = State::at_rest(sheet.positions().to_vec());
                state
                    .x
                    .iter_mut()
                    .skip(2)
                    .step_by(3)
                    .for_each(|z| *z = -0.015);
                let contacts = contacts(&model());
                let mut simulation = Simulation::new(model(), state, method.clone())
                    .and_then(|s| s.with_contact(contacts))
                    .expect("nothing touches");
                // On until the sheet rubs on table and ball.
                for _ in 0..16 {
                    simulation.step(STEP).expect("accepted");
                }
                simulation
            };
            let pressed = start().body_loads();
            assert!(pressed.iter().any(|load| load.force.norm() > 0.0), "{name}");
            compare_with(name, STEP, start, |checkpoint| {
                let contacts: Box<dyn Contact> = Box::new(contacts(&model()));
                Simulation::resume(model(), Some(contacts), checkpoint).expect("the same scene")
            });
        }
    }
}

#[test]
fn charts_go_on_bit_for_bit() {
    let sheet = bumped(1);
    let controls = [
        ChartStepControl::Fixed(1e-3),
        ChartStepControl::Adaptive {
            tolerance: 1e-5,
            min: 1e-8,
            max: 5e-3,
        },
    ];
    for control in controls {
        for method in [ChartMethod::ForwardEuler, ChartMethod::RungeKutta4] {
            let options = ChartOptions {
                method,
                control,
                // Rebased often.
                growth_limit: 1.05,
                condition_interval: 7,
                ..ChartOptions::default()
            };
            let pins = [VertexId(20)];
            let model = || plain(&sheet).with_pins(&pins).expect("exists");
            let chart = || -> Box<dyn Chart> {
                let system = RodSystem::new(&sheet, &pins).expect("valid");
                let chart = CartesianChart::new(system, Choice::Auto, sheet.positions());
                Box::new(chart.expect("not flat"))
            };
            let start = || {
                let state = State::at_rest(sheet.positions().to_vec());
                isosheet_charts::in_chart(model(), state, chart(), options).expect("valid")
            };
            compare_with(
                &format!("{method:?}, {control:?}"),
                STEP,
                start,
                |checkpoint| {
                    isosheet_charts::resume_in_chart(model(), chart(), checkpoint)
                        .expect("the same")
                },
            );
        }
    }
}

#[test]
fn charts_with_closures_and_drives_go_on_bit_for_bit() {
    let sheet = bumped(1);
    let corner = sheet.position(VertexId(20));
    let swing = Profile::Sine {
        mean: 0.0,
        amplitude: 2e-3,
        frequency: 3.0,
        phase: 0.0,
    };
    let swing = PointProfile {
        offset: corner,
        x: Profile::default(),
        y: Profile::default(),
        z: swing,
    };
    let model = || {
        let line = Line::new(sheet.position(VertexId(0)), [0.1, 1.0, -0.3]).expect("valid");
        plain(&sheet)
            .with_moving_pin(VertexId(20), swing.clone())
            .and_then(|m| m.with_constraint(VertexConstraint::on_curve(VertexId(0), line)))
            .expect("exists")
    };
    let chart = || -> Box<dyn Chart> {
        let system = RodSystem::new(&sheet, &[]).expect("valid");
        let chart = CartesianChart::new(system, Choice::Auto, sheet.positions());
        Box::new(chart.expect("not flat"))
    };
    let start = || {
        let state = State::at_rest(sheet.positions().to_vec());
        isosheet_charts::in_chart(model(), state, chart(), ChartOptions::default()).expect("valid")
    };
    compare_with("closures", STEP / 8.0, start, |checkpoint| {
        isosheet_charts::resume_in_chart(model(), chart(), checkpoint).expect("the same")
    });
    let checkpoint = start().checkpoint();
    let error = Simulation::resume(model(), None, checkpoint.clone()).err();
    let found = "a chart".to_owned();
    let expected = SimulationError::Checkpoint(CheckpointError::Engine { found });
    assert_eq!(error, Some(expected));
}
