use super::*;
use crate::primal::{PrimalMatrix, penalties};
use crate::{
    Isometry, Method, ModelError, SheetModel, Simulation, SimulationError, State, StepError,
    project_positions,
};
use isosheet_mesh::{MassKind, generate};
use nalgebra::{DMatrix, Matrix2, Rotation3, Vector2, Vector3};
use rand::{RngExt, SeedableRng};
use rand_chacha::ChaCha8Rng;

fn irregular() -> Sheet {
    let outline = [[0.0, 0.0], [1.0, 0.0], [1.0, 1.0], [0.0, 1.0]];
    generate::delaunay(&outline, 0.25, 2).unwrap()
}

fn model(sheet: &Sheet) -> SheetModel {
    SheetModel::new(sheet, 0.3, MassKind::Lumped)
        .unwrap()
        .with_weak_isometry(WeakIsometry::new(sheet, 10.0).unwrap())
        .unwrap()
}

fn shaken(x: &[f64], size: f64, seed: u64) -> Vec<f64> {
    let mut rng = ChaCha8Rng::seed_from_u64(seed);
    x.iter()
        .map(|x| x + rng.random_range(-size..size))
        .collect()
}

/// Positions of the vertices by a function of their rest positions in the horizontal plane.
fn mapped(sheet: &Sheet, map: impl Fn(Vector2<f64>) -> Vector3<f64>) -> Vec<f64> {
    let rest = sheet.positions().as_chunks::<3>().0;
    let places = rest.iter().map(|p| map(Vector2::new(p[0], p[1])));
    places.flat_map(|p| [p.x, p.y, p.z]).collect()
}

fn residual(model: &SheetModel, x: &[f64]) -> Vec<f64> {
    let rows = model.isometry_rows();
    let mut c = vec![0.0; rows.len()];
    rows.residual_into(x, &mut c);
    c
}

/// The rows of `J` at positions `x`, all vertices free.
fn jacobian(model: &SheetModel, x: &[f64]) -> DMatrix<f64> {
    let rows = model.isometry_rows();
    let mut j = DMatrix::zeros(rows.len(), x.len());
    let (mut unit, mut column) = (vec![0.0; x.len()], vec![0.0; rows.len()]);
    for i in 0..x.len() {
        unit[i] = 1.0;
        rows.apply(x, &unit, &mut column);
        unit[i] = 0.0;
        j.column_mut(i).copy_from_slice(&column);
    }
    j
}

fn rank(j: &DMatrix<f64>) -> usize {
    let values = j.clone().singular_values();
    let largest = values.max();
    values.iter().filter(|s| **s > 1e-8 * largest).count()
}

/// For any displacement `u` of the plane that is linear in each face `sum_i A_i / h_i u_i . C_i` is the
/// virtual work `sum_T A_T E_T : grad u` of the strain `E_T = (F^T F - 1) / 2`, here by the deformation
/// gradients `F` of the faces.
#[test]
fn equations_are_the_virtual_work_of_greens_strain() {
    let sheet = irregular();
    let x = shaken(sheet.positions(), 0.05, 1);
    let c = residual(&model(&sheet), &x);
    let topology = sheet.topology();
    let u = shaken(&vec![0.0; x.len()], 1.0, 2);
    let (mut expected, mut size) = (0.0, 0.0);
    for (f, &area) in topology.faces().iter().zip(sheet.face_areas()) {
        let edge = |x: &[f64], k: usize| {
            let (a, b) = (f[0].index(), f[k].index());
            Vector3::from_fn(|i, _| x[3 * b + i] - x[3 * a + i])
        };
        let flat = |x: &[f64]| Matrix2::from_columns(&[1, 2].map(|k| edge(x, k).xy()));
        let to_rest = flat(sheet.positions()).try_inverse().unwrap();
        let gradient = nalgebra::Matrix3x2::from_columns(&[edge(&x, 1), edge(&x, 2)]) * to_rest;
        let strain = 0.5 * (gradient.transpose() * gradient - Matrix2::identity());
        let work = area * strain.component_mul(&(flat(&u) * to_rest)).sum();
        expected += work;
        size += work.abs();
    }
    let mut found = 0.0;
    for v in topology.vertex_ids() {
        let faces = topology.vertex_faces(v);
        let area: f64 = faces.iter().map(|f| sheet.face_areas()[f.index()]).sum();
        let h = (2.0 * area / faces.len() as f64).sqrt();
        let i = v.index();
        found += area / h * (u[3 * i] * c[2 * i] + u[3 * i + 1] * c[2 * i + 1]);
    }
    assert!(
        (found - expected).abs() < 1e-13 * size,
        "{found} {expected}"
    );
}

