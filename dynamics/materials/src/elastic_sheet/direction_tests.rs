//! Sheets whose material has directions, against closed forms and differences.

use super::*;
use crate::testing::hessian;
use crate::{MaterialDirection, PlateLaw};
use isosheet_mesh::{Advice, VertexId, generate};
use nalgebra::{DMatrix, DVector};
use rand::{RngExt, SeedableRng};
use rand_chacha::ChaCha8Rng;

/// As cloth: soft in shear.
fn cloth(angle: f64) -> OrthotropicMembrane {
    OrthotropicMembrane {
        along: 4000.0,
        across: 2500.0,
        shear: 90.0,
        poisson: 0.25,
        direction: MaterialDirection::Uniform([angle.cos(), angle.sin(), 0.0]),
    }
}

const LENGTH: f64 = 1.0;
const WIDTH: f64 = 0.25;

fn strips() -> [Sheet; 2] {
    let outline = [[0.0, 0.0], [LENGTH, 0.0], [LENGTH, WIDTH], [0.0, WIDTH]];
    [
        generate::anisotropic_grid(16, 4, LENGTH, WIDTH).unwrap(),
        generate::delaunay(&outline, 0.07, 3).unwrap(),
    ]
}

/// The forces of a pull of 1 N/m at both ends of a strip.
fn pull(sheet: &Sheet) -> Vec<f64> {
    let mut force = vec![0.0; sheet.positions().len()];
    let x = |v: VertexId| sheet.positions()[3 * v.index()];
    let topology = sheet.topology();
    for edge in topology.edge_ids() {
        let [a, b] = topology.edges()[edge.index()];
        for (end, sign) in [(0.0, -1.0), (LENGTH, 1.0)] {
            if [a, b].iter().all(|v| (x(*v) - end).abs() < 1e-9) {
                for v in [a, b] {
                    force[3 * v.index()] += sign * 0.5 * sheet.lengths()[edge.index()];
                }
            }
        }
    }
    force
}

/// How much longer and wider a strip gets by the pull, over its length and width.
fn strains(sheet: &Sheet, elastic: ElasticSheet) -> [f64; 2] {
    let at = At::new(0.0, sheet.positions());
    // Rigid motions cost next to nothing.
    let n = at.x.len();
    let matrix =
        hessian(sheet.topology(), &elastic, at) + DMatrix::from_diagonal_element(n, n, 1e-9);
    let moved = matrix.lu().solve(&DVector::from(pull(sheet))).unwrap();
    let moved = moved.as_slice();
    // Displacements are linear in the places: their slopes by least squares.
    let slope = |k: usize| {
        let points = sheet.positions().as_chunks::<3>().0.iter();
        let points: Vec<_> = points.zip(moved.as_chunks::<3>().0).collect();
        let mean = |f: &dyn Fn(&[f64; 3], &[f64; 3]) -> f64| {
            points.iter().map(|(p, d)| f(p, d)).sum::<f64>() / points.len() as f64
        };
        let rows = DMatrix::from_fn(points.len(), 3, |i, c| match c {
            2 => 1.0,
            c => points[i].0[c],
        });
        let right = DVector::from_fn(points.len(), |i, _| points[i].1[k]);
        let fit = rows.clone().svd(true, true).solve(&right, 1e-12).unwrap();
        let rest = (rows * &fit - right).amax();
        assert!(rest < 1e-6 * mean(&|_, d| d[0].abs()), "{rest}");
        fit[k]
    };
    [slope(0), slope(1)]
}

#[test]
fn a_strip_that_is_cut_at_an_angle_and_pulled_has_the_moduli_of_lekhnitskii() {
    for sheet in strips() {
        for degrees in [0.0_f64, 20.0, 45.0, 90.0, 135.0] {
            let membrane = cloth(degrees.to_radians());
            let (s, c) = degrees.to_radians().sin_cos();
            let [e1, e2, g] = [membrane.along, membrane.across, membrane.shear];
            let nu = membrane.poisson;
            let expected = [
                c.powi(4) / e1 + (1.0 / g - 2.0 * nu / e1) * (s * c).powi(2) + s.powi(4) / e2,
                (1.0 / e1 + 1.0 / e2 - 1.0 / g) * (s * c).powi(2)
                    - nu / e1 * (s.powi(4) + c.powi(4)),
            ];
            let plate = PlateBending::new(&sheet, membrane.plate(1e-3)).unwrap();
            let elastic = ElasticSheet::of_law(&sheet, membrane).unwrap();
            let found = strains(&sheet, elastic.beside(&sheet, &plate));
            for (found, expected) in found.into_iter().zip(expected) {
                let error = (found - expected).abs() / expected.abs();
                assert!(error < 1e-4, "{degrees}: {found} {expected}");
            }
        }
    }
}

