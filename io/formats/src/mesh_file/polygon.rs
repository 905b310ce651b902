//! Cutting polygons into triangles.

use super::plane::{NEAR, meet, twice_area};
use isosheet_mesh::vec3::{axpy, cross, dot, sub, unit};
use std::collections::{BTreeMap, BTreeSet};

type Point = [f64; 3];

/// Part of the shortest cut by which a cut may be longer and count as equal: above the round-off of
/// coordinates of seven digits. A panel has the same cuts in every position then, flat and folded.
const EQUAL_CUTS: f64 = 1e-6;

/// Height of a triangle beside its longest side below which others are cut off first, which points of a curve
/// that hardly bends leave: slopes across such a triangle are so much greater than lengths along it, and the
/// numbers of a matrix differ by the square, a million.
const SLIVER: f64 = 1e-3;

/// More corners of a polygon are refused: cutting takes up to the third power of their number, a second for
/// so many.
pub(super) const MOST_CORNERS: usize = 1000;

/// A polygon in triangles.
pub(super) struct Pieces {
    pub(super) triangles: Vec<[u32; 3]>,
    /// The cuts between them, one fewer.
    pub(super) cuts: Vec<[u32; 2]>,
}

/// Cuts a polygon into triangles that are turned like the polygon as a whole; `None` if its outline crosses
/// or touches itself, seen along its normal, or has no area. It may come to a corner more than once, as that
/// of a face does into which another one reaches from a corner, and run along a line to a hole in both
/// directions.
///
/// Corner after corner is cut off, always by the shortest cut that is inside and leaves no sliver, if there
/// is one: a quad is cut along its shorter diagonal if both will do. Of equal cuts that with the smallest
/// vertex number is made. A Delaunay triangulation would leave it to round-off how the corners of a rectangle
/// are joined.
pub(super) fn triangulate(corners: &[u32], at: impl Fn(u32) -> Point) -> Option<Pieces> {
    let (places, near) = outline(corners, at)?;
    let mut pieces = Pieces {
        triangles: Vec::with_capacity(corners.len() - 2),
        cuts: Vec::with_capacity(corners.len() - 3),
    };
    let mut left: Vec<usize> = (0..corners.len()).collect();
    while left.len() > 3 {
        let k = next_ear(&left, corners, &places, near)?;
        let [a, b, c] = around(&left, k).map(|k| corners[k]);
        pieces.triangles.push([a, b, c]);
        pieces.cuts.push([a, c]);
        left.remove(k);
        // The last triangle begins where the last cut begins.
        let first = left.iter().position(|&k| corners[k] == a).unwrap_or(0);
        left.rotate_left(first);
    }
    let last = around(&left, 1);
    let is_left = height(last, &places) > 0.0;
    pieces.triangles.push(last.map(|k| corners[k]));
    is_left.then_some(pieces)
}

/// The places of the corners of a polygon in its plane, and the distance within which they are the same;
/// `None` if its outline crosses or touches itself, or has no extent.
pub(super) fn outline(corners: &[u32], at: impl Fn(u32) -> Point) -> Option<(Vec<Point>, f64)> {
    let places = in_plane(&corners.iter().map(|&c| at(c)).collect::<Vec<_>>());
    let near = NEAR * extent(&places);
    is_simple(corners, &places, near).then_some((places, near))
}

