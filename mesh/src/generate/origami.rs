//! Crease patterns of origami, with mountains and valleys.

use super::error::{GenerateError, check_angle, check_count, check_faces, check_size};
use super::grid::cut_quadrilaterals;
use crate::{EdgeId, Sheet, VertexId};
use std::f64::consts::{FRAC_PI_2, PI};

/// What an edge of a crease pattern is meant to do.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum FoldAssignment {
    /// The boundary of the sheet.
    Boundary,
    /// Folds away from the side from which faces are counter-clockwise: a negative fold angle.
    Mountain,
    /// Folds towards that side: a positive fold angle.
    Valley,
    /// Stays flat: an edge inside a panel with more than three corners.
    Flat,
}

impl FoldAssignment {
    /// The sign of the fold angle: -1, 0 or 1.
    pub fn sign(self) -> f64 {
        match self {
            Self::Mountain => -1.0,
            Self::Valley => 1.0,
            Self::Boundary | Self::Flat => 0.0,
        }
    }

    pub(super) fn of_sign(sign: i32) -> Self {
        if sign > 0 {
            Self::Valley
        } else {
            Self::Mountain
        }
    }
}

/// A flat sheet and what its edges are meant to do.
#[derive(Clone, Debug)]
pub struct FoldPattern {
    /// The sheet, flat.
    pub sheet: Sheet,
    /// One entry for each edge.
    pub assignments: Vec<FoldAssignment>,
}

impl FoldPattern {
    /// The assignment of an edge.
    ///
    /// # Panics
    /// If there is no such edge.
    pub fn assignment(&self, e: EdgeId) -> FoldAssignment {
        self.assignments[e.index()]
    }

    /// A sheet whose interior edges are flat but for the creases, given by their ends.
    pub(super) fn new(sheet: Sheet, creases: &[(usize, usize, FoldAssignment)]) -> Self {
        let t = sheet.topology();
        let mut assignments: Vec<FoldAssignment> = t
            .edge_ids()
            .map(|e| {
                if t.is_boundary_edge(e) {
                    FoldAssignment::Boundary
                } else {
                    FoldAssignment::Flat
                }
            })
            .collect();
        for &(a, b, assignment) in creases {
            let e = t.find_edge(VertexId::from_index(a), VertexId::from_index(b));
            assignments[e.expect("creases are edges").index()] = assignment;
        }
        Self { sheet, assignments }
    }
}

/// Miura's pattern, flat: `columns` x `rows` parallelograms with sides `straight` and `zigzag` (metres) and
/// the acute angle `angle` (radians) between them, each cut in two along its shorter diagonal.
///
/// Vertex (i, j) has the index i + j (columns + 1). Its straight creases run along y from (i, j) to (i, j +
/// 1), its zigzag creases from (i, j) to (i + 1, j), where odd i lie `zigzag cos(angle)` further along y.
/// Zigzag j is a valley for even j and a mountain for odd j; the straight crease from (i, j) folds like
/// zigzag j if i is odd and the other way if i is even (Miura, *Method of packaging and deployment of large
/// membranes in space*, Report 618 of the Institute of Space and Astronautical Science, Tokyo, 1985).
///
/// # Errors
/// [`GenerateError`] for a count of zero, a length that is not positive, an angle that is not between 0 and
/// pi/2, or too many faces.
pub fn miura(
    columns: usize,
    rows: usize,
    straight: f64,
    zigzag: f64,
    angle: f64,
) -> Result<FoldPattern, GenerateError> {
    check_count("columns", columns, 1)?;
    check_count("rows", rows, 1)?;
    check_size("straight", straight)?;
    check_size("zigzag", zigzag)?;
    check_angle("angle", angle, [0.0, FRAC_PI_2])?;
    check_faces(2 * columns as u128 * rows as u128)?;
    let at = |i: usize, j: usize| i + j * (columns + 1);
    let (step, shift) = (zigzag * angle.sin(), zigzag * angle.cos());
    let place = |i, j| {
        let y = straight * j as f64 + if i % 2 == 1 { shift } else { 0.0 };
        [step * i as f64, y]
    };
    let sheet = cut_quadrilaterals(columns, rows, place, |i, _| i % 2 == 1)?;
    let mut creases = Vec::new();
    for j in 0..=rows {
        let zigzag = if j % 2 == 0 { 1 } else { -1 };
        for i in 0..=columns {
            if i < columns && j > 0 && j < rows {
                creases.push((at(i, j), at(i + 1, j), FoldAssignment::of_sign(zigzag)));
            }
            if j < rows && i > 0 && i < columns {
                let sign = if i % 2 == 1 { zigzag } else { -zigzag };
                creases.push((at(i, j), at(i, j + 1), FoldAssignment::of_sign(sign)));
            }
        }
    }
    Ok(FoldPattern::new(sheet, &creases))
}

/// The zigzag creases of a pattern that [`miura`] has made: they join neighbours within a row of vertices,
/// and fold twice as far as the panels lean.
pub fn miura_zigzags(pattern: &FoldPattern) -> Vec<EdgeId> {
    let t = pattern.sheet.topology();
    let is_zigzag = |e: &EdgeId| {
        let [a, b] = t.edges()[e.index()].map(VertexId::index);
        a.abs_diff(b) == 1 && pattern.assignment(*e).sign() != 0.0
    };
    t.edge_ids().filter(is_zigzag).collect()
}

