//! The mechanics of contact against closed forms.

use crate::watch::Watch;
use isosheet_collide::{Coefficients, ContactOptions, Contacts, Keyframe, Obstacle, Shape};
use isosheet_dynamics::contact::internals::{BarrierPotential, ContactSet, Course, LaggedFriction};
use isosheet_dynamics::contact::{ActiveContacts, BodyMotions, Contact, JointMotion, StepSpan};
use isosheet_dynamics::{ImplicitOptions, Method, SheetModel, Simulation, State};
use isosheet_mesh::{MassKind, Sheet, generate};
use nalgebra::{Isometry3, Point3, UnitQuaternion, Vector3};

const G: f64 = 9.8;
/// Mass of the plate, kilograms.
const MASS: f64 = 0.2;

/// A slope that rises along -x by the angle `theta` (radians): z of its frame is its normal and x
/// points down it.
fn slope(theta: f64) -> Isometry3<f64> {
    let turn = UnitQuaternion::from_axis_angle(&Vector3::y_axis(), theta);
    Isometry3::from_parts([0.3, -0.2, 0.1].into(), turn)
}

/// A rigid plate of three rods on a slope, moving down it at `speed` (metres per second), with a
/// speed that counts as rest.
fn plate(
    theta: f64,
    coefficients: Coefficients,
    speed: f64,
    rest_speed: f64,
    friction_tolerance: f64,
) -> (Simulation, Watch) {
    let flat = Sheet::new(
        vec![0.0, 0.0, 0.0, 0.1, 0.0, 0.0, 0.05, 0.08, 0.0],
        &[[0, 1, 2]],
    );
    let flat = flat.expect("a triangle");
    let model = SheetModel::new(&flat, MASS, MassKind::Lumped)
        .expect("valid")
        .with_gravity();
    let options = ContactOptions {
        rest_speed,
        ..ContactOptions::for_sheet(&model)
    };
    let pose = slope(theta);
    let lifted = |gap: f64| {
        let place = |p: &[f64; 3]| (pose * (Point3::from(*p) + Vector3::z() * gap)).into();
        let x = flat.positions().as_chunks::<3>().0.iter();
        State::at_rest(x.flat_map::<[f64; 3], _>(place).collect())
    };
    let mut contacts = Contacts::new(&model, options)
        .and_then(|c| c.with_body(Obstacle::fixed(Shape::HalfSpace, pose)?, coefficients))
        .expect("valid");
    // Start where the barrier carries the weight: a plate that bounces slips.
    let [mut low, mut high] = [0.1, 1.0].map(|part| part * options.activation);
    for _ in 0..60 {
        let middle = 0.5 * (low + high);
        let state = lifted(middle);
        contacts
            .check_start(&model, &state)
            .expect("nothing touches");
        let barrier = BarrierPotential::at_start(contacts.laws(), &model, &state).expect("valid");
        let active = ActiveContacts::at_rest(&mut contacts, state.t, &state.x);
        let mut force = [0.0; 9];
        active.add_barrier_gradient(&barrier, -1.0, &mut force);
        let carried = force[2] + force[5] + force[8];
        let normal = carried / theta.cos();
        *(if normal > MASS * G * theta.cos() {
            &mut low
        } else {
            &mut high
        }) = middle;
    }
    let down = pose * Vector3::x() * speed;
    let start = State {
        v: [down.x, down.y, down.z].repeat(3),
        ..lifted(low)
    };
    let watch = Watch::new(&model, &contacts);
    let method = Method::Bdf2(ImplicitOptions {
        friction_tolerance,
        ..ImplicitOptions::default()
    });
    let simulation = Simulation::new(model, start, method).expect("valid");
    (
        simulation.with_contact(contacts).expect("nothing touches"),
        watch,
    )
}

/// Velocity down the slope of every vertex of the plate, metres per second.
fn speeds(simulation: &Simulation, theta: f64) -> [f64; 3] {
    let down = slope(theta) * Vector3::x();
    std::array::from_fn(|i| {
        down.dot(&Vector3::from_column_slice(
            &simulation.state().v[3 * i..3 * i + 3],
        ))
    })
}

