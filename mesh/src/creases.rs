//! Straight crease lines through a mesh, and the directions in which it folds.

use std::f64::consts::PI;

use crate::vec3::sub;
use crate::{EdgeId, HalfEdgeId, Sheet, VertexId};

/// How a crease line ends.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum LineEnds {
    /// On the boundary at both ends: the sheet can be folded along it without any other edge bending.
    Through,
    /// At an interior vertex, at one end or both.
    Inside,
    /// Nowhere: it closes on itself (possible on sheets with holes that are not planar).
    Closed,
}

/// A maximal chain of interior edges that runs straight on at every vertex between them.
#[derive(Clone, Debug, PartialEq)]
#[non_exhaustive]
pub struct CreaseLine {
    /// The vertices along the line; the first is repeated at the end of a closed line.
    pub vertices: Vec<VertexId>,
    /// The edges along the line, one fewer than `vertices`.
    pub edges: Vec<EdgeId>,
    /// How it ends.
    pub ends: LineEnds,
    /// Its length, in metres.
    pub length: f64,
    /// Its angle against the x axis in the rest positions, in radians within [0, pi); that of the chord from
    /// its first to its last vertex, as seen from +z.
    pub direction: f64,
}

/// The lines of one direction that run from boundary to boundary.
#[derive(Clone, Copy, Debug, PartialEq)]
#[non_exhaustive]
pub struct FoldingDirection {
    /// The angle against the x axis, in radians within [0, pi).
    pub angle: f64,
    /// The number of lines.
    pub lines: usize,
    /// Their total length, in metres.
    pub length: f64,
}

/// The straight crease lines of a flat sheet (Liu, Tang and Joneja 2007, Sec. 2.3).
///
/// A flat sheet of rigid triangles can be folded along a straight line while all else stays flat if and only
/// if the line consists of edges and runs from boundary to boundary: an edge that ends at an interior vertex
/// without going straight on cannot fold alone. So the lines with [`LineEnds::Through`] are the directions in
/// which the mesh folds.
///
/// The one-way grid has such lines along its rows, its columns and one diagonal, and none along the other
/// diagonal. The union-jack grid has them along rows, columns and both diagonals; [`Self::anisotropy`] puts a
/// number to the difference. An irregular mesh has hardly any.
///
/// ```
/// use isosheet_mesh::{CreasePattern, generate};
/// let degrees = |sheet| -> Vec<i64> {
///     let pattern = CreasePattern::of(&sheet, CreasePattern::TOLERANCE);
///     pattern.folding_directions().iter().map(|d| d.angle.to_degrees().round() as i64).collect()
/// };
/// assert_eq!(degrees(generate::anisotropic_grid(4, 4, 1.0, 1.0)?), [0, 90, 135]);
/// assert_eq!(degrees(generate::isotropic_square(1, 1.0)?), [0, 45, 90, 135]);
/// # Ok::<(), isosheet_mesh::generate::GenerateError>(())
/// ```
#[derive(Clone, Debug, PartialEq)]
pub struct CreasePattern {
    /// All lines; every interior edge is in exactly one.
    pub lines: Vec<CreaseLine>,
    tolerance: f64,
}

impl CreasePattern {
    /// A tolerance in radians that suits sheets made by formula, or read from files with at least seven
    /// digits.
    pub const TOLERANCE: f64 = 1e-5;

