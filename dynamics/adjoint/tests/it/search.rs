//! The method of Broyden, Fletcher, Goldfarb and Shanno, for searches that gradients lead (Nocedal and
//! Wright, "Numerical Optimization", 2006, Sec. 6.1).

use isosheet_adjoint::{AdjointOptions, Family, Loss, Plan, Run};
use nalgebra::{DMatrix, DVector};

/// What a search has come to.
pub(crate) struct Found {
    pub(crate) numbers: Vec<f64>,
    /// The losses of all runs, in order.
    pub(crate) losses: Vec<f64>,
}

/// Decreases a loss from a start, in so many runs. The inverse of its second derivatives is first taken to be
/// `scale` times the identity.
pub(crate) fn minimise(
    family: &dyn Family,
    plan: &Plan,
    loss: &dyn Loss,
    start: &[f64],
    scale: f64,
    runs: usize,
    goal: f64,
) -> Found {
    let evaluate = |at: &DVector<f64>| {
        let options = AdjointOptions::default();
        let run = Run::record(family, at.as_slice(), plan.clone(), options).ok()?;
        let gradient = run.gradient(loss).expect("a gradient");
        Some((gradient.value, DVector::from_vec(gradient.of_numbers)))
    };
    let n = start.len();
    let mut at = DVector::from_column_slice(start);
    let (mut value, mut gradient) = evaluate(&at).expect("a run at the start");
    let mut losses = vec![value];
    let mut inverse = DMatrix::identity(n, n) * scale;
    let mut part = 1.0;
    while losses.len() < runs && value > goal {
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
