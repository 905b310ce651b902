//! Yoshimura's pattern.

use super::error::{GenerateError, check_count, check_faces, check_size};
use super::grid::cut_quadrilaterals;
use super::origami::{FoldAssignment, FoldPattern};

/// Yoshimura's pattern, flat: `rows` bands of `2 columns` isosceles triangles with the given base and
/// height (metres), alternately upright and upside down.
///
/// Vertex (i, j) has the index `i + j (columns + 1)` and lies at `x = base i`, for odd j at
/// `x = base (i + 1/2)`, and `y = height j`. The bases, along x, are valleys, and all other creases are
/// mountains, as on the outside of a cylinder that was pressed together (Yoshimura, *On the mechanism of
/// buckling of a circular cylindrical shell under axial compression*, NACA TM 1390, 1955). With the angle
/// `a = atan(2 height / base)` the sectors at an inner vertex are `a, pi - 2 a, a` on either side of the
/// bases, so that every inner vertex can be folded flat.
///
/// # Errors
/// [`GenerateError`] for a count of zero, a length that is not positive, or too many faces.
pub fn yoshimura(
    columns: usize,
    rows: usize,
    base: f64,
    height: f64,
) -> Result<FoldPattern, GenerateError> {
    check_count("columns", columns, 1)?;
    check_count("rows", rows, 1)?;
    check_size("base", base)?;
    check_size("height", height)?;
    check_faces(2 * columns as u128 * rows as u128)?;
    let at = |i: usize, j: usize| i + j * (columns + 1);
    let place = |i, j| {
        let shift = if j % 2 == 1 { 0.5 } else { 0.0 };
        [base * (i as f64 + shift), height * j as f64]
    };
    let sheet = cut_quadrilaterals(columns, rows, place, |_, j| j % 2 == 1)?;
    let mut creases = Vec::new();
    for j in 0..rows {
        for i in 0..columns {
            let (a, b) = if j % 2 == 0 {
                (at(i + 1, j), at(i, j + 1))
            } else {
                (at(i, j), at(i + 1, j + 1))
            };
            creases.push((a, b, FoldAssignment::Mountain));
            if i > 0 {
                creases.push((at(i, j), at(i, j + 1), FoldAssignment::Mountain));
            }
            if j > 0 {
                creases.push((at(i, j), at(i + 1, j), FoldAssignment::Valley));
            }
        }
    }
    Ok(FoldPattern::new(sheet, &creases))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::tests::flat_folding::check_flat_folding;

    #[test]
    fn counts_lengths_and_flat_folding() {
        let (base, height) = (0.04, 0.03);
        let p = yoshimura(5, 4, base, height).unwrap();
        let t = p.sheet.topology();
        assert_eq!((t.vertex_count(), t.face_count()), (30, 40));
        assert_eq!(check_flat_folding(&p, |_| true), 4 * 3);
        let side = height.hypot(0.5 * base);
        for (e, l) in t.edge_ids().zip(p.sheet.lengths()) {
            match p.assignment(e) {
                FoldAssignment::Valley => assert!((l - base).abs() < 1e-15),
                FoldAssignment::Mountain => assert!((l - side).abs() < 1e-15),
                FoldAssignment::Boundary => {}
                FoldAssignment::Flat => panic!("all triangles are panels"),
            }
        }
        assert!((p.sheet.area() - 4.0 * 5.0 * base * height).abs() < 1e-15);
    }

    #[test]
    fn bad_arguments_are_refused() {
        assert!(yoshimura(0, 1, 1.0, 1.0).is_err());
        let error = yoshimura(2, 2, 1.0, f64::NAN).unwrap_err();
        assert!(matches!(error, GenerateError::Size { name: "height", .. }));
        let error = yoshimura(1 << 13, 1 << 13, 1.0, 1.0).unwrap_err();
        assert!(matches!(error, GenerateError::TooManyFaces { .. }));
    }
}