/// The place in `left` of the corner that is cut off next.
fn next_ear(left: &[usize], corners: &[u32], places: &[Point], near: f64) -> Option<usize> {
    // No corner that bulges outwards is in the way of another one without one that does not.
    let inward = (0..left.len()).filter(|&k| height(around(left, k), places) <= near);
    let inward: Vec<usize> = inward.map(|k| left[k]).collect();
    let is_ear = |&k: &usize| {
        let ear = around(left, k);
        // Where the outline comes to a corner again it is beside the ear.
        let is_corner = |p: usize| ear.iter().any(|&k| corners[k] == corners[p]);
        let is_free =
            |p: &usize| is_corner(*p) || is_outside(places[*p], ear.map(|k| places[k]), near);
        height(ear, places) > near && inward.iter().all(is_free)
    };
    let length = |k: usize| {
        let [a, _, c] = around(left, k).map(|k| places[k]);
        (a[0] - c[0]).hypot(a[1] - c[1])
    };
    let leaves_sliver = |k: usize| {
        // Of a quad, the other half.
        let other = (left.len() == 4).then(|| around(left, (k + 2) % 4));
        is_sliver(around(left, k), places) || other.is_some_and(|t| is_sliver(t, places))
    };
    let ears: Vec<(usize, f64)> = (0..left.len())
        .filter(is_ear)
        .map(|k| (k, length(k)))
        .collect();
    let (good, slivers): (Vec<_>, Vec<_>) = ears.into_iter().partition(|ear| !leaves_sliver(ear.0));
    let ears = if good.is_empty() { slivers } else { good };
    let shortest = ears.iter().map(|ear| ear.1).min_by(f64::total_cmp)?;
    let equal = ears
        .iter()
        .filter(|ear| ear.1 <= (1.0 + EQUAL_CUTS) * shortest);
    let by_number = |&k: &usize| {
        let [a, _, c] = around(left, k).map(|k| corners[k]);
        (a.min(c), a.max(c), a > c)
    };
    equal.map(|ear| ear.0).min_by_key(by_number)
}

/// A corner between its neighbours.
fn around(left: &[usize], k: usize) -> [usize; 3] {
    let n = left.len();
    [left[(k + n - 1) % n], left[k], left[(k + 1) % n]]
}

/// The height of a corner outside of the line between its neighbours.
fn height(corner: [usize; 3], places: &[Point]) -> f64 {
    let [a, b, c] = corner.map(|k| places[k]);
    twice_area([a, b, c].iter()) / (a[0] - c[0]).hypot(a[1] - c[1])
}

/// Whether a triangle is a sliver.
fn is_sliver(corners: [usize; 3], places: &[Point]) -> bool {
    let corners = corners.map(|k| places[k]);
    let [a, b, c] = corners;
    let squared = |[a, b]: [Point; 2]| (a[0] - b[0]).powi(2) + (a[1] - b[1]).powi(2);
    let longest = [[a, b], [b, c], [c, a]]
        .map(squared)
        .into_iter()
        .fold(0.0, f64::max);
    twice_area(corners.iter()) <= SLIVER * longest
}

/// Whether a point is farther than `near` from a counter-clockwise triangle.
fn is_outside(p: Point, [a, b, c]: [Point; 3], near: f64) -> bool {
    let sides = [[a, b], [b, c], [c, a]];
    sides
        .iter()
        .any(|&[a, b]| twice_area([a, b, p].iter()) < -near * (a[0] - b[0]).hypot(a[1] - b[1]))
}

/// Whether an outline neither crosses itself nor touches itself elsewhere than at corners.
fn is_simple(corners: &[u32], places: &[Point], near: f64) -> bool {
    let n = corners.len();
    let mut first = BTreeMap::new();
    let mut numbers = Vec::with_capacity(n);
    for (k, corner) in (0..).zip(corners) {
        numbers.push(*first.entry(corner).or_insert(k));
    }
    let side = |k: usize| [numbers[k], numbers[(k + 1) % n]];
    let sides: BTreeSet<[u32; 2]> = (0..n).map(side).collect();
    // A line to a hole is run along in both directions; one that leads nowhere is followed by itself.
    let turns_back = |k: usize| numbers[k] == numbers[(k + 2) % n];
    let meets = |i: usize| (i + 1..n).any(|j| meet(side(i), side(j), places, near));
    let goes_on = |k: usize| side(k)[0] != side(k)[1] && !turns_back(k);
    near > 0.0 && sides.len() == n && (0..n).all(goes_on) && !(0..n).any(meets)
}

