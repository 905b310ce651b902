//! Smooth curves through points of space.

use super::error::GenerateError;
use crate::vec3::{Vec3, axpy, norm, sub};

/// A curve through points, cubic between them: its tangent at each point is that of the parabola through the
/// point and its neighbours (Bessel's tangents; de Boor, *A Practical Guide to Splines*, ch. IV). Tangents
/// are exact to second order in the distance of the points.
#[derive(Clone, Debug)]
pub(super) struct SpaceCurve {
    points: Vec<Vec3>,
    tangents: Vec<Vec3>,
    /// The length of the chords up to each point.
    along: Vec<f64>,
    pub(super) is_closed: bool,
}

impl SpaceCurve {
    /// Through at least two points, closed if the last one is the first one and there are four or more.
    pub(super) fn through(name: &'static str, points: &[Vec3]) -> Result<Self, GenerateError> {
        let refused = |point, problem| GenerateError::Curve {
            name,
            point,
            problem,
        };
        if points.len() < 2 {
            return Err(refused(points.len(), "it has fewer than two points"));
        }
        let is_finite = |p: &Vec3| p.iter().all(|c| c.is_finite());
        if let Some(k) = points.iter().position(|p| !is_finite(p)) {
            return Err(refused(k, "a coordinate is not finite"));
        }
        let mut along = vec![0.0];
        for (k, pair) in points.windows(2).enumerate() {
            let length = norm(sub(pair[1], pair[0]));
            // Both the length and its part of the whole have to be numbers.
            if !(length > 0.0 && (along[k] + length).is_finite() && along[k] + length > along[k]) {
                return Err(refused(
                    k + 1,
                    "it is where the one before is, or too far from it",
                ));
            }
            along.push(along[k] + length);
        }
        let is_closed = points.len() > 3 && points.first() == points.last();
        let n = points.len() - 1;
        let slope = |k: usize| {
            let length = along[k + 1] - along[k];
            sub(points[k + 1], points[k]).map(|c| c / length)
        };
        let step = |k: usize| along[k + 1] - along[k];
        // The tangent of a parabola between two chords of the lengths `a` and `b`.
        let between = |[p, q]: [Vec3; 2], [a, b]: [f64; 2]| {
            [0, 1, 2].map(|i| (b * p[i] + a * q[i]) / (a + b))
        };
        let tangent = |k: usize| {
            let inner = |k: usize| between([slope(k - 1), slope(k)], [step(k - 1), step(k)]);
            let ends = |own: usize, other: usize| {
                let inner = inner(own.max(other));
                axpy(inner.map(|c| -c), 2.0, slope(own))
            };
            match k {
                _ if n == 1 => slope(0),
                0 if is_closed => between([slope(n - 1), slope(0)], [step(n - 1), step(0)]),
                k if k == n && is_closed => {
                    between([slope(n - 1), slope(0)], [step(n - 1), step(0)])
                }
                0 => ends(0, 1),
                k if k == n => ends(n - 1, n - 2),
                k => inner(k),
            }
        };
        let tangents = (0..=n).map(tangent).collect();
        Ok(Self {
            points: points.to_vec(),
            tangents,
            along,
            is_closed,
        })
    }

    /// The length of its chords, metres.
    pub(super) fn length(&self) -> f64 {
        self.along[self.along.len() - 1]
    }

    /// Its points from the last one to the first one.
    pub(super) fn reversed(&self) -> Self {
        let length = self.length();
        Self {
            points: self.points.iter().rev().copied().collect(),
            tangents: self.tangents.iter().rev().map(|t| t.map(|c| -c)).collect(),
            along: self.along.iter().rev().map(|l| length - l).collect(),
            is_closed: self.is_closed,
        }
    }

    /// The point and the tangent at a part of its length, from 0 to 1; a closed curve goes on.
    pub(super) fn at(&self, part: f64) -> [Vec3; 2] {
        let part = match self.is_closed {
            true if !(0.0..=1.0).contains(&part) => part.rem_euclid(1.0),
            _ => part.clamp(0.0, 1.0),
        };
        let at = part * self.length();
        let last = self.points.len() - 2;
        let k = self
            .along
            .partition_point(|l| *l <= at)
            .saturating_sub(1)
            .min(last);
        let length = self.along[k + 1] - self.along[k];
        let s = (at - self.along[k]) / length;
        let [p, q] = [self.points[k], self.points[k + 1]];
        let [v, w] = [self.tangents[k], self.tangents[k + 1]].map(|t| t.map(|c| c * length));
        let point = |i: usize| {
            let (d, r) = (q[i] - p[i], 1.0 - s);
            p[i] + s * s * (3.0 - 2.0 * s) * d + s * r * (r * v[i] - s * w[i])
        };
        let slope = |i: usize| {
            let (d, r) = (q[i] - p[i], 1.0 - s);
            (6.0 * s * r * d + r * (1.0 - 3.0 * s) * v[i] + s * (3.0 * s - 2.0) * w[i]) / length
        };
        [[0, 1, 2].map(point), [0, 1, 2].map(slope)]
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::vec3::dot;
    use std::f64::consts::TAU;

    /// Points of a circle: the curve goes through them, and its tangents are across the radius to second
    /// order, also where it closes.
    #[test]
    fn tangents_of_a_circle() {
        for n in [12_u32, 24, 48] {
            let angle = |k: u32| TAU * f64::from(k % n) / f64::from(n);
            let points: Vec<Vec3> = (0..=n)
                .map(|k| [angle(k).cos(), angle(k).sin(), 0.5])
                .collect();
            let curve = SpaceCurve::through("first", &points).unwrap();
            assert!(curve.is_closed);
            let error = (TAU / f64::from(n)).powi(2);
            for k in 0..200 {
                let [p, t] = curve.at(f64::from(k) / 200.0);
                assert!((p[0].hypot(p[1]) - 1.0).abs() < error * error);
                let across = dot(t, [p[0], p[1], 0.0]) / norm(t);
                assert!(across.abs() < error, "{k}: {across}");
                let [q, u] = curve.reversed().at(1.0 - f64::from(k) / 200.0);
                assert!(norm(sub(p, q)) < 1e-12 && norm(axpy(u, 1.0, t)) < 1e-9);
            }
            let half = SpaceCurve::through("first", &points[..=n as usize / 2]).unwrap();
            let [_, t] = half.at(0.0);
            assert!((t[0] / norm(t)).abs() < error);
        }
    }

    #[test]
    fn bad_points_are_named() {
        let refused = |points: &[Vec3]| match SpaceCurve::through("first", points).unwrap_err() {
            GenerateError::Curve { point, .. } => point,
            error => panic!("{error}"),
        };
        assert_eq!(refused(&[[0.0; 3]]), 1);
        assert_eq!(refused(&[[0.0; 3], [1.0; 3], [1.0; 3]]), 2);
        assert_eq!(refused(&[[0.0; 3], [f64::NAN, 0.0, 0.0]]), 1);
        assert_eq!(refused(&[[0.0; 3], [1e200, 0.0, 0.0]]), 1);
    }
}
