//! Directions of a material.

use crate::vectors::point;
use isosheet_mesh::{Advice, FaceId, Sheet};
use nalgebra::Vector3;

/// A direction of the material of a sheet at rest, such as the machine direction of paper or the warp of a
/// cloth: vectors at the rest positions, of any length, of which the part in the plane of a face counts.
#[derive(Debug, Clone, PartialEq)]
pub enum MaterialDirection {
    /// A uniform direction.
    Uniform([f64; 3]),
    /// One for each face.
    Faces(Vec<[f64; 3]>),
}

/// Why a direction of the material is none.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum DirectionError {
    /// There are not as many vectors as faces.
    #[error("{found} directions are given for {expected} faces")]
    Count {
        /// How many there are.
        found: usize,
        /// Number of faces.
        expected: usize,
    },
    /// A vector has no part in the plane of a face.
    #[error("the direction ({x}, {y}, {z}) has no part in the plane of {face}", x = vector[0], y = vector[1], z = vector[2])]
    Face {
        /// The face.
        face: FaceId,
        /// The vector.
        vector: [f64; 3],
    },
}

impl Advice for DirectionError {
    fn advice(&self) -> Option<&'static str> {
        match self {
            Self::Count { .. } => Some("give one vector for each face"),
            Self::Face { .. } => Some("give vectors along the sheet at rest"),
        }
    }
}

/// Part of its length that a vector must have in the plane of a face: below, its direction there is round-off
/// of the positions.
const LEAST_PART: f64 = 1e-6;

impl MaterialDirection {
    /// The angle of the direction from the first edge of a face (from its first corner to its second one)
    /// towards its third corner, radians, at the rest positions of a sheet.
    ///
    /// # Errors
    /// [`DirectionError`].
    pub fn angle(&self, sheet: &Sheet, face: FaceId) -> Result<f64, DirectionError> {
        let expected = sheet.topology().face_count();
        let vector = match self {
            Self::Uniform(vector) => *vector,
            Self::Faces(vectors) => {
                let found = vectors.len();
                let error = DirectionError::Count { found, expected };
                if found != expected {
                    return Err(error);
                }
                vectors[face.index()]
            }
        };
        let corners = sheet.topology().faces()[face.index()];
        let [a, b, c] = corners.map(|v| point(sheet.positions(), v));
        let first = (b - a).normalize();
        let second = (c - a) - first * first.dot(&(c - a));
        let second = second.normalize();
        let direction = Vector3::from(vector);
        let [along, across] = [first, second].map(|axis| axis.dot(&direction));
        let is_in_plane = along.hypot(across) > LEAST_PART * direction.norm();
        match is_in_plane {
            true => Ok(across.atan2(along)),
            false => Err(DirectionError::Face { face, vector }),
        }
    }
}
