//! Contact by impulses, in charts.

use crate::scenes::gap;
use isosheet_collide::{Coefficients, ContactOptions, Contacts, Keyframe, Obstacle, Shape};
use isosheet_coords::{AssignmentOptions, CartesianChart, Chart, Choice, FrontChart, RodSystem};
use isosheet_dynamics::chart::{
    ChartDynamicsError, ChartMethod, ChartOptions, ChartSimulation, ChartStepControl, Equations,
};
use isosheet_dynamics::{SheetModel, Simulation, State};
use isosheet_mesh::{MassKind, Sheet};
use isosheet_tests::Pendulum;
use nalgebra::{Isometry3, Vector3};

const G: f64 = 9.8;

fn cartesian(model: &SheetModel, x: &[f64]) -> Box<dyn Chart> {
    let system = RodSystem::from_parts(model.topology(), model.rods().lengths(), &model.pins());
    let system = system.expect("vertices exist");
    Box::new(CartesianChart::new(system, Choice::Auto, x).expect("regular"))
}

fn floor(model: &SheetModel, pose: Isometry3<f64>, friction: f64) -> Contacts {
    let options = ContactOptions {
        activation: 1e-4,
        ..ContactOptions::for_sheet(model)
    };
    let body = Obstacle::fixed(Shape::HalfSpace, pose).expect("valid");
    Contacts::new(model, options)
        .expect("valid")
        .with_body(body, Coefficients::equal(friction))
        .expect("valid")
}

fn options(method: ChartMethod, h: f64, restitution: f64) -> ChartOptions {
    ChartOptions {
        method,
        control: ChartStepControl::Fixed(h),
        restitution,
        ..Default::default()
    }
}

/// A triangle hinged at an edge falls on a floor. It has one degree of freedom, as a bouncing point has.
/// Each impact leaves e^2 of the kinetic energy, and so the heights above the floor shrink by e^2.
#[test]
fn bounces_of_a_hinged_triangle_shrink_by_the_square_of_the_restitution() {
    let pendulum = Pendulum::default();
    let height = -0.45;
    for e in [0.0, 0.5, 0.8, 1.0] {
        let (model, start) = (pendulum.model(), pendulum.start());
        let contacts = floor(&model, Isometry3::translation(0.0, 0.0, height), 0.0);
        // The pinned edge is above the floor.
        let chart = cartesian(&model, &start.x);
        let options = options(ChartMethod::RungeKutta4, 1e-3, e);
        let mut run = ChartSimulation::from_state(model, chart, options, &start)
            .expect("valid")
            .with_contact(contacts)
            .expect("free");
        let (mut tops, mut top, mut last) = (Vec::new(), start.x[8] - height, None);
        while run.time() < 4.0 && tops.len() < 4 {
            let report = run.step().expect("accepted");
            assert!(report.gap.expect("contact") > 0.0);
            assert!(report.strain < 1e-12 && report.impact >= 0.0);
            top = top.max(run.positions()[8] - height);
            let Some(impulse) = run.impulses().first() else {
                continue;
            };
            assert!(impulse.impulse.z > 0.0 && impulse.impulse.xy().norm() == 0.0);
            let before = report.kinetic + report.impact;
            if last.is_none_or(|t| report.t - t > 0.05) {
                assert!((report.kinetic - e * e * before).abs() < 1e-9 * before);
                tops.push(std::mem::replace(&mut top, 0.0));
            }
            last = Some(report.t);
        }
        for pair in tops.windows(2) {
            let want = e * e * pair[0];
            assert!(
                (pair[1] - want).abs() < 2e-3 * pair[0] + 1e-4,
                "e = {e}: {tops:?}"
            );
        }
        assert_eq!(
            tops.len(),
            if e == 0.0 { 1 } else { 4 },
            "e = {e}: {tops:?}"
        );
    }
}

/// A tilted triangle.
fn triangle() -> (SheetModel, State) {
    let x = vec![0.0, 0.0, 0.05, 0.3, 0.0, 0.2, 0.1, 0.25, 0.12];
    let sheet = Sheet::new(x.clone(), &[[0, 1, 2]]).expect("a triangle");
    let model = SheetModel::new(&sheet, 0.3, MassKind::Consistent).expect("valid");
    (model.with_gravity(), State::at_rest(x))
}

fn moments(model: &SheetModel, x: &[f64], v: &[f64]) -> [Vector3<f64>; 3] {
    let (p, l) = (
        Vector3::from(model.linear_momentum(v)),
        Vector3::from(model.angular_momentum(x, v)),
    );
    let weights = model.mass().row_sums(model.topology());
    let points = x.as_chunks::<3>().0.iter().zip(&weights);
    let centre: Vector3<f64> = points.map(|(x, w)| *w * Vector3::from(*x)).sum();
    let centre = centre / weights.iter().sum::<f64>();
    [p, l - centre.cross(&p), centre]
}

