//! Vertices on curves and surfaces, moving pins, and the forces of these supports.

use isosheet_dynamics::constraint::{Circle, Line, Plane, Side, Sphere};
use isosheet_dynamics::{
    Driver, ImplicitOptions, Method, Profile, RigidDisplacement, SheetModel, Simulation,
    SimulationError, State, StepControl, StepError, Support, Unsatisfiable, VertexConstraint,
};
use isosheet_mesh::{MassKind, Sheet, VertexId, generate};
use isosheet_tests::{HangingStrip, Pendulum, max_difference, orders};
use nalgebra::Vector3;
use std::f64::consts::{FRAC_PI_2, TAU};

const G: f64 = 9.8;

fn tight() -> ImplicitOptions {
    ImplicitOptions {
        tolerance: Some(1e-12),
        ..Default::default()
    }
}

fn damped() -> [Method; 2] {
    [Method::Bdf2(tight()), Method::ImplicitEuler(tight())]
}

fn conservative() -> [Method; 3] {
    [
        Method::EnergyMomentum(Default::default()),
        Method::Rattle(Default::default()),
        Method::RattleComposition(Default::default()),
    ]
}

fn every() -> impl Iterator<Item = Method> {
    damped().into_iter().chain(conservative())
}

fn triangle(mass: f64) -> (Sheet, SheetModel) {
    let sheet = Sheet::new(
        vec![0.0, 0.0, 0.0, 0.3, 0.0, 0.0, 0.1, 0.25, 0.0],
        &[[0, 1, 2]],
    )
    .expect("a triangle");
    let model = SheetModel::new(&sheet, mass, MassKind::Lumped).expect("valid");
    (sheet, model)
}

fn sum(simulation: &Simulation) -> Vector3<f64> {
    simulation.reactions().iter().map(|r| r.force).sum()
}

#[test]
fn a_hanging_strip_at_rest_weighs_what_it_weighs() {
    let strip = HangingStrip {
        rows: 5,
        spacing: 0.2,
        gravity: G,
        amplitude: 0.0,
        mode: 0,
    };
    for method in every() {
        let name = format!("{method:?}");
        let mut simulation = Simulation::new(strip.model(), strip.start(), method).expect("valid");
        for _ in 0..20 {
            simulation.step(0.01).expect("at rest");
        }
        let weight = 12.0 * 0.01 * G;
        let error = (sum(&simulation) - Vector3::new(0.0, 0.0, weight)).norm() / weight;
        assert!(error < 1e-9, "{name}: {error:e}");
        assert_eq!(simulation.reactions().len(), 2);
    }
}

#[test]
fn the_tension_of_a_pendulum_is_centripetal_force_and_weight() {
    let pendulum = Pendulum::default();
    let m = 0.1;
    for method in conservative().into_iter().chain([Method::Bdf2(tight())]) {
        let name = format!("{method:?}");
        let mean = !matches!(method, Method::Bdf2(_));
        let mut simulation =
            Simulation::new(pendulum.model(), pendulum.start(), method).expect("valid");
        let steps = 1000;
        let h = 0.5 * pendulum.period() / f64::from(steps);
        let mut worst = 0.0_f64;
        for k in 0..steps {
            simulation.step(h).expect("accepted");
            if k < 2 {
                continue;
            }
            let t = simulation.state().t - if mean { 0.5 * h } else { 0.0 };
            let x = pendulum.exact(t);
            let z = x[8];
            let (c, height) = (
                -z / pendulum.length,
                z + pendulum.length * pendulum.amplitude.cos(),
            );
            let speed = (-2.0 * pendulum.gravity * height).max(0.0);
            let tension = m * speed / pendulum.length + m * pendulum.gravity * c;
            let along = Vector3::new(x[6], 0.0, z) / pendulum.length;
            // The pins carry the weights of their own vertices too.
            let rest = Vector3::new(0.0, 0.0, 2.0 * m * pendulum.gravity);
            let want = rest - tension * along;
            worst = worst.max((sum(&simulation) - want).norm());
        }
        assert!(
            worst < 2e-4 * m * pendulum.gravity * 5.0,
            "{name}: {worst:e} N"
        );
    }
}

