//! Smoothed Coulomb friction with lagged normals.

use crate::{Closest, Jet};
use nalgebra::{Matrix3, Vector3};
use thiserror::Error;

/// Coulomb's law with the jump at rest smoothed out.
///
/// For a sliding distance `y` within a step the friction force is the normal force times
///
/// ```text
/// f(y) = mu_s (2 - y/e) y/e                               for y < e           (sticking)
/// f(y) = mu_s - (mu_s - mu_k) (3 - 2 w) w^2               for e <= y < 3 e,   w = (y - e) / (2 e)
/// f(y) = mu_k                                             beyond              (sliding)
/// ```
///
/// with the static and the kinetic coefficient and the smoothing distance `e`, the speed that counts
/// as rest times the step. The first line is Li et al. 2020 (Incremental potential contact, Eq. 15);
/// the second, a cubic step from the static to the kinetic coefficient, is ours. `f` is once
/// continuously differentiable and the derivative of a dissipation potential
/// ([`Friction::potential`]). With equal coefficients that potential is convex; otherwise it is not
/// between `e` and `3 e`, as dry friction with two coefficients is.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Friction {
    rest: f64,
    sliding: f64,
    smoothing: f64,
}

/// Width of the passage from the static to the kinetic coefficient in smoothing distances: as wide
/// as keeps its steepest descent (0.75 of the jump per `e`) below the ascent before it.
const PASSAGE: f64 = 2.0;

/// Coefficients that make no sense.
#[derive(Debug, Clone, PartialEq, Error)]
pub enum FrictionError {
    /// A coefficient is negative or not a number.
    #[error("friction coefficients {rest} (static) and {sliding} (kinetic): give numbers >= 0")]
    Coefficient {
        /// Static coefficient.
        rest: f64,
        /// Kinetic coefficient.
        sliding: f64,
    },
    /// The kinetic coefficient exceeds the static one.
    #[error("kinetic coefficient {sliding} above the static coefficient {rest}: swap them")]
    Order {
        /// Static coefficient.
        rest: f64,
        /// Kinetic coefficient.
        sliding: f64,
    },
    /// The smoothing distance is not positive.
    #[error(
        "smoothing distance {0} m: give a positive length, the speed that counts as rest times the step"
    )]
    Smoothing(f64),
}

impl Friction {
    /// With the static coefficient `rest`, the kinetic coefficient `sliding` and the smoothing
    /// distance in metres.
    ///
    /// # Errors
    /// [`FrictionError`] unless `0 <= sliding <= rest` and the smoothing distance is positive.
    pub fn new(rest: f64, sliding: f64, smoothing: f64) -> Result<Self, FrictionError> {
        let valid = |c: f64| c >= 0.0 && c.is_finite();
        if !valid(rest) || !valid(sliding) {
            return Err(FrictionError::Coefficient { rest, sliding });
        }
        if sliding > rest {
            return Err(FrictionError::Order { rest, sliding });
        }
        if !(smoothing > 0.0 && smoothing.is_finite()) {
            return Err(FrictionError::Smoothing(smoothing));
        }
        Ok(Self {
            rest,
            sliding,
            smoothing,
        })
    }

    /// Static coefficient.
    pub fn rest(&self) -> f64 {
        self.rest
    }

    /// Kinetic coefficient.
    pub fn sliding(&self) -> f64 {
        self.sliding
    }

    /// Smoothing distance, metres.
    pub fn smoothing(&self) -> f64 {
        self.smoothing
    }

    /// Friction force over normal force after sliding a distance `y >= 0` (metres) in the step.
    pub fn force(&self, y: f64) -> f64 {
        y * self.force_over_distance(y)
    }

    /// `f(y) / y`, one over metres: finite at rest, where it is `2 mu_s / e`.
    pub fn force_over_distance(&self, y: f64) -> f64 {
        let e = self.smoothing;
        let u = y / e;
        if u < 1.0 {
            self.rest * (2.0 - u) / e
        } else {
            let w = ((u - 1.0) / PASSAGE).min(1.0);
            (self.rest - (self.rest - self.sliding) * (3.0 - 2.0 * w) * w * w) / y
        }
    }

