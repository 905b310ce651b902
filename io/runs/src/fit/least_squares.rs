//! Least squares with bounds.

use nalgebra::{DMatrix, DVector};

/// Where the differences are taken, the part of a parameter's range. Derivatives are of second order, so that
/// they are right to some 1e-6 where a target is smooth; runs are exact to some 1e-9, and differences over
/// less would be differences of their tolerances.
pub(super) const DIFFERENCE: f64 = 1e-3;

/// A combination of parameters is determined whose effect is more than this part of the largest one, each
/// parameter by the size of its own: a hundred times the error of a derivative.
pub(super) const DETERMINED: f64 = 1e-4;

/// The search ends where a step changes no parameter by more than this part of its range, near the tolerances
/// of runs.
const SMALLEST: f64 = 1e-8;

/// The damping where a step without one does not succeed, and the factor by which it grows (Marquardt 1963).
const DAMPING: f64 = 1e-3;
const GROWTH: f64 = 10.0;

/// The largest damping: steps along the gradient that are shorter than [`SMALLEST`].
const MOST_DAMPING: f64 = 1e6;

/// The search ends where the differences are this part of the ones at its start.
const ENOUGH: f64 = 1e-8;

/// The search ends where a step makes the sum of the squares smaller by less than this part.
const GAIN: f64 = 1e-6;

/// Most steps of a search. (Gauss and Newton's takes less than ten where differences can be made to vanish.)
const MOST_STEPS: usize = 50;

/// A point of a search.
#[derive(Clone, Debug)]
pub(super) struct Point {
    /// The parameters, parts of their ranges, from 0 to 1.
    pub(super) at: Vec<f64>,
    /// The differences there.
    pub(super) differences: DVector<f64>,
}

impl Point {
    pub(super) fn cost(&self) -> f64 {
        self.differences.norm_squared()
    }
}

/// Where a search ended.
#[derive(Clone, Debug)]
pub(super) struct Minimum {
    pub(super) point: Point,
    /// The derivatives of the differences by the parameters, at the point from which the last step was taken.
    pub(super) jacobian: DMatrix<f64>,
    /// Whether the search came to its end.
    pub(super) is_found: bool,
}

/// Computes the differences at some points: none where that fails.
pub(super) type Evaluate<'a, E> =
    dyn FnMut(&[Vec<f64>]) -> Result<Vec<Option<DVector<f64>>>, E> + 'a;

/// Finds parameters in `[0, 1]` with the least sum of squares of the differences, by the method of Gauss and
/// Newton with the damping of Levenberg and Marquardt and derivatives by
/// differences. A
/// parameter that a step would move beyond a bound stays there. None where a derivative cannot be computed.
///
/// # Errors
/// Those of `evaluate`.
pub(super) fn least_squares<E>(
    start: Point,
    evaluate: &mut Evaluate<'_, E>,
    watch: &mut dyn FnMut(&Point),
) -> Result<Option<Minimum>, E> {
    let enough = ENOUGH * ENOUGH * start.cost();
    let mut point = start;
    let mut damping = 0.0;
    for _ in 0..MOST_STEPS {
        watch(&point);
        let Some(jacobian) = jacobian(&point, evaluate)? else {
            return Ok(None);
        };
        let ended = |point: Point, is_found| {
            Ok(Some(Minimum {
                point,
                jacobian: jacobian.clone(),
                is_found,
            }))
        };
        if point.cost() <= enough {
            return ended(point, true);
        }
        loop {
            let Some(at) = step(&point, &jacobian, damping) else {
                return ended(point, true);
            };
            let [differences] = &mut evaluate(std::slice::from_ref(&at))?[..] else {
                return ended(point, false);
            };
            let next = differences
                .take()
                .map(|differences| Point { at, differences });
            match next.filter(|next| next.cost() < point.cost()) {
                Some(next) if next.cost() > (1.0 - GAIN) * point.cost() => {
                    return ended(next, true);
                }
                Some(next) => {
                    point = next;
                    damping = if damping > DAMPING {
                        damping / GROWTH
                    } else {
                        0.0
                    };
                    break;
                }
                None => damping = (damping * GROWTH).max(DAMPING),
            }
            if damping > MOST_DAMPING {
                return ended(point, true);
            }
        }
    }
    watch(&point);
    let jacobian = jacobian(&point, evaluate)?;
    Ok(jacobian.map(|jacobian| Minimum {
        point,
        jacobian,
        is_found: false,
    }))
}

