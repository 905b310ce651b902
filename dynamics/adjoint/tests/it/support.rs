//! Gradients beside central differences of whole runs.

use crate::problems::exact;
use isosheet_adjoint::{AdjointOptions, Family, Gradient, Loss, Plan, Run, SceneError};
use isosheet_dynamics::Method;
use isosheet_mesh::{Sheet, generate};

/// A sheet that is curved in two directions, so that no rod depends on others.
pub(crate) fn shell() -> Result<Sheet, SceneError> {
    let square = generate::isotropic_square(2, 0.2)?;
    Ok(square.map_positions(|[x, y, _]| [x, y, 2.0 * x * (x - 0.3 * y) + y * y])?)
}

pub(crate) fn bdf2() -> Method {
    Method::Bdf2(exact())
}

/// The gradient of a loss, which is as near to central differences with their best step as `bound` says,
/// relative to the larger of the two.
pub(crate) fn checked(
    name: &str,
    family: &dyn Family,
    numbers: &[f64],
    plan: &Plan,
    loss: &dyn Loss,
    bound: f64,
) -> Gradient {
    checked_with(
        AdjointOptions::default(),
        name,
        family,
        numbers,
        plan,
        loss,
        bound,
    )
}

/// As [`checked`], with options.
pub(crate) fn checked_with(
    options: AdjointOptions,
    name: &str,
    family: &dyn Family,
    numbers: &[f64],
    plan: &Plan,
    loss: &dyn Loss,
    bound: f64,
) -> Gradient {
    let run = Run::record(family, numbers, plan.clone(), options.clone()).expect("a run");
    let gradient = run.gradient(loss).expect("a gradient");
    let value = run.value(loss).expect("a value");
    assert!((gradient.value - value).abs() <= 1e-14 * value.abs());
    println!("{name}: {:?}", gradient.effort);
    for (k, found) in gradient.of_numbers.iter().enumerate() {
        let value = |change: f64| {
            let mut moved = numbers.to_vec();
            moved[k] += change;
            let run = Run::record(family, &moved, plan.clone(), options.clone()).expect("a run");
            run.value(loss).expect("a value")
        };
        let size = match options.sizes.get(k) {
            Some(size) => *size,
            None => numbers[k].abs(),
        };
        let errors = [1e-3, 1e-4, 1e-5, 1e-6, 1e-7, 1e-8].map(|part| {
            let h = part * size;
            let slope = (value(h) - value(-h)) / (2.0 * h);
            ((slope - found) / slope.abs().max(found.abs()), slope)
        });
        let best = errors
            .iter()
            .fold(f64::INFINITY, |best, (error, _)| best.min(error.abs()));
        println!("  {name}, number {k}: {found:.10e}, error {best:.1e} of {errors:?}");
        assert!(best <= bound, "{name}, number {k}: {found} {errors:?}");
    }
    gradient
}