    /// `df/dy`, one over metres.
    pub fn force_slope(&self, y: f64) -> f64 {
        let e = self.smoothing;
        let u = y / e;
        if u < 1.0 {
            2.0 * self.rest * (1.0 - u) / e
        } else {
            let w = ((u - 1.0) / PASSAGE).min(1.0);
            -(self.rest - self.sliding) * 6.0 * (1.0 - w) * w / (PASSAGE * e)
        }
    }

    /// The integral of the force from 0 to `y`, metres: dissipation potential over normal force.
    ///
    /// Li et al. 2020 add a constant, `e/3`, that makes it `y` beyond `e`; here it vanishes at rest.
    pub fn potential(&self, y: f64) -> f64 {
        let e = self.smoothing;
        let u = y / e;
        if u < 1.0 {
            return self.rest * e * u * u * (1.0 - u / 3.0);
        }
        let w = (u - 1.0) / PASSAGE;
        let c = w.min(1.0);
        let passed = PASSAGE * e * c * c * c * (1.0 - 0.5 * c);
        let beyond = PASSAGE * e * (w - c);
        self.rest * (2.0 / 3.0 * e + y - e) - (self.rest - self.sliding) * (passed + beyond)
    }
}

/// Friction at one contact with normal, closest points and normal force held at their values at the
/// start of an iteration (Li et al. 2020, Sec. 5).
///
/// For displacements `dx_i` since the start of the step the contact slides by
/// `u = (I - n n^T) sum_i w_i dx_i`; its potential is `N F(|u|)` with the normal force `N` and the
/// integral `F` of the friction law.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct LaggedContact<const N: usize> {
    /// Weights of the points in the relative motion, from [`Closest::weights`].
    pub weights: [f64; N],
    /// Unit normal.
    pub normal: Vector3<f64>,
    /// Normal force, newtons.
    pub force: f64,
}

impl<const N: usize> LaggedContact<N> {
    /// At the closest points of a stencil, which must not touch, under a normal force in newtons.
    pub fn new(closest: &Closest<N>, force: f64) -> Self {
        Self {
            weights: closest.weights,
            normal: closest.difference / closest.distance(),
            force,
        }
    }

    /// The sliding displacement `u` (metres) for displacements `dx` of the points.
    pub fn slip(&self, dx: &[Vector3<f64>; N]) -> Vector3<f64> {
        let mut u = Vector3::zeros();
        for i in 0..N {
            u += self.weights[i] * dx[i];
        }
        u - self.normal * self.normal.dot(&u)
    }

