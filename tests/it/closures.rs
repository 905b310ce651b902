//! Vertices constrained by closure equations in a chart.

use crate::scenes::{corner, gap};
use isosheet_charts::{
    ChartDynamicsError, ChartMethod, ChartOptions, ChartSimulation, ChartStepControl, Equations,
    PositionUpdate,
};
use isosheet_coords::assignment::Degenerate;
use isosheet_coords::{
    AssignmentOptions, CartesianChart, Chart, ChartError, Choice, FrontChart, RodSystem,
};
use isosheet_dynamics::constraint::{Circle, Plane, Side, Sphere};
use isosheet_dynamics::{
    Method, SheetModel, Simulation, State, StepError, Support, VertexConstraint,
};
use isosheet_mesh::{MassKind, Sheet, VertexId, generate};
use isosheet_tests::{Linkage, max_difference, orders};
use nalgebra::{Isometry3, Vector3};

/// `M^1` bent so that no line of rods is straight: between two pins that would be a taut one.
fn bent() -> Sheet {
    let flat = generate::isotropic_square(1, 1.0).expect("valid");
    let mut x = flat.positions().to_vec();
    for p in x.chunks_mut(3) {
        p[2] = 0.2 * (2.5 * p[0] + 0.5 * p[1]).sin() + 0.1 * (4.0 * p[1] + p[0]).cos();
    }
    Sheet::new(x, &flat.face_indices()).expect("valid")
}

/// A well-conditioned chart with some of the pins of a model.
fn cartesian(model: &SheetModel, pins: &[VertexId], x: &[f64]) -> Box<dyn Chart> {
    let system = RodSystem::from_parts(model.topology(), model.rods().lengths(), pins);
    let system = system.expect("vertices exist");
    Box::new(CartesianChart::new(system, Choice::Auto, x).expect("regular"))
}

fn fixed(method: ChartMethod, h: f64) -> ChartOptions {
    ChartOptions {
        method,
        control: ChartStepControl::Fixed(h),
        ..Default::default()
    }
}

/// Largest distance of the linkage's pins from their places.
fn off_pins(x: &[f64], start: &[f64]) -> f64 {
    let of = |v: &VertexId| 3 * v.index()..3 * v.index() + 3;
    let pins = Linkage::PINS.iter();
    pins.map(|v| max_difference(&x[of(v)], &start[of(v)]))
        .fold(0.0, f64::max)
}

/// The chart has the paper's one external point, and three more pins are closures, two of whose nine
/// equations are dependent. The orders of all methods are measured against the exact motion of the parallel
/// linkage.
#[test]
fn a_parallel_linkage_swings_as_a_pendulum() {
    let linkage = Linkage::default();
    let (amplitude, end) = (1.0, 0.5);
    let cases = [
        (ChartMethod::ForwardEuler, 200, 1.0),
        (ChartMethod::RungeKutta4, 25, 4.0),
    ];
    for (method, steps, expected) in cases {
        let (mut errors, mut drifts) = (Vec::new(), Vec::new());
        for k in 0..3 {
            let n = steps << k;
            let (model, start) = linkage.parallel(amplitude);
            let chart = cartesian(&model, &[VertexId(0)], &start.x);
            let options = fixed(method, end / f64::from(n));
            let mut run =
                ChartSimulation::from_state(model, chart, options, &start).expect("valid");
            assert_eq!(run.coordinates().len(), 8);
            let energy = run.hamiltonian();
            for _ in 0..n {
                let report = run.step().expect("regular");
                assert!(report.strain < 1e-12, "{report:?}");
                assert!(off_pins(run.positions(), &start.x) < 1e-12);
            }
            errors.push(gap(run.positions(), &linkage.exact(amplitude, run.time())));
            drifts.push((run.hamiltonian() - energy).abs());
        }
        for (what, values) in [("error", &errors), ("energy", &drifts)] {
            for order in orders(values) {
                assert!(
                    order > expected - 0.15 && order < expected + 1.3,
                    "{method:?}: {what} {values:?}, order {order}"
                );
            }
        }
    }
}

