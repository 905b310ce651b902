//! Both charts: rows, rates, Jacobians, positions, conditioning and refusals.

use crate::assignment::{AssignmentOptions, Degenerate};
use crate::cartesian_chart::{CartesianChart, Choice};
use crate::chart::{Chart, ChartError};
use crate::condition::{
    BentState, TableChart, bent_square, condition_table, mass_condition, mass_condition_estimate,
    mass_matrix,
};
use crate::front_chart::FrontChart;
use crate::linearised::Linearised;
use crate::saddle::SaddlePoint;
use crate::system::RodSystem;
use crate::testing::{bent, irregular_grid, isotropic_square};
use isosheet_mesh::{MassKind, MassMatrix, Sheet, VertexId};
use proptest::prelude::*;

fn front(sheet: &Sheet, pins: &[VertexId], x: &[f64]) -> FrontChart {
    let options = AssignmentOptions {
        pins: pins.to_vec(),
        degenerate: Degenerate::Assign,
        ..Default::default()
    };
    FrontChart::new(sheet, &options, x).unwrap()
}

struct Case {
    name: String,
    system: RodSystem,
    chart: Box<dyn Chart>,
    sheet: Sheet,
    x: Vec<f64>,
}

/// Union-jack squares and irregular meshes, free and pinned, in both charts.
fn cases() -> Vec<Case> {
    let mut cases = Vec::new();
    let mut add = |name: &str, sheet: Sheet, pins: Vec<VertexId>, seed: u64| {
        // Not every noise leads Newton's method to a state with exact lengths.
        let x = (seed..seed + 50)
            .find_map(|s| bent(&sheet, &pins, 0.1, s))
            .unwrap_or_else(|| panic!("no bent state for {name}"));
        let system = RodSystem::new(&sheet, &pins).unwrap();
        let cartesian = CartesianChart::new(system.clone(), Choice::Auto, &x).unwrap();
        for chart in [
            Box::new(front(&sheet, &pins, &x)) as Box<dyn Chart>,
            Box::new(cartesian),
        ] {
            cases.push(Case {
                name: name.to_owned(),
                system: system.clone(),
                chart,
                sheet: sheet.clone(),
                x: x.clone(),
            });
        }
    };
    let v = VertexId;
    add("M^0 free", isotropic_square(0, 1.0), vec![], 1);
    add("M^0 pinned", isotropic_square(0, 1.0), vec![v(2)], 2);
    add(
        "M^0 two pins",
        isotropic_square(0, 1.0),
        vec![v(0), v(1)],
        3,
    );
    add("M^1 pinned", isotropic_square(1, 1.0), vec![v(0)], 4);
    add("irregular", irregular_grid(3, 1), vec![v(1)], 5);
    add("irregular free", irregular_grid(3, 7), vec![], 6);
    add("irregular, inner pin", irregular_grid(4, 3), vec![v(12)], 7);
    cases
}

fn velocity(system: &RodSystem, seed: f64) -> Vec<f64> {
    let reduced: Vec<f64> = (0..system.unknowns())
        .map(|i| (seed + 1.7 * i as f64).sin())
        .collect();
    let mut v = vec![0.0; 3 * system.vertex_count()];
    system.scatter(&reduced, &mut v);
    v
}

fn along(x: &[f64], v: &[f64], t: f64) -> Vec<f64> {
    x.iter().zip(v).map(|(x, v)| x + t * v).collect()
}

#[test]
fn rows_are_gradients_and_rates_their_derivatives() {
    for case in cases() {
        let chart = case.chart.as_ref();
        let n = chart.dimension();
        assert_eq!(n, case.system.dof(), "{}", case.name);
        let v = velocity(&case.system, 0.3);
        let mut reduced = vec![0.0; case.system.unknowns()];
        case.system.gather(&v, &mut reduced);
        let mut rows = vec![0.0; chart.pattern().len()];
        chart.rows(&case.x, &mut rows).unwrap();
        let mut exact = vec![0.0; n];
        chart.pattern().apply(&rows, &reduced, &mut exact);
        let h = 1e-5;
        let coordinates = |t: f64| {
            let mut q = vec![0.0; n];
            chart.coordinates(&along(&case.x, &v, t), &mut q).unwrap();
            q
        };
        let mut difference = vec![0.0; n];
        chart.difference(&coordinates(h), &coordinates(-h), &mut difference);
        for k in 0..n {
            let d = difference[k] / (2.0 * h);
            let size = 1.0 + exact[k].abs();
            assert!((d - exact[k]).abs() < 1e-5 * size, "{} row {k}", case.name);
        }
        let mut rate = vec![0.0; rows.len()];
        chart.rows_rate(&case.x, &v, &mut rate).unwrap();
        let values = |t: f64| {
            let mut r = vec![0.0; rows.len()];
            chart.rows(&along(&case.x, &v, t), &mut r).unwrap();
            r
        };
        let (a, b) = (values(-h), values(h));
        for i in 0..rows.len() {
            let d = (b[i] - a[i]) / (2.0 * h);
            let size = 1.0 + rate[i].abs() + rows[i] * rows[i];
            assert!((d - rate[i]).abs() < 1e-4 * size, "{} entry {i}", case.name);
        }
    }
}

