//! Plates that yield.

use super::*;
use crate::hessian::HessianPart;
use crate::testing::product;
use isosheet_mesh::Sheet;
use isosheet_mesh::generate;
use rand::{RngExt, SeedableRng};
use rand_chacha::ChaCha8Rng;

const RIGIDITY: f64 = 2.0;
const STIFFNESS: PlateStiffness = PlateStiffness {
    rigidity: RIGIDITY,
    poisson: 0.3,
};
const YIELD: Yield = Yield {
    moment: 0.5,
    hardening: 0.3,
    layers: 1,
};

/// An irregular mesh.
fn sheet() -> Sheet {
    let outline = [[0.0, 0.0], [1.0, 0.0], [1.0, 0.8], [0.0, 0.8]];
    generate::delaunay(&outline, 0.2, 4).expect("valid")
}

fn plate(sheet: &Sheet) -> PlateBending {
    plate_in_layers(sheet, 1)
}

fn plate_in_layers(sheet: &Sheet, layers: usize) -> PlateBending {
    let plate = PlateBending::new(sheet, STIFFNESS).expect("rigidity");
    let plate = plate.with_yield(sheet, YIELD.in_layers(layers));
    plate.expect("valid")
}

/// Rolled about the y-axis to a curvature, without a strain of the surface.
fn rolled(sheet: &Sheet, curvature: f64) -> Vec<f64> {
    let roll = |p: &[f64; 3]| {
        let angle = curvature * (p[0] - 0.5);
        [
            angle.sin() / curvature,
            p[1],
            (1.0 - angle.cos()) / curvature,
        ]
    };
    sheet
        .positions()
        .as_chunks::<3>()
        .0
        .iter()
        .flat_map(roll)
        .collect()
}

fn interior(sheet: &Sheet) -> impl Iterator<Item = usize> {
    let t = sheet.topology();
    let inside = |f: &FaceId| t.face_edges(*f).iter().all(|e| !t.is_boundary_edge(*e));
    t.face_ids().filter(inside).map(|f| f.index())
}

fn gradient(plate: &PlateBending, x: &[f64], memory: &[f64]) -> Vec<f64> {
    let mut g = vec![0.0; x.len()];
    plate.add_gradient(At::new(0.0, x).with_memory(memory), &mut g);
    g
}

/// What a plate remembers that was at rest at positions `x`; the energy that was dissipated.
fn settled(plate: &PlateBending, x: &[f64], mut memory: Vec<f64>) -> (Vec<f64>, f64) {
    let state = Reached { t: 0.0, x, v: &[] };
    let dissipated = plate.settle(state, &mut memory).dissipated;
    (memory, dissipated)
}

/// All second derivatives, at positions and with a memory.
fn full<'a>(x: &'a [f64], memory: &'a [f64]) -> (At<'a>, HessianPart) {
    (At::new(0.0, x).with_memory(memory), HessianPart::Full)
}

fn norm(x: &[f64]) -> f64 {
    x.iter().map(|x| x * x).sum::<f64>().sqrt()
}

#[test]
fn the_gradient_matches_differences_where_some_faces_yield() {
    for layers in [1, 3] {
        check_gradient(layers);
    }
}

fn check_gradient(layers: usize) {
    let sheet = sheet();
    let mut rng = ChaCha8Rng::seed_from_u64(5);
    let x: Vec<f64> = rolled(&sheet, 0.2);
    let x: Vec<f64> = x
        .iter()
        .map(|x| x + rng.random_range(-0.001..0.001))
        .collect();
    let plate = plate_in_layers(&sheet, layers);
    let memory: Vec<f64> = plate
        .memory()
        .iter()
        .map(|_| rng.random_range(-0.2..0.2))
        .collect();
    let (after, _) = settled(&plate, &x, memory.clone());
    let yielded = after.iter().zip(&memory).filter(|(p, q)| p != q).count();
    assert!(
        yielded > 30 && yielded + 30 < memory.len(),
        "{yielded} of {}",
        memory.len()
    );
    let g = gradient(&plate, &x, &memory);
    let largest = g.iter().fold(0.0_f64, |m, g| m.max(g.abs()));
    for i in 0..x.len() {
        let at = |s: f64| {
            let mut moved = x.clone();
            moved[i] += s * 1e-6;
            plate.energy(At::new(0.0, &moved).with_memory(&memory))
        };
        let slope = (8.0 * (at(1.0) - at(-1.0)) - (at(2.0) - at(-2.0))) / 12e-6;
        assert!(
            (slope - g[i]).abs() < 1e-6 * largest,
            "{i}: {slope} against {}",
            g[i]
        );
    }
}

