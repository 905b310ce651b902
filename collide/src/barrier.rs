//! The energy that keeps primitives apart.

use crate::{Closest, Jet, ParallelMollifier};
use nalgebra::Vector3;
use thiserror::Error;

/// A barrier that starts at an activation distance and grows without bound towards contact.
///
/// With a thickness `s` and the activation distance `d_hat` the squared gap `y = D - s^2` becomes
/// active below `y_hat = (s + d_hat)^2 - s^2`, and with `z = y / y_hat`
///
/// ```text
/// b = -(1 - z)^2 ln z   for 0 < z < 1,    0 for z >= 1,    infinite for z <= 0.
/// ```
///
/// It is twice continuously differentiable, decreasing and convex in `D`, and a function of the
/// ratio `z` alone: no unit enters. A potential multiplies it with a stiffness in joules. Li et al.
/// 2020 (Incremental potential contact, Eq. 6) up to the factor `y_hat^2`; the thickness as Li et
/// al. 2021 (Codimensional incremental potential contact, Sec. 3.3).
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Barrier {
    activation: f64,
    thickness: f64,
    /// Square of the thickness.
    closed: f64,
    /// Active range of squared distances beyond `closed`.
    range: f64,
}

/// A barrier that makes no sense.
#[derive(Debug, Clone, PartialEq, Error)]
pub enum BarrierError {
    /// The activation distance is not a positive length.
    #[error("activation distance {0} m: give a positive length, for instance 1e-3 of the sheet")]
    Activation(f64),
    /// The thickness is negative or not a number.
    #[error("thickness {0} m: give zero or a positive length")]
    Thickness(f64),
    /// The squares of the lengths are too large or too small for floating-point numbers.
    #[error(
        "activation distance {activation} m with thickness {thickness} m: their squares cannot be represented"
    )]
    Range {
        /// The activation distance.
        activation: f64,
        /// The thickness.
        thickness: f64,
    },
}

impl Barrier {
    /// A barrier that is active while the distance is between `thickness` and
    /// `thickness + activation`, both in metres.
    ///
    /// # Errors
    /// [`BarrierError`] unless the activation is positive and the thickness not negative.
    pub fn new(activation: f64, thickness: f64) -> Result<Self, BarrierError> {
        if !(activation > 0.0 && activation.is_finite()) {
            return Err(BarrierError::Activation(activation));
        }
        if !(thickness >= 0.0 && thickness.is_finite()) {
            return Err(BarrierError::Thickness(thickness));
        }
        let closed = thickness * thickness;
        let range = activation * (activation + 2.0 * thickness);
        // Second derivatives divide by the square of the range.
        if !(range * range).is_normal() || closed + range == closed {
            return Err(BarrierError::Range {
                activation,
                thickness,
            });
        }
        Ok(Self {
            activation,
            thickness,
            closed,
            range,
        })
    }

    /// Distance beyond the thickness at which the barrier starts, metres.
    pub fn activation(&self) -> f64 {
        self.activation
    }

    /// Distance that is never reached, metres.
    pub fn thickness(&self) -> f64 {
        self.thickness
    }

    /// Distance below which the barrier is not zero, metres: the reach for the broad phase.
    pub fn reach(&self) -> f64 {
        self.thickness + self.activation
    }

    /// Whether the barrier is not zero at a squared distance (square metres).
    pub fn is_active(&self, distance2: f64) -> bool {
        distance2 - self.closed < self.range
    }

    /// The barrier at a squared distance (square metres). No unit; infinite at and below the
    /// thickness.
    pub fn value(&self, distance2: f64) -> f64 {
        let z = (distance2 - self.closed) / self.range;
        if z >= 1.0 {
            0.0
        } else if z > 0.0 {
            -(1.0 - z) * (1.0 - z) * z.ln()
        } else {
            f64::INFINITY
        }
    }

    /// The barrier and its first and second derivative by the squared distance. At and below the
    /// thickness the value is infinite and the derivatives are not numbers.
    pub fn derivatives(&self, distance2: f64) -> [f64; 3] {
        let z = (distance2 - self.closed) / self.range;
        if z >= 1.0 {
            return [0.0; 3];
        }
        if z <= 0.0 {
            return [f64::INFINITY, f64::NAN, f64::NAN];
        }
        let (u, ln) = (1.0 - z, z.ln());
        [
            -u * u * ln,
            u * (2.0 * ln - u / z) / self.range,
            (-2.0 * ln + u * (3.0 * z + 1.0) / (z * z)) / (self.range * self.range),
        ]
    }

    /// Size of the contact force along the normal per joule of stiffness, `-db/dd` with `d` the
    /// distance (metres): one over metres, not negative.
    pub fn force(&self, distance: f64) -> f64 {
        -2.0 * distance * self.derivatives(distance * distance)[1]
    }

    /// Barrier of a stencil with gradient and Hessian by its points.
    pub fn jet<const N: usize>(&self, x: &[Vector3<f64>; N], closest: &Closest<N>) -> Jet<N> {
        closest.jet(x).compose(self.derivatives(closest.distance2))
    }

