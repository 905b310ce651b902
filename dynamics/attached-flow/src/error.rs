//! Why flow cannot be attached to a sheet.

use isosheet_dynamics::AirError;
use isosheet_mesh::{Advice, EdgeId, FaceId};

/// Why there cannot be such a flow.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum AttachedFlowError {
    /// The air makes no sense.
    #[error(transparent)]
    Air(#[from] AirError),
    /// A face does not exist.
    #[error("the flow is attached to {face}, but the sheet has only {face_count} faces")]
    NoSuchFace {
        /// The face.
        face: FaceId,
        /// Number of faces.
        face_count: usize,
    },
    /// There are too many faces.
    #[error("the flow is attached to {faces} faces, more than {most}")]
    TooManyFaces {
        /// Their number.
        faces: usize,
        /// The largest number.
        most: usize,
    },
    /// Nothing sheds a wake.
    #[error("the flow leaves the sheet at no edge")]
    NoTrailingEdge,
    /// A trailing edge is not at the rim of the faces.
    #[error(
        "{edge} is a trailing edge, but not at the rim of the faces that the flow is attached to"
    )]
    NotAtRim {
        /// The edge.
        edge: EdgeId,
    },
    /// The wake has too few rows, or too many.
    #[error("the wake has {rows} rows")]
    Rows {
        /// Their number.
        rows: usize,
    },
}

impl Advice for AttachedFlowError {
    fn advice(&self) -> Option<&'static str> {
        match self {
            Self::Air(error) => error.advice(),
            Self::NoTrailingEdge | Self::NotAtRim { .. } => {
                Some("name edges of the boundary, where the air leaves the sheet")
            }
            Self::TooManyFaces { .. } => Some("take a coarser mesh, or separated flow"),
            Self::Rows { .. } => Some("give it from 2 to 10000 rows"),
            Self::NoSuchFace { .. } => None,
        }
    }
}
