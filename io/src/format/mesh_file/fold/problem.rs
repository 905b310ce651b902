//! What can be wrong with a FOLD file.

use thiserror::Error;

/// What a FOLD file says does not fit together.
#[derive(Clone, Debug, PartialEq, Error)]
#[non_exhaustive]
pub enum FoldProblem {
    /// There is no such frame.
    #[error("there is no frame {frame}; the file has the frames 0 to {last}")]
    NoFrame {
        /// The frame that was asked for.
        frame: usize,
        /// The last frame.
        last: usize,
    },
    /// A frame inherits from one that does not exist, from itself in a circle, or over too many frames.
    #[error(
        "frame {frame} inherits from frame {parent}, which does not exist, inherits from it in turn, or has too many ancestors; correct `frame_parent`"
    )]
    Parent {
        /// The frame.
        frame: usize,
        /// The frame that it names.
        parent: usize,
    },
    /// No frame has vertices.
    #[error("no frame has `vertices_coords`; the file has no shape: export it with coordinates")]
    NoCoordinates,
    /// The unit is unknown.
    #[error("the unit {found:?} is unknown; the format has unit, in, pt, m, cm, mm, um and nm")]
    Unit {
        /// The text found.
        found: String,
    },
    /// A vertex with fewer than two coordinates.
    #[error("vertex {vertex} has {count} coordinates; give two or three")]
    Coordinates {
        /// The vertex, from 0.
        vertex: usize,
        /// How many it has.
        count: usize,
    },
    /// A vertex with a fourth coordinate.
    #[error(
        "vertex {vertex} has a fourth coordinate; only the space of three dimensions is supported"
    )]
    Dimension {
        /// The vertex, from 0.
        vertex: usize,
    },
    /// An array of edges has another length than `edges_vertices`.
    #[error("`{array}` has {got} entries for {edges} edges; it needs one for each edge")]
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
        "edge {edge} refers to vertex {vertex}, but there are {count} vertices, counted from 0; correct `edges_vertices`"
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
    #[error("edge {edge} has the assignment {found:?}; the format has B, M, V, F, U, C and J")]
    Assignment {
        /// The edge, from 0.
        edge: usize,
        /// The text found.
        found: String,
    },
    /// A fold angle out of range.
    #[error("edge {edge} has the fold angle {degrees} degrees; give -180 to 180")]
    Angle {
        /// The edge, from 0.
        edge: usize,
        /// The angle, in degrees.
        degrees: f64,
    },
    /// There are no faces, and the vertices are not those of a flat crease pattern.
    #[error(
        "the file has no `faces_vertices`, and its vertices do not lie in the plane z = 0; faces are made of flat crease patterns only: export the file with its faces"
    )]
    NoFacesInSpace,
    /// Two edges of a crease pattern without faces meet where there is no vertex.
    #[error(
        "the file has no `faces_vertices`, and its edges {first} and {second} meet where they have no vertex in common; add the vertex, or export the file with its faces"
    )]
    Crossing {
        /// The first edge, from 0.
        first: usize,
        /// The second edge, from 0.
        second: usize,
    },
    /// An edge of a crease pattern without faces has no length, or is there twice.
    #[error(
        "the file has no `faces_vertices`, and its edge {edge} has no length or is there twice; remove it, or export the file with its faces"
    )]
    UselessEdge {
        /// The edge, from 0.
        edge: usize,
    },
    /// A crease of a pattern without faces ends inside of a face.
    #[error(
        "the file has no `faces_vertices`, and vertex {vertex} is an end of one edge only; connect it to the other edges, or export the file with its faces"
    )]
    LooseEnd {
        /// The vertex, from 0.
        vertex: usize,
    },
    /// A crease pattern without faces is in pieces.
    #[error(
        "the file has no `faces_vertices`, and its edges make {pieces} separate pieces; split the file, or export it with its faces"
    )]
    Pieces {
        /// How many.
        pieces: usize,
    },
    /// A crease pattern without faces is too large.
    #[error(
        "the file has no `faces_vertices`, and its {edges} edges are more than the {limit} of which faces are made; export it with its faces"
    )]
    TooManyEdges {
        /// The number of edges.
        edges: usize,
        /// The limit.
        limit: usize,
    },
}
