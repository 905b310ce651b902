//! Bulk queries over candidate pairs: safe step and smallest distance.

use crate::broad_phase::{Candidates, CrossCandidates};
use crate::ccd::CcdOptions;
use crate::contact_mesh::ContactMesh;
use crate::distance::{edge_edge, point_triangle};
use nalgebra::Vector3;

#[cfg(test)]
mod tests;

/// A mesh on the way from `x` to `x + dx`.
#[derive(Debug, Clone, Copy)]
pub struct Moving<'a> {
    /// The primitives.
    pub mesh: &'a ContactMesh,
    /// Positions, `3V`, metres.
    pub x: &'a [f64],
    /// Displacements, `3V`, metres.
    pub dx: &'a [f64],
}

/// The points with the given numbers.
pub(crate) fn gather<const N: usize>(x: &[f64], vertices: [u32; N]) -> [Vector3<f64>; N] {
    vertices.map(|v| {
        let i = 3 * v as usize;
        Vector3::new(x[i], x[i + 1], x[i + 2])
    })
}

/// A vertex of one mesh and a face of another.
fn vertex_face(first: &[f64], second: &[f64], v: u32, [a, b, c]: [u32; 3]) -> [Vector3<f64>; 4] {
    let ([p], [q, r, s]) = (gather(first, [v]), gather(second, [a, b, c]));
    [p, q, r, s]
}

/// An edge of one mesh and an edge of another.
fn two_edges(first: &[f64], second: &[f64], e: [u32; 2], g: [u32; 2]) -> [Vector3<f64>; 4] {
    let ([a, b], [c, d]) = (gather(first, e), gather(second, g));
    [a, b, c, d]
}

impl Candidates {
    /// Largest part of the motion, up to `limit`, that is proven to bring no pair to within the
    /// separation of the options; see [`CcdOptions::point_triangle`]. The candidates have to be those
    /// of this motion.
    pub fn safe_fraction(&self, moving: Moving<'_>, options: &CcdOptions, limit: f64) -> f64 {
        let Moving { mesh, x, dx } = moving;
        let mut t = limit;
        for &[v, f] in &self.vertex_face {
            let face = mesh.faces()[f as usize];
            t = options.point_triangle(
                &vertex_face(x, x, v, face),
                &vertex_face(dx, dx, v, face),
                t,
            );
        }
        for &[e, g] in &self.edge_edge {
            let (e, g) = (mesh.edges()[e as usize], mesh.edges()[g as usize]);
            t = options.edge_edge(&two_edges(x, x, e, g), &two_edges(dx, dx, e, g), t);
        }
        t
    }

    /// Smallest distance of the pairs at positions `x` (`3V`), metres; infinite if there are none.
    pub fn smallest_distance(&self, mesh: &ContactMesh, x: &[f64]) -> f64 {
        let faces = self.vertex_face.iter().map(|&[v, f]| {
            point_triangle(&vertex_face(x, x, v, mesh.faces()[f as usize])).distance2
        });
        let edges = self.edge_edge.iter().map(|&[e, g]| {
            let (e, g) = (mesh.edges()[e as usize], mesh.edges()[g as usize]);
            edge_edge(&two_edges(x, x, e, g)).distance2
        });
        faces.chain(edges).fold(f64::INFINITY, smaller).sqrt()
    }
}

impl CrossCandidates {
    /// Largest part of the motions of both meshes, up to `limit`, that is proven to bring no pair to
    /// within the separation of the options. The candidates have to be those of these motions.
    pub fn safe_fraction(
        &self,
        first: Moving<'_>,
        second: Moving<'_>,
        options: &CcdOptions,
        limit: f64,
    ) -> f64 {
        let mut t = limit;
        for &[v, f] in &self.vertex_face {
            let face = second.mesh.faces()[f as usize];
            t = options.point_triangle(
                &vertex_face(first.x, second.x, v, face),
                &vertex_face(first.dx, second.dx, v, face),
                t,
            );
        }
        for &[f, v] in &self.face_vertex {
            let face = first.mesh.faces()[f as usize];
            t = options.point_triangle(
                &vertex_face(second.x, first.x, v, face),
                &vertex_face(second.dx, first.dx, v, face),
                t,
            );
        }
        for &[e, g] in &self.edge_edge {
            let (e, g) = (
                first.mesh.edges()[e as usize],
                second.mesh.edges()[g as usize],
            );
            t = options.edge_edge(
                &two_edges(first.x, second.x, e, g),
                &two_edges(first.dx, second.dx, e, g),
                t,
            );
        }
        t
    }

