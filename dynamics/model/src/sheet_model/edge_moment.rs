//! Moments at edges, which turn with the sheet.

#[cfg(test)]
mod tests;

use super::follower::{FaceLoad, Follower, OfCorners};
use super::load::{LoadError, direction};
use super::loaded_faces::Corners;
use super::pressure::area_derivatives;
use crate::SheetModel;
use isosheet_materials::vectors::point;
use isosheet_mesh::{EdgeId, Topology};
use isosheet_motion::Profile;
use nalgebra::{Matrix3, RowVector3, Vector3};
use std::sync::Arc;

/// A moment on a line of edges, `M(t)` in newton metres in all, which turns with the sheet: it acts about
/// each edge, in the sense that is that about an axis at the start, by a share like its length.
///
/// The faces beside an edge bear its share `m`, the two of an interior edge half of it each, as the forces of
/// a couple along their unit normal: at the corner opposite to the edge, which is the height `h` away from
/// it, `m / h`, and its opposite at the point of the edge that is nearest to that corner.
#[derive(Debug, Clone, PartialEq)]
pub struct EdgeMoment {
    size: Profile,
    /// Faces whose first side is an edge of the line.
    corners: Vec<Corners>,
    /// The part of the moment that each of them bears, positive about their first side.
    parts: Vec<f64>,
}

impl EdgeMoment {
    /// A moment on edges of a mesh at positions `x` (`3V`, metres) about an axis of any length; the profile
    /// gives its size, newton metres, right-handed about the axis.
    ///
    /// # Errors
    /// [`LoadError`] naming the first argument that cannot be used.
    ///
    /// # Panics
    /// If an edge is that of another mesh, or `x` is not of length `3V`.
    pub fn new(
        topology: &Topology,
        edges: &[EdgeId],
        axis: [f64; 3],
        size: impl Into<Profile>,
        x: &[f64],
    ) -> Result<Self, LoadError> {
        let size = size.into();
        size.validate()?;
        let axis = direction(axis)?;
        assert_eq!(
            x.len(),
            3 * topology.vertex_count(),
            "three coordinates a vertex"
        );
        if edges.is_empty() {
            return Err(LoadError::NoEdges);
        }
        let along = |edge: EdgeId| {
            let [a, b] = topology.edges()[edge.index()];
            point(x, b) - point(x, a)
        };
        let whole: f64 = edges.iter().map(|e| along(*e).norm()).sum();
        let (mut corners, mut parts) = (Vec::new(), Vec::new());
        for &edge in edges {
            let along = along(edge);
            let component = along.dot(&axis);
            if component.abs() <= ACROSS * along.norm() {
                return Err(LoadError::AcrossAxis { edge });
            }
            let faces = topology.edge_faces(edge);
            let bearing = faces.iter().flatten().count() as f64;
            let part = along.norm() / (whole * bearing) * component.signum();
            for (face, sign) in faces.into_iter().zip([1.0, -1.0]) {
                if let Some(face) = face {
                    corners.push(Corners::of(topology, face).beginning_with(edge));
                    parts.push(sign * part);
                }
            }
        }
        Ok(Self {
            size,
            corners,
            parts,
        })
    }
}

/// Part of its length along the axis up to which an edge is across it.
const ACROSS: f64 = 1e-6;

impl SheetModel {
    /// Adds a moment that turns with the sheet. Its work is a part of
    /// `StepReport::work`; BDF2 and implicit Euler take it at the end of a step,
    /// all other methods as it is.
    #[must_use]
    pub fn with_edge_moment(self, moment: EdgeMoment) -> Self {
        self.with_implicit_force(Follower(Arc::new(moment)))
    }
}

impl FaceLoad for EdgeMoment {
    fn faces(&self) -> &[Corners] {
        &self.corners
    }

    /// With the edge `e = b - a`, the area vector `N = e x (c - a)` of the face and the place `s` on the edge
    /// of the point that is nearest to `c`, the forces are `m w`, `w = |e| N / |N|^2`, at `c`, and `-m (1 -
    /// s) w` and `-m s w` at `a` and `b`.
    fn forces(&self, number: usize, t: f64, x: &OfCorners) -> OfCorners {
        let moment = self.parts[number] * self.size.value(t);
        let [a, b, c] = x;
        let (edge, arm) = (b - a, c - a);
        let area = edge.cross(&arm);
        let force = moment * edge.norm() / area.norm_squared() * area;
        let place = arm.dot(&edge) / edge.norm_squared();
        [(place - 1.0) * force, -place * force, force]
    }

    fn derivatives(&self, number: usize, t: f64, x: &OfCorners) -> [[Matrix3<f64>; 3]; 3] {
        let moment = self.parts[number] * self.size.value(t);
        let [a, b, c] = x;
        let (edge, arm) = (b - a, c - a);
        let area = edge.cross(&arm);
        let (length, square) = (edge.norm(), area.norm_squared());
        let force = moment * length / square * area;
        let place = arm.dot(&edge) / edge.norm_squared();
        let area_by = area_derivatives(x);
        // Of `|e|` and of `s`.
        let unit = edge / length;
        let length_by = [-unit, unit, Vector3::zeros()];
        let across = (arm - 2.0 * place * edge) / edge.norm_squared();
        let place_by = [
            -across - edge / edge.norm_squared(),
            across,
            edge / edge.norm_squared(),
        ];
        let force_by = [0, 1, 2].map(|j| {
            let of_area = area_by[j];
            let of_square: RowVector3<f64> = 2.0 * area.transpose() * of_area;
            moment / square
                * (area * length_by[j].transpose() + length * of_area
                    - length / square * area * of_square)
        });
        let at = |factor: f64, sign: f64, j: usize| {
            factor * force_by[j] + sign * force * place_by[j].transpose()
        };
        [
            [0, 1, 2].map(|j| at(place - 1.0, 1.0, j)),
            [0, 1, 2].map(|j| at(-place, -1.0, j)),
            force_by,
        ]
    }
}
