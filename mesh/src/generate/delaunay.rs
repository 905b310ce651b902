//! Seeded irregular Delaunay sheets.

use rand::{RngExt, SeedableRng};
use rand_chacha::ChaCha8Rng;
use spade::{ConstrainedDelaunayTriangulation, Point2, Triangulation};

use super::error::{GenerateError, check_faces, check_size};
use crate::Sheet;

/// Two rounds of smoothing remove slivers and leave the mesh visibly irregular.
const SMOOTHING_ROUNDS: usize = 2;

/// Lattice points are moved by up to this part of the spacing in x and in y.
const JITTER: f64 = 0.35;

/// Interior points keep this part of the spacing from the outline, so that no flat triangle leans on it.
const CLEARANCE: f64 = 0.55;

/// An irregular triangulation of the polygon `outline` (corners in order, metres, either direction) with
/// edges about `spacing` long.
///
/// The sides are cut into equal parts; inside lies a jittered triangular lattice, smoothed a little; the
/// triangulation is the constrained Delaunay one. The same arguments give the same mesh; another `seed` gives
/// another. Boundary vertices come first, in the order of the outline.
///
/// # Errors
/// [`GenerateError`] for a spacing that is not positive, an outline of fewer than three corners, with a
/// corner that is not finite, with a side of no length or with crossing sides, or more than 2^24 faces.
pub fn delaunay(outline: &[[f64; 2]], spacing: f64, seed: u64) -> Result<Sheet, GenerateError> {
    check_size("spacing", spacing)?;
    let (min, max) = check_outline(outline)?;
    let cells = ((max[0] - min[0]) / spacing) * ((max[1] - min[1]) / spacing);
    let perimeter: f64 = sides(outline)
        .map(|(p, q)| (q[0] - p[0]).hypot(q[1] - p[1]))
        .sum();
    check_faces((2.4 * cells + perimeter / spacing) as u128)?;

    let mut points = Vec::new();
    for (p, q) in sides(outline) {
        let parts = (((q[0] - p[0]).hypot(q[1] - p[1])) / spacing)
            .round()
            .max(1.0) as usize;
        subdivide(&mut points, p, q, parts);
    }
    let boundary = points.len();

    let mut rng = ChaCha8Rng::seed_from_u64(seed);
    let height = spacing * 0.75f64.sqrt();
    let (columns, rows) = ((max[0] - min[0]) / spacing, (max[1] - min[1]) / height);
    for j in 0..=rows as usize + 1 {
        for i in 0..=columns as usize + 1 {
            let p = [
                min[0]
                    + spacing
                        * (i as f64 + 0.5 * (j % 2) as f64 + rng.random_range(-JITTER..JITTER)),
                min[1] + height * j as f64 + spacing * rng.random_range(-JITTER..JITTER),
            ];
            let clear =
                || sides(outline).all(|(a, b)| distance_to_segment(p, a, b) > CLEARANCE * spacing);
            if is_inside(p, outline) && clear() {
                points.push(p);
            }
        }
    }
    relaxed(points, boundary, SMOOTHING_ROUNDS)
}

/// [`delaunay`] for the square `[0, side]` x `[0, side]` (metres).
///
/// # Errors
/// As [`delaunay`].
pub fn delaunay_square(side: f64, spacing: f64, seed: u64) -> Result<Sheet, GenerateError> {
    check_size("side", side)?;
    delaunay(
        &[[0.0, 0.0], [side, 0.0], [side, side], [0.0, side]],
        spacing,
        seed,
    )
}

/// Triangulates `points`, whose first `boundary` are the outline in order, after `rounds` of moving every
/// other point to the area-weighted mean of the centroids of its triangles.
pub(crate) fn relaxed(
    mut points: Vec<[f64; 2]>,
    boundary: usize,
    rounds: usize,
) -> Result<Sheet, GenerateError> {
    let mut faces = triangulate(&points, boundary)?;
    for _ in 0..rounds {
        let mut sums = vec![[0.0; 3]; points.len()];
        for f in &faces {
            let [a, b, c] = f.map(|v| points[v as usize]);
            let area = (b[0] - a[0]) * (c[1] - a[1]) - (b[1] - a[1]) * (c[0] - a[0]);
            for v in f {
                let sum = &mut sums[*v as usize];
                sum[0] += area * (a[0] + b[0] + c[0]) / 3.0;
                sum[1] += area * (a[1] + b[1] + c[1]) / 3.0;
                sum[2] += area;
            }
        }
        for (p, s) in points.iter_mut().zip(&sums).skip(boundary) {
            *p = [s[0] / s[2], s[1] / s[2]];
        }
        faces = triangulate(&points, boundary)?;
    }
    let positions = points.iter().flat_map(|p| [p[0], p[1], 0.0]).collect();
    Ok(Sheet::new(positions, &faces)?)
}

