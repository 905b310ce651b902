use super::*;
use nalgebra::{Matrix3, Vector1, Vector3};
use rand::{RngExt, SeedableRng};
use rand_chacha::ChaCha8Rng;

const STIFFNESS: f64 = 2.0;
const SECTION: Yield = Yield {
    moment: 1.5,
    hardening: 0.4,
    layers: 1,
};

fn random(rng: &mut ChaCha8Rng) -> Vector3<f64> {
    Vector3::from_fn(|_, _| rng.random_range(-1.0..1.0))
}

/// Plastic parts of layers.
fn parts(rng: &mut ChaCha8Rng, section: &Yield) -> Vec<f64> {
    (0..3 * section.layers)
        .map(|_| rng.random_range(-1.0..1.0))
        .collect()
}

/// The incremental energy for growths of the plastic parts of the layers, layer by layer.
fn energy(section: &Yield, e: Vector3<f64>, before: &[f64], after: &[f64]) -> f64 {
    let whole = e + section.plastic::<3>(before);
    let parts = before.as_chunks::<3>().0.iter().zip(after.as_chunks().0);
    let layers = section.of_section(STIFFNESS).zip(parts);
    let energy = |(layer, (p, q)): (Layer, (&[f64; 3], &[f64; 3]))| {
        let (p, q) = (Vector3::from(*p), Vector3::from(*q));
        0.5 * layer.rigidity * (whole - q).norm_squared() + layer.energy(p, q - p)
    };
    layers.map(energy).sum()
}

#[test]
fn the_growth_minimises_the_energy() {
    for layers in [1, 3] {
        let section = SECTION.in_layers(layers);
        let mut rng = ChaCha8Rng::seed_from_u64(2);
        let mut grown = 0;
        for _ in 0..200 {
            let (e, before) = (random(&mut rng), parts(&mut rng, &section));
            let flow = section.flow(STIFFNESS, e, &before);
            grown += usize::from(flow.step != Vector3::zeros());
            let mut after = before.clone();
            section.settle(STIFFNESS, e, &mut after);
            let least = energy(&section, e, &before, &after);
            let found = 0.5 * STIFFNESS * (e - flow.step).norm_squared() + flow.energy;
            assert!((found - least).abs() < 1e-13, "{found} {least}");
            for size in [1e-3, 1e-1] {
                let off = parts(&mut rng, &section);
                let other: Vec<f64> = after.iter().zip(off).map(|(q, d)| q + size * d).collect();
                assert!(
                    energy(&section, e, &before, &other) >= least,
                    "{e} {before:?}"
                );
            }
        }
        assert!((20..200).contains(&grown), "{grown} of 200 yielded");
    }
}

/// Layers that have different plastic parts keep energy where the section has no moment; what a step
/// dissipates is what the energy falls by.
#[test]
fn energy_falls_by_what_is_dissipated() {
    let section = SECTION.in_layers(4);
    let mut rng = ChaCha8Rng::seed_from_u64(7);
    for _ in 0..50 {
        let (whole, mut layers) = (2.0 * random(&mut rng), parts(&mut rng, &section));
        let at = |layers: &[f64]| {
            let e = whole - section.plastic::<3>(layers);
            let flow = section.flow(STIFFNESS, e, layers);
            0.5 * STIFFNESS * (e - flow.step).norm_squared() + flow.energy
        };
        let before = at(&layers);
        let e = whole - section.plastic::<3>(&layers);
        let dissipated = section.settle(STIFFNESS, e, &mut layers);
        assert!(dissipated > 0.0);
        assert!((before - at(&layers) - dissipated).abs() < 1e-12 * before);
    }
}

#[test]
fn gradient_and_hessian_match_differences_on_both_sides_of_the_yield() {
    for layers in [1, 2, 5] {
        let section = SECTION.in_layers(layers);
        let mut rng = ChaCha8Rng::seed_from_u64(3);
        let h = 1e-4;
        let mut smooth = 0;
        for _ in 0..100 {
            let (e, p, d) = (
                random(&mut rng),
                parts(&mut rng, &section),
                random(&mut rng),
            );
            let at = |s: f64| {
                let e = e + s * h * d;
                let flow = section.flow(STIFFNESS, e, &p);
                let elastic = e - flow.step;
                let energy = 0.5 * STIFFNESS * elastic.norm_squared() + flow.energy;
                (energy, STIFFNESS * elastic)
            };
            let flow = section.flow(STIFFNESS, e, &p);
            let moment = at(0.0).1;
            let slope = (at(1.0).0 - at(-1.0).0) / (2.0 * h);
            assert!((slope - moment.dot(&d)).abs() < 1e-6, "{slope}");
            let whole = e + section.plastic::<3>(&p);
            let mut yields = section.of_section(STIFFNESS).zip(p.as_chunks::<3>().0);
            let at_yield = yields.any(|(layer, p)| {
                let p = Vector3::from(*p);
                let drive = layer.rigidity * (whole - p) - layer.hardening * p;
                (drive.norm() - layer.moment).abs() < 8.0 * h * layer.rigidity
            });
            if at_yield {
                continue;
            }
            smooth += 1;
            let change = (at(1.0).1 - at(-1.0).1) / (2.0 * h);
            let tangent = STIFFNESS * (Matrix3::identity() - flow.slope);
            assert!((change - tangent * d).norm() < 1e-5, "{change}");
            assert!(tangent.symmetric_eigenvalues().min() >= -1e-14);
        }
        assert!(smooth > 80, "{smooth} of 100");
    }
}

