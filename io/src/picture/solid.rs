//! Bodies in pictures of sheets.

use super::camera::normal;
use super::error::PictureError;
use super::vector::dot;
use isosheet_collide::Obstacle;

/// A body as it is drawn: flat faces and the edges between them.
#[derive(Clone, Debug)]
pub struct Solid {
    /// Corners, metres.
    pub points: Vec<[f64; 3]>,
    /// Triangles: numbers of corners.
    pub faces: Vec<[usize; 3]>,
    /// Edges where two faces meet at an angle.
    pub edges: Vec<[usize; 2]>,
}

/// Sides of round bodies in pictures.
const SEGMENTS: usize = 96;

/// Faces whose normals differ by less than this (cosine) look like one.
const FLAT: f64 = 0.97;

impl Solid {
    /// A body in its place at time `t`, seconds.
    ///
    /// # Errors
    /// [`PictureError::NoFaces`] for half-spaces, balls and capsules.
    pub fn of(body: &Obstacle, t: f64) -> Result<Self, PictureError> {
        let Some(geometry) = body.shape().contact_geometry(SEGMENTS)? else {
            return Err(PictureError::NoFaces("half-space"));
        };
        if geometry.radius > 0.0 {
            return Err(PictureError::NoFaces("ball or capsule"));
        }
        let mut x = vec![0.0; geometry.positions.len()];
        body.place(t, &geometry.positions, &mut x);
        let points = x.as_chunks::<3>().0.to_vec();
        let faces: Vec<[usize; 3]> = geometry
            .mesh
            .faces()
            .iter()
            .map(|f| f.map(|v| v as usize))
            .collect();
        let normal = |f: &[usize; 3]| normal(&f.map(|v| points[v]));
        let ends = geometry.mesh.edges().iter().map(|e| e.map(|v| v as usize));
        let edges = ends
            .filter(|e| {
                let beside: Vec<_> = faces
                    .iter()
                    .filter(|f| e.iter().all(|v| f.contains(v)))
                    .collect();
                match beside[..] {
                    [f, g] => dot(&normal(f), &normal(g)) < FLAT,
                    _ => true,
                }
            })
            .collect();
        Ok(Self {
            points,
            faces,
            edges,
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use isosheet_collide::Shape;
    use nalgebra::Isometry3;

    #[test]
    fn a_box_has_twelve_edges_and_no_diagonals() {
        let shape = Shape::Cuboid {
            half: [1.0, 2.0, 3.0],
        };
        let body = Obstacle::fixed(shape, Isometry3::translation(0.0, 0.0, 5.0)).unwrap();
        let solid = Solid::of(&body, 0.0).unwrap();
        assert_eq!(
            (solid.points.len(), solid.faces.len(), solid.edges.len()),
            (8, 12, 12)
        );
        assert!(solid.points.iter().all(|p| p[2] == 2.0 || p[2] == 8.0));
    }
}
