//! The angle between two parts of a sheet.

use crate::words::key::Key;
use crate::words::problem::Problem;
use isosheet_mesh::VertexId;
use nalgebra::Vector3;
use std::collections::HashSet;

/// Faces of a sheet, and the direction in which they face together.
#[derive(Clone, Debug)]
pub(super) struct Facing {
    faces: Vec<[VertexId; 3]>,
}

impl Facing {
    /// The faces that have all corners among `corners`.
    pub(super) fn new(
        corners: &[VertexId],
        faces: &[[VertexId; 3]],
        key: &Key,
    ) -> Result<Self, Problem> {
        let corners: HashSet<_> = corners.iter().collect();
        let own = faces
            .iter()
            .filter(|f| f.iter().all(|v| corners.contains(v)));
        let faces: Vec<_> = own.copied().collect();
        if faces.is_empty() {
            let message = "no face of a sheet has all its corners among these vertices";
            let remedy = "choose a region that has whole faces in it";
            return Err(Problem::new(key.clone(), message, remedy));
        }
        Ok(Self { faces })
    }

    /// The vector area, square metres.
    fn area(&self, x: &[f64]) -> Vector3<f64> {
        let points = x.as_chunks::<3>().0;
        let of_face = |corners: &[VertexId; 3]| {
            let [a, b, c] = corners.map(|v| Vector3::from(points[v.index()]));
            (b - a).cross(&(c - a)) / 2.0
        };
        self.faces.iter().map(of_face).sum()
    }

    /// The angle between the vector areas of both, degrees.
    pub(super) fn angle_to(&self, other: &Self, x: &[f64]) -> f64 {
        let (one, other) = (self.area(x), other.area(x));
        f64::atan2(one.cross(&other).norm(), one.dot(&other)).to_degrees()
    }
}
