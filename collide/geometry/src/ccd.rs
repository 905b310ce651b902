//! Continuous collision detection that never misses: how far a motion may go.
//!
//! Points move on straight lines, `x(t) = x + t dx`, `0 <= t <= 1`. At any time the closest points of
//! two convex primitives give a direction `n`, and with it a slab between them of width
//!
//! ```text
//! gap = min over the first of n . x_i  -  max over the second of n . x_j.
//! ```
//!
//! Every `n . x_i` is linear in time, so it is known exactly how long the slab stays open, whatever
//! else the primitives do: a time step in which they cannot meet. Summing such steps is the additive
//! continuous collision detection of Li et al. 2021 (Codimensional incremental potential contact,
//! Sec. 5), with a separating direction as in conservative advancement (Mirtich 1996) in place of the
//! largest displacement: primitives that slide along each other or part cost one step instead of
//! thousands, and a fast far end does not slow a near end down.
//!
//! Nothing is solved for, so there is no root to lose. The bound holds for *every* unit vector `n`: an
//! inexact closest point costs progress, never safety. Round-off is subtracted from each gap.

use crate::distance::{edge_edge, point_triangle};
use isosheet_mesh::Advice;
use nalgebra::Vector3;
use thiserror::Error;

#[cfg(test)]
mod tests;

/// Options of the collision detection.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct CcdOptions {
    /// Distance that has to remain, metres: the thickness. Default 0.
    pub separation: f64,
    /// Part of the initial gap that is left at the time returned, between 0 and 1. Default 0.1, as
    /// Li et al. 2021: smaller values come closer and take more iterations.
    pub remainder: f64,
    /// Gap that is left at the time returned where this is more, metres, and half of the initial gap if that
    /// is less than the given length. Default 0: any gap may become as small as the remainder allows.
    pub approach: f64,
    /// Most advances per pair. Default 1000; the time reached by then is safe, only early.
    pub max_iterations: usize,
}

impl Default for CcdOptions {
    fn default() -> Self {
        Self {
            separation: 0.0,
            remainder: 0.1,
            approach: 0.0,
            max_iterations: 1000,
        }
    }
}

/// An option of the collision detection that makes no sense.
#[derive(Debug, Clone, PartialEq, Error)]
#[non_exhaustive]
pub enum CcdOptionsError {
    /// The separation is negative or not a number.
    #[error("the separation is {0} m")]
    Separation(f64),
    /// The remainder is not a proper fraction.
    #[error("the remainder is {0}")]
    Remainder(f64),
    /// The gap to leave is negative or not a number.
    #[error("the gap that motions leave is {0} m")]
    Approach(f64),
    /// No iterations at all.
    #[error("max_iterations is 0")]
    Iterations,
}

impl Advice for CcdOptionsError {
    fn advice(&self) -> Option<&'static str> {
        match self {
            Self::Separation(..) => Some("give zero or a positive length"),
            Self::Remainder(..) => Some("give a number between 0 and 1, for instance 0.1"),
            Self::Approach(..) => Some("give zero or a positive length"),
            Self::Iterations => Some("give at least 1"),
        }
    }
}

impl CcdOptions {
    /// # Errors
    /// [`CcdOptionsError`] naming the option that makes no sense.
    pub fn validate(&self) -> Result<(), CcdOptionsError> {
        if !(self.separation >= 0.0 && self.separation.is_finite()) {
            return Err(CcdOptionsError::Separation(self.separation));
        }
        if !(self.remainder > 0.0 && self.remainder < 1.0) {
            return Err(CcdOptionsError::Remainder(self.remainder));
        }
        if !(self.approach >= 0.0 && self.approach.is_finite()) {
            return Err(CcdOptionsError::Approach(self.approach));
        }
        if self.max_iterations == 0 {
            return Err(CcdOptionsError::Iterations);
        }
        Ok(())
    }

    /// A time up to which a point and a triangle, `[p, a, b, c]`, keep their distance above the
    /// separation, for a motion from `x` to `x + dx`.
    ///
    /// Returns `limit` (0 to 1) if that is safe; the smaller it is, the sooner the search ends, so
    /// pass the best time found so far. Otherwise the largest time that the advances proved safe:
    /// the gap that [`CcdOptions::remainder`] and [`CcdOptions::approach`] ask for, or up to a tenth more, is
    /// left then. Zero if the gap is not above the separation to begin with, up to round-off, or if a
    /// coordinate is not a number.
    pub fn point_triangle(&self, x: &[Vector3<f64>; 4], dx: &[Vector3<f64>; 4], limit: f64) -> f64 {
        self.advance(x, dx, 1, limit, |x| point_triangle(x).difference)
    }