/// The places of corners in the plane of a polygon, counter-clockwise.
fn in_plane(points: &[Point]) -> Vec<Point> {
    // Newell: the sum of the cross products about any point is twice the polygon's area vector.
    let area = points.windows(2).fold([0.0; 3], |sum, p| {
        axpy(sum, 1.0, cross(sub(p[0], points[0]), sub(p[1], points[0])))
    });
    let normal = unit(area);
    // The axis that is farthest from the normal, turned into the plane, so that coordinates in the plane of
    // two axes stay as they are.
    let axis = match normal.map(f64::abs) {
        [x, y, z] if z >= x && z >= y => [1.0, 0.0, 0.0],
        [x, y, _] if y >= x => [0.0, 0.0, 1.0],
        _ => [0.0, 1.0, 0.0],
    };
    let along = dot(axis, normal);
    let first = unit(sub(axis, normal.map(|c| along * c)));
    let second = cross(normal, first);
    let place = |p: &Point| {
        let from = sub(*p, points[0]);
        [dot(from, first), dot(from, second), 0.0]
    };
    points.iter().map(place).collect()
}

/// The largest extent along an axis.
fn extent(places: &[Point]) -> f64 {
    let along = |k: usize| {
        let values = places.iter().map(|p| p[k]);
        values.clone().fold(f64::NEG_INFINITY, f64::max) - values.fold(f64::INFINITY, f64::min)
    };
    along(0).max(along(1))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn cut(points: &[Point]) -> Option<Vec<[u32; 3]>> {
        let corners: Vec<u32> = (0..points.len() as u32).collect();
        Some(triangulate(&corners, |c| points[c as usize])?.triangles)
    }

    #[test]
    fn quads_take_the_shorter_diagonal_that_stays_inside() {
        let kite = [
            [0.0, 0.0, 0.0],
            [1.0, -0.2, 0.0],
            [2.0, 0.0, 0.0],
            [1.0, 0.2, 0.0],
        ];
        assert_eq!(cut(&kite).unwrap(), [[1, 2, 3], [1, 3, 0]]);
        // An arrowhead: the reflex corner 1 sees all others, the shorter diagonal 0-2 runs outside.
        let arrow = [
            [0.0, 0.0, 0.0],
            [1.0, 2.0, 0.0],
            [2.0, 0.0, 0.0],
            [1.0, 5.0, 0.0],
        ];
        let triangles = cut(&arrow).unwrap();
        assert!(triangles.iter().all(|t| t.contains(&1) && t.contains(&3)));
    }

    /// A strip between two curves that bend outwards by a ten thousandth of their length: all triangles reach
    /// from one to the other.
    #[test]
    fn curves_that_hardly_bend_leave_no_slivers() {
        let bend = |x: f64| 1e-4 * x * (10.0 - x);
        let lower = (0..=10).map(f64::from).map(|x| [x, -bend(x), 0.0]);
        let upper = (0..=10)
            .rev()
            .map(f64::from)
            .map(|x| [x, 1.0 + bend(x), 0.0]);
        let points: Vec<Point> = lower.chain(upper).collect();
        let triangles = cut(&points).unwrap();
        assert_eq!(triangles.len(), 20);
        for t in &triangles {
            let places = t.map(|c| points[c as usize]);
            assert!(twice_area(places.iter()) > 0.9, "{t:?}");
        }
    }

    /// A strip with a corner inside of its short side, but for a hundred thousandth: the last two triangles
    /// are none of them flat.
    #[test]
    fn the_last_triangle_is_no_sliver() {
        let points = [
            [0.0, 0.0, 0.0],
            [1.0, 0.0, 0.0],
            [1.0, 0.02, 0.0],
            [0.0, 0.02, 0.0],
            [1e-5, 0.005, 0.0],
        ];
        let triangles = cut(&points).unwrap();
        let areas = triangles.iter().map(|t| {
            let places = t.map(|c| points[c as usize]);
            twice_area(places.iter())
        });
        assert!(areas.clone().all(|area| area > 4e-3), "{triangles:?}");
    }

    /// A square from whose corner 0 a square hole reaches inwards: the outline comes to the corner twice.
    #[test]
    fn an_outline_may_come_to_a_corner_again() {
        let points = [
            [0.0, 0.0, 0.0],
            [3.0, 0.0, 0.0],
            [3.0, 3.0, 0.0],
            [0.0, 3.0, 0.0],
            [1.0, 2.0, 0.0],
            [2.0, 2.0, 0.0],
            [2.0, 1.0, 0.0],
            [1.0, 1.0, 0.0],
        ];
        let cut = |corners: &[u32]| triangulate(corners, |c| points[c as usize]);
        let found = cut(&[0, 1, 2, 3, 0, 4, 5, 6]).unwrap().triangles;
        let area = |t: &[u32; 3]| 0.5 * twice_area(t.map(|c| points[c as usize]).iter());
        assert!(found.iter().all(|t| area(t) > 0.0), "{found:?}");
        let sum: f64 = found.iter().map(area).sum();
        // The hole is a kite with the diagonals 2^1/2 and 2 2^1/2.
        assert!((sum - 7.0).abs() < 1e-12, "{sum}");
        assert_eq!(found.len(), 6);
        // A line to a square hole is run along in both directions, and a slit is no hole.
        let found = cut(&[0, 1, 2, 3, 0, 7, 4, 5, 6, 7]).unwrap().triangles;
        let sum: f64 = found.iter().map(area).sum();
        assert!(found.iter().all(|t| area(t) > 0.0), "{found:?}");
        assert!((sum - 8.0).abs() < 1e-12, "{sum}");
        assert!(cut(&[0, 1, 2, 3, 0, 5]).is_none());
    }

    /// Both diagonals of a rectangle have the same length up to round-off, which depends on its position.
    #[test]
    fn rectangles_are_cut_alike_in_every_position() {
        let corners = [7, 3, 9, 5];
        let expected = [[3, 9, 5], [3, 5, 7]];
        for k in 0..40 {
            let (s, c) = (0.157 * f64::from(k)).sin_cos();
            let turned = |x: f64, y: f64| [0.3 * k as f64 + x, c * y, s * y];
            let points = [(0.0, 0.0), (0.1, 0.0), (0.1, 0.3), (0.0, 0.3)];
            // As a file of seven digits has them.
            let points = points.map(|(x, y)| turned(x, y).map(|p| (1e7 * p).round() / 1e7));
            let at = |c: u32| points[corners.iter().position(|&d| d == c).unwrap()];
            assert_eq!(
                triangulate(&corners, at).unwrap().triangles,
                expected,
                "position {k}"
            );
            let reversed = [5, 9, 3, 7];
            let cuts = triangulate(&reversed, at).unwrap().triangles;
            assert!(
                cuts.iter().all(|t| t.contains(&3) && t.contains(&5)),
                "{cuts:?}"
            );
        }
    }

    /// Twice the area vector of triangles.
    fn area(points: &[Point], triangles: &[[u32; 3]]) -> Point {
        let areas = triangles.iter().map(|t| {
            let [a, b, c] = t.map(|k| points[k as usize]);
            cross(sub(b, a), sub(c, a))
        });
        areas.fold([0.0; 3], |sum, a| axpy(sum, 1.0, a))
    }

    /// Outlines of which no corner sees all others, with their areas.
    #[test]
    fn concave_polygons_are_cut() {
        let comb = [
            [0.0, 0.0],
            [6.0, 0.0],
            [6.0, 3.0],
            [5.0, 3.0],
            [5.0, 1.0],
            [3.5, 1.0],
            [3.5, 3.0],
            [2.5, 3.0],
            [2.5, 1.0],
            [1.0, 1.0],
            [1.0, 3.0],
            [0.0, 3.0],
        ];
        // The bar of 6 by 1, and three teeth of 1 by 2.
        let comb_area = 6.0 + 3.0 * 2.0;
        let spiral: Vec<[f64; 2]> = {
            let round = |k: usize, r: f64| {
                let a = 0.5 * k as f64;
                [(r + 0.1 * a) * a.cos(), (r + 0.1 * a) * a.sin()]
            };
            let (inner, outer) = (
                (0..30).map(|k| round(k, 1.0)),
                (0..30).map(|k| round(k, 1.3)),
            );
            outer.chain(inner.rev()).collect()
        };
        let shoelace = |outline: &[[f64; 2]]| {
            let next = outline.iter().cycle().skip(1);
            let sum: f64 = outline
                .iter()
                .zip(next)
                .map(|(p, q)| p[0] * q[1] - p[1] * q[0])
                .sum();
            0.5 * sum
        };
        assert_eq!(shoelace(&comb), comb_area);
        for outline in [&comb[..], &spiral] {
            let mut first = None;
            for k in 0..20 {
                // Turned about two axes, in seven digits, and bent a little out of its plane.
                let (s, c) = (0.3 * f64::from(k)).sin_cos();
                let points: Vec<Point> = outline
                    .iter()
                    .map(|&[x, y]| {
                        let (u, v, w) = (c * x - s * y, s * x + c * y, 1e-4 * x * y);
                        let turned = [u, 0.6 * v - 0.8 * w, 0.8 * v + 0.6 * w];
                        turned.map(|p| (1e6 * p).round() / 1e6)
                    })
                    .collect();
                let triangles = cut(&points).unwrap();
                assert_eq!(triangles.len(), outline.len() - 2);
                let expected = shoelace(outline);
                let sides = outline.len() as u32;
                let found = 0.5 * dot(area(&points, &triangles), [0.0, -0.8, 0.6]);
                assert!((found - expected).abs() < 1e-4, "{found} {expected}");
                // Every side is one of a triangle, in its direction.
                for k in 0..sides {
                    let side = [k, (k + 1) % sides];
                    let has = |t: &[u32; 3]| (0..3).any(|i| [t[i], t[(i + 1) % 3]] == side);
                    assert_eq!(triangles.iter().filter(|t| has(t)).count(), 1);
                }
                // The same cuts in every position.
                assert_eq!(first.get_or_insert_with(|| triangles.clone()), &triangles);
            }
        }
    }

    #[test]
    fn corners_on_a_straight_side_make_no_triangles_without_area() {
        let side = [0.0, 1.0, 2.0, 3.0];
        let mut points: Vec<Point> = side.iter().map(|&x| [0.1 * x, 0.3 * x, 0.7 * x]).collect();
        points.push([1.0, 0.0, 0.0]);
        let triangles = cut(&points).unwrap();
        assert_eq!(triangles.len(), 3);
        assert!(triangles.iter().all(|t| t.contains(&4)), "{triangles:?}");
    }

    #[test]
    fn outlines_that_cross_or_touch_themselves_are_refused() {
        let regular: Vec<Point> = (0..7)
            .map(|k| [(k as f64 * 0.9).cos(), 0.5, (k as f64 * 0.9).sin()])
            .collect();
        assert_eq!(cut(&regular).unwrap().len(), 5);
        assert!(cut(&[[0.0; 3]; 4]).is_none());
        let line: Vec<Point> = (0..5).map(|k| [f64::from(k), 0.0, 1.0]).collect();
        assert!(cut(&line).is_none());
        let flat = |points: &[[f64; 2]]| {
            let points: Vec<Point> = points.iter().map(|p| [p[0], p[1], 2.0]).collect();
            cut(&points)
        };
        // A bow tie with unequal halves, a pentagram, and a corner on another side.
        assert!(flat(&[[0.0, 0.0], [4.0, 4.0], [4.0, 0.0], [1.0, 3.0]]).is_none());
        let star: Vec<[f64; 2]> = (0..5)
            .map(|k| (144_f64.to_radians() * f64::from(k)).sin_cos().into())
            .collect();
        assert!(flat(&star).is_none());
        assert!(flat(&[[0.0, 0.0], [4.0, 0.0], [4.0, 4.0], [2.0, 0.0], [0.0, 4.0]]).is_none());
        let square = [
            [0.0, 0.0, 0.0],
            [1.0, 0.0, 0.0],
            [1.0, 1.0, 0.0],
            [0.0, 1.0, 0.0],
        ];
        assert!(triangulate(&[0, 1, 2, 3, 1], |c| square[c as usize]).is_none());
    }
}
