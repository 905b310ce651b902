//! Why coordinates cannot be assigned.

use isosheet_mesh::wording::brief;
use isosheet_mesh::{Advice, VertexId};
use thiserror::Error;

/// Why coordinates cannot be assigned.
#[derive(Clone, Copy, Debug, PartialEq, Error)]
#[non_exhaustive]
pub enum AssignmentError {
    /// A pin or start names a vertex that the mesh does not have.
    #[error("{vertex} does not exist, the mesh has {count} vertices")]
    NoSuchVertex {
        /// The vertex.
        vertex: VertexId,
        /// Number of vertices.
        count: usize,
    },
    /// A vertex is listed twice among pins and starts.
    #[error("{vertex} is listed twice among pins and starts")]
    Repeated {
        /// The vertex.
        vertex: VertexId,
    },
    /// A start vertex lies in a component that already has a pin or a start.
    #[error("start {vertex} lies in a component that has a pin or another start")]
    UnusedStart {
        /// The vertex.
        vertex: VertexId,
    },
    /// The state has the wrong number of values.
    #[error("the state has {found} values, expected {expected} (three per vertex)")]
    StateLength {
        /// Values given.
        found: usize,
        /// Values needed.
        expected: usize,
    },
    /// An option is out of range.
    #[error("option volume is {volume}", volume = brief(*volume))]
    Volume {
        /// Its value.
        volume: f64,
    },
}

impl Advice for AssignmentError {
    fn advice(&self) -> Option<&'static str> {
        match self {
            Self::Repeated { .. } => Some("list it once"),
            Self::UnusedStart { .. } => Some("remove it"),
            Self::Volume { .. } => {
                Some("give a value from 0 to 1, the volumes that three unit vectors can span")
            }
            Self::NoSuchVertex { .. } | Self::StateLength { .. } => None,
        }
    }
}