/// The published variants run with closures too, in all position updates.
#[test]
fn the_published_equations_keep_closures() {
    let linkage = Linkage::default();
    for equations in [Equations::Published, Equations::Reformed] {
        for position in [
            PositionUpdate::Linear,
            PositionUpdate::Exact,
            PositionUpdate::Projected,
        ] {
            let (model, start) = linkage.parallel(0.5);
            let chart = cartesian(&model, &[VertexId(0)], &start.x);
            let options = ChartOptions {
                equations,
                position,
                ..fixed(ChartMethod::ForwardEuler, 1e-3)
            };
            let mut run =
                ChartSimulation::from_state(model, chart, options, &start).expect("valid");
            for _ in 0..100 {
                let report = run.step().expect("regular");
                let limit = if position == PositionUpdate::Linear {
                    1e-3
                } else {
                    1e-12
                };
                assert!(report.strain < limit, "{position:?}: {report:?}");
                assert!(off_pins(run.positions(), &start.x) < 1e-12);
            }
            let error = gap(run.positions(), &linkage.exact(0.5, run.time()));
            // The literal scheme is not consistent; re-formed momenta are of first order.
            let limit = if equations == Equations::Published {
                0.05
            } else {
                2e-3
            };
            assert!(error < limit, "{equations:?} {position:?}: {error}");
        }
    }
}

#[test]
fn reactions_of_a_hanging_trapezoid() {
    let linkage = Linkage::default();
    let angle = 0.6_f64;
    let (model, start) = linkage.trapezoid(angle);
    let chart = cartesian(&model, &[VertexId(0)], &start.x);
    let options = fixed(ChartMethod::RungeKutta4, 1e-3);
    let mut run = isosheet_charts::in_chart(model, start.clone(), chart, options).expect("valid");
    for _ in 0..5 {
        run.step(1e-3).expect("at rest");
    }
    assert!(gap(&run.state().x, &start.x) < 1e-10, "in equilibrium");
    let reactions = run.reactions();
    assert_eq!(reactions.len(), 4);
    let sum = |range: std::ops::Range<usize>| {
        let forces = reactions[range].iter().map(|r| r.force);
        forces.sum::<Vector3<f64>>()
    };
    let weight = 2.0 * linkage.mass * linkage.gravity;
    // An end carries its own weight and that of the hinge below.
    let (first, second) = (sum(0..2), sum(2..4));
    for (force, side) in [(first, -1.0), (second, 1.0)] {
        let want = Vector3::new(side * linkage.pull(angle), 0.0, 2.0 * weight);
        assert!((force - want).norm() < 1e-9 * weight, "{force} {want}");
    }
}

/// A bent sheet with two pinned corners, one vertex on a circle and one on a sphere. The reference is
/// RATTLE's composition of fourth order without a chart.
fn crowded() -> (SheetModel, State, [VertexId; 2]) {
    let sheet = bent();
    let (second, third, fourth) = (VertexId(0), VertexId(4), VertexId(24));
    let place = |v: VertexId| sheet.position(v);
    let [x, y, z] = place(third);
    // Both across the middle of the sheet's diagonals, so that nothing is taut.
    let circle = Circle::new([x, y, z - 0.3], [1.0, 0.2, 0.0], 0.3).expect("valid");
    let [x, y, z] = place(fourth);
    let sphere = Sphere::new([x, y, z + 0.5], 0.5).expect("valid");
    let model = SheetModel::new(&sheet, 0.1, MassKind::Consistent)
        .expect("valid")
        .with_gravity()
        .with_pins(&[corner(1), second])
        .expect("exist")
        .with_constraint(VertexConstraint::on_curve(third, circle))
        .expect("exists")
        .with_constraint(VertexConstraint::on_surface(fourth, sphere, Side::On))
        .expect("exists");
    let start = State::at_rest(sheet.positions().to_vec());
    (model, start, [corner(1), second])
}