    /// A time up to which two edges `ab` and `cd`, `[a, b, c, d]`, keep their distance above the
    /// separation; at most `limit` (0 to 1). See [`CcdOptions::point_triangle`].
    pub fn edge_edge(&self, x: &[Vector3<f64>; 4], dx: &[Vector3<f64>; 4], limit: f64) -> f64 {
        self.advance(x, dx, 2, limit, |x| edge_edge(x).difference)
    }

    /// The gap that a motion leaves, for the initial gap, metres.
    pub(crate) fn least_gap(&self, initial: f64) -> f64 {
        (self.remainder * initial).max(self.approach.min(0.5 * initial))
    }

    /// The first `split` points of the stencil are the first primitive.
    fn advance<const N: usize>(
        &self,
        x: &[Vector3<f64>; N],
        dx: &[Vector3<f64>; N],
        split: usize,
        limit: f64,
        closest: impl Fn(&[Vector3<f64>; N]) -> Vector3<f64>,
    ) -> f64 {
        if !x.iter().chain(dx).flatten().all(|c| c.is_finite()) {
            return 0.0;
        }
        // Positions relative to one of the points; its own motion is a motion of the frame.
        let start: [Vector3<f64>; N] = std::array::from_fn(|i| x[i] - x[0]);
        let motion: [Vector3<f64>; N] = std::array::from_fn(|i| dx[i] - dx[0]);
        let far = |list: &[Vector3<f64>; N]| list.iter().map(Vector3::amax).fold(0.0, f64::max);
        // The largest coordinate during the motion, also before the subtraction: what the caller makes of the
        // time returned is rounded there. (Of the whole motion, not of the part up to the limit: the time
        // must not depend on the order in which pairs are asked for.)
        let size = far(x) + far(dx);
        let round_off = ROUND_OFF * size;
        let mut t = 0.0;
        let mut least = 0.0;
        for iteration in 0..self.max_iterations {
            let at: [Vector3<f64>; N] = std::array::from_fn(|i| start[i] + t * motion[i]);
            let difference = closest(&at);
            let distance = difference.norm();
            // Squares of huge coordinates may overflow.
            if !(distance > 0.0 && distance < f64::INFINITY) {
                return t;
            }
            let n = difference / distance;
            let height = at.map(|p| n.dot(&p));
            let speed = motion.map(|v| n.dot(&v));
            let margin = self.separation + round_off;
            let pairs = (0..split).flat_map(|i| (split..N).map(move |j| (i, j)));
            let gap = pairs
                .clone()
                .map(|(i, j)| height[i] - height[j] - margin)
                .fold(f64::INFINITY, f64::min);
            if iteration == 0 {
                least = self.least_gap(gap);
            }
            if gap <= 0.0 || (iteration > 0 && gap <= CLOSE_ENOUGH * least) {
                return t;
            }
            let mut step = f64::INFINITY;
            for (i, j) in pairs {
                let closing = speed[j] - speed[i];
                if closing > 0.0 {
                    let clear = height[i] - height[j] - margin;
                    step = step.min(room(clear, gap, least) / closing);
                }
            }
            t += step;
            if t >= limit {
                return limit;
            }
        }
        t
    }
}

/// Part of the gap that an advance may use up, Li et al. 2021: some is left, so that the next
/// direction is defined.
const ADVANCE: f64 = 0.9;
/// Gap, in units of the one that is to be left, at which advances end.
pub(crate) const CLOSE_ENOUGH: f64 = 1.1;

/// How far an advance may take two points that are `clear` of each other, of primitives whose gap is `gap`
/// and is to stay at least `least`, metres.
pub(crate) fn room(clear: f64, gap: f64, least: f64) -> f64 {
    clear - least.max((1.0 - ADVANCE) * gap)
}

/// Round-off of a gap relative to the largest coordinate: the differences, the products with the
/// direction and the positions that the caller computes, each a few units in the last place.
const ROUND_OFF: f64 = 16.0 * f64::EPSILON;
