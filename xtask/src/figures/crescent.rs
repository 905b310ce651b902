//! The shape of a mark: an arc, as the crescents that a cone leaves in paper, or a straight fold.

use crate::report::extremes;
use isosheet_mesh::{EdgeId, Sheet, VertexId};
use nalgebra::{Matrix3, SymmetricEigen, Vector3};
use serde::Serialize;
use std::f64::consts::TAU;

/// A connected set of sharp edges, in the flat sheet.
#[derive(Clone, Debug, Serialize)]
pub(super) struct Crescent {
    /// Edges of the mark.
    pub(super) edges: usize,
    /// Curvature of the best circle through their midpoints, with the fold angles as weights, per metre.
    pub(super) curvature: f64,
    /// Angle in which the circle's centre sees the midpoints, radians: of a crescent about 2, of a straight
    /// fold about 0.
    pub(super) opening: f64,
    /// Mean square distance of the midpoints from the circle over that from the best straight line: 1 if
    /// bending the line brings nothing, 0 for an arc.
    pub(super) straightness: f64,
}

/// Fewest edges that have a shape: any three points lie on a circle.
const FEWEST: usize = 5;

impl Crescent {
    /// Of the sharp edges (fold angles in radians) the connected set that carries most fold; none if it has
    /// fewer than five edges or all midpoints lie on a line.
    pub(super) fn largest(sheet: &Sheet, sharp: &[(f64, EdgeId)]) -> Option<Self> {
        let ends = |e: EdgeId| ends(sheet, e);
        let mut sets: Vec<Vec<(f64, EdgeId)>> = Vec::new();
        for &edge in sharp {
            let touches = |set: &Vec<(f64, EdgeId)>| {
                set.iter()
                    .any(|other| ends(other.1).iter().any(|v| ends(edge.1).contains(v)))
            };
            let (near, far): (Vec<_>, Vec<_>) = sets.into_iter().partition(touches);
            sets = far;
            sets.push(near.into_iter().flatten().chain([edge]).collect());
        }
        let fold = |set: &Vec<(f64, EdgeId)>| set.iter().map(|e| e.0).sum::<f64>();
        let set = sets
            .into_iter()
            .max_by(|a, b| fold(a).total_cmp(&fold(b)))?;
        let [first, second] = plane(sheet);
        let points: Vec<[f64; 3]> = set
            .iter()
            .map(|(fold, e)| {
                let [a, b] = ends(*e).map(|v| sheet.position(v));
                let middle = |axis: usize| 0.5 * (a[axis] + b[axis]);
                [middle(first), middle(second), *fold]
            })
            .collect();
        Self::fit(&points)
    }

    /// The circle of points with weights, `[x, y, w]`, by Taubin's fit (1991): the smallest mean of F² over
    /// that of |∇F|² among all F = A (x² + y²) + B x + C y + D. To first order this quotient is the mean
    /// square distance from the curve F = 0. Lines, A = 0, are among these curves and have exactly that
    /// quotient, so that no circle is worse than the best line.
    fn fit(points: &[[f64; 3]]) -> Option<Self> {
        if points.len() < FEWEST {
            return None;
        }
        let total: f64 = points.iter().map(|p| p[2]).sum();
        let mean =
            |f: &dyn Fn(&[f64; 3]) -> f64| points.iter().map(|p| p[2] * f(p)).sum::<f64>() / total;
        let (mx, my) = (mean(&|p| p[0]), mean(&|p| p[1]));
        // Mean square distance from the centre, which makes x² + y² a length.
        let square = mean(&|p| (p[0] - mx).powi(2) + (p[1] - my).powi(2));
        let size = 2.0 * square.sqrt();
        let rows: Vec<(f64, Vector3<f64>)> = points
            .iter()
            .map(|p| {
                let (x, y) = (p[0] - mx, p[1] - my);
                (
                    p[2] / total,
                    Vector3::new((x * x + y * y - square) / size, x, y),
                )
            })
            .collect();
        let moments: Matrix3<f64> = rows.iter().map(|(w, r)| *w * r * r.transpose()).sum();
        // The mean square distance from the best line is the smaller eigenvalue of the covariance.
        let line = SymmetricEigen::new(moments.fixed_view::<2, 2>(1, 1).into_owned())
            .eigenvalues
            .min();
        if line <= 1e-9 * square {
            return None;
        }
        let fit = SymmetricEigen::new(moments);
        let best = fit.eigenvalues.imin();
        let [a, b, c] = fit.eigenvectors.column(best).into_owned().into();
        // The gradient of F, times half the size, points away from the centre, or everywhere to it.
        let direction = |r: &Vector3<f64>| (a * r.y + 0.5 * size * b, a * r.z + 0.5 * size * c);
        let mut angles: Vec<f64> = rows
            .iter()
            .map(|(_, r)| {
                let (x, y) = direction(r);
                y.atan2(x)
            })
            .collect();
        angles.sort_by(f64::total_cmp);
        // What the widest gap leaves of the whole turn.
        let around = angles[0] + TAU - angles[angles.len() - 1];
        let gap = angles
            .windows(2)
            .map(|w| w[1] - w[0])
            .fold(around, f64::max);
        Some(Self {
            edges: points.len(),
            // With F = a (x² + y² - square) / size + b x + c y.
            curvature: 2.0 * a.abs() / size / (b * b + c * c + a * a).sqrt(),
            opening: TAU - gap,
            straightness: fit.eigenvalues[best].max(0.0) / line,
        })
    }
}

