//! Flat meshes cut along straight lines.

use crate::{MeshError, Sheet};
use std::collections::HashMap;

/// A flat triangle mesh that is being cut along straight lines of its plane; heights are left out.
///
/// A grid that is turned against the outline of a sheet is made in this way: each side of the outline cuts
/// the grid ([`FlatCut::split`]), and what lies beyond is dropped ([`FlatCut::keep`]).
#[derive(Clone, Debug)]
pub struct FlatCut {
    /// Places of the vertices, metres.
    points: Vec<[f64; 2]>,
    faces: Vec<[u32; 3]>,
}

impl FlatCut {
    /// The mesh of a sheet in the plane z = 0, uncut.
    pub fn of(sheet: &Sheet) -> Self {
        let points = sheet.positions().as_chunks::<3>().0;
        Self {
            points: points.iter().map(|p| [p[0], p[1]]).collect(),
            faces: sheet.face_indices(),
        }
    }

    /// Cuts the triangles that the line through `point` with the unit `normal` crosses. Vertices nearer to
    /// the line than `snap` (metres) are moved onto it first: with a quarter of the side of the squares of a
    /// grid no triangle collapses, and no piece is thinner than `snap`.
    pub fn split(&mut self, point: [f64; 2], normal: [f64; 2], snap: f64) {
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

    /// Drops the triangles on the other side of the line through `point` than `normal` points to. The line
    /// has been cut before: a triangle that it crosses goes by its centre.
    pub fn keep(&mut self, point: [f64; 2], normal: [f64; 2]) {
        let points = &self.points;
        self.faces.retain(|face| {
            let centre = [0, 1].map(|k| face.iter().map(|v| points[*v as usize][k]).sum::<f64>());
            (centre[0] - 3.0 * point[0]) * normal[0] + (centre[1] - 3.0 * point[1]) * normal[1]
                > 0.0
        });
    }

    /// The mesh without vertices that are in no face, and without the triangles that two cuts next to one
    /// another, at a corner, have left without an area.
    ///
    /// # Errors
    /// [`MeshError`] when no face is left or the rest hangs together at a vertex only.
    pub fn sheet(&self) -> Result<Sheet, MeshError> {
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
        Sheet::new(positions, &faces)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::generate::{Diagonals, grid};

    /// A square cut along an oblique line through two of its vertices, and without what lies beyond: areas
    /// are known, and no edge crosses the line.
    #[test]
    fn a_square_loses_a_part() {
        let square = grid(8, 8, 1.0, 1.0, Diagonals::UnionJack).unwrap();
        // From (0, 0.5) to (0.25, 0).
        let norm = 5.0_f64.sqrt();
        let (point, inwards) = ([0.0, 0.5], [2.0 / norm, 1.0 / norm]);
        let mut cut = FlatCut::of(&square);
        cut.split(point, inwards, 1e-9);
        let whole = cut.sheet().unwrap();
        assert!((whole.area() - 1.0).abs() < 1e-12);
        for edge in whole.topology().edges() {
            let [a, b] = edge.map(|v| {
                let [x, y, _] = whole.position(v);
                (x - point[0]) * inwards[0] + (y - point[1]) * inwards[1]
            });
            assert!(a * b > -1e-15, "{a} {b}");
        }
        cut.keep(point, inwards);
        let rest = cut.sheet().unwrap();
        assert!((rest.area() - (1.0 - 0.5 * 0.25 * 0.5)).abs() < 1e-12);
        cut.keep([2.0, 0.0], [1.0, 0.0]);
        assert!(cut.sheet().is_err(), "nothing is left");
    }

    /// Vertices near the line are moved onto it.
    #[test]
    fn near_vertices_are_on_the_line() {
        let square = grid(4, 4, 1.0, 1.0, Diagonals::UnionJack).unwrap();
        let mut cut = FlatCut::of(&square);
        cut.split([0.55, 0.0], [1.0, 0.0], 0.06);
        let moved = cut.sheet().unwrap();
        let count = |sheet: &Sheet| sheet.topology().vertex_count();
        assert_eq!(count(&moved), count(&square));
        let on_line = moved
            .positions()
            .chunks(3)
            .filter(|p| (p[0] - 0.55).abs() < 1e-15);
        assert_eq!(on_line.count(), 5);
    }
}