#[test]
fn momenta_change_by_the_impulses() {
    for (e, friction) in [(0.0, 0.0), (0.6, 0.0), (0.6, 0.4), (0.0, 2.0)] {
        let (model, mut start) = triangle();
        for v in start.v.chunks_mut(3) {
            v[0] = 0.7;
        }
        let contacts = floor(&model, Isometry3::identity(), friction);
        let chart = cartesian(&model, &start.x);
        let options = options(ChartMethod::RungeKutta4, 1e-3, e);
        let mut run = ChartSimulation::from_state(model, chart, options, &start)
            .expect("valid")
            .with_contact(contacts)
            .expect("free");
        let mut impacts = 0;
        while run.time() < 0.3 {
            let old_v = run.velocities().expect("regular");
            let old = moments(run.mechanics().model(), run.positions(), &old_v);
            let report = run.step().expect("accepted");
            assert!(report.gap.expect("contact") > 0.0 && report.strain < 1e-12);
            let v = run.velocities().expect("regular");
            let new = moments(run.mechanics().model(), run.positions(), &v);
            let (mut push, mut spin) = (
                Vector3::new(0.0, 0.0, -0.3 * G * report.h),
                Vector3::zeros(),
            );
            for impulse in run.impulses() {
                for (vertex, w) in impulse.point.stencil.iter().filter(|s| s.1 != 0.0) {
                    let i = 3 * *vertex as usize;
                    let arm = Vector3::from_column_slice(&run.positions()[i..i + 3]) - new[2];
                    push += *w * impulse.impulse;
                    spin += arm.cross(&(*w * impulse.impulse));
                }
                impacts += usize::from(impulse.impulse.z > 1e-3);
            }
            // Opened gaps shift positions by a part of the activation distance.
            let off = (new[0] - old[0] - push).norm();
            assert!(off < 2e-6, "linear: {off:e}, e = {e}, mu = {friction}");
            let off = (new[1] - old[1] - spin).norm();
            assert!(off < 2e-6, "angular: {off:e}, e = {e}, mu = {friction}");
        }
        assert!(impacts >= 2, "{impacts}");
    }
}

/// Sticks below and slides above the angle of friction.
#[test]
fn a_triangle_on_an_incline_sticks_or_slides() {
    let slope = 0.4_f64;
    for (friction, acceleration) in [
        (slope.tan() * 1.01, 0.0),
        (0.0, G * slope.sin()),
        (0.2, G * (slope.sin() - 0.2 * slope.cos())),
    ] {
        for method in [ChartMethod::ForwardEuler, ChartMethod::RungeKutta4] {
            let tilt = Isometry3::rotation(Vector3::new(0.0, slope, 0.0));
            let flat = [[0.0, 0.0], [0.3, 0.0], [0.1, 0.25]];
            let x: Vec<f64> = flat
                .iter()
                .flat_map(|[x, y]| {
                    let p = tilt * nalgebra::Point3::new(*x, *y, 5e-5);
                    [p.x, p.y, p.z]
                })
                .collect();
            let sheet = Sheet::new(x.clone(), &[[0, 1, 2]]).expect("a triangle");
            let model = SheetModel::new(&sheet, 0.3, MassKind::Lumped).expect("valid");
            let model = model.with_gravity();
            let contacts = floor(&model, tilt, friction);
            let chart = cartesian(&model, &x);
            let start = State::at_rest(x.clone());
            let mut run = Simulation::in_chart(model, start, chart, options(method, 1e-3, 0.0))
                .expect("valid")
                .with_contact(contacts)
                .expect("free");
            let mut report = run.step(1e-3).expect("accepted");
            for _ in 1..300 {
                report = run.step(1e-3).expect("accepted");
                assert!(report.gap.expect("contact") > 0.0);
            }
            let speed = Vector3::from_column_slice(&run.state().v[..3]).norm();
            let want = acceleration * report.t;
            assert!(
                (speed - want).abs() < 0.01 * want + 1e-9,
                "mu = {friction}, {method:?}: {speed} {want}"
            );
            // Runge-Kutta steps move with momenta that gravity has changed, before the impulse.
            if acceleration == 0.0 && method == ChartMethod::ForwardEuler {
                assert!(gap(&run.state().x, &x) < 1e-4, "sticks");
            }
            assert!(report.friction >= 0.0);
            assert!(
                report.energy_drift.abs() < 0.02 * 0.3 * G * 0.3,
                "{report:?}"
            );
        }
    }
}