/// Where it bends, and near the limit: with slack and barrier.
#[test]
fn gradients_are_differences_of_energies_where_a_sheet_bends() {
    let [_, sheet] = strips();
    let mut rng = ChaCha8Rng::seed_from_u64(9);
    let bent = sheet.positions().as_chunks::<3>().0.iter();
    let bent: Vec<f64> = bent
        .flat_map(|[x, y, _]| [0.5 * (2.0 * x).sin(), *y, 0.5 - 0.5 * (2.0 * x).cos()])
        .map(|p| p + rng.random_range(-1e-3..1e-3))
        .collect();
    let membrane = cloth(0.6);
    let plate = PlateBending::new(&sheet, membrane.plate(0.05)).unwrap();
    let elastic = ElasticSheet::of_law(&sheet, membrane).unwrap();
    let elastic = elastic.beside(&sheet, &plate).with_limit(0.15).unwrap();
    let mut memory = elastic.memory();
    let state = Reached {
        t: 0.0,
        x: &bent,
        v: &vec![0.0; bent.len()],
    };
    elastic.settle(state, &mut memory);
    memory[0] = 1.0;
    let x: Vec<f64> = (bent.iter())
        .map(|p| p + rng.random_range(-1e-3..1e-3))
        .collect();
    assert!(elastic.beyond_limit(At::new(0.0, &x)).is_none());
    let mut gradient = vec![0.0; x.len()];
    elastic.add_gradient(At::new(0.0, &x).with_memory(&memory), &mut gradient);
    let largest = gradient.iter().fold(0.0_f64, |m, g| m.max(g.abs()));
    let d = 1e-7;
    for i in 0..x.len() {
        let at = |s: f64| {
            let mut moved = x.clone();
            moved[i] += s;
            elastic.energy(At::new(0.0, &moved).with_memory(&memory))
        };
        let slope = (at(d) - at(-d)) / (2.0 * d);
        let error = (slope - gradient[i]).abs();
        assert!(error < 1e-6 * largest, "{i}: {slope} {}", gradient[i]);
    }
}

/// `D11 = E1 h^3 / (12 (1 - nu12 nu21))` and so on; an isotropic material gives Kirchhoff's plate.
#[test]
fn the_plate_of_the_same_material_has_the_rigidities_of_a_homogeneous_one() {
    let thickness = 0.02;
    let membrane = cloth(0.3);
    let cubed = thickness * thickness / 12.0;
    let free = 1.0 - 0.25 * (0.25 * 2500.0 / 4000.0);
    let plate = membrane.plate(thickness);
    let found = [plate.along, plate.across, plate.coupling, plate.twist];
    let expected = [4000.0 / free, 2500.0 / free, 0.25 * 2500.0 / free, 90.0];
    for (found, expected) in found.into_iter().zip(expected) {
        assert!((found / (expected * cubed) - 1.0).abs() < 1e-14);
    }
    assert_eq!(plate.direction, membrane.direction);
    let rigidity = PlateLaw::from(plate).rigidity();
    let mean = (4000.0_f64 * 2500.0).sqrt() / free * cubed;
    assert!((rigidity / mean - 1.0).abs() < 1e-14);
}

#[test]
fn laws_that_make_no_sense_are_refused() {
    let [sheet, _] = strips();
    let refused = |change: fn(&mut OrthotropicMembrane)| {
        let mut membrane = cloth(0.0);
        change(&mut membrane);
        let error = ElasticSheet::of_law(&sheet, membrane).unwrap_err();
        assert!(error.advice().is_some());
        error
    };
    for stiffness in [0.0, -3.0, f64::INFINITY] {
        let expected = ElasticSheetError::Stiffness { stiffness };
        let mut membrane = cloth(0.0);
        membrane.shear = stiffness;
        let found = ElasticSheet::of_law(&sheet, membrane).unwrap_err();
        assert_eq!(found, expected);
    }
    // The root of 4000 / 2500.
    let bound = 4000.0_f64 / 2500.0;
    let bound = bound.sqrt();
    assert_eq!(
        refused(|m| m.poisson = -1.3),
        ElasticSheetError::Coupling { ratio: -1.3, bound }
    );
    assert!(matches!(
        refused(|m| m.poisson = f64::NAN),
        ElasticSheetError::Coupling { .. }
    ));
    let normal = refused(|m| m.direction = MaterialDirection::Uniform([0.0, 0.0, 1.0]));
    assert!(matches!(normal, ElasticSheetError::Direction { .. }));
}
