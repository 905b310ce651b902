//! Flat rectangles on grids turned against their outline and on irregular meshes, and cuts along lines.

use anyhow::Result;
use isosheet_mesh::generate::Diagonals;
use isosheet_mesh::{FlatCut, Sheet, VertexId, generate};
use serde::{Deserialize, Serialize};
use std::f64::consts::{FRAC_1_SQRT_2, SQRT_2};

/// A kind of mesh.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub(crate) enum Grid {
    /// Squares with alternating diagonals, with mesh lines across the strip.
    #[serde(rename = "aligned")]
    Aligned,
    /// Squares with alternating diagonals, turned by 22.5 degrees, halfway between two mesh lines.
    #[serde(rename = "union jack")]
    UnionJack,
    /// Squares with diagonals in one direction, turned by 22.5 degrees.
    #[serde(rename = "one-way")]
    OneWay,
    /// Squares with both diagonals.
    #[serde(rename = "crossed")]
    Crossed,
    /// Irregular.
    #[serde(rename = "Delaunay 1")]
    Delaunay1,
    #[serde(rename = "Delaunay 2")]
    Delaunay2,
    #[serde(rename = "Delaunay 3")]
    Delaunay3,
}

/// Mean length of the rods of a grid of unit squares with one diagonal each: two sides and one diagonal for
/// every square, (2 + sqrt 2) / 3.
const MEAN_ROD: f64 = (2.0 + SQRT_2) / 3.0;

/// Vertices within this part of the cell of a line are moved onto it before triangles are cut: triangles of a
/// grid are 0.71 cells wide, so that none collapses, and no piece is thinner than this.
pub(crate) const SNAP: f64 = 0.25;

impl Grid {
    pub(crate) const ALL: [Self; 7] = [
        Self::Aligned,
        Self::UnionJack,
        Self::OneWay,
        Self::Crossed,
        Self::Delaunay1,
        Self::Delaunay2,
        Self::Delaunay3,
    ];

    /// Its name in tables.
    pub(crate) fn name(self) -> &'static str {
        match self {
            Self::Aligned => "aligned",
            Self::UnionJack => "union jack",
            Self::OneWay => "one-way",
            Self::Crossed => "crossed",
            Self::Delaunay1 => "Delaunay 1",
            Self::Delaunay2 => "Delaunay 2",
            Self::Delaunay3 => "Delaunay 3",
        }
    }

    /// A flat rectangle (corners `low` and `high`, metres) with squares of the side `cell`; an irregular mesh
    /// has edges of the same mean length. A turned grid is cut along the outline, see [`FlatCut::split`].
    pub(crate) fn rectangle(self, low: [f64; 2], high: [f64; 2], cell: f64) -> Result<Sheet> {
        let [width, height] = [high[0] - low[0], high[1] - low[1]];
        let irregular = |seed| -> Result<Sheet> {
            let outline = [low, [high[0], low[1]], high, [low[0], high[1]]];
            Ok(generate::delaunay(&outline, MEAN_ROD * cell, seed)?)
        };
        let (diagonals, cell, degrees) = match self {
            Self::Aligned => {
                let counts = [width, height].map(|l| (l / cell).round().max(1.0) as usize);
                let grid =
                    generate::grid(counts[0], counts[1], width, height, Diagonals::UnionJack)?;
                return Ok(grid.map_positions(|[x, y, z]| [x + low[0], y + low[1], z])?);
            }
            Self::UnionJack => (Diagonals::UnionJack, cell, 22.5_f64),
            Self::OneWay => (Diagonals::Rising, cell, 22.5),
            // Squares with both diagonals are smaller squares with alternating ones, turned by 45 degrees.
            Self::Crossed => (Diagonals::UnionJack, cell * FRAC_1_SQRT_2, 45.0),
            Self::Delaunay1 => return irregular(11),
            Self::Delaunay2 => return irregular(21),
            Self::Delaunay3 => return irregular(31),
        };
        // A grid about the middle that covers the rectangle at any angle, with an even number of cells so
        // that the middle is a vertex.
        let half = (0.5 * width.hypot(height) / cell).ceil() as usize + 1;
        let side = 2.0 * half as f64 * cell;
        let grid = generate::grid(2 * half, 2 * half, side, side, diagonals)?;
        let (s, c) = degrees.to_radians().sin_cos();
        let middle = [0.5 * (low[0] + high[0]), 0.5 * (low[1] + high[1])];
        let turned = grid.map_positions(|[x, y, z]| {
            let (x, y) = (x - 0.5 * side, y - 0.5 * side);
            [c * x - s * y + middle[0], s * x + c * y + middle[1], z]
        })?;
        let mut flat = FlatCut::of(&turned);
        for (point, normal) in [
            (low, [1.0, 0.0]),
            (low, [0.0, 1.0]),
            (high, [-1.0, 0.0]),
            (high, [0.0, -1.0]),
        ] {
            flat.split(point, normal, SNAP * cell);
            flat.keep(point, normal);
        }
        Ok(flat.sheet()?)
    }
}

