//! Where a flat sheet of rods starts that folds to given angles.

use crate::{
    CreaseSpring, CreaseSprings, ImplicitOptions, Method, SheetModel, Simulation, State,
    StepControl, project_positions,
};
use isosheet_materials::folding_from_flat;
use isosheet_materials::vectors::diameter;
use isosheet_mesh::{EdgeId, MassMatrix, Sheet, VertexId, fold_angle};

/// Part of the way to its angles at which the sheet starts. Terms of second order, by which branches differ
/// from what the angles ask for, are smaller by this factor.
const PART: f64 = 1e-2;
/// Length of a step in units of the time in which the springs turn the sheet: inertia is a hundredth of their
/// forces then, and each step ends at the equilibrium that is nearest.
const LONG: f64 = 10.0;
/// Steps until the equilibrium.
const STEPS: usize = 4;
/// Starts from flat that are tried, which leave it by different random displacements.
const SEEDS: u64 = 4;
/// Relative error of the edge lengths: that of accepted steps.
const EXACT: f64 = 1e-12;

/// Positions (`3V`, metres) a hundredth of the way from a flat sheet at positions `x` (`3V`, metres) to the
/// given fold angles: edges with their targets (radians, positive for a valley) and weights.
///
/// Flat is a singular state of a sheet of rods: from it the sheet can fold along several branches, and a step
/// that is short leaves it along any of them. Here springs of the given weights are let come to rest from
/// several starts, by long steps in which inertia does not count, and the one with the least energy is taken.
/// The starts are the flat state and the displacement that turns all creases to their sides to first order.
///
/// Nothing if the sheet is not flat, no edge has a target, or no branch is found.
///
/// # Panics
/// If an edge is at the boundary, or `x` is not of length `3V`.
pub fn start_of_folding(
    sheet: &Sheet,
    mass: &MassMatrix,
    pins: &[VertexId],
    x: &[f64],
    targets: &[(EdgeId, f64, f64)],
) -> Option<Vec<f64>> {
    let topology = sheet.topology();
    let displacement = folding_from_flat(topology, x, targets, pins)?;
    let stiffness = |e: EdgeId, weight: f64| weight * sheet.lengths()[e.index()];
    let model = || {
        let springs = targets.iter().map(|&(edge, target, weight)| CreaseSpring {
            edge,
            stiffness: stiffness(edge, weight),
            rest: (PART * target).into(),
            yields: None,
            in_series: None,
        });
        let springs = CreaseSprings::new(topology, springs.collect()).ok()?;
        let model = SheetModel::with_mass(sheet, mass.clone()).ok()?;
        Some(model.with_pins(pins).ok()?.with_potential(springs))
    };
    let towards = {
        let moved = x.iter().zip(&displacement).map(|(x, d)| x + PART * d);
        let mut moved: Vec<f64> = moved.collect();
        project_positions(&model()?, &mut moved, EXACT)
            .ok()
            .map(|_| moved)
    };
    let total: f64 = targets
        .iter()
        .map(|&(e, _, weight)| stiffness(e, weight))
        .sum();
    let h = LONG * diameter(x) * (mass.total() / total).sqrt();
    let relaxed = |start: &[f64], seed: u64| {
        let options = ImplicitOptions {
            seed,
            ..ImplicitOptions::default()
        };
        let start = State::at_rest(start.to_vec());
        // Shorter steps lead to no equilibrium.
        let control = StepControl {
            min_fraction: 1.0 / LONG,
            ..StepControl::default()
        };
        let method = Method::ImplicitEuler(options);
        let simulation = Simulation::new(model()?, start, method).ok()?;
        let mut simulation = simulation.with_control(control).ok()?;
        for _ in 0..STEPS {
            simulation.step(h).ok()?;
        }
        Some(simulation.state().x.clone())
    };
    let energy = |x: &[f64]| {
        let energies = targets.iter().map(|&(e, target, weight)| {
            let off = fold_angle(topology, x, e).unwrap_or(0.0) - PART * target;
            stiffness(e, weight) * off * off
        });
        energies.sum::<f64>()
    };
    let from_flat = (0..SEEDS).filter_map(|seed| relaxed(x, seed));
    let starts = from_flat.chain(towards.and_then(|start| relaxed(&start, 0)));
    let best = starts.min_by(|a, b| energy(a).total_cmp(&energy(b)))?;
    (energy(&best) < energy(x)).then_some(best)
}