    /// Finds the lines of `sheet`. Two edges at an interior vertex are one line when the face angles between
    /// them add up to pi within `tolerance` radians on both sides, which depends on the rest lengths only.
    pub fn of(sheet: &Sheet, tolerance: f64) -> Self {
        let t = sheet.topology();
        let next = continuations(sheet, tolerance);
        let mut seen = vec![false; t.edge_count()];
        let mut lines = Vec::new();
        for e in t.edge_ids() {
            if seen[e.index()] || t.is_boundary_edge(e) {
                continue;
            }
            let start = HalfEdgeId::new(e, 0);
            let (back, closed) = follow(&next, start.twin());
            let mut chain: Vec<HalfEdgeId> = back.into_iter().rev().map(HalfEdgeId::twin).collect();
            if !closed {
                chain.extend(follow(&next, start).0.into_iter().skip(1));
            }
            for h in &chain {
                seen[h.edge().index()] = true;
            }
            let mut vertices: Vec<VertexId> = chain.iter().map(|&h| t.tail(h)).collect();
            vertices.extend(chain.last().map(|&h| t.head(h)));
            let (first, last) = (vertices[0], vertices[vertices.len() - 1]);
            let ends = if closed {
                LineEnds::Closed
            } else if t.is_boundary_vertex(first) && t.is_boundary_vertex(last) {
                LineEnds::Through
            } else {
                LineEnds::Inside
            };
            let edges: Vec<EdgeId> = chain.iter().map(|h| h.edge()).collect();
            let length = edges.iter().map(|e| sheet.lengths()[e.index()]).sum();
            let chord = sub(sheet.position(last), sheet.position(first));
            lines.push(CreaseLine {
                vertices,
                edges,
                ends,
                length,
                direction: undirected(chord[1].atan2(chord[0]), tolerance),
            });
        }
        Self { lines, tolerance }
    }

    /// The lines that run from boundary to boundary.
    pub fn through_lines(&self) -> impl Iterator<Item = &CreaseLine> {
        self.lines.iter().filter(|l| l.ends == LineEnds::Through)
    }

    /// The directions in which the sheet folds, ascending by angle.
    pub fn folding_directions(&self) -> Vec<FoldingDirection> {
        let mut lines: Vec<&CreaseLine> = self.through_lines().collect();
        lines.sort_by(|a, b| a.direction.total_cmp(&b.direction));
        let mut out: Vec<FoldingDirection> = Vec::new();
        for l in lines {
            match out.last_mut() {
                Some(d) if l.direction - d.angle <= self.tolerance => {
                    d.lines += 1;
                    d.length += l.length;
                }
                _ => out.push(FoldingDirection {
                    angle: l.direction,
                    lines: 1,
                    length: l.length,
                }),
            }
        }
        out
    }

    /// How unevenly the fold lines are spread over the directions: |sum l exp(2 i direction)| / sum l over
    /// the lines that run through, between 0 and 1; `None` without such a line.
    ///
    /// This is the relative difference of the eigenvalues of the tensor sum l d d^T. It is 1 when all lines
    /// are parallel, positive for the one-way grid (rows and columns cancel, the diagonals do not) and 0 for
    /// the union-jack square. Zero does not mean that all directions are alike: the union jack still has four
    /// preferred ones.
    pub fn anisotropy(&self) -> Option<f64> {
        let (mut c, mut s, mut total) = (0.0, 0.0, 0.0);
        for l in self.through_lines() {
            c += l.length * (2.0 * l.direction).cos();
            s += l.length * (2.0 * l.direction).sin();
            total += l.length;
        }
        (total > 0.0).then(|| f64::hypot(c, s) / total)
    }
}

