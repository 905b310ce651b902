//! Motion in system coordinates against chart-free motion.

use crate::scenes::{bumped, corner, gap, hanging, pinned};
use isosheet_charts::{ChartMethod, ChartOptions, ChartStepControl, Equations, MassSolverKind};
use isosheet_coords::assignment::Degenerate;
use isosheet_coords::{AssignmentOptions, CartesianChart, Chart, Choice, FrontChart, RodSystem};
use isosheet_dynamics::{Air, At, Method, Potential, Simulation, State, StepControl, StepOutcome};
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};

const BUMP: f64 = 0.1;

fn cartesian(level: u32) -> Box<dyn Chart> {
    let sheet = bumped(level, BUMP);
    let system = RodSystem::new(&sheet, &[corner(level)]).expect("valid");
    Box::new(CartesianChart::new(system, Choice::Auto, sheet.positions()).expect("folded"))
}

fn front(level: u32) -> Box<dyn Chart> {
    let sheet = bumped(level, BUMP);
    let options = AssignmentOptions {
        pins: vec![corner(level)],
        degenerate: Degenerate::Assign,
        ..Default::default()
    };
    Box::new(FrontChart::new(&sheet, &options, sheet.positions()).expect("folded"))
}

fn in_chart(level: u32, chart: Box<dyn Chart>, options: ChartOptions) -> Simulation {
    let start = State::at_rest(bumped(level, BUMP).positions().to_vec());
    isosheet_charts::in_chart(pinned(level, BUMP), start, chart, options).expect("usable")
}

/// Positions after a tenth of a second by the fourth-order composition of RATTLE.
fn reference(level: u32) -> Vec<f64> {
    let mut run = hanging(level, BUMP, Method::RattleComposition(Default::default()));
    for _ in 0..100 {
        run.step(1e-3).expect("accepted");
    }
    run.state().x.clone()
}

#[test]
fn runge_kutta_in_both_charts_follows_the_chart_free_motion() {
    for level in [0, 1] {
        let want = reference(level);
        for (name, chart) in [("Cartesian", cartesian(level)), ("front", front(level))] {
            let options = ChartOptions {
                method: ChartMethod::RungeKutta4,
                equations: Equations::Full,
                control: ChartStepControl::Fixed(5e-4),
                ..Default::default()
            };
            let mut run = in_chart(level, chart, options);
            let report = run.step(0.1).expect("accepted");
            assert!(matches!(report.outcome, StepOutcome::Engine(_)));
            assert!(
                report.substeps >= 200 && report.strain < 1e-11,
                "{report:?}"
            );
            assert!(
                report.energy_drift.abs() < 1e-7,
                "{:e} J",
                report.energy_drift
            );
            let error = gap(&run.state().x, &want);
            assert!(error < 1e-6, "{name} chart, M^{level}: {error:e} m apart");
        }
    }
}

#[test]
fn the_mass_solvers_give_the_same_motion() {
    let mut ends: Vec<Vec<f64>> = Vec::new();
    for solver in [
        MassSolverKind::Cramer,
        MassSolverKind::DenseLu,
        MassSolverKind::Saddle,
    ] {
        let options = ChartOptions {
            solver,
            control: ChartStepControl::Fixed(1e-3),
            ..Default::default()
        };
        let mut run = in_chart(0, cartesian(0), options);
        run.step(0.05).expect("accepted");
        ends.push(run.state().x.clone());
    }
    for end in &ends[1..] {
        assert!(gap(end, &ends[0]) < 1e-10);
    }
}

#[test]
fn subdivision_control_does_not_fit_a_chart() {
    let run = in_chart(0, cartesian(0), ChartOptions::default());
    assert!(run.with_control(StepControl::default()).is_err());
}

#[test]
fn a_flat_sheet_has_no_chart() {
    let sheet = bumped(1, 0.0);
    let system = RodSystem::new(&sheet, &[corner(1)]).expect("valid");
    let error = CartesianChart::new(system, Choice::Auto, sheet.positions()).err();
    let message = error.expect("singular").to_string();
    assert!(!message.is_empty() && !message.contains("NaN"), "{message}");
}

