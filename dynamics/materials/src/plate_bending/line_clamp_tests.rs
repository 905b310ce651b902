//! Clamps along a line of vertices, against closed forms and balances.

use super::line_clamp::HeldEdges;
use super::tests::{Upwards, strip};
use super::*;
use crate::MaterialDirection;
use isosheet_mesh::generate::Diagonals;
use isosheet_mesh::{MassKind, MassMatrix};
use isosheet_motion::{AxisRotation, RigidDisplacement};
use nalgebra::{DMatrix, DVector, Vector3};
use rand::{RngExt, SeedableRng};
use rand_chacha::ChaCha8Rng;

fn line(sheet: &Sheet) -> Vec<VertexId> {
    sheet.vertices_where(|[x, ..]| x < 1e-9)
}

fn clamp(sheet: &Sheet, motion: RigidDisplacement) -> LineClamp {
    LineClamp {
        vertices: line(sheet),
        positions: sheet.positions().to_vec(),
        motion: motion.into(),
    }
}

fn plate(sheet: &Sheet, clamps: &[LineClamp]) -> PlateBending {
    let edges = PlateEdges {
        clamps,
        ..PlateEdges::default()
    };
    PlateBending::held(sheet, 1.0, &edges).unwrap()
}

/// How far the vertices of a plate of rigidity 1 go under a uniform load of 1 in linear theory, clamped along
/// a line.
fn deflections(sheet: &Sheet, line: Vec<VertexId>) -> Vec<f64> {
    let clamp = LineClamp {
        vertices: line.clone(),
        ..clamp(sheet, RigidDisplacement::default())
    };
    let count = sheet.topology().vertex_count();
    let matrix = DMatrix::zeros(count, count);
    let mut upwards = Upwards { sheet, matrix };
    plate(sheet, &[clamp]).add_hessian(At::new(0.0, sheet.positions()), &mut upwards);
    let free = sheet.topology().vertex_ids().filter(|v| !line.contains(v));
    let free: Vec<usize> = free.map(VertexId::index).collect();
    let k = upwards.matrix.select_rows(&free).select_columns(&free);
    let mass = MassMatrix::from_density(sheet, 1.0, MassKind::Lumped).unwrap();
    let load = free.iter().map(|v| mass.vertex[*v]);
    let load = DVector::from_iterator(free.len(), load);
    let found = k.cholesky().expect("a hinge would be singular");
    let mut all = vec![0.0; count];
    for (v, moved) in free.iter().zip(found.solve(&load).iter()) {
        all[*v] = *moved;
    }
    all
}

/// A square plate that is clamped on all sides bends by 1.265319e-3 q a^4 / D in its middle (Taylor and
/// Govindjee, 2004): to 3 % with 16 cells across.
#[test]
fn a_plate_clamped_on_all_sides_bends_as_in_the_literature() {
    let cells = 16;
    for (diagonals, jitter) in [
        (Diagonals::UnionJack, 0.0),
        (Diagonals::Falling, 0.0),
        (Diagonals::Rising, 0.2),
    ] {
        let sheet = strip([cells; 2], [1.0; 2], diagonals, jitter, 0.0);
        let deflections = deflections(&sheet, sheet.topology().boundary_loops().concat());
        let found = deflections.into_iter().fold(0.0, f64::max);
        let error = found / 1.265_319e-3 - 1.0;
        assert!(error.abs() < 0.03, "{diagonals:?} {jitter}: {error}");
    }
}

/// A strip of rigidity 1 under a uniform load of 1, clamped at the one line of vertices at its end, bends
/// down by `L^4 / 8` in linear theory, on any mesh with an error of second order.
#[test]
fn one_line_of_vertices_is_a_clamp() {
    let length = 0.3_f64;
    let exact = length.powi(4) / 8.0;
    let patterns = [
        (Diagonals::UnionJack, 0.0),
        (Diagonals::Falling, 0.0),
        (Diagonals::Rising, 0.2),
        (Diagonals::UnionJack, 0.2),
    ];
    for (diagonals, jitter) in patterns {
        let error = |cells: usize| {
            let sheet = strip([3 * cells, cells], [length, 0.1], diagonals, jitter, 0.0);
            let deflections = deflections(&sheet, line(&sheet));
            let places = sheet.positions().as_chunks::<3>().0.iter();
            let tip = places
                .zip(deflections)
                .filter(|(p, _)| p[0] > length - 1e-9);
            let tip: Vec<f64> = tip.map(|(_, d)| d).collect();
            tip.iter().sum::<f64>() / tip.len() as f64 / exact - 1.0
        };
        let errors = [2, 4, 8].map(error);
        let what = format!("{diagonals:?} {jitter}: {errors:?}");
        assert!(errors[2].abs() < 0.01, "{what}");
        assert!(errors[2].abs() < 0.6 * errors[1].abs().max(2e-3), "{what}");
    }
}

