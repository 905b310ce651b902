//! Why a trajectory cannot be recorded, written or read.

use crate::format::atomic::WriteError;
use isosheet_mesh::wording::given;
use isosheet_mesh::{Advice, VertexId};
use std::io;
use std::path::PathBuf;
use thiserror::Error;

/// A trajectory that cannot be recorded, written or read.
#[derive(Debug, Error)]
#[non_exhaustive]
pub enum TrajectoryError {
    /// The positions of a frame have the wrong length.
    #[error(
        "frame {frame} has {got} coordinates, but the mesh has {vertices} vertices, three coordinates each"
    )]
    WrongLength {
        /// The frame.
        frame: usize,
        /// The length of its array.
        got: usize,
        /// The number of vertices.
        vertices: usize,
    },
    /// A coordinate is NaN or infinite.
    #[error(
        "coordinate {} of {vertex} in frame {frame} is {value}, and the frame was not recorded", ["x", "y", "z"][*axis],
        value = given(*value)
    )]
    NotFinite {
        /// The frame.
        frame: usize,
        /// The vertex.
        vertex: VertexId,
        /// 0, 1, 2 for x, y, z.
        axis: usize,
        /// The value.
        value: f64,
    },
    /// A frame has not as many values as the mesh needs, or as the frames before it have: all or none.
    #[error("frame {frame} has {got} values of `{array}` where {expected} are needed")]
    DataCount {
        /// The frame.
        frame: usize,
        /// The array.
        array: &'static str,
        /// The number of values given.
        got: usize,
        /// The number needed; zero if the frames before have none.
        expected: usize,
    },
    /// A value is NaN or infinite.
    #[error(
        "value {index} of `{array}` in frame {frame} is {value}, and the frame was not recorded",
        value = given(*value)
    )]
    DataNotFinite {
        /// The frame.
        frame: usize,
        /// The array.
        array: &'static str,
        /// The index in the values of the frame.
        index: usize,
        /// The value.
        value: f64,
    },
    /// Time does not go forward.
    #[error(
        "frame {frame} has the time {t} s after {before} s",
        t = given(*t), before = given(*before)
    )]
    Time {
        /// The frame.
        frame: usize,
        /// Its time, in seconds.
        t: f64,
        /// The time of the frame before, in seconds (minus infinity for the first).
        before: f64,
    },
    /// There are no frames at this rate.
    #[error(
        "{rate} frames a second from frame {first} to frame {last}: the trajectory has {frames} frames, counted \
         from 0"
    )]
    Rate {
        /// Frames a second.
        rate: f64,
        /// The first frame.
        first: usize,
        /// The last frame.
        last: usize,
        /// The number of frames.
        frames: usize,
    },
    /// The file could not be written.
    #[error(transparent)]
    File(#[from] WriteError),
    /// The file could not be opened or is not an archive.
    #[error("cannot read {}: {source}", path.display())]
    Read {
        /// The file.
        path: PathBuf,
        /// What is wrong.
        source: io::Error,
    },
    /// An array is missing or of another type or shape.
    #[error("array `{array}` of {}: {problem}", path.display())]
    Array {
        /// The file.
        path: PathBuf,
        /// The array.
        array: &'static str,
        /// What is wrong.
        problem: String,
    },
}

impl Advice for TrajectoryError {
    fn advice(&self) -> Option<&'static str> {
        match self {
            Self::NotFinite { .. } | Self::DataNotFinite { .. } => {
                Some("go back to the last state that was finite")
            }
            Self::Time { .. } => Some("record frames in the order of time"),
            Self::Rate { .. } => Some(
                "give a positive rate with at most 86 400 frames in all, and frames that exist, the first before \
                 the last",
            ),
            Self::File(error) => error.advice(),
            Self::Read { .. } => Some("check that it is an .npz file"),
            Self::Array { .. } => {
                Some("give a trajectory that this program wrote, and that memory can hold")
            }
            Self::DataCount { .. } => Some("give them in all frames or in none"),
            Self::WrongLength { .. } => None,
        }
    }
}