/// The half-edge that goes straight on from the head of each interior half-edge.
fn continuations(sheet: &Sheet, tolerance: f64) -> Vec<Option<HalfEdgeId>> {
    let t = sheet.topology();
    let mut next = vec![None; 2 * t.edge_count()];
    let mut angle = Vec::new();
    for v in t.vertex_ids().filter(|&v| !t.is_boundary_vertex(v)) {
        let edges = t.vertex_edges(v);
        // Angle of every edge at v, in its own development: 0 for the first.
        angle.clear();
        let mut sum = 0.0;
        for &f in t.vertex_faces(v) {
            angle.push(sum);
            let corner = t.faces()[f.index()]
                .iter()
                .position(|&w| w == v)
                .unwrap_or(0);
            sum += sheet.corner_angles(f)[corner];
        }
        let outgoing =
            |k: usize| HalfEdgeId::new(edges[k], usize::from(t.edges()[edges[k].index()][0] != v));
        // The angles ascend, so the partner of each edge moves on with it.
        let mut j = 0;
        for i in 0..edges.len() {
            while j < edges.len() && angle[j] < angle[i] + PI - tolerance {
                j += 1;
            }
            if j < edges.len()
                && angle[j] <= angle[i] + PI + tolerance
                && (sum - angle[j] + angle[i] - PI).abs() <= tolerance
            {
                next[outgoing(i).twin().0 as usize] = Some(outgoing(j));
                next[outgoing(j).twin().0 as usize] = Some(outgoing(i));
            }
        }
    }
    next
}

/// Follows a line from a half-edge, which is included; true when it comes back to it.
fn follow(next: &[Option<HalfEdgeId>], start: HalfEdgeId) -> (Vec<HalfEdgeId>, bool) {
    let mut chain = vec![start];
    let mut h = start;
    while let Some(n) = next[h.0 as usize] {
        if n == start {
            return (chain, true);
        }
        chain.push(n);
        h = n;
    }
    (chain, false)
}

