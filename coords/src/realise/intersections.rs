//! The intersection conditions of a realisation: edges meet in common ends alone.

use super::FrontMap;
use super::error::RealiseError;
use super::{RealiseReport, Vec3, at, dot, norm, sub};
use crate::vec3::axpy;
use isosheet_mesh::{EdgeId, VertexId};

impl FrontMap {
    /// As [`FrontMap::realise`], and checks the two conditions that the paper's definition of a realisation
    /// has besides: two edges meet, if at all, in a common end, and no vertex lies on an edge of which it is
    /// no end. (Edges of a sheet in space rarely meet, even where its faces pass through each other, which
    /// `isosheet_geometry::crossings` finds.) Edges meet where they come closer than the [closure
    /// tolerance](super::RealiseOptions::closure_tolerance) times the longer one of them. Every pair is
    /// looked at: the time grows as the square of the number of edges.
    ///
    /// # Errors
    /// Errors of [`FrontMap::realise`], and [`RealiseError::EdgesMeet`] naming the first pair that meets.
    pub fn realise_checked(
        &self,
        q: &[f64],
        near: &[f64],
        x: &mut [f64],
    ) -> Result<RealiseReport, RealiseError> {
        let report = self.realise(q, near, x)?;
        match edges_that_meet(&self.ends, x, self.options.closure_tolerance) {
            None => Ok(report),
            Some((edges, distance)) => Err(RealiseError::EdgesMeet { edges, distance }),
        }
    }
}

/// The first two edges that come closer than `tolerance` times the longer of them, elsewhere than in a common
/// end, and how close they come, metres.
fn edges_that_meet(
    edges: &[[VertexId; 2]],
    x: &[f64],
    tolerance: f64,
) -> Option<([EdgeId; 2], f64)> {
    let segment = |[a, b]: [VertexId; 2]| [at(x, a), at(x, b)];
    let length = |[p, q]: &Segment| norm(&sub(q, p));
    for (i, &first) in edges.iter().enumerate() {
        for (j, &second) in edges.iter().enumerate().skip(i + 1) {
            let [s, t] = [first, second].map(segment);
            let longer = length(&s).max(length(&t));
            let distance = match first.iter().find(|v| second.contains(v)) {
                None => distance(&s, &t),
                // Beyond the common end the shorter edge begins to lie on the longer one.
                Some(&common) => {
                    let (short, long) = if length(&s) < length(&t) {
                        (first, t)
                    } else {
                        (second, s)
                    };
                    let end = short.into_iter().find(|v| *v != common)?;
                    distance_from_point(&at(x, end), &long)
                }
            };
            if distance <= tolerance * longer {
                return Some(([i, j].map(|e| EdgeId(e as u32)), distance));
            }
        }
    }
    None
}

type Segment = [Vec3<f64>; 2];

/// The distance of two segments: that of their lines if both of its feet are inside, else that of an end from
/// the other segment.
fn distance(s: &Segment, t: &Segment) -> f64 {
    let (u, v, w) = (sub(&s[1], &s[0]), sub(&t[1], &t[0]), sub(&s[0], &t[0]));
    let (uu, uv, vv, uw, vw) = (
        dot(&u, &u),
        dot(&u, &v),
        dot(&v, &v),
        dot(&u, &w),
        dot(&v, &w),
    );
    let determinant = uu * vv - uv * uv;
    let [a, b] = [uv * vw - vv * uw, uu * vw - uv * uw];
    let is_inside = |foot: f64| 0.0 < foot && foot < determinant;
    if is_inside(a) && is_inside(b) {
        let between = axpy(&axpy(&w, a / determinant, &u), -b / determinant, &v);
        return norm(&between);
    }
    let ends = s.iter().map(|p| distance_from_point(p, t));
    ends.chain(t.iter().map(|p| distance_from_point(p, s)))
        .fold(f64::INFINITY, f64::min)
}

fn distance_from_point(p: &Vec3<f64>, [a, b]: &Segment) -> f64 {
    let (along, to) = (sub(b, a), sub(p, a));
    let part = (dot(&to, &along) / dot(&along, &along)).clamp(0.0, 1.0);
    norm(&axpy(&to, -part, &along))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::testing::isotropic_square;
    use proptest::prelude::*;

    /// Mirrors the half of a square beyond `x = middle` onto the other half.
    fn folded(x: &[f64], middle: f64) -> Vec<f64> {
        let mut y = x.to_vec();
        for p in y.as_chunks_mut::<3>().0 {
            p[0] = middle - (p[0] - middle).abs();
        }
        y
    }

    #[test]
    fn flat_and_folded_squares() {
        let sheet = isotropic_square(1, 1.0);
        let (edges, x) = (sheet.topology().edges(), sheet.positions());
        assert_eq!(edges_that_meet(edges, x, 1e-9), None);
        let y = folded(x, 0.5);
        let ([e, f], distance) = edges_that_meet(edges, &y, 1e-9).expect("halves on each other");
        assert!(e != f && distance == 0.0);
        // Half open, the halves meet in the fold alone.
        let mut opened = y.clone();
        for (p, q) in opened
            .as_chunks_mut::<3>()
            .0
            .iter_mut()
            .zip(x.as_chunks::<3>().0)
        {
            if q[0] > 0.5 {
                *p = [0.5, p[1], 0.5 - p[0]];
            }
        }
        assert_eq!(edges_that_meet(edges, &opened, 1e-9), None);
    }

    proptest! {
        #![proptest_config(isosheet_random::cases(256))]

        /// The distance is the least distance of points on a fine grid of the two segments, within its
        /// spacing.
        #[test]
        fn distances_of_segments(c in prop::collection::vec(-1.0..1.0f64, 12)) {
            let p = |i: usize| [c[i], c[i + 1], c[i + 2]];
            let (s, t) = ([p(0), p(3)], [p(6), p(9)]);
            let n = 60;
            let on = |[a, b]: &Segment, k: usize| axpy(a, k as f64 / n as f64, &sub(b, a));
            let mut least = f64::INFINITY;
            for i in 0..=n {
                for j in 0..=n {
                    least = least.min(norm(&sub(&on(&s, i), &on(&t, j))));
                }
            }
            let spacing = (norm(&sub(&s[1], &s[0])) + norm(&sub(&t[1], &t[0]))) / (2 * n) as f64;
            let found = distance(&s, &t);
            prop_assert!(found <= least + 1e-12 && least <= found + spacing, "{found} {least}");
        }
    }
}
