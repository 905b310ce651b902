//! What can be wrong with a FOLD file.

use crate::format::mesh_file::{EdgeAssignment, FoldFrame};
use isosheet_mesh::Advice;
use isosheet_mesh::wording::brief;
use thiserror::Error;

/// What a FOLD file says does not fit together.
#[derive(Clone, Debug, PartialEq, Error)]
#[non_exhaustive]
pub enum FoldProblem {
    /// There is no such frame, or more than one of that title.
    #[error("{}; the frames of the file are {frames}", choice(wanted, found))]
    Choice {
        /// The frame that was asked for.
        wanted: FoldFrame,
        /// The numbers of the frames of that title: none or several.
        found: Vec<usize>,
        /// The frames of the file with their titles and classes, as text.
        frames: String,
    },
    /// A frame inherits from one that does not exist, from itself in a circle, or over too many frames.
    #[error(
        "frame {frame} inherits from frame {parent}, which does not exist, inherits from it in turn, \
         or has too many ancestors"
    )]
    Parent {
        /// The frame.
        frame: usize,
        /// The frame that it names.
        parent: usize,
    },
    /// No frame has vertices.
    #[error("no frame has `vertices_coords`, so the file has no shape")]
    NoCoordinates,
    /// The unit is unknown.
    #[error("the unit {found:?} is unknown")]
    Unit {
        /// The text found.
        found: String,
    },
    /// A vertex with fewer than two coordinates.
    #[error("vertex {vertex} has {count} coordinates")]
    Coordinates {
        /// The vertex, from 0.
        vertex: usize,
        /// How many it has.
        count: usize,
    },
    /// A vertex with a fourth coordinate.
    #[error("vertex {vertex} has a fourth coordinate")]
    Dimension {
        /// The vertex, from 0.
        vertex: usize,
    },
    /// An array of edges has another length than `edges_vertices`.
    #[error("`{array}` has {got} entries for {edges} edges")]
    Length {
        /// The array.
        array: &'static str,
        /// Its length.
        got: usize,
        /// The number of edges.
        edges: usize,
    },
    /// An edge refers to a vertex that does not exist.
    #[error(
        "edge {edge} refers to vertex {vertex}, but there are {count} vertices, counted from 0"
    )]
    EdgeVertex {
        /// The edge, from 0.
        edge: usize,
        /// The vertex.
        vertex: u32,
        /// The number of vertices.
        count: usize,
    },
    /// An assignment that the format does not have.
    #[error("edge {edge} has the assignment {found:?}")]
    Assignment {
        /// The edge, from 0.
        edge: usize,
        /// The text found.
        found: String,
    },
    /// A fold angle out of range.
    #[error("edge {edge} has the fold angle {degrees} degrees", degrees = brief(*degrees))]
    Angle {
        /// The edge, from 0.
        edge: usize,
        /// The angle, in degrees.
        degrees: f64,
    },
    /// An edge leads from a vertex to the same vertex.
    #[error("edge {edge} leads from vertex {vertex} to the same vertex")]
    EdgeToItself {
        /// The edge, from 0.
        edge: usize,
        /// The vertex.
        vertex: u32,
    },
    /// An edge is listed twice.
    #[error("edges {first} and {second} are the same edge, between the vertices {} and {}", ends[0], ends[1])]
    EdgeTwice {
        /// The first one, from 0.
        first: usize,
        /// The second one, from 0.
        second: usize,
        /// The vertices at their ends.
        ends: [u32; 2],
    },
    /// The assignment of an edge and its fold angle exclude each other.
    #[error(
        "edge {edge} {assignment} and has the fold angle {degrees} degrees", degrees = brief(*degrees)
    )]
    Contradiction {
        /// The edge, from 0.
        edge: usize,
        /// What it is meant to do.
        assignment: EdgeAssignment,
        /// The angle, in degrees.
        degrees: f64,
    },
    /// A crease or a cut is a side of no face.
    #[error("edge {edge} is a crease or a cut, and no face of `faces_vertices` has it as a side")]
    NoFace {
        /// The edge, from 0.
        edge: usize,
    },
    /// A fold is between a face that is clockwise and one that is counter-clockwise.
    #[error(
        "edge {edge} folds between face {kept} and face {reversed}, whose vertices are listed in opposite          directions, so that it is a mountain as seen from one of them and a valley from the other"
    )]
    OppositeFaces {
        /// The edge, from 0.
        edge: usize,
        /// The face, from 0, whose direction stays.
        kept: usize,
        /// The face, from 0, that has to be reversed.
        reversed: usize,
    },
    /// There are no faces, and the vertices are not those of a flat crease pattern.
    #[error(
        "the file has no `faces_vertices`, and its vertices do not lie in the plane z = 0, in which \
         alone faces can be made"
    )]
    NoFacesInSpace,
    /// Two edges of a crease pattern without faces meet where there is no vertex.
    #[error(
        "the file has no `faces_vertices`, and its edges {first} and {second} meet where they have \
         no vertex in common"
    )]
    Crossing {
        /// The first edge, from 0.
        first: usize,
        /// The second edge, from 0.
        second: usize,
    },
    /// An edge of a crease pattern without faces has no length.
    #[error("the file has no `faces_vertices`, and its edge {edge} has no length")]
    UselessEdge {
        /// The edge, from 0.
        edge: usize,
    },
    /// A crease of a pattern without faces ends inside of a face.
    #[error("the file has no `faces_vertices`, and vertex {vertex} is an end of one edge only")]
    LooseEnd {
        /// The vertex, from 0.
        vertex: usize,
    },
    /// A crease pattern without faces is in pieces.
    #[error("the file has no `faces_vertices`, and its edges make {pieces} separate pieces")]
    Pieces {
        /// How many.
        pieces: usize,
    },
    /// A crease pattern without faces is too large.
    #[error(
        "the file has no `faces_vertices`, and its {edges} edges are more than the {limit} of which \
         faces are made"
    )]
    TooManyEdges {
        /// The number of edges.
        edges: usize,
        /// The limit.
        limit: usize,
    },
}

