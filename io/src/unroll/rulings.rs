//! The rulings of an unrolled sheet.

use super::folds::Fold;
use super::strokes::{Point, place, straight};
use isosheet_coords::Unrolled;
use isosheet_drawings::{LineClass, Stroke};
use isosheet_dynamics::FaceCurvature;
use isosheet_mesh::vec3::{Vec3, dot, sub};
use isosheet_mesh::{EdgeId, FaceId, Ruling, Sheet, Topology};
use std::collections::BTreeSet;

/// The rulings of a sheet that bends, as straight lines of its layout.
///
/// Of a face whose corners all lie on outlines and creases the ruling is the edge that folds most and is no
/// crease: as between the quadrilaterals of a strip, the mesh is straight along such edges alone. Edges that
/// go straight on are one line. Other faces have the direction of their fitted curvature. From the face with
/// the largest curvature a line goes both ways up to an outline, a crease, or a face that is bent more along
/// the line than across it; then from the face with the largest curvature that no line passes, and so on.
pub(super) fn rulings(given: &Sheet, unrolled: &Unrolled, folds: &[Fold]) -> Vec<Stroke> {
    let flat = &unrolled.flat;
    let t = flat.topology();
    let creases: Vec<EdgeId> = folds
        .iter()
        .filter(|f| f.is_crease)
        .map(|f| f.edge)
        .collect();
    let x: Vec<f64> = unrolled
        .vertices
        .iter()
        .flat_map(|v| given.position(*v))
        .collect();
    let fitted = FaceCurvature::new(flat, &[], &creases).map(|curvature| curvature.rulings(&x));
    let fitted = fitted.unwrap_or_else(|_| vec![None; t.face_count()]);
    let mut bends = vec![0.0; t.edge_count()];
    let mut is_rim: Vec<bool> = t.edge_ids().map(|e| t.is_boundary_edge(e)).collect();
    let mut is_at_rim: Vec<bool> = t.vertex_ids().map(|v| t.is_boundary_vertex(v)).collect();
    for fold in folds {
        if fold.is_crease {
            is_rim[fold.edge.index()] = true;
            let ends = t.edges()[fold.edge.index()];
            ends.iter().for_each(|v| is_at_rim[v.index()] = true);
        } else if fold.is_bent {
            bends[fold.edge.index()] = fold.size();
        }
    }
    let mut edges: BTreeSet<EdgeId> = BTreeSet::new();
    let mut lines = Lines {
        flat,
        is_rim,
        direction: vec![None; t.face_count()],
        is_passed: vec![false; t.face_count()],
    };
    let mut bent = Vec::new();
    for (f, ruling) in t.face_ids().zip(fitted) {
        let face = t.faces()[f.index()];
        let is_inside = face.iter().any(|v| !is_at_rim[v.index()]);
        let own = t.face_edges(f).into_iter();
        let most = own.max_by(|a, b| bends[a.index()].total_cmp(&bends[b.index()]));
        let Some(most) = most.filter(|e| bends[e.index()] > 0.0) else {
            continue;
        };
        let Some(ruling) = ruling.filter(|_| is_inside) else {
            edges.insert(most);
            continue;
        };
        let own = face.map(|v| given.position(unrolled.vertices[v.index()]));
        lines.direction[f.index()] = in_plane(&own, &lines.corners(f), ruling.direction);
        bent.push((f, ruling));
    }
    let edges: Vec<EdgeId> = edges.into_iter().collect();
    let whole = straight(flat, &edges).into_iter();
    let mut found: Vec<[Point; 2]> = whole.map(|ends| ends.map(|v| place(flat, v))).collect();
    let size = |(_, ruling): &(FaceId, Ruling)| ruling.curvature.abs();
    bent.sort_by(|a, b| size(b).total_cmp(&size(a)));
    found.extend(bent.iter().filter_map(|(f, _)| lines.through(*f)));
    let stroke = |ends: [Point; 2]| Stroke {
        points: ends.to_vec(),
        class: LineClass::Ignored,
        angle: None,
    };
    found.into_iter().map(stroke).collect()
}

/// The directions of faces in the layout, and what lines have passed.
struct Lines<'a> {
    flat: &'a Sheet,
    /// The edges at which lines end: outlines and creases.
    is_rim: Vec<bool>,
    /// Of each face that has a ruling, a unit vector.
    direction: Vec<Option<Point>>,
    is_passed: Vec<bool>,
}

