//! Sparse matrices as Matrix Market files, for other programs to solve.

use isosheet_mesh::Advice;
use isosheet_mesh::wording::given;
use std::fmt::Write as _;
use std::io::Write as _;
use std::path::Path;

use thiserror::Error;

use crate::format::atomic::{WriteError, write_atomically};

/// Which entries of a matrix are given.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum MatrixSymmetry {
    /// All of them.
    General,
    /// Those on and below the diagonal; the others follow by symmetry.
    Symmetric,
}

/// A sparse matrix that cannot be written.
#[derive(Debug, Error)]
#[non_exhaustive]
pub enum MatrixMarketError {
    /// An entry lies outside the matrix, or above the diagonal of a symmetric one.
    #[error(
        "entry {index} is at row {row}, column {column} of a {rows} x {columns} {symmetry:?} matrix, \
         and nothing was written"
    )]
    Place {
        /// Position in the list of entries.
        index: usize,
        /// Row, from zero.
        row: usize,
        /// Column, from zero.
        column: usize,
        /// Number of rows.
        rows: usize,
        /// Number of columns.
        columns: usize,
        /// Which entries are given.
        symmetry: MatrixSymmetry,
    },
    /// An entry is NaN or infinite.
    #[error(
        "entry {index} (row {row}, column {column}) is {value}, and nothing was written",
        value = given(*value)
    )]
    NotFinite {
        /// Position in the list of entries.
        index: usize,
        /// Row, from zero.
        row: usize,
        /// Column, from zero.
        column: usize,
        /// The value.
        value: f64,
    },
    /// The file could not be written.
    #[error(transparent)]
    File(#[from] WriteError),
}

impl Advice for MatrixMarketError {
    fn advice(&self) -> Option<&'static str> {
        match self {
            Self::Place { .. } => Some(
                "give entries inside, and only those on and below the diagonal of a symmetric matrix",
            ),
            Self::NotFinite { .. } => Some("give finite entries"),
            Self::File(error) => error.advice(),
        }
    }
}

/// Writes the `rows` x `columns` matrix of the given `(row, column, value)` entries (indices from zero, each
/// place at most once) in the coordinate format of Matrix Market, atomically. Lines of `comment` stand at its
/// head.
///
/// Numbers have as many digits as are needed to read them back exactly. The format: Boisvert, Pozo and
/// Remington, *The Matrix Market Exchange Formats: Initial Design*, NISTIR 5935 (1996).
///
/// # Errors
/// [`MatrixMarketError`]; nothing is written then.
pub fn write_matrix_market(
    path: &Path,
    [rows, columns]: [usize; 2],
    symmetry: MatrixSymmetry,
    entries: &[(usize, usize, f64)],
    comment: &str,
) -> Result<(), MatrixMarketError> {
    for (index, &(row, column, value)) in entries.iter().enumerate() {
        let above = symmetry == MatrixSymmetry::Symmetric && row < column;
        if row >= rows || column >= columns || above {
            return Err(MatrixMarketError::Place {
                index,
                row,
                column,
                rows,
                columns,
                symmetry,
            });
        }
        if !value.is_finite() {
            return Err(MatrixMarketError::NotFinite {
                index,
                row,
                column,
                value,
            });
        }
    }
    let kind = match symmetry {
        MatrixSymmetry::General => "general",
        MatrixSymmetry::Symmetric => "symmetric",
    };
    let mut text = format!("%%MatrixMarket matrix coordinate real {kind}\n");
    for line in comment.lines() {
        // Writing to a string cannot fail.
        let _ = writeln!(text, "% {line}");
    }
    let _ = writeln!(text, "{rows} {columns} {}", entries.len());
    for (row, column, value) in entries {
        let _ = writeln!(text, "{} {} {value:e}", row + 1, column + 1);
    }
    Ok(write_atomically(path, |w| w.write_all(text.as_bytes()))?)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Reads a file by the definition of the format: size and dense matrix.
    fn read(path: &Path) -> Vec<Vec<f64>> {
        let text = std::fs::read_to_string(path).unwrap();
        let mut lines = text.lines();
        let head: Vec<&str> = lines.next().unwrap().split(' ').collect();
        assert_eq!(
            head[..4],
            ["%%MatrixMarket", "matrix", "coordinate", "real"]
        );
        let mut lines = lines.filter(|l| !l.starts_with('%'));
        let size: Vec<usize> = lines
            .next()
            .unwrap()
            .split_whitespace()
            .map(|w| w.parse().unwrap())
            .collect();
        let mut dense = vec![vec![0.0; size[1]]; size[0]];
        let mut count = 0;
        for line in lines {
            let words: Vec<&str> = line.split_whitespace().collect();
            let [i, j] = [0, 1].map(|k| words[k].parse::<usize>().unwrap() - 1);
            dense[i][j] = words[2].parse().unwrap();
            if head[4] == "symmetric" {
                dense[j][i] = dense[i][j];
            }
            count += 1;
        }
        assert_eq!(count, size[2]);
        dense
    }

    #[test]
    fn matrices_come_back_bit_by_bit() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("a.mtx");
        let third = 1.0 / 3.0;
        write_matrix_market(
            &path,
            [2, 3],
            MatrixSymmetry::General,
            &[(0, 2, third), (1, 0, -1e-300), (0, 0, 7.0)],
            "first\nsecond",
        )
        .unwrap();
        assert_eq!(
            read(&path),
            vec![vec![7.0, 0.0, third], vec![-1e-300, 0.0, 0.0]]
        );
        write_matrix_market(
            &path,
            [2, 2],
            MatrixSymmetry::Symmetric,
            &[(0, 0, 2.0), (1, 0, -third)],
            "",
        )
        .unwrap();
        assert_eq!(read(&path), vec![vec![2.0, -third], vec![-third, 0.0]]);
    }

    #[test]
    fn nonsense_is_refused_and_nothing_written() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("a.mtx");
        for (symmetry, entry) in [
            (MatrixSymmetry::General, (0, 2, 1.0)),
            (MatrixSymmetry::General, (0, 0, f64::NAN)),
            (MatrixSymmetry::Symmetric, (0, 1, 1.0)),
        ] {
            let refused = write_matrix_market(&path, [2, 2], symmetry, &[entry], "");
            assert!(refused.is_err(), "{entry:?}");
        }
        assert!(!path.exists());
    }
}
