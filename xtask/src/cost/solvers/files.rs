//! Matrix Market files of the matrices of the solver study.

use super::body::{Body, STIFFNESS};
use super::finest;
use crate::interrupt;
use crate::progress;
use crate::report::Effort;
use anyhow::Result;
use isosheet_io::{MatrixSymmetry, write_matrix_market};
use std::path::Path;

/// Writes the matrices of all sizes of an effort.
pub(in crate::cost) fn write(folder: &Path, effort: Effort) -> Result<()> {
    for body in Body::all(finest(effort)) {
        let body = body?;
        let kinds = [
            ("saddle", "saddle-point matrix [M G^T; G 0]"),
            ("schur", "Schur complement G M^-1 G^T"),
            ("primal", "primal matrix M + r G^T G"),
        ];
        for (kind, words) in kinds {
            interrupt::check()?;
            let matrix = match kind {
                "saddle" => body.saddle(MatrixSymmetry::Symmetric),
                "schur" => body.schur(),
                _ => body.primal(),
            };
            // The zeros on the diagonal of the saddle-point matrix are places, not entries.
            let entries: Vec<_> = matrix.entries().filter(|(.., v)| *v != 0.0).collect();
            let path = folder.join(format!("{}-{kind}.mtx", body.name));
            let comment = format!(
                "{words} of the free sheet {}: {} vertices, {} rods, {} degrees of freedom.\n\
                 M: lumped masses over their mean. G: rows x_a - x_b over the mean rod length. r = {STIFFNESS:e}.",
                body.name,
                body.sheet.topology().vertex_count(),
                body.system.equations(),
                body.system.dof()
            );
            let order = matrix.pattern.cols();
            write_matrix_market(&path, [order; 2], matrix.symmetry, &entries, &comment)?;
            progress::note(
                &path.display().to_string(),
                &format!("order {order}, {} entries", entries.len()),
            );
        }
    }
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn files_are_written() {
        let folder = tempfile::tempdir().unwrap();
        write(folder.path(), Effort::Quick).unwrap();
        let text = std::fs::read_to_string(folder.path().join("pair-saddle.mtx")).unwrap();
        assert!(text.starts_with("%%MatrixMarket matrix coordinate real symmetric\n% saddle"));
        assert!(
            text.contains("\n17 17 38\n"),
            "12 masses, 6 numbers for each of 4 rods, 2 for that along x: {text}"
        );
    }
}
