//! B-splines as Bezier curves.

use isosheet_mesh::plane::PlaneCurve;

/// The curves of a spline of a degree of at most three by its knots and control points; `None` if they do not
/// fit together.
pub(super) fn curves(degree: usize, knots: &[f64], points: &[[f64; 2]]) -> Option<Vec<PlaneCurve>> {
    let fits = (1..=3).contains(&degree)
        && points.len() > degree
        && knots.len() == points.len() + degree + 1
        && knots.windows(2).all(|k| k[0] <= k[1]);
    if !fits {
        return None;
    }
    let spans = (degree..points.len()).filter(|&k| knots[k] < knots[k + 1]);
    let curve = |k: usize| {
        let (a, b) = (knots[k], knots[k + 1]);
        // The control points are the values of the polar form at the ends of the span.
        let control = |at_end: usize| {
            let arguments: Vec<f64> = (0..degree)
                .map(|j| if j < at_end { b } else { a })
                .collect();
            polar(&arguments, k, knots, points)
        };
        match degree {
            1 => PlaneCurve::Line([control(0), control(1)]),
            2 => {
                let [p, q, r] = [control(0), control(1), control(2)];
                let near = |end: [f64; 2]| [0, 1].map(|i| (end[i] + 2.0 * q[i]) / 3.0);
                PlaneCurve::Cubic([p, near(p), near(r), r])
            }
            _ => PlaneCurve::Cubic([0, 1, 2, 3].map(control)),
        }
    };
    Some(spans.map(curve).collect())
}

/// The polar form of the polynomial on the span that begins with a knot, by the algorithm of de Boor with one
/// argument for each of its rounds.
fn polar(arguments: &[f64], span: usize, knots: &[f64], points: &[[f64; 2]]) -> [f64; 2] {
    let degree = arguments.len();
    let mut d: Vec<[f64; 2]> = points[span - degree..=span].to_vec();
    for (round, u) in (1..).zip(arguments) {
        for j in (round..=degree).rev() {
            let low = knots[span - degree + j];
            let high = knots[j + 1 + span - round];
            let w = (u - low) / (high - low);
            d[j] = [0, 1].map(|k| (1.0 - w) * d[j - 1][k] + w * d[j][k]);
        }
    }
    d[degree]
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A spline that is one Bezier curve has its control points, and the parts of another one go on smoothly.
    #[test]
    fn splines_are_smooth_chains() {
        let points = [[0.0, 0.0], [1.0, 2.0], [3.0, 3.0], [4.0, 0.0]];
        let knots = [0.0, 0.0, 0.0, 0.0, 1.0, 1.0, 1.0, 1.0];
        assert_eq!(
            curves(3, &knots, &points),
            Some(vec![PlaneCurve::Cubic(points)])
        );
        for degree in [2, 3] {
            let points: Vec<[f64; 2]> = (0..6)
                .map(|k| [f64::from(k), f64::from(k * k % 5)])
                .collect();
            let knots: Vec<f64> = (0..6 + degree + 1)
                .map(|k| k.clamp(degree, 6) as f64)
                .collect();
            let parts = curves(degree, &knots, &points).unwrap();
            assert_eq!(parts.len(), 6 - degree);
            assert_eq!(parts[0].point(0.0), points[0]);
            assert_eq!(parts[5 - degree].point(1.0), points[5]);
            for pair in parts.windows(2) {
                let ends = [
                    (pair[0].point(1.0), pair[1].point(0.0)),
                    (pair[0].derivative(1.0), pair[1].derivative(0.0)),
                ];
                for (p, q) in ends {
                    assert!((p[0] - q[0]).hypot(p[1] - q[1]) < 1e-12);
                }
            }
        }
        assert_eq!(curves(4, &knots, &points), None);
        assert_eq!(curves(3, &knots[1..], &points), None);
    }
}
