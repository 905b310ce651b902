//! Cutting polygons into triangles.

type Point = [f64; 3];

/// Part of the shortest cuts by which cuts may be longer and count as equal: above the round-off of
/// coordinates of seven digits. A rectangle has the same cuts in every position then, flat and folded.
const EQUAL_CUTS: f64 = 1e-6;

/// Cuts a polygon into triangles that all contain one of its corners and are turned like the polygon as a
/// whole; `None` when no corner sees all the others. A quad is cut along the shorter diagonal if both will
/// do; of equal ones, that with the smallest vertex number.
pub(crate) fn triangulate(corners: &[u32], at: impl Fn(u32) -> Point) -> Option<Vec<[u32; 3]>> {
    let n = corners.len();
    let points: Vec<Point> = corners.iter().map(|&c| at(c)).collect();
    // Newell: the sum of the cross products about any point is twice the polygon's area vector.
    let whole = (1..n - 1).fold([0.0; 3], |sum, k| {
        add(sum, turn(points[0], points[k], points[k + 1]))
    });
    let fan = |start: usize| (1..n - 1).map(move |k| [start, (start + k) % n, (start + k + 1) % n]);
    let good = |start: usize| {
        fan(start).all(|[a, b, c]| dot(turn(points[a], points[b], points[c]), whole) > 0.0)
    };
    // The length of the cuts decides among the corners that will do.
    let cuts = |start: usize| {
        (2..n - 1)
            .map(|k| distance(points[start], points[(start + k) % n]))
            .sum::<f64>()
    };
    let candidates: Vec<(usize, f64)> = (0..n).filter(|&s| good(s)).map(|s| (s, cuts(s))).collect();
    let shortest = candidates.iter().map(|c| c.1).min_by(f64::total_cmp)?;
    let equal = candidates
        .iter()
        .filter(|c| c.1 <= (1.0 + EQUAL_CUTS) * shortest);
    let start = equal.map(|c| c.0).min_by_key(|&s| corners[s])?;
    Some(fan(start).map(|t| t.map(|k| corners[k])).collect())
}

fn sub(a: Point, b: Point) -> Point {
    [a[0] - b[0], a[1] - b[1], a[2] - b[2]]
}

fn add(a: Point, b: Point) -> Point {
    [a[0] + b[0], a[1] + b[1], a[2] + b[2]]
}

fn dot(a: Point, b: Point) -> f64 {
    a[0] * b[0] + a[1] * b[1] + a[2] * b[2]
}

fn distance(a: Point, b: Point) -> f64 {
    dot(sub(a, b), sub(a, b)).sqrt()
}

/// Twice the area vector of a triangle.
fn turn(a: Point, b: Point, c: Point) -> Point {
    let (u, v) = (sub(b, a), sub(c, a));
    [
        u[1] * v[2] - u[2] * v[1],
        u[2] * v[0] - u[0] * v[2],
        u[0] * v[1] - u[1] * v[0],
    ]
}

#[cfg(test)]
mod tests {
    use super::*;

    fn cut(points: &[Point]) -> Option<Vec<[u32; 3]>> {
        let corners: Vec<u32> = (0..points.len() as u32).collect();
        triangulate(&corners, |c| points[c as usize])
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
            assert_eq!(triangulate(&corners, at).unwrap(), expected, "position {k}");
            let reversed = [5, 9, 3, 7];
            let cuts = triangulate(&reversed, at).unwrap();
            assert!(
                cuts.iter().all(|t| t.contains(&3) && t.contains(&5)),
                "{cuts:?}"
            );
        }
    }

    #[test]
    fn areas_add_up_or_the_polygon_is_refused() {
        let regular: Vec<Point> = (0..7)
            .map(|k| [(k as f64 * 0.9).cos(), 0.5, (k as f64 * 0.9).sin()])
            .collect();
        assert_eq!(cut(&regular).unwrap().len(), 5);
        // A comb: no corner sees all.
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
        let comb: Vec<Point> = comb.iter().map(|p| [p[0], p[1], 0.0]).collect();
        assert!(cut(&comb).is_none());
        assert!(cut(&[[0.0; 3]; 4]).is_none());
    }
}
