//! Sparse `L D L^T` factorisation of a symmetric quasi-definite or saddle-point matrix.

use super::error::LinalgError;
use super::pattern::{Pattern, norm_inf};
use super::symbolic::{analyse, view};
use faer::dyn_stack::{MemBuffer, MemStack};
use faer::sparse::SparseColMatRef;
use faer::sparse::linalg::cholesky as ch;
use faer::{Conj, MatMut, Par, Side};

/// Factorisation `A = L D L^T` without pivoting of a sparse symmetric matrix, stored as its
/// lower triangle, in a given elimination order.
///
/// Safe only where the order makes every leading block regular, as where every multiplier of a saddle-point
/// matrix follows all of its own unknowns (Bridson 2007).
pub struct SparseLdlt {
    pattern: Pattern,
    values: Vec<f64>,
    symbolic: ch::SymbolicCholesky<usize>,
    factor: Vec<f64>,
    factor_scratch: MemBuffer,
    solve_scratch: MemBuffer,
}

impl SparseLdlt {
    /// Analyses the lower-triangular `pattern` for elimination in `order` (`order[k]` is the
    /// unknown eliminated k-th).
    ///
    /// # Errors
    /// [`LinalgError::Symbolic`] if memory runs out.
    ///
    /// # Panics
    /// If `order` is not a permutation of the unknowns.
    pub fn new(pattern: Pattern, order: &[usize]) -> Result<Self, LinalgError> {
        let symbolic = analyse(&pattern, order)?;
        let par = Par::Seq;
        Ok(Self {
            values: vec![0.0; pattern.len()],
            factor: vec![0.0; symbolic.len_val()],
            factor_scratch: MemBuffer::new(
                symbolic.factorize_numeric_ldlt_scratch::<f64>(par, Default::default()),
            ),
            solve_scratch: MemBuffer::new(symbolic.solve_in_place_scratch::<f64>(1, par)),
            symbolic,
            pattern,
        })
    }

    /// Order of the matrix.
    pub fn order(&self) -> usize {
        self.pattern.cols()
    }

    /// The pattern of the lower triangle.
    pub fn pattern(&self) -> &Pattern {
        &self.pattern
    }

    /// Values of the lower triangle, in pattern order.
    pub fn values(&self) -> &[f64] {
        &self.values
    }

    /// Values of the lower triangle, to be filled before [`SparseLdlt::factorize`].
    pub fn values_mut(&mut self) -> &mut [f64] {
        &mut self.values
    }

    /// Numeric factorisation of the current values.
    ///
    /// # Errors
    /// [`LinalgError::Singular`] if a pivot is zero or a factor not finite.
    pub fn factorize(&mut self) -> Result<(), LinalgError> {
        let order = self.order();
        let a = SparseColMatRef::new(view(&self.pattern), self.values.as_slice());
        let done = self.symbolic.factorize_numeric_ldlt::<f64>(
            &mut self.factor,
            a,
            Side::Lower,
            Default::default(),
            Par::Seq,
            MemStack::new(&mut self.factor_scratch),
            Default::default(),
        );
        if done.is_err() || !norm_inf(&self.factor).is_finite() {
            return Err(LinalgError::Singular {
                order,
                backward_error: f64::INFINITY,
            });
        }
        Ok(())
    }

    /// Number of negative eigenvalues, by Sylvester's law of inertia: that of negative entries of `D`.
    pub fn negative_eigenvalues(&self) -> usize {
        match self.symbolic.raw() {
            ch::SymbolicCholeskyRaw::Simplicial(symbolic) => {
                let first = |column: &usize| self.factor[*column] < 0.0;
                symbolic.col_ptr()[..self.order()]
                    .iter()
                    .filter(|c| first(c))
                    .count()
            }
            ch::SymbolicCholeskyRaw::Supernodal(symbolic) => {
                let factor = ch::supernodal::SupernodalLdltRef::new(symbolic, &self.factor);
                let negative = |s: usize| {
                    let block = factor.supernode(s).val();
                    let columns = block.ncols();
                    (0..columns).filter(|k| block[(*k, *k)] < 0.0).count()
                };
                (0..symbolic.n_supernodes()).map(negative).sum()
            }
        }
    }

    /// Solves `A x = b` in place with the current factor.
    pub fn solve(&mut self, rhs: &mut [f64]) {
        let n = self.order();
        ch::LdltRef::new(&self.symbolic, &self.factor).solve_in_place_with_conj(
            Conj::No,
            MatMut::from_column_major_slice_mut(rhs, n, 1),
            Par::Seq,
            MemStack::new(&mut self.solve_scratch),
        );
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn solves_a_saddle_point_system() {
        // [2 0 1; 0 3 -1; 1 -1 0], multiplier last.
        let entries = [(0, 0), (1, 1), (2, 0), (2, 1), (2, 2)];
        let (pattern, slots) = Pattern::from_entries(3, 3, &entries);
        let mut ldlt = SparseLdlt::new(pattern, &[0, 1, 2]).expect("small pattern");
        for (slot, v) in slots.iter().zip([2.0, 3.0, 1.0, -1.0, 0.0]) {
            ldlt.values_mut()[*slot as usize] = v;
        }
        ldlt.factorize().expect("regular");
        let mut b = [2.0 + 3.0, 6.0 - 3.0, -1.0]; // A (1, 2, 3)
        ldlt.solve(&mut b);
        for (got, want) in b.iter().zip([1.0, 2.0, 3.0]) {
            assert!((got - want).abs() < 1e-14, "{b:?}");
        }
        // The determinant is 2 (-1) - 3 < 0, and two of the diagonal are positive.
        assert_eq!(ldlt.negative_eigenvalues(), 1);
        ldlt.values_mut().fill(0.0);
        assert!(ldlt.factorize().is_err());
    }
}
