//! The lines of a drawing of an unrolled sheet.

use super::folds::Fold;
use isosheet_coords::Unrolled;
use isosheet_drawings::{LineClass, Stroke};
use isosheet_dynamics::FaceCurvature;
use isosheet_formats::EdgeAssignment;
use isosheet_mesh::vec3::{Vec3, dot, sub};
use isosheet_mesh::{EdgeId, Ruling, Sheet, VertexId};
use std::collections::{BTreeMap, BTreeSet};

type Point = [f64; 2];

fn place(flat: &Sheet, v: VertexId) -> Point {
    let [x, y, _] = flat.position(v);
    [x, y]
}

/// The outlines of all pieces, closed.
pub(super) fn outlines(flat: &Sheet) -> Vec<Stroke> {
    let loops = flat.topology().boundary_loops().into_iter();
    let outline = |own: Vec<VertexId>| {
        let points = own.iter().chain(own.first()).map(|v| place(flat, *v));
        Stroke {
            points: points.collect(),
            class: LineClass::Cut,
            angle: None,
        }
    };
    loops.map(outline).collect()
}

/// The creases. Those that fold alike and go straight on are one line.
pub(super) fn creases(flat: &Sheet, folds: &[Fold]) -> Vec<Stroke> {
    // Angles have nine digits after the layout: they are alike if these are.
    let key = |fold: &Fold| ((fold.size() * 1e9).round() as u64, class(fold) as u8);
    let mut alike: BTreeMap<_, Vec<&Fold>> = BTreeMap::new();
    for fold in folds.iter().filter(|fold| fold.is_crease) {
        alike.entry(key(fold)).or_default().push(fold);
    }
    let stroke = |own: Vec<&Fold>| {
        let edges: Vec<EdgeId> = own.iter().map(|fold| fold.edge).collect();
        let (class, angle) = (class(own[0]), own[0].angle.map(f64::abs));
        straight(flat, &edges).into_iter().map(move |ends| Stroke {
            points: ends.map(|v| place(flat, v)).to_vec(),
            class,
            angle,
        })
    };
    alike.into_values().flat_map(stroke).collect()
}

fn class(fold: &Fold) -> LineClass {
    match fold.assignment {
        EdgeAssignment::Mountain => LineClass::Mountain,
        EdgeAssignment::Valley => LineClass::Valley,
        EdgeAssignment::Flat => LineClass::Flat,
        _ => LineClass::Crease,
    }
}

/// The ends of the longest straight lines that some edges make.
fn straight(flat: &Sheet, edges: &[EdgeId]) -> Vec<[VertexId; 2]> {
    /// The sine of the angle by which a straight line turns: round-off of layouts.
    const TURN: f64 = 1e-9;
    let t = flat.topology();
    let mut at: BTreeMap<VertexId, Vec<EdgeId>> = BTreeMap::new();
    for &e in edges {
        t.edges()[e.index()]
            .iter()
            .for_each(|v| at.entry(*v).or_default().push(e));
    }
    let direction = |from: VertexId, to: VertexId| {
        let [p, q] = [from, to].map(|v| place(flat, v));
        let d = [q[0] - p[0], q[1] - p[1]];
        let length = d[0].hypot(d[1]);
        d.map(|c| c / length)
    };
    // The edge with which a line goes on at a vertex.
    let next = |e: EdgeId, v: VertexId| {
        let along = direction(t.other_end(e, v), v);
        let mut others = at[&v].iter().copied().filter(|o| *o != e);
        others.find(|o| {
            let onwards = direction(v, t.other_end(*o, v));
            let turn = along[0] * onwards[1] - along[1] * onwards[0];
            turn.abs() < TURN && along[0] * onwards[0] + along[1] * onwards[1] > 0.0
        })
    };
    let mut is_drawn = vec![false; t.edge_count()];
    let mut lines = Vec::new();
    for &first in edges {
        if is_drawn[first.index()] {
            continue;
        }
        is_drawn[first.index()] = true;
        let ends = t.edges()[first.index()].map(|end| {
            let (mut e, mut v) = (first, end);
            while let Some(onwards) = next(e, v).filter(|o| !is_drawn[o.index()]) {
                is_drawn[onwards.index()] = true;
                (e, v) = (onwards, t.other_end(onwards, v));
            }
            v
        });
        lines.push(ends);
    }
    lines
}

/// The rulings of faces that bend along one of their edges.
///
/// Of a face whose corners all lie on outlines and creases the ruling is the edge that folds most and is no
/// crease: as between the quadrilaterals of a strip, the mesh is straight along such edges alone. Of other
/// faces it is a line through the centre, up to the sides of the face, in the direction of the fitted
/// curvature.
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
    let mut is_at_rim: Vec<bool> = t.vertex_ids().map(|v| t.is_boundary_vertex(v)).collect();
    for fold in folds {
        if fold.is_crease {
            let ends = t.edges()[fold.edge.index()];
            ends.iter().for_each(|v| is_at_rim[v.index()] = true);
        } else if fold.is_bent {
            bends[fold.edge.index()] = fold.size();
        }
    }
    let mut edges: BTreeSet<EdgeId> = BTreeSet::new();
    let mut strokes = Vec::new();
    let mut draw = |points: [Point; 2]| {
        strokes.push(Stroke {
            points: points.to_vec(),
            class: LineClass::Ignored,
            angle: None,
        });
    };
    for (f, ruling) in t.face_ids().zip(fitted) {
        let face = t.faces()[f.index()];
        let is_inside = face.iter().any(|v| !is_at_rim[v.index()]);
        let own = t.face_edges(f).into_iter();
        let most = own.max_by(|a, b| bends[a.index()].total_cmp(&bends[b.index()]));
        let Some(most) = most.filter(|e| bends[e.index()] > 0.0) else {
            continue;
        };
        let Some(Ruling { direction, .. }) = ruling.filter(|_| is_inside) else {
            edges.insert(most);
            continue;
        };
        let own = face.map(|v| given.position(unrolled.vertices[v.index()]));
        let corners = face.map(|v| place(flat, v));
        let direction = in_plane(&own, &corners, direction);
        if let Some(points) = direction.and_then(|d| across(&corners, d)) {
            draw(points);
        }
    }
    for e in edges {
        draw(t.edges()[e.index()].map(|v| place(flat, v)));
    }
    strokes
}

/// A direction in the plane of a face in space, in the plane where the face is laid out.
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
    d.iter().all(|c| c.is_finite()).then_some(d)
}

/// Where a line through the centre of a triangle leaves it.
fn across(corners: &[Point; 3], d: Point) -> Option<[Point; 2]> {
    let centre = [0, 1].map(|k| corners.iter().map(|p| p[k]).sum::<f64>() / 3.0);
    let mut range = [f64::NEG_INFINITY, f64::INFINITY];
    for k in 0..3 {
        let [p, q] = [corners[k], corners[(k + 1) % 3]];
        // The distance from the side, inwards, along the line.
        let inwards = [p[1] - q[1], q[0] - p[0]];
        let gap = inwards[0] * (centre[0] - p[0]) + inwards[1] * (centre[1] - p[1]);
        let slope = inwards[0] * d[0] + inwards[1] * d[1];
        let at = -gap / slope;
        if slope > 0.0 {
            range[0] = range[0].max(at);
        } else if slope < 0.0 {
            range[1] = range[1].min(at);
        }
    }
    let ends = range.map(|s| [centre[0] + s * d[0], centre[1] + s * d[1]]);
    ends.iter().flatten().all(|c| c.is_finite()).then_some(ends)
}
