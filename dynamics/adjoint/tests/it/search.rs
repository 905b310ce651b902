//! Searches: Newton's method, and the method of Broyden, Fletcher, Goldfarb and Shanno (Nocedal and Wright,
//! "Numerical Optimization", 2006, Sec. 6.1).

use isosheet_adjoint::{AdjointOptions, Family, Loss, Plan, Run};
use nalgebra::{DMatrix, DVector};

/// What a search for a number has come to.
pub(crate) struct FoundNumber {
    pub(crate) number: f64,
    pub(crate) runs: usize,
}

/// The number with which a loss has a value, by Newton's method.
pub(crate) fn solve(
    family: &dyn Family,
    plan: &Plan,
    loss: &dyn Loss,
    start: f64,
    target: f64,
) -> FoundNumber {
    let mut number = start;
    for runs in 1..20 {
        let run = Run::record(family, &[number], plan.clone(), AdjointOptions::default());
        let gradient = run.expect("a run").gradient(loss).expect("a gradient");
        let step = (gradient.value - target) / gradient.of_numbers[0];
        number -= step.clamp(-0.5 * number.abs(), 0.5 * number.abs());
        if step.abs() <= 1e-9 * number.abs() {
            return FoundNumber { number, runs };
        }
    }
    panic!("the search does not end: {number}");
}

/// What a search for a minimum has come to.
pub(crate) struct Found {
    pub(crate) numbers: Vec<f64>,
    /// The losses in order, infinite where there was no run.
    pub(crate) losses: Vec<f64>,
}

/// A loss with its gradient at numbers; nothing where a run fails.
pub(crate) fn lead_by_gradients<'a>(
    family: &'a dyn Family,
    plan: &'a Plan,
    loss: &'a dyn Loss,
) -> impl FnMut(&[f64]) -> Option<(f64, Vec<f64>)> + 'a {
    |numbers| {
        let options = AdjointOptions::default();
        let run = Run::record(family, numbers, plan.clone(), options).ok()?;
        let gradient = run.gradient(loss).expect("a gradient");
        Some((gradient.value, gradient.of_numbers))
    }
}

/// Decreases a loss from a start, in so many evaluations. The inverse of its second derivatives is first
/// taken to be `scale` times the identity.
pub(crate) fn minimise(
    mut evaluate: impl FnMut(&[f64]) -> Option<(f64, Vec<f64>)>,
    start: &[f64],
    scale: f64,
    most: usize,
    goal: f64,
) -> Found {
    let mut evaluate = |at: &DVector<f64>| {
        let (value, gradient) = evaluate(at.as_slice())?;
        Some((value, DVector::from_vec(gradient)))
    };
    let n = start.len();
    let mut at = DVector::from_column_slice(start);
    let (mut value, mut gradient) = evaluate(&at).expect("a run at the start");
    let mut losses = vec![value];
    let mut inverse = DMatrix::identity(n, n) * scale;
    let mut part = 1.0;
    while losses.len() < most && value > goal {
        let step = -part * (&inverse * &gradient);
        let next = &at + &step;
        let found = evaluate(&next);
        losses.push(found.as_ref().map_or(f64::INFINITY, |(value, _)| *value));
        let Some((there, slope)) = found.filter(|(there, _)| *there < value) else {
            part *= 0.25;
            continue;
        };
        let change = &slope - &gradient;
        let along = step.dot(&change);
        if along > 0.0 {
            let left = DMatrix::identity(n, n) - &step * change.transpose() / along;
            inverse = &left * inverse * left.transpose() + &step * step.transpose() / along;
        }
        (at, value, gradient, part) = (next, there, slope, 1.0);
    }
    Found {
        numbers: at.as_slice().to_vec(),
        losses,
    }
}
