//! What can be wrong with a mesh file.

use isosheet_files::DataError;
use isosheet_mesh::wording::counted;
use isosheet_mesh::{Advice, MeshError, TopologyError};
use std::fmt;
use std::path::PathBuf;
use thiserror::Error;

/// Where in a file something is wrong.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[non_exhaustive]
pub enum Location {
    /// A line of a text file, counted from 1.
    Line(usize),
    /// A byte of a binary file, counted from 0.
    Byte(usize),
    /// A face, counted from 0 in the order of the file.
    Face(usize),
}

impl fmt::Display for Location {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Line(line) => write!(f, "line {line}"),
            Self::Byte(byte) => write!(f, "byte {byte}"),
            Self::Face(face) => write!(f, "face {face}, counted from 0"),
        }
    }
}

/// What is wrong, with its place where there is one.
pub(super) type Located = (Option<Location>, MeshFileProblem);

/// A mesh file that cannot be read, with the place.
#[derive(Debug, Error)]
#[error("{}{}: {problem}", path.display(), place.map(|p| format!(", {p}")).unwrap_or_default())]
pub struct MeshFileError {
    /// The file.
    pub path: PathBuf,
    /// The place, where there is one to blame.
    pub place: Option<Location>,
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
    /// An option is out of range.
    #[error(transparent)]
    Options(DataError),
    /// The frame that is asked for is not there, or the format has no frames.
    #[error(transparent)]
    Frame(DataError),
    /// The mesh of the name that is asked for is not there, or the format has no names of meshes.
    #[error(transparent)]
    Name(DataError),
    /// The file could not be opened or read.
    #[error("cannot read the file: {0}")]
    Read(std::io::Error),
    /// A face with more than three corners, where polygons are refused.
    #[error(transparent)]
    Polygon(DataError),
    /// The file breaks the rules of its format, has no faces, or says what does not fit together.
    #[error(transparent)]
    Data(#[from] DataError),
    /// The vertices and faces are not a sheet.
    #[error("{0}{numbered}", numbered = numbered(.0))]
    Mesh(#[from] MeshError),
}

/// How the vertices and faces are numbered that an error names: files of some formats count from 1.
fn numbered(error: &MeshError) -> &'static str {
    match error {
        MeshError::Topology(TopologyError::NoFaces | TopologyError::TooLarge { .. })
        | MeshError::WrongLength { .. } => "",
        _ => "; vertices and faces count from 0",
    }
}

impl Advice for MeshFileProblem {
    fn advice(&self) -> Option<&'static str> {
        match self {
            Self::Options(error)
            | Self::Frame(error)
            | Self::Name(error)
            | Self::Polygon(error)
            | Self::Data(error) => error.advice(),
            Self::Read(..) => Some("check the path and the permissions"),
            Self::Mesh(error) => error.advice(),
        }
    }
}

/// The first characters of a text, for an error.
pub(super) fn excerpt(text: &str) -> String {
    text.chars().take(30).collect()
}

/// What is to be done about a file that lacks something, or has something else than it should.
pub(super) const COPY: &str = "copy or export it again";
pub(super) const CORRECT: &str = "correct the file or export it again";

/// A word of a text file is not what the format has there.
pub(super) fn unexpected(expected: &str, found: &str) -> DataError {
    DataError::new(format!("expected {expected}, found {found:?}"), CORRECT)
}

/// The file ends too early.
pub(super) fn cut_short(missing: &str) -> DataError {
    let message = format!("the file ends before {missing}: it was cut short");
    DataError::new(message, COPY)
}

/// The header announces more than fits into the bytes that follow it.
pub(super) fn announced(what: &str, count: u64, needed: u64, available: u64) -> DataError {
    let message = format!(
        "the header announces {count} {what}, which need {needed} bytes, but {available} bytes follow"
    );
    let remedy = "the file is damaged, was cut short or has another format than its name says: copy or export it again";
    DataError::new(message, remedy)
}

/// A face refers to one of so many vertices that does not exist; `first` is the number of the first one.
pub(super) fn no_such_vertex(index: i64, count: usize, first: i64) -> DataError {
    let message = format!(
        "a face refers to vertex {index}, but the file has {}, counted from {first}",
        counted(count, "vertex", "vertices")
    );
    let remedy = "the file is damaged or incomplete: copy or export it again";
    DataError::new(message, remedy).value(index as f64)
}
