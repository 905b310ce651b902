//! Exactly flat and otherwise rank-deficient states.

use crate::scenes::{bumped, corner, gap, hanging, methods, pinned};
use isosheet_dynamics::{
    ElasticSheet, Fallback, Method, PlateBending, SheetModel, Simulation, State, StepControl,
    StepError, StepOutcome, leave_flat,
};
use isosheet_mesh::{MassKind, VertexId};

#[test]
fn flat_start_is_never_rejected() {
    for level in [1, 2, 3] {
        for (name, method) in isosheet_tests::damped() {
            let mut run = hanging(level, 0.0, method);
            let mut last = 0.0;
            for k in 0..60 {
                let report = run.step(1.0 / 60.0).expect("accepted");
                assert_eq!(report.rejected, 0, "M^{level}, {name}, step {k}");
                assert!(report.strain < 1e-11, "strain {:e}", report.strain);
                last = report.potential;
            }
            let pin = 3 * corner(level).index();
            let start = bumped(level, 0.0);
            assert_eq!(
                run.state().x[pin..pin + 3],
                start.positions()[pin..pin + 3],
                "{name}: the pin stays where it is to the last bit"
            );
            assert!(last < -0.03, "M^{level} fell: {last} J, {name}");
        }
    }
}

#[test]
fn energy_momentum_refuses_a_loaded_flat_sheet_and_says_why() {
    let mut run = hanging(1, 0.0, Method::EnergyMomentum(Default::default()));
    let error = run.step(1.0 / 60.0).expect_err("flat and loaded");
    let StepError::RankDeficient {
        t,
        rank_deficiency,
        smallest_singular_value,
    } = error
    else {
        panic!("{error}");
    };
    // The sheet has nine interior vertices and as many dependent rods; the short steps before the refusal
    // may have folded some of the vertices.
    assert!((1..=9).contains(&rank_deficiency), "{rank_deficiency}");
    assert!(
        smallest_singular_value < 1e-5,
        "{smallest_singular_value:e}"
    );
    // It gives up in the first tenth of the step, at the last state that it vouches for.
    assert!(t == run.state().t && t < 0.1 / 60.0, "{t} s");
    assert!(run.energy().abs() < 1e-10, "{:e} J", run.energy());
    let strain = run.model().rods().max_strain(&run.state().x);
    assert!(strain < 1e-12, "{strain:e}");
}

/// Many short steps lead out of the flat state. They keep the energy to one part in 1e6 (RATTLE) and one
/// part in 1e5 (its composition) of the 1.3 mJ that the fall releases.
#[test]
fn rattle_leaves_a_loaded_flat_sheet_by_short_steps() {
    for (name, method) in methods().skip(4) {
        let mut run = hanging(1, 0.0, method);
        let report = run
            .step(1.0 / 60.0)
            .unwrap_or_else(|e| panic!("{name}: {e}"));
        assert!((8..=64).contains(&report.substeps), "{name}: {report:?}");
        assert!(
            (1.25e-3..1.35e-3).contains(&report.kinetic),
            "{name}: {report:?}"
        );
        let drift = report.energy_drift.abs() / report.kinetic;
        assert!(drift < 1e-4 && report.strain < 1e-12, "{name}: {report:?}");
    }
}

#[test]
fn fallback_carries_a_conservative_run_off_flat() {
    let mut run = hanging(1, 0.0, Method::EnergyMomentum(Default::default()))
        .with_control(StepControl {
            fallback: Fallback::ImplicitEuler(Default::default()),
            ..Default::default()
        })
        .expect("valid");
    let mut paths = Vec::new();
    for _ in 0..60 {
        let report = run.step(1.0 / 60.0).expect("accepted");
        assert!(report.strain < 1e-11);
        paths.push(report.outcome);
    }
    assert_eq!(paths[0], StepOutcome::Fallback);
    let fallbacks = paths
        .iter()
        .filter(|p| **p == StepOutcome::Fallback)
        .count();
    assert!(fallbacks < 20, "{fallbacks} of 60 steps fell back");
}

#[test]
fn leaving_flat_lets_conservative_methods_run() {
    let model = pinned(1, 0.0);
    let mut x = bumped(1, 0.0).positions().to_vec();
    leave_flat(&model, &mut x, 1e-2, 7).expect("projected");
    let method = Method::EnergyMomentum(Default::default());
    let mut run = Simulation::new(model, State::at_rest(x), method).expect("valid");
    for _ in 0..60 {
        let report = run.step(1.0 / 60.0).expect("accepted");
        assert!(report.energy_drift.abs() < 1e-10 && report.strain < 1e-12);
    }
}

