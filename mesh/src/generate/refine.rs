//! Refinement of any sheet by splitting every face into four.

use super::error::{GenerateError, check_faces};
use crate::{Sheet, Topology};

/// How a face is cut into four once a vertex sits in the middle of each of its edges.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum FaceSplit {
    /// Join the three midpoints.
    OneToFour,
    /// Join the midpoint of edge k of the face to the opposite corner and to the other two midpoints.
    Bisect(usize),
}

/// The 1-4 split of Liu, Tang and Joneja 2007, Fig. 1: every edge is halved and the midpoints of each face
/// are joined.
///
/// Vertex V + e of the result is the midpoint of edge e; faces 4f to 4f + 3 replace face f, the last being
/// the middle one. V' = V + E, E' = 2E + 3F, F' = 4F. All four parts are similar to the face, so a one-way
/// pattern stays one.
///
/// # Errors
/// [`GenerateError::TooManyFaces`].
pub fn split_1_4(sheet: &Sheet) -> Result<Sheet, GenerateError> {
    split(sheet, |_| FaceSplit::OneToFour)
}

/// Refinement that carries the isotropic square M^k to M^(k+1) (Liu, Tang and Joneja 2007, Fig. 4), for any
/// sheet.
///
/// Every edge is halved; in each face the midpoint of the longest edge is joined to the opposite corner and
/// to the other two midpoints, which is bisecting the face and then both halves. The counts are as in
/// [`split_1_4`], but every old vertex now has twice its degree, because a crease runs from it into every
/// face around it. Where two edges of a face have the same length within 1e-9, the lower edge index counts as
/// the longer.
///
/// # Errors
/// [`GenerateError::TooManyFaces`].
pub fn refine_isotropic(sheet: &Sheet) -> Result<Sheet, GenerateError> {
    /// Equal lengths differ by round-off only; without a margin the choice would depend on it.
    const TIE: f64 = 1e-9;
    let t = sheet.topology();
    split(sheet, |f| {
        let edges = t.face_edges(crate::FaceId::from_index(f));
        let mut order = [0, 1, 2];
        order.sort_by_key(|&k| edges[k]);
        let length = |k: usize| sheet.lengths()[edges[k].index()];
        let longest = order.into_iter().reduce(|best, k| {
            if length(k) > length(best) * (1.0 + TIE) {
                k
            } else {
                best
            }
        });
        FaceSplit::Bisect(longest.unwrap_or(0))
    })
}

fn split(sheet: &Sheet, pattern: impl Fn(usize) -> FaceSplit) -> Result<Sheet, GenerateError> {
    let t = sheet.topology();
    check_faces(4 * t.face_count() as u128)?;
    let mut positions = sheet.positions().to_vec();
    for &[a, b] in t.edges() {
        let (p, q) = (sheet.position(a), sheet.position(b));
        positions.extend([0, 1, 2].map(|k| 0.5 * p[k] + 0.5 * q[k]));
    }
    Ok(Sheet::new(positions, &split_faces(t, pattern))?)
}

/// The faces of the refined mesh; vertex V + e is the midpoint of edge e.
pub(crate) fn split_faces(t: &Topology, pattern: impl Fn(usize) -> FaceSplit) -> Vec<[u32; 3]> {
    let n = t.vertex_count() as u32;
    let mut faces = Vec::with_capacity(4 * t.face_count());
    for f in t.face_ids() {
        let c = t.faces()[f.index()].map(|v| v.0);
        // m[i] lies between corners i and i + 1.
        let m = t.face_edges(f).map(|e| n + e.0);
        match pattern(f.index()) {
            FaceSplit::OneToFour => {
                faces.extend([
                    [c[0], m[0], m[2]],
                    [m[0], c[1], m[1]],
                    [m[2], m[1], c[2]],
                    [m[0], m[1], m[2]],
                ]);
            }
            FaceSplit::Bisect(k) => {
                let (a, b, apex) = (c[k], c[(k + 1) % 3], c[(k + 2) % 3]);
                let (base, right, left) = (m[k], m[(k + 1) % 3], m[(k + 2) % 3]);
                faces.extend([
                    [a, base, left],
                    [base, b, right],
                    [base, right, apex],
                    [base, apex, left],
                ]);
            }
        }
    }
    faces
}

#[cfg(test)]
mod tests {
    use std::collections::BTreeSet;

    use super::*;
    use crate::generate::{Diagonals, grid, isotropic_square};

    /// Faces as sets of corner positions on a fine integer lattice, to compare meshes with other numbering.
    fn faces_by_place(s: &Sheet) -> BTreeSet<[[i64; 2]; 3]> {
        let faces = s.topology().faces().iter().map(|f| {
            let mut c = f.map(|v| {
                let p = s.position(v);
                [
                    (p[0] * 1024.0).round() as i64,
                    (p[1] * 1024.0).round() as i64,
                ]
            });
            c.sort_unstable();
            c
        });
        faces.collect()
    }

    #[test]
    fn isotropic_refinement_climbs_the_levels() {
        let mut s = isotropic_square(0, 1.0).unwrap();
        for level in 1..=4 {
            s = refine_isotropic(&s).unwrap();
            s.topology().check_invariants();
            assert_eq!(
                faces_by_place(&s),
                faces_by_place(&isotropic_square(level, 1.0).unwrap()),
                "M^{level}"
            );
        }
    }

    #[test]
    fn one_to_four_keeps_the_one_way_pattern_but_not_the_union_jack() {
        let coarse = grid(2, 2, 1.0, 1.0, Diagonals::Falling).unwrap();
        let fine = grid(4, 4, 1.0, 1.0, Diagonals::Falling).unwrap();
        let split = split_1_4(&coarse).unwrap();
        split.topology().check_invariants();
        assert_eq!(faces_by_place(&split), faces_by_place(&fine));
        let jack = split_1_4(&isotropic_square(0, 1.0).unwrap()).unwrap();
        assert_ne!(
            faces_by_place(&jack),
            faces_by_place(&isotropic_square(1, 1.0).unwrap())
        );
    }

    #[test]
    fn counts_and_area_of_a_split() {
        let s = crate::generate::annulus(7, 2, 0.3, 1.0).unwrap();
        let (v, e, f) = (
            s.topology().vertex_count(),
            s.topology().edge_count(),
            s.topology().face_count(),
        );
        for fine in [split_1_4(&s).unwrap(), refine_isotropic(&s).unwrap()] {
            let t = fine.topology();
            t.check_invariants();
            assert_eq!(
                (t.vertex_count(), t.edge_count(), t.face_count()),
                (v + e, 2 * e + 3 * f, 4 * f)
            );
            assert!((fine.area() - s.area()).abs() < 1e-14);
        }
    }
}
