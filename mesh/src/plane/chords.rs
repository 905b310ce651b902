//! Chords of curves, and which of them come near to each other.

use super::curve::PlaneCurve;
use super::error::PlaneError;
use super::near;
use super::vec2::{Point, between, cross, distance, foot, sub};

/// A part of a curve between two of its points.
#[derive(Clone, Copy, Debug)]
pub(super) struct Chord {
    /// The number of the curve.
    pub(super) curve: usize,
    /// Its parameters at both ends.
    pub(super) range: [f64; 2],
    /// The ends.
    pub(super) ends: [Point; 2],
    /// The third corner of a triangle that contains the part: where the tangents at its ends meet, about.
    pub(super) apex: Point,
}

impl Chord {
    pub(super) fn of(curve: &PlaneCurve, number: usize, range: [f64; 2]) -> Self {
        let ends = range.map(|t| curve.point(t));
        Self::with_ends(curve, number, range, ends)
    }

    /// The chord between two ends that are known, and may have been moved a little.
    pub(super) fn with_ends(
        curve: &PlaneCurve,
        number: usize,
        range: [f64; 2],
        ends: [Point; 2],
    ) -> Self {
        let middle = between(ends[0], ends[1], 0.5);
        let apex = match curve {
            PlaneCurve::Line(_) => middle,
            _ => between(middle, curve.point(0.5 * (range[0] + range[1])), 2.0),
        };
        Self {
            curve: number,
            range,
            ends,
            apex,
        }
    }

    /// How far the curve is away from the chord, about.
    pub(super) fn height(&self) -> f64 {
        0.5 * distance(self.apex, between(self.ends[0], self.ends[1], 0.5))
    }

    fn corners(&self) -> [Point; 3] {
        [self.ends[0], self.ends[1], self.apex]
    }

    /// The distance of a point from the chord.
    pub(super) fn distance(&self, p: Point) -> f64 {
        let [a, b] = self.ends;
        distance(p, between(a, b, foot(p, self.ends)))
    }

    /// Where two chords cross, as parts of the way along each.
    pub(super) fn crossing(&self, other: &Self) -> Option<[f64; 2]> {
        let ([a, b], [c, d]) = (self.ends, other.ends);
        let (u, v, w) = (sub(b, a), sub(d, c), sub(c, a));
        let turn = cross(u, v);
        let parts = [cross(w, v) / turn, cross(w, u) / turn];
        let inside = |part: &f64| (-1e-9..=1.0 + 1e-9).contains(part);
        parts.iter().all(inside).then_some(parts)
    }

    /// Whether the triangles around two parts of curves have points in common besides common ends, so that
    /// chords cross where the curves do not.
    pub(super) fn overlaps(&self, other: &Self) -> bool {
        let shared = |p: &Point| other.ends.contains(p);
        match self.ends.iter().filter(|p| shared(p)).count() {
            2 => true,
            1 => self.contains_a_corner_of(other) || other.contains_a_corner_of(self),
            _ => {
                let sides = |c: &Self| {
                    let [a, b, apex] = c.corners();
                    [[a, b], [b, apex], [apex, a]].map(|ends| Self { ends, ..*c })
                };
                let crossing = |s: &Self| sides(other).iter().any(|t| s.crossing(t).is_some());
                sides(self).iter().any(crossing)
                    || self.contains_a_corner_of(other)
                    || other.contains_a_corner_of(self)
            }
        }
    }

    /// Whether a corner of another one lies inside of the triangle, and not on its sides.
    fn contains_a_corner_of(&self, other: &Self) -> bool {
        let [a, b, c] = self.corners();
        let area = cross(sub(b, a), sub(c, a));
        let inside = |p: Point| {
            let parts = [[a, b], [b, c], [c, a]].map(|[q, r]| cross(sub(q, p), sub(r, p)) / area);
            parts.iter().all(|part| *part > 1e-6)
        };
        other.corners().into_iter().any(inside)
    }
}

/// Calls `visit` for all pairs of chords that are at most `reach` apart, with their bends.
///
/// # Errors
/// [`PlaneError::TooManyMeetings`]
pub(super) fn near_pairs(
    chords: &[Chord],
    reach: f64,
    visit: impl FnMut(usize, usize),
) -> Result<(), PlaneError> {
    let corners: Vec<[Point; 3]> = chords.iter().map(Chord::corners).collect();
    near::near_pairs(&corners, reach, visit)
}
