//! Sparse LU factorisation of a general square matrix.

use super::error::LinalgError;
use super::pattern::{Pattern, norm_inf};
use super::symbolic::view;
use faer::dyn_stack::{MemBuffer, MemStack};
use faer::sparse::SparseColMatRef;
use faer::sparse::linalg::{SupernodalThreshold, lu};
use faer::{Conj, MatMut, Par};

/// LU factorisation `P A Q = L U` of a sparse square matrix, with partial pivoting and
/// a column approximate-minimum-degree ordering.
pub struct SparseLu {
    pattern: Pattern,
    values: Vec<f64>,
    symbolic: lu::SymbolicLu<usize>,
    factor: lu::NumericLu<usize, f64>,
    factor_scratch: MemBuffer,
    solve_scratch: MemBuffer,
    residual: Vec<f64>,
    rhs: Vec<f64>,
}

/// Largest normwise backward error that a refined solve may leave. A matrix that is merely
/// ill conditioned gives a few units of round-off (1e-16 to 1e-14 at the sizes of interest);
/// one that is singular to working precision does not come near.
const MAX_BACKWARD_ERROR: f64 = 1e-10;

/// Refinement steps after the first solve; a second one has never been seen to help where
/// the first did not.
const REFINEMENT_STEPS: usize = 2;

impl SparseLu {
    /// Analyses the `pattern` of a square matrix.
    ///
    /// # Errors
    /// [`LinalgError::Symbolic`] if memory runs out.
    ///
    /// # Panics
    /// If the pattern is not square.
    pub fn new(pattern: Pattern) -> Result<Self, LinalgError> {
        let n = pattern.cols();
        assert_eq!(pattern.rows(), n, "LU needs a square matrix");
        let params = lu::LuSymbolicParams {
            // faer's automatic choice takes the simplicial code too often: up to five times slower.
            supernodal_flop_ratio_threshold: SupernodalThreshold::FORCE_SUPERNODAL,
            ..Default::default()
        };
        let symbolic = lu::factorize_symbolic_lu(view(&pattern), params).map_err(|e| {
            LinalgError::Symbolic {
                order: n,
                reason: format!("{e:?}"),
            }
        })?;
        let par = Par::Seq;
        let solve = symbolic
            .solve_in_place_scratch::<f64>(1, par)
            .or(symbolic.solve_transpose_in_place_scratch::<f64>(1, par));
        Ok(Self {
            values: vec![0.0; pattern.len()],
            factor: lu::NumericLu::new(),
            factor_scratch: MemBuffer::new(
                symbolic.factorize_numeric_lu_scratch::<f64>(par, Default::default()),
            ),
            solve_scratch: MemBuffer::new(solve),
            residual: vec![0.0; n],
            rhs: vec![0.0; n],
            symbolic,
            pattern,
        })
    }

    /// Order of the matrix.
    pub fn order(&self) -> usize {
        self.pattern.cols()
    }

    /// The pattern.
    pub fn pattern(&self) -> &Pattern {
        &self.pattern
    }

    /// Values in pattern order.
    pub fn values(&self) -> &[f64] {
        &self.values
    }

    /// Values in pattern order, to be filled before [`SparseLu::factorize`].
    pub fn values_mut(&mut self) -> &mut [f64] {
        &mut self.values
    }

    /// Numeric factorisation of the current values.
    ///
    /// A zero pivot is not noticed here (faer goes on with infinities): solve with
    /// [`SparseLu::solve_refined`], which checks.
    ///
    /// # Errors
    /// [`LinalgError::Singular`] if the pattern is structurally singular.
    pub fn factorize(&mut self) -> Result<(), LinalgError> {
        let order = self.order();
        let a = SparseColMatRef::new(view(&self.pattern), self.values.as_slice());
        match self.symbolic.factorize_numeric_lu(
            &mut self.factor,
            a,
            Par::Seq,
            MemStack::new(&mut self.factor_scratch),
            Default::default(),
        ) {
            Ok(_) => Ok(()),
            Err(faer::sparse::linalg::LuError::SymbolicSingular { .. }) => {
                Err(LinalgError::Singular {
                    order,
                    backward_error: f64::INFINITY,
                })
            }
            Err(faer::sparse::linalg::LuError::Generic(e)) => Err(LinalgError::Symbolic {
                order,
                reason: format!("{e:?}"),
            }),
        }
    }

    /// Solves `A x = b` in place, without refinement or check.
    pub fn solve(&mut self, rhs: &mut [f64]) {
        let n = self.order();
        lu::LuRef::new_unchecked(&self.symbolic, &self.factor).solve_in_place_with_conj(
            Conj::No,
            MatMut::from_column_major_slice_mut(rhs, n, 1),
            Par::Seq,
            MemStack::new(&mut self.solve_scratch),
        );
    }

    /// Solves `A^T x = b` in place, without refinement or check.
    fn solve_transpose(&mut self, rhs: &mut [f64]) {
        let n = self.order();
        lu::LuRef::new_unchecked(&self.symbolic, &self.factor).solve_transpose_in_place_with_conj(
            Conj::No,
            MatMut::from_column_major_slice_mut(rhs, n, 1),
            Par::Seq,
            MemStack::new(&mut self.solve_scratch),
        );
    }

