//! Edges that pass through faces, found without a tree or a distance.

use crate::contact_mesh::ContactMesh;
use crate::vectors::gather;
use nalgebra::Vector3;

#[cfg(test)]
mod tests;

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

/// Whether the open segment `pq` runs through the open triangle `abc`: strictly inside the three sides, with
/// its ends strictly on different sides of the plane, beyond round-off.
pub fn pierces([p, q]: [Vector3<f64>; 2], [a, b, c]: [Vector3<f64>; 3]) -> bool {
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
