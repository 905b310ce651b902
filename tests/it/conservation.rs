//! Conservation of energy and momenta, time reversal, exactness of the lengths.

use crate::scenes::{bumped, gap, hanging, methods};
use isosheet_dynamics::{Method, SheetModel, Simulation, State};
use isosheet_mesh::MassKind;
use isosheet_tests::{Pendulum, orders};

#[test]
fn energy_momentum_keeps_energy_and_lengths_for_a_second() {
    for level in [1, 2] {
        let mut run = hanging(level, 0.05, Method::EnergyMomentum(Default::default()));
        let start = run.model().potential_energy(0.0, &run.state().x);
        let (mut drift, mut strain, mut lowest) = (0.0_f64, 0.0_f64, start);
        for _ in 0..200 {
            let report = run.step(5e-3).expect("accepted");
            drift = drift.max(report.energy_drift.abs());
            strain = strain.max(report.strain);
            lowest = lowest.min(report.potential);
        }
        let released = start - lowest;
        assert!(released > 0.1, "the sheet falls: {released} J");
        assert!(
            drift < 1e-10 * released,
            "M^{level}: {drift:e} J of {released} J"
        );
        assert!(strain < 1e-12, "M^{level}: strain {strain:e}");
    }
}

fn tumbling_model() -> SheetModel {
    SheetModel::new(&bumped(1, 0.1), 0.1, MassKind::Lumped).expect("valid")
}

/// A folded sheet flying and tumbling: smooth velocities, projected on the constraints by a tiny
/// step of the projection method.
fn tumbling(method: Method) -> Simulation {
    let sheet = bumped(1, 0.1);
    let x = sheet.positions().to_vec();
    let v = x
        .chunks(3)
        .flat_map(|p| {
            [
                0.3 - 2.0 * p[1] + p[2],
                0.1 + 2.0 * p[0],
                1.0 - p[0] + 0.8 * (p[0] - 0.5) * (p[1] - 0.3),
            ]
        })
        .collect();
    let mut settle = Simulation::new(
        tumbling_model(),
        State::moving(x, v),
        Method::Projection(Default::default()),
    )
    .expect("valid");
    settle.step(1e-6).expect("accepted");
    let State { x, v, .. } = settle.state().clone();
    Simulation::new(tumbling_model(), State::moving(x, v), method).expect("valid")
}

#[test]
fn momenta_of_a_free_sheet() {
    for (name, method) in methods() {
        let mut run = tumbling(method);
        let moments = |run: &Simulation| {
            let State { x, v, .. } = run.state();
            (
                run.model().linear_momentum(v),
                run.model().angular_momentum(x, v),
            )
        };
        let (linear, angular) = moments(&run);
        let mut drift = 0.0_f64;
        for _ in 0..50 {
            drift = drift.max(run.step(4e-3).expect("accepted").energy_drift.abs());
        }
        let (linear_end, angular_end) = moments(&run);
        let lost = gap(&linear, &linear_end);
        // Projections solve with rods 1e9 to 1e13 times as stiff as the masses: round-off.
        let bound = if name == "projection" { 1e-8 } else { 1e-13 };
        assert!(
            lost < bound,
            "{name}: linear momentum {lost:e} of {linear:?}"
        );
        let lost = gap(&angular, &angular_end);
        match name {
            // Their rods push along directions of the iterates, which is exact in the limit only.
            "implicit Euler" | "BDF2" | "projection" => {
                assert!(
                    lost < 0.2 * angular[2].abs(),
                    "{name}: angular momentum {lost:e}"
                );
            }
            _ => assert!(lost < 1e-12, "{name}: angular momentum {lost:e}"),
        }
        if name == "energy-momentum" {
            assert!(drift < 1e-13, "energy {drift:e}");
        }
    }
}

#[test]
fn symmetric_methods_run_backwards() {
    for (name, method) in methods().into_iter().skip(3) {
        let mut run = tumbling(method.clone());
        let start = run.state().clone();
        for _ in 0..40 {
            run.step(4e-3).expect("accepted");
        }
        let State { x, v, .. } = run.state().clone();
        let back = v.iter().map(|v| -v).collect();
        let mut run =
            Simulation::new(tumbling_model(), State::moving(x, back), method).expect("valid");
        for _ in 0..40 {
            run.step(4e-3).expect("accepted");
        }
        let error = gap(&run.state().x, &start.x);
        assert!(error < 1e-9, "{name}: {error:e} m from the start");
    }
}

#[test]
fn rattle_energy_error_is_bounded_and_second_order() {
    let problem = Pendulum::default();
    let worst = |steps: usize| {
        let mut run = Simulation::new(
            problem.model(),
            problem.start(),
            Method::Rattle(Default::default()),
        )
        .expect("valid");
        let h = problem.period() / steps as f64;
        let mut halves = [0.0_f64; 2];
        for k in 0..10 * steps {
            let drift = run.step(h).expect("accepted").energy_drift.abs();
            let half = usize::from(k >= 5 * steps);
            halves[half] = halves[half].max(drift);
        }
        assert!(halves[1] < 1.01 * halves[0], "no growth: {halves:?}");
        halves[0]
    };
    let errors = [worst(100), worst(200), worst(400)];
    for order in orders(&errors) {
        assert!((order - 2.0).abs() < 0.05, "{errors:?}");
    }
}

#[test]
fn damping_is_accounted_for() {
    let model = Pendulum::default()
        .model()
        .with_damping(0.7)
        .expect("valid");
    let mut run = Simulation::new(
        model,
        Pendulum::default().start(),
        Method::EnergyMomentum(Default::default()),
    )
    .expect("valid");
    let mut last = None;
    for _ in 0..300 {
        last = Some(run.step(5e-3).expect("accepted"));
    }
    let report = last.expect("steps were taken");
    assert!(report.dissipated > 0.1, "{} J", report.dissipated);
    assert!(
        report.energy_drift.abs() < 1e-11,
        "{:e} J",
        report.energy_drift
    );
}

#[test]
fn damping_slows_a_flight_at_its_rate() {
    // Every velocity decays as exp(-gamma t), whatever the steps, in every method.
    let (gamma, speed) = (1.3, [0.4, -0.2, 0.7]);
    for (name, method) in methods() {
        let sheet = bumped(1, 0.05);
        let model = SheetModel::new(&sheet, 0.1, MassKind::Lumped)
            .and_then(|m| m.with_damping(gamma))
            .expect("valid");
        let start = State {
            v: speed.repeat(sheet.topology().vertex_count()),
            ..State::at_rest(sheet.positions().to_vec())
        };
        let mut simulation = Simulation::new(model, start, method).expect("valid");
        for _ in 0..30 {
            simulation.step(0.01).expect("free flight");
        }
        let decay = (-gamma * simulation.state().t).exp();
        for v in simulation.state().v.chunks(3) {
            for (found, start) in v.iter().zip(speed) {
                let ratio = found / (start * decay);
                assert!((ratio - 1.0).abs() < 1e-9, "{name}: {ratio}");
            }
        }
    }
}