impl Lines<'_> {
    fn topology(&self) -> &Topology {
        self.flat.topology()
    }

    fn corners(&self, f: FaceId) -> [Point; 3] {
        self.topology().faces()[f.index()].map(|v| place(self.flat, v))
    }

    /// The line through the centre of a face, if no line has passed it: along the mean direction of the
    /// faces that the line along its own direction passes.
    fn through(&mut self, f: FaceId) -> Option<[Point; 2]> {
        let own = self.direction[f.index()].filter(|_| !self.is_passed[f.index()])?;
        let (_, passed) = self.traced(f, own)?;
        let along = passed.iter().filter_map(|f| self.direction[f.index()]);
        let sum = along.fold([0.0, 0.0], |[x, y], d| {
            let sign = (d[0] * own[0] + d[1] * own[1]).signum();
            [x + sign * d[0], y + sign * d[1]]
        });
        let length = sum[0].hypot(sum[1]);
        let (ends, passed) = self.traced(f, sum.map(|c| c / length))?;
        // A line within a face beside an outline has no direction to speak of.
        if passed.len() == 1 {
            return None;
        }
        for f in passed {
            self.is_passed[f.index()] = true;
        }
        Some(ends)
    }

    /// The ends of a line through the centre of a face, and the faces that it passes.
    fn traced(&self, first: FaceId, d: Point) -> Option<([Point; 2], Vec<FaceId>)> {
        let corners = self.corners(first);
        let centre = [0, 1].map(|k| corners.iter().map(|p| p[k]).sum::<f64>() / 3.0);
        let mut passed = vec![first];
        let mut ends = [centre; 2];
        for (end, d) in ends.iter_mut().zip([d, d.map(|c| -c)]) {
            let (mut f, mut reached) = (first, f64::NEG_INFINITY);
            loop {
                let (at, out) = leaves(&self.corners(f), &centre, &d)?;
                // Beside a corner round-off may lead back.
                if at < reached {
                    break;
                }
                reached = at;
                let next = self.beyond(f, out).filter(|f| self.is_along(*f, &d));
                let Some(next) = next.filter(|f| !passed.contains(f)) else {
                    break;
                };
                passed.push(next);
                f = next;
            }
            *end = [0, 1].map(|k| centre[k] + reached * d[k]);
        }
        Some((ends, passed))
    }

    /// The face on the other side of a face's `k`-th side, unless that is an outline or a crease.
    fn beyond(&self, f: FaceId, k: usize) -> Option<FaceId> {
        let t = self.topology();
        let face = t.faces()[f.index()];
        let e = t.find_edge(face[k], face[(k + 1) % 3])?;
        let others = t.edge_faces(e).into_iter().flatten();
        others.filter(|_| !self.is_rim[e.index()]).find(|o| *o != f)
    }

    /// Whether a face is bent less along a line than across it: of the curvature `k` across the ruling it has
    /// `k sin^2` along a line that is turned from the ruling, and `k cos^2` across.
    fn is_along(&self, f: FaceId, d: &Point) -> bool {
        self.direction[f.index()].is_some_and(|own| {
            let cosine = own[0] * d[0] + own[1] * d[1];
            cosine * cosine > 0.5
        })
    }
}

/// A direction in the plane of a face in space, as a unit vector in the plane where the face is laid out.
fn in_plane(own: &[Vec3; 3], corners: &[Point; 3], direction: Vec3) -> Option<Point> {
    let [u, v] = [sub(own[1], own[0]), sub(own[2], own[0])];
    let [uu, uv, vv] = [dot(u, u), dot(u, v), dot(v, v)];
    let [du, dv] = [dot(direction, u), dot(direction, v)];
    let determinant = uu * vv - uv * uv;
    let [a, b] = [
        (vv * du - uv * dv) / determinant,
        (uu * dv - uv * du) / determinant,
    ];
    let side = |k: usize, axis: usize| corners[k][axis] - corners[0][axis];
    let d = [0, 1].map(|axis| a * side(1, axis) + b * side(2, axis));
    let length = d[0].hypot(d[1]);
    length.is_normal().then(|| d.map(|c| c / length))
}

/// Where a line `origin + s d` leaves a triangle, and through which side.
fn leaves(corners: &[Point; 3], origin: &Point, d: &Point) -> Option<(f64, usize)> {
    // The triangle may be laid out either way round.
    let [a, b, c] = corners;
    let turn = (b[0] - a[0]) * (c[1] - a[1]) - (b[1] - a[1]) * (c[0] - a[0]);
    let way = turn.signum();
    let side = |k: usize| {
        let [p, q] = [corners[k], corners[(k + 1) % 3]];
        // The distance from the side, inwards, and how it grows along the line.
        let inwards = [way * (p[1] - q[1]), way * (q[0] - p[0])];
        let gap = inwards[0] * (origin[0] - p[0]) + inwards[1] * (origin[1] - p[1]);
        let slope = inwards[0] * d[0] + inwards[1] * d[1];
        (slope < 0.0).then(|| (-gap / slope, k))
    };
    let sides = (0..3).filter_map(side);
    sides
        .min_by(|a, b| a.0.total_cmp(&b.0))
        .filter(|(at, _)| at.is_finite())
}
