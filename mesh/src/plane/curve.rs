//! Curves in the plane.

use super::vec2::{Point, between, cross, distance, dot, foot, sub};
use std::f64::consts::TAU;

/// A curve in the plane, metres, with a parameter from 0 to 1.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum PlaneCurve {
    /// The straight line from one point to the other.
    Line([[f64; 2]; 2]),
    /// A part of an ellipse.
    Arc(EllipticArc),
    /// A cubic Bezier curve by its control points.
    Cubic([[f64; 2]; 4]),
}

/// A part of an ellipse: the points `centre + cos(a) axes[0] + sin(a) axes[1]`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct EllipticArc {
    /// The centre, metres.
    pub centre: [f64; 2],
    /// Two conjugate half-axes, metres; for a circle orthogonal and as long as its radius.
    pub axes: [[f64; 2]; 2],
    /// The values of `a` at both ends, radians.
    pub angles: [f64; 2],
}

impl EllipticArc {
    /// A part of a circle; a whole one where the angles (radians) differ by a turn.
    pub fn circular(centre: [f64; 2], radius: f64, angles: [f64; 2]) -> Self {
        Self {
            centre,
            axes: [[radius, 0.0], [0.0, radius]],
            angles,
        }
    }

    /// A whole circle.
    pub fn circle(centre: [f64; 2], radius: f64) -> Self {
        Self::circular(centre, radius, [0.0, TAU])
    }
}

/// As many samples of a curve measure its length and its turning.
const SAMPLES: usize = 96;

/// A curve that turns by more than this between two samples, radians, has a corner there.
const CUSP: f64 = 0.5;

impl PlaneCurve {
    /// The point at the parameter `t`.
    pub fn point(&self, t: f64) -> [f64; 2] {
        match self {
            Self::Line([p, q]) => between(*p, *q, t),
            Self::Arc(arc) => {
                let angle = (1.0 - t) * arc.angles[0] + t * arc.angles[1];
                let (sin, cos) = angle.sin_cos();
                let [u, v] = arc.axes;
                [0, 1].map(|k| arc.centre[k] + cos * u[k] + sin * v[k])
            }
            Self::Cubic(p) => {
                let s = 1.0 - t;
                let weights = [s * s * s, 3.0 * s * s * t, 3.0 * s * t * t, t * t * t];
                [0, 1].map(|k| weights.iter().zip(p).map(|(w, p)| w * p[k]).sum())
            }
        }
    }

    /// The derivative of [`point`](Self::point).
    pub fn derivative(&self, t: f64) -> [f64; 2] {
        match self {
            Self::Line([p, q]) => sub(*q, *p),
            Self::Arc(arc) => {
                let [from, to] = arc.angles;
                let (sin, cos) = ((1.0 - t) * from + t * to).sin_cos();
                let [u, v] = arc.axes;
                [0, 1].map(|k| (to - from) * (cos * v[k] - sin * u[k]))
            }
            Self::Cubic(p) => {
                let s = 1.0 - t;
                let weights = [s * s, 2.0 * s * t, t * t];
                [0, 1].map(|k| {
                    let sides = p.windows(2).map(|q| q[1][k] - q[0][k]);
                    3.0 * weights.iter().zip(sides).map(|(w, d)| w * d).sum::<f64>()
                })
            }
        }
    }

    /// Its first and last point.
    pub fn ends(&self) -> [[f64; 2]; 2] {
        [self.point(0.0), self.point(1.0)]
    }

    /// Whether all its numbers are finite.
    pub fn is_finite(&self) -> bool {
        let finite = |points: &[[f64; 2]]| points.as_flattened().iter().all(|c| c.is_finite());
        match self {
            Self::Line(points) => finite(points),
            Self::Arc(arc) => finite(&[arc.centre, arc.axes[0], arc.axes[1], arc.angles]),
            Self::Cubic(points) => finite(points),
        }
    }

    /// The curve after the affine map `p -> matrix[0] p[0] + matrix[1] p[1] + matrix[2]`.
    #[must_use]
    pub fn transformed(&self, matrix: [[f64; 2]; 3]) -> Self {
        let linear = |p: Point| [0, 1].map(|k| matrix[0][k] * p[0] + matrix[1][k] * p[1]);
        let affine = |p: Point| {
            let q = linear(p);
            [0, 1].map(|k| q[k] + matrix[2][k])
        };
        match self {
            Self::Line(points) => Self::Line(points.map(affine)),
            Self::Arc(arc) => Self::Arc(EllipticArc {
                centre: affine(arc.centre),
                axes: arc.axes.map(linear),
                angles: arc.angles,
            }),
            Self::Cubic(points) => Self::Cubic(points.map(affine)),
        }
    }

