//! What makes a replay or its options unusable.

use isosheet_mesh::wording::{brief, given};
use isosheet_mesh::{Advice, TopologyError};
use thiserror::Error;

/// Why no page could be made of a [`Replay`](super::Replay).
#[derive(Debug, Clone, PartialEq, Error)]
#[non_exhaustive]
pub enum ViewError {
    /// There is no frame.
    #[error("the replay has no frames")]
    NoFrames,
    /// There is no face.
    #[error("the replay has no faces")]
    NoFaces,
    /// The triangles are not an oriented manifold.
    #[error("the triangles of the sheet: {0}")]
    Topology(#[from] TopologyError),
    /// A list has the wrong length.
    #[error("{what}: the length is {got} and has to be {expected}")]
    Length {
        /// The list.
        what: String,
        /// Its length.
        got: usize,
        /// The length that the mesh or the number of frames asks for.
        expected: usize,
    },
    /// A number is NaN or infinite, or so large that differences of such numbers are infinite.
    #[error("{what}: entry {index} is {value}", value = given(*value))]
    NotFinite {
        /// The list that has the number.
        what: String,
        /// Its index in the list.
        index: usize,
        /// The number.
        value: f64,
    },
    /// Times go backwards.
    #[error(
        "{what}: entry {index} is {time} s after {before} s",
        time = given(*time), before = given(*before)
    )]
    Time {
        /// The list of times.
        what: String,
        /// The index of the time.
        index: usize,
        /// The time, in seconds.
        time: f64,
        /// The time before, in seconds.
        before: f64,
    },
    /// An index names a vertex that does not exist.
    #[error(
        "{what}: entry {index} is the vertex {vertex}, but there are {vertices} vertices, counted from 0"
    )]
    Vertex {
        /// The list of indices.
        what: String,
        /// Where in the list.
        index: usize,
        /// The vertex.
        vertex: u32,
        /// The number of vertices.
        vertices: usize,
    },
    /// A length of a body is not positive.
    #[error("{what}: {name} is {value} m", value = given(*value))]
    BodyLength {
        /// The body.
        what: String,
        /// The length.
        name: &'static str,
        /// Its value, in metres.
        value: f64,
    },
    /// A body made of triangles has none.
    #[error("{what}: the mesh has no triangles")]
    NoBodyFaces {
        /// The body.
        what: String,
    },
    /// A quaternion does not have the length 1.
    #[error("{what}: the quaternion of pose {index} has the length {norm}", norm = brief(*norm))]
    Rotation {
        /// The body.
        what: String,
        /// The pose.
        index: usize,
        /// The length of its quaternion.
        norm: f64,
    },
    /// A logarithmic scale has no place for a negative number.
    #[error("{what}: entry {index} is {value}, which has no logarithm", value = given(*value))]
    Negative {
        /// The list that has the number.
        what: String,
        /// Its index in the list.
        index: usize,
        /// The number.
        value: f64,
    },
    /// The size that a page may have is too small for any page.
    #[error("the budget is {budget} bytes, but the program of the page alone has {least} bytes")]
    Budget {
        /// The size that the page may have.
        budget: usize,
        /// The size of a page without data.
        least: usize,
    },
    /// The page is too large even with two frames.
    #[error(
        "the page has {bytes} bytes with {frames} frames left, but the budget is {budget} bytes"
    )]
    TooLarge {
        /// The size of the page.
        bytes: usize,
        /// The number of frames that were left.
        frames: usize,
        /// The size that it may have.
        budget: usize,
    },
}

impl Advice for ViewError {
    fn advice(&self) -> Option<&'static str> {
        match self {
            Self::NoFrames => Some("give the positions at one time at least"),
            Self::NoFaces => Some("give the triangles of the sheet"),
            Self::Topology(error) => error.advice(),
            Self::NotFinite { .. } => Some("give finite numbers below 1e300 in size"),
            Self::Time { .. } => Some("give the times in ascending order"),
            Self::BodyLength { .. } => Some("give a positive length"),
            Self::NoBodyFaces { .. } => Some("give at least one"),
            Self::Rotation { .. } => Some("give a quaternion of length 1"),
            Self::Negative { .. } => Some("use a linear scale or sizes"),
            Self::Budget { .. } => Some("raise the budget"),
            Self::TooLarge { .. } => Some("raise the budget, or leave out fields or series"),
            Self::Length { .. } | Self::Vertex { .. } => None,
        }
    }
}
