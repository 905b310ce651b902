//! Solvers against each other, derivatives against differences, orders against closed forms, refusals.

mod orders;

use super::*;
use isosheet_coords::assignment::{AssignmentOptions, Degenerate};
use isosheet_coords::{CartesianChart, Chart, ChartError, Choice, FrontChart, RodSystem};
use isosheet_dynamics::{SheetModel, State};
use isosheet_mesh::{MassKind, MassMatrix, Sheet, VertexId};
use std::f64::consts::PI;

/// The union-jack square with a bump: the rest shape itself is bent, so that it is a regular state.
fn bumped(level: u32, height: f64) -> Sheet {
    let flat = isosheet_mesh::generate::isotropic_square(level, 1.0).unwrap();
    let mut x = flat.positions().to_vec();
    for p in x.chunks_exact_mut(3) {
        // Not symmetric, or the pinned corner and the centre would make a special case.
        p[2] = height * (PI * p[0]).sin() * (0.3 + (2.0 * p[1] + 0.4).sin());
    }
    Sheet::new(x, &flat.face_indices()).unwrap()
}

fn front(sheet: &Sheet, pins: &[VertexId]) -> Box<dyn Chart> {
    let options = AssignmentOptions {
        pins: pins.to_vec(),
        degenerate: Degenerate::Assign,
        ..Default::default()
    };
    Box::new(FrontChart::new(sheet, &options, sheet.positions()).unwrap())
}

fn cartesian(sheet: &Sheet, pins: &[VertexId]) -> Box<dyn Chart> {
    let system = RodSystem::new(sheet, pins).unwrap();
    Box::new(CartesianChart::new(system, Choice::Auto, sheet.positions()).unwrap())
}

fn both(sheet: &Sheet, pins: &[VertexId]) -> [Box<dyn Chart>; 2] {
    [front(sheet, pins), cartesian(sheet, pins)]
}

fn model(sheet: &Sheet, pins: &[VertexId], kind: MassKind) -> SheetModel {
    SheetModel::new(sheet, 0.1, kind)
        .unwrap()
        .with_gravity()
        .with_pins(pins)
        .unwrap()
}

fn numbers(n: usize, seed: f64) -> Vec<f64> {
    (0..n).map(|k| (seed + 1.9 * k as f64).sin()).collect()
}

#[test]
fn solvers_agree() {
    let kinds = [
        MassSolverKind::Saddle,
        MassSolverKind::DenseLu,
        MassSolverKind::Cramer,
    ];
    for (level, kind) in [(0, MassKind::Lumped), (1, MassKind::Consistent)] {
        let sheet = bumped(level, 0.1);
        let pins = [VertexId(0)];
        let reference = {
            let chart = cartesian(&sheet, &pins);
            let mut m = ChartMechanics::new(model(&sheet, &pins, kind), chart, kinds[0]).unwrap();
            let n = m.dimension();
            m.at(sheet.positions()).unwrap();
            let mut p = vec![0.0; n];
            m.momenta(&numbers(sheet.positions().len(), 0.2), &mut p)
                .unwrap();
            p
        };
        let n = reference.len();
        let mut answers = Vec::new();
        for solver in kinds {
            let chart = cartesian(&sheet, &pins);
            let mut m = ChartMechanics::new(model(&sheet, &pins, kind), chart, solver).unwrap();
            m.at(sheet.positions()).unwrap();
            let (mut qdot, mut gradient) = (vec![0.0; n], vec![0.0; n]);
            m.solver().velocity(&reference, &mut qdot).unwrap();
            m.solver()
                .momentum_gradient(&reference, &mut gradient)
                .unwrap();
            let size = qdot.iter().fold(0.0f64, |s, v| s.max(v.abs()));
            for (a, b) in qdot.iter().zip(&gradient) {
                assert!((a - b).abs() < 1e-9 * size, "{solver:?}: dH/dp = qdot");
            }
            answers.push(qdot);
        }
        let size = answers[0].iter().fold(0.0f64, |s, v| s.max(v.abs()));
        for (solver, answer) in kinds.iter().zip(&answers) {
            for (a, b) in answer.iter().zip(&answers[0]) {
                assert!((a - b).abs() < 1e-9 * size, "M^{level} {solver:?} {a} {b}");
            }
        }
    }
}

