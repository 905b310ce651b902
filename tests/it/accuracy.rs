//! Steps that are divided by an estimate of their error.

use isosheet_dynamics::{
    ImplicitOptions, Method, SheetModel, Simulation, SimulationError, State, StepControl,
    leave_flat,
};
use isosheet_mesh::{MassKind, Sheet, VertexId, generate};
use isosheet_tests::{Pendulum, max_difference};

fn accurate(accuracy: f64) -> StepControl {
    StepControl {
        accuracy: Some(accuracy),
        ..StepControl::default()
    }
}

fn pendulum(method: Method, control: StepControl) -> Simulation {
    let problem = Pendulum::default();
    let simulation =
        Simulation::new(problem.model(), problem.start(), method).expect("valid model");
    simulation.with_control(control).expect("valid control")
}

/// A sheet that hangs by a corner, with damping.
fn hanging(sheet: &Sheet) -> SheetModel {
    SheetModel::new(sheet, 3e-3, MassKind::Lumped)
        .expect("positive mass")
        .with_gravity()
        .with_damping(4.0)
        .expect("positive rate")
        .with_pins(&[VertexId(0)])
        .expect("a vertex")
}

/// A sheet that is held by a corner, with damping, and falls from all but flat.
fn falling(sheet: &Sheet) -> Simulation {
    let model = hanging(sheet);
    let mut x = sheet.positions().to_vec();
    leave_flat(&model, &mut x, 1e-3, 1).expect("positions with these lengths");
    let simulation = Simulation::new(model, State::at_rest(x), Method::default());
    let simulation = simulation
        .expect("valid model")
        .with_control(accurate(1e-5));
    simulation.expect("valid control")
}

fn square() -> Sheet {
    generate::isotropic_square(2, 0.2).expect("a square")
}

/// The error of a sub-step is of order `p + 1` in its length for a method of order `p`, that of a motion of
/// order `p`. With `2^(p+1)` times less of the first one sub-steps are halved, and of the second one a part
/// `2^-p` is left.
#[test]
fn the_error_of_a_motion_follows_the_accuracy_by_the_order_of_the_method() {
    let problem = Pendulum::default();
    let end = 0.3 * problem.period();
    let tight = ImplicitOptions {
        tolerance: Some(1e-12),
        ..ImplicitOptions::default()
    };
    let methods = [
        (Method::ImplicitEuler(tight.clone()), 1, 1e-4),
        (Method::Bdf2(tight), 2, 1e-5),
    ];
    for (method, order, coarsest) in methods {
        let runs = [0, 1, 2].map(|k| {
            let accuracy = coarsest / 2.0_f64.powi((order + 1) * k);
            let mut simulation = pendulum(method.clone(), accurate(accuracy));
            let mut substeps = 0;
            for _ in 0..4 {
                let report = simulation.step(0.25 * end).expect("step accepted");
                assert!(report.error.is_some_and(|e| e <= accuracy), "{report:?}");
                substeps += report.substeps;
            }
            let error = max_difference(&simulation.state().x, &problem.exact(end));
            (error, substeps as f64)
        });
        for pair in runs.windows(2) {
            let [(coarse, few), (fine, many)] = [pair[0], pair[1]];
            let observed = (coarse / fine).log2();
            assert!(
                (observed - f64::from(order)).abs() < 0.3,
                "order {order}: {runs:?}"
            );
            assert!(
                (1.7..2.3).contains(&(many / few)),
                "order {order}: {runs:?}"
            );
        }
    }
}

/// Long sub-steps follow short ones where a motion dies down, and a step asks for no more than one.
#[test]
fn a_sheet_that_comes_to_rest_takes_long_steps_again() {
    let mut simulation = falling(&square());
    let substeps: Vec<usize> = (0..60)
        .map(|_| simulation.step(0.1).expect("step accepted").substeps)
        .collect();
    assert!(
        substeps[..5].iter().all(|count| *count >= 4),
        "{substeps:?}"
    );
    assert!(
        substeps[55..].iter().all(|count| *count == 1),
        "{substeps:?}"
    );
}

#[test]
fn a_resumed_run_goes_on_with_the_same_sub_steps() {
    let start = || falling(&square());
    super::checkpoint::compare_with("accurate", 0.1, start, |checkpoint| {
        Simulation::resume(hanging(&square()), None, checkpoint).expect("of this model")
    });
}

/// Where sub-steps are as short as allowed they are accepted, and the report says by how much they err.
#[test]
fn an_accuracy_that_is_out_of_reach_is_told() {
    let control = StepControl {
        min_fraction: 0.25,
        ..accurate(1e-9)
    };
    let report = pendulum(Method::default(), control)
        .step(0.1)
        .expect("step accepted");
    assert_eq!((report.substeps, report.rejected), (4, 2));
    assert!(report.error.is_some_and(|e| e > 1e-9));
}

#[test]
fn methods_without_an_estimate_refuse_an_accuracy() {
    let problem = Pendulum::default();
    for method in [
        Method::Rattle(Default::default()),
        Method::RattleComposition(Default::default()),
        Method::EnergyMomentum(Default::default()),
    ] {
        let simulation = Simulation::new(problem.model(), problem.start(), method);
        let refused = simulation
            .expect("valid model")
            .with_control(accurate(1e-3));
        assert!(matches!(refused, Err(SimulationError::Accuracy)));
    }
    for accuracy in [0.0, -1e-3, f64::NAN, f64::INFINITY] {
        let simulation = Simulation::new(problem.model(), problem.start(), Method::default());
        let refused = simulation
            .expect("valid model")
            .with_control(accurate(accuracy));
        assert!(
            matches!(refused, Err(SimulationError::Options(_))),
            "{accuracy}"
        );
    }
}
