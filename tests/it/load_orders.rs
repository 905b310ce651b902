//! Convergence orders of every method under every kind of load that changes in time.

use isosheet_charts::{ChartMethod, ChartOptions, ChartStepControl};
use isosheet_coords::{CartesianChart, Chart, Choice, RodSystem};
use isosheet_dynamics::{
    AccelerationField, ElasticSheet, ImplicitOptions, Method, Profile, Simulation, State,
};
use isosheet_tests::pushed::{DependsOn, END, MASS, SIZE, bare, exact, loads, start, triangle};
use isosheet_tests::{methods, orders};

/// Error of position and velocity at the end of a run, relative to the exact ones: the larger one, since each
/// may pass through zero as steps get shorter.
fn error(run: &mut Simulation, steps: usize) -> f64 {
    for _ in 0..steps {
        let report = run.step(END / steps as f64).expect("accepted");
        assert_eq!(report.rejected, 0, "no step is refused");
    }
    let [z, v, _] = exact(END);
    let state = run.state();
    ((state.x[2] - z).abs() / z).max((state.v[2] - v).abs() / v)
}

/// Checks that a motion converges with an order; `run` starts a simulation with steps of a length.
fn check(what: &str, order: f64, run: impl Fn(f64) -> Simulation) {
    let errors: Vec<f64> = [60, 120, 240]
        .map(|steps| error(&mut run(END / steps as f64), steps))
        .to_vec();
    let is_round_off = errors.iter().all(|e| *e < 1e-11);
    let observed = orders(&errors);
    assert!(
        is_round_off || observed.iter().all(|o| *o > order - 0.1),
        "{what}: errors {errors:?}, orders {observed:?}, expected {order}"
    );
}

#[test]
fn loads_of_time_keep_the_order_of_each_method() {
    for (load, depends, model) in loads() {
        for (name, method) in methods() {
            let order = match (name, depends) {
                ("implicit Euler", _) => 1.0,
                // Its steps are symmetric, and can be composed, where forces depend on no velocities.
                ("RATTLE composition", DependsOn::Time | DependsOn::Damping) => 4.0,
                _ => 2.0,
            };
            let tight = ImplicitOptions {
                tolerance: Some(1e-14),
                ..Default::default()
            };
            let method = match method {
                Method::ImplicitEuler(_) => Method::ImplicitEuler(tight),
                Method::Bdf2(_) => Method::Bdf2(tight),
                other => other,
            };
            check(&format!("{name} under {load}"), order, |_| {
                Simulation::new(model(), start(), method.clone()).expect("a simulation")
            });
        }
    }
}

/// In a chart the damping is that of the paper, which follows each step.
#[test]
fn loads_of_time_keep_the_order_in_a_chart() {
    for (load, depends, model) in loads() {
        let order = if depends == DependsOn::Damping {
            1.0
        } else {
            4.0
        };
        check(&format!("Runge-Kutta under {load}"), order, |h| {
            let sheet = triangle();
            let system = RodSystem::new(&sheet, &[]).expect("rods");
            let chart =
                CartesianChart::new(system, Choice::Auto, sheet.positions()).expect("a chart");
            let options = ChartOptions {
                method: ChartMethod::RungeKutta4,
                control: ChartStepControl::Fixed(h),
                ..Default::default()
            };
            let chart: Box<dyn Chart> = Box::new(chart);
            isosheet_charts::in_chart(model(), start(), chart, options).expect("a simulation")
        });
    }
}

/// A release at a time that is no end of a step, a load that jumps within a thousandth of a second, and a pin
/// that starts with a jump of its velocity: with the breaks of their functions the order is two.
#[test]
fn breaks_keep_the_order_of_bdf2() {
    let begin = 0.1234;
    let jump = |to: f64| Profile::Ramp {
        from: 0.0,
        to,
        begin,
        end: begin + 1e-9,
    };
    // z = a (t - b)^2 / 2 after the jump of the load, and the same for the velocity that it leaves.
    let observed = |with_breaks: bool| -> Vec<f64> {
        let errors: Vec<f64> = [60_u32, 120, 240]
            .iter()
            .map(|steps| {
                let profile = jump(SIZE);
                let times = if with_breaks {
                    profile.breaks()
                } else {
                    Vec::new()
                };
                let field = AccelerationField::new(vec![MASS; 3], [0.0, 0.0, 1.0], profile);
                let model = bare()
                    .with_force(field.expect("a field"))
                    .with_breaks(times);
                let method = Method::Bdf2(Default::default());
                let start = State::at_rest(triangle().positions().to_vec());
                let mut run = Simulation::new(model, start, method).expect("a simulation");
                for _ in 0..*steps {
                    run.step(END / f64::from(*steps)).expect("accepted");
                }
                (run.state().v[2] - SIZE * (END - begin)).abs()
            })
            .collect();
        errors
    };
    let (without, with) = (observed(false), observed(true));
    assert!(with.iter().all(|e| *e < 1e-8), "{with:?}");
    assert!(without.iter().all(|e| *e > 1e-4), "{without:?}");
}

/// A card of an elastic sheet is shaken at 5 Hz from rest, `a = A sin(omega t)`: after a second, five
/// periods, it is `A / omega` away. BDF2 itself is 10.6, 2.8 and 0.71 % off in steps of 1/60, 1/120 and 1/240
/// s.
#[test]
fn a_card_that_is_shaken_from_rest_drifts_as_it_should() {
    let (size, frequency) = (10.0, 5.0);
    let exact = size / (std::f64::consts::TAU * frequency);
    let errors = [60_u32, 120, 240].map(|steps| {
        let shaken = Profile::Sine {
            mean: 0.0,
            amplitude: size,
            frequency,
            phase: 0.0,
        };
        let field = AccelerationField::new(vec![MASS; 3], [0.0, 0.0, 1.0], shaken);
        let elastic = ElasticSheet::new(&triangle(), 3e5, 0.3).expect("a sheet");
        let model = bare().with_force(field.expect("a field"));
        let model = model.with_elastic_sheet(elastic).expect("its mesh");
        let start = State::at_rest(triangle().positions().to_vec());
        let mut run = Simulation::new(model, start, Method::default()).expect("a simulation");
        for _ in 0..steps {
            let report = run.step(1.0 / f64::from(steps)).expect("accepted");
            assert_eq!(report.rejected, 0);
        }
        (run.state().x[2] / exact - 1.0).abs()
    });
    for (error, expected) in errors.iter().zip([0.106233, 0.027897, 0.0070796]) {
        assert!((error / expected - 1.0).abs() < 1e-4, "{errors:?}");
    }
    assert!(orders(&errors).iter().all(|o| *o > 1.9), "{errors:?}");
}
