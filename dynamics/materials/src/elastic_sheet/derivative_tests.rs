//! How what an elastic sheet remembers depends on where it was, by differences.

use super::bend::NUMBERS;
use super::*;
use crate::{Curl, Curvature, PlateEdges};
use isosheet_mesh::generate;
use rand::{RngExt, SeedableRng};
use rand_chacha::ChaCha8Rng;

/// A sheet, three places of it that are bent and strained differently, and random numbers.
fn scene(seed: u64) -> (ElasticSheet, [Vec<f64>; 3], impl FnMut() -> f64) {
    let corners = [[0.0, 0.0], [0.2, 0.0], [0.2, 0.1], [0.0, 0.1]];
    let sheet = generate::delaunay(&corners, 0.03, 3).expect("a rectangle");
    let plate = PlateBending::new(&sheet, 5e-4).expect("a plate");
    let elastic = ElasticSheet::new(&sheet, 3e3, 0.3).expect("elastic");
    let elastic = elastic.beside(&sheet, &plate);
    let mut rng = ChaCha8Rng::seed_from_u64(seed);
    let mut random = move || rng.random_range(-1.0..1.0);
    let mut place = |bend: f64, stretch: f64| -> Vec<f64> {
        let points = sheet.positions().as_chunks::<3>().0.iter();
        points
            .flat_map(|[x, y, _]| {
                let z = bend * (x * x - 0.4 * x * y) + 2e-5 * random();
                [stretch * x + 2e-5 * random(), y + 2e-5 * random(), z]
            })
            .collect()
    };
    let places = [place(1.0, 0.999), place(2.5, 1.001), place(1.7, 1.004)];
    let mut rng = ChaCha8Rng::seed_from_u64(seed + 1);
    (elastic, places, move || rng.random_range(-1.0..1.0))
}

fn at<'a>(x: &'a [f64], v: &'a [f64]) -> Reached<'a> {
    Reached { t: 0.0, x, v }
}

/// By positions and by what was remembered, at choices that are kept.
#[test]
fn what_is_remembered_has_its_derivatives() {
    for seed in 0..4 {
        let (elastic, [first, second, third], mut random) = scene(seed);
        let v = vec![0.0; first.len()];
        let mut found = elastic.memory();
        elastic.settle(at(&first, &v), &mut found);
        elastic.settle(at(&second, &v), &mut found);
        let choices = elastic.choices(at(&third, &v), &found);
        let closes = choices.iter().filter(|part| **part > 0.0 && **part < 1.0);
        assert!(closes.count() > 5, "slack closes as far as it is paid for");
        let settled = |x: &[f64], found: &[f64]| {
            let mut memory = found.to_vec();
            elastic.settle_by(&choices, at(x, &v), &mut memory);
            memory
        };
        let mut plain = found.clone();
        elastic.settle(at(&third, &v), &mut plain);
        for (a, b) in plain.iter().zip(&settled(&third, &found)) {
            assert!((a - b).abs() <= 1e-12 * a.abs() + 1e-18, "{a} {b}");
        }
        // Numbers of different units, one kind at a time.
        for kind in 0..NUMBERS {
            let mut of = vec![0.0; found.len()];
            for row in of[1..].as_chunks_mut::<NUMBERS>().0 {
                row[kind] = random();
            }
            let number =
                |memory: &[f64]| -> f64 { of.iter().zip(memory).map(|(o, m)| o * m).sum() };
            let (mut of_found, mut of_x) = (of.clone(), vec![0.0; third.len()]);
            elastic
                .pull_back_settling(at(&third, &v), (&found, &choices), &mut of_found, &mut of_x)
                .expect("a derivative");
            let difference = |by: &mut dyn FnMut(f64) -> f64, step: f64| {
                (8.0 * (by(step) - by(-step)) - (by(2.0 * step) - by(-2.0 * step))) / (12.0 * step)
            };
            let direction: Vec<f64> = third.iter().map(|_| random()).collect();
            let slope: f64 = direction.iter().zip(&of_x).map(|(d, o)| d * o).sum();
            let mut along = |s: f64| {
                let x: Vec<f64> = third
                    .iter()
                    .zip(&direction)
                    .map(|(x, d)| x + s * d)
                    .collect();
                number(&settled(&x, &found))
            };
            let expected = difference(&mut along, 1e-9);
            // (The credit is a difference of energies.)
            let bound = if kind == 5 { 1e-4 } else { 1e-6 };
            let error = (slope - expected).abs();
            assert!(
                error < bound * expected.abs(),
                "{kind} by x: {slope:e} {expected:e}"
            );
            for own in 0..NUMBERS {
                let direction: Vec<f64> = found
                    .iter()
                    .enumerate()
                    .map(|(i, m)| match i > 0 && (i - 1) % NUMBERS == own {
                        true => m * random(),
                        false => 0.0,
                    })
                    .collect();
                let slope: f64 = direction.iter().zip(&of_found).map(|(d, o)| d * o).sum();
                let mut along = |s: f64| {
                    let moved: Vec<f64> = found
                        .iter()
                        .zip(&direction)
                        .map(|(m, d)| m + s * d)
                        .collect();
                    number(&settled(&third, &moved))
                };
                let expected = difference(&mut along, 1e-5);
                let error = (slope - expected).abs();
                assert!(
                    error <= bound * expected.abs(),
                    "{kind} by {own}: {slope:e} {expected:e}"
                );
            }
        }
    }
}