fn front(sheet: &Sheet, pins: &[VertexId]) -> Box<dyn Chart> {
    let options = AssignmentOptions {
        pins: pins.to_vec(),
        degenerate: Degenerate::Assign,
        ..Default::default()
    };
    Box::new(FrontChart::new(sheet, &options, sheet.positions()).expect("folded"))
}

#[test]
fn closures_follow_the_chart_free_motion() {
    let (end, steps) = (0.05, 100);
    let (model, start, _) = crowded();
    let method = Method::RattleComposition(Default::default());
    let mut free = Simulation::new(model, start, method).expect("valid");
    let mut forces = Vec::new();
    for _ in 0..200 {
        free.step(end / 200.0).expect("accepted");
        forces = free.reactions();
    }
    for which in ["one pin in the chart", "both pins", "front, one pin"] {
        let (model, start, pins) = crowded();
        let chart = match which {
            "one pin in the chart" => cartesian(&model, &pins[..1], &start.x),
            "both pins" => cartesian(&model, &pins, &start.x),
            _ => front(&bent(), &pins[..1]),
        };
        let options = fixed(ChartMethod::RungeKutta4, end / f64::from(steps));
        let mut run = isosheet_charts::in_chart(model, start, chart, options).expect("valid");
        let report = run.step(end).expect("accepted");
        assert!(report.violation.expect("constraints") < 1e-12, "{report:?}");
        assert!(report.strain < 1e-11, "{report:?}");
        assert!(report.energy_drift.abs() < 1e-7, "{which}: {report:?}");
        let error = gap(&run.state().x, &free.state().x);
        assert!(error < 1e-6, "{which}: {error:e}");
        let own = run.reactions();
        assert_eq!(own.len(), forces.len());
        let size = forces.iter().map(|r| r.force.norm()).fold(0.0, f64::max);
        for (a, b) in own.iter().zip(&forces) {
            assert_eq!(a.support, b.support);
            // Those without a chart are means over a short step.
            let off = (a.force - b.force).norm();
            assert!(off < 0.02 * size, "{which}: {a:?} {b:?}");
        }
    }
}

/// A pin and a plane in prescribed motion: positions, energy and work.
#[test]
fn moving_closures_follow_the_chart_free_motion() {
    let scene = || {
        let sheet = bent();
        let (first, second) = (VertexId(0), VertexId(24));
        let from = sheet.position(second);
        let normal = [0.3, -0.2, 1.0];
        let plane = Plane::new(sheet.position(VertexId(4)), normal).expect("valid");
        let plane = VertexConstraint::on_surface(VertexId(4), plane, Side::On)
            .moving(|t: f64| Isometry3::translation(0.0, 0.0, 0.1 * (5.0 * t).sin()));
        let model = SheetModel::new(&sheet, 0.1, MassKind::Lumped)
            .expect("valid")
            .with_gravity()
            .with_damping(0.0)
            .expect("valid")
            .with_pins(&[first])
            .expect("exists")
            .with_moving_pin(second, move |t: f64| {
                let s = 0.1 * (4.0 * t).sin();
                [from[0] - s, from[1] - s, from[2] + s * s]
            })
            .expect("exists")
            .with_constraint(plane)
            .expect("exists");
        (model, State::at_rest(sheet.positions().to_vec()))
    };
    let end = 0.1;
    let (model, start) = scene();
    let method = Method::RattleComposition(Default::default());
    let mut free = Simulation::new(model, start, method).expect("valid");
    for _ in 0..400 {
        free.step(end / 400.0).expect("accepted");
    }
    let mut errors = Vec::new();
    for h in [4e-3, 2e-3, 1e-3] {
        let (model, start) = scene();
        let chart = cartesian(&model, &[VertexId(0)], &start.x);
        let options = fixed(ChartMethod::RungeKutta4, h);
        let mut run = isosheet_charts::in_chart(model, start, chart, options).expect("valid");
        let report = run.step(end).expect("accepted");
        assert!(report.violation.expect("a plane") < 1e-12);
        errors.push(gap(&run.state().x, &free.state().x));
        // The trapezoidal rule for the work is of second order.
        assert!(report.energy_drift.abs() < 2e3 * h * h * report.kinetic);
    }
    assert!(errors[2] < 1e-7, "{errors:?}");
    for order in orders(&errors) {
        assert!(order > 3.5, "{errors:?}");
    }
}

