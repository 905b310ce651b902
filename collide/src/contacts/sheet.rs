//! The pairs of the sheet with itself.

use super::limit::{Limit, for_each_near};
use super::motion::SheetMotion;
use super::neighbours::Neighbours;
use isosheet_dynamics::contact::{ContactKey, ContactKind};
use isosheet_geometry::distance::{edge_edge, point_triangle};
use isosheet_geometry::vectors::gather;
use nalgebra::Vector3;

fn key(kind: ContactKind, pair: [u32; 2]) -> ContactKey {
    ContactKey {
        body: None,
        kind,
        pair,
    }
}

/// Appends the pairs of the sheet with itself within reach on a motion and shortens the part of it that
/// brings nothing into contact. `neighbours` belong to the motion; `near` is room.
pub(super) fn query(
    sheet: SheetMotion<'_>,
    neighbours: &Neighbours,
    limit: &Limit,
    near: &mut Vec<bool>,
    pairs: &mut Vec<ContactKey>,
) {
    let boxes = neighbours.boxes();
    let SheetMotion { mesh, x, dx, .. } = sheet;
    let is_near = |(_, pair): (f64, [u32; 2])| {
        if !boxes.vertex_meets_face(boxes, pair) {
            return false;
        }
        let vertices = mesh.vertex_face(pair);
        let clearance = sheet.of_pair(vertices);
        let (places, steps) = (gather(x, vertices), gather(dx, vertices));
        let closer = approach(&steps, 1);
        let [p, a, b, c] = places;
        let directions = [(a - p) + (b - p) + (c - p), (b - a).cross(&(c - a))];
        if are_apart(&places, 1, &directions, clearance.reach + closer) {
            return false;
        }
        let nearest = point_triangle(&places).distance() - closer;
        if nearest <= clearance.trigger_distance() || nearest.is_nan() {
            let ccd = clearance.ccd(sheet.ccd);
            limit.shorten(|limit| ccd.point_triangle(&places, &steps, limit));
        }
        nearest <= clearance.reach || nearest.is_nan()
    };
    let kind = ContactKind::VertexFace;
    for_each_near(neighbours.vertex_face(), near, is_near, |(_, pair)| {
        pairs.push(key(kind, pair));
    });
    let is_near = |(_, pair): (f64, [u32; 2])| {
        // The faces that an edge is a side of look after points.
        let [first, second] = pair;
        let is_flat = |e: u32| !mesh.is_round(mesh.edges()[e as usize][0]);
        if mesh.is_point(first) && is_flat(second) || mesh.is_point(second) && is_flat(first) {
            return false;
        }
        if !boxes.edge_meets_edge(boxes, pair) {
            return false;
        }
        let vertices = mesh.edge_edge(pair);
        let clearance = sheet.of_pair(vertices);
        let (places, steps) = (gather(x, vertices), gather(dx, vertices));
        let closer = approach(&steps, 2);
        let [a, b, c, d] = places;
        let directions = [(c - a) + (d - b), (b - a).cross(&(d - c))];
        if are_apart(&places, 2, &directions, clearance.reach + closer) {
            return false;
        }
        let nearest = edge_edge(&places).distance() - closer;
        if nearest <= clearance.trigger_distance() || nearest.is_nan() {
            let ccd = clearance.ccd(sheet.ccd);
            limit.shorten(|limit| ccd.edge_edge(&places, &steps, limit));
        }
        nearest <= clearance.reach || nearest.is_nan()
    };
    let kind = ContactKind::EdgeEdge;
    for_each_near(neighbours.edge_edge(), near, is_near, |(_, pair)| {
        pairs.push(key(kind, pair));
    });
}

/// Bound on how much closer two primitives come: the largest displacements of the points of both
/// relative to their common displacement. The first `split` points are the first primitive.
fn approach(steps: &[Vector3<f64>; 4], split: usize) -> f64 {
    let common = 0.25 * (steps[0] + steps[1] + steps[2] + steps[3]);
    let largest = |steps: &[Vector3<f64>]| {
        let squares = steps.iter().map(|d| (d - common).norm_squared());
        squares.fold(0.0, f64::max).sqrt()
    };
    largest(&steps[..split]) + largest(&steps[split..])
}

/// Whether one of the directions alone shows that two primitives are further apart than `bound`: a
/// tenth of the cost of their distance, and enough for most pairs whose boxes overlap.
fn are_apart(
    places: &[Vector3<f64>; 4],
    split: usize,
    directions: &[Vector3<f64>; 2],
    bound: f64,
) -> bool {
    directions.iter().any(|n| {
        let height = places.map(|p| n.dot(&(p - places[0])));
        let range = |list: &[f64]| {
            let low = list.iter().copied().fold(f64::INFINITY, f64::min);
            (low, list.iter().copied().fold(f64::NEG_INFINITY, f64::max))
        };
        let (first, second) = (range(&height[..split]), range(&height[split..]));
        let between = (second.0 - first.1).max(first.0 - second.1);
        between > 0.0 && between * between > bound * bound * n.norm_squared()
    })
}
