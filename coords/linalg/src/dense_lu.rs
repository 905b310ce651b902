//! LU factorisation of a dense square matrix.

use super::error::LinalgError;
use faer::dyn_stack::{MemBuffer, MemStack};
use faer::linalg::lu::partial_pivoting::{factor, solve};
use faer::perm::PermRef;
use faer::{MatMut, MatRef, Par};

/// LU factorisation `P A = L U` of a dense square matrix with partial pivoting, sequential.
pub struct DenseLu {
    order: usize,
    /// The factors, by columns.
    values: Vec<f64>,
    rows: Vec<usize>,
    inverse_rows: Vec<usize>,
}

/// Smallest pivot, relative to the largest one, of a matrix that is not singular to working precision.
const LEAST_PIVOT: f64 = 1e-13;

impl DenseLu {
    /// Factorises a matrix of `order * order` values, given by columns.
    ///
    /// # Errors
    /// [`LinalgError::Singular`] if it is singular to working precision, or a value is not finite.
    ///
    /// # Panics
    /// If the number of values is not the square of the order.
    pub fn new(order: usize, mut values: Vec<f64>) -> Result<Self, LinalgError> {
        assert_eq!(values.len(), order * order, "the matrix is square");
        let (mut rows, mut inverse_rows) = (vec![0; order], vec![0; order]);
        let scratch =
            factor::lu_in_place_scratch::<usize, f64>(order, order, Par::Seq, Default::default());
        let _ = factor::lu_in_place(
            MatMut::from_column_major_slice_mut(&mut values, order, order),
            &mut rows,
            &mut inverse_rows,
            Par::Seq,
            MemStack::new(&mut MemBuffer::new(scratch)),
            Default::default(),
        );
        let pivots = (0..order).map(|i| values[i * order + i].abs());
        let largest = pivots.clone().fold(0.0, f64::max);
        if !pivots
            .into_iter()
            .all(|pivot| pivot > LEAST_PIVOT * largest)
        {
            let backward_error = f64::INFINITY;
            return Err(LinalgError::Singular {
                order,
                backward_error,
            });
        }
        Ok(Self {
            order,
            values,
            rows,
            inverse_rows,
        })
    }

    /// Order of the matrix.
    pub fn order(&self) -> usize {
        self.order
    }

    /// Solves `A X = B` in place for the columns of `B`.
    ///
    /// # Panics
    /// If the number of values is no multiple of the order.
    pub fn solve(&self, columns: &mut [f64]) {
        let order = self.order;
        if order == 0 || columns.is_empty() {
            return;
        }
        let count = columns.len() / order;
        let factors = MatRef::from_column_major_slice(&self.values, order, order);
        let scratch = solve::solve_in_place_scratch::<usize, f64>(order, count, Par::Seq);
        solve::solve_in_place(
            factors,
            factors,
            PermRef::new_checked(&self.rows, &self.inverse_rows, order),
            MatMut::from_column_major_slice_mut(columns, order, count),
            Par::Seq,
            MemStack::new(&mut MemBuffer::new(scratch)),
        );
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn entry(i: usize, j: usize) -> f64 {
        (1.3 * i as f64 + 2.1 * j as f64).sin() + if (i + 1) % 7 == j { 3.0 } else { 0.0 }
    }

    #[test]
    fn solutions_satisfy_the_equations() {
        let n = 7;
        let matrix = (0..n * n).map(|k| entry(k % n, k / n)).collect();
        let lu = DenseLu::new(n, matrix).expect("regular");
        let mut columns: Vec<f64> = (0..2 * n).map(|k| (k as f64).cos()).collect();
        let given = columns.clone();
        lu.solve(&mut columns);
        for (k, b) in given.iter().enumerate() {
            let (column, i) = (k / n, k % n);
            let sum: f64 = (0..n).map(|j| entry(i, j) * columns[column * n + j]).sum();
            assert!((sum - b).abs() < 1e-13, "{sum} {b}");
        }
    }

    #[test]
    fn singular_matrices_and_values_that_are_no_numbers_are_refused() {
        for last in [4.0, f64::NAN, f64::INFINITY] {
            let found = DenseLu::new(2, vec![1.0, 2.0, 2.0, last]);
            assert!(matches!(found, Err(LinalgError::Singular { .. })));
        }
        assert!(DenseLu::new(2, vec![1.0, 2.0, 2.0, 5.0]).is_ok());
    }
}
