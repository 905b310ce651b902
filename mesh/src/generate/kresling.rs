//! Kresling's pattern.

use super::error::{GenerateError, check_angle, check_count, check_faces, check_size};
use super::grid::cut_quadrilaterals;
use super::origami::{FoldAssignment, FoldPattern};
use std::f64::consts::FRAC_PI_2;

/// Kresling's pattern, flat: `columns` x `rows` parallelograms with sides `base` along x and `side`
/// (metres) and the acute angle `angle` (radians) between them, each cut in two along its longer diagonal.
///
/// Vertex (i, j) has the index `i + j (columns + 1)` and lies at `x = base i + side cos(angle) j` and `y =
/// side sin(angle) j`. The diagonals, from (i, j) to (i + 1, j + 1), are valleys; bases and sides are
/// mountains (Kresling, *Natural twist buckling in shells: from the hawkmoth's bellows to the deployable
/// Kresling-pattern and cylindrical Miura-ori*, Proceedings of IASS-IACM 2008; Guest and Pellegrino, *The
/// folding of triangulated cylinders*, J. Appl. Mech. 61, 1994). All triangles are congruent: the sectors at
/// an inner vertex are the three angles of a triangle, twice in the same order, so that every inner vertex
/// can be folded flat.
///
/// # Errors
/// [`GenerateError`] for a count of zero, a length that is not positive, an angle that is not between 0
/// and pi/2, or too many faces.
pub fn kresling(
    columns: usize,
    rows: usize,
    base: f64,
    side: f64,
    angle: f64,
) -> Result<FoldPattern, GenerateError> {
    check_count("columns", columns, 1)?;
    check_count("rows", rows, 1)?;
    check_size("base", base)?;
    check_size("side", side)?;
    check_angle("angle", angle, [0.0, FRAC_PI_2])?;
    check_faces(2 * columns as u128 * rows as u128)?;
    let at = |i: usize, j: usize| i + j * (columns + 1);
    let (sine, cosine) = angle.sin_cos();
    let place = |i, j| {
        let along = side * j as f64;
        [base * i as f64 + cosine * along, sine * along]
    };
    let sheet = cut_quadrilaterals(columns, rows, place, |_, _| true)?;
    let mut creases = Vec::new();
    for j in 0..rows {
        for i in 0..columns {
            creases.push((at(i, j), at(i + 1, j + 1), FoldAssignment::Valley));
            if i > 0 {
                creases.push((at(i, j), at(i, j + 1), FoldAssignment::Mountain));
            }
            if j > 0 {
                creases.push((at(i, j), at(i + 1, j), FoldAssignment::Mountain));
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
        let (base, side, angle) = (0.03, 0.02, 1.1f64);
        let p = kresling(6, 3, base, side, angle).unwrap();
        let t = p.sheet.topology();
        assert_eq!((t.vertex_count(), t.face_count()), (28, 36));
        assert_eq!(check_flat_folding(&p, |_| true), 5 * 2);
        // The law of cosines for the diagonal opposite of the obtuse angle.
        let long = (base * base + side * side + 2.0 * base * side * angle.cos()).sqrt();
        let mut valleys = 0;
        for (e, l) in t.edge_ids().zip(p.sheet.lengths()) {
            match p.assignment(e) {
                FoldAssignment::Valley => {
                    assert!((l - long).abs() < 1e-15);
                    valleys += 1;
                }
                FoldAssignment::Flat => panic!("all triangles are panels"),
                _ => assert!((l - base).abs().min((l - side).abs()) < 1e-15),
            }
        }
        assert_eq!(valleys, 6 * 3);
    }

    #[test]
    fn bad_arguments_are_refused() {
        assert!(kresling(1, 0, 1.0, 1.0, 1.0).is_err());
        let error = kresling(2, 2, 1.0, 1.0, 1.6).unwrap_err();
        assert!(matches!(error, GenerateError::Angle { name: "angle", .. }));
        let error = kresling(2, 2, 1.0, -1.0, 1.0).unwrap_err();
        assert!(matches!(error, GenerateError::Size { name: "side", .. }));
    }
}
