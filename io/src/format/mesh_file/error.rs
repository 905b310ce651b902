//! What can be wrong with a mesh file.

mod fold;
mod gltf;

pub use fold::FoldProblem;
pub use gltf::GltfProblem;

use isosheet_mesh::wording::given;
use std::fmt;
use std::path::PathBuf;

use isosheet_mesh::{Advice, MeshError};
use thiserror::Error;

use super::MeshFormat;

/// Where in a file something is wrong.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[non_exhaustive]
pub enum Place {
    /// A line of a text file, counted from 1.
    Line(usize),
    /// A byte of a binary file, counted from 0.
    Byte(usize),
    /// A face, counted from 0 in the order of the file.
    Face(usize),
}

impl fmt::Display for Place {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Line(line) => write!(f, "line {line}"),
            Self::Byte(byte) => write!(f, "byte {byte}"),
            Self::Face(face) => write!(f, "face {face}, counted from 0"),
        }
    }
}

/// What is wrong, with its place where there is one.
pub(super) type Located = (Option<Place>, MeshFileProblem);

/// A mesh file that cannot be read, with the place.
#[derive(Debug, Error)]
#[error("{}{}: {problem}", path.display(), place.map(|p| format!(", {p}")).unwrap_or_default())]
pub struct MeshFileError {
    /// The file.
    pub path: PathBuf,
    /// The place, where there is one to blame.
    pub place: Option<Place>,
    /// What is wrong.
    #[source]
    pub problem: MeshFileProblem,
}

impl Advice for MeshFileError {
    fn advice(&self) -> Option<&'static str> {
        self.problem.advice()
    }
}

