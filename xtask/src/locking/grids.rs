//! The meshes of yardsticks with answers in closed form.

use super::meshes::Pattern;
use anyhow::Result;
use isosheet_mesh::Sheet;
use serde::{Deserialize, Serialize};
use std::f64::consts::FRAC_1_SQRT_2;
use std::fmt;

/// A kind of mesh.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub(super) enum Grid {
    /// Squares with alternating diagonals, with mesh lines across the bend.
    Aligned,
    /// Squares with alternating diagonals, turned by 22.5 degrees.
    UnionJack,
    /// Squares with diagonals in one direction, turned by 22.5 degrees.
    OneWay,
    /// Squares with both diagonals.
    Crossed,
    /// Irregular, with a seed.
    Delaunay(u8),
}

impl Grid {
    pub(super) const ALL: [Self; 7] = [
        Self::Aligned,
        Self::UnionJack,
        Self::OneWay,
        Self::Crossed,
        Self::Delaunay(1),
        Self::Delaunay(2),
        Self::Delaunay(3),
    ];

    /// A flat rectangle (corners `low` and `high`, metres) with squares of the side `cell`.
    pub(super) fn rectangle(self, low: [f64; 2], high: [f64; 2], cell: f64) -> Result<Sheet> {
        let (pattern, cell, degrees) = match self {
            Self::Aligned => (Pattern::UnionJack, cell, 0.0),
            Self::UnionJack => (Pattern::UnionJack, cell, TURNED),
            Self::OneWay => (Pattern::OneWay, cell, TURNED),
            // Squares with both diagonals are smaller squares with alternating ones, turned by 45 degrees.
            Self::Crossed => (Pattern::UnionJack, cell * FRAC_1_SQRT_2, 45.0),
            // The angle of an irregular mesh is no more than a seed.
            Self::Delaunay(seed) => (Pattern::Delaunay, cell, f64::from(seed)),
        };
        pattern.rectangle(low, high, cell, degrees.to_radians())
    }
}

/// Degrees between the mesh and the strip: halfway between two mesh lines of the union jack.
const TURNED: f64 = 22.5;

impl fmt::Display for Grid {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Aligned => f.write_str("aligned"),
            Self::UnionJack => f.write_str("union jack"),
            Self::OneWay => f.write_str("one-way"),
            Self::Crossed => f.write_str("crossed"),
            Self::Delaunay(seed) => write!(f, "Delaunay {seed}"),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Squares with both diagonals: twice as many faces as squares with one.
    #[test]
    fn crossed_squares_have_four_triangles() {
        let count = |grid: Grid| {
            let sheet = grid.rectangle([0.0; 2], [4.0, 1.0], 0.25).unwrap();
            assert!((sheet.area() - 4.0).abs() < 1e-9, "{grid}");
            sheet.topology().face_count()
        };
        assert_eq!(count(Grid::Aligned), 4 * 4 * 4 * 2);
        assert_eq!(count(Grid::Crossed), 4 * 4 * 4 * 4);
    }
}