    /// Barrier of two edges, taken out as they become parallel.
    pub fn mollified_jet(
        &self,
        x: &[Vector3<f64>; 4],
        closest: &Closest<4>,
        mollifier: &ParallelMollifier,
    ) -> Jet<4> {
        self.jet(x, closest).times(&mollifier.jet(x))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::distance::{edge_edge, point_triangle};
    use crate::testing::{check_jet, points, sizes};
    use proptest::prelude::*;

    proptest! {
        #[test]
        fn derivatives_match_differences(z in 1e-3..1.2_f64, d_hat in sizes(), thick in 0.0..3.0_f64) {
            // The third derivative jumps where the barrier starts.
            prop_assume!((z - 1.0).abs() > 1e-3);
            let b = Barrier::new(d_hat, thick * d_hat).unwrap();
            let range = b.reach() * b.reach() - b.thickness() * b.thickness();
            let y = b.thickness() * b.thickness() + z * range;
            let [value, slope, curvature] = b.derivatives(y);
            let h = 1e-5 * z * range;
            prop_assert_eq!(value, b.value(y));
            let (up, down) = (b.derivatives(y + h), b.derivatives(y - h));
            // Differences of the squares cost digits when the thickness is large.
            let tolerance = 1e-6 * (1.0 + thick * thick / z);
            let size = slope.abs() + 1e-3 / range;
            prop_assert!(((up[0] - down[0]) / (2.0 * h) - slope).abs() < tolerance * size);
            let size = curvature + 1e-2 / (range * range);
            prop_assert!(((up[1] - down[1]) / (2.0 * h) - curvature).abs() < tolerance * size);
            // Decreasing and convex.
            prop_assert!(value >= 0.0 && slope <= 0.0 && curvature >= 0.0);
            prop_assert!((b.force(y.sqrt()) + 2.0 * y.sqrt() * slope).abs() <= 1e-9 * size * b.reach() * range);
        }

        #[test]
        fn stencils_match_differences(x in points::<4>(), size in sizes()) {
            let x = x.map(|p| size * p);
            let reach = 1.5 * size;
            let b = Barrier::new(0.8 * reach, 0.0).unwrap();
            for f in [point_triangle, edge_edge] {
                let closest = f(&x);
                let d = closest.distance();
                // Smooth where the feature stays and the barrier has room to be differenced.
                let steady = (0..12).all(|k| [-1e-4, 1e-4].iter().all(|e| {
                    let mut y = x;
                    y[k / 3][k % 3] += e * size;
                    f(&y).feature == closest.feature
                }));
                let thin = (x[1] - x[0]).cross(&(x[3] - x[2])).norm() < 0.2 * size * size
                    || (x[2] - x[1]).cross(&(x[3] - x[1])).norm() < 0.2 * size * size;
                if steady && !thin && d > 0.2 * size && (d / b.reach() - 1.0).abs() > 1e-3 {
                    check_jet(&x, 0.05 * size, &|y| b.jet(y, &f(y)));
                }
            }
        }
    }

    #[test]
    fn joins_zero_twice_differentiably_and_ends_at_infinity() {
        let b = Barrier::new(2e-3, 1e-3).unwrap();
        let top = b.reach() * b.reach();
        let range = top - 1e-6;
        for (k, scale) in [1.0, 1.0 / range, 1.0 / (range * range)]
            .into_iter()
            .enumerate()
        {
            assert!(b.derivatives(top - 1e-7 * range)[k].abs() < 1e-5 * scale);
            assert_eq!(b.derivatives(top * (1.0 + 1e-12))[k], 0.0);
        }
        assert!(b.is_active(0.999 * top) && !b.is_active(1.001 * top));
        assert_eq!(b.value(1e-6), f64::INFINITY);
        assert_eq!(b.value(0.0), f64::INFINITY);
        assert!(b.derivatives(0.0)[1].is_nan());
        // At half the range, by hand: (1/2)^2 ln 2.
        let half = b.value(1e-6 + 0.5 * range);
        assert!((half - 0.25 * 2.0_f64.ln()).abs() < 1e-12);
    }

    /// The stated value is that of the literature divided by `d_hat^4`.
    #[test]
    fn agrees_with_the_published_barrier() {
        let d_hat = 0.01_f64;
        let b = Barrier::new(d_hat, 0.0).unwrap();
        for d in [1e-5, 1e-3, 0.005, 0.0099_f64] {
            let (y, h) = (d * d, d_hat * d_hat);
            let published = -(y - h) * (y - h) * (y / h).ln();
            assert!((b.value(y) * h * h / published - 1.0).abs() < 1e-9);
        }
    }

    /// Integrating the force over the distance gives the energy back.
    #[test]
    fn work_of_the_force_is_the_energy() {
        let b = Barrier::new(0.02, 0.005).unwrap();
        let (low, high, n) = (0.009, b.reach(), 20_000);
        let h = (high - low) / f64::from(n);
        let work: f64 = (0..n)
            .map(|i| b.force(low + (f64::from(i) + 0.5) * h) * h)
            .sum();
        assert!((work / b.value(low * low) - 1.0).abs() < 1e-6);
    }

    #[test]
    fn parallel_edges_carry_no_force() {
        let v = Vector3::new;
        let x = [
            v(0.0, 0.0, 0.0),
            v(1.0, 0.0, 0.0),
            v(0.0, 0.0, 0.1),
            v(1.0, 0.0, 0.1),
        ];
        let b = Barrier::new(0.2, 0.0).unwrap();
        let closest = edge_edge(&x);
        let jet = b.mollified_jet(&x, &closest, &ParallelMollifier::new(1.0, 1.0));
        assert_eq!(jet.value, 0.0);
        assert!(b.jet(&x, &closest).value > 0.0);
    }

    #[test]
    fn bad_lengths_are_refused() {
        assert_eq!(Barrier::new(0.0, 0.0), Err(BarrierError::Activation(0.0)));
        assert!(matches!(
            Barrier::new(f64::NAN, 0.0),
            Err(BarrierError::Activation(_))
        ));
        assert_eq!(Barrier::new(1.0, -1.0), Err(BarrierError::Thickness(-1.0)));
        assert!(matches!(
            Barrier::new(1e-90, 0.0),
            Err(BarrierError::Range { .. })
        ));
        assert!(matches!(
            Barrier::new(1e-20, 1.0),
            Err(BarrierError::Range { .. })
        ));
    }
}
