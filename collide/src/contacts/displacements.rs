//! How far sets of points have moved.

use isosheet_geometry::vectors::larger;

/// Displacements of points beyond boxes: the least of their lower sides and the largest of their upper sides
/// along each axis, metres. Where the boxes are points, these are the least and the largest displacement.
#[derive(Debug, Clone, Copy)]
pub(super) struct Displacements {
    low: [f64; 3],
    high: [f64; 3],
}

impl Displacements {
    /// Of points on a motion from `x0` to `x1`, beyond the boxes of another motion with the start and end
    /// `other` (three values a point). Not numbers if a coordinate is not finite.
    pub(super) fn beyond(other: [&[f64]; 2], x0: &[f64], x1: &[f64]) -> Self {
        let mut range = Self {
            low: [f64::INFINITY; 3],
            high: [f64::NEG_INFINITY; 3],
        };
        let mut sum = 0.0;
        let [r0, r1, x0, x1] = [other[0], other[1], x0, x1].map(|x| x.as_chunks::<3>().0);
        for ((r, s), (p, q)) in r0.iter().zip(r1).zip(x0.iter().zip(x1)) {
            for k in 0..3 {
                let low = p[k].min(q[k]) - r[k].min(s[k]);
                let high = p[k].max(q[k]) - r[k].max(s[k]);
                range.low[k] = range.low[k].min(low);
                range.high[k] = range.high[k].max(high);
                sum += p[k] + q[k] + r[k] + s[k];
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

    /// Of points that have gone from one place to another.
    fn between(reference: &[f64], x: &[f64]) -> Displacements {
        Displacements::beyond([reference; 2], x, x)
    }

    #[test]
    fn a_common_displacement_is_none() {
        let reference = [0.0, 1.0, 2.0, 3.0, 4.0, 5.0];
        let range = between(&reference, &reference.map(|c| c + 0.5));
        assert_eq!(range.relative_to(&range), 0.0);
        let rest = between(&reference, &reference);
        assert_eq!(range.relative_to(&rest), 0.5);
        assert_eq!(rest.relative_to(&range), 0.5);
    }

    #[test]
    fn no_point_moves_further_from_another_than_the_spread() {
        let moved = [3.0, 0.0, 0.0, 0.0, 4.0, 0.0, 1.0, 1.0, 12.0];
        assert_eq!(between(&[0.0; 9], &moved).spread(), 13.0);
    }

    #[test]
    fn start_and_end_count() {
        let start = [0.1, 0.0, 0.0, 0.0, 0.0, 0.0];
        let end = [0.0, 0.0, 0.0, -0.2, 0.0, 0.0];
        let range = Displacements::beyond([&[0.0; 6]; 2], &start, &end);
        assert!((range.relative_to(&range) - 0.3).abs() < 1e-15);
    }

    #[test]
    fn a_motion_within_another_one_goes_not_beyond_it() {
        let (start, end) = ([0.0, 1.0, -2.0], [4.0, -1.0, -2.0]);
        let whole = Displacements::beyond([&start, &end], &end, &start);
        assert_eq!(whole.relative_to(&whole), 0.0);
        let part = Displacements::beyond([&start, &end], &[1.0, 0.5, -2.0], &[3.0, -0.5, -2.0]);
        assert_eq!(part.relative_to(&part), 0.0);
        let other = Displacements::beyond([&start, &end], &[1.0, 0.5, -2.25], &[4.5, -0.5, -2.0]);
        assert_eq!(other.relative_to(&whole), 0.5);
    }

    #[test]
    fn what_is_not_a_number_stays_so() {
        for bad in [f64::NAN, f64::INFINITY] {
            let (good, bad) = ([0.0; 3], [0.0, bad, 0.0]);
            for motions in [[&good, &good, &good, &bad], [&good, &bad, &good, &good]] {
                let [r0, r1, x0, x1] = motions;
                let range = Displacements::beyond([r0, r1], x0, x1);
                assert!(range.relative_to(&range).is_nan());
            }
        }
    }
}
