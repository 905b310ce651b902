//! Triangles that lie on each other.

use super::vec2::{Point, dot};

/// The first two triangles found that lie on each other more than `depth` deep: no line along a side of
/// either of them has the one on one side and the other on the other side, up to that depth. Neighbours
/// touch.
///
/// Triangles are counter-clockwise.
pub(super) fn overlapping(triangles: &[[Point; 3]], depth: f64) -> Option<[usize; 2]> {
    let bounds = triangles.iter().map(|t| {
        let [x, y] = [0, 1].map(|k| {
            let own = t.iter().map(|p| p[k]);
            own.fold([f64::INFINITY, f64::NEG_INFINITY], |[low, high], c| {
                [low.min(c), high.max(c)]
            })
        });
        [x, y]
    });
    let bounds: Vec<[[f64; 2]; 2]> = bounds.collect();
    // They are swept along the longer side of all.
    let extent = |k: usize| {
        let low = bounds.iter().fold(f64::INFINITY, |m, b| m.min(b[k][0]));
        bounds.iter().fold(f64::NEG_INFINITY, |m, b| m.max(b[k][1])) - low
    };
    let [axis, other] = if extent(0) >= extent(1) {
        [0, 1]
    } else {
        [1, 0]
    };
    let mut order: Vec<usize> = (0..triangles.len()).collect();
    order.sort_by(|a, b| bounds[*a][axis][0].total_cmp(&bounds[*b][axis][0]));
    for (place, &one) in order.iter().enumerate() {
        for &next in &order[place + 1..] {
            if bounds[next][axis][0] >= bounds[one][axis][1] {
                break;
            }
            let [[low, high], [other_low, other_high]] = [bounds[one][other], bounds[next][other]];
            if low < other_high
                && other_low < high
                && lie_on_each_other(&triangles[one], &triangles[next], depth)
            {
                return Some([one.min(next), one.max(next)]);
            }
        }
    }
    None
}

fn lie_on_each_other(one: &[Point; 3], other: &[Point; 3], depth: f64) -> bool {
    !is_beyond_a_side(one, other, depth) && !is_beyond_a_side(other, one, depth)
}

/// Whether a triangle is beyond a side of another one.
fn is_beyond_a_side(of: &[Point; 3], other: &[Point; 3], depth: f64) -> bool {
    (0..3).any(|k| {
        let [a, b] = [of[k], of[(k + 1) % 3]];
        let [x, y] = [b[0] - a[0], b[1] - a[1]];
        let length = x.hypot(y);
        let outwards = [y / length, -x / length];
        let nearest = other
            .iter()
            .map(|p| dot([p[0] - a[0], p[1] - a[1]], outwards));
        nearest.fold(f64::INFINITY, f64::min) >= -depth
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn neighbours_touch_and_others_lie_on_each_other() {
        let [a, b, c, d] = [[0.0, 0.0], [1.0, 0.0], [1.0, 1.0], [0.0, 1.0]];
        assert_eq!(overlapping(&[[a, b, c], [a, c, d]], 0.0), None);
        // Two that have a corner in common, and one that is inside of another.
        let inside = [[0.6, 0.2], [0.8, 0.2], [0.8, 0.4]];
        assert_eq!(
            overlapping(&[[a, c, d], [a, b, c], inside], 0.0),
            Some([1, 2])
        );
        assert_eq!(overlapping(&[[a, b, c], [a, b, d]], 1e-3), Some([0, 1]));
        // A star without a side of either between the corners of the other.
        let up = [[-1.0, -0.5], [1.0, -0.5], [0.0, 1.0]];
        let down = up.map(|[x, y]| [-x, -y]);
        assert_eq!(overlapping(&[up, down], 0.0), Some([0, 1]));
    }

    /// Depth counts: triangles whose sides overlap by round-off touch.
    #[test]
    fn round_off_is_no_overlap() {
        let one = [[0.0, 0.0], [1.0, 0.0], [0.0, 1.0]];
        let beside = [[0.0, 1e-12], [0.0, -1.0], [1.0, 1e-12]];
        assert_eq!(overlapping(&[one, beside], 1e-9), None);
        assert_eq!(overlapping(&[one, beside], 1e-13), Some([0, 1]));
    }
}