/// The derivatives of the differences: central ones, at the ends of ranges of second order from inside, and
/// of first order where the run at one place fails.
fn jacobian<E>(point: &Point, evaluate: &mut Evaluate<'_, E>) -> Result<Option<DMatrix<f64>>, E> {
    let steps = |at: f64| match at {
        _ if at < DIFFERENCE => [DIFFERENCE, 2.0 * DIFFERENCE],
        _ if at > 1.0 - DIFFERENCE => [-DIFFERENCE, -2.0 * DIFFERENCE],
        _ => [DIFFERENCE, -DIFFERENCE],
    };
    let mut places = Vec::with_capacity(2 * point.at.len());
    for (k, at) in point.at.iter().enumerate() {
        for step in steps(*at) {
            let mut place = point.at.clone();
            place[k] += step;
            places.push(place);
        }
    }
    let found = evaluate(&places)?;
    let mut columns = Vec::with_capacity(point.at.len());
    for (at, found) in point.at.iter().zip(found.as_chunks::<2>().0) {
        let [p, q] = steps(*at);
        let here = &point.differences;
        columns.push(match found {
            // The parabola through three places.
            [Some(a), Some(b)] => {
                (a - here) * (q / (p * (q - p))) - (b - here) * (p / (q * (q - p)))
            }
            [Some(a), None] => (a - here) / p,
            [None, Some(b)] => (b - here) / q,
            [None, None] => return Ok(None),
        });
    }
    Ok(Some(DMatrix::from_columns(&columns)))
}

/// The singular values and the right singular vectors of derivatives whose columns have unit length, and the
/// lengths (one where a column is zero).
pub(super) fn combinations(jacobian: &DMatrix<f64>) -> (DVector<f64>, DMatrix<f64>, Vec<f64>) {
    let lengths: Vec<f64> = jacobian
        .column_iter()
        .map(|column| match column.norm() {
            0.0 => 1.0,
            norm => norm,
        })
        .collect();
    let mut scaled = jacobian.clone();
    for (mut column, length) in scaled.column_iter_mut().zip(&lengths) {
        column /= *length;
    }
    if jacobian.ncols() == 0 {
        return (DVector::zeros(0), DMatrix::zeros(0, 0), lengths);
    }
    // Eigenvectors of the normal matrix: there may be fewer differences than parameters.
    let own = scaled.tr_mul(&scaled).symmetric_eigen();
    let values = own.eigenvalues.map(|value| value.max(0.0).sqrt());
    (values, own.eigenvectors, lengths)
}

/// The change of the parameters that makes the linearised differences smallest, damped: of combinations that
/// are not determined by nothing.
fn damped(jacobian: &DMatrix<f64>, differences: &DVector<f64>, damping: f64) -> DVector<f64> {
    let (values, vectors, lengths) = combinations(jacobian);
    let largest = values.max();
    let mut slopes = -jacobian.tr_mul(differences);
    for (slope, length) in slopes.iter_mut().zip(&lengths) {
        *slope /= *length;
    }
    let mut parts = vectors.tr_mul(&slopes);
    for (part, value) in parts.iter_mut().zip(values.iter()) {
        *part = match *value > DETERMINED * largest {
            true => *part / (value * value + damping),
            false => 0.0,
        };
    }
    let mut change = vectors * parts;
    for (change, length) in change.iter_mut().zip(&lengths) {
        *change /= *length;
    }
    change
}

