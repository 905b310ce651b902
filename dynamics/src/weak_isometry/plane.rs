//! The plane of a flat rest shape.

use super::WeakIsometryError;
use crate::constraint::rows::point;
use isosheet_mesh::{FaceId, Sheet, VertexId};
use nalgebra::{Vector2, Vector3};

/// Largest distance from the plane, relative to the mean length of the edges: coordinates with six digits are
/// flat, a surface with curvature is not. (Strains of the second order in it are below 1e-10.)
const FLAT: f64 = 1e-5;

/// The rest positions in Cartesian coordinates of their plane, in which the faces run counter-clockwise.
#[derive(Debug)]
pub(super) struct RestPlane(Vec<Vector2<f64>>);

impl RestPlane {
    /// The plane whose normal is the mean of those of the faces, weighted with their areas.
    ///
    /// # Errors
    /// [`WeakIsometryError::NotFlat`], [`WeakIsometryError::Folded`].
    pub(super) fn new(sheet: &Sheet) -> Result<Self, WeakIsometryError> {
        let at = |v: VertexId| point(sheet.positions(), v);
        let vertices = || sheet.topology().vertex_ids();
        let centre = vertices().map(at).sum::<Vector3<f64>>() / vertices().len() as f64;
        let faces = sheet.topology().faces();
        let area = |[a, b, c]: [VertexId; 3]| (at(b) - at(a)).cross(&(at(c) - at(a)));
        let sum: Vector3<f64> = faces.iter().map(|f| area(*f)).sum();
        // The normals of a sheet that is folded over may cancel: then that of a face will do, to tell which
        // faces are turned over.
        let areas = faces.iter().map(|f| area(*f));
        let normal = areas.fold(sum, longer).normalize();
        let height = |v: VertexId| (at(v) - centre).dot(&normal).abs();
        let furthest = vertices().max_by(|a, b| height(*a).total_cmp(&height(*b)));
        let furthest = furthest.unwrap_or(VertexId(0));
        if height(furthest) > FLAT * sheet.mean_length() {
            return Err(WeakIsometryError::NotFlat {
                vertex: furthest,
                distance: height(furthest),
            });
        }
        let [first, second] = axes(&normal);
        let flat = |v: VertexId| {
            let d = at(v) - centre;
            Vector2::new(d.dot(&first), d.dot(&second))
        };
        let plane = Self(vertices().map(flat).collect());
        for (f, [a, b, c]) in faces.iter().enumerate() {
            if (plane.at(*b) - plane.at(*a)).perp(&(plane.at(*c) - plane.at(*a))) <= 0.0 {
                let face = FaceId(f as u32);
                return Err(WeakIsometryError::Folded { face });
            }
        }
        Ok(plane)
    }

    /// The place of a vertex, metres.
    pub(super) fn at(&self, v: VertexId) -> Vector2<f64> {
        self.0[v.index()]
    }
}

fn longer(a: Vector3<f64>, b: Vector3<f64>) -> Vector3<f64> {
    if b.norm_squared() > a.norm_squared() {
        b
    } else {
        a
    }
}

/// Orthonormal vectors of the plane with the given normal, which make a right-handed system with it. In the
/// horizontal plane they are the axes x and y.
fn axes(normal: &Vector3<f64>) -> [Vector3<f64>; 2] {
    let start = if normal.x.abs() < 0.9 {
        Vector3::x()
    } else {
        Vector3::y()
    };
    let first = (start - normal * normal.dot(&start)).normalize();
    [first, normal.cross(&first)]
}
