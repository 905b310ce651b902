//! Faces that are curved at rest.

use isosheet_mesh::FaceId;

/// A face of an [`ElasticSheet`](crate::ElasticSheet) that is curved without stress.
#[derive(Debug, Clone, Copy, PartialEq)]
#[non_exhaustive]
pub struct CurvedFace {
    /// The face.
    pub face: FaceId,
    /// The root mean square of the lengths of its edges, metres.
    pub size: f64,
    /// Its radius at rest, metres: of a cylinder that of the cylinder, of a sphere that of the sphere by the
    /// root of 2.
    pub radius: f64,
    /// Thickness of a homogeneous sheet with its stiffness in the plane and its flexural rigidity, metres.
    pub thickness: f64,
}

impl CurvedFace {
    /// Its size in units of the length `(R t)^1/2` over which a shell bends near its edges and where forces
    /// act on it.
    pub fn coarseness(&self) -> f64 {
        self.size / (self.radius * self.thickness).sqrt()
    }
}