/// A folded strip in the paper's chart, moved by the paper's literal scheme with adaptive step, falls on
/// the floor. Gaps stay open, and impacts only take energy away.
#[test]
fn a_strip_falls_on_a_floor_in_the_papers_scheme() {
    let rows = [[0.0, 0.3], [0.2, 0.15], [0.38, 0.28], [0.6, 0.2]];
    let x: Vec<f64> = rows
        .iter()
        .flat_map(|[x, z]| [*x, 0.0, *z, *x, 0.25, *z + 0.02])
        .collect();
    let faces: Vec<[u32; 3]> = (0..3)
        .flat_map(|r| [[2 * r, 2 * r + 2, 2 * r + 3], [2 * r, 2 * r + 3, 2 * r + 1]])
        .collect();
    let sheet = Sheet::new(x, &faces).expect("a strip");
    for equations in [Equations::Published, Equations::Reformed, Equations::Full] {
        let model = SheetModel::new(&sheet, 0.1, MassKind::Lumped).expect("valid");
        let model = model.with_gravity().with_damping(0.5).expect("valid");
        let contacts = floor(&model, Isometry3::identity(), 0.3);
        let assignment = AssignmentOptions::default();
        let chart = FrontChart::new(&sheet, &assignment, sheet.positions()).expect("folded");
        let options = ChartOptions {
            equations,
            control: ChartStepControl::Adaptive {
                tolerance: 1e-5,
                min: 1e-7,
                max: 2e-3,
            },
            restitution: 0.2,
            ..Default::default()
        };
        let start = State::at_rest(sheet.positions().to_vec());
        let mut run = ChartSimulation::from_state(model, Box::new(chart), options, &start)
            .expect("valid")
            .with_contact(contacts)
            .expect("free");
        let (mut lost, mut steps, energy) = (0.0, 0, run.hamiltonian());
        while run.time() < 0.5 {
            let before = run.hamiltonian();
            let report = run.step().unwrap_or_else(|e| panic!("{equations:?}: {e}"));
            assert!(report.gap.expect("contact") > 0.0, "{report:?}");
            assert!(report.strain < 1e-11 && report.impact >= 0.0, "{report:?}");
            // Opening gaps of a tenth of the activation distance lifts the strip by no more.
            assert!(run.hamiltonian() - before < 1e-5 + 0.1 * G * 1e-5);
            lost += report.impact;
            steps += 1;
        }
        let fallen = energy - run.hamiltonian();
        assert!(
            lost > 0.3 * fallen && steps > 250,
            "{equations:?}: {lost} of {fallen}, {steps}"
        );
    }
}

/// A floor that rises pushes the sheet up and does work on it; a floor that rises to a pinned edge ends the
/// run with an error.
#[test]
fn moving_bodies_do_work_and_do_not_pass() {
    let (model, start) = triangle();
    let key = |t: f64, z: f64| Keyframe {
        t,
        pose: Isometry3::translation(0.0, 0.0, z),
    };
    let rising = vec![key(0.0, 0.0), key(0.2, 0.4)];
    let rising = Obstacle::new(Shape::HalfSpace, rising).expect("valid");
    let contacts = floor(&model, Isometry3::translation(0.0, 0.0, -1.0), 0.0)
        .with_body(rising, Coefficients::FRICTIONLESS)
        .expect("valid");
    let chart = cartesian(&model, &start.x);
    let options = options(ChartMethod::RungeKutta4, 5e-4, 0.0);
    let mut run = Simulation::in_chart(model, start, chart, options)
        .expect("valid")
        .with_contact(contacts)
        .expect("free");
    let mut report = run.step(1e-3).expect("accepted");
    for _ in 1..150 {
        report = run.step(1e-3).expect("accepted");
        assert!(report.gap.expect("contact") > 0.0);
    }
    assert!(run.state().x[2] > 0.29, "lifted");
    assert!(report.work > 0.0);
    let size = report.kinetic + report.work;
    assert!(report.energy_drift.abs() < 0.02 * size, "{report:?}");

    // A pinned edge gives no way to a floor that rises to it.
    let pendulum = Pendulum {
        amplitude: 1.0,
        ..Default::default()
    };
    let (model, start) = (pendulum.model(), pendulum.start());
    let rising = vec![key(0.0, -0.5), key(1.0, 0.1)];
    let rising = Obstacle::new(Shape::HalfSpace, rising).expect("valid");
    let contacts = floor(&model, Isometry3::translation(0.0, 0.0, -1.0), 0.0)
        .with_body(rising, Coefficients::FRICTIONLESS)
        .expect("valid");
    let chart = cartesian(&model, &start.x);
    let mut run = ChartSimulation::from_state(model, chart, options, &start)
        .expect("valid")
        .with_contact(contacts)
        .expect("free");
    let error = (0..100_000).find_map(|_| run.step().err());
    let error = error.expect("jammed");
    assert!(
        matches!(error, ChartDynamicsError::Contact { t, .. } if (t - 5.0 / 6.0).abs() < 1e-3),
        "{error}"
    );
    assert!(run.contacts().expect("contact").gap() > 0.0);
    assert!(run.positions()[8] > -1e-3, "lifted to the edge");
}