const STEP: f64 = 1.0 / 240.0;

/// Tolerance of friction with which the laws of friction are tested: just above the friction angle the
/// acceleration is a hundredth of the friction.
const EXACT: f64 = 1e-9;

/// Static and kinetic coefficient; the friction angle of the static one is 26.6 degrees.
const TWO: Coefficients = Coefficients {
    rest: 0.5,
    sliding: 0.3,
};

#[test]
fn below_the_friction_angle_a_plate_sticks() {
    // Smoothed friction balances the pull at the creep speed v with mu (2 - v/e) v/e = tan theta:
    // proportional to the speed e that counts as rest, and there is no other motion.
    for coefficients in [Coefficients::equal(0.5), TWO] {
        for rest_speed in [1e-3, 1e-5] {
            let theta = (0.99_f64 * coefficients.rest).atan();
            let creep = rest_speed * (1.0 - 0.01_f64.sqrt());
            let (mut simulation, mut watch) = plate(theta, coefficients, 0.0, rest_speed, EXACT);
            for _ in 0..240 {
                watch.step(&mut simulation, STEP);
            }
            for v in speeds(&simulation, theta) {
                assert!((v / creep - 1.0).abs() < 1e-6, "{v} m/s, expected {creep}");
            }
        }
    }
}

#[test]
fn friction_is_as_exact_as_its_tolerance() {
    // Friction forces are off by the tolerance at most, on average over a second by far less.
    let theta = f64::atan(1.0);
    let coefficients = Coefficients::equal(0.5);
    for tolerance in [1e-2, ImplicitOptions::default().friction_tolerance, 1e-5] {
        let (mut simulation, mut watch) = plate(theta, coefficients, 0.0, 1e-5, tolerance);
        for _ in 0..240 {
            watch.step(&mut simulation, STEP);
        }
        let friction = 0.5 * G * theta.cos();
        let expected = G * theta.sin() - friction;
        for v in speeds(&simulation, theta) {
            let error = (v / (240.0 * STEP) - expected).abs() / friction;
            assert!(error < tolerance, "{tolerance}: {error}");
        }
    }
}

#[test]
fn above_the_friction_angle_a_plate_slides() {
    // One percent beyond the static coefficient, well beyond it, and beyond the kinetic one only but
    // already in motion: a = g (sin theta - mu cos theta).
    let one = Coefficients::equal(0.5);
    let scenes = [
        (one, 1.01 * 0.5, 0.0),
        (one, 1.0, 0.0),
        (TWO, 1.01 * 0.5, 0.0),
        (TWO, 0.4, 0.5),
        (Coefficients::FRICTIONLESS, 0.5, 0.0),
    ];
    for (coefficients, tangent, speed) in scenes {
        let theta = f64::atan(tangent);
        let expected = G * (theta.sin() - coefficients.sliding * theta.cos());
        let (mut simulation, mut watch) = plate(theta, coefficients, speed, 1e-5, EXACT);
        let mut before = [0.0; 3];
        let mut loss = [0.0; 2];
        for n in 0..240 {
            if n == 120 {
                before = speeds(&simulation, theta);
            }
            let report = watch.step(&mut simulation, STEP);
            if n == 119 {
                loss[0] = report.friction;
            }
            if n == 239 {
                loss[1] = report.friction;
            }
        }
        let after = speeds(&simulation, theta);
        for (a, b) in after.iter().zip(before) {
            let found = (a - b) / (120.0 * STEP);
            assert!(
                (found / expected - 1.0).abs() < 1e-6,
                "{found} m/s2, expected {expected}"
            );
        }
        // The heat is the force of friction times the distance, and the slope carries both forces.
        let distance = 0.5 * (after[0] + before[0]) * 120.0 * STEP;
        let normal = MASS * G * theta.cos();
        let heat = coefficients.sliding * normal * distance;
        assert!(
            (loss[1] - loss[0] - heat).abs() < 1e-6,
            "heat {loss:?} J, expected {heat}"
        );
        let load = slope(theta).inverse() * simulation.body_loads()[0].force;
        let expected = Vector3::new(coefficients.sliding * normal, 0.0, -normal);
        assert!(
            (load - expected).norm() < 1e-6 * normal,
            "load {load}, expected {expected}"
        );
    }
}