/// The mesh cut along the line of the given `x` (metres), parallel to y: it gets vertices on the line and
/// edges along it; vertices within a quarter of the cell are moved onto the line first.
pub(crate) fn with_line(sheet: &Sheet, x: f64, cell: f64) -> Result<Sheet> {
    let mut flat = FlatCut::of(sheet);
    flat.split([x, 0.0], [1.0, 0.0], SNAP * cell);
    Ok(flat.sheet()?)
}

/// The vertices whose positions in the flat sheet pass a test.
pub(crate) fn vertices(sheet: &Sheet, test: impl Fn([f64; 3]) -> bool) -> Vec<VertexId> {
    let all = sheet.topology().vertex_ids();
    all.filter(|v| test(sheet.position(*v))).collect()
}

/// The vertex nearest to a point of a flat sheet.
pub(crate) fn nearest(sheet: &Sheet, target: [f64; 2]) -> VertexId {
    let distance = |v: VertexId| {
        let p = sheet.position(v);
        (p[0] - target[0]).hypot(p[1] - target[1])
    };
    let all = sheet.topology().vertex_ids();
    all.min_by(|a, b| distance(*a).total_cmp(&distance(*b)))
        .unwrap_or(VertexId(0))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn rectangles_have_the_outline_a_line_and_no_slivers() {
        for grid in Grid::ALL {
            for cell in [0.03, 0.015, 0.0075] {
                let sheet = grid.rectangle([-0.03, 0.0], [0.3, 0.06], cell).unwrap();
                let sheet = with_line(&sheet, 0.1, cell).unwrap();
                let text = format!("{grid:?} {cell}");
                assert!((sheet.area() - 0.33 * 0.06).abs() < 1e-9, "{text}");
                assert_eq!(sheet.topology().boundary_loops().len(), 1, "{text}");
                let crossed = sheet.topology().edges().iter().filter(|e| {
                    let [a, b] = e.map(|v| sheet.position(v)[0] - 0.1);
                    a.min(b) < -1e-9 && a.max(b) > 1e-9
                });
                assert_eq!(crossed.count(), 0, "{text}");
                let heights = sheet.topology().faces().iter().zip(sheet.face_areas());
                let thinnest = heights.map(|(f, area)| {
                    let p = f.map(|v| sheet.position(v));
                    let side = |i: usize, j: usize| (p[i][0] - p[j][0]).hypot(p[i][1] - p[j][1]);
                    2.0 * area / side(0, 1).max(side(1, 2)).max(side(2, 0))
                });
                let thinnest = thinnest.fold(f64::INFINITY, f64::min);
                assert!(thinnest > 0.1 * cell, "{text}: {thinnest} m");
            }
        }
    }

    /// Squares with both diagonals: twice as many faces as squares with one.
    #[test]
    fn crossed_squares_have_four_triangles() {
        let count = |grid: Grid| {
            let sheet = grid.rectangle([0.0; 2], [4.0, 1.0], 0.25).unwrap();
            sheet.topology().face_count()
        };
        assert_eq!(count(Grid::Aligned), 4 * 4 * 4 * 2);
        assert_eq!(count(Grid::Crossed), 4 * 4 * 4 * 4);
    }
}
