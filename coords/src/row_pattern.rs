//! Where the coordinate rows of a chart have their entries.

/// Row-compressed pattern of S: columns of row k are `columns[starts[k]..starts[k + 1]]`.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct RowPattern {
    starts: Vec<usize>,
    columns: Vec<u32>,
}

impl RowPattern {
    /// A pattern without rows.
    #[must_use]
    pub fn new() -> Self {
        Self {
            starts: vec![0],
            columns: Vec::new(),
        }
    }

    /// Append a row with entries in the given unknowns.
    pub fn push(&mut self, columns: impl IntoIterator<Item = u32>) {
        self.columns.extend(columns);
        self.starts.push(self.columns.len());
    }

    /// Number of rows.
    #[must_use]
    pub fn rows(&self) -> usize {
        self.starts.len() - 1
    }

    /// Number of entries.
    #[must_use]
    pub fn len(&self) -> usize {
        self.columns.len()
    }

    /// Whether there is no entry.
    #[must_use]
    pub fn is_empty(&self) -> bool {
        self.columns.is_empty()
    }

    /// Entries of row k: range into the values.
    #[must_use]
    pub fn range(&self, k: usize) -> std::ops::Range<usize> {
        self.starts[k]..self.starts[k + 1]
    }

    /// The unknown of each entry.
    #[must_use]
    pub fn columns(&self) -> &[u32] {
        &self.columns
    }

    /// `(row, unknown)` of each entry.
    pub fn entries(&self) -> impl Iterator<Item = (u32, u32)> + '_ {
        (0..self.rows()).flat_map(move |k| self.range(k).map(move |i| (k as u32, self.columns[i])))
    }

    /// `S v` for `v` on the unknowns.
    pub fn apply(&self, values: &[f64], v: &[f64], out: &mut [f64]) {
        for (k, o) in out.iter_mut().enumerate() {
            *o = self
                .range(k)
                .map(|i| values[i] * v[self.columns[i] as usize])
                .sum();
        }
    }

    /// `out += S^T p` on the unknowns.
    pub fn add_transpose(&self, values: &[f64], p: &[f64], out: &mut [f64]) {
        for (k, pk) in p.iter().enumerate() {
            for i in self.range(k) {
                out[self.columns[i] as usize] += values[i] * pk;
            }
        }
    }
}