/// A vertex of degree four whose sectors `a1, a2, pi - a1, pi - a2` allow it to fold flat (Kawasaki), with
/// rigid triangles of the given radius (metres): vertex 0 in the middle, vertex k at the end of crease k for
/// k = 1 to 4, crease 1 along x.
///
/// Such a vertex has one degree of freedom and two ways to fold from the flat state, which the assignment of
/// the creases tells apart: creases 2 and 4 alike or creases 1 and 3 alike, and the other two unlike.
///
/// # Errors
/// [`GenerateError`] for angles that are not between 0 and pi, a radius that is not positive, or an
/// assignment that is not three of a kind and one of the other (Maekawa).
pub fn degree_four(
    sectors: [f64; 2],
    radius: f64,
    assignments: [FoldAssignment; 4],
) -> Result<FoldPattern, GenerateError> {
    for (name, angle) in ["sectors[0]", "sectors[1]"].into_iter().zip(sectors) {
        check_angle(name, angle, [0.0, PI])?;
    }
    check_size("radius", radius)?;
    let sum: f64 = assignments.iter().map(|a| a.sign()).sum();
    if sum.abs() != 2.0 || assignments.iter().any(|a| a.sign() == 0.0) {
        return Err(GenerateError::Assignment {
            problem: "a vertex of degree four has three creases of a kind and one of the other",
        });
    }
    let [a, b] = sectors;
    let mut positions = vec![0.0; 3];
    for angle in [0.0, a, a + b, PI + b] {
        positions.extend([radius * angle.cos(), radius * angle.sin(), 0.0]);
    }
    let faces = [[0, 1, 2], [0, 2, 3], [0, 3, 4], [0, 4, 1]];
    let sheet = Sheet::new(positions, &faces)?;
    let creases: Vec<_> = assignments
        .into_iter()
        .enumerate()
        .map(|(k, assignment)| (0, k + 1, assignment))
        .collect();
    Ok(FoldPattern::new(sheet, &creases))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_counts_and_lengths_of_miura() {
        let (a, b, angle) = (0.02, 0.03, 1.0);
        let p = miura(4, 6, a, b, angle).unwrap();
        let t = p.sheet.topology();
        assert_eq!((t.vertex_count(), t.face_count()), (35, 48));
        let count = |kind| p.assignments.iter().filter(|k| **k == kind).count();
        assert_eq!(count(FoldAssignment::Boundary), 20);
        assert_eq!(
            count(FoldAssignment::Flat),
            24,
            "one diagonal for each panel"
        );
        assert_eq!(
            count(FoldAssignment::Mountain) + count(FoldAssignment::Valley),
            4 * 5 + 3 * 6
        );
        // Five inner rows of four parts each, all of the length b.
        let zigzags = miura_zigzags(&p);
        assert_eq!(zigzags.len(), 4 * 5);
        let lengths = zigzags.iter().map(|e| p.sheet.lengths()[e.index()]);
        assert!(lengths.map(|l| (l - b).abs()).all(|d| d < 1e-15));
        assert!((p.sheet.area() - 24.0 * a * b * angle.sin()).abs() < 1e-15);
        for (e, l) in t.edge_ids().zip(p.sheet.lengths()) {
            match p.assignment(e) {
                FoldAssignment::Flat => assert!(*l < a.hypot(b), "the shorter diagonal"),
                _ => assert!((l - a).abs() < 1e-15 || (l - b).abs() < 1e-15),
            }
        }
    }

    /// Maekawa: at every interior vertex mountains and valleys differ by two.
    #[test]
    fn miura_folds_flat() {
        let p = miura(5, 4, 0.1, 0.1, 1.2).unwrap();
        let t = p.sheet.topology();
        let mut inside = 0;
        for v in t.vertex_ids().filter(|v| !t.is_boundary_vertex(*v)) {
            let edges = t.vertex_edges(v).iter();
            let sum: f64 = edges.map(|e| p.assignment(*e).sign()).sum();
            assert_eq!(sum.abs(), 2.0, "{v}");
            inside += 1;
        }
        assert_eq!(inside, 12);
    }

    #[test]
    fn what_makes_no_pattern_is_refused() {
        assert!(miura(0, 2, 1.0, 1.0, 1.0).is_err());
        assert!(matches!(
            miura(2, 2, 1.0, 1.0, 1.6),
            Err(GenerateError::Angle { name: "angle", .. })
        ));
        assert!(miura(2, 2, 1.0, 1.0, f64::NAN).is_err());
        use FoldAssignment::{Flat, Mountain, Valley};
        for wrong in [
            [Valley; 4],
            [Valley, Mountain, Valley, Mountain],
            [Valley, Valley, Valley, Flat],
        ] {
            let made = degree_four([1.0, 1.2], 1.0, wrong);
            assert!(matches!(made, Err(GenerateError::Assignment { .. })));
        }
        assert!(degree_four([1.0, 3.2], 1.0, [Valley, Valley, Valley, Mountain]).is_err());
        assert!(degree_four([1.0, 1.2], 1.0, [Valley, Valley, Valley, Mountain]).is_ok());
    }
}