#[test]
fn momenta_and_velocities_are_inverse() {
    let sheet = bumped(1, 0.1);
    for chart in both(&sheet, &[VertexId(0)]) {
        let m = model(&sheet, &[VertexId(0)], MassKind::Consistent);
        let mut m = ChartMechanics::new(m, chart, MassSolverKind::Saddle).unwrap();
        m.at(sheet.positions()).unwrap();
        let n = m.dimension();
        let p = numbers(n, 0.5);
        let (mut qdot, mut back) = (vec![0.0; n], vec![0.0; n]);
        let mut v = vec![0.0; sheet.positions().len()];
        m.velocity(&p, &mut qdot, &mut v).unwrap();
        m.momenta(&v, &mut back).unwrap();
        for (a, b) in p.iter().zip(&back) {
            assert!((a - b).abs() < 1e-8, "{a} {b}");
        }
        // Eq. 17: H = T + V, T from the vertices' velocities.
        let h = m.hamiltonian(0.0, sheet.positions(), &p).unwrap();
        let energy =
            m.model().kinetic_energy(&v) + m.model().potential_energy(0.0, sheet.positions());
        assert!((h - energy).abs() < 1e-9 * h.abs().max(1.0), "{h} {energy}");
    }
}

/// `dH/dq` by central differences of H(q, p) through exact realisation.
#[test]
fn momentum_rate_is_minus_the_gradient_of_the_hamiltonian() {
    let cases: [(Sheet, Vec<VertexId>); 3] = [
        (bumped(0, 0.15), vec![VertexId(0)]),
        (bumped(1, 0.2), vec![VertexId(12)]),
        (bumped(0, 0.15), vec![]),
    ];
    for (sheet, pins) in cases {
        for chart in both(&sheet, &pins) {
            let x = sheet.positions();
            let m = model(&sheet, &pins, MassKind::Lumped);
            let mut m = ChartMechanics::new(m, chart, MassSolverKind::Saddle).unwrap();
            let n = m.dimension();
            let (mut q, mut p) = (vec![0.0; n], vec![0.0; n]);
            let (mut qdot, mut v) = (vec![0.0; n], vec![0.0; x.len()]);
            m.at(x).unwrap();
            m.coordinates(x, &mut q).unwrap();
            // Velocities of about 1 m/s.
            m.momenta(&numbers(x.len(), 0.4), &mut p).unwrap();
            m.velocity(&p, &mut qdot, &mut v).unwrap();
            let rate = |m: &mut ChartMechanics, equations| {
                let mut pdot = vec![0.0; n];
                m.momentum_rate(0.0, x, &v, equations, &mut pdot).unwrap();
                pdot
            };
            let full = rate(&mut m, Equations::Full);
            let simplified = rate(&mut m, Equations::Published);
            let size = full.iter().fold(0.0f64, |s, f| s.max(f.abs()));
            let mut y = vec![0.0; x.len()];
            for k in 0..n {
                let mut energies = |t: f64| {
                    let mut moved = q.clone();
                    moved[k] += t;
                    m.realise(&moved, x, &mut y).unwrap();
                    m.at(&y).unwrap();
                    let h = m.hamiltonian(0.0, &y, &p).unwrap();
                    (h, m.model().potential_energy(0.0, &y))
                };
                let h = 1e-5;
                let (a, b) = (energies(-h), energies(h));
                let slope = (b.0 - a.0) / (2.0 * h);
                assert!((slope + full[k]).abs() < 1e-5 * size, "{slope} {}", full[k]);
                let slope = (b.1 - a.1) / (2.0 * h);
                assert!((slope + simplified[k]).abs() < 1e-5 * size);
            }
        }
    }
}

#[test]
fn adaptive_step_bounds_the_energy_change() {
    let sheet = bumped(1, 0.1);
    let pins = [VertexId(0)];
    let tolerance = 1e-5;
    let options = ChartOptions {
        control: ChartStepControl::Adaptive {
            tolerance,
            min: 1e-7,
            max: 0.02,
        },
        ..Default::default()
    };
    let v = vec![0.0; sheet.positions().len()];
    let m = model(&sheet, &pins, MassKind::Lumped);
    let chart = cartesian(&sheet, &pins);
    let mut s = ChartSimulation::new(m, chart, options, sheet.positions(), &v).unwrap();
    let mut before = s.hamiltonian();
    while s.time() < 0.1 {
        let report = s.step().unwrap();
        assert!(report.energy_change.abs() < tolerance);
        assert!((s.hamiltonian() - before - report.energy_change).abs() < 1e-12);
        assert!(report.strain < 1e-11);
        before = s.hamiltonian();
    }
    let range = s.step_range();
    assert!(
        range.min > 1e-7 && range.max <= 0.02 && range.max > range.min,
        "{range:?}"
    );
    // Too small a smallest step is refused with the reason, not cut silently.
    let hard = ChartOptions {
        control: ChartStepControl::Adaptive {
            tolerance: 1e-12,
            min: 0.01,
            max: 0.02,
        },
        ..Default::default()
    };
    let m = model(&sheet, &pins, MassKind::Lumped);
    let chart = cartesian(&sheet, &pins);
    let mut s = ChartSimulation::new(m, chart, hard, sheet.positions(), &v).unwrap();
    assert!(matches!(
        s.step(),
        Err(ChartDynamicsError::StepTooSmall { .. })
    ));
}