/// `p` and the points that cut the side from `p` to `q` into equal parts, without `q`.
pub(crate) fn subdivide(points: &mut Vec<[f64; 2]>, p: [f64; 2], q: [f64; 2], parts: usize) {
    for k in 0..parts {
        let w = k as f64 / parts as f64;
        points.push([(1.0 - w) * p[0] + w * q[0], (1.0 - w) * p[1] + w * q[1]]);
    }
}

/// Constrained Delaunay triangles inside the closed loop of the first `boundary` points.
fn triangulate(points: &[[f64; 2]], boundary: usize) -> Result<Vec<[u32; 3]>, GenerateError> {
    let bad = |k: usize, problem: &'static str| GenerateError::Outline { corner: k, problem };
    let mut cdt = ConstrainedDelaunayTriangulation::<Point2<f64>>::new();
    let mut handles = Vec::with_capacity(points.len());
    for (k, p) in points.iter().enumerate() {
        let handle = cdt
            .insert(Point2::new(p[0], p[1]))
            .map_err(|_| bad(k, "a coordinate is out of range"))?;
        if handle.index() != k {
            return Err(bad(k, "two points coincide"));
        }
        handles.push(handle);
    }
    for k in 0..boundary {
        let (a, b) = (handles[k], handles[(k + 1) % boundary]);
        if !cdt.can_add_constraint(a, b) {
            return Err(bad(k, "a side crosses another one"));
        }
        cdt.add_constraint(a, b);
    }
    // Faces that hang together without crossing the loop; those with the outer face are outside.
    let mut group: Vec<usize> = (0..cdt.num_all_faces()).collect();
    fn root(group: &mut [usize], mut f: usize) -> usize {
        while group[f] != f {
            group[f] = group[group[f]];
            f = group[f];
        }
        f
    }
    for e in cdt.undirected_edges().filter(|e| !e.is_constraint_edge()) {
        let e = e.as_directed();
        let (f, g) = (
            root(&mut group, e.face().index()),
            root(&mut group, e.rev().face().index()),
        );
        group[f] = g;
    }
    let outside = root(&mut group, cdt.outer_face().index());
    let mut faces = Vec::with_capacity(2 * points.len());
    for f in cdt.inner_faces() {
        if root(&mut group, f.index()) != outside {
            faces.push(f.vertices().map(|v| v.index() as u32));
        }
    }
    Ok(faces)
}

type Corners = ([f64; 2], [f64; 2]);

fn sides(outline: &[[f64; 2]]) -> impl Iterator<Item = Corners> + '_ {
    (0..outline.len()).map(|k| (outline[k], outline[(k + 1) % outline.len()]))
}

/// The bounding box of a usable outline. Crossing sides are found by the triangulation.
fn check_outline(outline: &[[f64; 2]]) -> Result<Corners, GenerateError> {
    if outline.len() < 3 {
        let max = 1 << 24;
        return Err(GenerateError::Count {
            name: "corners of the outline",
            value: outline.len(),
            min: 3,
            max,
        });
    }
    let (mut min, mut max) = ([f64::INFINITY; 2], [f64::NEG_INFINITY; 2]);
    for (corner, (p, q)) in sides(outline).enumerate() {
        if !p.iter().all(|c| c.is_finite()) {
            return Err(GenerateError::Outline {
                corner,
                problem: "a coordinate is not finite",
            });
        }
        if p == q {
            return Err(GenerateError::Outline {
                corner,
                problem: "it coincides with the next corner",
            });
        }
        for k in 0..2 {
            min[k] = min[k].min(p[k]);
            max[k] = max[k].max(p[k]);
        }
    }
    Ok((min, max))
}

fn is_inside(p: [f64; 2], outline: &[[f64; 2]]) -> bool {
    let mut inside = false;
    for (a, b) in sides(outline) {
        if (a[1] > p[1]) != (b[1] > p[1])
            && p[0] < a[0] + (p[1] - a[1]) / (b[1] - a[1]) * (b[0] - a[0])
        {
            inside = !inside;
        }
    }
    inside
}

