//! Loads whose direction turns with the sheet.

#[cfg(test)]
mod tests;

use super::follower::{FaceLoad, Follower, OfCorners};
use super::load::{LoadError, direction};
use super::loaded_faces::Corners;
use super::pressure::area_derivatives;
use crate::SheetModel;
use isosheet_materials::vectors::point;
use isosheet_mesh::{FaceId, Topology, VertexId};
use isosheet_motion::Profile;
use nalgebra::{Matrix3, Vector3};
use std::sync::Arc;

/// A load on some vertices whose direction turns with the faces around them, and whose size is the same on
/// each of them: each face carries a share like its area, which is fixed in the face. In its plane the
/// direction goes along with its edges; where these stretch by a part, so does that component of the load.
#[derive(Debug, Clone, PartialEq)]
pub struct TurningLoad {
    size: Profile,
    corners: Vec<Corners>,
    of_faces: Vec<OfFace>,
}

/// The load on a face of one newton in all at a vertex.
#[derive(Debug, Clone, Copy, PartialEq)]
struct OfFace {
    /// Newtons along the two sides from its first corner, over their lengths, and along its normal.
    components: Vector3<f64>,
    /// The parts of the load at its corners.
    parts: [f64; 3],
}

impl TurningLoad {
    /// A load on vertices of a mesh that has a direction of any length at positions `x` (`3V`, metres); the
    /// profile gives its size on each vertex, newtons.
    ///
    /// # Errors
    /// [`LoadError`] naming the first argument that cannot be used.
    ///
    /// # Panics
    /// If `x` is not of length `3V`.
    pub fn new(
        topology: &Topology,
        vertices: &[VertexId],
        along: [f64; 3],
        size: impl Into<Profile>,
        x: &[f64],
    ) -> Result<Self, LoadError> {
        let size = size.into();
        size.validate()?;
        let vertex_count = topology.vertex_count();
        assert_eq!(x.len(), 3 * vertex_count, "three coordinates a vertex");
        if let Some(&vertex) = vertices.iter().find(|v| v.index() >= vertex_count) {
            return Err(LoadError::NoSuchVertex {
                vertex,
                vertex_count,
            });
        }
        let along = direction(along)?;
        let places = |f: FaceId| topology.faces()[f.index()].map(|v| point(x, v));
        let area = |f: &FaceId| area_vector(&places(*f)).norm();
        let mut parts = vec![[0.0; 3]; topology.face_count()];
        for &v in vertices {
            let around = topology.vertex_faces(v);
            let whole: f64 = around.iter().map(area).sum();
            for f in around {
                let corners = topology.faces()[f.index()].iter();
                for (part, _) in parts[f.index()]
                    .iter_mut()
                    .zip(corners)
                    .filter(|(_, w)| **w == v)
                {
                    *part += area(f) / whole;
                }
            }
        }
        let (mut corners, mut of_faces) = (Vec::new(), Vec::new());
        for (f, parts) in topology.face_ids().zip(parts) {
            if parts != [0.0; 3] {
                let components = frame(&places(f)).try_inverse();
                let components = components.ok_or(LoadError::Sliver { face: f })? * along;
                corners.push(Corners::of(topology, f));
                of_faces.push(OfFace { components, parts });
            }
        }
        Ok(Self {
            size,
            corners,
            of_faces,
        })
    }
}

impl SheetModel {
    /// Adds a load whose direction turns with the sheet. Its work is a part of
    /// `StepReport::work`; BDF2 and implicit Euler take it at the end of a step,
    /// all other methods as it is.
    #[must_use]
    pub fn with_turning_load(self, load: TurningLoad) -> Self {
        self.with_implicit_force(Follower(Arc::new(load)))
    }
}

/// Twice the area of a face along its normal.
fn area_vector([a, b, c]: &OfCorners) -> Vector3<f64> {
    (b - a).cross(&(c - a))
}

/// The two sides from the first corner, and the unit normal.
fn frame(x: &OfCorners) -> Matrix3<f64> {
    let [a, b, c] = x;
    Matrix3::from_columns(&[b - a, c - a, area_vector(x).normalize()])
}

impl FaceLoad for TurningLoad {
    fn faces(&self) -> &[Corners] {
        &self.corners
    }

    fn forces(&self, number: usize, t: f64, x: &OfCorners) -> OfCorners {
        let OfFace { components, parts } = self.of_faces[number];
        let whole = self.size.value(t) * frame(x) * components;
        parts.map(|part| part * whole)
    }

    fn derivatives(&self, number: usize, t: f64, x: &OfCorners) -> [[Matrix3<f64>; 3]; 3] {
        let OfFace { components, parts } = self.of_faces[number];
        let [along_first, along_second, across] = components.into();
        let area = area_vector(x);
        let normal = area.normalize();
        let turning = (Matrix3::identity() - normal * normal.transpose()) / area.norm();
        let sides = [-along_first - along_second, along_first, along_second];
        let area_by = area_derivatives(x);
        let whole_by = [0, 1, 2].map(|j| {
            let side = Matrix3::from_diagonal_element(sides[j]);
            self.size.value(t) * (side + across * turning * area_by[j])
        });
        parts.map(|part| whole_by.map(|d| part * d))
    }
}
