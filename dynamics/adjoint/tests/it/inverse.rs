//! Closed forms, and searches that gradients lead.

use crate::support::exact;
use isosheet_adjoint::{AdjointOptions, Family, Plan, Run, Scene, SceneError, coordinate};
use isosheet_dynamics::{Material, Method, SheetModel, State};
use isosheet_mesh::{Sheet, generate};

const LENGTH: f64 = 0.3;

fn at_rest() -> Plan {
    Plan::steps(Method::Equilibrium(exact()), 1.0, 1)
}

/// A strip that is clamped at its left end, with a width of a tenth of its length.
fn strip(cells: usize) -> Result<Sheet, SceneError> {
    // The clamp is a column of faces before the strip.
    let cell = LENGTH / cells as f64;
    let grid = generate::anisotropic_grid(cells + 1, 2, LENGTH + cell, 0.1 * LENGTH)?;
    Ok(grid.map_positions(|[x, y, z]| [x - cell, y, z])?)
}

/// The tip of the heavy elastica: of a strip of the weight `w` per length and the bending stiffness `B` of
/// its width it is a function of `Gamma = w L^3 / B` alone, `-L Gamma / 8` for small sags.
fn elastica(p: &[f64]) -> Result<Scene, SceneError> {
    let sheet = strip(24)?;
    let clamp = sheet.vertices_where(|[x, _, _]| x < 1e-9);
    let mut film = Material::office_paper();
    film.poisson = 0.0;
    // Gamma = density g L^3 / rigidity.
    film.rigidity = film.density * 9.8 * LENGTH.powi(3) / p[0];
    film.stiffness = 3e3;
    let model = SheetModel::of_material(&sheet, &film)
        .clamped(&clamp)
        .build()?
        .with_acceleration([0.0, 0.0, -9.8]);
    Ok(Scene::new(
        model,
        State::at_rest(sheet.positions().to_vec()),
    ))
}

/// The sag over the length of an inextensible elastica under its weight, by shooting:
/// `theta'' = -Gamma (1 - s) cos theta` with `theta(0) = 0` and `theta'(1) = 0`, by steps of Runge and Kutta.
fn sag(gamma: f64) -> f64 {
    let shoot = |slope: f64| -> [f64; 3] {
        let steps = 2000;
        let h = 1.0 / f64::from(steps);
        let rate = |s: f64, [angle, slope, _]: [f64; 3]| {
            [slope, -gamma * (1.0 - s) * angle.cos(), angle.sin()]
        };
        let mut y = [0.0, slope, 0.0];
        for k in 0..steps {
            let s = h * f64::from(k);
            let along = |d: [f64; 3], part: f64| std::array::from_fn(|i| y[i] + part * h * d[i]);
            let a = rate(s, y);
            let b = rate(s + 0.5 * h, along(a, 0.5));
            let c = rate(s + 0.5 * h, along(b, 0.5));
            let d = rate(s + h, along(c, 1.0));
            y = std::array::from_fn(|i| y[i] + h / 6.0 * (a[i] + 2.0 * b[i] + 2.0 * c[i] + d[i]));
        }
        y
    };
    // The moment at the tip grows with the slope at the clamp.
    let (mut low, mut high) = (0.0, gamma);
    for _ in 0..60 {
        let middle = 0.5 * (low + high);
        match shoot(middle)[1] > 0.0 {
            true => high = middle,
            false => low = middle,
        }
    }
    shoot(0.5 * (low + high))[2]
}

/// The derivative of the tip by Gamma, for a small and for a moderate sag.
#[test]
fn the_tip_of_the_elastica() {
    let tip = 25;
    for gamma in [0.1, 3.0] {
        let run = Run::record(&elastica, &[gamma], at_rest(), AdjointOptions::default());
        let gradient = run.expect("a run").gradient(&coordinate(tip, 2, 1));
        let gradient = gradient.expect("a gradient");
        let step = 1e-3 * gamma;
        let expected = -LENGTH * (sag(gamma + step) - sag(gamma - step)) / (2.0 * step);
        let found = gradient.of_numbers[0];
        println!("Gamma {gamma}: {found} {expected} {}", -LENGTH / 8.0);
        assert!(
            (found / expected - 1.0).abs() < 5e-3,
            "{gamma}: {found} {expected}"
        );
    }
}

fn solve(family: &dyn Family, plan: &Plan, start: f64, vertex: usize, target: f64) -> (f64, usize) {
    let count = plan.steps.len();
    let loss = coordinate(vertex, 2, count);
    let mut number = start;
    for runs in 1..20 {
        let run = Run::record(family, &[number], plan.clone(), AdjointOptions::default());
        let gradient = run.expect("a run").gradient(&loss).expect("a gradient");
        let step = (gradient.value - target) / gradient.of_numbers[0];
        number -= step.clamp(-0.5 * number.abs(), 0.5 * number.abs());
        if step.abs() <= 1e-9 * number.abs() {
            return (number, runs);
        }
    }
    panic!("the search does not end: {number}");
}

/// The rigidity of paper from its sag.
#[test]
fn the_rigidity_from_the_sag() {
    let family = |p: &[f64]| -> Result<Scene, SceneError> {
        let sheet = strip(12)?;
        let clamp = sheet.vertices_where(|[x, _, _]| x < 1e-9);
        let mut paper = Material::office_paper();
        paper.rigidity = p[0];
        let model = SheetModel::of_material(&sheet, &paper)
            .clamped(&clamp)
            .build()?
            .with_gravity();
        Ok(Scene::new(
            model,
            State::at_rest(sheet.positions().to_vec()),
        ))
    };
    let (tip, rigidity) = (13, 4.2e-4);
    let run = Run::record(&family, &[rigidity], at_rest(), AdjointOptions::default());
    let measured = run.expect("a run").value(&coordinate(tip, 2, 1));
    let (found, runs) = solve(&family, &at_rest(), 8e-4, tip, measured);
    println!("{found} in {runs} runs");
    assert!((found / rigidity - 1.0).abs() < 1e-6, "{found}");
    assert!(runs <= 10, "{runs}");
}

/// The height of a clamp that brings a tip to a height.
#[test]
fn the_clamp_that_brings_the_tip_there() {
    let family = |p: &[f64]| -> Result<Scene, SceneError> {
        let sheet = strip(12)?;
        let height = p[0];
        let clamp = sheet.vertices_where(|[x, _, _]| x < 1e-9);
        let lifted = sheet.map_positions(|[x, y, z]| [x, y, z + height])?;
        let model = SheetModel::of_material(&sheet, &Material::office_paper())
            .clamped(&clamp)
            .build()?
            .with_gravity();
        Ok(Scene::new(
            model,
            State::at_rest(lifted.positions().to_vec()),
        ))
    };
    let (tip, target) = (13, 0.05);
    let (found, _) = solve(&family, &at_rest(), 0.1, tip, target);
    let run = Run::record(&family, &[found], at_rest(), AdjointOptions::default());
    let reached = run.expect("a run").value(&coordinate(tip, 2, 1));
    assert!((reached - target).abs() < 1e-9, "{reached}");
}
