//! Searches that gradients lead.

use crate::problems::{TIP, at_rest, by_clamp, by_curls, by_heights, by_rigidity, squared_heights};
use crate::search::{lead_by_gradients, minimise, solve};
use isosheet_adjoint::{AdjointOptions, Family, Loss, Run, coordinate, squared_distances};

fn value(family: &dyn Family, numbers: &[f64], loss: &dyn Loss) -> f64 {
    let run = Run::record(family, numbers, at_rest(), AdjointOptions::default());
    run.expect("a run").value(loss).expect("a value")
}

/// The rigidity of paper from its sag.
#[test]
fn the_rigidity_from_the_sag() {
    let (height, rigidity) = (coordinate(TIP, 2, 1), 4.2e-4);
    let measured = value(&by_rigidity, &[rigidity], &height);
    let found = solve(&by_rigidity, &at_rest(), &height, 8e-4, measured);
    println!("{} in {} runs", found.number, found.runs);
    assert!((found.number / rigidity - 1.0).abs() < 1e-6);
    assert!(found.runs <= 10);
}

/// The height of a clamp that brings a tip to a height.
#[test]
fn the_clamp_that_brings_the_tip_there() {
    let (height, target) = (coordinate(TIP, 2, 1), 0.05);
    let found = solve(&by_clamp, &at_rest(), &height, 0.1, target);
    println!("{} in {} runs", found.number, found.runs);
    let reached = value(&by_clamp, &[found.number], &height);
    assert!((reached - target).abs() < 1e-9, "{reached}");
}

/// The curl of three patches of a strip that gives it the shape that it has with other curls.
#[test]
fn the_curl_by_patches_of_a_shape() {
    let wanted = [2.0, -1.0, 3.0];
    let run = Run::record(&by_curls, &wanted, at_rest(), AdjointOptions::default());
    let run = run.expect("a run");
    let end = run.states()[1].vertex_positions();
    let targets = (1..=TIP).map(|v| (v, end[v])).collect();
    let loss = squared_distances(targets, 1);
    let plan = at_rest();
    let evaluate = lead_by_gradients(&by_curls, &plan, &loss);
    let found = minimise(evaluate, &[0.1, 0.1, 0.1], 100.0, 25, 1e-16);
    println!("{:?} {:?}", found.numbers, found.losses);
    for (found, wanted) in found.numbers.iter().zip(wanted) {
        assert!((found - wanted).abs() < 1e-4, "{found} {wanted}");
    }
}

/// The rest shape of a strip that its weight makes straight: thirty heights, in at most twenty runs.
#[test]
fn the_rest_shape_of_a_strip_that_is_straight_under_load() {
    // Only the heights count: the targets are where the strip would be.
    let (loss, plan) = (squared_heights(30), at_rest());
    let evaluate = lead_by_gradients(&by_heights, &plan, &loss);
    let found = minimise(evaluate, &[0.0; 30], 1.0, 20, 1e-10);
    println!("{:?}", found.losses);
    let last = found.losses.iter().copied().fold(f64::INFINITY, f64::min);
    // A root mean square of a micrometre or two, of a sag of centimetres.
    assert!(last < 1e-6 * found.losses[0], "{:?}", found.losses);
    assert!(found.losses.len() <= 20);
}
