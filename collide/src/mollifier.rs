//! Smoothing of the edge-edge distance where the edges are parallel.

use crate::Jet;
use nalgebra::{Matrix3, Vector3};

/// A factor that takes the contact of two edges out smoothly as they become parallel.
///
/// The distance of two edges has a kink in its gradient where they are parallel. With
/// `c = |u x v|^2` (`u`, `v` the edge vectors) and a threshold `e` the factor
///
/// ```text
/// m = (2 - c/e) c/e   for c < e,   else 1
/// ```
///
/// is once continuously differentiable and vanishes with its gradient at `c = 0`, so its product
/// with a function of the distance is smooth there. The point-triangle pairs about the edges still
/// keep parallel edges apart. Li et al. 2020, Incremental potential contact, Eq. 24.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct ParallelMollifier {
    threshold: f64,
}

/// Threshold relative to the squared product of the rest lengths, Li et al. 2020: a sine of about
/// 0.03.
const RELATIVE_THRESHOLD: f64 = 1e-3;

impl ParallelMollifier {
    /// For edges with the given squared rest lengths, square metres. The threshold is
    /// `1e-3 |u|^2 |v|^2` at rest.
    pub fn new(first_length2: f64, second_length2: f64) -> Self {
        Self {
            threshold: RELATIVE_THRESHOLD * first_length2 * second_length2,
        }
    }

    /// The value of `|u x v|^2` from which the factor is one, metres to the fourth power.
    pub fn threshold(&self) -> f64 {
        self.threshold
    }

    /// The factor for the stencil `[a, b, c, d]` of the edges `ab` and `cd`, between 0 and 1.
    pub fn value(&self, x: &[Vector3<f64>; 4]) -> f64 {
        self.factor((x[1] - x[0]).cross(&(x[3] - x[2])).norm_squared())[0]
    }

    /// The factor with gradient and Hessian by the points.
    pub fn jet(&self, x: &[Vector3<f64>; 4]) -> Jet<4> {
        let (u, v) = (x[1] - x[0], x[3] - x[2]);
        let n = u.cross(&v);
        let c = n.norm_squared();
        if c >= self.threshold {
            return Jet::constant(1.0);
        }
        let (du, dv) = (2.0 * v.cross(&n), 2.0 * n.cross(&u));
        let across = |e: &Vector3<f64>| {
            2.0 * (Matrix3::from_diagonal_element(e.norm_squared()) - e * e.transpose())
        };
        let (uu, vv) = (across(&v), across(&u));
        let uv = 2.0
            * (2.0 * u * v.transpose()
                - v * u.transpose()
                - Matrix3::from_diagonal_element(u.dot(&v)));
        let vu = uv.transpose();
        Jet {
            value: c,
            gradient: [-du, du, -dv, dv],
            hessian: [
                [uu, -uu, uv, -uv],
                [-uu, uu, -uv, uv],
                [vu, -vu, vv, -vv],
                [-vu, vu, -vv, vv],
            ],
        }
        .compose(self.factor(c))
    }

    /// Factor and its derivatives by `c`.
    fn factor(&self, c: f64) -> [f64; 3] {
        if c >= self.threshold {
            return [1.0, 0.0, 0.0];
        }
        let e = self.threshold;
        let y = c / e;
        [(2.0 - y) * y, 2.0 * (1.0 - y) / e, -2.0 / (e * e)]
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::distance::edge_edge;
    use crate::testing::{check_jet, points, sizes};
    use proptest::prelude::*;

    fn nearly_parallel() -> impl Strategy<Value = [Vector3<f64>; 4]> {
        (points::<4>(), 0.0..0.05_f64).prop_filter_map("short edge", |(mut x, bend)| {
            x[3] = x[2] + 0.8 * (x[1] - x[0]) + bend * x[3];
            ((x[1] - x[0]).norm() > 0.3).then_some(x)
        })
    }

    fn rest(x: &[Vector3<f64>; 4]) -> ParallelMollifier {
        ParallelMollifier::new((x[1] - x[0]).norm_squared(), (x[3] - x[2]).norm_squared())
    }

    proptest! {
        #[test]
        fn derivatives_match_differences(x in nearly_parallel(), size in sizes()) {
            let x = x.map(|p| size * p);
            let m = rest(&x);
            let c = (x[1] - x[0]).cross(&(x[3] - x[2])).norm_squared();
            // The second derivative jumps at the threshold.
            if (c / m.threshold() - 1.0).abs() > 1e-2 {
                check_jet(&x, 0.03 * size, &|y| m.jet(y));
            }
            prop_assert_eq!(m.jet(&x).value, m.value(&x));
            prop_assert!((0.0..=1.0).contains(&m.value(&x)));
        }

        #[test]
        fn parallel_edges_lose_value_and_slope(x in nearly_parallel()) {
            let m = rest(&x);
            let mut y = x;
            y[3] = y[2] + 0.5 * (y[1] - y[0]);
            let jet = m.jet(&y);
            prop_assert!(jet.value < 1e-12);
            prop_assert!(jet.gradient.iter().all(|g| g.norm() < 1e-9));
            // Crossing at a right angle: untouched.
            let across = (x[1] - x[0]).cross(&Vector3::new(0.3, -0.5, 0.8)).normalize();
            y[3] = y[2] + (x[1] - x[0]).norm() * across;
            prop_assert_eq!(rest(&y).jet(&y), Jet::constant(1.0));
        }
    }

    /// The product with the distance has a continuous gradient through the parallel position; the
    /// distance alone has not.
    #[test]
    fn product_is_smooth_where_the_distance_is_not() {
        let v = Vector3::new;
        let stencil = |tilt: f64| {
            [
                v(-1.0, 0.0, 0.0),
                v(1.0, 0.0, 0.0),
                v(-1.0, -tilt, 0.1),
                v(1.0, tilt, 0.1 + tilt),
            ]
        };
        let slope = |tilt: f64| {
            let x = stencil(tilt);
            let distance = edge_edge(&x).jet(&x);
            let product = distance.times(&rest(&x).jet(&x));
            (distance.gradient[2].z, product.gradient[2].z)
        };
        let (left, right) = (slope(-1e-7), slope(1e-7));
        assert!((left.0 - right.0).abs() > 0.1, "{left:?} {right:?}");
        assert!((left.1 - right.1).abs() < 1e-5, "{left:?} {right:?}");
    }
}