/// On a cylinder that is bent beyond the yield, and beyond the plastic curvature that it has.
#[test]
fn the_hessian_matches_differences_of_the_gradient() {
    let sheet = sheet();
    let mut rng = ChaCha8Rng::seed_from_u64(6);
    let d: Vec<f64> = sheet
        .positions()
        .iter()
        .map(|_| rng.random_range(-1.0..1.0))
        .collect();
    for (layers, curvature, bound) in [(1, 0.4, 0.04), (1, 0.8, 0.08), (4, 0.4, 0.04)] {
        let bent = plate_in_layers(&sheet, layers);
        let (memory, _) = settled(&bent, &rolled(&sheet, curvature), bent.memory());
        let x = rolled(&sheet, 1.1 * curvature);
        let h = 1e-7;
        let at = |s: f64| {
            let moved: Vec<f64> = x.iter().zip(&d).map(|(x, d)| x + s * h * d).collect();
            gradient(&bent, &moved, &memory)
        };
        let (up, down) = (at(1.0), at(-1.0));
        let expected: Vec<f64> = up
            .iter()
            .zip(&down)
            .map(|(u, d)| (u - d) / (2.0 * h))
            .collect();
        let found = product(sheet.topology(), &bent, full(&x, &memory), &d);
        let difference: Vec<f64> = found.iter().zip(&expected).map(|(a, b)| a - b).collect();
        let error = norm(&difference) / norm(&expected);
        assert!(
            error < bound,
            "{layers} layers, curvature {curvature}: {error}"
        );
    }
}

/// A sheet at its plastic curvature has no moments, and turning it costs nothing: the part of its Hessian
/// that turns normals cancels that of the curvature.
#[test]
fn a_sheet_at_its_plastic_curvature_is_at_rest_and_turns_freely() {
    let sheet = sheet();
    let curvature = 0.7;
    let x = rolled(&sheet, curvature);
    let elastic = PlateBending::new(&sheet, STIFFNESS).expect("rigidity");
    let bent = || {
        let with_yield = |moment: f64| {
            let plate = PlateBending::new(&sheet, STIFFNESS).expect("rigidity");
            plate
                .with_yield(&sheet, Yield::perfect(moment))
                .expect("valid")
        };
        // Of a plate that hardly resists all curvature is plastic.
        let soft = with_yield(1e-9);
        let (memory, _) = settled(&soft, &x, soft.memory());
        (with_yield(YIELD.moment), memory)
    };
    let (plate, memory) = bent();
    let energy = plate.energy(At::new(0.0, &x).with_memory(&memory));
    let ratio = energy / elastic.energy(At::new(0.0, &x));
    assert!(ratio < 1e-2, "{ratio}");
    let forces = norm(&gradient(&plate, &x, &memory)) / norm(&gradient(&elastic, &x, &[]));
    assert!(forces < 0.1, "{forces}");
    for axis in [Vector3::x(), Vector3::y()] {
        let turn = |p: &[f64; 3]| axis.cross(&Vector3::from(*p)).data.0[0];
        let d: Vec<f64> = x.as_chunks::<3>().0.iter().flat_map(turn).collect();
        let plain = PlateBending::new(&sheet, STIFFNESS).expect("rigidity");
        let t = sheet.topology();
        let plain = norm(&product(t, &plain, full(&x, &[]), &d));
        let part = norm(&product(t, &plate, full(&x, &memory), &d)) / plain;
        assert!(part < 0.1, "{axis}: {part}");
    }
}

/// The closed form of springback, and the energy that bending has dissipated.
#[test]
fn a_rolled_sheet_keeps_the_curvature_beyond_the_yield() {
    let sheet = sheet();
    let curvature = 0.9;
    let plate = plate(&sheet);
    let expected = (RIGIDITY * curvature - YIELD.moment) / (RIGIDITY + YIELD.hardening);
    let x = rolled(&sheet, curvature);
    let energy = |memory: &[f64]| plate.energy(At::new(0.0, &x).with_memory(memory));
    let flat = plate.memory();
    let before = energy(&flat);
    let (memory, dissipated) = settled(&plate, &x, flat);
    let fall = before - energy(&memory);
    assert!(
        (fall - dissipated).abs() < 1e-12 * before,
        "{fall} {dissipated}"
    );
    let curvatures = plate.plastic_curvatures(&memory);
    for face in interior(&sheet) {
        let principal = curvatures[face].1.symmetric_eigenvalues();
        let (large, small) = (principal.max(), principal.min());
        assert!(
            (large - expected).abs() < 0.03 * expected,
            "{large} {expected}"
        );
        assert!(small.abs() < 0.03 * expected, "{small}");
    }
    // Rolled to the other side it yields sooner.
    let back = -0.5 * curvature;
    let (memory, _) = settled(&plate, &rolled(&sheet, back), memory);
    let expected = (RIGIDITY * back + YIELD.moment) / (RIGIDITY + YIELD.hardening);
    let curvatures = plate.plastic_curvatures(&memory);
    for face in interior(&sheet) {
        let least = curvatures[face].1.symmetric_eigenvalues().min();
        assert!(
            (least - expected).abs() < 0.05 * curvature,
            "{least} {expected}"
        );
    }
}
