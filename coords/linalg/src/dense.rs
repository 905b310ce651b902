//! Dense kernels of the multifrontal factorisation, for blocks of a few dozen columns.
//!
//! Matrices are stored by columns. The kernels take three columns at a time, because the unknowns of sparse
//! matrices come in threes, the coordinates of a vertex, and up to three registers of rows, so that sums stay
//! in registers.

use pulp::Simd;
use std::ops::Range;

/// Columns that are handled together.
pub(super) const TOGETHER: usize = 3;

/// What becomes of the values that a product is meant for.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Onto {
    /// They are replaced by minus the product.
    Nothing,
    /// The product is subtracted from them.
    Values,
}

impl Onto {
    /// What is stored where there was `before`.
    #[inline(always)]
    fn stored<S: Simd>(self, simd: S, before: S::f64s, product: S::f64s) -> S::f64s {
        match self {
            Self::Nothing => simd.neg_f64s(product),
            Self::Values => simd.sub_f64s(before, product),
        }
    }
}

/// Factorises the first columns of a matrix, `A = L L^T` in their rows: `panel` holds its first columns of
/// `height` values each, whose lower triangle is replaced by the columns of `L`. What is above the diagonal
/// has no meaning.
///
/// # Errors
/// The number of the first column with a pivot that is not positive.
#[inline(always)]
pub(super) fn factorise<S: Simd>(simd: S, panel: &mut [f64], height: usize) -> Result<(), usize> {
    let columns = panel.len() / height;
    let whole = columns - columns % TOGETHER;
    for first in (0..whole).step_by(TOGETHER) {
        factorise_columns::<S, TOGETHER>(simd, panel, height, first)?;
    }
    for first in whole..columns {
        factorise_columns::<S, 1>(simd, panel, height, first)?;
    }
    Ok(())
}

/// Columns `first` to `first + N` of the factor; those before are given.
#[inline(always)]
fn factorise_columns<S: Simd, const N: usize>(
    simd: S,
    panel: &mut [f64],
    height: usize,
    first: usize,
) -> Result<(), usize> {
    let (done, rest) = panel.split_at_mut(first * height);
    let columns = &mut rest[..N * height];
    if first > 0 {
        let left = Left {
            columns: done,
            height,
            first_row: first,
        };
        left.product::<S, N>(simd, &mut columns[first..], height, Onto::Values);
    }
    // The block on the diagonal.
    let mut factor = [[0.0; N]; N];
    let mut inverse = [0.0; N];
    for j in 0..N {
        for i in j..N {
            let known: f64 = (0..j).map(|k| factor[k][i] * factor[k][j]).sum();
            let value = columns[j * height + first + i] - known;
            if i > j {
                factor[j][i] = value * inverse[j];
            } else if value > 0.0 {
                factor[j][j] = value.sqrt();
                inverse[j] = 1.0 / factor[j][j];
            } else {
                return Err(first + j);
            }
        }
        columns[j * height + first + j..][..N - j].copy_from_slice(&factor[j][j..]);
    }
    // The rows below, as many as fill registers and the rest.
    let mut heads = columns.chunks_exact_mut(height);
    let below: [(&mut [S::f64s], &mut [f64]); N] = std::array::from_fn(|_| {
        let column = heads.next().expect("N columns");
        S::as_mut_simd_f64s(&mut column[first + N..])
    });
    let inverses = inverse.map(|v| simd.splat_f64s(v));
    for i in 0..below[0].0.len() {
        let mut solved = [simd.splat_f64s(0.0); N];
        for j in 0..N {
            let mut value = below[j].0[i];
            for k in 0..j {
                let l = simd.splat_f64s(-factor[k][j]);
                value = simd.mul_add_f64s(solved[k], l, value);
            }
            solved[j] = simd.mul_f64s(value, inverses[j]);
            below[j].0[i] = solved[j];
        }
    }
    for i in 0..below[0].1.len() {
        for j in 0..N {
            let known: f64 = (0..j).map(|k| below[k].1[i] * factor[k][j]).sum();
            below[j].1[i] = (below[j].1[i] - known) * inverse[j];
        }
    }
    Ok(())
}

