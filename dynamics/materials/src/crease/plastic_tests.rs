//! Creases that yield.

use super::*;
use crate::hessian::HessianPart;
use crate::testing::product;
use isosheet_mesh::{fold_angle, generate};
use rand::{RngExt, SeedableRng};
use rand_chacha::ChaCha8Rng;

const STIFFNESS: f64 = 1e-2;
const YIELD: Yield = Yield {
    moment: 2e-3,
    hardening: 1e-3,
    layers: 1,
};

/// Two triangles of a square and the edge between them.
fn hinge() -> (Sheet, EdgeId) {
    let x = vec![0.0, 0.0, 0.0, 0.1, 0.0, 0.0, 0.1, 0.1, 0.0, 0.0, 0.1, 0.0];
    let sheet = Sheet::new(x, &[[0, 1, 2], [0, 2, 3]]).expect("a square");
    let edge = sheet.topology().find_edge(VertexId(0), VertexId(2));
    let edge = edge.expect("the diagonal");
    (sheet, edge)
}

fn spring(edge: EdgeId) -> CreaseSpring {
    CreaseSpring {
        edge,
        stiffness: STIFFNESS,
        rest: 0.0.into(),
        yields: Some(YIELD),
        in_series: None,
    }
}

/// The square folded to an angle.
fn folded(angle: f64) -> Vec<f64> {
    let (sheet, edge) = hinge();
    let x = |angle: f64| {
        let height = 0.05 * std::f64::consts::SQRT_2;
        let (sine, cosine) = angle.sin_cos();
        let out = 0.05 - 0.05 * cosine;
        let mut x = sheet.positions().to_vec();
        x[9..].copy_from_slice(&[out, 0.1 - out, height * sine]);
        x
    };
    let found = fold_angle(sheet.topology(), &x(angle), edge).expect("interior");
    if found * angle < 0.0 {
        x(-angle)
    } else {
        x(angle)
    }
}

fn at_rest(x: &[f64]) -> Reached<'_> {
    Reached { t: 0.0, x, v: &[] }
}

#[test]
fn derivatives_match_differences_across_the_yield() {
    let sheet = generate::isotropic_square(1, 1.0).expect("valid");
    let mut rng = ChaCha8Rng::seed_from_u64(5);
    let x = sheet.positions().iter();
    let x: Vec<f64> = x.map(|p| p + rng.random_range(-0.08..0.08)).collect();
    let springs = CreaseSprings::bending(&sheet, 1.0)
        .and_then(|s| s.with_yield(&sheet, YIELD_OF_SHEET))
        .expect("valid");
    let memory: Vec<f64> = springs
        .memory()
        .iter()
        .map(|_| rng.random_range(-0.2..0.2))
        .collect();
    let mut yielded = memory.clone();
    springs.settle(at_rest(&x), &mut yielded);
    let changed = yielded.iter().zip(&memory).filter(|(p, q)| p != q);
    let count = changed.count();
    assert!(
        count > 5 && count + 5 < yielded.len(),
        "{count} of {}",
        yielded.len()
    );
    let gradient = |x: &[f64]| {
        let mut g = vec![0.0; x.len()];
        springs.add_gradient(At::new(0.0, x).with_memory(&memory), &mut g);
        g
    };
    let g = gradient(&x);
    let largest = g.iter().fold(0.0_f64, |m, g| m.max(g.abs()));
    for i in 0..x.len() {
        let at = |s: f64| {
            let mut moved = x.clone();
            moved[i] += s * 1e-5;
            springs.energy(At::new(0.0, &moved).with_memory(&memory))
        };
        let slope = (8.0 * (at(1.0) - at(-1.0)) - (at(2.0) - at(-2.0))) / 12e-5;
        assert!(
            (slope - g[i]).abs() < 1e-7 * largest,
            "{i}: {slope} against {}",
            g[i]
        );
    }
}

/// Per metre.
const YIELD_OF_SHEET: Yield = Yield {
    moment: 0.8,
    hardening: 0.3,
    layers: 1,
};

