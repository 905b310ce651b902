//! Drawings in the plane z = 0.

/// A point, whose third coordinate is left out.
pub(crate) type Point = [f64; 3];

/// An edge meets another one if an end of it is so near, as a part of the size of the pattern: above the
/// round-off of coordinates of seven digits, below any distance in a drawing.
pub(crate) const NEAR: f64 = 1e-7;

/// Twice the signed area of a polygon in the plane z = 0.
pub(crate) fn twice_area<'a>(mut corners: impl Iterator<Item = &'a Point>) -> f64 {
    let Some(first) = corners.next() else {
        return 0.0;
    };
    let from_first = |p: &Point| [p[0] - first[0], p[1] - first[1]];
    let (sum, _) = corners.fold((0.0, [0.0; 2]), |(sum, a), p| {
        let b = from_first(p);
        (sum + a[0] * b[1] - a[1] * b[0], b)
    });
    sum
}

/// Whether two edges meet elsewhere than at a vertex that both have.
pub(super) fn meet(e: [u32; 2], f: [u32; 2], points: &[Point], near: f64) -> bool {
    let at = |v: u32| points[v as usize];
    let ends_near = |e: [u32; 2], f: [u32; 2]| {
        let apart = |v: &&u32| !f.contains(v);
        e.iter()
            .filter(apart)
            .any(|&v| distance(at(v), f.map(at)) <= near)
    };
    if ends_near(e, f) || ends_near(f, e) {
        return true;
    }
    if e.iter().any(|v| f.contains(v)) {
        return false;
    }
    let ([a, b], [c, d]) = (e.map(at), f.map(at));
    let side = |p: Point, q: Point, r: Point| twice_area([p, q, r].iter());
    side(a, b, c) * side(a, b, d) < 0.0 && side(c, d, a) * side(c, d, b) < 0.0
}

/// The distance of a point from a segment in the plane.
pub(crate) fn distance(p: Point, [a, b]: [Point; 2]) -> f64 {
    let along = [b[0] - a[0], b[1] - a[1]];
    let from = [p[0] - a[0], p[1] - a[1]];
    let squared = along[0] * along[0] + along[1] * along[1];
    let part = ((along[0] * from[0] + along[1] * from[1]) / squared).clamp(0.0, 1.0);
    (from[0] - part * along[0]).hypot(from[1] - part * along[1])
}