#[test]
fn a_sheet_slides_down_a_line_at_g_sin() {
    let slope = 0.6_f64;
    let along = [slope.cos(), 0.0, -slope.sin()];
    for method in every() {
        let name = format!("{method:?}");
        let order_one = matches!(method, Method::ImplicitEuler(_));
        let (sheet, mut model) = triangle(0.3);
        // Two vertices are on parallel lines and one is on the plane through these lines. The triangle
        // slides without turning, and no equation depends on the others.
        for v in 0..2 {
            let line = Line::new(sheet.position(VertexId(v)), along).expect("valid");
            model = model
                .with_constraint(VertexConstraint::on_curve(VertexId(v), line))
                .expect("exists");
        }
        let plane = Plane::new(sheet.position(VertexId(2)), [slope.sin(), 0.0, slope.cos()]);
        let plane = VertexConstraint::on_surface(VertexId(2), plane.expect("valid"), Side::On);
        model = model.with_constraint(plane).expect("exists");
        let model = model.with_gravity();
        let start = State::at_rest(sheet.positions().to_vec());
        let mut simulation = Simulation::new(model, start, method).expect("valid");
        let (h, steps) = (1e-3, 100);
        for _ in 0..steps {
            let report = simulation.step(h).expect("accepted");
            assert!(report.violation.expect("constraints") < 1e-13, "{name}");
            assert!(report.strain < 2e-12, "{name}");
        }
        let a = G * slope.sin();
        for v in 0..3 {
            let speed = simulation.state().v[3 * v] / slope.cos();
            let error = (speed / (a * h * f64::from(steps)) - 1.0).abs();
            assert!(error < 1e-9, "{name}: {error:e}");
        }
        let moved = (simulation.state().x[0] - sheet.positions()[0]) / slope.cos();
        let exact = 0.5 * a * (h * f64::from(steps)).powi(2);
        let allowed = if order_one { 0.011 } else { 3e-4 };
        assert!(
            (moved / exact - 1.0).abs() < allowed,
            "{name}: {moved} {exact}"
        );
        // The force of a line is perpendicular to it.
        let want = 0.3 * G * slope.cos();
        let push = sum(&simulation);
        // Newton's method of the damped methods stops at the round-off of the energy, which is a force of
        // about 1e-5 N here.
        assert!((push.norm() / want - 1.0).abs() < 3e-5, "{name}: {push}");
    }
}

/// Two vertices are on circles about a common axis and one is on a sphere about a point of this axis. The
/// triangle turns about the axis and is a compound pendulum.
#[test]
fn beads_on_circles_and_a_sphere_are_a_pendulum() {
    let beads = [(0.7, 0.0, -0.3), (0.5, 0.6, 0.4), (0.6, -0.5, 0.1_f64)];
    let place = |angle: f64| -> Vec<f64> {
        beads
            .iter()
            .flat_map(|(r, a, y)| [r * (angle + a).sin(), *y, -r * (angle + a).cos()])
            .collect()
    };
    let arm = |f: fn(f64) -> f64| beads.iter().map(|(r, a, _)| r * f(*a)).sum::<f64>();
    let (c, s) = (arm(f64::cos), arm(f64::sin));
    let inertia: f64 = beads.iter().map(|(r, _, _)| r * r).sum();
    let pendulum = Pendulum {
        length: inertia / c.hypot(s),
        amplitude: 1.3,
        gravity: 9.81,
    };
    let exact = |t: f64| {
        let x = pendulum.exact(t);
        place(x[6].atan2(-x[8]) - s.atan2(c))
    };
    let end = 0.4 * pendulum.period();
    let error = |method: &Method, steps: u32| {
        let sheet = Sheet::new(exact(0.0), &[[0, 1, 2]]).expect("a triangle");
        let mut model = SheetModel::new(&sheet, 0.3, MassKind::Lumped)
            .expect("valid")
            .with_acceleration([0.0, 0.0, -pendulum.gravity]);
        for v in 0..2 {
            let (r, _, y) = beads[v];
            let circle = Circle::new([0.0, y, 0.0], [0.0, 1.0, 0.0], r).expect("valid");
            let circle = VertexConstraint::on_curve(VertexId(v as u32), circle);
            model = model.with_constraint(circle).expect("exists");
        }
        let sphere = Sphere::new([0.0; 3], beads[2].0.hypot(beads[2].2)).expect("valid");
        let sphere = VertexConstraint::on_surface(VertexId(2), sphere, Side::On);
        let model = model.with_constraint(sphere).expect("exists");
        let mut simulation =
            Simulation::new(model, State::at_rest(exact(0.0)), method.clone()).expect("valid");
        for _ in 0..steps {
            let report = simulation.step(end / f64::from(steps)).expect("accepted");
            assert!(report.violation.expect("constraints") < 2e-12);
            assert!(report.strain < 2e-12);
        }
        max_difference(&simulation.state().x, &exact(end))
    };
    for (method, order) in [
        (Method::ImplicitEuler(tight()), 1.0),
        (Method::Bdf2(tight()), 2.0),
        (Method::EnergyMomentum(Default::default()), 2.0),
        (Method::Rattle(Default::default()), 2.0),
    ] {
        let errors: Vec<f64> = [100, 200, 400].map(|n| error(&method, n)).to_vec();
        let observed = orders(&errors);
        for o in &observed {
            assert!(
                (o - order).abs() < 0.15 * order.max(1.5),
                "{method:?}: {errors:?} {observed:?}"
            );
        }
    }
}