/// A homogeneous strain has no virtual work with displacements that vanish at the boundary.
#[test]
fn homogeneous_strains_violate_the_equations_of_the_boundary_alone() {
    let sheet = irregular();
    let f = Matrix2::new(1.1, 0.2, -0.05, 0.93);
    let x = mapped(&sheet, |p| (f * p).push(0.3));
    let c = residual(&model(&sheet), &x);
    for v in sheet.topology().vertex_ids() {
        let size = c[2 * v.index()].hypot(c[2 * v.index() + 1]);
        if sheet.topology().is_boundary_vertex(v) {
            assert!(size > 1e-3, "{v}: {size}");
        } else {
            assert!(size < 1e-14, "{v}: {size}");
        }
    }
}

#[test]
fn products_are_derivatives_of_the_equations() {
    let sheet = irregular();
    let model = model(&sheet);
    let rows = model.isometry_rows();
    let x = shaken(sheet.positions(), 0.05, 3);
    let v = shaken(&vec![0.0; x.len()], 1.0, 4);
    let moved = |s: f64| -> Vec<f64> { x.iter().zip(&v).map(|(x, v)| x + s * v).collect() };
    // Central differences of quadratic functions are exact.
    let (plus, minus) = (
        residual(&model, &moved(0.1)),
        residual(&model, &moved(-0.1)),
    );
    let mut rate = vec![0.0; rows.len()];
    rows.apply(&x, &v, &mut rate);
    for i in 0..rate.len() {
        let exact = (plus[i] - minus[i]) / 0.2;
        assert!((rate[i] - exact).abs() < 1e-12, "{i}: {} {exact}", rate[i]);
    }
    // The transpose, and with it the gradient of m . C.
    let m = shaken(&vec![0.0; rows.len()], 1.0, 5);
    let (mut densities, mut force) = (vec![0.0; model.rods().len()], vec![0.0; x.len()]);
    rows.apply_transpose_add(&x, &m, &mut densities, &mut force);
    let work: f64 = force.iter().zip(&v).map(|(f, v)| f * v).sum();
    let exact: f64 = m.iter().zip(&rate).map(|(m, r)| m * r).sum();
    assert!((work - exact).abs() < 1e-12 * force.len() as f64);
    // Its Hessian along v.
    let mut curvature = 0.0;
    for (&[a, b], p) in model.rods().edges().iter().zip(&densities) {
        let d = |k: usize| v[3 * a + k] - v[3 * b + k];
        curvature += p * (0..3).map(|k| d(k).powi(2)).sum::<f64>();
    }
    let value = |c: &[f64]| m.iter().zip(c).map(|(m, c)| m * c).sum::<f64>();
    let exact = (value(&plus) - 2.0 * value(&residual(&model, &x)) + value(&minus)) / 0.01;
    assert!((curvature - exact).abs() < 1e-9 * exact.abs().max(1.0));
}

/// The matrix of a step: masses, the penalty of the equations with its curvature, pinned vertices left out.
#[test]
fn the_matrix_is_the_hessian_of_the_penalty() {
    let sheet = irregular();
    let pins = [VertexId(0), VertexId(7)];
    let model = model(&sheet).with_pins(&pins).unwrap();
    let rows = model.isometry_rows();
    let x = shaken(sheet.positions(), 0.03, 6);
    let penalty = penalties(&model, 20.0);
    let mut v = shaken(&vec![0.0; x.len()], 1.0, 7);
    model.clear_pinned(&mut v);
    let mut densities = vec![0.0; model.rods().len()];
    let mut gradient = |x: &[f64]| {
        let c = residual(&model, x);
        let weighted: Vec<f64> = c.iter().zip(&penalty).map(|(c, p)| c * p).collect();
        let mut g = vec![0.0; x.len()];
        rows.apply_transpose_add(x, &weighted, &mut densities, &mut g);
        model.clear_pinned(&mut g);
        g
    };
    let d = 1e-4;
    let moved = |s: f64| -> Vec<f64> { x.iter().zip(&v).map(|(x, v)| x + s * v).collect() };
    let (plus, minus) = (gradient(&moved(d)), gradient(&moved(-d)));
    gradient(&x);
    let mut matrix = PrimalMatrix::new(&model).unwrap();
    matrix.assemble(&model, &x, &penalty, &densities);
    let product = matrix.product(&model, &v);
    let largest = product.iter().fold(0.0_f64, |m, p| m.max(p.abs()));
    for i in 0..x.len() {
        let exact = model.mass().vertex[i / 3] * v[i] + (plus[i] - minus[i]) / (2.0 * d);
        let difference = product[i] - exact;
        assert!(
            difference.abs() < 1e-6 * largest,
            "{i}: {difference} of {largest}"
        );
    }
    for v in pins {
        assert_eq!(penalty[2 * v.index()..2 * v.index() + 2], [0.0; 2]);
    }
}

