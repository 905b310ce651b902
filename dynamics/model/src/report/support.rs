//! Supports of the sheet, by name.

use isosheet_mesh::VertexId;
use serde::Serialize;
use std::fmt;

/// A support of the sheet, by name.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Support {
    /// A pinned vertex.
    Pin(VertexId),
    /// A vertex on a curve or surface.
    Constraint {
        /// Place in the order in which the constraints were added, from 0.
        index: usize,
        /// The vertex.
        vertex: VertexId,
    },
}

impl Support {
    /// The vertex that it holds.
    pub fn vertex(&self) -> VertexId {
        let (Self::Pin(vertex) | Self::Constraint { vertex, .. }) = self;
        *vertex
    }
}

impl Serialize for Support {
    fn serialize<S: serde::Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        serializer.collect_str(self)
    }
}

impl fmt::Display for Support {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Pin(v) => write!(f, "the pin at {v}"),
            Self::Constraint { index, vertex } => write!(f, "constraint {index} at {vertex}"),
        }
    }
}
