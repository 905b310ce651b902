//! Values with first and second derivatives by the points of a stencil.

use nalgebra::{DMatrix, Matrix3, Vector3};

/// A scalar function of `N` points together with its gradient and Hessian by their coordinates.
///
/// Jets are combined by the product rule ([`Jet::times`]) and the chain rule ([`Jet::compose`]), so
/// a contact energy is written as `barrier(distance2) * mollifier` without new derivatives.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Jet<const N: usize> {
    /// The value.
    pub value: f64,
    /// Derivatives by the points, `gradient[i] = df/dx_i`.
    pub gradient: [Vector3<f64>; N],
    /// Second derivatives, `hessian[i][j] = d2f / dx_i dx_j`, rows at `x_i`; the whole is symmetric.
    pub hessian: [[Matrix3<f64>; N]; N],
}

impl<const N: usize> Jet<N> {
    /// A function that does not depend on the points.
    pub fn constant(value: f64) -> Self {
        Self {
            value,
            gradient: [Vector3::zeros(); N],
            hessian: [[Matrix3::zeros(); N]; N],
        }
    }

    /// `g(f)` for a scalar function with value, first and second derivative `[g, g', g'']` at `f`:
    /// gradient `g' df`, Hessian `g'' df df^T + g' d2f`.
    pub fn compose(&self, [g, g1, g2]: [f64; 3]) -> Self {
        Self {
            value: g,
            gradient: self.gradient.map(|d| g1 * d),
            hessian: std::array::from_fn(|i| {
                std::array::from_fn(|j| {
                    g1 * self.hessian[i][j] + g2 * self.gradient[i] * self.gradient[j].transpose()
                })
            }),
        }
    }

    /// The product of two functions of the same points.
    pub fn times(&self, other: &Self) -> Self {
        let (f, g) = (self, other);
        Self {
            value: f.value * g.value,
            gradient: std::array::from_fn(|i| f.value * g.gradient[i] + g.value * f.gradient[i]),
            hessian: std::array::from_fn(|i| {
                std::array::from_fn(|j| {
                    f.value * g.hessian[i][j]
                        + g.value * f.hessian[i][j]
                        + f.gradient[i] * g.gradient[j].transpose()
                        + g.gradient[i] * f.gradient[j].transpose()
                })
            }),
        }
    }

    /// The function times a number.
    pub fn scaled(&self, factor: f64) -> Self {
        Self {
            value: factor * self.value,
            gradient: self.gradient.map(|d| factor * d),
            hessian: self.hessian.map(|row| row.map(|block| factor * block)),
        }
    }

    /// The same with the negative eigenvalues of the Hessian set to zero: the nearest positive
    /// semidefinite matrix in the Frobenius norm, so that Newton's method descends (Teran et al.
    /// 2005; Li et al. 2020, Sec. 4.1).
    pub fn projected(&self) -> Self {
        let n = 3 * N;
        let dense = DMatrix::from_fn(n, n, |r, c| {
            let (i, j) = (r / 3, c / 3);
            0.5 * (self.hessian[i][j][(r % 3, c % 3)] + self.hessian[j][i][(c % 3, r % 3)])
        });
        let eigen = dense.symmetric_eigen();
        let mut hessian = [[Matrix3::zeros(); N]; N];
        for (k, &value) in eigen.eigenvalues.iter().enumerate() {
            if value > 0.0 {
                let vector = eigen.eigenvectors.column(k);
                for i in 0..N {
                    for j in 0..N {
                        hessian[i][j] += value
                            * vector.fixed_rows::<3>(3 * i)
                            * vector.fixed_rows::<3>(3 * j).transpose();
                    }
                }
            }
        }
        Self { hessian, ..*self }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::testing::{check_jet, points};
    use proptest::prelude::*;

    /// A cubic function whose derivatives are written out.
    fn cubic(x: &[Vector3<f64>; 2]) -> Jet<2> {
        let (a, b) = (x[0], x[1]);
        let mut jet = Jet::constant(a.dot(&a) * b.x + b.dot(&b));
        jet.gradient = [2.0 * b.x * a, 2.0 * b + a.dot(&a) * Vector3::x()];
        jet.hessian[0][0] = 2.0 * b.x * Matrix3::identity();
        jet.hessian[0][1] = 2.0 * a * Vector3::x().transpose();
        jet.hessian[1][0] = jet.hessian[0][1].transpose();
        jet.hessian[1][1] = 2.0 * Matrix3::identity();
        jet
    }

    fn linear(x: &[Vector3<f64>; 2]) -> Jet<2> {
        let mut jet = Jet::constant(x[0].x - 3.0 * x[1].z);
        jet.gradient = [Vector3::x(), -3.0 * Vector3::z()];
        jet
    }

    proptest! {
        #[test]
        fn rules_match_differences(x in points::<2>()) {
            check_jet(&x, 1.0, &cubic);
            check_jet(&x, 1.0, &|x| cubic(x).times(&linear(x)));
            check_jet(&x, 1.0, &|x| {
                let f = cubic(x);
                let (s, c) = f.value.sin_cos();
                f.compose([s, c, -s]).scaled(0.5)
            });
        }

        #[test]
        fn projection_removes_negative_curvature_only(x in points::<2>()) {
            let f = cubic(&x);
            let p = f.projected();
            let dense = |f: &Jet<2>| DMatrix::from_fn(6, 6, |r, c| f.hessian[r / 3][c / 3][(r % 3, c % 3)]);
            let (before, after) = (dense(&f), dense(&p));
            let size = before.norm().max(1e-300);
            prop_assert!(after.clone().symmetric_eigenvalues().min() > -1e-12 * size);
            // The part taken away is negative semidefinite and orthogonal to what stays.
            let away = &after - &before;
            prop_assert!(away.clone().symmetric_eigenvalues().min() > -1e-12 * size);
            prop_assert!((away * after).norm() < 1e-11 * size * size);
        }
    }
}