/// Bends a section that was flat to curvatures in turn; the moments.
fn bend<const N: usize>(section: Yield, curvatures: [f64; N]) -> [f64; N] {
    let mut layers = vec![0.0; section.layers];
    curvatures.map(|k| {
        let e = Vector1::new(k) - section.plastic(&layers);
        section.settle(STIFFNESS, e, &mut layers);
        STIFFNESS * (k - section.plastic::<1>(&layers)[0])
    })
}

/// Bent to one side, let go, bent to the other: the closed forms of kinematic hardening.
#[test]
fn a_section_springs_back_and_yields_sooner_to_the_other_side() {
    let Yield {
        moment, hardening, ..
    } = SECTION;
    let slope = STIFFNESS * hardening / (STIFFNESS + hardening);
    let first = moment / STIFFNESS;
    let kept = (STIFFNESS - moment) / (STIFFNESS + hardening);
    let back = 1.0 - 2.0 * first;
    let [top, none, elastic, other] = bend(SECTION, [1.0, kept, back + 1e-9, back - 0.5]);
    assert!((top - moment - slope * (1.0 - first)).abs() < 1e-15);
    // Without moment it is where the plastic part is.
    assert!(none.abs() < 1e-15);
    // Elastic over twice the moment of the yield, then with the same slope.
    assert!((elastic - (top - 2.0 * moment)).abs() < 1e-8);
    assert!((other - (top - 2.0 * moment - 0.5 * slope)).abs() < 1e-9);
}

/// The moment of an elastic-perfectly plastic section beyond its first yield, in parts of that of a section
/// that has yielded throughout (Gardiner).
fn of_whole_section(k: f64) -> f64 {
    let first = 2.0 * SECTION.moment / (3.0 * STIFFNESS);
    if k < first {
        k * STIFFNESS / SECTION.moment
    } else {
        1.0 - (first / k).powi(2) / 3.0
    }
}

/// The largest error of the moment that a section in layers has, in parts of that of a section that has
/// yielded throughout.
fn error_of_moment(layers: usize) -> f64 {
    let section = Yield::perfect(SECTION.moment).in_layers(layers);
    let curvatures = (1..4000).map(|i| 2e-3 * f64::from(i));
    let errors = curvatures.map(|k| {
        let [moment] = bend(section, [k]);
        (moment / SECTION.moment - of_whole_section(k)).abs()
    });
    errors.fold(0.0, f64::max)
}

#[test]
fn layers_have_the_moment_of_a_section_that_yields_from_its_faces() {
    let errors = [1, 2, 4, 8, 16].map(error_of_moment);
    assert!((errors[0] - 4.0 / 27.0).abs() < 1e-3, "{errors:?}");
    for pair in errors.windows(2).skip(1) {
        let order = (pair[0] / pair[1]).log2();
        assert!((order - 2.0).abs() < 0.6, "{errors:?}");
    }
}

/// Springback of an elastic-perfectly plastic section (Gardiner): `R / R_f = 4 q^3 - 3 q + 1` with `q = R s /
/// (E t)`, half the curvature of the first yield in parts of that to which it is bent. Between layers
/// stresses stay.
#[test]
fn a_section_in_layers_springs_back_as_one_that_yields_from_its_faces() {
    for layers in [4, 8, 16] {
        let section = Yield::perfect(SECTION.moment).in_layers(layers);
        for k in [0.55, 0.8, 1.5, 4.0] {
            let q = SECTION.moment / (3.0 * STIFFNESS * k);
            let kept = k * (4.0 * q.powi(3) - 3.0 * q + 1.0);
            let [_, moment] = bend(section, [k, kept]);
            // It is elastic on its way back: what is left of the moment is its error where it was bent.
            let error = moment.abs() / SECTION.moment;
            assert!(
                error < 0.4 / (layers * layers) as f64,
                "{layers}: {k}: {error}"
            );
        }
        let mut memory = vec![0.0; layers];
        section.settle(STIFFNESS, Vector1::new(1.0), &mut memory);
        let flow = section.flow(STIFFNESS, Vector1::zeros(), &memory);
        assert!(flow.step[0] == 0.0 && flow.energy > 0.0);
    }
}

