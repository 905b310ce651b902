//! Pieces side by side.

use super::vec2::{Point, along, cross, sub};

/// Turns a piece such that its bounding box has the least area, lies along the x axis, and begins at the
/// origin; returns its sides. A side of the convex hull lies on a side of that box (Freeman and Shapira
/// 1975).
pub(super) fn straighten(points: &mut [Point]) -> [f64; 2] {
    let hull = hull(points);
    let mut best: Option<(f64, Point)> = None;
    for k in 0..hull.len() {
        let side = sub(hull[(k + 1) % hull.len()], hull[k]);
        let length = side[0].hypot(side[1]);
        if length == 0.0 {
            continue;
        }
        let axis = side.map(|c| c / length);
        let [w, h] = bounds(hull.iter().map(|p| along(*p, axis))).map(|[low, high]| high - low);
        // The longer side lies along x.
        let axis = if w >= h { axis } else { [-axis[1], axis[0]] };
        if best.is_none_or(|(area, _)| w * h < area * (1.0 - 1e-9)) {
            best = Some((w * h, axis));
        }
    }
    let axis = best.map_or([1.0, 0.0], |(_, axis)| axis);
    points.iter_mut().for_each(|p| *p = along(*p, axis));
    let [x, y] = bounds(points.iter().copied());
    points
        .iter_mut()
        .for_each(|p| *p = [p[0] - x[0], p[1] - y[0]]);
    [x[1] - x[0], y[1] - y[0]]
}

/// Where boxes with some sides begin that stand in rows, a gap between each other: the highest ones first, in
/// rows about as long as all rows are high together.
pub(super) fn in_rows(sides: &[[f64; 2]], gap: f64) -> Vec<Point> {
    let mut order: Vec<usize> = (0..sides.len()).collect();
    order.sort_by(|a, b| sides[*b][1].total_cmp(&sides[*a][1]));
    let area: f64 = sides.iter().map(|[w, h]| (w + gap) * (h + gap)).sum();
    let widest = sides.iter().fold(0.0_f64, |m, [w, _]| m.max(*w));
    let row = widest.max(area.sqrt());
    let mut places = vec![[0.0; 2]; sides.len()];
    let ([mut x, mut y], mut height) = ([0.0; 2], 0.0);
    for k in order {
        let [w, h] = sides[k];
        if x > 0.0 && x + w > row {
            (x, y, height) = (0.0, y + height + gap, 0.0);
        }
        places[k] = [x, y];
        x += w + gap;
        height = f64::max(height, h);
    }
    places
}

/// The least and the largest coordinates.
fn bounds(points: impl Iterator<Item = Point>) -> [[f64; 2]; 2] {
    let none = [f64::INFINITY, f64::NEG_INFINITY];
    points.fold([none; 2], |b, p| {
        [0, 1].map(|k| [b[k][0].min(p[k]), b[k][1].max(p[k])])
    })
}

/// The convex hull, counter-clockwise (Andrew 1979).
fn hull(points: &[Point]) -> Vec<Point> {
    let mut sorted = points.to_vec();
    sorted.sort_by(|a, b| a[0].total_cmp(&b[0]).then(a[1].total_cmp(&b[1])));
    let half = |points: &mut dyn Iterator<Item = Point>| {
        let mut chain: Vec<Point> = Vec::new();
        for p in points {
            while let [.., a, b] = chain[..]
                && cross(sub(b, a), sub(p, b)) <= 0.0
            {
                chain.pop();
            }
            chain.push(p);
        }
        chain.pop();
        chain
    };
    let mut hull = half(&mut sorted.iter().copied());
    hull.extend(half(&mut sorted.iter().rev().copied()));
    hull
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A rectangle that is turned lies along the axes again, its longer side along x.
    #[test]
    fn a_rectangle_is_straightened() {
        for angle in [0.0, 0.3, 1.2, 2.0, -0.7] {
            let (s, c) = f64::sin_cos(angle);
            let corners = [[0.0, 0.0], [1.0, 0.0], [1.0, 3.0], [0.0, 3.0], [0.4, 2.0]];
            let mut points = corners.map(|[x, y]| [c * x - s * y + 5.0, s * x + c * y]);
            let sides = straighten(&mut points);
            assert!((sides[0] - 3.0).abs() < 1e-14 && (sides[1] - 1.0).abs() < 1e-14);
            for (p, q) in points.iter().zip(&corners) {
                assert!((p[1] - q[0]).abs() < 1e-14 || (p[1] + q[0] - 1.0).abs() < 1e-14);
            }
        }
    }

    #[test]
    fn boxes_do_not_touch() {
        let sides = [[2.0, 1.0], [1.0, 1.5], [0.5, 0.2], [3.0, 0.4], [0.7, 0.7]];
        let places = in_rows(&sides, 0.1);
        for i in 0..sides.len() {
            for j in 0..i {
                let apart = (0..2).any(|k| {
                    let gap = |a: usize, b: usize| places[b][k] - places[a][k] - sides[a][k];
                    gap(i, j) > 0.1 - 1e-15 || gap(j, i) > 0.1 - 1e-15
                });
                assert!(apart, "{i} {j}: {places:?}");
            }
        }
    }
}