/// Forces that are not numbers while the switch is on.
#[derive(Debug)]
struct Broken(Arc<AtomicBool>);

impl Potential for Broken {
    fn energy(&self, _at: At<'_>) -> f64 {
        0.0
    }

    fn add_gradient(&self, _at: At<'_>, gradient: &mut [f64]) {
        if self.0.load(Ordering::Relaxed) {
            gradient.fill(f64::NAN);
        }
    }
}

/// The step has taken a new reference state for the chart before its forces turn out not to be numbers.
#[test]
fn a_refused_step_that_has_rebased_leaves_everything_as_it_was() {
    const H: f64 = 1e-3;
    for build in [cartesian, front] {
        let options = ChartOptions {
            control: ChartStepControl::Fixed(H),
            growth_limit: 1.0 + 1e-9,
            ..Default::default()
        };
        let run = |is_broken: &Arc<AtomicBool>| {
            let model = pinned(1, BUMP).with_potential(Broken(Arc::clone(is_broken)));
            let start = State::at_rest(bumped(1, BUMP).positions().to_vec());
            isosheet_charts::in_chart(model, start, build(1), options).expect("usable")
        };
        let never = Arc::new(AtomicBool::new(false));
        let switch = Arc::new(AtomicBool::new(false));
        let (mut calm, mut disturbed) = (run(&never), run(&switch));
        let bytes = |run: &Simulation| run.checkpoint().to_bytes().expect("serialisable");
        let mut rebased = 0;
        for _ in 0..100 {
            let before = bytes(&disturbed);
            switch.store(true, Ordering::Relaxed);
            disturbed.step(H).expect_err("the forces are not numbers");
            switch.store(false, Ordering::Relaxed);
            assert_eq!(bytes(&disturbed), before);
            let report = disturbed.step(H).expect("accepted");
            calm.step(H).expect("accepted");
            rebased += u32::from(report.outcome == StepOutcome::Engine(isosheet_charts::REBASED));
            assert_eq!(bytes(&disturbed), bytes(&calm));
        }
        assert!(rebased >= 5, "{rebased} steps rebased the chart");
    }
}

/// The drag of air is the same force in the paper's coordinates: motion there, which knows nothing of the
/// implicit drag of damped methods, is the limit that BDF2 approaches at its order.
#[test]
fn drag_in_a_chart_is_that_of_damped_methods() {
    let air = Air {
        wind: [0.0, 2.0, 1.0].into(),
        ..Air::default()
    };
    let windy = || pinned(1, BUMP).with_air(air.clone()).expect("valid");
    let start = State::at_rest(bumped(1, BUMP).positions().to_vec());
    let options = ChartOptions {
        method: ChartMethod::RungeKutta4,
        equations: Equations::Full,
        control: ChartStepControl::Fixed(5e-4),
        ..Default::default()
    };
    let mut run =
        isosheet_charts::in_chart(windy(), start.clone(), cartesian(1), options).expect("usable");
    run.step(0.1).expect("accepted");
    let want = run.state().x.clone();
    // The wind moves the sheet by much more than the errors.
    let mut calm = in_chart(1, cartesian(1), options);
    calm.step(0.1).expect("accepted");
    assert!(gap(&calm.state().x, &want) > 1e-3);
    let error = |steps: usize| {
        let method = Method::Bdf2(Default::default());
        let mut run = Simulation::new(windy(), start.clone(), method).expect("valid");
        for _ in 0..steps {
            run.step(0.1 / steps as f64).expect("accepted");
        }
        gap(&run.state().x, &want)
    };
    let errors = [100, 200, 400].map(error);
    for k in 0..2 {
        let order = (errors[k] / errors[k + 1]).log2();
        assert!((order - 2.0).abs() < 0.3, "{errors:?}");
    }
}