/// An angle brought into [0, pi), with what is within the tolerance of pi counted as 0.
fn undirected(angle: f64, tolerance: f64) -> f64 {
    let a = angle.rem_euclid(PI);
    if a >= PI - tolerance { 0.0 } else { a }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::LengthConstraints;
    use crate::generate::{self, Diagonals};

    fn pattern(s: &Sheet) -> CreasePattern {
        let p = CreasePattern::of(s, CreasePattern::TOLERANCE);
        // Every interior edge is in one line, no boundary edge in any.
        let mut count = vec![0; s.topology().edge_count()];
        for l in &p.lines {
            assert_eq!(l.vertices.len(), l.edges.len() + 1);
            for (k, e) in l.edges.iter().enumerate() {
                count[e.index()] += 1;
                assert_eq!(
                    s.topology().find_edge(l.vertices[k], l.vertices[k + 1]),
                    Some(*e)
                );
            }
        }
        for e in s.topology().edge_ids() {
            assert_eq!(
                count[e.index()],
                usize::from(!s.topology().is_boundary_edge(e)),
                "{e}"
            );
        }
        p
    }

    fn directions(s: &Sheet) -> Vec<(i64, usize)> {
        let d = pattern(s).folding_directions();
        d.iter()
            .map(|d| (d.angle.to_degrees().round() as i64, d.lines))
            .collect()
    }

    #[test]
    fn one_way_grids_lack_a_direction_and_union_jacks_do_not() {
        for n in [2, 4, 8] {
            let s = generate::anisotropic_grid(n, n, 1.0, 1.0).unwrap();
            assert_eq!(directions(&s), [(0, n - 1), (90, n - 1), (135, 2 * n - 1)]);
            // Rows and columns cancel; the diagonals are n^2 cells of sqrt 2 / n.
            let diagonal = 2f64.sqrt() * n as f64;
            let expected = diagonal / (diagonal + 2.0 * (n - 1) as f64);
            assert!((pattern(&s).anisotropy().unwrap() - expected).abs() < 1e-12);
        }
        let mirrored = generate::grid(4, 4, 1.0, 1.0, Diagonals::Rising).unwrap();
        assert_eq!(directions(&mirrored), [(0, 3), (45, 7), (90, 3)]);
        for (level, n) in [(0, 2), (1, 4), (2, 8), (3, 16)] {
            let s = generate::isotropic_square(level, 1.0).unwrap();
            assert_eq!(
                directions(&s),
                [(0, n - 1), (45, n - 1), (90, n - 1), (135, n - 1)]
            );
            assert!(pattern(&s).anisotropy().unwrap() < 1e-12);
            assert!(
                pattern(&s)
                    .lines
                    .iter()
                    .all(|l| l.ends == LineEnds::Through)
            );
        }
        // The 1-4 split keeps the one-way pattern one-way (Fig. 1 to Fig. 3).
        let split =
            generate::split_1_4(&generate::anisotropic_grid(2, 2, 1.0, 1.0).unwrap()).unwrap();
        assert_eq!(directions(&split), [(0, 3), (90, 3), (135, 7)]);
    }

    #[test]
    fn irregular_sheets_have_no_lines_through() {
        let s = generate::delaunay_square(1.0, 0.15, 2).unwrap();
        let p = pattern(&s);
        // An edge between two boundary vertices cuts off a corner and is a line of its own.
        assert!(p.through_lines().all(|l| l.edges.len() == 1));
        assert!(p.lines.iter().any(|l| l.ends == LineEnds::Inside));
    }

    #[test]
    fn folding_along_a_line_through_keeps_every_length() {
        let s = generate::isotropic_square(1, 1.0).unwrap();
        let g = LengthConstraints::new(&s);
        let fold_all = |p: &CreasePattern, only: LineEnds| {
            for l in p.lines.iter().filter(|l| l.ends == only) {
                let o = s.position(l.vertices[0]);
                let (dy, dx) = l.direction.sin_cos();
                let (sine, cosine) = 0.8f64.sin_cos();
                let folded: Vec<f64> = s
                    .positions()
                    .chunks_exact(3)
                    .flat_map(|q| {
                        let (u, v) = (q[0] - o[0], q[1] - o[1]);
                        let (along, side) = (u * dx + v * dy, v * dx - u * dy);
                        let (flat, up) = if side > 0.0 {
                            (side * cosine, side * sine)
                        } else {
                            (side, 0.0)
                        };
                        [
                            o[0] + along * dx - flat * dy,
                            o[1] + along * dy + flat * dx,
                            up,
                        ]
                    })
                    .collect();
                assert!(folded.chunks_exact(3).any(|q| q[2] > 0.05));
                assert!(g.max_strain(&folded) < 1e-14, "{l:?}");
            }
        };
        fold_all(&pattern(&s), LineEnds::Through);
    }

    #[test]
    fn closed_lines_on_a_cylinder() {
        // A ring of 2 x 8 cells with a straight middle circle.
        let (n, mut x, mut faces) = (8u32, Vec::new(), Vec::new());
        for j in 0..3 {
            for i in 0..n {
                let (s, c) = (std::f64::consts::TAU * f64::from(i) / f64::from(n)).sin_cos();
                x.extend([c, s, f64::from(j) * 0.5]);
            }
        }
        for j in 0..2 {
            for i in 0..n {
                let (a, b) = (i + n * j, (i + 1) % n + n * j);
                faces.extend([[a, b, b + n], [a, b + n, a + n]]);
            }
        }
        let s = Sheet::new(x, &faces).unwrap();
        assert!(!s.topology().is_closed());
        let p = pattern(&s);
        let closed: Vec<_> = p
            .lines
            .iter()
            .filter(|l| l.ends == LineEnds::Closed)
            .collect();
        assert_eq!(closed.len(), 1);
        assert_eq!(closed[0].edges.len(), 8);
        assert_eq!(closed[0].vertices.first(), closed[0].vertices.last());
        // Rungs and helical diagonals run through.
        assert_eq!(p.lines.len(), 17);
    }

    #[test]
    fn single_hinge_is_a_line() {
        let s = generate::strip(1, 1.0, 1.0, Diagonals::Falling).unwrap();
        assert_eq!(directions(&s), [(135, 1)]);
        assert_eq!(pattern(&s).anisotropy(), Some(1.0));
        let one = generate::fan(1, 1.0, 1.0).unwrap();
        assert_eq!(pattern(&one).anisotropy(), None);
    }
}