/// Sets the lower triangle of some columns of the square matrix `-B B^T` of a size, where `B` is what columns
/// of `height` values have in their last rows; `out` begins with the first of them. What is above the
/// diagonal has no meaning. The first column and the one after the last are multiples of [`TOGETHER`], or all
/// that are left.
#[inline(always)]
pub(super) fn square<S: Simd>(
    simd: S,
    (panel, height): (&[f64], usize),
    (out, size): (&mut [f64], usize),
    columns: Range<usize>,
) {
    let whole = (size - size % TOGETHER).clamp(columns.start, columns.end);
    let place = |j: usize| (j - columns.start) * size + j;
    let left = |column: usize| Left {
        columns: panel,
        height,
        first_row: height - size + column,
    };
    for j in (columns.start..whole).step_by(TOGETHER) {
        left(j).product::<S, TOGETHER>(simd, &mut out[place(j)..], size, Onto::Nothing);
    }
    for j in whole..columns.end {
        left(j).product::<S, 1>(simd, &mut out[place(j)..], size, Onto::Nothing);
    }
}

/// A matrix `B`: the rows of columns of `height` values from `first_row` on.
#[derive(Clone, Copy)]
struct Left<'a> {
    columns: &'a [f64],
    height: usize,
    first_row: usize,
}

impl Left<'_> {
    /// The first `N` columns of `B B^T`. `out` begins with the first row of the first of these columns, which
    /// are `stride` values apart.
    #[inline(always)]
    fn product<S: Simd, const N: usize>(self, simd: S, out: &mut [f64], stride: usize, onto: Onto) {
        let rows = self.height - self.first_row;
        let lanes = S::F64_LANES;
        let mut i = 0;
        while i + 3 * lanes <= rows {
            self.tile::<S, N, 3>(simd, i, out, stride, onto);
            i += 3 * lanes;
        }
        match (rows - i) / lanes {
            2 => self.tile::<S, N, 2>(simd, i, out, stride, onto),
            1 => self.tile::<S, N, 1>(simd, i, out, stride, onto),
            _ => {}
        }
        i += (rows - i) / lanes * lanes;
        if i < rows {
            self.last_rows::<S, N>(simd, i, out, stride, onto);
        }
    }

    /// Rows from `i` on, `V` registers.
    #[inline(always)]
    fn tile<S: Simd, const N: usize, const V: usize>(
        self,
        simd: S,
        i: usize,
        out: &mut [f64],
        stride: usize,
        onto: Onto,
    ) {
        let size = V * S::F64_LANES;
        let mut sums = [[simd.splat_f64s(0.0); V]; N];
        for column in self.columns.chunks_exact(self.height) {
            let column = &column[self.first_row..];
            let (a, _) = S::as_simd_f64s(&column[i..i + size]);
            let b = &column[..N];
            for q in 0..N {
                let b = simd.splat_f64s(b[q]);
                for v in 0..V {
                    sums[q][v] = simd.mul_add_f64s(a[v], b, sums[q][v]);
                }
            }
        }
        for q in 0..N {
            let (target, _) = S::as_mut_simd_f64s(&mut out[q * stride + i..][..size]);
            for v in 0..V {
                target[v] = onto.stored(simd, target[v], sums[q][v]);
            }
        }
    }

    /// The last rows, fewer than a register has.
    #[inline(always)]
    fn last_rows<S: Simd, const N: usize>(
        self,
        simd: S,
        i: usize,
        out: &mut [f64],
        stride: usize,
        onto: Onto,
    ) {
        let size = self.height - self.first_row - i;
        let mut sums = [simd.splat_f64s(0.0); N];
        for column in self.columns.chunks_exact(self.height) {
            let column = &column[self.first_row..];
            let a = simd.partial_load_f64s(&column[i..]);
            for q in 0..N {
                sums[q] = simd.mul_add_f64s(a, simd.splat_f64s(column[q]), sums[q]);
            }
        }
        for q in 0..N {
            let target = &mut out[q * stride + i..][..size];
            let before = simd.partial_load_f64s(target);
            simd.partial_store_f64s(target, onto.stored(simd, before, sums[q]));
        }
    }
}