#[test]
fn one_call_takes_no_more_than_so_many_steps() {
    let sheet = bumped(1, 0.1);
    let pins = [VertexId(0)];
    let options = ChartOptions {
        control: ChartStepControl::Fixed(1e-3),
        max_steps: 5,
        ..Default::default()
    };
    let m = model(&sheet, &pins, MassKind::Lumped);
    let start = State::at_rest(sheet.positions().to_vec());
    let mut s = in_chart(m, start, cartesian(&sheet, &pins), options).unwrap();
    assert_eq!(s.step(4e-3).unwrap().substeps, 4);
    let error = s.step(8e-3).unwrap_err().to_string();
    assert!(error.contains("5 steps"), "{error}");
    // What was reached stays, and the way on is open.
    assert!((s.state().t - 9e-3).abs() < 1e-15);
    assert_eq!(s.step(4e-3).unwrap().substeps, 4);
}

#[test]
fn singular_and_ill_conditioned_charts_are_refused() {
    let pins = [VertexId(0)];
    let flat = isosheet_mesh::generate::isotropic_square(1, 1.0).unwrap();
    let v = vec![0.0; flat.positions().len()];
    let options = AssignmentOptions {
        pins: pins.to_vec(),
        ..Default::default()
    };
    let chart = FrontChart::new(&flat, &options, flat.positions()).unwrap();
    let outcome = ChartSimulation::new(
        model(&flat, &pins, MassKind::Lumped),
        Box::new(chart),
        ChartOptions::default(),
        flat.positions(),
        &v,
    );
    assert!(matches!(outcome.err(), Some(ChartDynamicsError::Chart(_))));
    // M^3 from the corner: a condition number of 1e20 and more.
    let sheet = bumped(3, 0.1);
    let outcome = ChartSimulation::new(
        model(&sheet, &pins, MassKind::Lumped),
        Box::new(FrontChart::new(&sheet, &options, sheet.positions()).unwrap()),
        ChartOptions::default(),
        sheet.positions(),
        &vec![0.0; sheet.positions().len()],
    );
    let error = outcome.err().unwrap();
    assert!(
        matches!(
            error,
            ChartDynamicsError::Chart(ChartError::IllConditioned { .. } | ChartError::Linalg(_))
        ),
        "{error}"
    );
    assert!(matches!(
        MassSolverKind::Cramer.build(
            &RodSystem::new(&sheet, &pins).unwrap(),
            &MassMatrix::from_total(&sheet, 1.0, MassKind::Lumped).unwrap()
        ),
        Err(ChartDynamicsError::TooManyCoordinates { .. })
    ));
}

#[test]
fn charts_for_other_pins_are_refused_as_such() {
    let sheet = bumped(1, 0.1);
    for chart in both(&sheet, &[VertexId(0)]) {
        let outcome = ChartSimulation::new(
            model(&sheet, &[VertexId(4)], MassKind::Lumped),
            chart,
            ChartOptions::default(),
            sheet.positions(),
            &vec![0.0; sheet.positions().len()],
        );
        assert_eq!(
            outcome.err(),
            Some(ChartDynamicsError::OtherPins {
                vertex: VertexId(0)
            })
        );
    }
    let other = bumped(0, 0.1);
    let outcome = ChartMechanics::new(
        model(&sheet, &[VertexId(0)], MassKind::Lumped),
        cartesian(&other, &[VertexId(0)]),
        MassSolverKind::Saddle,
    );
    let text = outcome.err().unwrap().to_string();
    assert!(text.contains("the chart's sheet"), "{text}");
}

#[derive(Debug)]
struct Wind([f64; 3]);

impl isosheet_dynamics::Force for Wind {
    fn add_force(&self, _t: f64, _x: &[f64], v: &[f64], force: &mut [f64]) {
        // Drag relative to the wind, 0.01 N per m/s and vertex.
        for (f, v) in force.chunks_exact_mut(3).zip(v.chunks_exact(3)) {
            for i in 0..3 {
                f[i] += 0.01 * (self.0[i] - v[i]);
            }
        }
    }
}