/// The energy by what was remembered: chords and squared bends of faces, and the stiffness of the barrier.
#[test]
fn the_energy_has_its_derivatives_by_what_is_remembered() {
    for seed in 0..4 {
        let (elastic, [first, mut second, _], mut random) = scene(seed);
        // Within the limit of the strain.
        for row in second.as_chunks_mut::<3>().0 {
            row[2] *= 0.1;
        }
        let v = vec![0.0; first.len()];
        let mut memory = elastic.memory();
        elastic.settle(at(&first, &v), &mut memory);
        let energy = |memory: &[f64]| elastic.energy(At::new(0.0, &second).with_memory(memory));
        let mut of = vec![0.0; memory.len()];
        let here = At::new(0.0, &second).with_memory(&memory);
        elastic
            .add_memory_slopes(here, 2.0, &mut of)
            .expect("a derivative");
        for own in [0, 1, 2, 3, 4, 5] {
            let direction = memory.iter().enumerate();
            let direction: Vec<f64> = direction
                .map(|(i, m)| match i > 0 && (i - 1) % NUMBERS == own {
                    true => m * random(),
                    false => 0.0,
                })
                .collect();
            let slope: f64 = direction.iter().zip(&of).map(|(d, o)| 0.5 * d * o).sum();
            let along = |s: f64| {
                let moved = memory.iter().zip(&direction).map(|(m, d)| m + s * d);
                energy(&moved.collect::<Vec<f64>>())
            };
            let h = 1e-4;
            let expected =
                (8.0 * (along(h) - along(-h)) - (along(2.0 * h) - along(-2.0 * h))) / (12.0 * h);
            let error = (slope - expected).abs();
            // (What is left is the round-off of the energy.)
            let bound = 1e-6 * expected.abs() + 1e-15 * along(0.0) / h;
            assert!(error <= bound, "by {own}: {slope:e} {expected:e}");
        }
        assert!(of[1..].iter().any(|o| *o != 0.0));
    }
}

/// Sheets that differ in a patch: their gradients and memories differ by those of their parts.
#[test]
fn differing_parts_have_the_whole_difference() {
    let corners = [[0.0, 0.0], [0.2, 0.0], [0.2, 0.1], [0.0, 0.1]];
    let sheet = generate::delaunay(&corners, 0.02, 3).expect("a rectangle");
    let beyond = |face: &FaceId| {
        let corners = sheet.topology().faces()[face.index()];
        corners.iter().all(|v| sheet.position(*v)[0] > 0.14)
    };
    let patch: Vec<FaceId> = sheet.topology().face_ids().filter(beyond).collect();
    let curl = Curl {
        direction: crate::MaterialDirection::Uniform([1.0, 0.3, 0.0]),
        curvature: Curvature {
            along: 2.0,
            ..Curvature::default()
        }
        .into(),
        profile: 1.0.into(),
    };
    let (_, _, mut random) = scene(0);
    let n = sheet.positions().len();
    let place = |bend: f64, random: &mut dyn FnMut() -> f64| -> Vec<f64> {
        let points = sheet.positions().as_chunks::<3>().0.iter();
        points
            .flat_map(|[x, y, _]| [*x, *y, bend * (x * x - 0.4 * x * y) + 2e-5 * random()])
            .collect()
    };
    let [first, second] = [0.3, 0.5].map(|bend| place(bend, &mut random));
    for is_curled in [false, true] {
        let make = |rigidity: f64| {
            let laws = Patched::everywhere(5e-4.into()).with_patch(patch.clone(), rigidity.into());
            let edges = PlateEdges {
                pinned: &[],
                creases: &[],
                clamps: &[],
            };
            let mut plate = PlateBending::patched(&sheet, &laws, &edges).expect("a plate");
            if is_curled {
                plate = plate.with_curl(&sheet, curl.clone()).expect("a curl");
            }
            let elastic = ElasticSheet::new(&sheet, 3e3, 0.3).expect("elastic");
            (elastic.beside(&sheet, &plate), plate)
        };
        let [up, down] = [6e-4, 6.1e-4].map(make);
        let v = vec![0.0; n];
        let mut memory = up.0.memory();
        up.0.start(at(&first, &v), &mut memory);
        let choices = up.0.choices(at(&second, &v), &memory);
        let of: Vec<f64> = memory.iter().map(|_| random()).collect();
        let here = At::new(0.0, &second).with_memory(&memory);
        let potentials: [[&dyn Potential; 2]; 2] = [[&up.0, &down.0], [&up.1, &down.1]];
        for (pair, here) in potentials.into_iter().zip([here, At::new(0.0, &second)]) {
            let Difference::Parts(parts) = pair[0].difference(pair[1]) else {
                panic!("{pair:?} differ in some parts");
            };
            let [whole, of_parts] = [false, true].map(|is_part| {
                let [a, b] = pair.map(|potential| {
                    let mut gradient = vec![0.0; n];
                    match is_part {
                        true => potential.add_gradient_of(&parts, here, &mut gradient),
                        false => potential.add_gradient(here, &mut gradient),
                    }
                    gradient
                });
                a.iter().zip(&b).map(|(a, b)| a - b).collect::<Vec<f64>>()
            });
            let size = whole.iter().fold(0.0, |m: f64, w| m.max(w.abs()));
            for (a, b) in whole.iter().zip(&of_parts) {
                assert!((a - b).abs() <= 1e-9 * size, "{a:e} {b:e}");
            }
        }
        let Difference::Parts(parts) = up.0.memory_difference(&down.0) else {
            panic!("some faces remember something else");
        };
        assert!(parts.len() < up.0.face_count());
        // (Of the barrier's stiffness, too, which is the same.)
        let [whole, of_parts] = [None, Some(&parts[..])].map(|parts| {
            let products = [&up.0, &down.0].map(|elastic| {
                elastic.settled_product(parts, at(&second, &v), (&memory, &choices), &of)
            });
            products[0] - products[1]
        });
        let error = (whole - of_parts).abs();
        assert!(error <= 1e-6 * whole.abs(), "{whole:e} {of_parts:e}");
    }
}
