//! Prescribed motions whose function returns values that are not finite: the error names the body or pin, the
//! time and the value.

use isosheet_charts::{
    ChartDynamicsError, ChartMethod, ChartOptions, ChartSimulation, ChartStepControl,
};
use isosheet_collide::{Coefficients, ContactOptions, Contacts, Obstacle, Shape};
use isosheet_coords::{CartesianChart, Chart, Choice, RodSystem};
use isosheet_dynamics::contact::{BodyMotionError, ContactError};
use isosheet_dynamics::{
    Method, RigidMotion, SheetModel, Simulation, SimulationError, State, StepError, Support,
};
use isosheet_mesh::{MassKind, Sheet, VertexId, generate};
use nalgebra::{Isometry3, Quaternion, UnitQuaternion, Vector3};

/// Time until which the motions are finite, seconds; no step ends there.
const GOOD_UNTIL: f64 = 0.055;
const STEP: f64 = 0.01;

/// Rest at a height (metres) until [`GOOD_UNTIL`]; then a component of the pose has the value: 0 to 2 of the
/// translation, 3 to 6 of the rotation.
fn breaking(height: f64, component: usize, value: f64) -> RigidMotion {
    let function = move |t: f64| {
        let mut place = Vector3::new(0.5, 0.5, height);
        let mut turn = Quaternion::identity();
        if t > GOOD_UNTIL {
            match component {
                0..3 => place[component] = value,
                _ => turn.coords[component - 3] = value,
            }
        }
        Isometry3::from_parts(place.into(), UnitQuaternion::new_unchecked(turn))
    };
    function.into()
}

/// Contact with a floor far below, body 0, and a body in the given motion, body 1.
fn contacts(model: &SheetModel, shape: Shape, motion: RigidMotion) -> Contacts {
    let floor = Obstacle::fixed(Shape::HalfSpace, Isometry3::translation(0.0, 0.0, -10.0));
    let options = ContactOptions {
        activation: 1e-3,
        ..ContactOptions::for_sheet(model)
    };
    Contacts::new(model, options)
        .and_then(|c| c.with_body(floor?, Coefficients::FRICTIONLESS))
        .and_then(|c| c.with_body(Obstacle::new(shape, motion)?, Coefficients::equal(0.3)))
        .and_then(|c| c.with_self_contact(Coefficients::equal(0.3)))
        .expect("valid")
}

fn sheet() -> (SheetModel, State) {
    let sheet = generate::isotropic_square(1, 1.0).expect("valid");
    let model = SheetModel::new(&sheet, 0.1, MassKind::Lumped).expect("valid");
    (
        model.with_gravity(),
        State::at_rest(sheet.positions().to_vec()),
    )
}

fn is_finite(state: &State) -> bool {
    state.x.iter().chain(&state.v).all(|c| c.is_finite())
}

fn check(error: BodyMotionError, value: f64, t: f64) {
    assert_eq!((error.body, error.value.to_bits()), (1, value.to_bits()));
    assert!((error.t - t).abs() < 1e-12, "{error}");
    let text = error.to_string();
    assert!(
        text.contains("body 1") && text.contains(&value.to_string()),
        "{text}"
    );
}

fn shapes() -> [Shape; 5] {
    [
        Shape::HalfSpace,
        Shape::Sphere { radius: 0.1 },
        Shape::Cuboid { half: [0.1; 3] },
        Shape::Cylinder {
            radius: 0.1,
            half_height: 0.1,
        },
        Shape::Capsule {
            radius: 0.1,
            half_length: 0.1,
        },
    ]
}

#[test]
fn a_pose_that_is_not_finite_ends_the_step_and_keeps_the_state() {
    for shape in shapes() {
        for (component, value) in [(0, f64::NAN), (2, f64::INFINITY), (5, f64::NAN)] {
            for method in [
                Method::Bdf2(Default::default()),
                Method::ImplicitEuler(Default::default()),
            ] {
                let (model, start) = sheet();
                // Below the flat sheet, out of reach at first.
                let contacts = contacts(&model, shape.clone(), breaking(-0.21, component, value));
                let mut run = Simulation::new(model, start, method)
                    .and_then(|run| run.with_contact(contacts))
                    .expect("free");
                for _ in 0..5 {
                    run.step(STEP).expect("accepted");
                }
                let before = run.state().clone();
                for _ in 0..2 {
                    let Err(StepError::Body(error)) = run.step(STEP) else {
                        panic!("{shape:?}: not refused");
                    };
                    check(error, value, 6.0 * STEP);
                    assert_eq!(run.state(), &before);
                    assert!(is_finite(run.state()));
                }
            }
        }
    }
}

#[test]
fn a_pose_that_is_not_finite_at_the_start_is_refused() {
    for shape in shapes() {
        let (model, mut start) = sheet();
        start.t = 1.0;
        let contacts = contacts(&model, shape, breaking(-0.21, 1, f64::NEG_INFINITY));
        let run = Simulation::new(model, start, Method::default()).expect("valid");
        let Err(SimulationError::Contact(ContactError::Motion(error))) = run.with_contact(contacts)
        else {
            panic!("not refused");
        };
        check(error, f64::NEG_INFINITY, 1.0);
    }
}

/// A triangle in free fall, in a chart with steps of [`STEP`] / 10.
fn triangle() -> (SheetModel, State, Box<dyn Chart>, ChartOptions) {
    let x = vec![0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.3, 0.8, 0.0];
    let sheet = Sheet::new(x.clone(), &[[0, 1, 2]]).expect("a triangle");
    let model = SheetModel::new(&sheet, 0.1, MassKind::Lumped).expect("valid");
    let system = RodSystem::from_parts(model.topology(), model.rods().lengths(), &[]);
    let chart = CartesianChart::new(system.expect("vertices exist"), Choice::Auto, &x);
    let options = ChartOptions {
        method: ChartMethod::RungeKutta4,
        control: ChartStepControl::Fixed(0.1 * STEP),
        ..Default::default()
    };
    (
        model.with_gravity(),
        State::at_rest(x),
        Box::new(chart.expect("regular")),
        options,
    )
}

#[test]
fn a_pin_that_is_not_finite_ends_the_step_in_a_chart() {
    let (model, start, chart, options) = triangle();
    let pin = |t: f64| [if t > GOOD_UNTIL { f64::NAN } else { 0.0 }, 0.0, 0.0];
    let model = model.with_moving_pin(VertexId(0), pin).expect("exists");
    let mut run = ChartSimulation::from_state(model, chart, options, &start).expect("valid");
    let error = (0..100).find_map(|_| run.step().err());
    assert!(
        matches!(
            error,
            Some(ChartDynamicsError::Motion { support: Support::Pin(VertexId(0)), value, t })
                if value.is_nan() && t > GOOD_UNTIL && t < GOOD_UNTIL + 0.1 * STEP
        ),
        "{error:?}"
    );
    assert!(run.positions().iter().all(|c| c.is_finite()));
}
