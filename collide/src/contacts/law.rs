//! The barrier as a function of the gap.

use crate::Barrier;

/// Part of the activation distance that a loaded contact keeps.
const REST: f64 = 0.5;

/// Vertices whose weight it carries.
const LOAD: f64 = 100.0;

/// The potential `phi(g) = kappa b(g^2)` of a gap `g`: distance less thickness, and less the radius
/// of a round body. A function of the gap rather than of the distance, so that balls, capsules and
/// their signed distances repel alike.
#[derive(Debug, Clone, Copy)]
pub(super) struct GapPotential {
    barrier: Barrier,
    stiffness: f64,
}

impl GapPotential {
    /// The barrier has to be one without thickness.
    pub(super) fn new(barrier: Barrier, stiffness: f64) -> Self {
        Self { barrier, stiffness }
    }

    /// With the stiffness at which the weight of a hundred masses under an acceleration keeps half the
    /// activation distance.
    pub(super) fn for_weight(barrier: Barrier, mass: f64, acceleration: f64) -> Self {
        let unit = Self::new(barrier, 1.0);
        let force = unit.force(REST * barrier.activation());
        Self::new(barrier, LOAD * mass * acceleration / force)
    }

    /// Joules; infinite at and below zero, and if the gap is not a number.
    pub(super) fn value(&self, gap: f64) -> f64 {
        if gap > 0.0 {
            self.stiffness * self.barrier.value(gap * gap)
        } else {
            f64::INFINITY
        }
    }

    /// Value, first and second derivative by the gap.
    pub(super) fn derivatives(&self, gap: f64) -> [f64; 3] {
        let [b, b1, b2] = self.barrier.derivatives(gap * gap);
        let k = self.stiffness;
        [
            k * b,
            2.0 * k * gap * b1,
            k * (2.0 * b1 + 4.0 * gap * gap * b2),
        ]
    }

    /// Force along the normal, `-phi'`, newtons.
    pub(super) fn force(&self, gap: f64) -> f64 {
        -self.derivatives(gap)[1]
    }
}