#[test]
fn a_one_sided_plane_catches_and_lets_go() {
    for method in damped() {
        let name = format!("{method:?}");
        let (sheet, mut model) = triangle(0.3);
        for v in 0..3 {
            let floor = Plane::new([0.0, 0.0, -0.05], [0.0, 0.0, 1.0]).expect("valid");
            let floor = VertexConstraint::on_surface(VertexId(v), floor, Side::Outside);
            model = model.with_constraint(floor).expect("exists");
        }
        // Falls, lies, and is lifted by a force that grows with time beyond the weight.
        let model = model.with_gravity().with_force(Lift);
        let start = State::at_rest(sheet.positions().to_vec());
        let mut simulation = Simulation::new(model, start, method).expect("valid");
        let mut heights = Vec::new();
        for _ in 0..100 {
            let report = simulation.step(0.01).expect("accepted");
            assert!(report.violation.expect("constraints") < 1e-12, "{name}");
            heights.push(simulation.state().x[2]);
            let total = sum(&simulation).z;
            assert!(total > -1e-9, "{name}: a floor does not pull, {total} N");
            let t = simulation.state().t;
            if (0.3..0.45).contains(&t) {
                assert!((total / (0.3 * G) - 1.0).abs() < 1e-6, "{name}: {total} N");
            }
        }
        assert!((heights[40] + 0.05).abs() < 1e-12, "{name}: lies");
        assert!(heights[99] > 0.0, "{name}: lifts off, {}", heights[99]);
    }
}

#[derive(Debug)]
struct Lift;

impl isosheet_dynamics::Force for Lift {
    fn add_force(&self, t: f64, _x: &[f64], _v: &[f64], force: &mut [f64]) {
        if t > 0.5 {
            for v in 0..3 {
                force[3 * v + 2] += 0.2 * G;
            }
        }
    }
}

#[test]
fn conservative_methods_refuse_one_sided_constraints() {
    let (sheet, model) = triangle(0.3);
    let floor = Plane::new([0.0, 0.0, -0.05], [0.0, 0.0, 1.0]).expect("valid");
    let floor = VertexConstraint::on_surface(VertexId(1), floor, Side::Outside);
    let model = model.with_constraint(floor).expect("exists");
    let start = State::at_rest(sheet.positions().to_vec());
    let refused = Simulation::new(model, start, Method::Rattle(Default::default())).err();
    assert_eq!(refused, Some(SimulationError::OneSided { index: 0 }));
}

/// Lifts a hanging strip by its pins and back: the work of the pins is the energy gained.
#[test]
fn the_work_of_moving_pins_is_the_energy_gained() {
    for method in every() {
        let name = format!("{method:?}");
        let strip = HangingStrip {
            rows: 3,
            spacing: 0.2,
            gravity: G,
            amplitude: 0.0,
            mode: 0,
        };
        let up = |x: f64| {
            move |t: f64| {
                [
                    x,
                    0.02 * (1.0 - (5.0 * t).cos()),
                    0.2 * (1.0 - (5.0 * t).cos()),
                ]
            }
        };
        let model = strip
            .model()
            .with_moving_pin(VertexId(0), up(0.0))
            .and_then(|m| m.with_moving_pin(VertexId(1), up(0.3)))
            .expect("exist");
        let order_one = matches!(method, Method::ImplicitEuler(_));
        let mut simulation = Simulation::new(model, strip.start(), method).expect("valid");
        let mut report = None;
        for _ in 0..300 {
            report = Some(simulation.step(1e-3).expect("accepted"));
        }
        let report = report.expect("steps");
        let x = &simulation.state().x;
        assert!((x[2] - up(0.0)(0.3)[2]).abs() < 1e-12, "{name}");
        assert!(report.strain < 2e-12, "{name}");
        let share = report.energy_drift.abs() / report.work.abs();
        let allowed = if order_one { 0.02 } else { 1e-4 };
        assert!(share < allowed, "{name}: {share:e} of {} J", report.work);
    }
}

