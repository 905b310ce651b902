//! How far sets of points have moved.

use crate::narrow_phase::larger;

/// Displacements of points: the least and the largest along each axis, metres.
#[derive(Debug, Clone, Copy)]
pub(super) struct Displacements {
    low: [f64; 3],
    high: [f64; 3],
}

impl Displacements {
    /// Of points on a motion from `x0` to `x1`, since they were at `reference` (three values a point). Not
    /// numbers if a coordinate is not finite.
    pub(super) fn since(reference: &[f64], x0: &[f64], x1: &[f64]) -> Self {
        let mut range = Self {
            low: [f64::INFINITY; 3],
            high: [f64::NEG_INFINITY; 3],
        };
        let mut sum = 0.0;
        let places = x0.as_chunks::<3>().0.iter().zip(x1.as_chunks::<3>().0);
        for (r, (p, q)) in reference.as_chunks::<3>().0.iter().zip(places) {
            for k in 0..3 {
                let (d, e) = (p[k] - r[k], q[k] - r[k]);
                range.low[k] = range.low[k].min(d).min(e);
                range.high[k] = range.high[k].max(d).max(e);
                sum += d.abs() + e.abs();
            }
        }
        // `min` and `max` pass over values that are not numbers.
        if !sum.is_finite() {
            range.low = [f64::NAN; 3];
        }
        range
    }

    /// The largest displacement along an axis of a point relative to one of the others, metres.
    pub(super) fn relative_to(&self, others: &Self) -> f64 {
        let along = |k: usize| larger(self.high[k] - others.low[k], others.high[k] - self.low[k]);
        (0..3).map(along).fold(0.0, larger)
    }

    /// Bound on the displacement of a point relative to another one, metres: the diagonal of the range.
    pub(super) fn spread(&self) -> f64 {
        let squares = (0..3).map(|k| (self.high[k] - self.low[k]).powi(2));
        squares.sum::<f64>().sqrt()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_common_displacement_is_none() {
        let reference = [0.0, 1.0, 2.0, 3.0, 4.0, 5.0];
        let moved = reference.map(|c| c + 0.5);
        let range = Displacements::since(&reference, &moved, &moved);
        assert_eq!(range.relative_to(&range), 0.0);
        let rest = Displacements::since(&reference, &reference, &reference);
        assert_eq!(range.relative_to(&rest), 0.5);
        assert_eq!(rest.relative_to(&range), 0.5);
    }

    #[test]
    fn no_point_moves_further_from_another_than_the_spread() {
        let reference = [0.0; 9];
        let moved = [3.0, 0.0, 0.0, 0.0, 4.0, 0.0, 1.0, 1.0, 12.0];
        let range = Displacements::since(&reference, &moved, &moved);
        assert_eq!(range.spread(), 13.0);
    }

    #[test]
    fn start_and_end_count() {
        let reference = [0.0; 6];
        let start = [0.1, 0.0, 0.0, 0.0, 0.0, 0.0];
        let end = [0.0, 0.0, 0.0, -0.2, 0.0, 0.0];
        let range = Displacements::since(&reference, &start, &end);
        assert!((range.relative_to(&range) - 0.3).abs() < 1e-15);
    }

    #[test]
    fn what_is_not_a_number_stays_so() {
        for bad in [f64::NAN, f64::INFINITY] {
            let range = Displacements::since(&[0.0; 3], &[0.0; 3], &[0.0, bad, 0.0]);
            assert!(range.relative_to(&range).is_nan());
        }
    }
}