/// A clamp that turns turns the sheet with it: in the turned positions there is no energy.
#[test]
fn a_sheet_turns_with_its_clamp() {
    let sheet = strip([6, 2], [0.3, 0.1], Diagonals::UnionJack, 0.2, 0.0);
    let turn = RigidDisplacement {
        rotation: Some(AxisRotation {
            centre: [0.0; 3],
            axis: [0.0, 1.0, 0.0],
            angle: Profile::Ramp {
                from: 0.0,
                to: 1.0,
                begin: 0.0,
                end: 1.0,
            },
        }),
        ..RigidDisplacement::default()
    };
    let plate = plate(&sheet, &[clamp(&sheet, turn)]);
    assert!(plate.is_driven());
    let turned = |angle: f64| -> Vec<f64> {
        let (s, c) = angle.sin_cos();
        let points = sheet.positions().as_chunks::<3>().0.iter();
        points
            .flat_map(|[x, y, z]| [c * x + s * z, *y, c * z - s * x])
            .collect()
    };
    let energy = |t: f64, x: &[f64]| plate.energy(At::new(t, x));
    let scale = energy(0.0, &turned(0.5));
    assert!(scale > 0.0);
    for t in [0.0, 0.5, 1.0] {
        assert!(energy(t, &turned(t)) < 1e-20 * scale, "{t}");
    }
}

/// Forces and moments on a bent sheet balance: with what the clamp does to the slopes there is no force and
/// no moment left, wherever the vertices are. Forces are differences of energies.
#[test]
fn the_moment_of_a_clamp_balances_the_forces() {
    let sheet = strip([5, 3], [0.3, 0.1], Diagonals::Rising, 0.2, 0.0);
    let clamp = clamp(&sheet, RigidDisplacement::default());
    let curl = Curl {
        direction: MaterialDirection::Uniform([1.0, 0.4, 0.0]),
        curvature: Curvature {
            along: 3.0,
            across: -1.0,
            twist: 0.5,
        }
        .into(),
        profile: Profile::Constant(1.0),
    };
    let plate = plate(&sheet, &[clamp]).with_curl(&sheet, curl).unwrap();
    let mut rng = ChaCha8Rng::seed_from_u64(4);
    let x: Vec<f64> = sheet
        .positions()
        .iter()
        .map(|x| x + 0.01 * rng.random_range(-1.0..1.0))
        .collect();
    let at = |x: &[f64]| plate.energy(At::new(0.0, x));
    let mut gradient = vec![0.0; x.len()];
    plate.add_gradient(At::new(0.0, &x), &mut gradient);
    let largest = gradient.iter().fold(0.0_f64, |m, f| m.max(f.abs()));
    for i in 0..x.len() {
        let h = 1e-6;
        let [mut up, mut down] = [x.clone(), x.clone()];
        up[i] += h;
        down[i] -= h;
        let expected = (at(&up) - at(&down)) / (2.0 * h);
        assert!((gradient[i] - expected).abs() < 1e-6 * largest, "{i}");
    }
    let vectors = |x: &[f64]| -> Vec<Vector3<f64>> {
        let points = x.as_chunks::<3>().0.iter();
        points.map(|p| Vector3::from(*p)).collect()
    };
    let (places, forces) = (vectors(&x), vectors(&gradient));
    let sum: Vector3<f64> = forces.iter().sum();
    assert!(sum.norm() < 1e-10 * largest, "{sum}");
    let turning: Vector3<f64> = places.iter().zip(&forces).map(|(x, f)| x.cross(f)).sum();
    let moment = Vector3::from(plate.clamp_moments(At::new(0.0, &x))[0]);
    assert!(moment.norm() > 1e-3 * largest, "{moment}");
    assert!(
        (turning + moment).norm() < 1e-10 * largest,
        "{turning} {moment}"
    );
}

/// Two clamps that meet at a corner hold the slopes at the edges of both.
#[test]
fn clamps_with_a_corner_in_common_hold_both_lines() {
    let sheet = strip([4, 4], [0.1, 0.1], Diagonals::UnionJack, 0.0, 0.0);
    let first = clamp(&sheet, RigidDisplacement::default());
    let second = LineClamp {
        vertices: sheet.vertices_where(|[_, y, _]| y < 1e-9),
        ..first.clone()
    };
    let clamps = [first, second];
    let held = HeldEdges::new(&sheet, &clamps);
    let directors = |number: usize| {
        let t = sheet.topology();
        let sides = t.face_ids().flat_map(|f| t.face_edges(f).map(|e| (f, e)));
        let found = sides.filter_map(|(f, e)| held.director(&sheet, f, e));
        found.filter(|(clamp, _)| *clamp == number).count()
    };
    assert_eq!([directors(0), directors(1)], [4, 4]);
}
