//! Elastic sheets that bend, and sheets that are taut, against closed forms.

use super::bend::{Bend, NUMBERS};
use super::*;
use crate::hessian::HessianPart;
use crate::testing::product;
use isosheet_mesh::generate::{self, Diagonals};
use rand::{RngExt, SeedableRng};
use rand_chacha::ChaCha8Rng;

const STIFFNESS: f64 = 3e5;

fn mesh(kind: Option<Diagonals>, cells: [usize; 2], size: [f64; 2]) -> Sheet {
    let [length, width] = size;
    let corners = [[0.0, 0.0], [length, 0.0], [length, width], [0.0, width]];
    match kind {
        Some(diagonals) => generate::grid(cells[0], cells[1], length, width, diagonals).unwrap(),
        None => generate::delaunay(&corners, width / cells[1] as f64, 5).unwrap(),
    }
}

const KINDS: [Option<Diagonals>; 3] = [Some(Diagonals::UnionJack), Some(Diagonals::Falling), None];

/// Rolled to a cylinder of a curvature along a direction, without strain.
fn rolled(sheet: &Sheet, curvature: f64, direction: f64) -> Vec<f64> {
    let (sin, cos) = direction.sin_cos();
    let roll = |p: &[f64; 3]| {
        let [along, across] = [cos * p[0] + sin * p[1], cos * p[1] - sin * p[0]];
        let angle = curvature * along;
        let [x, z] = [angle.sin() / curvature, (1.0 - angle.cos()) / curvature];
        [cos * x - sin * across, sin * x + cos * across, z]
    };
    let points = sheet.positions().as_chunks::<3>().0.iter();
    points.flat_map(roll).collect()
}

fn elastic(sheet: &Sheet) -> ElasticSheet {
    let plate = PlateBending::new(sheet, 5e-4).unwrap();
    let elastic = ElasticSheet::new(sheet, STIFFNESS, 0.3).unwrap();
    elastic.beside(sheet, &plate).with_limit(0.1).unwrap()
}

/// What is remembered of a bend.
fn remembered(elastic: &ElasticSheet, x: &[f64]) -> Vec<f64> {
    let mut memory = elastic.memory();
    let v = vec![0.0; x.len()];
    elastic.settle(Reached { t: 0.0, x, v: &v }, &mut memory);
    memory
}

/// On a cylinder vertices have their places without strain, whatever the mesh: the energy is that of
/// round-off against the one of chords without arcs. It is of the order of the error of the curvature.
#[test]
fn chords_on_a_cylinder_are_those_of_its_arcs() {
    for kind in KINDS {
        for direction in [0.0, 0.5, 1.3] {
            let sheet = mesh(kind, [8, 6], [0.4, 0.3]);
            let elastic = elastic(&sheet);
            let x = rolled(&sheet, 2.0, direction);
            let memory = remembered(&elastic, &x);
            let bent = elastic.energy(At::new(0.0, &x).with_memory(&memory));
            let locked = elastic.energy(At::new(0.0, &x).with_memory(&elastic.memory()));
            assert!(
                bent < 1e-4 * locked,
                "{kind:?} {direction}: {bent} {locked}"
            );
        }
    }
}

/// Away from a cylinder whose bend is remembered.
#[test]
fn gradient_and_hessian_of_a_bent_sheet_are_derivatives_of_its_energy() {
    let sheet = mesh(None, [5, 4], [0.5, 0.4]);
    let elastic = elastic(&sheet);
    let base = rolled(&sheet, 2.0, 0.4);
    let memory = remembered(&elastic, &base);
    let mut rng = ChaCha8Rng::seed_from_u64(8);
    for size in [1e-5, 1e-4, 1e-3] {
        let x: Vec<f64> = base
            .iter()
            .map(|x| x + rng.random_range(-size..size))
            .collect();
        let at = |x: &[f64]| elastic.energy(At::new(0.0, x).with_memory(&memory));
        let gradient = |x: &[f64]| {
            let mut g = vec![0.0; x.len()];
            elastic.add_gradient(At::new(0.0, x).with_memory(&memory), &mut g);
            g
        };
        let moved =
            |d: &[f64], s: f64| -> Vec<f64> { x.iter().zip(d).map(|(x, d)| x + s * d).collect() };
        let d: Vec<f64> = x.iter().map(|_| rng.random_range(-1.0..1.0)).collect();
        let step = 1e-3 * size;
        let slope: f64 = gradient(&x).iter().zip(&d).map(|(g, d)| g * d).sum();
        let difference = (at(&moved(&d, step)) - at(&moved(&d, -step))) / (2.0 * step);
        assert!(
            (slope / difference - 1.0).abs() < 1e-5,
            "{size}: {slope} {difference}"
        );
        let [up, down] = [step, -step].map(|s| gradient(&moved(&d, s)));
        let here = At::new(0.0, &x).with_memory(&memory);
        let product = product(sheet.topology(), &elastic, (here, HessianPart::Full), &d);
        let largest = product.iter().fold(0.0_f64, |m, p| m.max(p.abs()));
        for i in 0..x.len() {
            let exact = (up[i] - down[i]) / (2.0 * step);
            let found = product[i];
            assert!(
                (found - exact).abs() < 1e-4 * largest,
                "{size} {i}: {found} {exact}"
            );
        }
    }
}

/// However a sheet is bent and stretched, the slack of its faces gives no more energy than it has taken.
#[test]
fn slack_drives_nothing() {
    let sheet = mesh(None, [5, 4], [0.5, 0.4]);
    let elastic = elastic(&sheet);
    let mut memory = remembered(&elastic, sheet.positions());
    let mut rng = ChaCha8Rng::seed_from_u64(3);
    let (mut given, mut exchanged, mut most) = (0.0, 0.0, 0.0_f64);
    for round in 0..200 {
        let curvature = rng.random_range(0.1..4.0);
        let stretch = rng.random_range(0.995..1.005);
        let x = rolled(&sheet, curvature, 0.4);
        let x: Vec<f64> = x.iter().map(|x| stretch * x).collect();
        // Chords first, which do work of their own.
        let mut chords = memory.clone();
        for arcs in &elastic.arcs {
            arcs.remember(&elastic.faces, At::new(0.0, &x), &mut chords[1..]);
        }
        let mut slack = chords.clone();
        for (new, old) in slack[1..]
            .as_chunks_mut::<NUMBERS>()
            .0
            .iter_mut()
            .zip(memory[1..].as_chunks().0)
        {
            let mut bend = Bend::remembered(new);
            bend.squared = Bend::remembered(old).squared;
            *new = bend.numbers();
        }
        let energy = |memory: &[f64]| elastic.energy(At::new(0.0, &x).with_memory(memory));
        let change = energy(&chords) - energy(&slack);
        given += change;
        exchanged += change.abs();
        most = most.max(energy(&chords));
        assert!(given <= 1e-12 * most, "{round}: {given}");
        memory = chords;
    }
    assert!(
        exchanged > most,
        "the slack was at work: {exchanged} {most}"
    );
}