    /// Solves `A x = b` in place with iterative refinement; returns the normwise backward
    /// error `|b - A x| / (|A| |x| + |b|)` in the infinity norm.
    ///
    /// # Errors
    /// [`LinalgError::Singular`] if the result is not finite or its backward error is far
    /// above round-off.
    pub fn solve_refined(&mut self, rhs: &mut [f64]) -> Result<f64, LinalgError> {
        self.refined(rhs, Operator::Normal)
    }

    /// As [`SparseLu::solve_refined`] for `A^T x = b`.
    ///
    /// # Errors
    /// As [`SparseLu::solve_refined`].
    pub fn solve_transpose_refined(&mut self, rhs: &mut [f64]) -> Result<f64, LinalgError> {
        self.refined(rhs, Operator::Transpose)
    }

    fn refined(&mut self, x: &mut [f64], operator: Operator) -> Result<f64, LinalgError> {
        let mut b = std::mem::take(&mut self.rhs);
        let mut r = std::mem::take(&mut self.residual);
        b.copy_from_slice(x);
        let norm_a = self.pattern.inf_norm(&self.values, &mut r);
        self.solve_once(x, operator);
        let mut error = f64::INFINITY;
        for k in 0..=REFINEMENT_STEPS {
            r.copy_from_slice(&b);
            match operator {
                Operator::Normal => self.pattern.sub_product(&self.values, x, &mut r),
                Operator::Transpose => self.pattern.sub_transpose_product(&self.values, x, &mut r),
            }
            let scale = norm_a * norm_inf(x) + norm_inf(&b);
            let now = if scale == 0.0 {
                0.0
            } else {
                norm_inf(&r) / scale
            };
            let stalled = now.is_nan() || now >= 0.5 * error;
            error = if now.is_nan() {
                f64::INFINITY
            } else {
                now.min(error)
            };
            if k == REFINEMENT_STEPS || stalled || error < f64::EPSILON {
                break;
            }
            self.solve_once(&mut r, operator);
            for (xi, ri) in x.iter_mut().zip(&r) {
                *xi += ri;
            }
        }
        self.rhs = b;
        self.residual = r;
        if error <= MAX_BACKWARD_ERROR && norm_inf(x).is_finite() {
            Ok(error)
        } else {
            Err(LinalgError::Singular {
                order: self.order(),
                backward_error: error,
            })
        }
    }

    fn solve_once(&mut self, x: &mut [f64], operator: Operator) {
        match operator {
            Operator::Normal => self.solve(x),
            Operator::Transpose => self.solve_transpose(x),
        }
    }
}

/// The matrix of a solve: A or its transpose.
#[derive(Debug, Clone, Copy)]
enum Operator {
    Normal,
    Transpose,
}

#[cfg(test)]
mod tests {
    use super::*;

    fn matrix(n: usize, corner: f64) -> SparseLu {
        let mut entries = vec![(0, n as u32 - 1)];
        for i in 0..n as u32 {
            entries.push((i, i));
            if i + 1 < n as u32 {
                entries.push((i + 1, i));
            }
        }
        let (pattern, slots) = Pattern::from_entries(n, n, &entries);
        let mut lu = SparseLu::new(pattern).expect("small pattern");
        for (k, &(r, c)) in entries.iter().enumerate() {
            lu.values_mut()[slots[k] as usize] = match (r, c) {
                (0, c) if c as usize == n - 1 => corner,
                (r, c) if r == c => 1.0 + 0.1 * f64::from(r),
                _ => -2.0,
            };
        }
        lu
    }

    #[test]
    fn solves_both_sides() {
        let n = 30;
        let mut lu = matrix(n, 3.0);
        lu.factorize().expect("structure is regular");
        let x: Vec<f64> = (0..n).map(|i| 1.0 + (i as f64).cos()).collect();
        let mut b = vec![0.0; n];
        lu.pattern().sub_product(lu.values(), &x, &mut b);
        b.iter_mut().for_each(|v| *v = -*v);
        assert!(lu.solve_refined(&mut b).expect("regular") < 1e-15);
        for i in 0..n {
            assert!(
                (b[i] - x[i]).abs() < 1e-11,
                "unknown {i}: {} {}",
                b[i],
                x[i]
            );
        }
        b.fill(0.0);
        lu.pattern().sub_transpose_product(lu.values(), &x, &mut b);
        b.iter_mut().for_each(|v| *v = -*v);
        assert!(lu.solve_transpose_refined(&mut b).expect("regular") < 1e-15);
        for i in 0..n {
            assert!((b[i] - x[i]).abs() < 1e-11, "unknown {i}");
        }
    }

    #[test]
    fn singular_is_an_error_not_a_nan() {
        // Two equal rows: structurally full, numerically singular.
        let (pattern, _) = Pattern::from_entries(2, 2, &[(0, 0), (0, 1), (1, 0), (1, 1)]);
        let mut lu = SparseLu::new(pattern).expect("small pattern");
        lu.values_mut().copy_from_slice(&[1.0, 1.0, 2.0, 2.0]);
        let solved = lu
            .factorize()
            .and_then(|()| lu.solve_refined(&mut [1.0, 0.0]));
        assert!(
            matches!(solved, Err(LinalgError::Singular { order: 2, .. })),
            "{solved:?}"
        );
    }
}