#[test]
fn a_plate_that_slides_in_stops_where_friction_says() {
    // On the level v^2 / (2 mu g), whatever the static coefficient.
    for coefficients in [Coefficients::equal(0.3), TWO] {
        let (mut simulation, mut watch) = plate(0.0, coefficients, 0.9, 1e-5, EXACT);
        let start = simulation.state().x[0];
        for _ in 0..120 {
            watch.step(&mut simulation, STEP);
        }
        let distance = simulation.state().x[0] - start;
        let expected = 0.9 * 0.9 / (2.0 * 0.3 * G);
        assert!(
            (distance / expected - 1.0).abs() < 1e-3,
            "{distance} m, expected {expected}"
        );
        assert!(speeds(&simulation, 0.0).iter().all(|v| v.abs() < 1e-5));
    }
}

/// A tilted strip of five panels falls on a floor whose barrier reaches a centimetre high, so that a
/// step can follow it. Returns the energy that friction and damping do not account for at the end and
/// at most, as a share of the energy released.
fn drop(h: f64, coefficients: Coefficients, damping: f64) -> [f64; 2] {
    let turn = UnitQuaternion::from_euler_angles(0.13, 0.31, 0.0);
    let flat = generate::strip(4, 0.2, 0.05, generate::Diagonals::Rising).expect("valid");
    let x: Vec<f64> = flat
        .positions()
        .as_chunks::<3>()
        .0
        .iter()
        .flat_map(|p| {
            let q = turn * (Point3::from(*p) - Vector3::new(0.1, 0.025, 0.0)) + Vector3::z() * 0.06;
            [q.x, q.y, q.z]
        })
        .collect();
    let model = SheetModel::new(&flat, MASS, MassKind::Lumped)
        .expect("valid")
        .with_gravity();
    let model = model.with_damping(damping).expect("valid");
    let options = ContactOptions {
        activation: 0.01,
        ..ContactOptions::for_sheet(&model)
    };
    let contacts = Contacts::new(&model, options)
        .and_then(|c| {
            c.with_body(
                Obstacle::fixed(Shape::HalfSpace, Isometry3::identity())?,
                coefficients,
            )
        })
        .expect("valid");
    let mut watch = Watch::new(&model, &contacts);
    let simulation = Simulation::new(model, State::at_rest(x), Method::default()).expect("valid");
    let mut simulation = simulation.with_contact(contacts).expect("nothing touches");
    let released = MASS * G * 0.06;
    let mut drift = 0.0;
    let mut most = 0.0_f64;
    for _ in 0..(0.15 / h).round() as usize {
        let report = watch.step(&mut simulation, h);
        most = most.max(report.energy_drift);
        drift = report.energy_drift;
    }
    [drift, most].map(|d| d / released)
}

#[test]
fn a_dropped_sheet_loses_what_friction_and_damping_take() {
    let steps = [1e-3, 5e-4, 2.5e-4, 1.25e-4];
    for (damping, order) in [(0.0, 2.0), (2.0, 2.0)] {
        let drifts = steps.map(|h| drop(h, Coefficients::FRICTIONLESS, damping));
        assert!(drifts.iter().all(|[_, most]| *most < 1e-9), "{drifts:?}");
        let ratios = drifts.windows(2).map(|w| (w[0][0] / w[1][0]).log2());
        assert!(ratios.clone().all(|r| r > order), "{drifts:?}");
        assert!(drifts[3][0] > -3e-4, "{drifts:?}");
    }
    // Friction jumps with the direction of sliding, which costs an order.
    for damping in [0.0, 2.0] {
        let drifts = steps.map(|h| drop(h, Coefficients::equal(0.4), damping));
        assert!(drifts.iter().all(|[_, most]| *most < 1e-4), "{drifts:?}");
        let ratios = drifts.windows(2).map(|w| w[0][0] / w[1][0]);
        assert!(ratios.clone().all(|r| r > 1.5), "{drifts:?}");
        assert!(drifts[3][0] < 0.0 && drifts[3][0] > -2e-3, "{drifts:?}");
    }
}

