//! Triangles that cover each other, seen from above.

/// A triangle seen from above, with its height.
#[derive(Clone, Copy, Debug)]
pub(super) struct Triangle {
    /// Its corners, counter-clockwise as seen from above.
    corners: [[f64; 3]; 3],
}

/// What two triangles have in common.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Common {
    pub(super) area: f64,
    /// The mean of its corners.
    pub(super) middle: [f64; 2],
}

/// Twice the area of a triangle of points, positive where they are counter-clockwise.
fn twice([a, b, c]: [[f64; 2]; 3]) -> f64 {
    (b[0] - a[0]) * (c[1] - a[1]) - (b[1] - a[1]) * (c[0] - a[0])
}

/// A point seen from above.
fn flat([x, y, _]: [f64; 3]) -> [f64; 2] {
    [x, y]
}

impl Triangle {
    /// Of three corners in any order.
    pub(super) fn new([a, b, c]: [[f64; 3]; 3]) -> Self {
        let corners = match twice([a, b, c].map(flat)) < 0.0 {
            true => [a, c, b],
            false => [a, b, c],
        };
        Self { corners }
    }

    /// Its area as seen from above.
    pub(super) fn area(&self) -> f64 {
        0.5 * twice(self.corners.map(flat))
    }

    /// The height of its plane at a point.
    pub(super) fn height(&self, point: [f64; 2]) -> f64 {
        let [a, b, c] = self.corners;
        let [p, q, r] = self.corners.map(flat);
        let parts = [[point, q, r], [p, point, r], [p, q, point]].map(twice);
        let sum: f64 = parts.iter().sum();
        (parts[0] * a[2] + parts[1] * b[2] + parts[2] * c[2]) / sum
    }

    /// The two ends of a coordinate.
    fn ends(&self, axis: usize) -> [f64; 2] {
        let values = self.corners.map(|p| p[axis]);
        [
            values.iter().copied().fold(f64::INFINITY, f64::min),
            values.iter().copied().fold(f64::NEG_INFINITY, f64::max),
        ]
    }
}

/// What two triangles have in common, if they do.
pub(super) fn overlap(first: &Triangle, second: &Triangle) -> Option<Common> {
    let is_apart = |axis: usize| {
        let ([a, b], [c, d]) = (first.ends(axis), second.ends(axis));
        b <= c || d <= a
    };
    if is_apart(0) || is_apart(1) {
        return None;
    }
    let mut polygon: Vec<[f64; 2]> = first.corners.map(flat).to_vec();
    let corners = second.corners.map(flat);
    // Sutherland and Hodgman: what is on the inner side of each edge of the second one.
    for k in 0..3 {
        let [p, q] = [corners[k], corners[(k + 1) % 3]];
        let side = |point: [f64; 2]| twice([p, q, point]);
        let mut inside = Vec::with_capacity(polygon.len() + 1);
        for (i, &from) in polygon.iter().enumerate() {
            let to = polygon[(i + 1) % polygon.len()];
            let [s, t] = [from, to].map(side);
            if s >= 0.0 {
                inside.push(from);
            }
            if s * t < 0.0 {
                let part = s / (s - t);
                inside.push([0, 1].map(|c| from[c] + part * (to[c] - from[c])));
            }
        }
        polygon = inside;
        if polygon.len() < 3 {
            return None;
        }
    }
    let fan = polygon
        .windows(2)
        .map(|pair| twice([polygon[0], pair[0], pair[1]]));
    let area = 0.5 * fan.sum::<f64>();
    let count = polygon.len() as f64;
    let middle = [0, 1].map(|c| polygon.iter().map(|p| p[c]).sum::<f64>() / count);
    (area > 0.0).then_some(Common { area, middle })
}

#[cfg(test)]
mod tests {
    use super::{Triangle, overlap};

    /// A right triangle with sides of a length at a corner, at a height.
    fn right(x: f64, y: f64, side: f64, z: f64) -> Triangle {
        Triangle::new([[x, y, z], [x, y + side, z], [x + side, y, z]])
    }

    #[test]
    fn triangles_have_a_triangle_in_common() {
        let common = overlap(&right(0.0, 0.0, 1.0, 0.0), &right(0.5, 0.25, 1.0, 2.0)).unwrap();
        // A right triangle with sides of a quarter.
        assert!((common.area - 0.25 * 0.25 / 2.0).abs() < 1e-15);
        let middle = [0.5 + 0.25 / 3.0, 0.25 + 0.25 / 3.0];
        assert!((0..2).all(|c| (common.middle[c] - middle[c]).abs() < 1e-15));
    }

    #[test]
    fn triangles_beside_each_other_have_nothing_in_common() {
        let first = right(0.0, 0.0, 1.0, 0.0);
        let beside = Triangle::new([[1.0, 0.0, 0.0], [1.0, 1.0, 0.0], [0.0, 1.0, 0.0]]);
        assert_eq!(overlap(&first, &beside), None);
        assert_eq!(overlap(&first, &right(2.0, 0.0, 1.0, 0.0)), None);
    }

    #[test]
    fn the_height_is_that_of_the_plane() {
        let height = |x: f64, y: f64| 0.3 + 0.2 * x - 0.7 * y;
        let corner = |x: f64, y: f64| [x, y, height(x, y)];
        let triangle = Triangle::new([corner(0.0, 0.0), corner(0.0, 1.0), corner(2.0, 0.5)]);
        assert!((triangle.height([0.4, 0.6]) - height(0.4, 0.6)).abs() < 1e-15);
    }
}