/// What is wrong with a mesh file.
#[derive(Debug, Error)]
#[non_exhaustive]
pub enum MeshFileProblem {
    /// The extension is not that of a format that is read.
    #[error(
        "{} is no known format of meshes (known are {})",
        if extension.is_empty() { "a name without extension".to_owned() } else { format!(".{extension}") },
        known_extensions()
    )]
    Extension {
        /// The extension found, without a dot.
        extension: String,
    },
    /// The option `weld` is not a length.
    #[error("the tolerance for welding vertices is {tolerance}", tolerance = given(*tolerance))]
    WeldTolerance {
        /// The value.
        tolerance: f64,
    },
    /// A frame was asked for in a file that is no FOLD file.
    #[error("a frame is asked for, and only FOLD files have frames")]
    NoFrames,
    /// A mesh was named, and the file is no glTF file.
    #[error("a mesh is named, and only the meshes of glTF files have names")]
    NoNames,
    /// The file could not be opened or read.
    #[error("cannot read the file: {0}")]
    Read(std::io::Error),
    /// There is nothing in it but comments.
    #[error("the file has no vertices and no faces: it is empty, or was cut short")]
    Empty,
    /// Other lines, no vertices.
    #[error("the file has no vertices, and its first unknown word is {word:?}")]
    NotObj {
        /// The first word that no OBJ line starts with.
        word: String,
    },
    /// Vertices, no faces.
    #[error(
        "the file has {vertices} vertices, {lines} line elements and {points} point elements, but no \
         faces"
    )]
    NoFaces {
        /// The number of vertices.
        vertices: usize,
        /// The number of line elements.
        lines: usize,
        /// The number of point elements.
        points: usize,
    },
    /// Faces, no vertices.
    #[error("the file has {faces} faces but no vertices")]
    NoVertices {
        /// The number of faces.
        faces: usize,
    },
    /// A vertex line of an OBJ file does not hold three or more numbers.
    #[error("a vertex needs three numbers, found {found:?}")]
    BadVertex {
        /// The rest of the line.
        found: String,
    },
    /// A coordinate is NaN or infinite.
    #[error(
        "coordinate {} of vertex {vertex} is {value}", ["x", "y", "z"][*axis],
        value = given(*value)
    )]
    NonFinite {
        /// The vertex, counted as the file does: from 1 in OBJ, from 0 in all others.
        vertex: usize,
        /// 0, 1, 2 for x, y, z.
        axis: usize,
        /// The value.
        value: f64,
    },
    /// A weight other than 1.
    #[error(
        "vertex {vertex} has the weight {weight}, and weights, which belong to curves, are not \
         supported",
        weight = given(*weight)
    )]
    Weight {
        /// The vertex, counted from 1.
        vertex: usize,
        /// The weight.
        weight: f64,
    },
    /// A corner of a face of an OBJ file is not an index.
    #[error("{found:?} is not a vertex index")]
    BadIndex {
        /// The text found.
        found: String,
    },
    /// A corner of a face refers to a vertex that does not exist.
    #[error(
        "a face refers to vertex {index}, but there are {count} vertices, counted from {first}"
    )]
    IndexOutOfRange {
        /// The index as written.
        index: i64,
        /// How many vertices there are.
        count: usize,
        /// The number of the first vertex: 1 in OBJ, 0 in all others.
        first: i64,
    },
    /// A face with fewer than three corners.
    #[error("a face has {corners} corners, and needs at least three")]
    TooFewCorners {
        /// How many.
        corners: usize,
    },
    /// A face with more than three corners.
    #[error("a face has {corners} corners, and a rigid sheet is made of triangles")]
    Polygon {
        /// How many.
        corners: usize,
    },
    /// A polygon whose outline crosses or touches itself, or has no area.
    #[error(
        "the outline of a face of {corners} corners crosses or touches itself, or has no area, so that it cannot be \
         cut into triangles"
    )]
    CrossedPolygon {
        /// How many corners.
        corners: usize,
    },
    /// A polygon with too many corners.
    #[error(
        "a face has {corners} corners, more than the {limit} of a polygon that is cut into triangles"
    )]
    LargePolygon {
        /// How many.
        corners: usize,
        /// The limit.
        limit: usize,
    },
    /// More vertices than 32-bit numbers can count.
    #[error("the file has {vertices} vertices, more than 32-bit numbers can count")]
    TooManyVertices {
        /// How many.
        vertices: usize,
    },
    /// A word of a text file is not what the format has there.
    #[error("expected {expected}, found {found:?}")]
    Syntax {
        /// What the format has there.
        expected: String,
        /// The text found.
        found: String,
    },
    /// The file ends too early.
    #[error("the file ends before {missing}: it was cut short")]
    Truncated {
        /// What is missing.
        missing: String,
    },
    /// The header announces more than the file can hold.
    #[error(
        "the header announces {count} {what}, which need {needed} bytes, but {available} bytes follow"
    )]
    Announced {
        /// What is announced.
        what: String,
        /// How many.
        count: u64,
        /// The least number of bytes that they need.
        needed: u64,
        /// The number of bytes that follow the header.
        available: u64,
    },
    /// A PLY file that breaks the rules of its format.
    #[error("{0}")]
    Ply(String),
    /// A facet of an STL file that breaks the rules of the format.
    #[error("facet {facet} (from 0): {problem}")]
    Stl {
        /// The facet.
        facet: usize,
        /// What is wrong.
        problem: String,
    },
    /// A FOLD file is no JSON, or its arrays are not what the format has.
    #[error("the file is not valid FOLD: {0}")]
    Json(serde_json::Error),
    /// What a FOLD file says does not fit together.
    #[error(transparent)]
    Fold(#[from] FoldProblem),
    /// A glTF file that cannot be used.
    #[error(transparent)]
    Gltf(#[from] GltfProblem),
    /// The vertices and faces are not a sheet.
    #[error(transparent)]
    Mesh(#[from] MeshError),
}

impl Advice for MeshFileProblem {
    fn advice(&self) -> Option<&'static str> {
        match self {
            Self::Extension { .. } => Some("convert the file to a known format"),
            Self::WeldTolerance { .. } => {
                Some("give a length of 0 or more in the unit of the file")
            }
            Self::NoFrames => Some("leave the frame out"),
            Self::NoNames => Some("leave the name out"),
            Self::Read(..) => Some("check the path and the permissions"),
            Self::Empty | Self::Truncated { .. } => Some("copy or export it again"),
            Self::NotObj { .. } => Some("check that it is an OBJ file"),
            Self::NoFaces { .. } => Some("export it with its faces"),
            Self::NoVertices { .. } => Some("export it with its vertices"),
            Self::BadVertex { .. } => Some("write `v x y z`"),
            Self::NonFinite { .. } => Some("export it with finite coordinates"),
            Self::Weight { .. } => Some("write the point itself"),
            Self::BadIndex { .. } => Some("write `f 1 2 3` or `f 1/1/1 2/2/2 3/3/3`"),
            Self::IndexOutOfRange { .. } => {
                Some("the file is damaged or incomplete: copy or export it again")
            }
            Self::TooFewCorners { .. } => Some("remove it or complete it"),
            Self::Polygon { .. } => Some(
                "triangulate the file, or ask for `Polygons::Triangulate` (each diagonal is a new crease)",
            ),
            Self::CrossedPolygon { .. } => Some("correct the face, or remove it"),
            Self::LargePolygon { .. } => Some("triangulate the file first"),
            Self::TooManyVertices { .. } => Some("split it"),
            Self::Syntax { .. } | Self::Ply(..) | Self::Stl { .. } | Self::Json(..) => {
                Some("correct the file or export it again")
            }
            Self::Announced { .. } => Some(
                "the file is damaged, was cut short or has another format than its name says: copy or export it again",
            ),
            Self::Fold(error) => error.advice(),
            Self::Gltf(error) => error.advice(),
            Self::Mesh(error) => error.advice(),
        }
    }
}

fn known_extensions() -> String {
    let names = MeshFormat::ALL.map(|f| format!(".{}", f.extension()));
    names.join(", ")
}

/// The first characters of a text, for an error.
pub(super) fn excerpt(text: &str) -> String {
    text.chars().take(30).collect()
}
