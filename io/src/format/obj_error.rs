//! What can be wrong with an OBJ file.

use std::path::PathBuf;

use isosheet_mesh::MeshError;
use thiserror::Error;

/// An OBJ file that cannot be read, with the place.
#[derive(Debug, Error)]
#[error("{}{}: {problem}", path.display(), line.map(|l| format!(", line {l}")).unwrap_or_default())]
pub struct ObjError {
    /// The file.
    pub path: PathBuf,
    /// The line, counted from 1, where there is one to blame.
    pub line: Option<usize>,
    /// What is wrong.
    #[source]
    pub problem: ObjProblem,
}

/// What is wrong with an OBJ file.
#[derive(Debug, Error)]
#[non_exhaustive]
pub enum ObjProblem {
    /// The file could not be opened or read.
    #[error("cannot read the file: {0}; check the path")]
    Read(std::io::Error),
    /// There is nothing in it but comments.
    #[error("the file has no vertices and no faces; it is empty, or was cut short")]
    Empty,
    /// Other lines, no vertices.
    #[error(
        "the file has no vertices; its first unknown word is {word:?}, so it may not be an OBJ file"
    )]
    NotObj {
        /// The first word that no OBJ line starts with.
        word: String,
    },
    /// Vertices, no faces.
    #[error(
        "the file has {vertices} vertices, {lines} line elements and {points} point elements, but no faces; export it with its faces"
    )]
    NoFaces {
        /// The number of vertices.
        vertices: usize,
        /// The number of `l` lines.
        lines: usize,
        /// The number of `p` lines.
        points: usize,
    },
    /// Faces, no vertices.
    #[error("the file has {faces} faces but no vertices; export it with its vertices")]
    NoVertices {
        /// The number of faces.
        faces: usize,
    },
    /// A vertex line does not hold three or more numbers.
    #[error("a vertex needs three numbers, found {found:?}; write `v x y z`")]
    BadVertex {
        /// The rest of the line.
        found: String,
    },
    /// A coordinate is NaN or infinite.
    #[error("coordinate {} of vertex {vertex} is {value}; every coordinate must be finite", ["x", "y", "z"][*axis])]
    NonFinite {
        /// The vertex, counted from 1 as the file does.
        vertex: usize,
        /// 0, 1, 2 for x, y, z.
        axis: usize,
        /// The value.
        value: f64,
    },
    /// A weight other than 1.
    #[error(
        "vertex {vertex} has the weight {weight}; weights belong to curves and are not supported: write the point itself"
    )]
    Weight {
        /// The vertex, counted from 1.
        vertex: usize,
        /// The weight.
        weight: f64,
    },
    /// A corner of a face is not an index.
    #[error("{found:?} is not a vertex index; write `f 1 2 3` or `f 1/1/1 2/2/2 3/3/3`")]
    BadIndex {
        /// The text found.
        found: String,
    },
    /// A corner of a face refers to a vertex that does not exist.
    #[error(
        "a face refers to vertex {index}, but there are {count} vertices (counted from 1, or backwards from -1); the file is damaged or incomplete"
    )]
    IndexOutOfRange {
        /// The index as written.
        index: i64,
        /// How many vertices there are.
        count: usize,
    },
    /// A face with fewer than three corners.
    #[error("a face has {corners} corners; it needs at least three: remove it or complete it")]
    TooFewCorners {
        /// How many.
        corners: usize,
    },
    /// A face with more than three corners.
    #[error(
        "a face has {corners} corners; a rigid sheet is made of triangles, and a diagonal is a new crease: triangulate the file, or ask for `Polygons::Triangulate`"
    )]
    Polygon {
        /// How many.
        corners: usize,
    },
    /// A polygon that cannot be cut into triangles from one corner.
    #[error(
        "a face of {corners} corners cannot be cut into triangles from any one of its corners (it is too concave, or repeats a point); triangulate the file first"
    )]
    ConcavePolygon {
        /// How many.
        corners: usize,
    },
    /// The vertices and faces are not a sheet.
    #[error(transparent)]
    Mesh(#[from] MeshError),
}
