//! The tessellation of waterbomb bases.

use super::error::{GenerateError, check_count, check_faces, check_size};
use super::origami::{FoldAssignment, FoldPattern};
use crate::Sheet;

/// The waterbomb tessellation, flat: a rectangle of `rows` rows with `columns` squares each, of the given
/// side (metres). Odd rows are moved by half a square, and have half a square at either end.
///
/// The creases of a square are its sides, its two diagonals and its middle line along y. Vertex (i, j) of the
/// corners and ends of middle lines has the index `i + j (2 columns + 1)` and lies at `x = side i / 2`, `y =
/// side j`; the centres of the squares follow, row by row. Diagonals are valleys, all other creases mountains
/// (Chen, Feng, Ma, Peng and You, *Symmetric waterbomb origami*, Proc. R. Soc. A 472, 2016, 20150846). The
/// sectors at a centre are 45, 90, 45, 45, 90, 45 degrees, those at any other inner vertex 90, 90 and four
/// times 45 degrees: every inner vertex can be folded flat.
///
/// # Errors
/// [`GenerateError`] for a count of zero, a length that is not positive, or too many faces.
pub fn waterbomb(columns: usize, rows: usize, side: f64) -> Result<FoldPattern, GenerateError> {
    check_count("columns", columns, 1)?;
    check_count("rows", rows, 1)?;
    check_size("side", side)?;
    check_faces(6 * columns as u128 * rows as u128)?;
    let line = 2 * columns + 1;
    let mut positions = Vec::new();
    for j in 0..=rows {
        for i in 0..line {
            positions.extend([0.5 * side * i as f64, side * j as f64, 0.0]);
        }
    }
    let (mut faces, mut creases) = (Vec::new(), Vec::new());
    for j in 0..rows {
        let at = |i: usize| [i + j * line, i + (j + 1) * line];
        if j > 0 {
            let bottom = (0..line - 1).map(|i| (at(i)[0], at(i + 1)[0], FoldAssignment::Mountain));
            creases.extend(bottom);
        }
        // Centres are over odd i in even rows and over even i in odd rows.
        for i in (1 - j % 2..line).step_by(2) {
            let centre = positions.len() / 3;
            positions.extend([0.5 * side * i as f64, side * (j as f64 + 0.5), 0.0]);
            let [south, north] = at(i);
            let mut face = |a: usize, b: usize| faces.push([centre, a, b].map(|v| v as u32));
            // A middle line or side at the edge of the sheet is no crease.
            if i > 0 && i < line - 1 {
                creases.extend([south, north].map(|v| (centre, v, FoldAssignment::Mountain)));
            }
            if i > 0 {
                let [sw, nw] = at(i - 1);
                face(north, nw);
                face(nw, sw);
                face(sw, south);
                creases.extend([sw, nw].map(|v| (centre, v, FoldAssignment::Valley)));
            }
            if i < line - 1 {
                let [se, ne] = at(i + 1);
                face(south, se);
                face(se, ne);
                face(ne, north);
                creases.extend([se, ne].map(|v| (centre, v, FoldAssignment::Valley)));
                if i + 1 < line - 1 {
                    creases.push((se, ne, FoldAssignment::Mountain));
                }
            }
        }
    }
    let sheet = Sheet::new(positions, &faces)?;
    Ok(FoldPattern::new(sheet, &creases))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::tests::flat_folding::check_flat_folding;

    #[test]
    fn counts_lengths_and_flat_folding() {
        for (columns, rows) in [(1, 1), (1, 2), (3, 4), (4, 3)] {
            let side = 0.02;
            let p = waterbomb(columns, rows, side).unwrap();
            let t = p.sheet.topology();
            let (even, odd) = (rows.div_ceil(2), rows / 2);
            let centres = even * columns + odd * (columns + 1);
            assert_eq!(t.face_count(), 6 * columns * rows);
            assert_eq!(t.vertex_count(), (2 * columns + 1) * (rows + 1) + centres);
            // Centres of odd rows at the ends of their row are on the boundary.
            let inner = (2 * columns - 1) * (rows - 1) + even * columns + odd * (columns - 1);
            assert_eq!(check_flat_folding(&p, |_| true), inner);
            let half = 0.5 * side;
            for (e, l) in t.edge_ids().zip(p.sheet.lengths()) {
                match p.assignment(e) {
                    FoldAssignment::Valley => assert!((l - half * 2f64.sqrt()).abs() < 1e-15),
                    FoldAssignment::Flat => panic!("all triangles are panels"),
                    _ => assert!((l - half).abs().min((l - side).abs()) < 1e-15),
                }
            }
            let area = (columns * rows) as f64 * side * side;
            assert!((p.sheet.area() - area).abs() < 1e-14 * area);
        }
    }

    #[test]
    fn bad_arguments_are_refused() {
        assert!(waterbomb(0, 1, 1.0).is_err() && waterbomb(1, 0, 1.0).is_err());
        let error = waterbomb(2, 2, 0.0).unwrap_err();
        assert!(matches!(error, GenerateError::Size { name: "side", .. }));
        let error = waterbomb(1 << 12, 1 << 12, 1.0).unwrap_err();
        assert!(matches!(error, GenerateError::TooManyFaces { .. }));
    }
}
