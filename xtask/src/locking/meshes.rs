//! Flat triangulations: grids turned against the outline of the sheet, irregular meshes, and cuts along
//! lines.

use anyhow::Result;
use isosheet_mesh::generate::{self, Diagonals};
use isosheet_mesh::{FlatCut, Sheet, VertexId};
use serde::{Deserialize, Serialize};
use std::fmt;

/// A kind of triangulation.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub(super) enum Pattern {
    /// Squares with alternating diagonals: mesh lines in four directions, 45 degrees apart.
    UnionJack,
    /// Squares with diagonals in one direction: mesh lines in three directions.
    OneWay,
    /// Irregular: no mesh lines.
    Delaunay,
}

impl Pattern {
    pub(super) const ALL: [Self; 3] = [Self::UnionJack, Self::OneWay, Self::Delaunay];

    /// The place in [`Pattern::ALL`], which is the number of the mesh in figures.
    pub(super) fn number(self) -> usize {
        self as usize
    }

    /// A flat rectangle (corners `low` and `high`, metres) with squares of the side `cell`, whose sides are
    /// turned by `angle` (radians) against the x axis; an irregular mesh has edges of the same mean length.
    ///
    /// A turned grid is cut along the outline, see [`FlatCut::split`]. Of an irregular mesh `angle` is no
    /// more than another seed.
    pub(super) fn rectangle(
        self,
        low: [f64; 2],
        high: [f64; 2],
        cell: f64,
        angle: f64,
    ) -> Result<Sheet> {
        let [width, height] = [high[0] - low[0], high[1] - low[1]];
        let diagonals = match self {
            Self::UnionJack => Diagonals::UnionJack,
            Self::OneWay => Diagonals::Rising,
            Self::Delaunay => {
                let outline = [low, [high[0], low[1]], high, [low[0], high[1]]];
                let seed = 1 + (angle.to_degrees() * 10.0).round() as u64;
                return Ok(generate::delaunay(&outline, MEAN_ROD * cell, seed)?);
            }
        };
        if angle == 0.0 {
            let counts = [width, height].map(|l| (l / cell).round().max(1.0) as usize);
            let grid = generate::grid(counts[0], counts[1], width, height, diagonals)?;
            return Ok(grid.map_positions(|[x, y, z]| [x + low[0], y + low[1], z])?);
        }
        // A grid about the middle that covers the rectangle at any angle, with an even number of cells so
        // that the middle is a vertex.
        let half = (0.5 * width.hypot(height) / cell).ceil() as usize + 1;
        let side = 2.0 * half as f64 * cell;
        let grid = generate::grid(2 * half, 2 * half, side, side, diagonals)?;
        let (s, c) = angle.sin_cos();
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

impl fmt::Display for Pattern {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            Self::UnionJack => "union jack",
            Self::OneWay => "one-way",
            Self::Delaunay => "Delaunay",
        })
    }
}

/// Mean length of the rods of a grid of unit squares with one diagonal each: two sides and one diagonal for
/// every square, (2 + sqrt 2) / 3.
const MEAN_ROD: f64 = (2.0 + std::f64::consts::SQRT_2) / 3.0;

/// Vertices within this part of the cell of a line are moved onto it before triangles are cut: triangles of a
/// grid are 0.71 cells wide, so that none collapses, and no piece is thinner than this.
const SNAP: f64 = 0.25;

/// The mesh cut along the line of the given `x` (metres), parallel to y: it gets vertices on the line and
/// edges along it; vertices within a quarter of the cell are moved onto the line first.
pub(super) fn with_line(sheet: &Sheet, x: f64, cell: f64) -> Result<Sheet> {
    let mut flat = FlatCut::of(sheet);
    flat.split([x, 0.0], [1.0, 0.0], SNAP * cell);
    Ok(flat.sheet()?)
}

/// A strip along x, clamped over its part up to x = 0.
#[derive(Clone, Copy, Debug)]
pub(super) struct Strip {
    /// Length of the free part, from x = 0, metres.
    pub(super) free: f64,
    /// Length of the clamped part, metres.
    pub(super) clamped: f64,
    /// Width, metres.
    pub(super) width: f64,
}

