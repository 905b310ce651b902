//! Colours of a sheet by a quantity.

use super::error::PictureError;
use isosheet_files::DataError;
use isosheet_mesh::{EdgeId, Topology};

/// The sRGB colour of faces whose edges show values.
const PALE: [u8; 3] = [244, 244, 242];

/// sRGB colours of a sheet by a quantity.
#[derive(Clone, Debug, PartialEq)]
pub enum Colours {
    /// One colour for each vertex; on faces colours are interpolated.
    Vertices(Vec<[u8; 3]>),
    /// One for each edge, which is drawn as a bar on faces that are white.
    Edges(Vec<[u8; 3]>),
    /// One for each edge that is drawn as a bar, on faces with the colours of their sides.
    Creases(Vec<Option<[u8; 3]>>),
    /// One for each face.
    Faces(Vec<[u8; 3]>),
}

impl Colours {
    pub(super) fn validate(&self, topology: &Topology) -> Result<(), PictureError> {
        let (count, expected, what) = match self {
            Self::Vertices(colours) => (colours.len(), topology.vertex_count(), "vertices"),
            Self::Edges(colours) => (colours.len(), topology.edge_count(), "edges"),
            Self::Creases(colours) => (colours.len(), topology.edge_count(), "edges"),
            Self::Faces(colours) => (colours.len(), topology.face_count(), "faces"),
        };
        if count == expected {
            return Ok(());
        }
        let message = format!("there are {count} colours for {expected} {what}");
        let error = DataError::new(message, "give one for each");
        Err(PictureError::Data(error))
    }

    /// The colour of a corner of a face, by the numbers of both; none if it has that of its side.
    pub(super) fn of_corner(&self, face: usize, vertex: usize) -> Option<[u8; 3]> {
        match self {
            Self::Vertices(colours) => Some(colours[vertex]),
            Self::Faces(colours) => Some(colours[face]),
            Self::Edges(_) => Some(PALE),
            Self::Creases(_) => None,
        }
    }

    /// The colour of an edge that is drawn as a bar.
    pub(super) fn of_edge(&self, edge: EdgeId) -> Option<[u8; 3]> {
        match self {
            Self::Edges(colours) => Some(colours[edge.index()]),
            Self::Creases(colours) => colours[edge.index()],
            Self::Vertices(_) | Self::Faces(_) => None,
        }
    }
}
