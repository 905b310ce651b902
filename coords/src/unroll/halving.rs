//! A cut across a disk between two of its faces.

use super::paths::Paths;
use isosheet_mesh::{EdgeId, FaceId, Sheet, VertexId};
use std::collections::VecDeque;

/// The edges of a cut across a disk, from boundary to boundary, which leaves two faces on different sides;
/// `None` if none was found.
///
/// The cut crosses the shortest way from the one to the other through the faces once: at one edge of it, from
/// whose ends the cheapest paths lead to the boundary that do not cross that way. Of all such cuts it is that
/// with the least cost for the area of the smaller side.
pub(super) fn between(sheet: &Sheet, costs: &[f64], faces: [FaceId; 2]) -> Option<Vec<EdgeId>> {
    let t = sheet.topology();
    let way = way(sheet, faces);
    let mut beside = costs.to_vec();
    way.iter().for_each(|e| beside[e.index()] = f64::INFINITY);
    let mut paths = Paths::new(t, &beside);
    let boundary = t.vertex_ids().filter(|v| t.is_boundary_vertex(*v));
    boundary.for_each(|v| paths.start(v));
    paths.reach_all();
    let mut best: Option<(f64, Vec<EdgeId>)> = None;
    for e in way {
        let [one, other] = t.edges()[e.index()].map(|v| paths.back(v));
        let root = |way: &[(EdgeId, VertexId)], k: usize| {
            way.last().map_or(t.edges()[e.index()][k], |last| last.1)
        };
        if root(&one, 0) == root(&other, 1) {
            continue;
        }
        let cut: Vec<EdgeId> = one
            .iter()
            .chain(&other)
            .map(|(e, _)| *e)
            .chain([e])
            .collect();
        let Some(area) = smaller_side(sheet, &cut, faces) else {
            continue;
        };
        let cost: f64 = cut.iter().map(|e| costs[e.index()]).sum();
        if best.as_ref().is_none_or(|(least, _)| cost / area < *least) {
            best = Some((cost / area, cut));
        }
    }
    best.map(|(_, cut)| cut)
}

/// The edges that the way from a face to another one crosses, through as few faces as possible.
fn way(sheet: &Sheet, [from, to]: [FaceId; 2]) -> Vec<EdgeId> {
    let t = sheet.topology();
    let mut before: Vec<Option<(EdgeId, FaceId)>> = vec![None; t.face_count()];
    let mut open = VecDeque::from([from]);
    while let Some(f) = open.pop_front() {
        for e in t.face_edges(f) {
            for next in t.edge_faces(e).into_iter().flatten() {
                if next != from && before[next.index()].is_none() {
                    before[next.index()] = Some((e, f));
                    open.push_back(next);
                }
            }
        }
    }
    let (mut face, mut crossed) = (to, Vec::new());
    while let Some((e, f)) = before[face.index()] {
        crossed.push(e);
        face = f;
    }
    crossed
}

/// The area of the smaller side of a cut that has two faces on different sides.
fn smaller_side(sheet: &Sheet, cut: &[EdgeId], [from, to]: [FaceId; 2]) -> Option<f64> {
    let t = sheet.topology();
    let mut is_cut = vec![false; t.edge_count()];
    cut.iter().for_each(|e| is_cut[e.index()] = true);
    let mut is_reached = vec![false; t.face_count()];
    is_reached[from.index()] = true;
    let (mut open, mut area) = (vec![from], 0.0);
    while let Some(f) = open.pop() {
        area += sheet.face_areas()[f.index()];
        for e in t.face_edges(f).into_iter().filter(|e| !is_cut[e.index()]) {
            for next in t.edge_faces(e).into_iter().flatten() {
                if !std::mem::replace(&mut is_reached[next.index()], true) {
                    open.push(next);
                }
            }
        }
    }
    (!is_reached[to.index()]).then(|| area.min(sheet.area() - area))
}
