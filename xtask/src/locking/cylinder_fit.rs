//! The cylinder that fits points best.

use nalgebra::{Matrix3, SMatrix, SVector, Vector3};

/// A cylinder fitted to points.
#[derive(Clone, Copy, Debug)]
pub(super) struct CylinderFit {
    /// Curvature, 1/m: the inverse of the radius, positive where the cylinder bends towards +z.
    pub(super) curvature: f64,
    /// Angle between its axis and the y axis, radians.
    pub(super) turned: f64,
    /// Root of the mean squared distance of the points, metres.
    pub(super) distance: f64,
}

/// Parameters: height `rho` of the surface's point nearest to the origin along the normal, the two slopes of
/// that normal, the direction of the axis about it, the curvature.
type Parameters = SVector<f64, 5>;

/// Fits a cylinder to points (3V, metres) near the cylinder about the y axis of the given curvature through
/// the origin.
///
/// The squared distances are minimised by Gauss-Newton steps, with the distance of Lukacs, Martin and
/// Marshall,
/// *Faithful least-squares fitting of spheres, cylinders, cones and tori* (1998), Sec. 4: with `n` the normal at
/// the point `rho n` of the surface nearest to the origin, `a` the axis and `k` the curvature,
///
/// ```text
/// d~ = k/2 (|p|^2 - 2 rho p.n - (p.a)^2 + rho^2) + rho - p.n,   d = 2 d~ / (1 + sqrt(1 + 2 k d~)),
/// ```
///
/// which is the exact distance and stays well conditioned as `k` goes to zero (a sheet that did not bend).
/// Nothing where the points are too few or the steps do not converge.
pub(super) fn fit(points: &[f64], curvature: f64) -> Option<CylinderFit> {
    let points = points.as_chunks::<3>().0;
    let mut p = Parameters::zeros();
    p[4] = curvature;
    for _ in 0..ITERATIONS {
        let mut normal = SMatrix::<f64, 5, 5>::zeros();
        let mut right = Parameters::zeros();
        for point in points {
            let point = Vector3::from(*point);
            let residual = distance(&p, &point);
            let mut gradient = Parameters::zeros();
            for k in 0..5 {
                let (mut up, mut down) = (p, p);
                up[k] += SPAN;
                down[k] -= SPAN;
                gradient[k] = (distance(&up, &point) - distance(&down, &point)) / (2.0 * SPAN);
            }
            normal += gradient * gradient.transpose();
            right -= gradient * residual;
        }
        let step = normal.cholesky()?.solve(&right);
        p += step;
        if !p.iter().all(|v| v.is_finite()) {
            return None;
        }
        if step.norm() < CONVERGED {
            let squares = points
                .iter()
                .map(|q| distance(&p, &Vector3::from(*q)).powi(2));
            let mean = squares.sum::<f64>() / points.len() as f64;
            let (_, axis) = directions(&p);
            return Some(CylinderFit {
                curvature: p[4],
                turned: axis.y.abs().min(1.0).acos(),
                distance: mean.sqrt(),
            });
        }
    }
    None
}

/// Most Gauss-Newton steps, and the step at which they have converged (metres, radians, 1/m).
const ITERATIONS: usize = 60;
const CONVERGED: f64 = 1e-9;

/// Change of parameters over which derivatives are taken by differences: the error is of the order of its
/// square, and the steps converge all the same.
const SPAN: f64 = 1e-5;

/// Normal and axis.
fn directions(p: &Parameters) -> (Vector3<f64>, Vector3<f64>) {
    let normal = Vector3::new(p[1], p[2], 1.0).normalize();
    let (s, c) = p[3].sin_cos();
    let axis = Vector3::new(s, c, 0.0);
    let axis = (axis - normal * axis.dot(&normal)).normalize();
    (normal, axis)
}