/// A penalty of one is as stiff as the masses: the mean of `p J M^-1 J^T` over the two equations of a vertex.
#[test]
fn unit_penalties_are_as_stiff_as_the_masses() {
    let sheet = irregular();
    let model = model(&sheet).with_pins(&[VertexId(3)]).unwrap();
    let j = jacobian(&model, sheet.positions());
    let unit = penalties(&model, 1.0);
    for v in (0..unit.len() / 2).filter(|v| *v != 3) {
        let stiffness = |row: usize| {
            let along = |i: usize| match i / 3 {
                3 => 0.0,
                w => j[(row, i)].powi(2) / model.mass().vertex[w],
            };
            unit[row] * (0..j.ncols()).map(along).sum::<f64>()
        };
        let mean = 0.5 * (stiffness(2 * v) + stiffness(2 * v + 1));
        assert!((mean - 1.0).abs() < 1e-12, "{v}: {mean}");
    }
}

/// A cylinder of radius 1 that bends the horizontal plane in an oblique direction.
fn cylinder(p: Vector2<f64>) -> Vector3<f64> {
    let t = Vector2::new(0.3_f64.cos(), 0.3_f64.sin());
    let n = Vector2::new(-t.y, t.x);
    let (s, c) = p.dot(&t).sin_cos();
    (s * t + p.dot(&n) * n).push(1.0 - c)
}

/// In flat and in bent states 2 V equations of which 3 depend on the others; no motion within the plane but
/// the rigid ones is left free.
#[test]
fn the_rank_is_the_same_in_flat_and_in_bent_states() {
    let square = generate::isotropic_square(2, 1.0).unwrap();
    assert_eq!(square.topology().vertex_count(), 81);
    for (sheet, rows) in [(square, 162), (irregular(), 0)] {
        let model = model(&sheet);
        let expected = 2 * sheet.topology().vertex_count();
        assert!(rows == 0 || rows == expected);
        let flat = jacobian(&model, sheet.positions());
        let bent = jacobian(&model, &mapped(&sheet, cylinder));
        assert_eq!((flat.nrows(), rank(&flat)), (expected, expected - 3));
        assert_eq!((bent.nrows(), rank(&bent)), (expected, expected - 3));
        let in_plane = |j: &DMatrix<f64>| {
            let columns: Vec<_> = (0..j.ncols()).filter(|i| i % 3 < 2).collect();
            j.select_columns(&columns)
        };
        // (The plane has 2 V motions: three are left.)
        assert_eq!(rank(&in_plane(&flat)), expected - 3);
    }
}

/// Rods lose rank where a sheet is flat, one for each interior vertex; these equations do not. What depends
/// on the others are the rotation about a single pin, and nothing once two vertices are pinned.
#[test]
fn equations_are_independent_once_two_vertices_are_pinned() {
    let sheet = generate::isotropic_square(1, 1.0).unwrap();
    let model = model(&sheet);
    for (pins, dependent) in [(&[20][..], 1), (&[20, 24], 0), (&[0, 1, 5, 6], 0)] {
        for x in [sheet.positions().to_vec(), mapped(&sheet, cylinder)] {
            let j = jacobian(&model, &x);
            let is_free = |v: usize| !pins.contains(&v);
            let rows: Vec<_> = (0..j.nrows()).filter(|r| is_free(r / 2)).collect();
            let columns: Vec<_> = (0..j.ncols()).filter(|c| is_free(c / 3)).collect();
            let free = j.select_rows(&rows).select_columns(&columns);
            assert_eq!(rank(&free), rows.len() - dependent, "{pins:?}");
        }
    }
}

#[test]
fn rigid_motions_satisfy_the_equations() {
    let sheet = irregular();
    let model = model(&sheet);
    let turn = Rotation3::from_euler_angles(0.4, -1.1, 2.0);
    let x = mapped(&sheet, |p| {
        turn * p.push(0.0) + Vector3::new(0.5, -3.0, 1.0)
    });
    assert!(model.constrained_strain(&x) < 1e-14);
    assert!(model.constrained_strain(sheet.positions()) < 1e-15);
}