/// Bent the other way, a section in layers has the curve of the first bend in twice its size (Masing): from
/// `k_1` on it is `M(k_1) - 2 M_0((k_1 - k) / 2)`, `M_0` being the first curve, until it meets that curve on
/// the other side.
#[test]
fn the_second_bend_the_other_way_is_the_first_one_doubled() {
    for hardening in [0.0, 0.3] {
        for layers in [1, 3, 7] {
            let section = Yield {
                hardening,
                ..Yield::perfect(SECTION.moment).in_layers(layers)
            };
            let top = 1.7;
            for k in [1.2, 0.6, 0.0, -0.8, -1.7] {
                let [first, second] = bend(section, [top, k]);
                let [half] = bend(section, [0.5 * (top - k)]);
                assert!(
                    (second - (first - 2.0 * half)).abs() < 1e-14,
                    "{layers}: {k}: {second}"
                );
            }
        }
    }
}

/// Bent in a direction that turns, where only the limit of small steps is exact: errors are of first order.
#[test]
fn the_plastic_part_converges_with_the_number_of_steps() {
    let section = SECTION.in_layers(2);
    let bend = |count: u32| {
        let mut layers = vec![0.0; 6];
        for k in 1..=count {
            let s = f64::from(k) / f64::from(count);
            let k = 3.0 * s * Vector3::new((2.0 * s).cos(), (2.0 * s).sin(), 0.3 * s);
            let e = k - section.plastic(&layers);
            section.settle(STIFFNESS, e, &mut layers);
        }
        section.plastic::<3>(&layers)
    };
    let exact = bend(1 << 16);
    let errors = [16, 32, 64].map(|count| (bend(count) - exact).norm());
    for pair in errors.windows(2) {
        let order = (pair[0] / pair[1]).log2();
        assert!((order - 1.0).abs() < 0.15, "{errors:?}");
    }
}

#[test]
fn numbers_that_make_no_sense_are_refused() {
    for (moment, hardening, layers, name) in [
        (0.0, 0.0, 1, "moment"),
        (f64::NAN, 0.0, 1, "moment"),
        (1.0, -1.0, 1, "hardening"),
        (1.0, f64::INFINITY, 1, "hardening"),
        (1.0, 0.0, 0, "layers"),
        (1.0, 0.0, 101, "layers"),
    ] {
        let section = Yield {
            moment,
            hardening,
            layers,
        };
        assert_eq!(section.validate().expect_err(name).name, name);
    }
    assert_eq!(Yield::perfect(1.0).validate(), Ok(()));
}

/// A cantilever under a force at its end, whose largest moment is `m M_y` at the clamp: what is left of the
/// deflection of its end is the integral of what is left of the curvature times the distance from the end. Of
/// the whole section that is `k_y / (3 (1 - m))^(1/2) - m M_y / D` beyond two thirds of `M_y`.
#[test]
fn a_cantilever_in_the_default_number_of_layers_keeps_what_it_should() {
    let section = Yield::perfect(1.0).in_layers(Yield::LAYERS);
    // The curvature of the layers at a moment, by bisection.
    let kept = |m: f64| {
        let (mut low, mut high) = (0.0, 100.0);
        for _ in 0..60 {
            let k: f64 = 0.5 * (low + high);
            let layers = section.of_section(1.0);
            let moment: f64 = layers.map(|l| (l.rigidity * k).min(l.moment)).sum();
            match moment < m {
                true => low = k,
                false => high = k,
            }
        }
        low - m
    };
    let exact = |m: f64| match m > 2.0 / 3.0 {
        true => (2.0 / 3.0) / (3.0 * (1.0 - m)).sqrt() - m,
        false => 0.0,
    };
    for largest in [0.75, 0.8, 0.85, 0.9, 0.95, 0.97, 0.99] {
        let count = 2000;
        let tip = |curvature: &dyn Fn(f64) -> f64| -> f64 {
            let arms = (0..count).map(|k| (f64::from(k) + 0.5) / f64::from(count));
            arms.map(|arm| arm * curvature(largest * arm)).sum()
        };
        let error = tip(&kept) / tip(&exact) - 1.0;
        assert!(error.abs() < 1e-2, "{largest}: {error}");
    }
}