impl Strip {
    /// The strip with so many squares across, turned by an angle, and with mesh lines along the clamp.
    pub(super) fn mesh(&self, pattern: Pattern, across: usize, degrees: f64) -> Result<Sheet> {
        let cell = self.width / across as f64;
        let (low, high) = ([-self.clamped, 0.0], [self.free, self.width]);
        let sheet = pattern.rectangle(low, high, cell, degrees.to_radians())?;
        with_line(&sheet, 0.0, cell)
    }

    /// The clamped vertices.
    pub(super) fn clamp(&self, sheet: &Sheet) -> Vec<VertexId> {
        vertices(sheet, |[x, ..]| x < 1e-9)
    }

    /// The vertices of the free edge.
    pub(super) fn tip(&self, sheet: &Sheet) -> Vec<VertexId> {
        vertices(sheet, |[x, ..]| x > self.free - 1e-9)
    }
}

/// The vertices whose positions in the flat sheet pass a test.
pub(super) fn vertices(sheet: &Sheet, test: impl Fn([f64; 3]) -> bool) -> Vec<VertexId> {
    let all = sheet.topology().vertex_ids();
    all.filter(|v| test(sheet.position(*v))).collect()
}

/// The vertex nearest to a point of a flat sheet.
pub(crate) fn nearest(sheet: &Sheet, target: [f64; 2]) -> VertexId {
    let distance = |v: VertexId| {
        let p = sheet.position(v);
        (p[0] - target[0]).hypot(p[1] - target[1])
    };
    sheet
        .topology()
        .vertex_ids()
        .min_by(|a, b| distance(*a).total_cmp(&distance(*b)))
        .unwrap_or(VertexId(0))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn turned_rectangles_have_the_outline_and_no_slivers() {
        for pattern in Pattern::ALL {
            for degrees in [0.0_f64, 15.0, 22.5, 30.0, 45.0] {
                for cell in [0.03, 0.015, 0.0075] {
                    let angle = degrees.to_radians();
                    let sheet = pattern.rectangle([-0.03, 0.0], [0.3, 0.06], cell, angle);
                    let sheet = sheet.unwrap();
                    let text = format!("{pattern} {degrees} {cell}");
                    assert!((sheet.area() - 0.33 * 0.06).abs() < 1e-9, "{text}");
                    assert_eq!(sheet.topology().boundary_loops().len(), 1, "{text}");
                    let heights = sheet.topology().faces().iter().zip(sheet.face_areas());
                    let thinnest = heights.map(|(f, area)| {
                        let p = f.map(|v| sheet.position(v));
                        let side =
                            |i: usize, j: usize| (p[i][0] - p[j][0]).hypot(p[i][1] - p[j][1]);
                        2.0 * area / side(0, 1).max(side(1, 2)).max(side(2, 0))
                    });
                    let thinnest = thinnest.fold(f64::INFINITY, f64::min);
                    assert!(thinnest > 0.1 * cell, "{text}: {thinnest} m");
                    let line = with_line(&sheet, 0.0, cell).unwrap();
                    assert!((line.area() - sheet.area()).abs() < 1e-9, "{text}");
                    let crossed = line.topology().edges().iter().filter(|e| {
                        let [a, b] = e.map(|v| line.position(v)[0]);
                        a.min(b) < -1e-9 && a.max(b) > 1e-9
                    });
                    assert_eq!(crossed.count(), 0, "{text}");
                }
            }
        }
    }

    /// The directions of the long mesh lines are those asked for.
    #[test]
    fn grids_are_turned_by_the_angle() {
        let angle = 30.0_f64.to_radians();
        let sheet = Pattern::OneWay
            .rectangle([0.0; 2], [1.0; 2], 0.1, angle)
            .unwrap();
        let inside = |v: &VertexId| {
            let [x, y, _] = sheet.position(*v);
            (0.2..0.8).contains(&x) && (0.2..0.8).contains(&y)
        };
        for edge in sheet
            .topology()
            .edges()
            .iter()
            .filter(|e| e.iter().all(inside))
        {
            let [p, q] = edge.map(|v| sheet.position(v));
            let direction = (q[1] - p[1]).atan2(q[0] - p[0]) - angle;
            let eighths = direction / std::f64::consts::FRAC_PI_4;
            assert!((eighths - eighths.round()).abs() < 1e-9, "{eighths}");
        }
    }
}
