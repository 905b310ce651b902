//! Contact of the sheet with itself.

use super::body::{SheetMotion, point};
use super::options::Coefficients;
use super::touch::{Key, Kind, Parallel, Touch};
use crate::distance::{Closest, edge_edge, point_triangle};
use crate::{BroadPhase, Candidates, ParallelMollifier};
use nalgebra::Vector3;

/// The pairs of the sheet that are within reach on the present motion.
#[derive(Debug, Clone)]
pub(super) struct SelfContact {
    pub(super) coefficients: Coefficients,
    pub(super) pairs: Candidates,
}

impl SelfContact {
    pub(super) fn new(coefficients: Coefficients) -> Self {
        Self {
            coefficients,
            pairs: Candidates::default(),
        }
    }

    /// Collects the pairs within reach on a motion and returns the part of it, up to `limit`, that
    /// brings nothing into contact. The boxes are those of the whole motion, enlarged by half the
    /// reach.
    pub(super) fn search(
        &mut self,
        sheet: SheetMotion<'_>,
        sheet_boxes: &mut BroadPhase,
        limit: f64,
    ) -> f64 {
        sheet_boxes.self_candidates(&mut self.pairs);
        let SheetMotion {
            mesh,
            x,
            dx,
            reach,
            ccd,
            ..
        } = sheet;
        let half_way = ccd.separation + 0.5 * (reach - ccd.separation);
        let mut limit = limit;
        self.pairs.vertex_face.retain(|&[v, f]| {
            let vertices = vertex_face(v, mesh.faces()[f as usize]);
            let (places, steps) = (points(x, vertices), points(dx, vertices));
            let closer = approach(&steps, 1);
            let [p, a, b, c] = places;
            let directions = [(a - p) + (b - p) + (c - p), (b - a).cross(&(c - a))];
            if are_apart(&places, 1, &directions, reach + closer) {
                return false;
            }
            let nearest = point_triangle(&places).distance() - closer;
            if nearest <= half_way || nearest.is_nan() {
                limit = ccd.point_triangle(&places, &steps, limit);
            }
            nearest <= reach || nearest.is_nan()
        });
        self.pairs.edge_edge.retain(|&[e, g]| {
            let vertices = two_edges(mesh.edges()[e as usize], mesh.edges()[g as usize]);
            let (places, steps) = (points(x, vertices), points(dx, vertices));
            let closer = approach(&steps, 2);
            let [a, b, c, d] = places;
            let directions = [(c - a) + (d - b), (b - a).cross(&(d - c))];
            if are_apart(&places, 2, &directions, reach + closer) {
                return false;
            }
            let nearest = edge_edge(&places).distance() - closer;
            if nearest <= half_way || nearest.is_nan() {
                limit = ccd.edge_edge(&places, &steps, limit);
            }
            nearest <= reach || nearest.is_nan()
        });
        limit
    }

    /// Adds the contacts within reach at `x`.
    pub(super) fn touches(&self, sheet: SheetMotion<'_>, out: &mut Vec<Touch>) {
        let SheetMotion { mesh, x, .. } = sheet;
        for &[v, f] in &self.pairs.vertex_face {
            let vertices = vertex_face(v, mesh.faces()[f as usize]);
            let closest = point_triangle(&points(x, vertices));
            if let Some(touch) = touch(sheet, Kind::VertexFace, [v, f], vertices, &closest) {
                out.push(touch);
            }
        }
        for &[e, g] in &self.pairs.edge_edge {
            let vertices = two_edges(mesh.edges()[e as usize], mesh.edges()[g as usize]);
            let places = points(x, vertices);
            let closest = edge_edge(&places);
            if let Some(touch) = touch(sheet, Kind::EdgeEdge, [e, g], vertices, &closest) {
                let lengths2 = [e, g].map(|e| sheet.lengths2[e as usize]);
                let mollifier = ParallelMollifier::new(lengths2[0], lengths2[1]);
                let [a, b, c, d] = places;
                let parallel = Parallel::new(b - a, d - c, &mollifier);
                out.push(Touch { parallel, ..touch });
            }
        }
    }
}

fn vertex_face(v: u32, [a, b, c]: [u32; 3]) -> [u32; 4] {
    [v, a, b, c]
}

fn two_edges([a, b]: [u32; 2], [c, d]: [u32; 2]) -> [u32; 4] {
    [a, b, c, d]
}

fn points(x: &[f64], vertices: [u32; 4]) -> [Vector3<f64>; 4] {
    vertices.map(|v| point(x, v))
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

fn touch(
    sheet: SheetMotion<'_>,
    kind: Kind,
    pair: [u32; 2],
    vertices: [u32; 4],
    closest: &Closest<4>,
) -> Option<Touch> {
    let distance = closest.distance();
    if distance >= sheet.reach {
        return None;
    }
    Some(Touch {
        key: Key {
            body: None,
            kind,
            pair,
        },
        vertices,
        weights: closest.weights,
        normal: closest.difference / distance,
        gap: distance - sheet.ccd.separation,
        foot: Vector3::zeros(),
        parallel: None,
    })
}