fn distance_to_segment(p: [f64; 2], a: [f64; 2], b: [f64; 2]) -> f64 {
    let (d, r) = ([b[0] - a[0], b[1] - a[1]], [p[0] - a[0], p[1] - a[1]]);
    let w = ((r[0] * d[0] + r[1] * d[1]) / (d[0] * d[0] + d[1] * d[1])).clamp(0.0, 1.0);
    (r[0] - w * d[0]).hypot(r[1] - w * d[1])
}

#[cfg(test)]
mod tests {
    use super::*;

    fn min_angle(s: &Sheet) -> f64 {
        let mut worst = f64::INFINITY;
        for f in s.topology().faces() {
            let p = f.map(|v| s.position(v));
            for i in 0..3 {
                let (a, b, c) = (p[i], p[(i + 1) % 3], p[(i + 2) % 3]);
                let (u, v) = ([b[0] - a[0], b[1] - a[1]], [c[0] - a[0], c[1] - a[1]]);
                let angle = (u[0] * v[1] - u[1] * v[0]).atan2(u[0] * v[0] + u[1] * v[1]);
                assert!(angle > 0.0, "counter-clockwise");
                worst = worst.min(angle);
            }
        }
        worst.to_degrees()
    }

    #[test]
    fn squares_are_good_irregular_and_seeded() {
        for seed in 0..20 {
            let s = delaunay_square(1.0, 0.12, seed).unwrap();
            s.topology().check_invariants();
            assert_eq!(s.topology().boundary_edge_count(), 32);
            assert_eq!(s.topology().euler_characteristic(), 1);
            assert!((s.area() - 1.0).abs() < 1e-12);
            assert!(min_angle(&s) > 20.0, "seed {seed}: {}", min_angle(&s));
        }
        let again = delaunay_square(1.0, 0.12, 3).unwrap();
        assert_eq!(again, delaunay_square(1.0, 0.12, 3).unwrap());
        assert_ne!(again, delaunay_square(1.0, 0.12, 4).unwrap());
    }

    #[test]
    fn outlines_need_not_be_convex() {
        let l = [
            [0.0, 0.0],
            [2.0, 0.0],
            [2.0, 1.0],
            [1.0, 1.0],
            [1.0, 2.0],
            [0.0, 2.0],
        ];
        let backwards: Vec<_> = l.iter().rev().copied().collect();
        for outline in [&l[..], &backwards] {
            let s = delaunay(outline, 0.2, 1).unwrap();
            s.topology().check_invariants();
            assert!((s.area() - 3.0).abs() < 1e-12, "{}", s.area());
            assert_eq!(s.topology().boundary_edge_count(), 40);
            assert!(min_angle(&s) > 15.0);
        }
        // Coarser than the outline: its corners only.
        let s = delaunay(&l, 10.0, 1).unwrap();
        assert_eq!(
            (s.topology().vertex_count(), s.topology().face_count()),
            (6, 4)
        );
    }

    #[test]
    fn scale_changes_nothing_but_the_scale() {
        let small = delaunay_square(1e-6, 1.2e-7, 5).unwrap();
        let large = delaunay_square(1e3, 1.2e2, 5).unwrap();
        assert_eq!(small.topology(), large.topology());
    }

    #[test]
    fn misuse_is_refused() {
        let bow_tie = [[0.0, 0.0], [1.0, 1.0], [1.0, 0.0], [0.0, 1.0]];
        assert!(matches!(
            delaunay(&bow_tie, 0.1, 0),
            Err(GenerateError::Outline { .. })
        ));
        assert!(matches!(
            delaunay(&bow_tie[..2], 0.1, 0),
            Err(GenerateError::Count { .. })
        ));
        let nan = [[0.0, 0.0], [1.0, f64::NAN], [1.0, 0.0]];
        assert!(matches!(
            delaunay(&nan, 0.1, 0),
            Err(GenerateError::Outline { corner: 1, .. })
        ));
        let double = [[0.0, 0.0], [1.0, 0.0], [1.0, 0.0], [0.0, 1.0]];
        assert!(matches!(
            delaunay(&double, 0.1, 0),
            Err(GenerateError::Outline { corner: 1, .. })
        ));
        let flat = [[0.0, 0.0], [1.0, 0.0], [2.0, 0.0]];
        assert!(delaunay(&flat, 0.1, 0).is_err());
        assert!(matches!(
            delaunay_square(1.0, 1e-9, 0),
            Err(GenerateError::TooManyFaces { .. })
        ));
        assert!(matches!(
            delaunay_square(1.0, 0.0, 0),
            Err(GenerateError::Size { .. })
        ));
    }
}
