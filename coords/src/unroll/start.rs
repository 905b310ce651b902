//! Layouts to start from.

use super::vec2::Point;
use isosheet_linalg::{LinalgError, Pattern, SparseLlt};
use isosheet_mesh::{FaceId, Sheet, VertexId};
use std::collections::VecDeque;
use std::f64::consts::TAU;

/// Lays face after face beside one that lies already, with the lengths of its edges, breadth first: exact for
/// what is developable. A vertex lies where its first face has it.
///
/// Each face continues from the corners of the face before, not from vertices that other faces have placed.
/// So the turns of faces add up, and errors grow with the number of faces on the way. (From vertices they
/// would grow by a factor in each column of a long strip.)
pub(super) fn face_by_face(sheet: &Sheet) -> Vec<Point> {
    let t = sheet.topology();
    let length = |a: VertexId, b: VertexId| {
        let edge = t.find_edge(a, b);
        edge.map_or(0.0, |e| sheet.lengths()[e.index()])
    };
    let beyond = |a: VertexId, b: VertexId, c: VertexId, [p, q]: [Point; 2]| {
        third(p, q, [length(a, b), length(b, c), length(c, a)])
    };
    let mut points: Vec<Option<Point>> = vec![None; t.vertex_count()];
    let mut is_laid = vec![false; t.face_count()];
    let first = middle(sheet);
    let [a, b, c] = t.faces()[first.index()];
    let [p, q] = [[0.0; 2], [length(a, b), 0.0]];
    is_laid[first.index()] = true;
    let mut open = VecDeque::from([(first, [p, q, beyond(a, b, c, [p, q])])]);
    while let Some((f, places)) = open.pop_front() {
        let corners = t.faces()[f.index()];
        for (v, place) in corners.iter().zip(places) {
            points[v.index()].get_or_insert(place);
        }
        for k in 0..3 {
            let [a, b] = [k, (k + 1) % 3].map(|k| (corners[k], places[k]));
            let faces = t.find_edge(a.0, b.0).map(|e| t.edge_faces(e));
            for next in faces.into_iter().flatten().flatten() {
                if std::mem::replace(&mut is_laid[next.index()], true) {
                    continue;
                }
                // The neighbour runs along their edge the other way.
                let own = t.faces()[next.index()];
                let Some(k) = own.iter().position(|v| *v != a.0 && *v != b.0) else {
                    continue;
                };
                let mut others = [[0.0; 2]; 3];
                others[(k + 1) % 3] = b.1;
                others[(k + 2) % 3] = a.1;
                others[k] = beyond(b.0, a.0, own[k], [b.1, a.1]);
                open.push_back((next, others));
            }
        }
    }
    points.into_iter().map(Option::unwrap_or_default).collect()
}

/// The corner on the left of the side from `p` to `q` of a triangle with the lengths `pq`, `qr` and `rp`.
fn third(p: Point, q: Point, [pq, qr, rp]: [f64; 3]) -> Point {
    // Of the factors of Heron's formula the differences are formed as Kahan does.
    let mut sides = [pq, qr, rp];
    sides.sort_by(|a, b| b.total_cmp(a));
    let [a, b, c] = sides;
    let product = (a + (b + c)) * (c - (a - b)) * (c + (a - b)) * (a + (b - c));
    let height = 0.5 * product.max(0.0).sqrt() / pq;
    let foot = 0.5 * (pq + (rp - qr) * (rp + qr) / pq);
    let [x, y] = [q[0] - p[0], q[1] - p[1]].map(|c| c / pq);
    [p[0] + foot * x - height * y, p[1] + foot * y + height * x]
}

/// A face in the middle: the last one that is reached from the boundary.
fn middle(sheet: &Sheet) -> FaceId {
    let t = sheet.topology();
    let at_boundary = |f: &FaceId| t.face_edges(*f).iter().any(|e| t.is_boundary_edge(*e));
    let mut open: VecDeque<FaceId> = t.face_ids().filter(at_boundary).collect();
    let mut is_reached = vec![false; t.face_count()];
    open.iter().for_each(|f| is_reached[f.index()] = true);
    let mut last = FaceId(0);
    while let Some(f) = open.pop_front() {
        last = f;
        for e in t.face_edges(f) {
            for next in t.edge_faces(e).into_iter().flatten() {
                if !std::mem::replace(&mut is_reached[next.index()], true) {
                    open.push_back(next);
                }
            }
        }
    }
    last
}

/// The layout of a disk whose boundary is a circle with the area of the sheet, and where each vertex inside
/// is the mean of its neighbours: no face is turned over (Tutte, *How to draw a graph*, 1963).
///
/// # Errors
/// [`LinalgError`] for a sheet without a boundary.
pub(super) fn on_a_disk(sheet: &Sheet) -> Result<Vec<Point>, LinalgError> {
    let t = sheet.topology();
    let loops = t.boundary_loops();
    let length = |own: &[VertexId], k: usize| {
        let edge = t.find_edge(own[k], own[(k + 1) % own.len()]);
        edge.map_or(0.0, |e| sheet.lengths()[e.index()])
    };
    let whole = |own: &[VertexId]| (0..own.len()).map(|k| length(own, k)).sum::<f64>();
    let outer = loops.iter().max_by(|a, b| whole(a).total_cmp(&whole(b)));
    let outer = outer.map_or(&[][..], Vec::as_slice);
    let mut points = vec![[0.0; 2]; t.vertex_count()];
    let mut unknown: Vec<Option<u32>> = vec![None; t.vertex_count()];
    let (radius, turn) = ((2.0 * sheet.area() / TAU).sqrt(), TAU / whole(outer));
    let mut angle = 0.0_f64;
    let mut is_outer = vec![false; t.vertex_count()];
    for (k, v) in outer.iter().enumerate() {
        points[v.index()] = [radius * angle.cos(), radius * angle.sin()];
        is_outer[v.index()] = true;
        angle += turn * length(outer, k);
    }
    let inside: Vec<VertexId> = t.vertex_ids().filter(|v| !is_outer[v.index()]).collect();
    if inside.is_empty() {
        return Ok(points);
    }
    for (k, v) in inside.iter().enumerate() {
        unknown[v.index()] = Some(k as u32);
    }
    let mut entries = Vec::new();
    let mut values = Vec::new();
    let mut sides = [vec![0.0; inside.len()], vec![0.0; inside.len()]];
    for (k, &v) in inside.iter().enumerate() {
        entries.push((k as u32, k as u32));
        values.push(t.degree(v) as f64);
        for w in t.neighbours(v) {
            match unknown[w.index()] {
                Some(j) if j < k as u32 => {
                    entries.push((k as u32, j));
                    values.push(-1.0);
                }
                Some(_) => {}
                None => (0..2).for_each(|axis| sides[axis][k] += points[w.index()][axis]),
            }
        }
    }
    let (pattern, slots) = Pattern::from_entries(inside.len(), inside.len(), &entries);
    let mut matrix = SparseLlt::new(pattern)?;
    for (slot, value) in slots.iter().zip(values) {
        matrix.values_mut()[*slot as usize] += value;
    }
    matrix.factorize()?;
    for (axis, side) in sides.iter_mut().enumerate() {
        matrix.solve(side);
        for (v, value) in inside.iter().zip(side.iter()) {
            points[v.index()][axis] = *value;
        }
    }
    Ok(points)
}
