use super::*;
use nalgebra::{Matrix3, Vector3};
use rand::{RngExt, SeedableRng};
use rand_chacha::ChaCha8Rng;

const STIFFNESS: f64 = 2.0;
const SECTION: Yield = Yield {
    moment: 1.5,
    hardening: 0.4,
};

fn random(rng: &mut ChaCha8Rng) -> Vector3<f64> {
    Vector3::from_fn(|_, _| rng.random_range(-1.0..1.0))
}

/// The incremental energy for a growth `d` of the plastic part.
fn energy(e: Vector3<f64>, p: Vector3<f64>, d: Vector3<f64>) -> f64 {
    0.5 * STIFFNESS * (e - d).norm_squared() + SECTION.energy(p, d)
}

#[test]
fn the_growth_minimises_the_energy() {
    let mut rng = ChaCha8Rng::seed_from_u64(2);
    let mut grown = 0;
    for _ in 0..200 {
        let (e, p) = (random(&mut rng), random(&mut rng));
        let step = SECTION.flow(STIFFNESS, e, p).step;
        grown += usize::from(step != Vector3::zeros());
        let least = energy(e, p, step);
        for size in [1e-3, 1e-1] {
            let other = step + size * random(&mut rng);
            assert!(energy(e, p, other) >= least, "{e} {p} {step}");
        }
    }
    assert!((20..180).contains(&grown), "{grown} of 200 yielded");
}

#[test]
fn gradient_and_hessian_match_differences_on_both_sides_of_the_yield() {
    let mut rng = ChaCha8Rng::seed_from_u64(3);
    let h = 1e-4;
    for _ in 0..100 {
        let (e, p, d) = (random(&mut rng), random(&mut rng), random(&mut rng));
        let at = |s: f64| {
            let e = e + s * h * d;
            let flow = SECTION.flow(STIFFNESS, e, p);
            (energy(e, p, flow.step), STIFFNESS * (e - flow.step))
        };
        let flow = SECTION.flow(STIFFNESS, e, p);
        let moment = at(0.0).1;
        let slope = (at(1.0).0 - at(-1.0).0) / (2.0 * h);
        assert!((slope - moment.dot(&d)).abs() < 1e-6, "{slope}");
        let drive = (STIFFNESS * e - SECTION.hardening * p).norm();
        if (drive - SECTION.moment).abs() < 4.0 * h {
            continue;
        }
        let change = (at(1.0).1 - at(-1.0).1) / (2.0 * h);
        let tangent = STIFFNESS * (Matrix3::identity() - flow.slope);
        assert!((change - tangent * d).norm() < 1e-6, "{change}");
        assert!(tangent.symmetric_eigenvalues().min() >= -1e-14);
    }
}

/// Bent to one side, let go, bent to the other: the closed forms of kinematic hardening.
#[test]
fn a_section_springs_back_and_yields_sooner_to_the_other_side() {
    use nalgebra::Vector1;
    let Yield { moment, hardening } = SECTION;
    let mut p = 0.0;
    let mut bend = |k: f64| {
        p += SECTION
            .flow(STIFFNESS, Vector1::new(k - p), Vector1::new(p))
            .step[0];
        (p, STIFFNESS * (k - p))
    };
    let slope = STIFFNESS * hardening / (STIFFNESS + hardening);
    let first = moment / STIFFNESS;
    let (bent, top) = bend(1.0);
    assert!((bent - (STIFFNESS - moment) / (STIFFNESS + hardening)).abs() < 1e-15);
    assert!((top - moment - slope * (1.0 - first)).abs() < 1e-15);
    // Without moment it is where the plastic part is.
    let (kept, none) = bend(bent);
    assert!(kept == bent && none.abs() < 1e-15);
    // Elastic over twice the moment of the yield, then with the same slope.
    let back = 1.0 - 2.0 * first;
    let (kept, _) = bend(back + 1e-9);
    assert_eq!(kept, bent);
    let (further, moment_there) = bend(back - 0.5);
    assert!(further < bent);
    assert!((moment_there - (top - 2.0 * moment - 0.5 * slope)).abs() < 1e-9);
}

/// Bent in a direction that turns, where only the limit of small steps is exact: errors are of first order.
#[test]
fn the_plastic_part_converges_with_the_number_of_steps() {
    let bend = |count: u32| {
        let mut p = Vector3::zeros();
        for k in 1..=count {
            let s = f64::from(k) / f64::from(count);
            let k = 3.0 * s * Vector3::new((2.0 * s).cos(), (2.0 * s).sin(), 0.3 * s);
            p += SECTION.flow(STIFFNESS, k - p, p).step;
        }
        p
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
    for (moment, hardening, name) in [
        (0.0, 0.0, "moment"),
        (f64::NAN, 0.0, "moment"),
        (1.0, -1.0, "hardening"),
        (1.0, f64::INFINITY, "hardening"),
    ] {
        let error = Yield { moment, hardening }.validate().expect_err(name);
        assert_eq!(error.name, name);
    }
    assert_eq!(Yield::perfect(1.0).validate(), Ok(()));
}