#[test]
fn jacobians_invert_the_rows() {
    for case in cases() {
        let chart = case.chart.as_ref();
        let mut linear = Linearised::new(&case.system, chart.pattern()).unwrap();
        let jacobian = chart.jacobian(&case.system, &mut linear, &case.x).unwrap();
        let solved = linear.jacobian().unwrap();
        let size = jacobian.amax();
        assert!(
            (&jacobian - &solved).amax() < 1e-7 * size,
            "{} {:e}",
            case.name,
            (&jacobian - &solved).amax() / size
        );
        let mut full = vec![0.0; case.x.len()];
        let mut c = vec![0.0; case.system.equations()];
        let mut s = vec![0.0; chart.dimension()];
        for (k, column) in jacobian.column_iter().enumerate() {
            case.system.scatter(column.as_slice(), &mut full);
            case.system.apply(&case.x, &full, &mut c);
            assert!(c.iter().all(|v| v.abs() < 1e-8 * size), "{}", case.name);
            chart
                .pattern()
                .apply(linear.rows(), column.as_slice(), &mut s);
            for (i, v) in s.iter().enumerate() {
                let delta = f64::from(u8::from(i == k));
                assert!((v - delta).abs() < 1e-6, "{} {i} {k} {v}", case.name);
            }
        }
        // pull is the transpose of push.
        let w: Vec<f64> = (0..case.system.unknowns())
            .map(|i| (i as f64).cos())
            .collect();
        let (mut mu, mut p) = (vec![0.0; c.len()], vec![0.0; s.len()]);
        linear.pull(&w, &mut mu, &mut p).unwrap();
        for (k, column) in jacobian.column_iter().enumerate() {
            let exact: f64 = column.iter().zip(&w).map(|(a, b)| a * b).sum();
            assert!((p[k] - exact).abs() < 1e-7 * size * size, "{}", case.name);
        }
    }
}

#[test]
fn realisation_follows_the_jacobian() {
    for case in cases() {
        let chart = case.chart.as_ref();
        let n = chart.dimension();
        let mut linear = Linearised::new(&case.system, chart.pattern()).unwrap();
        let jacobian = chart.jacobian(&case.system, &mut linear, &case.x).unwrap();
        // A coordinate change that moves positions by about 1e-4.
        let mut dq: Vec<f64> = (0..n).map(|k| (0.7 + 2.3 * k as f64).sin()).collect();
        let scale = 1e-4 / jacobian.amax();
        dq.iter_mut().for_each(|d| *d *= scale);
        let mut q = vec![0.0; n];
        chart.coordinates(&case.x, &mut q).unwrap();
        let target: Vec<f64> = q.iter().zip(&dq).map(|(q, d)| q + d).collect();
        let mut y = vec![0.0; case.x.len()];
        chart
            .realise(&mut linear, &target, &case.x, &mut y)
            .unwrap_or_else(|e| panic!("{}: {e}", case.name));
        assert!(case.system.max_strain(&y) < 1e-11, "{}", case.name);
        let mut back = vec![0.0; n];
        chart.coordinates(&y, &mut back).unwrap();
        let mut error = vec![0.0; n];
        chart.difference(&back, &target, &mut error);
        assert!(error.iter().all(|e| e.abs() < 1e-9), "{}", case.name);
        let predicted = &jacobian * nalgebra::DVector::from_column_slice(&dq);
        let mut reduced = vec![0.0; case.system.unknowns()];
        case.system.gather(&along(&y, &case.x, -1.0), &mut reduced);
        for (a, b) in reduced.iter().zip(predicted.iter()) {
            assert!((a - b).abs() < 1e-5, "{} {a} {b}", case.name);
        }
    }
}

