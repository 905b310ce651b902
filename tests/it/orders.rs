//! Convergence orders of the chart-free integrators on problems with exact solutions.

use isosheet_dynamics::{ImplicitOptions, Method, SheetModel, Simulation, State, StepControl};
use isosheet_tests::{Flap, FreeTriangle, HangingStrip, Pendulum, max_difference, orders};

/// The integrators, their orders, and the coarsest number of steps that shows the order.
fn methods() -> Vec<(&'static str, Method, f64)> {
    let tight = || ImplicitOptions {
        tolerance: Some(1e-12),
        ..Default::default()
    };
    vec![
        ("implicit Euler", Method::ImplicitEuler(tight()), 1.0),
        ("BDF2", Method::Bdf2(tight()), 2.0),
        (
            "energy-momentum",
            Method::EnergyMomentum(Default::default()),
            2.0,
        ),
        ("RATTLE", Method::Rattle(Default::default()), 2.0),
        (
            "RATTLE composition",
            Method::RattleComposition(Default::default()),
            4.0,
        ),
    ]
}

fn run(model: SheetModel, start: State, method: Method, end: f64, steps: usize) -> Simulation {
    let mut simulation = Simulation::new(model, start, method)
        .expect("valid model")
        .with_control(StepControl {
            min_fraction: 1.0,
            ..Default::default()
        })
        .expect("valid control");
    for _ in 0..steps {
        let report = simulation.step(end / steps as f64).expect("step accepted");
        assert_eq!(report.substeps, 1, "the step size is the one asked for");
        assert!(report.strain < 2e-12, "strain {:e}", report.strain);
    }
    simulation
}

/// Checks the order of every method; `error` runs one with a number of steps, of which the
/// coarsest is given for orders 1, 2 and 4.
fn check(problem: &str, steps: [usize; 3], error: impl Fn(&Method, usize) -> f64) {
    for (name, method, order) in methods() {
        let base = match order as u32 {
            1 => steps[0],
            2 => steps[1],
            _ => steps[2],
        };
        let errors: Vec<f64> = [1, 2, 4].iter().map(|k| error(&method, k * base)).collect();
        let observed = orders(&errors);
        for o in &observed {
            assert!(
                (o - order).abs() < 0.15 * order.max(2.0),
                "{name} on {problem}: errors {errors:?}, orders {observed:?}, expected {order}"
            );
        }
    }
}

#[test]
fn pendulum() {
    let problem = Pendulum::default();
    let end = 0.3 * problem.period();
    check("the pendulum", [400, 100, 20], |method, steps| {
        let done = run(problem.model(), problem.start(), method.clone(), end, steps);
        max_difference(&done.state().x, &problem.exact(end))
    });
}

#[test]
fn free_triangle() {
    let problem = FreeTriangle::default();
    let end = 0.3 * problem.period();
    check("the free triangle", [400, 100, 20], |method, steps| {
        let done = run(problem.model(), problem.start(), method.clone(), end, steps);
        let spin = problem.spin_of(done.model(), done.state());
        max_difference(&spin, &problem.spin_at(end))
    });
}

#[test]
fn free_flap() {
    let problem = Flap::default();
    let end = 0.6;
    check("the flap", [400, 100, 20], |method, steps| {
        let done = run(problem.model(), problem.start(), method.clone(), end, steps);
        max_difference(&done.state().x, &problem.exact(end))
    });
}

#[test]
fn hanging_strip() {
    // Small enough that what the linear theory leaves out (relative error amplitude^2) is below
    // the finest error measured.
    let problem = HangingStrip {
        rows: 3,
        spacing: 0.5,
        gravity: 9.81,
        amplitude: 1e-5,
        mode: 1,
    };
    let end = 1.2 / problem.frequency();
    check("the hanging strip", [400, 100, 5], |method, steps| {
        let done = run(problem.model(), problem.start(), method.clone(), end, steps);
        let y: Vec<f64> = done.state().x.chunks(3).map(|p| p[1]).collect();
        max_difference(&y, &problem.displacements(end)) / problem.amplitude
    });
}

#[test]
fn laguerre_frequencies() {
    // Every mode of a strip of four rows passes through zero a quarter period after release.
    for mode in 0..4 {
        let problem = HangingStrip {
            rows: 4,
            spacing: 0.25,
            gravity: 9.81,
            amplitude: 1e-6,
            mode,
        };
        let quarter = 0.5 * std::f64::consts::PI / problem.frequency();
        let done = run(
            problem.model(),
            problem.start(),
            Method::RattleComposition(Default::default()),
            quarter,
            80,
        );
        let largest = |x: &[f64]| x.chunks(3).fold(0.0_f64, |m, p| m.max(p[1].abs()));
        let left = largest(&done.state().x) / largest(&problem.start().x);
        // A relative error d in the frequency leaves pi/2 d.
        assert!(
            left < 1e-5,
            "mode {mode}: {left:e} of the amplitude is left"
        );
    }
}