/// In its own frame a sheet that falls freely is at rest, however large the acceleration is: nothing strains
/// it.
#[test]
fn free_fall_does_not_strain_an_elastic_sheet() {
    let sheet = bumped(3, 0.0);
    for (name, method) in isosheet_tests::damped() {
        for weights in [1.0, 20.0, 100.0, 1000.0] {
            let model = SheetModel::new(&sheet, 0.1, MassKind::Lumped)
                .expect("valid")
                .with_acceleration([0.0, 0.0, -9.8 * weights])
                .with_potential(PlateBending::new(&sheet, 5e-4).expect("rigidity"))
                .with_elastic_sheet(ElasticSheet::new(&sheet, 3e5, 0.3).expect("stiffness"))
                .expect("its own sheet");
            let start = State::at_rest(sheet.positions().to_vec());
            let mut run = Simulation::new(model, start, method.clone()).expect("valid");
            for _ in 0..30 {
                let report = run.step(1.0 / 60.0).expect("accepted");
                let fall = run.state().x[2].abs();
                // A search ends at the round-off of the energies of weight and inertia, eight operations of
                // 3/2 m d^2 for the way d, and all of that may be the motion of one vertex. (Faces resist
                // strain more than masses do.)
                let energies = 8.0 * f64::EPSILON * 1.5 * (sheet.positions().len() / 3) as f64;
                let round_off = energies.sqrt() * fall;
                let strain = report.strain;
                assert!(strain < round_off, "{name}, {weights} g: {strain:e}");
                let first = &run.state().x[..3];
                for (p, q) in run.state().x.chunks(3).zip(sheet.positions().chunks(3)) {
                    let from = &sheet.positions()[..3];
                    let moved = [0, 1, 2].map(|k| q[k] + first[k] - from[k]);
                    assert!(gap(p, &moved) < round_off, "{name}: {p:?}, {moved:?}");
                }
            }
        }
    }
}

#[test]
fn free_fall_keeps_a_flat_sheet_flat() {
    // No rod is loaded, so dependent rods do not matter to any method.
    let sheet = bumped(2, 0.0);
    for (name, method) in methods() {
        let model = SheetModel::new(&sheet, 0.1, MassKind::Lumped)
            .expect("valid")
            .with_gravity();
        let start = State::at_rest(sheet.positions().to_vec());
        let mut run = Simulation::new(model, start, method).expect("valid");
        let (h, steps) = (1e-2, 20);
        for _ in 0..steps {
            let report = run.step(h).unwrap_or_else(|e| panic!("{name}: {e}"));
            assert_eq!(report.rejected, 0, "{name}");
        }
        let t = h * f64::from(steps);
        // First-order methods fall by g h^2 (n + 1) n / 2 instead of g t^2 / 2; BDF2 starts with
        // one such step, of which 3/2 of the error remains.
        let fall = match name {
            "implicit Euler" => 4.9 * t * (t + h),
            "BDF2" => 4.9 * (t * t + 1.5 * h * h),
            _ => 4.9 * t * t,
        };
        for (p, q) in run.state().x.chunks(3).zip(sheet.positions().chunks(3)) {
            assert!(
                gap(p, &[q[0], q[1], -fall]) < 1e-9,
                "{name}: {p:?} from {q:?}"
            );
        }
    }
}

#[test]
fn bad_states_are_refused() {
    let sheet = bumped(1, 0.05);
    let mut x = sheet.positions().to_vec();
    x[3] += 0.01;
    let error = Simulation::new(pinned(1, 0.05), State::at_rest(x), Method::default());
    let message = error.err().expect("refused").to_string();
    assert!(
        message.contains("edge") && message.contains("too short"),
        "{message}"
    );

    let mut x = sheet.positions().to_vec();
    x[7] = f64::NAN;
    let error = Simulation::new(pinned(1, 0.05), State::at_rest(x), Method::default());
    assert!(error.err().expect("refused").to_string().contains("NaN"));

    let short = State::at_rest(vec![0.0; 6]);
    assert!(Simulation::new(pinned(1, 0.05), short, Method::default()).is_err());

    let mut run = hanging(1, 0.05, Method::default());
    for h in [0.0, -1.0, f64::NAN, f64::INFINITY] {
        assert!(
            matches!(run.step(h), Err(StepError::StepSize { .. })),
            "{h}"
        );
    }
    assert!(pinned(1, 0.0).with_pins(&[VertexId(1000)]).is_err());
    assert_eq!(corner(1), VertexId(20));
}