/// Where a step goes; none where it would not go further than [`SMALLEST`].
fn step(point: &Point, jacobian: &DMatrix<f64>, damping: f64) -> Option<Vec<f64>> {
    let gradient = jacobian.tr_mul(&point.differences);
    let mut is_free: Vec<bool> = point
        .at
        .iter()
        .zip(gradient.iter())
        .map(|(at, slope)| !(*at <= 0.0 && *slope > 0.0 || *at >= 1.0 && *slope < 0.0))
        .collect();
    // Each round fixes the parameters that leave their ranges.
    loop {
        let free: Vec<usize> = (0..is_free.len()).filter(|k| is_free[*k]).collect();
        if free.is_empty() {
            return None;
        }
        let own = jacobian.select_columns(&free);
        let change = damped(&own, &point.differences, damping);
        let mut at = point.at.clone();
        for (k, change) in free.iter().zip(change.iter()) {
            at[*k] += change;
        }
        let beyond: Vec<usize> = free
            .iter()
            .copied()
            .filter(|k| at[*k] < 0.0 && point.at[*k] <= 0.0 || at[*k] > 1.0 && point.at[*k] >= 1.0)
            .collect();
        if !beyond.is_empty() {
            beyond.iter().for_each(|k| is_free[*k] = false);
            continue;
        }
        at.iter_mut().for_each(|c| *c = c.clamp(0.0, 1.0));
        let moved = at.iter().zip(&point.at).map(|(a, b)| (a - b).abs());
        return (moved.fold(0.0, f64::max) > SMALLEST).then_some(at);
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::convert::Infallible;

    fn found(start: &[f64], function: impl Fn(&[f64]) -> Option<Vec<f64>>) -> Minimum {
        let value = |at: &[f64]| function(at).map(DVector::from_vec);
        let mut evaluate = |points: &[Vec<f64>]| -> Result<_, Infallible> {
            Ok(points.iter().map(|at| value(at)).collect())
        };
        let start = Point {
            at: start.to_vec(),
            differences: value(start).unwrap(),
        };
        let Ok(minimum) = least_squares(start, &mut evaluate, &mut |_| ());
        minimum.unwrap()
    }

    /// Rosenbrock's valley, whose minimum is at (1, 1), in a square of side 4.
    fn valley(at: &[f64]) -> Option<Vec<f64>> {
        let [x, y] = [4.0 * at[0] - 2.0, 4.0 * at[1] - 2.0];
        Some(vec![10.0 * (y - x * x), 1.0 - x])
    }

    #[test]
    fn a_valley_is_followed_to_its_end() {
        let minimum = found(&[0.2, 0.75], valley);
        assert!(minimum.is_found);
        for at in &minimum.point.at {
            assert!((at - 0.75).abs() < SMALLEST, "{minimum:?}");
        }
    }

    /// Where the minimum is outside, a parameter stays at its bound, and the other one has its best value.
    #[test]
    fn bounds_are_kept() {
        let minimum = found(&[0.9, 0.1], |at| {
            assert!(at.iter().all(|c| (0.0..=1.0).contains(c)));
            Some(vec![at[0] + 0.5, 3.0 * (at[1] - at[0] - 0.25)])
        });
        assert_eq!(minimum.point.at[0], 0.0);
        assert!((minimum.point.at[1] - 0.25).abs() < SMALLEST, "{minimum:?}");
    }

    /// A start at an end of its range is left, also by a step that would go beyond the other end.
    #[test]
    fn starts_at_ends_are_left() {
        for start in [0.0, 1.0] {
            let minimum = found(&[start], |at| Some(vec![(3.0 * at[0] - 1.0).powi(3)]));
            assert!(
                (minimum.point.at[0] - 1.0 / 3.0).abs() < 0.02,
                "{minimum:?}"
            );
        }
    }

    /// Of two parameters of which one combination matters the search changes that alone.
    #[test]
    fn what_is_not_determined_stays() {
        let minimum = found(&[0.2, 0.6], |at| {
            Some(vec![at[0] + at[1] - 1.0, 2.0 * (at[0] + at[1] - 1.0)])
        });
        assert!(minimum.is_found);
        for (found, expected) in minimum.point.at.iter().zip([0.3, 0.7]) {
            assert!((found - expected).abs() < 1e-6, "{minimum:?}");
        }
    }

    /// A step to where nothing can be computed is shortened.
    #[test]
    fn points_that_fail_are_avoided() {
        let minimum = found(&[0.9], |at| {
            (at[0] > 0.2).then(|| vec![at[0] * at[0] - 0.09, 0.0])
        });
        assert!((minimum.point.at[0] - 0.3).abs() < SMALLEST, "{minimum:?}");
    }
}
