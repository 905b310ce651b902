//! Gradients beside closed forms.

use crate::problems::{LENGTH, as_meshed, at_rest, strip};
use isosheet_adjoint::{AdjointOptions, Run, Scene, SceneError, coordinate, support_force};
use isosheet_dynamics::{Material, SheetModel, State};
use isosheet_mesh::generate;

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
    Ok(as_meshed(model, &sheet))
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

/// The complete elliptic integrals `K` and `E` of a modulus, by the arithmetic-geometric mean.
fn elliptic(k: f64) -> [f64; 2] {
    let (mut a, mut g, mut c) = (1.0, (1.0 - k * k).sqrt(), k);
    let (mut sum, mut power) = (0.5 * c * c, 0.5);
    while c.abs() > 1e-15 {
        (a, g, c) = (0.5 * (a + g), (a * g).sqrt(), 0.5 * (a - g));
        power *= 2.0;
        sum += power * c * c;
    }
    let first = 0.5 * std::f64::consts::PI / a;
    [first, first * (1.0 - sum)]
}

/// The load on the ends of a hinged strip of the length `length` and the bending stiffness `stiffness`, which
/// are a part `shortened` nearer than its length: with the sine `k` of half the slope at an end
/// `P = 4 K(k)^2 B / L^2` and `2 E(k) / K(k) - 1 = 1 - shortened / L`; Euler's load for `k` = 0.
fn load(stiffness: f64, length: f64, shortened: f64) -> f64 {
    let (mut low, mut high) = (0.0, 0.9);
    for _ in 0..60 {
        let middle = 0.5 * (low + high);
        let [first, second] = elliptic(middle);
        match 2.0 - 2.0 * second / first > shortened / length {
            true => high = middle,
            false => low = middle,
        }
    }
    let [first, _] = elliptic(0.5 * (low + high));
    4.0 * first * first * stiffness / (length * length)
}

/// Euler's load of a strip by its length, just beyond the point where it buckles: the force on its ends,
/// which are at a fixed distance from its length.
#[test]
fn eulers_load_by_the_length() {
    let (cells, width, rigidity, shortened) = (24, 0.03, 1e-3, 1.5e-3);
    let family = |p: &[f64]| -> Result<Scene, SceneError> {
        let length = p[0];
        let sheet = generate::anisotropic_grid(cells, 2, length, width)?;
        let ends = sheet.vertices_where(|[x, _, _]| !(1e-9..length - 1e-9).contains(&x));
        let mut film = Material::office_paper();
        (film.poisson, film.rigidity, film.stiffness) = (0.0, rigidity, 3e4);
        let model = SheetModel::of_material(&sheet, &film)
            .build()?
            .with_pins(&ends)?;
        // An arch as long as the strip, to second order.
        let height = 2.0 / std::f64::consts::PI * (shortened * length).sqrt();
        let arch = sheet.map_positions(|[x, y, _]| {
            let z = height * (std::f64::consts::PI * x / length).sin();
            [x * (1.0 - shortened / length), y, z]
        })?;
        Ok(Scene::new(model, State::at_rest(arch.positions().to_vec())))
    };
    let length = 0.3;
    let run = Run::record(&family, &[length], at_rest(), AdjointOptions::default());
    let run = run.expect("a run");
    let sheet = generate::anisotropic_grid(cells, 2, length, width).expect("a strip");
    let end = sheet.vertices_where(|[x, _, _]| x < 1e-9);
    let end = end.iter().map(|v| v.index()).collect();
    let gradient = run.gradient(&support_force(end, 0, 1)).expect("a gradient");
    let load = |length: f64| load(rigidity * width, length, shortened);
    let euler = |length: f64| rigidity * width * (std::f64::consts::PI / length).powi(2);
    let step = 1e-4;
    let expected = (load(length + step) - load(length - step)) / (2.0 * step);
    let (value, found) = (gradient.value, gradient.of_numbers[0]);
    println!(
        "load {value}, {} exactly, {} of Euler; by length {found}, {expected} exactly, {} of Euler",
        load(length),
        euler(length),
        -2.0 * euler(length) / length
    );
    assert!((value / load(length) - 1.0).abs() < 1e-2);
    assert!((found / expected - 1.0).abs() < 1e-2);
}
