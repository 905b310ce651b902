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
/// the largest curvature a line goes both ways up to an outline, a crease, a face that does not bend or bends
/// more along the line than across it, or a line that is there; then from the face with the largest curvature
/// that no line passes, and so on. So no two lines cross.
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
    let mut lines = Lines {
        flat,
        is_rim,
        passage: vec![Passage::Flat; t.face_count()],
        is_passed: vec![false; t.face_count()],
        drawn: Vec::new(),
    };
    let mut bent = Vec::new();
    let mut edges = Vec::new();
    for (f, ruling) in t.face_ids().zip(fitted) {
        let face = t.faces()[f.index()];
        let is_inside = face.iter().any(|v| !is_at_rim[v.index()]);
        let own = t.face_edges(f).into_iter();
        let most = own.max_by(|a, b| bends[a.index()].total_cmp(&bends[b.index()]));
        let Some(most) = most.filter(|e| bends[e.index()] > 0.0) else {
            continue;
        };
        lines.passage[f.index()] = Passage::Any;
        if !is_inside {
            edges.push((f, most));
            continue;
        }
        let Some(ruling) = ruling else {
            continue;
        };
        let own = face.map(|v| given.position(unrolled.vertices[v.index()]));
        if let Some(d) = in_plane(&own, &lines.corners(f), ruling.direction) {
            lines.passage[f.index()] = Passage::Along(d);
            bent.push((f, ruling));
        }
    }
    let size = |(_, ruling): &(FaceId, Ruling)| ruling.curvature.abs();
    bent.sort_by(|a, b| size(b).total_cmp(&size(a)));
    bent.iter().for_each(|(f, _)| lines.draw(*f));
    let left = edges.iter().filter(|(f, _)| !lines.is_passed[f.index()]);
    let left: BTreeSet<EdgeId> = left.map(|(_, e)| *e).collect();
    let whole = straight(flat, &left.into_iter().collect::<Vec<_>>()).into_iter();
    let whole = whole.map(|ends| ends.map(|v| place(flat, v)));
    let stroke = |ends: [Point; 2]| Stroke {
        points: ends.to_vec(),
        class: LineClass::Ignored,
        angle: None,
    };
    whole.chain(lines.drawn).map(stroke).collect()
}

/// Which lines a face lets pass.
#[derive(Clone, Copy)]
enum Passage {
    /// None: it does not bend.
    Flat,
    /// All: it bends, and its direction is not known.
    Any,
    /// Lines along which it bends less than across them, with the direction of its own ruling, a unit vector.
    Along(Point),
}

/// The lines in a layout.
struct Lines<'a> {
    flat: &'a Sheet,
    /// The edges at which lines end: outlines and creases.
    is_rim: Vec<bool>,
    passage: Vec<Passage>,
    is_passed: Vec<bool>,
    drawn: Vec<[Point; 2]>,
}

/// A line through the centre of a face.
struct Line {
    ends: [Point; 2],
    faces: Vec<FaceId>,
    /// Whether an end is at an outline, a crease or a face that does not bend, as those of rulings are.
    has_an_end: bool,
}

impl Lines<'_> {
    fn topology(&self) -> &Topology {
        self.flat.topology()
    }

    fn corners(&self, f: FaceId) -> [Point; 3] {
        self.topology().faces()[f.index()].map(|v| place(self.flat, v))
    }

    /// Draws the line through the centre of a face, unless a line has passed it: along the mean direction of
    /// the faces that the line along its own direction passes, up to the lines that are there.
    fn draw(&mut self, f: FaceId) {
        let Passage::Along(own) = self.passage[f.index()] else {
            return;
        };
        if self.is_passed[f.index()] {
            return;
        }
        let Some(first) = self.traced(f, own) else {
            return;
        };
        let mut sum = [0.0, 0.0];
        for f in &first.faces {
            if let Passage::Along([x, y]) = self.passage[f.index()] {
                let sign = (x * own[0] + y * own[1]).signum();
                sum = [sum[0] + sign * x, sum[1] + sign * y];
            }
        }
        let length = sum[0].hypot(sum[1]);
        // A line within a face has no direction to speak of, nor has one between faces that bend otherwise:
        // the curvature changes its sign there.
        let line = self.traced(f, sum.map(|c| c / length));
        if let Some(line) = line.filter(|line| line.faces.len() > 1 && line.has_an_end) {
            line.faces
                .iter()
                .for_each(|f| self.is_passed[f.index()] = true);
            self.drawn.push(line.ends);
        }
    }

    /// The line through the centre of a face in a direction, up to a face or a line that lets it not pass.
    fn traced(&self, first: FaceId, d: Point) -> Option<Line> {
        let corners = self.corners(first);
        let centre = [0, 1].map(|k| corners.iter().map(|p| p[k]).sum::<f64>() / 3.0);
        let mut faces = vec![first];
        let mut ends = [centre; 2];
        let mut has_an_end = false;
        for (end, d) in ends.iter_mut().zip([d, d.map(|c| -c)]) {
            let (mut f, mut reached) = (first, f64::NEG_INFINITY);
            let limit = self.limit(&centre, &d);
            loop {
                let (at, out) = leaves(&self.corners(f), &centre, &d)?;
                // Beside a corner round-off may lead back.
                if at < reached {
                    break;
                }
                reached = at.min(limit);
                if limit < at {
                    break;
                }
                let next = self.beyond(f, out);
                let next = next.filter(|f| !matches!(self.passage[f.index()], Passage::Flat));
                let Some(next) = next else {
                    has_an_end = true;
                    break;
                };
                if !self.lets_pass(next, &d) || faces.contains(&next) {
                    break;
                }
                faces.push(next);
                f = next;
            }
            *end = [0, 1].map(|k| centre[k] + reached * d[k]);
        }
        Some(Line {
            ends,
            faces,
            has_an_end,
        })
    }

    /// How far a ray goes up to the next line.
    fn limit(&self, origin: &Point, d: &Point) -> f64 {
        let crossing = |[p, q]: &[Point; 2]| {
            let side = [q[0] - p[0], q[1] - p[1]];
            let from = [p[0] - origin[0], p[1] - origin[1]];
            let turn = d[0] * side[1] - d[1] * side[0];
            let ray = (from[0] * side[1] - from[1] * side[0]) / turn;
            let part = (from[0] * d[1] - from[1] * d[0]) / turn;
            // (Of parallel lines both are not finite.)
            ((0.0..=1.0).contains(&part) && ray > 0.0).then_some(ray)
        };
        let crossings = self.drawn.iter().filter_map(crossing);
        crossings.fold(f64::INFINITY, f64::min)
    }

    /// The face on the other side of a face's `k`-th side, unless that is an outline or a crease.
    fn beyond(&self, f: FaceId, k: usize) -> Option<FaceId> {
        let t = self.topology();
        let face = t.faces()[f.index()];
        let e = t.find_edge(face[k], face[(k + 1) % 3])?;
        let others = t.edge_faces(e).into_iter().flatten();
        others.filter(|_| !self.is_rim[e.index()]).find(|o| *o != f)
    }

    /// Whether a face lets a line pass. Of the curvature `k` across its ruling it has `k sin^2` along a line
    /// that is turned from the ruling, and `k cos^2` across.
    fn lets_pass(&self, f: FaceId, d: &Point) -> bool {
        match self.passage[f.index()] {
            Passage::Flat => false,
            Passage::Any => true,
            Passage::Along(own) => {
                let cosine = own[0] * d[0] + own[1] * d[1];
                cosine * cosine > 0.5
            }
        }
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
