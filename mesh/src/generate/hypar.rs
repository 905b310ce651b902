//! The pleated hyperbolic paraboloid.

use super::error::{GenerateError, check_count, check_faces, check_size};
use super::origami::{FoldAssignment, FoldPattern};
use crate::Sheet;

/// The pleated hyperbolic paraboloid (hypar), flat: a square about the origin with the given side (metres)
/// and `rings` concentric squares with the sides `side k / rings`, k = 1 to `rings`, the last of which is
/// the boundary.
///
/// Corner c of square k has the index `4 (k - 1) + c`, with c = 0 to 3 counter-clockwise from the lower
/// left. Square k is a mountain for odd k and a valley for even k; the diagonals between the squares k and
/// k + 1 fold the other way than square k + 1. The innermost square has one diagonal, from corner 0 to
/// corner 2, since two straight creases that cross cannot fold together.
///
/// The trapezoids between two squares are cut in two, in one sense of rotation between even squares and in
/// the other one between odd ones, and these cuts are flat edges: a sheet whose trapezoids stay flat does not
/// fold at all (Demaine, Demaine, Hart, Price and Tachi, *(Non)existence of pleated folds: how paper folds
/// between creases*, Graphs and Combinatorics 27, 2011, 377-397, which has the pattern and the alternating
/// triangulation). At every corner of the squares 2 to `rings - 1` the sectors are 45, 45, 135 and 135
/// degrees, and the corner can be folded flat; the corners 1 and 3 of the innermost square cannot, since they
/// have three creases.
///
/// # Errors
/// [`GenerateError`] for no ring, a length that is not positive, or too many faces.
pub fn hypar(rings: usize, side: f64) -> Result<FoldPattern, GenerateError> {
    check_count("rings", rings, 1)?;
    check_size("side", side)?;
    check_faces(8 * rings as u128)?;
    let fold = |k: usize| FoldAssignment::of_sign(if k % 2 == 1 { -1 } else { 1 });
    let at = |k: usize, c: usize| 4 * (k - 1) + c % 4;
    let mut positions = Vec::with_capacity(12 * rings);
    for k in 1..=rings {
        let half = 0.5 * side * (k as f64 / rings as f64);
        for [x, y] in [[-1.0, -1.0], [1.0, -1.0], [1.0, 1.0], [-1.0, 1.0]] {
            positions.extend([half * x, half * y, 0.0]);
        }
    }
    let mut faces = vec![[0, 1, 2], [0, 2, 3]];
    let mut creases = vec![(0, 2, fold(2))];
    for k in 1..rings {
        for c in 0..4 {
            let corners = [at(k + 1, c), at(k + 1, c + 1), at(k, c + 1), at(k, c)];
            creases.push((corners[2], corners[3], fold(k)));
            creases.push((corners[0], corners[3], fold(k)));
            let [a, b, d, e] = corners.map(|v| v as u32);
            if k % 2 == 1 {
                faces.extend([[a, b, d], [a, d, e]]);
            } else {
                faces.extend([[a, b, e], [b, d, e]]);
            }
        }
    }
    let sheet = Sheet::new(positions, &faces)?;
    Ok(FoldPattern::new(sheet, &creases))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::VertexId;
    use crate::tests::flat_folding::check_flat_folding;

    #[test]
    fn counts_lengths_and_flat_folding() {
        for rings in [1, 2, 5, 8] {
            let p = hypar(rings, 0.2).unwrap();
            let t = p.sheet.topology();
            assert_eq!(t.vertex_count(), 4 * rings);
            assert_eq!(t.face_count(), 2 + 8 * (rings - 1));
            assert!((p.sheet.area() - 0.04).abs() < 1e-15);
            let folds_flat = |v: VertexId| v.index() != 1 && v.index() != 3;
            let inner = if rings == 1 { 0 } else { 4 * (rings - 1) - 2 };
            assert_eq!(check_flat_folding(&p, folds_flat), inner);
            let flat = p.assignments.iter().filter(|a| **a == FoldAssignment::Flat);
            assert_eq!(flat.count(), 4 * (rings - 1), "one for each trapezoid");
        }
    }

    /// Neighbouring squares, and neighbouring parts of a diagonal, fold to different sides.
    #[test]
    fn pleats_alternate() {
        let p = hypar(5, 1.0).unwrap();
        let t = p.sheet.topology();
        let sign = |a: usize, b: usize| {
            let [a, b] = [a, b].map(VertexId::from_index);
            p.assignment(t.find_edge(a, b).unwrap()).sign()
        };
        for k in 0..4 {
            let first = 4 * k;
            let expected = if k % 2 == 0 { -1.0 } else { 1.0 };
            for c in 0..4 {
                assert_eq!(sign(first + c, first + (c + 1) % 4), expected);
                assert_eq!(sign(first + c, first + 4 + c), expected);
            }
        }
        assert_eq!(sign(0, 2), 1.0);
    }

    #[test]
    fn bad_arguments_are_refused() {
        assert!(hypar(0, 1.0).is_err());
        let error = hypar(3, f64::INFINITY).unwrap_err();
        assert!(matches!(error, GenerateError::Size { name: "side", .. }));
    }
}
