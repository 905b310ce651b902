//! Why a model cannot be built.

use isosheet_mesh::wording::given;
use isosheet_mesh::{Advice, MeshError, VertexId};
use isosheet_motion::MotionError;

/// Why a model cannot be built.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum ModelError {
    /// The mass does not fit the sheet.
    #[error(transparent)]
    Mesh(#[from] MeshError),
    /// The mass matrix belongs to another sheet.
    #[error("the mass matrix is for {masses} vertices, the sheet has {vertex_count}")]
    MassLength {
        /// Vertices of the mass matrix.
        masses: usize,
        /// Vertices of the sheet.
        vertex_count: usize,
    },
    /// A vertex has no mass.
    #[error("{vertex} has mass {mass} kg", mass = given(*mass))]
    Mass {
        /// The vertex.
        vertex: VertexId,
        /// Its mass.
        mass: f64,
    },
    /// A pinned vertex does not exist.
    #[error("{vertex} is pinned, but the sheet has only {vertex_count} vertices")]
    NoSuchVertex {
        /// The vertex.
        vertex: VertexId,
        /// Number of vertices.
        vertex_count: usize,
    },
    /// A prescribed motion cannot be used.
    #[error("the motion prescribed for {vertex} cannot be used: {source}")]
    Motion {
        /// The vertex that is pinned or constrained.
        vertex: VertexId,
        /// What is wrong with its motion.
        source: MotionError,
    },
    /// The elastic sheet belongs to another sheet.
    #[error("the elastic sheet is made for {found} faces, the sheet has {face_count}")]
    ElasticSheet {
        /// Faces that it was built for.
        found: usize,
        /// Faces of the sheet.
        face_count: usize,
    },
    /// The damping rate is negative or not finite.
    #[error("damping rate is {rate}", rate = given(*rate))]
    Damping {
        /// The rate given, 1/s.
        rate: f64,
    },
}

impl Advice for ModelError {
    fn advice(&self) -> Option<&'static str> {
        match self {
            Self::Mesh(error) => error.advice(),
            Self::MassLength { .. } | Self::ElasticSheet { .. } => Some("build it for this sheet"),
            Self::Mass { .. } => Some("give every vertex that is not pinned a positive mass"),
            Self::Motion { source, .. } => source.advice(),
            Self::Damping { .. } => Some("give a finite rate of at least 0 per second"),
            Self::NoSuchVertex { .. } => None,
        }
    }
}
