//! Sparse Cholesky factorisation of a symmetric positive definite matrix.

use super::error::LinalgError;
use super::graph::Graph;
use super::multifrontal::Multifrontal;
use super::ordering::{Ordering, elimination_order, postordered};
use super::pattern::Pattern;
use super::symbolic::{analyse, view};
use faer::dyn_stack::{MemBuffer, MemStack, StackReq};
use faer::linalg::cholesky::llt::factor::LltError;
use faer::sparse::SparseColMatRef;
use faer::sparse::linalg::cholesky as ch;
use faer::{Conj, MatMut, Par, Side};

/// Cholesky factorisation `A = L L^T` of a sparse symmetric positive definite matrix,
/// stored as its lower triangle.
pub struct SparseLlt {
    pattern: Pattern,
    values: Vec<f64>,
    symbolic: ch::SymbolicCholesky<usize>,
    /// The plan of the factorisation; nothing for matrices that faer factorises column by column.
    fronts: Option<Multifrontal>,
    factor: Vec<f64>,
    factor_scratch: MemBuffer,
    solve_scratch: MemBuffer,
}

impl SparseLlt {
    /// Analyses the lower-triangular `pattern`.
    ///
    /// # Errors
    /// [`LinalgError::Symbolic`] if memory runs out.
    pub fn new(pattern: Pattern) -> Result<Self, LinalgError> {
        Self::with_blocks(pattern, 1)
    }

    /// Analyses the lower-triangular `pattern` of unknowns that come in groups of `block`, as the three
    /// coordinates of a vertex do, in the [best](Ordering::Best) order known for it.
    ///
    /// # Errors
    /// [`LinalgError::Symbolic`] if memory runs out.
    ///
    /// # Panics
    /// If `block` does not divide the order of the matrix.
    pub fn with_blocks(pattern: Pattern, block: usize) -> Result<Self, LinalgError> {
        let order = elimination_order(&pattern, block, Ordering::Best);
        Self::analysed(pattern, &order)
    }

