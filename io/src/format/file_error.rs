//! Files that cannot be read or written.

use super::{DataError, WriteError};
use isosheet_mesh::Advice;
use std::fmt::Display;
use std::io;
use std::path::{Path, PathBuf};
use thiserror::Error;

/// A file or a folder that cannot be read, or is not what it should be.
#[derive(Debug, Error)]
#[error("{message}")]
pub struct ReadError {
    /// The file or the folder.
    pub path: PathBuf,
    message: String,
    source: Option<io::Error>,
    remedy: &'static str,
}

impl ReadError {
    /// What the system says of a file or a folder that is to be read.
    pub fn new(path: &Path, source: io::Error) -> Self {
        Self {
            path: path.to_owned(),
            message: format!("cannot read {}: {source}", path.display()),
            source: Some(source),
            remedy: "check the path and the permissions",
        }
    }

    /// What is wrong with the content of a file, and what to do.
    pub(crate) fn content(path: &Path, problem: impl Display, remedy: &'static str) -> Self {
        Self {
            path: path.to_owned(),
            message: format!("{}: {problem}", path.display()),
            source: None,
            remedy,
        }
    }

    /// Whether there is nothing of this name.
    #[cfg(feature = "run")]
    pub(crate) fn is_missing(&self) -> bool {
        let kind = self.source.as_ref().map(io::Error::kind);
        kind == Some(io::ErrorKind::NotFound)
    }
}

impl Advice for ReadError {
    fn advice(&self) -> Option<&'static str> {
        Some(self.remedy)
    }
}

/// A history, a trajectory or another file of a run that cannot be read or written.
#[derive(Debug, Error)]
#[non_exhaustive]
pub enum FileError {
    /// What is to be written has a number that is not finite, or does not fit together.
    #[error(transparent)]
    Data(#[from] DataError),
    /// The file cannot be read, or is not what it should be.
    #[error(transparent)]
    Read(#[from] ReadError),
    /// The file cannot be written.
    #[error(transparent)]
    Write(#[from] WriteError),
}

impl Advice for FileError {
    fn advice(&self) -> Option<&'static str> {
        match self {
            Self::Data(error) => error.advice(),
            Self::Read(error) => error.advice(),
            Self::Write(error) => error.advice(),
        }
    }
}