fn choice(wanted: &FoldFrame, found: &[usize]) -> String {
    match found.len() {
        0 => format!("there is no frame {wanted}"),
        count => format!("{count} frames have the title {wanted}"),
    }
}

impl Advice for FoldProblem {
    fn advice(&self) -> Option<&'static str> {
        match self {
            Self::Choice { .. } => Some("give the number of one of these"),
            Self::Parent { .. } => Some("correct `frame_parent`"),
            Self::NoCoordinates => Some("export it with coordinates"),
            Self::Unit { .. } => Some("use unit, in, pt, m, cm, mm, um or nm"),
            Self::Coordinates { .. } => Some("give two or three"),
            Self::Dimension { .. } => {
                Some("give two or three: only the space of three dimensions is supported")
            }
            Self::Length { .. } => Some("give one for each edge"),
            Self::EdgeVertex { .. } => Some("correct `edges_vertices`"),
            Self::Assignment { .. } => Some("use B, M, V, F, U, C or J"),
            Self::Angle { .. } => Some("give -180 to 180"),
            Self::EdgeToItself { .. } => Some("remove it"),
            Self::EdgeTwice { .. } => Some("remove one of them"),
            Self::Contradiction { .. } => Some(
                "correct one of them: mountains have negative angles, valleys positive ones, flat edges 0",
            ),
            Self::NoFace { .. } => Some("divide the face along it, or remove the edge"),
            Self::OppositeFaces { .. } => {
                Some("list the vertices of all faces counter-clockwise as seen from the same side")
            }
            Self::NoFacesInSpace => Some("export the file with its faces"),
            Self::Crossing { .. } => Some("add the vertex, or export the file with its faces"),
            Self::UselessEdge { .. } => Some("remove it, or export the file with its faces"),
            Self::LooseEnd { .. } => {
                Some("connect it to the other edges, or export the file with its faces")
            }
            Self::Pieces { .. } => Some("split the file, or export it with its faces"),
            Self::TooManyEdges { .. } => Some("export it with its faces"),
        }
    }
}