    /// Analyses the pattern, once more if subtrees of the elimination tree are not ranges of the order.
    fn analysed(pattern: Pattern, order: &[usize]) -> Result<Self, LinalgError> {
        let mut symbolic = analyse(&pattern, order)?;
        let mut fronts = plan(&pattern, &symbolic);
        if let (None, Some(perm)) = (&fronts, symbolic.perm()) {
            let order = postordered(&Graph::of_blocks(&pattern, 1), perm.arrays().0);
            symbolic = analyse(&pattern, &order)?;
            fronts = plan(&pattern, &symbolic);
        }
        let par = Par::Seq;
        // faer's numerical factorisation is that of matrices without a plan.
        let scratch = match fronts {
            Some(_) => StackReq::EMPTY,
            None => symbolic.factorize_numeric_llt_scratch::<f64>(par, Default::default()),
        };
        Ok(Self {
            values: vec![0.0; pattern.len()],
            factor: vec![0.0; symbolic.len_val()],
            factor_scratch: MemBuffer::new(scratch),
            solve_scratch: MemBuffer::new(symbolic.solve_in_place_scratch::<f64>(1, par)),
            fronts,
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

    /// Values of the lower triangle, to be filled before [`SparseLlt::factorize`].
    pub fn values_mut(&mut self) -> &mut [f64] {
        &mut self.values
    }

    /// Multiplications of a factorisation.
    pub fn operations(&self) -> f64 {
        match &self.fronts {
            Some(fronts) => fronts.operations(),
            // Without a plan the matrix has hardly any couplings.
            None => self.factor.len() as f64,
        }
    }

    /// Whether factorisations are shared among threads, where there are several.
    pub fn is_shared(&self) -> bool {
        self.fronts.as_ref().is_some_and(Multifrontal::is_shared)
    }

    /// Number of stored entries of the factor, including the zeros that supernodes pad in.
    pub fn factor_len(&self) -> usize {
        self.factor.len()
    }

    /// Numeric factorisation of the current values. Factorisations of more than 2e7 multiplications are
    /// shared among the threads of rayon's current pool, with the same bits for any number of threads.
    ///
    /// # Errors
    /// [`LinalgError::NotPositiveDefinite`] if a pivot is not positive.
    pub fn factorize(&mut self) -> Result<(), LinalgError> {
        let result = match &mut self.fronts {
            Some(fronts) => fronts.factorise(&self.values, &mut self.factor),
            None => {
                let result = self.symbolic.factorize_numeric_llt::<f64>(
                    &mut self.factor,
                    SparseColMatRef::new(view(&self.pattern), self.values.as_slice()),
                    Side::Lower,
                    Default::default(),
                    Par::Seq,
                    MemStack::new(&mut self.factor_scratch),
                    Default::default(),
                );
                result.map(|_| ()).map_err(|e| match e {
                    LltError::NonPositivePivot { index } => index,
                })
            }
        };
        result.map_err(|index| LinalgError::NotPositiveDefinite {
            order: self.pattern.cols(),
            index,
        })
    }

    /// Entries of the factor in the order in which they are stored, by supernodes. Entries above the diagonal
    /// have no meaning.
    pub fn factor(&self) -> &[f64] {
        &self.factor
    }

    /// Solves `A x = b` in place with the current factor, shared among threads as
    /// [factorisations](Self::factorize).
    pub fn solve(&mut self, rhs: &mut [f64]) {
        match (&mut self.fronts, self.symbolic.perm()) {
            (Some(fronts), Some(perm)) => fronts.solve(perm.arrays().0, &self.factor, rhs),
            // Matrices without couplings.
            _ => {
                let n = self.order();
                ch::LltRef::new(&self.symbolic, &self.factor).solve_in_place_with_conj(
                    Conj::No,
                    MatMut::from_column_major_slice_mut(rhs, n, 1),
                    Par::Seq,
                    MemStack::new(&mut self.solve_scratch),
                );
            }
        }
    }
}

/// The plan of a factorisation by supernodes.
fn plan(pattern: &Pattern, symbolic: &ch::SymbolicCholesky<usize>) -> Option<Multifrontal> {
    match (symbolic.raw(), symbolic.perm()) {
        (ch::SymbolicCholeskyRaw::Supernodal(s), Some(perm)) => Multifrontal::new(pattern, perm, s),
        _ => None,
    }
}

#[cfg(test)]
mod tests {
    use super::super::testing::grids;
    use super::*;

    /// The symbolic factorisation of the matrix of a chain of `n` unknowns.
    fn chain(n: usize) -> SparseLlt {
        let entries: Vec<(u32, u32)> = (0..n as u32).flat_map(|i| [(i, i), (i + 1, i)]).collect();
        let (pattern, _) = Pattern::from_entries(n, n, &entries[..2 * n - 1]);
        SparseLlt::new(pattern).expect("small pattern")
    }

    /// Gives the matrix other values and factorises it: `diagonal` on the diagonal, and beside it couplings
    /// around -1 that differ from each other and between diagonals.
    fn refactorise(llt: &mut SparseLlt, diagonal: f64) -> Result<(), LinalgError> {
        let pattern = llt.pattern().clone();
        for c in 0..pattern.cols() {
            for k in pattern.col_ptr()[c]..pattern.col_ptr()[c + 1] {
                llt.values_mut()[k] = if pattern.row_idx()[k] == c {
                    diagonal
                } else {
                    -1.0 + 0.1 * (diagonal * k as f64).sin()
                };
            }
        }
        llt.factorize()
    }

    /// Two matrices with one symbolic factorisation, and an indefinite one between them.
    #[test]
    fn solves_and_refactorises() {
        for mut llt in [chain(50), grid(31, 1)] {
            for diagonal in [4.5, 0.0, 7.0] {
                let result = refactorise(&mut llt, diagonal);
                if diagonal == 0.0 {
                    result.expect_err("a zero diagonal is indefinite");
                    continue;
                }
                result.expect("diagonally dominant");
                let x: Vec<f64> = (0..llt.order()).map(|i| (i as f64).sin()).collect();
                let mut b = vec![0.0; llt.order()];
                llt.pattern()
                    .sub_symmetric_product(llt.values(), &x, &mut b);
                b.iter_mut().for_each(|v| *v = -*v);
                llt.solve(&mut b);
                for i in 0..llt.order() {
                    assert!((b[i] - x[i]).abs() < 1e-12, "unknown {i} of {diagonal}");
                }
            }
        }
    }

    /// The matrix of a square grid.
    fn grid(side: u32, block: usize) -> SparseLlt {
        let (pattern, values) = grids(&[side], 1);
        let mut llt = SparseLlt::with_blocks(pattern, block).expect("small pattern");
        llt.values_mut().copy_from_slice(&values);
        llt.factorize().expect("diagonally dominant");
        llt
    }

    #[test]
    fn solutions_satisfy_the_equations() {
        for (side, block) in [(2, 1), (5, 1), (6, 2), (6, 3), (31, 1), (30, 3)] {
            let mut llt = grid(side, block);
            let b: Vec<f64> = (0..llt.order()).map(|i| (i as f64).cos()).collect();
            let mut x = b.clone();
            llt.solve(&mut x);
            let mut residual = b;
            llt.pattern()
                .sub_symmetric_product(llt.values(), &x, &mut residual);
            let worst = residual.iter().fold(0.0_f64, |m, r| m.max(r.abs()));
            assert!(worst < 1e-13, "grid of {side}, blocks of {block}: {worst}");
        }
    }

    /// Orders in which subtrees of the elimination tree are no ranges: groups that are not full, rows that
    /// minimum degree takes out as dense, and any order at all.
    #[test]
    fn every_order_is_taken() {
        let solve = |entries: &[(u32, u32)], n: usize, make: &dyn Fn(Pattern) -> SparseLlt| {
            let all: Vec<_> = entries
                .iter()
                .copied()
                .chain((0..n as u32).map(|i| (i, i)))
                .collect();
            let (pattern, slots) = Pattern::from_entries(n, n, &all);
            let mut llt = make(pattern);
            for (slot, (r, c)) in slots.iter().zip(&all) {
                llt.values_mut()[*slot as usize] = if r == c { n as f64 } else { -1.0 };
            }
            llt.factorize().unwrap();
            let b: Vec<f64> = (0..n).map(|i| (i as f64).sin()).collect();
            let mut x = b.clone();
            llt.solve(&mut x);
            let mut left = b;
            llt.pattern()
                .sub_symmetric_product(llt.values(), &x, &mut left);
            assert!(left.iter().all(|r| r.abs() < 1e-12), "{n} unknowns");
        };
        solve(&[(3, 0), (4, 1), (5, 2)], 6, &|p| {
            SparseLlt::with_blocks(p, 3).unwrap()
        });
        let mut hubs: Vec<(u32, u32)> = (1..1200)
            .filter(|i| i % 400 > 0)
            .map(|i| (i, i - 1))
            .collect();
        hubs.extend((0..400).chain(800..1200).map(|i| (1200, i)));
        hubs.extend((400..800).map(|i| (1201, i)));
        solve(&hubs, 1202, &|p| SparseLlt::new(p).unwrap());
        let order: Vec<usize> = (0..1202).map(|i| i * 5 % 1202).collect();
        solve(&hubs, 1202, &|p| SparseLlt::analysed(p, &order).unwrap());
    }

    #[test]
    fn indefinite_is_an_error() {
        assert!(matches!(
            refactorise(&mut chain(10), 0.0),
            Err(LinalgError::NotPositiveDefinite { order: 10, .. })
        ));
    }

    #[test]
    fn matrices_without_couplings_or_unknowns() {
        let mut none = SparseLlt::new(Pattern::from_entries(0, 0, &[]).0).unwrap();
        none.factorize().unwrap();
        none.solve(&mut []);
        for n in [1, 7, 500] {
            let entries: Vec<(u32, u32)> = (0..n).map(|i| (i, i)).collect();
            let (pattern, slots) = Pattern::from_entries(n as usize, n as usize, &entries);
            let mut diagonal = SparseLlt::new(pattern).unwrap();
            for (i, slot) in slots.iter().enumerate() {
                diagonal.values_mut()[*slot as usize] = 1.0 + i as f64;
            }
            diagonal.factorize().unwrap();
            let mut x: Vec<f64> = (0..n).map(|i| 1.0 + f64::from(i)).collect();
            diagonal.solve(&mut x);
            assert!(x.iter().all(|x| (x - 1.0).abs() < 1e-15));
        }
    }
}