/// Out of the plane of a flat sheet the angles are linear, and the tangent is that of the section.
#[test]
fn the_hessian_matches_differences_where_springs_yield() {
    let (sheet, edge) = hinge();
    let springs = CreaseSprings::new(sheet.topology(), vec![spring(edge)]).expect("interior");
    // In the flat state the moment that yields comes from the plastic angle of before.
    let bent = vec![-0.5];
    let x = sheet.positions();
    let mut d = vec![0.0; x.len()];
    (d[2], d[11]) = (0.3, -0.8);
    for (memory, part) in [
        (springs.memory(), 1.0),
        (bent, YIELD.hardening / (YIELD.hardening + STIFFNESS)),
    ] {
        let at = (At::new(0.0, x).with_memory(&memory), HessianPart::Full);
        let product = product(sheet.topology(), &springs, at, &d);
        let h = 1e-6;
        let gradient = |s: f64| {
            let moved: Vec<f64> = x.iter().zip(&d).map(|(x, d)| x + s * h * d).collect();
            let mut f = vec![0.0; x.len()];
            springs.add_gradient(At::new(0.0, &moved).with_memory(&memory), &mut f);
            f[11]
        };
        let slope = (gradient(1.0) - gradient(-1.0)) / (2.0 * h);
        assert!((slope - product[11]).abs() < 1e-6 * slope.abs(), "{slope}");
        let ends = vertices(&sheet, edge);
        let place = |v: u32| ends.iter().position(|w| w.0 == v).expect("a corner");
        let g = Fold::at(x, &ends).gradient();
        let angle: f64 = 0.3 * g[place(0)].z - 0.8 * g[place(3)].z;
        let expected = part * STIFFNESS * angle * g[place(3)].z;
        let error = (slope - expected).abs();
        assert!(error < 1e-5 * expected.abs(), "{slope} against {expected}");
    }
}

fn vertices(sheet: &Sheet, edge: EdgeId) -> [VertexId; 4] {
    let [left, right] = sheet.topology().opposite_vertices(edge);
    let [a, b] = sheet.topology().edges()[edge.index()];
    [a, b, left.expect("left"), right.expect("right")]
}

/// Steps through a cycle of angles: what is dissipated is the work of the moment less what is stored.
#[test]
fn dissipation_is_work_less_energy() {
    let (sheet, edge) = hinge();
    let springs = CreaseSprings::new(sheet.topology(), vec![spring(edge)]).expect("interior");
    let mut memory = springs.memory();
    let count = 4000;
    let (mut work, mut dissipated, mut before) = (0.0, 0.0, (0.0, 0.0));
    for k in 1..=count {
        let phase = TAU * f64::from(k) / f64::from(count);
        let angle = 1.1 * phase.sin();
        let x = folded(angle);
        dissipated += springs.settle(at_rest(&x), &mut memory).dissipated;
        let moment = -springs.moments(At::new(0.0, &x).with_memory(&memory))[0];
        work += 0.5 * (moment + before.1) * (angle - before.0);
        before = (angle, moment);
    }
    let flat = folded(0.0);
    let stored = springs.energy(At::new(0.0, &flat).with_memory(&memory));
    assert!(dissipated > 3.0 * YIELD.moment, "{dissipated} J");
    assert!(
        (work - stored - dissipated).abs() < 1e-5 * work,
        "{work} {stored} {dissipated}"
    );
}

/// A crease that yields in a sheet that bends turns by what its moment makes of it besides the angle that
/// stays: `M = k (kink - rest - plastic)`.
#[test]
fn the_kink_of_a_crease_that_yields_has_its_plastic_angle() {
    let (sheet, edge) = hinge();
    let mut springs = vec![spring(edge)];
    CreaseSpring::put_in_sheet(&mut springs, &sheet, 2e-2);
    let springs = CreaseSprings::new(sheet.topology(), springs).expect("interior");
    let mut memory = springs.memory();
    for angle in [0.1, 0.5, 1.2, 0.3, -0.8] {
        let x = folded(angle);
        springs.settle(at_rest(&x), &mut memory);
        let at = At::new(0.0, &x).with_memory(&memory);
        let kink = angle - springs.bends_beside(at)[0].1;
        let plastic = springs.plastic_angles(&memory)[0].1;
        let moment = -springs.moments(at)[0];
        assert!(
            (moment - STIFFNESS * (kink - plastic)).abs() < 1e-15,
            "{angle}"
        );
    }
    assert!(memory[0].abs() > 0.1, "nothing has yielded");
}
