//! The volume that closed faces enclose.

#[cfg(test)]
pub(super) mod tests;

use super::loaded_faces::{Corners, LoadedFaces};
use isosheet_materials::hessian::{HessianPart, HessianSink};
use isosheet_materials::vectors::point;
use isosheet_mesh::{EdgeId, VertexId};
use nalgebra::{Matrix3, Vector3};
use std::collections::BTreeMap;

/// The volume `V = sum_f det(x_a - c, x_b - c, x_d - c) / 6` that faces enclose, positive where they have it
/// behind them. It does not depend on the point `c`; the mean of all corners costs the fewest digits.
///
/// Its gradient at a vertex is a third of the sum of the areas of the faces around it, as vectors along their
/// normals: the resultants of a pressure of one. Where a seam stands open, a strip of triangles closes the
/// surface.
#[derive(Debug, Clone)]
pub(super) struct Volume {
    /// The vertices of the faces, and of each face and each triangle of a strip their numbers in this list.
    vertices: Vec<VertexId>,
    faces: Vec<[usize; 3]>,
    hinges: Vec<Hinge>,
}

/// An edge with what is opposite to it in the faces that have it in its direction and in the other one;
/// nothing beside a seam.
#[derive(Debug, Clone, Copy)]
struct Hinge {
    edge: EdgeId,
    ends: [VertexId; 2],
    opposite: [Option<VertexId>; 2],
}

impl LoadedFaces {
    /// The volume that closed faces enclose at positions `x` (`3V`, metres), cubic metres; negative where
    /// their front is inside.
    ///
    /// # Panics
    /// If `x` is shorter than the mesh that the faces are of.
    pub fn volume(&self, x: &[f64]) -> f64 {
        Volume::new(self).value(x)
    }
}

impl Volume {
    /// Behind faces that are closed but for their seams.
    pub(super) fn new(loaded: &LoadedFaces) -> Self {
        let corners = &loaded.corners;
        let mut vertices: Vec<VertexId> = corners.iter().flat_map(|c| c.vertices).collect();
        vertices.sort_unstable();
        vertices.dedup();
        let number = |v: VertexId| vertices.partition_point(|w| *w < v);
        let strips = loaded.seams.iter().flat_map(|seam| seam.strip());
        let faces = corners.iter().map(|c| c.vertices).chain(strips);
        Self {
            faces: faces.map(|vertices| vertices.map(number)).collect(),
            hinges: hinges(corners),
            vertices,
        }
    }

    /// `c`.
    fn centre(&self, x: &[f64]) -> Vector3<f64> {
        let sum: Vector3<f64> = self.vertices.iter().map(|v| point(x, *v)).sum();
        sum / self.vertices.len() as f64
    }

    /// The positions of the vertices less the centre.
    fn arms(&self, x: &[f64]) -> Vec<Vector3<f64>> {
        let centre = self.centre(x);
        let vertices = self.vertices.iter();
        vertices.map(|v| point(x, *v) - centre).collect()
    }

    /// The volume, cubic metres.
    pub(super) fn value(&self, x: &[f64]) -> f64 {
        let arms = self.arms(x);
        let six = self.faces.iter().map(|face| {
            let [a, b, d] = face.map(|k| arms[k]);
            a.dot(&b.cross(&d))
        });
        six.sum::<f64>() / 6.0
    }

    /// Its gradient, square metres.
    pub(super) fn gradient(&self, x: &[f64]) -> Vec<(VertexId, Vector3<f64>)> {
        let arms = self.arms(x);
        let mut sums = vec![Vector3::zeros(); arms.len()];
        for face in &self.faces {
            for k in 0..3 {
                let [own, next, last] = [0, 1, 2].map(|j| face[(k + j) % 3]);
                sums[own] += arms[next].cross(&arms[last]) / 6.0;
            }
        }
        self.vertices.iter().copied().zip(sums).collect()
    }

    /// Adds `scale` times a part of the second derivatives, which belong to closed seams.
    ///
    /// The block of an edge from `a` to `b` is that of the cross product with `w = s (r - l) / 6`, between
    /// what is opposite to it on both sides. Its eigenvalues are `|w|`, `-|w|` and zero, each of them twice:
    /// the matrices `|w| (1 - n n^T) / 2` at both ends, `n = w / |w|`, and half of the block itself make up
    /// the semidefinite part.
    pub(super) fn add_hessian(
        &self,
        x: &[f64],
        scale: f64,
        part: HessianPart,
        sink: &mut dyn HessianSink,
    ) {
        let centre = self.centre(x);
        for hinge in &self.hinges {
            let arm = |v: Option<VertexId>| v.map_or(centre, |v| point(x, v));
            let [left, right] = hinge.opposite.map(arm);
            let w = scale / 6.0 * (right - left);
            let block = w.cross_matrix();
            match part {
                HessianPart::Full => sink.add_edge(hinge.edge, &block),
                HessianPart::PositiveSemidefinite => {
                    let n = w.try_normalize(0.0).unwrap_or_default();
                    let across = Matrix3::identity() - n * n.transpose();
                    let half = 0.5 * w.norm() * across;
                    hinge.ends.iter().for_each(|v| sink.add_vertex(*v, &half));
                    sink.add_edge(hinge.edge, &(0.5 * block));
                }
                HessianPart::Certain => {}
            }
        }
    }
}

fn hinges(corners: &[Corners]) -> Vec<Hinge> {
    let mut hinges: BTreeMap<EdgeId, Hinge> = BTreeMap::new();
    for face in corners {
        for (k, side) in face.sides.iter().enumerate() {
            let [from, to] = face.ends(k);
            let (ends, place) = match side.is_forward {
                true => ([from, to], 0),
                false => ([to, from], 1),
            };
            let hinge = hinges.entry(side.edge).or_insert(Hinge {
                edge: side.edge,
                ends,
                opposite: [None; 2],
            });
            hinge.opposite[place] = Some(face.vertices[(k + 2) % 3]);
        }
    }
    hinges.into_values().collect()
}
