//! Why a trajectory cannot be recorded, written or read.

use crate::format::DataError;
use crate::format::atomic::WriteError;
use isosheet_mesh::Advice;
use std::io;
use std::path::PathBuf;
use thiserror::Error;

/// A trajectory that cannot be recorded, written or read.
#[derive(Debug, Error)]
#[non_exhaustive]
pub enum TrajectoryError {
    /// A frame cannot be recorded.
    #[error(transparent)]
    Frame(#[from] DataError),
    /// There are no frames at this rate.
    #[error(transparent)]
    Rate(DataError),
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
            Self::Frame(error) | Self::Rate(error) => error.advice(),
            Self::File(error) => error.advice(),
            Self::Read { .. } => Some("check that it is an .npz file"),
            Self::Array { .. } => {
                Some("give a trajectory that this program wrote, and that memory can hold")
            }
        }
    }
}
