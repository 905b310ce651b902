//! Points of the plane.

/// A point of the plane.
pub(super) type Point = [f64; 2];

pub(super) fn sub(a: Point, b: Point) -> Point {
    [a[0] - b[0], a[1] - b[1]]
}

pub(super) fn dot(a: Point, b: Point) -> f64 {
    a[0] * b[0] + a[1] * b[1]
}

/// The component of the vector product along the normal of the plane.
pub(super) fn cross(a: Point, b: Point) -> f64 {
    a[0] * b[1] - a[1] * b[0]
}

pub(super) fn distance(a: Point, b: Point) -> f64 {
    (a[0] - b[0]).hypot(a[1] - b[1])
}

/// Twice the signed area of a triangle, positive for a counter-clockwise one.
pub(super) fn twice_area([a, b, c]: [Point; 3]) -> f64 {
    cross(sub(b, a), sub(c, a))
}

/// The point in the coordinates in which the unit vector `axis` is the x axis.
pub(super) fn along(p: Point, axis: Point) -> Point {
    [dot(p, axis), cross(axis, p)]
}
