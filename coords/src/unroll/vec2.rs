//! Points of the plane.

pub(super) use isosheet_mesh::plane::vec2::{Point, cross, distance, dot, sub};

/// Twice the signed area of a triangle, positive for a counter-clockwise one.
pub(super) fn twice_area([a, b, c]: [Point; 3]) -> f64 {
    cross(sub(b, a), sub(c, a))
}

/// The point in the coordinates in which the unit vector `axis` is the x axis.
pub(super) fn along(p: Point, axis: Point) -> Point {
    [dot(p, axis), cross(axis, p)]
}
