//! Why a sheet cannot be unrolled.

use isosheet_linalg::LinalgError;
use isosheet_mesh::wording::{brief, counted, given};
use isosheet_mesh::{Advice, EdgeId, FaceId, MeshError, VertexId};
use thiserror::Error;

/// Why a sheet cannot be laid out in the plane.
#[derive(Clone, Debug, PartialEq, Error)]
#[non_exhaustive]
pub enum UnrollError {
    /// An option is out of range.
    #[error("{name} is {}, not within {} and {}", given(*value), given(*least), given(*most))]
    Option {
        /// Which option.
        name: &'static str,
        /// Its value.
        value: f64,
        /// The smallest value.
        least: f64,
        /// The largest value.
        most: f64,
    },
    /// The sheet does not have an edge that is to be cut.
    #[error("{edge} is to be cut, and the sheet has {}", counted(*count, "edge", "edges"))]
    NoEdge {
        /// The edge.
        edge: EdgeId,
        /// The number of edges of the sheet.
        count: usize,
    },
    /// The sheet is curved such that it does not lie flat without more strain than is accepted.
    #[error(
        "laid flat, the edge between {} and {} has the strain {} (limit {}): {} an angle deficit, the largest one \
         {} degrees at {vertex}", ends[0], ends[1], brief(*strain), given(*limit),
         counted(*count, "vertex inside has", "vertices inside have"), brief(deficit.to_degrees())
    )]
    Curved {
        /// The ends of the edge with the largest strain.
        ends: [VertexId; 2],
        /// Its strain, `length / rest length - 1`.
        strain: f64,
        /// The largest one that is accepted.
        limit: f64,
        /// How many vertices of the piece that no cut reaches have a deficit beyond round-off.
        count: usize,
        /// That with the largest deficit.
        vertex: VertexId,
        /// Its deficit, radians.
        deficit: f64,
    },
    /// A triangle of the layout is turned over.
    #[error(
        "laid flat, {face} is turned over: the largest angle deficit is {} degrees at {vertex}",
        brief(deficit.to_degrees())
    )]
    TurnedOver {
        /// The triangle.
        face: FaceId,
        /// The vertex of its piece with the largest deficit that no cut reaches.
        vertex: VertexId,
        /// Its deficit, radians.
        deficit: f64,
    },
    /// A piece lies on itself, and no cut was found that divides it there.
    #[error("laid flat, {} and {} of one piece lie on each other", faces[0], faces[1])]
    Overlap {
        /// The two triangles.
        faces: [FaceId; 2],
    },
    /// A piece is no sheet.
    #[error(transparent)]
    Mesh(#[from] MeshError),
    /// A system of equations has no solution.
    #[error(transparent)]
    Linalg(#[from] LinalgError),
}

impl UnrollError {
    /// The error with the numbers that vertices have in the mesh of which a sheet was made.
    pub fn numbered(self, number: impl Fn(VertexId) -> VertexId) -> Self {
        match self {
            Self::Curved {
                ends,
                strain,
                limit,
                count,
                vertex,
                deficit,
            } => Self::Curved {
                ends: ends.map(&number),
                strain,
                limit,
                count,
                vertex: number(vertex),
                deficit,
            },
            Self::TurnedOver {
                face,
                vertex,
                deficit,
            } => Self::TurnedOver {
                face,
                vertex: number(vertex),
                deficit,
            },
            other => other,
        }
    }
}

impl Advice for UnrollError {
    fn advice(&self) -> Option<&'static str> {
        Some(match self {
            Self::Option { .. } => "give a value in this range",
            Self::NoEdge { .. } => "name an edge of the sheet",
            Self::Curved { .. } => {
                "cut the sheet there, take smaller folds for creases so that corners on them are cut to, or accept \
                 this strain"
            }
            Self::TurnedOver { .. } => "cut the sheet at this vertex",
            Self::Overlap { .. } => "cut the piece between them",
            Self::Mesh(error) => return error.advice(),
            Self::Linalg(_) => "cut the sheet into smaller pieces",
        })
    }
}
