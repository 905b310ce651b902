//! Least squares with bounds.

use nalgebra::{DMatrix, DVector};

/// Where the differences are taken, the part of a parameter's range: runs are exact to their tolerances, and
/// differences of less than a thousandth of a range would be those of round-off and of tolerances.
const DIFFERENCE: f64 = 1e-3;

/// The search ends where a step changes no parameter by more than this part of its range, near the tolerances
/// of runs.
const SMALLEST: f64 = 1e-8;

/// The damping where a step without one does not succeed, and the factor by which it grows (Marquardt 1963).
const DAMPING: f64 = 1e-3;
const GROWTH: f64 = 10.0;

/// The largest damping: steps along the gradient that are shorter than [`SMALLEST`].
const MOST_DAMPING: f64 = 1e6;

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
/// Newton with the damping of Levenberg and Marquardt and derivatives by differences in one direction. A
/// parameter that a step would move beyond a bound stays there. None where a derivative cannot be computed.
///
/// # Errors
/// Those of `evaluate`.
pub(super) fn least_squares<E>(
    start: Point,
    evaluate: &mut Evaluate<'_, E>,
    watch: &mut dyn FnMut(&Point),
) -> Result<Option<Minimum>, E> {
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

/// The derivatives of the differences, by differences toward the middle of each range.
fn jacobian<E>(point: &Point, evaluate: &mut Evaluate<'_, E>) -> Result<Option<DMatrix<f64>>, E> {
    let count = point.at.len();
    let moved = |k: usize, by: f64| {
        let mut at = point.at.clone();
        at[k] += by;
        at
    };
    let inward = |k: usize| {
        if point.at[k] > 0.5 {
            -DIFFERENCE
        } else {
            DIFFERENCE
        }
    };
    let mut found = evaluate(&(0..count).map(|k| moved(k, inward(k))).collect::<Vec<_>>())?;
    let mut columns = Vec::with_capacity(count);
    for (k, found) in found.iter_mut().enumerate() {
        let (mut by, mut found) = (inward(k), found.take());
        if found.is_none() {
            by = -by;
            let at = moved(k, by);
            if !(0.0..=1.0).contains(&at[k]) {
                return Ok(None);
            }
            found = evaluate(&[at])?.pop().flatten();
        }
        let Some(found) = found else {
            return Ok(None);
        };
        columns.push((found - &point.differences) / by);
    }
    Ok(Some(DMatrix::from_columns(&columns)))
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
        let mut normal = own.tr_mul(&own);
        for k in 0..free.len() {
            normal[(k, k)] *= 1.0 + damping;
        }
        let slopes = DVector::from_iterator(free.len(), free.iter().map(|k| gradient[*k]));
        // Parameters on which nothing depends stay where they are.
        let change = normal.svd(true, true).solve(&-slopes, f64::EPSILON).ok()?;
        let mut at = point.at.clone();
        for (k, change) in free.iter().zip(change.iter()) {
            at[*k] += change;
        }
        let beyond: Vec<usize> = free
            .iter()
            .copied()
            .filter(|k| {
                !(0.0..=1.0).contains(&at[*k]) && (point.at[*k] <= 0.0 || point.at[*k] >= 1.0)
            })
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

    /// A step to where nothing can be computed is shortened.
    #[test]
    fn points_that_fail_are_avoided() {
        let minimum = found(&[0.9], |at| {
            (at[0] > 0.2).then(|| vec![at[0] * at[0] - 0.09, 0.0])
        });
        assert!((minimum.point.at[0] - 0.3).abs() < SMALLEST, "{minimum:?}");
    }
}
