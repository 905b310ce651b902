//! Random stencils and difference quotients for the tests.

use crate::distance::Jet;
use nalgebra::Vector3;
use proptest::prelude::*;

/// `N` points in the cube `[-1, 1]^3`.
pub(crate) fn points<const N: usize>() -> impl Strategy<Value = [Vector3<f64>; N]> {
    proptest::collection::vec(proptest::array::uniform3(-1.0..1.0_f64), N)
        .prop_map(|list| std::array::from_fn(|i| Vector3::from(list[i])))
}

/// Sizes from a micrometre to a kilometre.
pub(crate) fn sizes() -> impl Strategy<Value = f64> {
    (-6.0..3.0_f64).prop_map(|p| 10.0_f64.powf(p))
}

/// A rotation and a translation of the order of `size`, applied to the points scaled by `size`.
pub(crate) fn place<const N: usize>(
    x: &[Vector3<f64>; N],
    size: f64,
    pose: &[f64; 6],
) -> [Vector3<f64>; N] {
    let rotation = nalgebra::Rotation3::new(3.0 * Vector3::new(pose[0], pose[1], pose[2]));
    let shift = Vector3::new(pose[3], pose[4], pose[5]);
    x.map(|p| size * (rotation * p + shift))
}

/// Compares gradient and Hessian with central differences. `length` is the length over which the
/// function changes.
pub(crate) fn check_jet<const N: usize>(
    x: &[Vector3<f64>; N],
    length: f64,
    f: &dyn Fn(&[Vector3<f64>; N]) -> Jet<N>,
) {
    let at = f(x);
    // Round-off and the h^2 term balance at the cube root of the machine precision.
    let h = 6e-6 * length;
    let steepest = at.gradient.iter().map(|g| g.norm()).fold(0.0, f64::max);
    let curvature = (0..N * N)
        .map(|k| at.hessian[k / N][k % N].norm())
        .fold(0.0, f64::max);
    let slope_scale = steepest + curvature * length + at.value.abs() / length;
    let curvature_scale = curvature + steepest / length + at.value.abs() / (length * length);
    for j in 0..N {
        for k in 0..3 {
            let shifted = |d: f64| {
                let mut y = *x;
                y[j][k] += d;
                f(&y)
            };
            let (up, down) = (shifted(h), shifted(-h));
            let slope = (up.value - down.value) / (2.0 * h);
            assert!(
                (slope - at.gradient[j][k]).abs() <= 1e-7 * slope_scale,
                "slope {j},{k}: {slope} against {}",
                at.gradient[j][k]
            );
            for i in 0..N {
                let column = (up.gradient[i] - down.gradient[i]) / (2.0 * h);
                let error = (column - at.hessian[i][j].column(k)).norm();
                assert!(
                    error <= 1e-6 * curvature_scale,
                    "curvature {i},{j},{k}: {column} against {}",
                    at.hessian[i][j]
                );
            }
        }
    }
}