/// The distance of a point, positive outside.
fn distance(p: &Parameters, point: &Vector3<f64>) -> f64 {
    let (n, a) = directions(p);
    let (rho, k) = (p[0], p[4]);
    let (along, axial) = (point.dot(&n), point.dot(&a));
    let d = 0.5 * k * (point.norm_squared() - 2.0 * rho * along - axial * axial + rho * rho) + rho
        - along;
    // The root is that of a square: negative only by round-off.
    2.0 * d / (1.0 + (1.0 + 2.0 * k * d).max(0.0).sqrt())
}

/// The rigid motion that brings `x` nearest to `target` (3V each, least squares), applied to `x`
/// (Kabsch 1976).
pub(super) fn aligned(x: &[f64], target: &[f64]) -> Vec<f64> {
    let rows = |v: &[f64]| -> Vec<Vector3<f64>> {
        v.as_chunks::<3>()
            .0
            .iter()
            .map(|p| Vector3::from(*p))
            .collect()
    };
    let (x, target) = (rows(x), rows(target));
    let mean = |v: &[Vector3<f64>]| v.iter().sum::<Vector3<f64>>() / v.len() as f64;
    let (from, to) = (mean(&x), mean(&target));
    let mut covariance = Matrix3::zeros();
    for (p, q) in x.iter().zip(&target) {
        covariance += (q - to) * (p - from).transpose();
    }
    let svd = covariance.svd(true, true);
    let (Some(u), Some(vt)) = (svd.u, svd.v_t) else {
        return x.iter().flat_map(|p| [p.x, p.y, p.z]).collect();
    };
    // A rotation, and no reflection.
    let mut signs = Matrix3::identity();
    signs[(2, 2)] = (u * vt).determinant().signum();
    let rotation = u * signs * vt;
    let moved = x.iter().map(|p| rotation * (p - from) + to);
    moved.flat_map(|p| [p.x, p.y, p.z]).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use nalgebra::Rotation3;

    fn cylinder(curvature: f64) -> Vec<f64> {
        let mut x = Vec::new();
        for i in -5..=5 {
            for j in -5..=5 {
                let (s, t) = (0.1 * f64::from(i), 0.1 * f64::from(j));
                let (sin, cos) = (s * curvature).sin_cos();
                x.extend([sin / curvature, t, (1.0 - cos) / curvature]);
            }
        }
        x
    }

    #[test]
    fn exact_cylinders_are_found_from_afar() {
        for curvature in [1.0, 0.5, 1e-3] {
            let turn = Rotation3::from_euler_angles(0.05, -0.04, 0.1);
            let moved: Vec<f64> = cylinder(curvature)
                .as_chunks::<3>()
                .0
                .iter()
                .flat_map(|p| {
                    let p = turn * Vector3::from(*p) + Vector3::new(0.02, 0.01, -0.03);
                    [p.x, p.y, p.z]
                })
                .collect();
            let fit = fit(&moved, 1.0).unwrap();
            assert!((fit.curvature - curvature).abs() < 1e-8, "{fit:?}");
            assert!(fit.distance < 1e-10, "{fit:?}");
            if curvature > 0.1 {
                // The axis is the y axis turned.
                let exact = (turn * Vector3::y()).y.acos();
                assert!((fit.turned - exact).abs() < 1e-7, "{fit:?} {exact}");
            }
        }
    }

    #[test]
    fn rigid_motions_are_undone() {
        let target = cylinder(1.0);
        let turn = Rotation3::from_euler_angles(1.0, 2.0, -0.5);
        let moved: Vec<f64> = target
            .as_chunks::<3>()
            .0
            .iter()
            .flat_map(|p| {
                let p = turn * Vector3::from(*p) + Vector3::new(3.0, 1.0, -2.0);
                [p.x, p.y, p.z]
            })
            .collect();
        for (a, b) in aligned(&moved, &target).iter().zip(&target) {
            assert!((a - b).abs() < 1e-13);
        }
    }
}
