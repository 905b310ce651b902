//! Flat triangulations: grids turned against the outline of the sheet, irregular meshes, and cuts along
//! lines.

use anyhow::Result;
use isosheet_mesh::generate::{self, Diagonals};
use isosheet_mesh::{Sheet, VertexId};
use serde::{Deserialize, Serialize};
use std::collections::HashMap;
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
    /// A turned grid is cut along the outline, see [`Flat::split`]. Of an irregular mesh `angle` is no more
    /// than another seed.
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
        let mut flat = Flat::of(&turned);
        for (point, normal) in [
            (low, [1.0, 0.0]),
            (low, [0.0, 1.0]),
            (high, [-1.0, 0.0]),
            (high, [0.0, -1.0]),
        ] {
            flat.split(point, normal, SNAP * cell);
            flat.keep_left(point, normal);
        }
        flat.sheet()
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
    let mut flat = Flat::of(sheet);
    flat.split([x, 0.0], [1.0, 0.0], SNAP * cell);
    flat.sheet()
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

/// A flat triangle mesh that is being cut.
struct Flat {
    points: Vec<[f64; 2]>,
    faces: Vec<[u32; 3]>,
}

impl Flat {
    fn of(sheet: &Sheet) -> Self {
        let points = sheet.positions().as_chunks::<3>().0;
        Self {
            points: points.iter().map(|p| [p[0], p[1]]).collect(),
            faces: sheet.face_indices(),
        }
    }

    /// Cuts the triangles that the line through `point` with the unit `normal` crosses. Vertices nearer to
    /// the line than `snap` (metres) are moved onto it first.
    fn split(&mut self, point: [f64; 2], normal: [f64; 2], snap: f64) {
        let side = |p: &[f64; 2]| {
            let d = (p[0] - point[0]) * normal[0] + (p[1] - point[1]) * normal[1];
            if d.abs() < snap { 0.0 } else { d }
        };
        let sides: Vec<f64> = self.points.iter().map(side).collect();
        for (p, s) in self.points.iter_mut().zip(&sides) {
            if *s == 0.0 {
                let d = (p[0] - point[0]) * normal[0] + (p[1] - point[1]) * normal[1];
                *p = [p[0] - d * normal[0], p[1] - d * normal[1]];
            }
        }
        let mut crossings: HashMap<[u32; 2], u32> = HashMap::new();
        let mut faces = Vec::with_capacity(self.faces.len());
        for face in std::mem::take(&mut self.faces) {
            let s = face.map(|v| sides[v as usize]);
            // The corners in order, and a new one on every side of the triangle that the line crosses.
            let mut corners = Vec::with_capacity(5);
            for k in 0..3 {
                let (a, b, sa, sb) = (face[k], face[(k + 1) % 3], s[k], s[(k + 1) % 3]);
                corners.push((a, sa));
                if sa * sb < 0.0 {
                    let crossing = *crossings.entry([a.min(b), a.max(b)]).or_insert_with(|| {
                        let (p, q) = (self.points[a as usize], self.points[b as usize]);
                        let w = sa / (sa - sb);
                        self.points
                            .push([0, 1].map(|i| (1.0 - w) * p[i] + w * q[i]));
                        (self.points.len() - 1) as u32
                    });
                    corners.push((crossing, 0.0));
                }
            }
            for sign in [1.0, -1.0] {
                let part: Vec<u32> = corners
                    .iter()
                    .filter(|(_, s)| sign * s >= 0.0)
                    .map(|(v, _)| *v)
                    .collect();
                let is_on_this_side = corners.iter().any(|(_, s)| sign * s > 0.0);
                if is_on_this_side {
                    self.triangulate(&part, &mut faces);
                }
            }
        }
        self.faces = faces;
    }

    /// A triangle as it is, a quadrilateral cut along its shorter diagonal.
    fn triangulate(&self, corners: &[u32], faces: &mut Vec<[u32; 3]>) {
        let distance = |a: u32, b: u32| {
            let (p, q) = (self.points[a as usize], self.points[b as usize]);
            (p[0] - q[0]).hypot(p[1] - q[1])
        };
        match *corners {
            [a, b, c] => faces.push([a, b, c]),
            [a, b, c, d] if distance(a, c) <= distance(b, d) => {
                faces.extend([[a, b, c], [a, c, d]]);
            }
            [a, b, c, d] => faces.extend([[a, b, d], [b, c, d]]),
            _ => {}
        }
    }

    /// Drops the triangles on the other side of the line through `point` than `normal` points to.
    fn keep_left(&mut self, point: [f64; 2], normal: [f64; 2]) {
        let points = &self.points;
        self.faces.retain(|face| {
            let centre = [0, 1].map(|k| face.iter().map(|v| points[*v as usize][k]).sum::<f64>());
            (centre[0] - 3.0 * point[0]) * normal[0] + (centre[1] - 3.0 * point[1]) * normal[1]
                > 0.0
        });
    }

    /// The mesh without vertices that are in no face, and without the triangles that two cuts next to one
    /// another, at a corner, have left without an area.
    fn sheet(&self) -> Result<Sheet> {
        let mut welded: HashMap<[i64; 2], u32> = HashMap::new();
        let mut positions: Vec<f64> = Vec::new();
        let mut faces = Vec::new();
        for face in &self.faces {
            let [a, b, c] = face.map(|v| self.points[v as usize]);
            let twice = (b[0] - a[0]) * (c[1] - a[1]) - (b[1] - a[1]) * (c[0] - a[0]);
            let longest = [(a, b), (b, c), (c, a)]
                .map(|(p, q)| (p[0] - q[0]).hypot(p[1] - q[1]))
                .into_iter()
                .fold(0.0, f64::max);
            if twice <= 1e-9 * longest * longest {
                continue;
            }
            faces.push([a, b, c].map(|p| {
                // Places that differ by round-off only are one vertex.
                let key = p.map(|x| (x * 1e9).round() as i64);
                *welded.entry(key).or_insert_with(|| {
                    positions.extend([p[0], p[1], 0.0]);
                    (positions.len() / 3 - 1) as u32
                })
            }));
        }
        Ok(Sheet::new(positions, &faces)?)
    }
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