    /// Dissipation potential (joules) with gradient and Hessian by the displacements `dx`, and so by
    /// the positions at the end of the step. The negative gradient is the friction force.
    pub fn jet(&self, friction: &Friction, dx: &[Vector3<f64>; N]) -> Jet<N> {
        let u = self.slip(dx);
        let y = u.norm();
        let ratio = self.force * friction.force_over_distance(y);
        let tangential = Matrix3::identity() - self.normal * self.normal.transpose();
        let mut block = ratio * tangential;
        if y > 0.0 {
            let t = u / y;
            block += (self.force * friction.force_slope(y) - ratio) * t * t.transpose();
        }
        let w = &self.weights;
        Jet {
            value: self.force * friction.potential(y),
            gradient: w.map(|w| w * ratio * u),
            hessian: std::array::from_fn(|i| std::array::from_fn(|j| w[i] * w[j] * block)),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::distance::point_triangle;
    use crate::testing::{check_jet, points, sizes};
    use proptest::prelude::*;

    proptest! {
        #[test]
        fn law_is_consistent(u in 0.0..5.0_f64, e in sizes(), rest in 0.0..2.0_f64, part in 0.0..=1.0_f64) {
            let f = Friction::new(rest, part * rest, e).unwrap();
            let y = u * e;
            let h = 1e-6 * e;
            let y = y.max(2.0 * h);
            let scale = rest + 1e-9;
            let slope = (f.potential(y + h) - f.potential(y - h)) / (2.0 * h);
            prop_assert!((slope - f.force(y)).abs() < 1e-8 * scale);
            // The slope of the force jumps nowhere, its own slope is bounded by 2 mu / e^2.
            let slope = (f.force(y + h) - f.force(y - h)) / (2.0 * h);
            prop_assert!((slope - f.force_slope(y)).abs() < 1e-5 * scale / e);
            prop_assert!((f.force_over_distance(y) * y - f.force(y)).abs() <= 1e-15 * scale);
            prop_assert!(f.force(y) <= rest * (1.0 + 1e-15));
        }

        #[test]
        fn contacts_match_differences(
            x in points::<4>(), dx in points::<4>(), e in sizes(), size in 0.01..3.0_f64,
            coefficients in (0.1..1.0_f64, 0.0..=1.0_f64),
        ) {
            let closest = point_triangle(&x);
            prop_assume!(closest.distance() > 0.05);
            let contact = LaggedContact::new(&closest, 7.0);
            let friction = Friction::new(coefficients.0, coefficients.0 * coefficients.1, e).unwrap();
            let dx = dx.map(|d| size * e * d);
            // The curvature has kinks at the seams and turns quickly next to rest.
            let y = contact.slip(&dx).norm() / e;
            prop_assume!((y - 1.0).abs() > 1e-3 && (y - 3.0).abs() > 1e-3 && y > 0.05);
            check_jet(&dx, 0.02 * e, &|d| contact.jet(&friction, d));
        }

        #[test]
        fn force_is_tangential_opposes_the_slip_and_sums_to_nothing(x in points::<4>(), dx in points::<4>()) {
            let closest = point_triangle(&x);
            prop_assume!(closest.distance() > 0.05);
            let contact = LaggedContact::new(&closest, 3.0);
            let friction = Friction::new(0.5, 0.4, 1e-3).unwrap();
            let jet = contact.jet(&friction, &dx);
            let total: Vector3<f64> = jet.gradient.iter().sum();
            prop_assert!(total.norm() < 1e-12);
            for g in &jet.gradient {
                prop_assert!(g.dot(&contact.normal).abs() < 1e-12);
            }
            let power: f64 = jet.gradient.iter().zip(&dx).map(|(g, d)| g.dot(d)).sum();
            prop_assert!(power >= 0.0);
            // Sliding far beyond the passage: kinetic coefficient times normal force.
            if contact.slip(&dx).norm() > 3e-3 {
                prop_assert!((jet.gradient[0].norm() - 0.4 * 3.0).abs() < 1e-12);
            }
            // A convex law stays convex, one that falls does not promise it.
            let equal = Friction::new(0.5, 0.5, 0.3).unwrap();
            let jet = contact.jet(&equal, &dx);
            let same = jet.projected();
            for i in 0..4 {
                for j in 0..4 {
                    prop_assert!((jet.hessian[i][j] - same.hessian[i][j]).norm() < 1e-10);
                }
            }
        }
    }

    #[test]
    fn rest_has_a_finite_stiffness() {
        let friction = Friction::new(0.6, 0.3, 1e-4).unwrap();
        let contact = LaggedContact {
            weights: [1.0, -1.0],
            normal: Vector3::z(),
            force: 2.0,
        };
        let jet = contact.jet(&friction, &[Vector3::z(), -3.0 * Vector3::z()]);
        assert_eq!(jet.value, 0.0);
        assert_eq!(jet.gradient[0].norm(), 0.0);
        let stiffness = 2.0 * 2.0 * 0.6 / 1e-4;
        assert!((jet.hessian[0][1][(0, 0)] + stiffness).abs() < 1e-9 * stiffness);
        assert_eq!(jet.hessian[0][1][(2, 2)], 0.0);
        // The static coefficient is reached, the kinetic one stays.
        assert!((friction.force(1e-4) - 0.6).abs() < 1e-15);
        assert!((friction.force(3e-4) - 0.3).abs() < 1e-15);
        assert!((friction.force(1.0) - 0.3).abs() < 1e-15);
    }

    #[test]
    fn bad_coefficients_are_refused() {
        assert!(matches!(
            Friction::new(-0.1, 0.0, 1.0),
            Err(FrictionError::Coefficient { .. })
        ));
        assert!(matches!(
            Friction::new(0.1, f64::NAN, 1.0),
            Err(FrictionError::Coefficient { .. })
        ));
        assert!(matches!(
            Friction::new(0.1, 0.2, 1.0),
            Err(FrictionError::Order { .. })
        ));
        assert_eq!(
            Friction::new(0.1, 0.1, 0.0),
            Err(FrictionError::Smoothing(0.0))
        );
    }
}
