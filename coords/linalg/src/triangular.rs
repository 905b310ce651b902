//! Triangular solves with the supernodal factor of a sparse matrix and one right-hand side.
//!
//! faer's solve multiplies dense matrices for each supernode. With one right-hand side and supernodes of
//! a few columns that takes 1.4 to 1.6 times as long as the loops here (243 to 12 675 unknowns).

use faer::sparse::linalg::cholesky::supernodal::SymbolicSupernodalCholesky;

/// Columns of a supernode that are applied together. Coordinates of a vertex are eliminated one after
/// another, so that supernodes of three or a multiple of three columns are the rule.
const TOGETHER: usize = 3;
/// Sums that run side by side in an inner product.
const LANES: usize = 8;

/// A factor.
#[derive(Clone, Copy)]
pub(super) struct Factor<'a> {
    pub(super) symbolic: &'a SymbolicSupernodalCholesky<usize>,
    /// Values by supernodes.
    pub(super) values: &'a [f64],
    /// Inverses of the diagonal entries: a division takes as long as a row of a supernode.
    pub(super) inverses: &'a [f64],
}

/// Sets the inverses of the diagonal entries of a factor.
pub(super) fn invert_diagonal(
    symbolic: &SymbolicSupernodalCholesky<usize>,
    values: &[f64],
    inverses: &mut [f64],
) {
    for s in 0..symbolic.n_supernodes() {
        let (start, end) = (symbolic.supernode_begin()[s], symbolic.supernode_end()[s]);
        let next = end - start + symbolic.supernode(s).pattern().len() + 1;
        let diagonal = values[symbolic.col_ptr_for_val()[s]..].iter().step_by(next);
        for (inverse, d) in inverses[start..end].iter_mut().zip(diagonal) {
            *inverse = 1.0 / d;
        }
    }
}

/// A supernode: adjacent columns of `L` with the same rows below.
struct Supernode<'a> {
    /// Its first column.
    start: usize,
    columns: usize,
    /// Rows below its columns.
    rows: &'a [usize],
    /// Values by columns, each with the rows of the supernode itself first.
    values: &'a [f64],
    /// Inverses of the diagonal entries.
    inverses: &'a [f64],
}

impl<'a> Supernode<'a> {
    fn of(factor: Factor<'a>, s: usize) -> Self {
        let symbolic = factor.symbolic;
        let (start, end) = (symbolic.supernode_begin()[s], symbolic.supernode_end()[s]);
        let values = symbolic.col_ptr_for_val();
        Self {
            start,
            columns: end - start,
            rows: symbolic.supernode(s).pattern(),
            values: &factor.values[values[s]..values[s + 1]],
            inverses: &factor.inverses[start..end],
        }
    }

    /// Column `j`: the entries below the diagonal in the supernode's own rows, and those in the rows below.
    fn column(&self, j: usize) -> (&'a [f64], &'a [f64]) {
        let height = self.columns + self.rows.len();
        let column = &self.values[j * height..(j + 1) * height];
        let (own, below) = column.split_at(self.columns);
        (&own[j + 1..], below)
    }

    fn below(&self, j: usize) -> &'a [f64] {
        self.column(j).1
    }

    /// Solves for the supernode's own unknowns in `L x = b` and takes their parts off the rows below.
    fn forward(&self, x: &mut [f64], sums: &mut [f64]) {
        let own = &mut x[self.start..self.start + self.columns];
        for j in 0..self.columns {
            let (column, _) = self.column(j);
            own[j] *= self.inverses[j];
            let xj = own[j];
            for (xi, l) in own[j + 1..].iter_mut().zip(column) {
                *xi -= l * xj;
            }
        }
        let own = &x[self.start..self.start + self.columns];
        let sums = &mut sums[..self.rows.len()];
        sums.fill(0.0);
        let whole = self.columns - self.columns % TOGETHER;
        for j in (0..whole).step_by(TOGETHER) {
            let [a, b, c]: [&[f64]; TOGETHER] = std::array::from_fn(|k| self.below(j + k));
            let [xa, xb, xc]: [f64; TOGETHER] = std::array::from_fn(|k| own[j + k]);
            for (s, ((a, b), c)) in sums.iter_mut().zip(a.iter().zip(b).zip(c)) {
                *s += a * xa + b * xb + c * xc;
            }
        }
        for j in whole..self.columns {
            for (s, l) in sums.iter_mut().zip(self.below(j)) {
                *s += l * own[j];
            }
        }
        for (i, s) in self.rows.iter().zip(sums) {
            x[*i] -= *s;
        }
    }

    /// Solves for the supernode's own unknowns in `L^T x = b`, those of the rows below being known.
    fn backward(&self, x: &mut [f64], known: &mut [f64]) {
        let known = &mut known[..self.rows.len()];
        for (k, i) in known.iter_mut().zip(self.rows) {
            *k = x[*i];
        }
        let own = &mut x[self.start..self.start + self.columns];
        for j in (0..self.columns).rev() {
            let (column, below) = self.column(j);
            let (solved, rest) = own[j..].split_at_mut(1);
            solved[0] = (solved[0] - inner(column, rest) - inner(below, known)) * self.inverses[j];
        }
    }
}

/// Inner product, in [`LANES`] sums.
fn inner(a: &[f64], b: &[f64]) -> f64 {
    let (a, a_rest) = a.as_chunks::<LANES>();
    let (b, b_rest) = b.as_chunks::<LANES>();
    let mut sums = [0.0; LANES];
    for (a, b) in a.iter().zip(b) {
        for k in 0..LANES {
            sums[k] += a[k] * b[k];
        }
    }
    let rest: f64 = a_rest.iter().zip(b_rest).map(|(a, b)| a * b).sum();
    sums.iter().sum::<f64>() + rest
}

/// Solves `L L^T x = b` in place, in the order of the factor; `scratch` has room for the rows of a supernode.
pub(super) fn solve(factor: Factor<'_>, x: &mut [f64], scratch: &mut [f64]) {
    let count = factor.symbolic.n_supernodes();
    for s in 0..count {
        Supernode::of(factor, s).forward(x, scratch);
    }
    for s in (0..count).rev() {
        Supernode::of(factor, s).backward(x, scratch);
    }
}

/// Largest number of rows below a supernode.
pub(super) fn scratch_len(symbolic: &SymbolicSupernodalCholesky<usize>) -> usize {
    let rows = |s| symbolic.supernode(s).pattern().len();
    (0..symbolic.n_supernodes()).map(rows).max().unwrap_or(0)
}