proptest! {
    #![proptest_config(isosheet_random::cases(64))]

    /// Any regular state of any mesh, in both charts: coordinates to positions and back.
    #[test]
    fn charts_round_trip(kind in 0..3u32, seed in 0..10_000u64, pin in 0..9u32, move_by in -0.5..0.5f64) {
        let sheet = match kind {
            0 => isotropic_square(0, 1.0),
            1 => isotropic_square(1, 1.0),
            _ => irregular_grid(3, seed),
        };
        let pins = [VertexId(pin)];
        let Some(x) = bent(&sheet, &pins, 0.1, seed) else { return Ok(()) };
        let system = RodSystem::new(&sheet, &pins).unwrap();
        let cartesian = CartesianChart::new(system.clone(), Choice::Auto, &x).unwrap();
        for chart in [Box::new(front(&sheet, &pins, &x)) as Box<dyn Chart>, Box::new(cartesian)] {
            let n = chart.dimension();
            prop_assert_eq!(n, system.dof());
            let mut linear = Linearised::new(&system, chart.pattern()).unwrap();
            let jacobian = chart.jacobian(&system, &mut linear, &x).unwrap();
            let mut q = vec![0.0; n];
            chart.coordinates(&x, &mut q).unwrap();
            for (k, value) in q.iter_mut().enumerate() {
                *value += 1e-3 * move_by * (2.0 * k as f64).cos() / jacobian.amax();
            }
            let mut y = vec![0.0; x.len()];
            chart.realise(&mut linear, &q, &x, &mut y).unwrap();
            prop_assert!(system.max_strain(&y) < 1e-11);
            let (mut back, mut error) = (vec![0.0; n], vec![0.0; n]);
            chart.coordinates(&y, &mut back).unwrap();
            chart.difference(&back, &q, &mut error);
            prop_assert!(error.iter().all(|e| e.abs() < 1e-9), "{error:?}");
            // And from there to the start.
            chart.coordinates(&x, &mut q).unwrap();
            let mut z = vec![0.0; x.len()];
            chart.realise(&mut linear, &q, &y, &mut z).unwrap();
            let worst = x.iter().zip(&z).map(|(a, b)| (a - b).abs()).fold(0.0, f64::max);
            prop_assert!(worst < 1e-8 * jacobian.amax().max(1.0), "{worst}");
        }
    }
}

#[test]
fn the_mass_matrix_solve_is_a_saddle_point_solve() {
    for case in cases() {
        let chart = case.chart.as_ref();
        for kind in [MassKind::Lumped, MassKind::Consistent] {
            let mass = MassMatrix::from_density(&case.sheet, 0.3, kind).unwrap();
            let mut linear = Linearised::new(&case.system, chart.pattern()).unwrap();
            let jacobian = chart.jacobian(&case.system, &mut linear, &case.x).unwrap();
            let c = mass_matrix(&case.system, &mass, &jacobian);
            let qdot = nalgebra::DVector::from_fn(chart.dimension(), |k, _| (k as f64).cos());
            let p = &c * &qdot;
            let mut saddle = SaddlePoint::new(&case.system, &mass).unwrap();
            saddle.factorize(&case.system, &case.x).unwrap();
            let n = case.system.unknowns();
            let mut force = vec![0.0; n];
            chart
                .pattern()
                .add_transpose(linear.rows(), p.as_slice(), &mut force);
            let (mut v, mut mu) = (vec![0.0; n], vec![0.0; case.system.equations()]);
            let zero = vec![0.0; mu.len()];
            saddle.solve(&force, &zero, &mut v, &mut mu).unwrap();
            let exact = &jacobian * &qdot;
            let size = exact.amax();
            let condition = mass_condition(&case.system, chart, &mass, &case.x).unwrap();
            for i in 0..n {
                let bound = (1e-13 * condition + 1e-9) * size;
                assert!((v[i] - exact[i]).abs() < bound, "{} {}", case.name, v[i]);
            }
        }
    }
}

#[test]
fn condition_numbers_of_the_design() {
    let table = condition_table(0..=4).unwrap();
    let find = |level, state, chart| {
        table
            .iter()
            .find(|r| r.level == level && r.state == state && r.chart == chart)
            .map(|r| r.condition)
            .unwrap()
    };
    for state in [BentState::Noise, BentState::Cylinder] {
        for level in 0..=4 {
            let corner = find(level, state, TableChart::FrontCorner);
            let centre = find(level, state, TableChart::FrontCentre);
            let cartesian = find(level, state, TableChart::Cartesian);
            // Cartesian: grows like the number of faces. Fronts: exponentially with their number,
            // twice as fast from the corner as from the centre.
            let bound = 30.0 * 4f64.powi(level as i32);
            assert!(
                cartesian > 2.0 && cartesian < bound,
                "M^{level} {cartesian:e}"
            );
            let least = match level {
                0 => [20.0, 10.0],
                1 => [1e4, 3e2],
                2 => [1e7, 1e5],
                3 => [1e20, 1e17],
                _ => [1e50, 1e35],
            };
            assert!(corner > least[0], "M^{level} {state:?} corner {corner:e}");
            assert!(centre > least[1], "M^{level} {state:?} centre {centre:e}");
        }
    }
}

