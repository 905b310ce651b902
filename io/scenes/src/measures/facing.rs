//! The angle between two parts of a sheet.

use crate::words::key::Key;
use crate::words::problem::Problem;
use isosheet_mesh::VertexId;
use nalgebra::Vector3;
use std::collections::HashSet;

/// The vector area of faces that close up is less than this part of their areas: round-off, many times over.
const CLOSED: f64 = 1e-9;

/// Faces of a sheet, and the direction in which they face together.
#[derive(Clone, Debug)]
pub(super) struct Facing {
    faces: Vec<[VertexId; 3]>,
}

impl Facing {
    /// The faces that have all corners among `corners`, with the positions `x` at the start (`3V`, metres).
    pub(super) fn new(
        corners: &[VertexId],
        faces: &[[VertexId; 3]],
        x: &[f64],
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
        let part = Self { faces };
        let areas = part.areas(x).map(|area| area.norm());
        if part.area(x).norm() <= CLOSED * areas.sum::<f64>() {
            let message = "these faces close up, and face to no side";
            return Err(Problem::new(
                key.clone(),
                message,
                "choose faces on one side",
            ));
        }
        Ok(part)
    }

    /// The vector area of each face, square metres.
    fn areas<'a>(&'a self, x: &'a [f64]) -> impl Iterator<Item = Vector3<f64>> + 'a {
        let points = x.as_chunks::<3>().0;
        self.faces.iter().map(|corners| {
            let [a, b, c] = corners.map(|v| Vector3::from(points[v.index()]));
            (b - a).cross(&(c - a)) / 2.0
        })
    }

    /// The vector area of all, square metres.
    fn area(&self, x: &[f64]) -> Vector3<f64> {
        self.areas(x).sum()
    }

    /// The angle between the vector areas of both, degrees.
    pub(super) fn angle_to(&self, other: &Self, x: &[f64]) -> f64 {
        let (one, other) = (self.area(x), other.area(x));
        f64::atan2(one.cross(&other).norm(), one.dot(&other)).to_degrees()
    }
}