/// A floor that moves sideways at a constant speed drags a plate along by friction. Half of the floor's
/// work is lost to friction and half is kinetic energy in the end, `W = m v^2`.
#[test]
fn a_conveyor_does_work_by_friction() {
    const SPEED: f64 = 0.5;
    let flat = generate::isotropic_square(1, 0.2).expect("valid");
    let model = SheetModel::new(&flat, MASS, MassKind::Lumped)
        .expect("valid")
        .with_gravity();
    let options = ContactOptions::for_sheet(&model);
    let key = |t: f64| Keyframe {
        t,
        pose: Isometry3::translation(SPEED * t, 0.0, -0.95 * options.activation),
    };
    let belt = Obstacle::new(Shape::HalfSpace, vec![key(0.0), key(1.0)]).expect("valid");
    let contacts = Contacts::new(&model, options)
        .and_then(|c| c.with_body(belt, Coefficients::equal(0.5)))
        .expect("valid");
    let mut watch = Watch::new(&model, &contacts);
    let start = State::at_rest(flat.positions().to_vec());
    let mut simulation = Simulation::new(model, start, Method::default())
        .and_then(|s| s.with_contact(contacts))
        .expect("valid");
    let mut last = watch.step(&mut simulation, 1.0 / 480.0);
    while last.t < 0.3 {
        last = watch.step(&mut simulation, 1.0 / 480.0);
    }
    let work = MASS * SPEED * SPEED;
    assert!((last.work / work - 1.0).abs() < 0.02, "{last:?}");
    assert!((last.friction / work - 0.5).abs() < 0.02, "{last:?}");
    assert!((last.kinetic / work - 0.5).abs() < 0.01, "{last:?}");
    assert!(last.energy_drift.abs() < 0.02 * work, "{last:?}");
}

/// What is kept to resume a run comes back to the last bit: the barrier, and the friction of the step.
#[test]
fn barrier_and_lagged_friction_survive_a_file() {
    let flat = generate::isotropic_square(1, 0.2).expect("valid");
    let model = SheetModel::new(&flat, MASS, MassKind::Lumped)
        .expect("valid")
        .with_gravity();
    let options = ContactOptions::for_sheet(&model);
    let floor = Isometry3::translation(0.0, 0.0, -0.7 * options.activation);
    let mut contacts = Contacts::new(&model, options)
        .and_then(|c| {
            c.with_body(
                Obstacle::fixed(Shape::HalfSpace, floor)?,
                Coefficients::equal(0.5),
            )
        })
        .expect("valid");
    let start = State::at_rest(flat.positions().to_vec());
    let barrier = BarrierPotential::at_start(contacts.laws(), &model, &start).expect("valid");
    let span = StepSpan { t0: 0.0, h: 0.01 };
    let bodies = BodyMotions::over(&contacts, span);
    let motion = JointMotion {
        bodies: &bodies,
        progress: [1.0; 2],
        x: &start.x,
        dx: &vec![0.0; start.x.len()],
    };
    let set = ContactSet::of(&mut contacts, motion);
    let active = ActiveContacts::at(&contacts, &set, 1.0, &start.x);
    let mut friction = LaggedFriction::none();
    friction.lag(
        contacts.laws(),
        &barrier,
        &active,
        Course::from_start(&start.x, span.h),
        &start.x,
    );
    assert_eq!(friction.contacts().len(), 25);
    let text = serde_json::to_string(&(barrier, &friction)).expect("finite");
    let back: (BarrierPotential, LaggedFriction) = serde_json::from_str(&text).expect("readable");
    assert_eq!(back, (barrier, friction));
}
