//! The few vector operations that drawings and layouts need, on `[f64; 2]`.

/// A point of the plane, or a vector.
pub type Point = [f64; 2];

/// `a - b`.
pub fn sub(a: Point, b: Point) -> Point {
    [a[0] - b[0], a[1] - b[1]]
}

/// The scalar product.
pub fn dot(a: Point, b: Point) -> f64 {
    a[0] * b[0] + a[1] * b[1]
}

/// The component of the vector product along the normal of the plane.
pub fn cross(a: Point, b: Point) -> f64 {
    a[0] * b[1] - a[1] * b[0]
}

/// The distance of two points.
pub fn distance(a: Point, b: Point) -> f64 {
    (a[0] - b[0]).hypot(a[1] - b[1])
}

/// The point at the part `w` of the way from `a` to `b`; the ends exactly.
pub fn between(a: Point, b: Point, w: f64) -> Point {
    [0, 1].map(|k| (1.0 - w) * a[k] + w * b[k])
}

/// The part of the way from `a` to `b` that is nearest to `p`.
pub fn foot(p: Point, [a, b]: [Point; 2]) -> f64 {
    let d = sub(b, a);
    let square = dot(d, d);
    match square > 0.0 {
        true => (dot(sub(p, a), d) / square).clamp(0.0, 1.0),
        false => 0.0,
    }
}