/// A platform under all vertices lifts a triangle: constraint forces and work.
#[test]
fn a_moving_plane_lifts_a_triangle() {
    for method in every() {
        let name = format!("{method:?}");
        let order_one = matches!(method, Method::ImplicitEuler(_));
        let (sheet, mut model) = triangle(0.3);
        // From rest at the lowest point: 0.1 m (1 - cos(6 t / s)).
        let lift = RigidDisplacement {
            z: Profile::Sine {
                mean: 0.1,
                amplitude: 0.1,
                frequency: 6.0 / TAU,
                phase: -FRAC_PI_2,
            },
            ..RigidDisplacement::default()
        };
        for v in 0..3 {
            let floor = Plane::new([0.0; 3], [0.0, 0.0, 1.0]).expect("valid");
            let floor =
                VertexConstraint::on_surface(VertexId(v), floor, Side::On).moving(lift.clone());
            model = model.with_constraint(floor).expect("exists");
        }
        let model = model.with_gravity();
        let start = State::at_rest(sheet.positions().to_vec());
        let mut simulation = Simulation::new(model, start, method).expect("valid");
        let mut report = None;
        for _ in 0..200 {
            report = Some(simulation.step(1e-3).expect("accepted"));
        }
        let report = report.expect("steps");
        let t = simulation.state().t;
        let push = sum(&simulation).z;
        let want = 0.3 * (G + 3.6 * (6.0 * t).cos());
        assert!((push / want - 1.0).abs() < 0.02, "{name}: {push} {want}");
        let share = report.energy_drift.abs() / report.work.abs();
        let allowed = if order_one { 0.02 } else { 1e-3 };
        assert!(share < allowed, "{name}: {share:e} of {} J", report.work);
    }
}

#[test]
fn supports_that_do_not_start_in_place_are_refused() {
    let sheet = generate::isotropic_square(0, 0.3).expect("valid");
    let model = || SheetModel::new(&sheet, 0.1, MassKind::Lumped).expect("valid");
    let start = || State::at_rest(sheet.positions().to_vec());
    let away = model()
        .with_moving_pin(VertexId(0), |_| [9.0, 0.0, 0.0])
        .expect("exists");
    let refused = Simulation::new(away, start(), Method::default()).err();
    assert!(
        matches!(
            refused,
            Some(SimulationError::Start(StepError::OffSupport {
                support: Support::Pin(VertexId(0)),
                ..
            }))
        ),
        "{refused:?}"
    );
    let bad = model()
        .with_moving_pin(VertexId(0), |_| [f64::NAN; 3])
        .expect("exists");
    let refused = Simulation::new(bad, start(), Method::default()).err();
    assert!(
        matches!(
            refused,
            Some(SimulationError::Start(StepError::NonFiniteMotion { .. }))
        ),
        "{refused:?}"
    );
}

/// Two opposite corners of a folded strip are pulled apart further than its diagonal.
#[test]
fn pulling_beyond_taut_names_the_pin_and_the_demand() {
    let run = |unsatisfiable| {
        let (sheet, model) = triangle(0.3);
        let far = |t: f64| [0.3 + 0.5 * t, 0.0, 0.0];
        let model = model
            .with_pins(&[VertexId(0)])
            .and_then(|m| m.with_moving_pin(VertexId(1), far))
            .expect("exist");
        let start = State::at_rest(sheet.positions().to_vec());
        Simulation::new(model, start, Method::default())
            .expect("valid")
            .with_control(StepControl {
                unsatisfiable,
                ..Default::default()
            })
            .expect("valid")
    };
    let mut simulation = run(Unsatisfiable::Refuse);
    let error = simulation.step(0.01).expect_err("beyond taut");
    let StepError::Unsatisfiable { t, infeasibility } = error else {
        panic!("{error}");
    };
    assert_eq!(infeasibility.by, Driver::Support(Support::Pin(VertexId(1))));
    assert!(
        t < 0.01 && (infeasibility.distance / 0.005 - 1.0).abs() < 0.05,
        "{infeasibility:?}"
    );
    let mut simulation = run(Unsatisfiable::StopTaut);
    let report = simulation.step(0.01).expect("stops");
    assert!(report.taut.is_some() && report.t < 0.01, "{report:?}");
    assert!(report.strain < 1e-12);
}
