//! Smoothed Coulomb friction.

use super::{FrictionError, FrictionLaw};
use serde::{Deserialize, Serialize};

/// Coefficients of Coulomb friction, see [`Coulomb`].
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Coefficients {
    /// Static coefficient, at least the kinetic one.
    pub rest: f64,
    /// Kinetic coefficient.
    pub sliding: f64,
}

impl Coefficients {
    /// No friction, and no cost of it.
    pub const FRICTIONLESS: Self = Self {
        rest: 0.0,
        sliding: 0.0,
    };

    /// Equal coefficients `mu` at rest and in motion.
    pub const fn equal(mu: f64) -> Self {
        Self {
            rest: mu,
            sliding: mu,
        }
    }

    /// Whether there is no friction.
    pub(crate) fn is_frictionless(&self) -> bool {
        self.rest == 0.0
    }

    /// # Errors
    /// [`FrictionError`] unless `0 <= sliding <= rest`.
    pub fn validate(&self) -> Result<(), FrictionError> {
        Coulomb::new(self.rest, self.sliding, 1.0).map(|_| ())
    }
}

/// Coulomb's law with the jump at rest smoothed out.
///
/// At a sliding speed `v` the friction force is the normal force times
///
/// ```text
/// mu(v) = mu_s (2 - v/e) v/e                               for v < e           (sticking)
/// mu(v) = mu_s - (mu_s - mu_k) (3 - 2 w) w^2               for e <= v < 3 e,   w = (v - e) / (2 e)
/// mu(v) = mu_k                                             beyond              (sliding)
/// ```
///
/// with the static and the kinetic coefficient and the speed `e` that counts as rest. The solver measures
/// speeds of this law in metres a step: `v` is the sliding distance in the step, and `e` the speed that
/// counts as rest times the step.
///
/// The first line is Li et al. 2020 (Incremental potential contact, Eq. 15); the second, a cubic step from
/// the static to the kinetic coefficient, is ours. `mu` is once continuously differentiable. With equal
/// coefficients its integral is convex; otherwise it is not between `e` and `3 e`, as dry friction with two
/// coefficients is.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct Coulomb {
    rest: f64,
    sliding: f64,
    smoothing: f64,
}

/// Width of the passage from the static to the kinetic coefficient in smoothing distances: as wide
/// as keeps its steepest descent (0.75 of the jump per `e`) below the ascent before it.
const TRANSITION_WIDTH: f64 = 2.0;

impl Coulomb {
    /// With the static coefficient `rest`, the kinetic coefficient `sliding` and the speed `smoothing` that
    /// counts as rest.
    ///
    /// # Errors
    /// [`FrictionError`] unless `0 <= sliding <= rest` and `smoothing` is positive.
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
}

impl FrictionLaw for Coulomb {
    fn coefficient(&self, v: f64) -> f64 {
        v * self.coefficient_over_speed(v)
    }

    /// Li et al. 2020 add a constant, `e/3`, that makes it `v` beyond `e`; here it vanishes at rest.
    fn integral(&self, v: f64) -> f64 {
        let e = self.smoothing;
        let u = v / e;
        if u < 1.0 {
            return self.rest * e * u * u * (1.0 - u / 3.0);
        }
        let w = (u - 1.0) / TRANSITION_WIDTH;
        let c = w.min(1.0);
        let passed = TRANSITION_WIDTH * e * c * c * c * (1.0 - 0.5 * c);
        let beyond = TRANSITION_WIDTH * e * (w - c);
        self.rest * (2.0 / 3.0 * e + v - e) - (self.rest - self.sliding) * (passed + beyond)
    }

    fn slope(&self, v: f64) -> f64 {
        let e = self.smoothing;
        let u = v / e;
        if u < 1.0 {
            2.0 * self.rest * (1.0 - u) / e
        } else {
            let w = ((u - 1.0) / TRANSITION_WIDTH).min(1.0);
            -(self.rest - self.sliding) * 6.0 * (1.0 - w) * w / (TRANSITION_WIDTH * e)
        }
    }

    /// At rest it is `2 mu_s / e`.
    fn coefficient_over_speed(&self, v: f64) -> f64 {
        let e = self.smoothing;
        let u = v / e;
        if u < 1.0 {
            self.rest * (2.0 - u) / e
        } else {
            let w = ((u - 1.0) / TRANSITION_WIDTH).min(1.0);
            (self.rest - (self.rest - self.sliding) * (3.0 - 2.0 * w) * w * w) / v
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    proptest! {
        #![proptest_config(isosheet_random::cases(256))]

        #[test]
        fn law_is_consistent(u in 0.0..5.0_f64, size in -6.0..3.0_f64, rest in 0.0..2.0_f64, part in 0.0..=1.0_f64) {
            let e = 10.0_f64.powf(size);
            let f = Coulomb::new(rest, part * rest, e).unwrap();
            let y = u * e;
            let h = 1e-6 * e;
            let y = y.max(2.0 * h);
            let scale = rest + 1e-9;
            let slope = (f.integral(y + h) - f.integral(y - h)) / (2.0 * h);
            prop_assert!((slope - f.coefficient(y)).abs() < 1e-8 * scale);
            // The slope of the force jumps nowhere, its own slope is bounded by 2 mu / e^2.
            let slope = (f.coefficient(y + h) - f.coefficient(y - h)) / (2.0 * h);
            prop_assert!((slope - f.slope(y)).abs() < 1e-5 * scale / e);
            prop_assert!((f.coefficient_over_speed(y) * y - f.coefficient(y)).abs() <= 1e-15 * scale);
            prop_assert!(f.coefficient(y) <= rest * (1.0 + 1e-15));
        }
    }

    #[test]
    fn the_static_coefficient_is_reached_and_the_kinetic_one_stays() {
        let friction = Coulomb::new(0.6, 0.3, 1e-4).unwrap();
        assert!((friction.coefficient(1e-4) - 0.6).abs() < 1e-15);
        assert!((friction.coefficient(3e-4) - 0.3).abs() < 1e-15);
        assert!((friction.coefficient(1.0) - 0.3).abs() < 1e-15);
        // Rest has a finite stiffness.
        let stiffness = 2.0 * 0.6 / 1e-4;
        assert!((friction.coefficient_over_speed(0.0) - stiffness).abs() < 1e-9 * stiffness);
    }

    #[test]
    fn bad_coefficients_are_refused() {
        assert!(matches!(
            Coulomb::new(-0.1, 0.0, 1.0),
            Err(FrictionError::Coefficient { .. })
        ));
        assert!(matches!(
            Coulomb::new(0.1, f64::NAN, 1.0),
            Err(FrictionError::Coefficient { .. })
        ));
        assert!(matches!(
            Coulomb::new(0.1, 0.2, 1.0),
            Err(FrictionError::Order { .. })
        ));
        assert_eq!(
            Coulomb::new(0.1, 0.1, 0.0),
            Err(FrictionError::Smoothing(0.0))
        );
    }
}
