//! What can be wrong with a mesh: each error names the element, the value and the remedy.

use crate::Advice;
use crate::wording::{brief, given};
use thiserror::Error;

use crate::{EdgeId, FaceId, VertexId};

/// A face list that does not describe an oriented surface.
#[derive(Clone, Debug, PartialEq, Error)]
#[non_exhaustive]
pub enum TopologyError {
    /// The face list is empty.
    #[error("the mesh has no faces")]
    NoFaces,
    /// More vertices or faces than 32-bit ids can count.
    #[error("the mesh has {count} {what}, more than the {limit} that 32-bit ids can number")]
    TooLarge {
        /// "vertices" or "faces".
        what: &'static str,
        /// How many there are.
        count: usize,
        /// How many there may be.
        limit: usize,
    },
    /// A corner refers to a vertex that does not exist.
    #[error(
        "{face} refers to vertex {vertex}, but there are only {vertex_count} vertices (indices start \
         at 0)"
    )]
    IndexOutOfRange {
        /// The face.
        face: FaceId,
        /// The index found.
        vertex: u32,
        /// The number of vertices.
        vertex_count: usize,
    },
    /// A face uses one vertex twice.
    #[error("{face} uses {vertex} more than once, so it is not a triangle")]
    RepeatedVertex {
        /// The face.
        face: FaceId,
        /// The repeated vertex.
        vertex: VertexId,
    },
    /// Two faces have the same three corners.
    #[error("{first} and {second} have the same three corners {corners:?}")]
    DuplicateFace {
        /// The first of the two.
        first: FaceId,
        /// The second.
        second: FaceId,
        /// The corners, sorted.
        corners: [u32; 3],
    },
    /// More than two faces meet at an edge.
    #[error(
        "{count} faces meet at the edge between {a} and {b} (among them {}, {} and {}), and a \
         surface has at most two",
        faces[0], faces[1], faces[2]
    )]
    NonManifoldEdge {
        /// One end of the edge.
        a: VertexId,
        /// The other end.
        b: VertexId,
        /// How many faces have this edge.
        count: usize,
        /// The first three of them.
        faces: [FaceId; 3],
    },
    /// Two neighbouring faces run along their common edge in the same direction.
    #[error("{first} and {second} both run from {a} to {b}, so their windings disagree")]
    InconsistentWinding {
        /// Tail of the edge as both faces see it.
        a: VertexId,
        /// Head of the edge as both faces see it.
        b: VertexId,
        /// One of the faces.
        first: FaceId,
        /// The other.
        second: FaceId,
    },
    /// The faces around a vertex form more than one fan.
    #[error(
        "the {degree} faces at {vertex} form more than one fan ({reached} of them are connected \
         through edges): a bow tie"
    )]
    BowTieVertex {
        /// The vertex.
        vertex: VertexId,
        /// The number of faces at the vertex.
        degree: usize,
        /// The number of faces in the first fan.
        reached: usize,
    },
    /// No face uses a vertex.
    #[error("{vertex} belongs to no face")]
    UnreferencedVertex {
        /// The vertex.
        vertex: VertexId,
    },
    /// The surface has only one side.
    #[error(
        "the surface is not orientable (a Moebius band): going round it, {face} would have to be \
         wound both ways"
    )]
    NonOrientable {
        /// A face at which the two windings meet.
        face: FaceId,
    },
}

impl Advice for TopologyError {
    fn advice(&self) -> Option<&'static str> {
        match self {
            Self::NoFaces => Some("give at least one triangle"),
            Self::TooLarge { .. } => Some("split it into several sheets"),
            Self::IndexOutOfRange { .. } => Some("correct the index or add the vertex"),
            Self::RepeatedVertex { .. } => Some("remove the face"),
            Self::DuplicateFace { .. } => Some("remove one of them"),
            Self::NonManifoldEdge { .. } => {
                Some("separate the sheets there by duplicating the edge's vertices")
            }
            Self::InconsistentWinding { .. } => {
                Some("reverse the corners of one, or pass the faces through `orient_consistently`")
            }
            Self::BowTieVertex { .. } => Some("duplicate the vertex, one copy per fan"),
            Self::UnreferencedVertex { .. } => {
                Some("remove it (and renumber), or add the missing face")
            }
            Self::NonOrientable { .. } => Some("cut it open along some edges"),
        }
    }
}

/// A mesh that cannot be a sheet of rigid triangles.
#[derive(Clone, Debug, PartialEq, Error)]
#[non_exhaustive]
pub enum MeshError {
    /// The faces are not a surface.
    #[error(transparent)]
    Topology(#[from] TopologyError),
    /// The position array has the wrong length.
    #[error("the position array has {got} numbers, but three per vertex are needed ({expected})")]
    WrongLength {
        /// Its length.
        got: usize,
        /// The length needed.
        expected: usize,
    },
    /// A coordinate is NaN or infinite.
    #[error("coordinate {} of {vertex} is {value}", ["x", "y", "z"][*axis], value = given(*value))]
    NonFinite {
        /// The vertex.
        vertex: VertexId,
        /// 0, 1, 2 for x, y, z.
        axis: usize,
        /// The value found.
        value: f64,
    },
    /// The corners of a face lie on a line, or at one point.
    #[error(
        "{face} has no area: its altitude over its longest edge is {relative_altitude} of that \
         edge ({longest} long), less than {limit}",
        relative_altitude = brief(*relative_altitude),
        longest = brief(*longest),
        limit = given(*limit)
    )]
    ZeroAreaFace {
        /// The face.
        face: FaceId,
        /// The altitude over the longest edge divided by that edge.
        relative_altitude: f64,
        /// The length of the longest edge, in metres.
        longest: f64,
        /// The smallest relative altitude that is accepted.
        limit: f64,
    },
    /// A length or area over- or underflows.
    #[error(
        "{edge} has length {length} m, outside the range 1e-70 to 1e70 m in which squared areas \
         can be formed",
        length = brief(*length)
    )]
    LengthOutOfRange {
        /// The edge.
        edge: EdgeId,
        /// Its length.
        length: f64,
    },
    /// The angles about an interior vertex do not add up to a full turn.
    #[error(
        "the angles about {vertex} add up to 2 pi minus {defect:.3e} rad, more than {tolerance} \
         from a full turn, so the sheet cannot be laid flat there",
        tolerance = given(*tolerance)
    )]
    NotDevelopable {
        /// The vertex.
        vertex: VertexId,
        /// 2 pi minus the angle sum, in radians.
        defect: f64,
        /// What was allowed.
        tolerance: f64,
    },
    /// A mass or density is not a positive number.
    #[error("the {what} is {value}", value = given(*value))]
    NotPositive {
        /// Which quantity.
        what: &'static str,
        /// The value found.
        value: f64,
    },
}

impl Advice for MeshError {
    fn advice(&self) -> Option<&'static str> {
        match self {
            Self::Topology(error) => error.advice(),
            Self::WrongLength { .. } => Some("pass x0 y0 z0 x1 y1 z1 and so on"),
            Self::NonFinite { .. } => Some("give finite coordinates"),
            Self::ZeroAreaFace { .. } => Some("remove the face or move its corners apart"),
            Self::LengthOutOfRange { .. } => Some("change the unit"),
            Self::NotDevelopable { .. } => Some("flatten it, or cut it open at this vertex"),
            Self::NotPositive { .. } => Some("give a positive, finite number"),
        }
    }
}