    /// Parameters from `range[0]` to `range[1]`, both included, between which chords are at most `longest`
    /// long, turn by at most `turn` radians, and are about equally long where the curve is equally bent.
    pub fn subdivide(&self, range: [f64; 2], longest: f64, turn: f64) -> Vec<f64> {
        let at = |k: usize, n: usize| {
            let w = k as f64 / n as f64;
            (1.0 - w) * range[0] + w * range[1]
        };
        let samples = match self {
            Self::Line(_) => 1,
            _ => SAMPLES,
        };
        // How many chords the curve needs up to each sample.
        let mut needed = vec![0.0];
        let mut last = (self.point(range[0]), self.derivative(range[0]));
        for k in 1..=samples {
            let t = at(k, samples);
            let next = (self.point(t), self.derivative(t));
            let length = distance(last.0, next.0) / longest;
            // A cusp turns at one point, where chords end in any case.
            let bend = match cross(last.1, next.1).atan2(dot(last.1, next.1)).abs() {
                bend if bend < CUSP => bend / turn,
                _ => 1.0,
            };
            needed.push(needed[k - 1] + length.max(bend));
            last = next;
        }
        let total = needed[samples];
        // Round-off makes no further chord.
        let count = (total - 1e-9).ceil().clamp(1.0, 1e9) as usize;
        let mut parameters = vec![range[0]];
        let mut k = 0;
        for part in 1..count {
            let wanted = total * part as f64 / count as f64;
            while needed[k + 1] < wanted {
                k += 1;
            }
            let w = (wanted - needed[k]) / (needed[k + 1] - needed[k]);
            let [a, b] = [at(k, samples), at(k + 1, samples)];
            parameters.push((1.0 - w) * a + w * b);
        }
        parameters.push(range[1]);
        parameters
    }

    /// The parameter of the point that is nearest to `p`.
    pub fn nearest(&self, p: [f64; 2]) -> f64 {
        if let Self::Line(ends) = self {
            return foot(p, *ends);
        }
        let at = |k: usize| k as f64 / SAMPLES as f64;
        let nearness = |t: f64| distance(self.point(t), p);
        let best = (0..=SAMPLES).min_by(|&i, &j| nearness(at(i)).total_cmp(&nearness(at(j))));
        let best = best.unwrap_or(0);
        // Between the neighbours of the nearest sample the derivative of the distance changes its sign.
        let slope = |t: f64| dot(sub(self.point(t), p), self.derivative(t));
        let [mut low, mut high] = [at(best.saturating_sub(1)), at((best + 1).min(SAMPLES))];
        if slope(low) >= 0.0 {
            return low;
        }
        if slope(high) <= 0.0 {
            return high;
        }
        for _ in 0..60 {
            let middle = 0.5 * (low + high);
            match slope(middle) < 0.0 {
                true => low = middle,
                false => high = middle,
            }
        }
        0.5 * (low + high)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::f64::consts::PI;

    #[test]
    fn chords_of_a_circle_are_equal_and_turn_no_more_than_allowed() {
        let circle = PlaneCurve::Arc(EllipticArc::circle([1.0, 2.0], 0.5));
        for (longest, turn, count) in [(1e9, PI / 6.0, 12), (0.1, PI / 6.0, 32)] {
            let t = circle.subdivide([0.0, 1.0], longest, turn);
            assert_eq!(t.len(), count + 1, "{longest}");
            for pair in t.windows(2) {
                assert!((pair[1] - pair[0] - 1.0 / count as f64).abs() < 1e-3);
                let length = distance(circle.point(pair[0]), circle.point(pair[1]));
                assert!(length <= longest * 1.001);
            }
        }
    }

    #[test]
    fn nearest_points_and_derivatives() {
        let curves = [
            PlaneCurve::Line([[0.0, 0.0], [1.0, 2.0]]),
            PlaneCurve::Arc(EllipticArc::circular([0.2, 0.1], 0.7, [0.3, 2.0])),
            PlaneCurve::Cubic([[0.0, 0.0], [0.5, 1.0], [1.0, -1.0], [2.0, 0.3]]),
        ];
        for curve in curves {
            for k in 1..10 {
                let t = 0.1 * f64::from(k);
                let (p, d) = (curve.point(t), curve.derivative(t));
                assert!((curve.nearest(p) - t).abs() < 1e-7, "{curve:?} {t}");
                let h = 1e-6;
                let secant = sub(curve.point(t + h), curve.point(t - h));
                assert!((0..2).all(|k| (secant[k] / (2.0 * h) - d[k]).abs() < 1e-8));
            }
        }
    }

    /// An ellipse whose half-axes are mapped is the ellipse of the mapped points.
    #[test]
    fn affine_maps_act_on_the_points() {
        let curves = [
            PlaneCurve::Arc(EllipticArc::circle([0.2, 0.1], 0.7)),
            PlaneCurve::Cubic([[0.0, 0.0], [0.5, 1.0], [1.0, -1.0], [2.0, 0.3]]),
        ];
        let matrix = [[2.0, 0.5], [-1.0, 0.3], [0.1, 4.0]];
        for curve in curves {
            let mapped = curve.transformed(matrix);
            for t in [0.0, 0.3, 1.0] {
                let [x, y] = curve.point(t);
                let q = mapped.point(t);
                let expected = [0, 1].map(|k| matrix[0][k] * x + matrix[1][k] * y + matrix[2][k]);
                assert!((0..2).all(|k| (q[k] - expected[k]).abs() < 1e-14));
            }
        }
    }
}