#[test]
fn closures_that_cannot_be_met_say_so() {
    // The middle panel keeps the far end from moving away for long.
    let linkage = Linkage::default();
    let (model, start) = linkage.parallel(0.5);
    let from = [linkage.middle, 0.0, 0.0];
    let far = VertexId(6);
    let pull = move |t: f64| [from[0] + t, 0.0, 0.0];
    let model = model.with_moving_pin(far, pull).expect("exists");
    let chart = cartesian(&model, &[VertexId(0)], &start.x);
    let options = fixed(ChartMethod::RungeKutta4, 1e-3);
    let mut run = isosheet_charts::in_chart(model, start.clone(), chart, options).expect("valid");
    let error = (0..2000).find_map(|_| run.step(1e-3).err()).expect("taut");
    // The rung between the two pins of that end is pulled apart at once.
    match error {
        StepError::Engine { source, .. } => match source.downcast_ref() {
            Some(ChartDynamicsError::Closure {
                support: Support::Pin(_),
                distance,
                rank,
                equations: 9,
                ..
            }) => assert!(*distance > 0.0 && *rank < 9),
            _ => panic!("{source}"),
        },
        other => panic!("{other}"),
    }
    assert!(run.state().x.iter().all(|c| c.is_finite()));
    // A state off a support, a moving pin in the chart, a one-sided surface.
    let plane = |height| {
        let plane = Plane::new([0.0, 0.0, height], [0.0, 0.0, 1.0]).expect("valid");
        move |side| VertexConstraint::on_surface(VertexId(2), plane.clone(), side)
    };
    let lowest = start.x[8];
    let begin = |model: SheetModel, pins: &[VertexId]| {
        let chart = cartesian(&model, pins, &start.x);
        ChartSimulation::from_state(model, chart, ChartOptions::default(), &start).err()
    };
    let model = || linkage.parallel(0.5).0;
    let off = model().with_constraint(plane(lowest - 0.1)(Side::On));
    let off = begin(off.expect("exists"), &[VertexId(0)]);
    assert!(
        matches!(off, Some(ChartDynamicsError::Closure { distance, .. }) if (distance - 0.1).abs() < 1e-9),
        "{off:?}"
    );
    let one_sided = model().with_constraint(plane(lowest)(Side::Outside));
    let one_sided = begin(one_sided.expect("exists"), &[VertexId(0)]);
    assert_eq!(one_sided, Some(ChartDynamicsError::OneSided { index: 0 }));
    let moving = model().with_moving_pin(VertexId(0), |_| [0.0; 3]);
    let moving = begin(moving.expect("exists"), &[VertexId(0)]);
    let vertex = VertexId(0);
    assert_eq!(moving, Some(ChartDynamicsError::MovingPin { vertex }));
    // Pins that leave no freedom make no chart; as closures they fix the whole sheet.
    let full: Vec<VertexId> = (0..8).map(VertexId).collect();
    let model = model().with_pins(&full).expect("exist");
    let system = RodSystem::from_parts(model.topology(), model.rods().lengths(), &full);
    let none = CartesianChart::new(system.expect("valid"), Choice::Auto, &start.x);
    assert!(matches!(none.err(), Some(ChartError::System(_))));
    let chart = cartesian(&model, &[VertexId(0)], &start.x);
    let options = fixed(ChartMethod::RungeKutta4, 1e-2);
    let mut run = ChartSimulation::from_state(model, chart, options, &start).expect("valid");
    for _ in 0..10 {
        run.step().expect("fixed");
    }
    assert!(gap(run.positions(), &start.x) < 1e-12);
}
