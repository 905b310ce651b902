//! Compressed-sparse-column patterns and the products that residuals need.

/// The nonzero pattern of a sparse matrix in compressed-sparse-column form.
///
/// Row indices of a column are strictly increasing. Values live elsewhere, in a slice of
/// length [`Pattern::len`] in the same order.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Pattern {
    rows: usize,
    cols: usize,
    col_ptr: Vec<usize>,
    row_idx: Vec<usize>,
}

impl Pattern {
    /// Pattern of the given `(row, column)` entries, duplicates merged.
    ///
    /// Also returns, for each entry in the order given, the slot of its value.
    ///
    /// # Panics
    /// If an entry lies outside the matrix.
    pub fn from_entries(rows: usize, cols: usize, entries: &[(u32, u32)]) -> (Self, Vec<u32>) {
        let mut order: Vec<u32> = (0..entries.len() as u32).collect();
        order.sort_unstable_by_key(|&k| {
            let (r, c) = entries[k as usize];
            (c, r)
        });
        let mut col_ptr = vec![0usize; cols + 1];
        let mut row_idx = Vec::with_capacity(entries.len());
        let mut slots = vec![0u32; entries.len()];
        let mut last = None;
        for &k in &order {
            let (r, c) = entries[k as usize];
            assert!(
                (r as usize) < rows && (c as usize) < cols,
                "entry ({r}, {c}) lies outside a {rows} x {cols} matrix"
            );
            if last != Some((r, c)) {
                row_idx.push(r as usize);
                col_ptr[c as usize + 1] += 1;
                last = Some((r, c));
            }
            slots[k as usize] = row_idx.len() as u32 - 1;
        }
        for c in 0..cols {
            col_ptr[c + 1] += col_ptr[c];
        }
        (
            Self {
                rows,
                cols,
                col_ptr,
                row_idx,
            },
            slots,
        )
    }

    /// Number of rows.
    pub fn rows(&self) -> usize {
        self.rows
    }

    /// Number of columns.
    pub fn cols(&self) -> usize {
        self.cols
    }

    /// Number of stored entries.
    pub fn len(&self) -> usize {
        self.row_idx.len()
    }

    /// Whether no entry is stored.
    pub fn is_empty(&self) -> bool {
        self.row_idx.is_empty()
    }

    /// Start of each column in [`Pattern::row_idx`], length `cols + 1`.
    pub fn col_ptr(&self) -> &[usize] {
        &self.col_ptr
    }

    /// Row of each stored entry, column by column.
    pub fn row_idx(&self) -> &[usize] {
        &self.row_idx
    }

    /// `y -= A x` for the full matrix with these `values`.
    pub fn sub_product(&self, values: &[f64], x: &[f64], y: &mut [f64]) {
        for c in 0..self.cols {
            let xc = x[c];
            for k in self.col_ptr[c]..self.col_ptr[c + 1] {
                y[self.row_idx[k]] -= values[k] * xc;
            }
        }
    }

    /// `y -= A^T x` for the full matrix with these `values`.
    pub(crate) fn sub_transpose_product(&self, values: &[f64], x: &[f64], y: &mut [f64]) {
        for c in 0..self.cols {
            let mut s = 0.0;
            for k in self.col_ptr[c]..self.col_ptr[c + 1] {
                s += values[k] * x[self.row_idx[k]];
            }
            y[c] -= s;
        }
    }

    /// `y -= A x` for the symmetric matrix whose lower triangle this is.
    pub fn sub_symmetric_product(&self, values: &[f64], x: &[f64], y: &mut [f64]) {
        for c in 0..self.cols {
            let xc = x[c];
            let mut s = 0.0;
            for k in self.col_ptr[c]..self.col_ptr[c + 1] {
                let r = self.row_idx[k];
                y[r] -= values[k] * xc;
                if r != c {
                    s += values[k] * x[r];
                }
            }
            y[c] -= s;
        }
    }

    /// Largest absolute row sum of the full matrix (infinity norm); `work` has length `rows`.
    pub(crate) fn inf_norm(&self, values: &[f64], work: &mut [f64]) -> f64 {
        work.fill(0.0);
        for (&r, v) in self.row_idx.iter().zip(values) {
            work[r] += v.abs();
        }
        norm_inf(work)
    }
}

/// Largest absolute entry; infinite if any entry is not a number.
pub fn norm_inf(x: &[f64]) -> f64 {
    x.iter().fold(0.0, |m: f64, v| {
        if v.is_nan() {
            f64::INFINITY
        } else {
            m.max(v.abs())
        }
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn duplicates_share_a_slot() {
        let (p, slots) = Pattern::from_entries(2, 2, &[(1, 0), (0, 0), (1, 0), (1, 1)]);
        assert_eq!(slots, [1, 0, 1, 2]);
        assert_eq!(p.col_ptr(), [0, 2, 3]);
        assert_eq!(p.row_idx(), [0, 1, 1]);
    }

    #[test]
    fn products() {
        // A = [2 0; 3 5]
        let (p, _) = Pattern::from_entries(2, 2, &[(0, 0), (1, 0), (1, 1)]);
        let v = [2.0, 3.0, 5.0];
        let mut y = [0.0; 2];
        p.sub_product(&v, &[1.0, 10.0], &mut y);
        assert_eq!(y, [-2.0, -53.0]);
        y = [0.0; 2];
        p.sub_transpose_product(&v, &[1.0, 10.0], &mut y);
        assert_eq!(y, [-32.0, -50.0]);
        y = [0.0; 2];
        p.sub_symmetric_product(&v, &[1.0, 10.0], &mut y);
        assert_eq!(y, [-32.0, -53.0]);
        assert_eq!(p.inf_norm(&v, &mut [0.0; 2]), 8.0);
    }

    #[test]
    fn norm_reports_nan_as_infinite() {
        assert_eq!(norm_inf(&[1.0, f64::NAN, -2.0]), f64::INFINITY);
        assert_eq!(norm_inf(&[1.0, -2.0]), 2.0);
    }
}
