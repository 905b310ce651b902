//! Smoothing of the distance of two edges where they are parallel.

use nalgebra::Vector3;
use serde::{Deserialize, Serialize};

/// Threshold relative to the squared product of the rest lengths, Li et al. 2020: a sine of about 0.03.
const RELATIVE_THRESHOLD: f64 = 1e-3;

/// The factor that takes the contact of two edges out smoothly as they become parallel.
///
/// The distance of two edges has a kink in its gradient where they are parallel. With `c = |u x v|^2`
/// (`u`, `v` the edge vectors) and a threshold `e` the factor
///
/// ```text
/// m = (2 - y) y,   y = c / e   for c < e,   else 1
/// ```
///
/// is once continuously differentiable and vanishes with its gradient at `c = 0`, so its product with a
/// function of the distance is smooth there. The pairs of points and triangles about the edges still keep
/// parallel edges apart. Li et al. 2020, Incremental potential contact, Eq. 24.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct ParallelEdges {
    pub(super) u: Vector3<f64>,
    pub(super) v: Vector3<f64>,
    pub(super) threshold: f64,
    /// `|u x v|^2` over the threshold, below one.
    pub(super) y: f64,
}

impl ParallelEdges {
    /// Of two edge vectors in space (metres) with the given squared rest lengths (square metres), the
    /// threshold being `1e-3` of their product; `None` where the factor is one.
    pub fn new(u: Vector3<f64>, v: Vector3<f64>, rest_lengths2: [f64; 2]) -> Option<Self> {
        let threshold = RELATIVE_THRESHOLD * rest_lengths2[0] * rest_lengths2[1];
        let y = u.cross(&v).norm_squared() / threshold;
        (y < 1.0).then_some(Self { u, v, threshold, y })
    }

    /// Derivative of the factor by `|u x v|^2`, times two: `dm/dx = rate J^T (u x v)`.
    pub(super) fn rate(&self) -> f64 {
        4.0 * (1.0 - self.y) / self.threshold
    }

    /// The factor `m`, from 0 to 1.
    pub fn factor(&self) -> f64 {
        (2.0 - self.y) * self.y
    }

    /// `J^T z` for the derivative `J` of `u x v` by the four points, the ends of `u` and the ends of `v`.
    pub(super) fn pull_back(&self, z: &Vector3<f64>) -> [Vector3<f64>; 4] {
        let (du, dv) = (self.v.cross(z), z.cross(&self.u));
        [-du, du, -dv, dv]
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    fn factor(x: &[f64; 12]) -> f64 {
        let p = |i: usize| Vector3::from_column_slice(&x[3 * i..3 * i + 3]);
        let (u, v) = (p(1) - p(0), p(3) - p(2));
        ParallelEdges::new(u, v, [1.0, 4.0]).map_or(1.0, |e| e.factor())
    }

    proptest! {
        #![proptest_config(isosheet_random::cases(256))]

        #[test]
        fn gradient_matches_differences(
            turn in -0.03..0.03_f64, tilt in -0.03..0.03_f64,
            a in proptest::array::uniform3(-1.0..1.0_f64), b in proptest::array::uniform3(-1.0..1.0_f64),
        ) {
            let (u, v) = (Vector3::new(1.0, 0.0, 0.0), Vector3::new(2.0, 2.0 * turn, 2.0 * tilt));
            let (a, b) = (Vector3::from(a), Vector3::from(b));
            let edges = ParallelEdges::new(u, v, [1.0, 4.0]);
            // The second derivative jumps at the threshold.
            prop_assume!(edges.is_some_and(|e| e.y < 0.99));
            let edges = edges.unwrap();
            let gradient = edges.pull_back(&u.cross(&v)).map(|g| edges.rate() * g);
            let points = [a, a + u, b, b + v];
            let x: [f64; 12] = std::array::from_fn(|i| points[i / 3][i % 3]);
            let h = 1e-6;
            for i in 0..12 {
                let at = |d: f64| {
                    let mut y = x;
                    y[i] += d;
                    factor(&y)
                };
                let slope = (at(h) - at(-h)) / (2.0 * h);
                prop_assert!((slope - gradient[i / 3][i % 3]).abs() < 1e-6 * 60.0, "{}", slope);
            }
        }
    }

    #[test]
    fn parallel_edges_have_no_part_and_skew_ones_the_whole() {
        let x = Vector3::x();
        let along = ParallelEdges::new(x, 2.0 * x, [1.0, 4.0]).unwrap();
        assert_eq!(along.factor(), 0.0);
        assert_eq!(along.pull_back(&x.cross(&x))[1].norm(), 0.0);
        assert_eq!(ParallelEdges::new(x, Vector3::y(), [1.0, 1.0]), None);
        // A sine of the root of a thousandth is where the factor becomes one.
        let at = |sine: f64| ParallelEdges::new(x, Vector3::new(1.0, sine, 0.0), [1.0, 1.0]);
        assert!(at(0.03163).is_none() && at(0.03162).unwrap().factor() > 0.999);
    }
}