/// Where the sheet lies at rest makes no difference to `|C_i|`.
#[test]
fn violations_do_not_depend_on_the_plane_of_rest() {
    let sheet = irregular();
    let turn = Rotation3::from_euler_angles(0.9, 0.3, -2.0);
    let turned = sheet
        .map_positions(|p| (turn * Vector3::from(p) + Vector3::new(1.0, 2.0, 3.0)).into())
        .unwrap();
    let x = shaken(sheet.positions(), 0.05, 8);
    let [one, other] = [&sheet, &turned].map(|s| model(s).constrained_strain(&x));
    assert!(one > 1e-2 && (one - other).abs() < 1e-12, "{one} {other}");
}

#[test]
fn positions_are_projected_onto_the_equations() {
    let sheet = irregular();
    let model = model(&sheet).with_pins(&[VertexId(0)]).unwrap();
    let mut x = shaken(sheet.positions(), 0.02, 9);
    x[..3].copy_from_slice(&sheet.positions()[..3]);
    let start = State::at_rest(x.clone());
    assert!(model.constrained_strain(&x) > 1e-2);
    let left = project_positions(&model, &mut x, 1e-13).unwrap();
    assert!(left <= 1e-13 && model.constrained_strain(&x) <= 1e-13);
    assert_eq!(x[..3], sheet.positions()[..3]);
    // A start that does not satisfy them is refused.
    let refused = Simulation::new(model, start, Method::default()).err();
    let Some(SimulationError::Start(StepError::OffWeakIsometry { strain, .. })) = refused else {
        panic!("{refused:?}");
    };
    assert!(strain > 1e-2);
}

#[test]
fn positions_that_are_not_numbers_have_no_violation() {
    let sheet = irregular();
    let mut x = sheet.positions().to_vec();
    x[10] = f64::NAN;
    assert!(model(&sheet).constrained_strain(&x).is_nan());
}

#[test]
fn sheets_that_are_not_flat_at_rest_are_refused() {
    let flat = generate::isotropic_square(1, 1.0).unwrap();
    let bumped = flat
        .map_positions(|[x, y, _]| [x, y, 1e-3 * x * (1.0 - x)])
        .unwrap();
    let refused = WeakIsometry::new(&bumped, 1.0).err();
    let Some(WeakIsometryError::NotFlat { distance, .. }) = refused else {
        panic!("{refused:?}");
    };
    assert!((1e-4..1e-3).contains(&distance), "{distance}");
    let folded = flat
        .map_positions(|[x, y, _]| [(x - 0.5).abs(), y, 0.0])
        .unwrap();
    assert!(matches!(
        WeakIsometry::new(&folded, 1.0),
        Err(WeakIsometryError::Folded { .. })
    ));
}

#[test]
fn numbers_that_make_no_sense_are_refused() {
    let sheet = irregular();
    for bad in [0.0, -1.0, f64::NAN, f64::INFINITY] {
        assert!(matches!(
            WeakIsometry::new(&sheet, bad),
            Err(WeakIsometryError::Membrane(MembraneError::Stiffness { .. }))
        ));
        assert!(matches!(
            WeakIsometry::of_plate(&sheet, bad),
            Err(WeakIsometryError::Rigidity { .. })
        ));
    }
    let square = generate::isotropic_square(1, 1.0).unwrap();
    let wrong = WeakIsometry::new(&square, 1.0).unwrap();
    let refused = SheetModel::new(&sheet, 0.1, MassKind::Lumped)
        .unwrap()
        .with_weak_isometry(wrong);
    let expected = (25, sheet.topology().vertex_count());
    assert!(matches!(
        refused.err(),
        Some(ModelError::WeakIsometry { found, vertex_count }) if (found, vertex_count) == expected
    ));
}

#[test]
fn methods_that_need_rods_are_refused() {
    let sheet = irregular();
    assert_eq!(model(&sheet).isometry(), Isometry::Weak);
    for method in [
        Method::Projection(Default::default()),
        Method::EnergyMomentum(Default::default()),
        Method::Rattle(Default::default()),
        Method::RattleComposition(Default::default()),
    ] {
        let start = State::at_rest(sheet.positions().to_vec());
        let refused = Simulation::new(model(&sheet), start, method).err();
        assert_eq!(refused, Some(SimulationError::Elastic));
    }
}

/// `100 D / h^2` with squares of the side `h`.
#[test]
fn the_membrane_of_a_plate_belongs_to_its_rigidity() {
    let sheet = generate::isotropic_square(2, 1.0).unwrap();
    let stiffness = WeakIsometry::stiffness_for(&sheet, 5e-4);
    assert!((stiffness - 100.0 * 5e-4 * 64.0).abs() < 1e-12);
}