/// Ends of an edge.
fn ends(sheet: &Sheet, e: EdgeId) -> [VertexId; 2] {
    sheet.topology().edges()[e.index()]
}

/// The two axes that a flat sheet extends along most.
fn plane(sheet: &Sheet) -> [usize; 2] {
    let extent = |axis: usize| {
        let along = sheet.positions().iter().skip(axis).step_by(3);
        extremes(along.copied()).map_or(0.0, |[low, high]| high - low)
    };
    let mut axes = [0, 1, 2];
    axes.sort_by(|a, b| extent(*b).total_cmp(&extent(*a)));
    let mut two = [axes[0], axes[1]];
    two.sort_unstable();
    two
}

#[cfg(test)]
mod tests {
    use super::*;
    use isosheet_mesh::generate::isotropic_square;
    use std::f64::consts::PI;

    #[test]
    fn an_arc_is_found() {
        let (radius, opening) = (0.3, 1.9);
        let points: Vec<[f64; 3]> = (0..=20)
            .map(|k| {
                let angle = 0.4 + opening * f64::from(k) / 20.0;
                [
                    1.0 + radius * angle.cos(),
                    radius * angle.sin() - 2.0,
                    1.0 + f64::from(k % 3),
                ]
            })
            .collect();
        let arc = Crescent::fit(&points).expect("an arc");
        assert!(
            (arc.curvature * radius - 1.0).abs() < 1e-9 && (arc.opening - opening).abs() < 1e-9
        );
        assert!(arc.straightness < 1e-12, "{arc:?}");
    }

    #[test]
    fn a_wavy_line_is_no_arc() {
        let points: Vec<[f64; 3]> = (0..40)
            .map(|k| {
                [
                    0.1 * f64::from(k),
                    if k % 2 == 0 { 0.02 } else { -0.02 },
                    1.0,
                ]
            })
            .collect();
        let arc = Crescent::fit(&points).expect("not straight");
        assert!(arc.straightness > 0.95 && arc.opening < 0.2, "{arc:?}");
    }

    #[test]
    fn the_largest_connected_set_counts() {
        // A quarter of a ring about a corner of a square, and a few edges about the opposite one.
        let side = 0.2;
        let sheet = isotropic_square(4, side).unwrap();
        let t = sheet.topology();
        let inner = t.edge_ids().filter(|e| !t.is_boundary_edge(*e));
        let sharp: Vec<(f64, EdgeId)> = inner
            .filter(|e| {
                let [a, b] = ends(&sheet, *e).map(|v| sheet.position(v));
                let r = (0.5 * (a[0] + b[0])).hypot(0.5 * (a[1] + b[1])) / side;
                (0.45..0.55).contains(&r) || r > 1.3
            })
            .map(|e| (0.5, e))
            .collect();
        let arc = Crescent::largest(&sheet, &sharp).expect("an arc");
        assert!((0.5 * side * arc.curvature - 1.0).abs() < 0.05, "{arc:?}");
        assert!((arc.opening - 0.5 * PI).abs() < 0.15, "{arc:?}");
        // Across the ring the mean square distance is (0.1 r)^2 / 3; a quarter turn bent straight adds the
        // variance of r cos(angle) over +-45 degrees, 0.00774 r^2.
        let expected = 0.01 / 3.0 / (0.01 / 3.0 + 0.00774);
        assert!((arc.straightness - expected).abs() < 0.05, "{arc:?}");
        assert!(arc.edges < sharp.len(), "{arc:?}");
    }
}
