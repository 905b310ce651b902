//! Terms of rank one that a factorised matrix is without.

use isosheet_linalg::LinalgError;
use isosheet_materials::vectors::dot;
use nalgebra::{Cholesky, DMatrix, DVector, Dyn};

/// The terms `sum_k c_k v_k v_k^T` with `c_k > 0` of a symmetric matrix, dense but of a low rank: from
/// energies of one quantity of all vertices, such as a volume. With `V = [v_k]` and `C = diag(c_k)`
///
/// ```text
/// (K + V C V^T)^-1 = K^-1 - U S^-1 V^T K^-1,   U = K^-1 V,   S = C^-1 + V^T U
/// ```
///
/// (Sherman, Morrison and Woodbury; Golub and Van Loan, "Matrix Computations", 2013, Sec. 2.1.4), which takes
/// a solve with the factorised `K` for each term.
#[derive(Debug, Default)]
pub(super) struct LowRank {
    terms: Vec<RankOne>,
    /// `S`.
    small: Option<Cholesky<f64, Dyn>>,
}

#[derive(Debug)]
struct RankOne {
    /// `c_k`.
    factor: f64,
    /// `v_k`, in free coordinates.
    vector: Vec<f64>,
    /// `K^-1 v_k`.
    solution: Vec<f64>,
}

impl LowRank {
    /// Forgets all terms.
    pub(super) fn clear(&mut self) {
        self.terms.clear();
        self.small = None;
    }

    /// Adds a term; one with a factor of zero is none.
    pub(super) fn add(&mut self, factor: f64, vector: Vec<f64>) {
        if factor != 0.0 {
            self.terms.push(RankOne {
                factor,
                vector,
                solution: Vec::new(),
            });
        }
    }

    /// Prepares solutions with the matrix `K` that has just been factorised, which `solve` applies inversely.
    ///
    /// # Errors
    /// [`LinalgError::NotPositiveDefinite`] where the sum of both is not.
    pub(super) fn prepare(&mut self, mut solve: impl FnMut(&mut [f64])) -> Result<(), LinalgError> {
        for term in &mut self.terms {
            term.solution.clone_from(&term.vector);
            solve(&mut term.solution);
        }
        let terms = &self.terms;
        if terms.is_empty() {
            return Ok(());
        }
        let entry = |i: usize, j: usize| {
            let diagonal = if i == j { 1.0 / terms[i].factor } else { 0.0 };
            diagonal + dot(&terms[i].vector, &terms[j].solution)
        };
        let order = terms.len();
        self.small = Cholesky::new(DMatrix::from_fn(order, order, entry));
        match self.small {
            Some(_) => Ok(()),
            None => Err(LinalgError::NotPositiveDefinite { order, index: 0 }),
        }
    }

    /// Turns `K^-1 b` into `(K + V C V^T)^-1 b`.
    pub(super) fn correct(&self, x: &mut [f64]) {
        let Some(small) = &self.small else { return };
        let products = self.terms.iter().map(|term| dot(&term.vector, x));
        let shares = small.solve(&DVector::from_iterator(self.terms.len(), products));
        for (term, share) in self.terms.iter().zip(shares.iter()) {
            for (x, u) in x.iter_mut().zip(&term.solution) {
                *x -= share * u;
            }
        }
    }

    /// Adds the product of the terms and `x` to `y`.
    #[cfg(test)]
    pub(super) fn add_product(&self, x: &[f64], y: &mut [f64]) {
        for term in &self.terms {
            let scale = term.factor * dot(&term.vector, x);
            for (y, v) in y.iter_mut().zip(&term.vector) {
                *y += scale * v;
            }
        }
    }
}