    /// Smallest distance of the pairs at positions `x` of the first and `y` of the second mesh,
    /// metres; infinite if there are none.
    pub fn smallest_distance(
        &self,
        [first, second]: [&ContactMesh; 2],
        x: &[f64],
        y: &[f64],
    ) -> f64 {
        let mut best = f64::INFINITY;
        for &[v, f] in &self.vertex_face {
            let stencil = vertex_face(x, y, v, second.faces()[f as usize]);
            best = smaller(best, point_triangle(&stencil).distance2);
        }
        for &[f, v] in &self.face_vertex {
            let stencil = vertex_face(y, x, v, first.faces()[f as usize]);
            best = smaller(best, point_triangle(&stencil).distance2);
        }
        for &[e, g] in &self.edge_edge {
            let stencil = two_edges(x, y, first.edges()[e as usize], second.edges()[g as usize]);
            best = smaller(best, edge_edge(&stencil).distance2);
        }
        best.sqrt()
    }
}

/// The minimum, or not a number if one of the two is not: a broken state must not pass for a wide
/// gap.
pub(crate) fn smaller(a: f64, b: f64) -> f64 {
    if a.is_nan() || b.is_nan() {
        f64::NAN
    } else {
        a.min(b)
    }
}

/// The maximum, or not a number if one of the two is not.
pub(crate) fn larger(a: f64, b: f64) -> f64 {
    -smaller(-a, -b)
}

/// Edges of a mesh that pass through its faces, as pairs of edge and face, at positions `x` (`3V`).
///
/// Tests every pair without any tree or distance: the check of last resort for what the rest of this
/// crate promises. An edge passes through a face if its ends lie strictly on different sides and the
/// line runs strictly inside the three sides; touching and overlapping in one plane do not count.
pub fn crossings(mesh: &ContactMesh, x: &[f64]) -> Vec<[u32; 2]> {
    pierced(mesh, x, mesh, x, |e, f| !e.iter().any(|v| f.contains(v)))
}

/// Edges of the first mesh that pass through faces of the second; see [`crossings`]. For the other
/// direction swap the meshes.
pub fn crossings_between(
    first: &ContactMesh,
    x: &[f64],
    second: &ContactMesh,
    y: &[f64],
) -> Vec<[u32; 2]> {
    pierced(first, x, second, y, |_, _| true)
}

fn pierced(
    first: &ContactMesh,
    x: &[f64],
    second: &ContactMesh,
    y: &[f64],
    keep: impl Fn(&[u32; 2], &[u32; 3]) -> bool,
) -> Vec<[u32; 2]> {
    let mut found = Vec::new();
    for (f, face) in (0..).zip(second.faces()) {
        let [a, b, c] = gather(y, *face);
        for (e, edge) in (0..).zip(first.edges()) {
            if !keep(edge, face) {
                continue;
            }
            let [p, q] = gather(x, *edge);
            if pierces([p, q], [a, b, c]) {
                found.push([e, f]);
            }
        }
    }
    found
}

/// Round-off of a triple product over the product of the lengths.
const VOLUME_ROUND_OFF: f64 = 16.0 * f64::EPSILON;

/// Whether the open segment `pq` runs through the open triangle `abc`.
pub(crate) fn pierces([p, q]: [Vector3<f64>; 2], [a, b, c]: [Vector3<f64>; 3]) -> bool {
    // Zero in one plane: what is left there is round-off of arbitrary sign.
    let volume = |a: Vector3<f64>, b: Vector3<f64>, c: Vector3<f64>, d: Vector3<f64>| {
        let (b, c, d) = (b - a, c - a, d - a);
        let volume = b.cross(&c).dot(&d);
        if volume.abs() <= VOLUME_ROUND_OFF * b.norm() * c.norm() * d.norm() {
            0.0
        } else {
            volume
        }
    };
    let (first, second) = (volume(a, b, c, p), volume(a, b, c, q));
    if !(first < 0.0 && second > 0.0 || first > 0.0 && second < 0.0) {
        return false;
    }
    let sides = [volume(p, q, a, b), volume(p, q, b, c), volume(p, q, c, a)];
    sides.iter().all(|s| *s > 0.0) || sides.iter().all(|s| *s < 0.0)
}