/// Sec. 5: a generalised force does the same work as the force on the vertices.
#[test]
fn generalised_forces_do_the_same_work() {
    let sheet = bumped(1, 0.2);
    let pins = [VertexId(3)];
    let x = sheet.positions();
    for chart in both(&sheet, &pins) {
        let with = model(&sheet, &pins, MassKind::Lumped).with_force(Wind([1.0, 2.0, -0.5]));
        let mut m = ChartMechanics::new(with, chart, MassSolverKind::Saddle).unwrap();
        let n = m.dimension();
        let p = numbers(n, 0.1);
        let (mut qdot, mut v) = (vec![0.0; n], vec![0.0; x.len()]);
        m.at(x).unwrap();
        m.velocity(&p, &mut qdot, &mut v).unwrap();
        let mut f = vec![0.0; x.len()];
        m.model().applied_force(0.0, x, &v, &mut f);
        let work: f64 = f.iter().zip(&v).map(|(f, v)| f * v).sum();
        let mut q = vec![0.0; n];
        m.generalised_force(&f, &mut q).unwrap();
        let same: f64 = q.iter().zip(&qdot).map(|(q, r)| q * r).sum();
        assert!((work - same).abs() < 1e-8 * work.abs(), "{work} {same}");
        // It enters the rate of the momenta as it is.
        let (mut total, mut without) = (vec![0.0; n], vec![0.0; n]);
        m.momentum_rate(0.0, x, &v, Equations::Published, &mut total)
            .unwrap();
        m.model().potential_force(0.0, x, &mut f);
        m.generalised_force(&f, &mut without).unwrap();
        for k in 0..n {
            let size = q[k].abs() + without[k].abs();
            assert!((total[k] - without[k] - q[k]).abs() < 1e-8 * size.max(1e-3));
        }
    }
}

/// The linear position update of a blown-up run ends with an error, not with numbers.
#[test]
fn divergence_is_reported() {
    let sheet = bumped(1, 0.1);
    let pins = [VertexId(0)];
    let options = ChartOptions {
        equations: Equations::Published,
        position: PositionUpdate::Linear,
        control: ChartStepControl::Fixed(5e-3),
        ..Default::default()
    };
    let m = model(&sheet, &pins, MassKind::Lumped);
    let v = vec![0.0; sheet.positions().len()];
    let mut s =
        ChartSimulation::new(m, front(&sheet, &pins), options, sheet.positions(), &v).unwrap();
    let outcome = (0..2000).find_map(|_| s.step().err());
    assert!(
        matches!(
            outcome,
            Some(ChartDynamicsError::Diverged { .. } | ChartDynamicsError::Chart(_))
        ),
        "{outcome:?}"
    );
    assert!(s.positions().iter().all(|c| c.is_finite()));
}

#[test]
fn options_are_checked() {
    let bad = |change: fn(&mut ChartOptions)| {
        let mut o = ChartOptions::default();
        change(&mut o);
        o.validate().unwrap_err()
    };
    assert!(matches!(
        bad(|o| o.control = ChartStepControl::Fixed(-1.0)),
        ChartDynamicsError::Option { .. }
    ));
    assert!(matches!(
        bad(|o| o.control = ChartStepControl::Adaptive {
            tolerance: 1.0,
            min: 2.0,
            max: 1.0
        }),
        ChartDynamicsError::Option { .. }
    ));
    assert!(matches!(
        bad(|o| {
            o.method = ChartMethod::RungeKutta4;
            o.equations = Equations::Published;
        }),
        ChartDynamicsError::Combination { .. }
    ));
    ChartOptions::default().validate().unwrap();
}

/// A large motion with many turns: the chart is rebased on the way and energy stays.
#[test]
fn rebasing_keeps_the_motion() {
    let x = vec![0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.4, 0.9, 0.0];
    let sheet = Sheet::new(x, &[[0, 1, 2]]).unwrap();
    let v = vec![0.0, 0.0, 3.0, 0.0, 0.0, -4.0, 1.0, 0.0, 0.5];
    for build in [
        front as fn(&Sheet, &[VertexId]) -> Box<dyn Chart>,
        cartesian,
    ] {
        let m = SheetModel::new(&sheet, 1.0, MassKind::Lumped).unwrap();
        let options = ChartOptions {
            method: ChartMethod::RungeKutta4,
            control: ChartStepControl::Fixed(2e-3),
            condition_interval: 10,
            condition_limit: 1e4,
            ..Default::default()
        };
        let mut s =
            ChartSimulation::new(m, build(&sheet, &[]), options, sheet.positions(), &v).unwrap();
        let start = s.hamiltonian();
        for _ in 0..1000 {
            s.step().unwrap();
        }
        assert!(
            (s.hamiltonian() - start).abs() < 1e-5 * start,
            "{start} {}",
            s.hamiltonian()
        );
    }
}