#[test]
fn estimate_agrees_with_eigenvalues() {
    for (level, state) in [(1, BentState::Noise), (2, BentState::Cylinder)] {
        let sheet = isotropic_square(level, 1.0);
        let x = bent_square(&sheet, level, state);
        let mass = MassMatrix::from_density(&sheet, 1.0, MassKind::Lumped).unwrap();
        let system = RodSystem::new(&sheet, &[VertexId(0)]).unwrap();
        let chart = CartesianChart::new(system.clone(), Choice::Auto, &x).unwrap();
        let exact = mass_condition(&system, &chart, &mass, &x).unwrap();
        let estimate = mass_condition_estimate(&system, &chart, &mass, &x).unwrap();
        assert!(
            estimate <= exact * 1.001 && estimate > 0.3 * exact,
            "{estimate} {exact}"
        );
    }
}

#[test]
fn the_three_selections() {
    let sheet = isotropic_square(2, 1.0);
    let mass = MassMatrix::from_density(&sheet, 1.0, MassKind::Lumped).unwrap();
    let system = RodSystem::new(&sheet, &[VertexId(0)]).unwrap();
    for state in [BentState::Noise, BentState::Cylinder] {
        let x = bent_square(&sheet, 2, state);
        let condition = |choice| {
            let chart = CartesianChart::new(system.clone(), choice, &x).unwrap();
            mass_condition(&system, &chart, &mass, &x).unwrap()
        };
        let dense = condition(Choice::PivotedQr);
        let exchanged = condition(Choice::Exchange);
        let eliminated = condition(Choice::Elimination);
        assert!(exchanged < 3.0 * dense, "{exchanged} {dense}");
        assert!(eliminated < 10.0 * dense, "{eliminated} {dense}");
    }
}

#[test]
fn flat_sheets_are_refused() {
    let sheet = isotropic_square(1, 1.0);
    let system = RodSystem::new(&sheet, &[VertexId(0)]).unwrap();
    for choice in [Choice::PivotedQr, Choice::Exchange, Choice::Elimination] {
        let error = CartesianChart::new(system.clone(), choice, sheet.positions())
            .err()
            .unwrap();
        // 56 rods, 9 of them redundant in the plane (V_i = 9).
        assert_eq!(
            error,
            ChartError::RankDeficient {
                equations: 56,
                rank: 47
            }
        );
    }
    // The front chart: with the degenerate placements kept it has no derivatives, with coordinates
    // assigned to them the closures are dependent.
    for degenerate in [Degenerate::Carry, Degenerate::Assign] {
        let options = AssignmentOptions {
            pins: vec![VertexId(0)],
            degenerate,
            ..Default::default()
        };
        let outcome = FrontChart::new(&sheet, &options, sheet.positions()).and_then(|chart| {
            let mut linear = Linearised::new(&system, chart.pattern())?;
            chart.jacobian(&system, &mut linear, sheet.positions())
        });
        assert!(outcome.is_err(), "{degenerate:?}");
    }
}

#[test]
fn a_sheet_that_is_pinned_everywhere_has_no_chart() {
    let sheet = isotropic_square(0, 1.0);
    let pins: Vec<VertexId> = (0..9).map(VertexId).collect();
    let system = RodSystem::new(&sheet, &pins).unwrap();
    let refusal = ChartError::System(crate::system::SystemError::NoFreedom {
        equations: 0,
        unknowns: 0,
    });
    for choice in [
        Choice::Auto,
        Choice::PivotedQr,
        Choice::Exchange,
        Choice::Elimination,
    ] {
        let outcome = CartesianChart::new(system.clone(), choice, sheet.positions());
        assert_eq!(outcome.err().as_ref(), Some(&refusal), "{choice:?}");
    }
    let options = AssignmentOptions {
        pins,
        ..Default::default()
    };
    let outcome = FrontChart::new(&sheet, &options, sheet.positions());
    assert!(outcome.is_err());
}
