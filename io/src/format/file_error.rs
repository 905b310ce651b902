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

impl FileError {
    /// What the system says of a file or a folder that is to be read.
    pub(crate) fn unreadable(path: &Path, source: io::Error) -> Self {
        Self::Read(ReadError {
            path: path.to_owned(),
            message: format!("cannot read {}: {source}", path.display()),
            source: Some(source),
            remedy: "check the path and the permissions",
        })
    }

    /// What the system says of a file that is being written.
    pub(crate) fn unwritable(path: &Path, source: io::Error) -> Self {
        let path = path.to_owned();
        Self::Write(WriteError::Write { path, source })
    }

    /// What is wrong with the content of a file, and what to do.
    pub(crate) fn content(path: &Path, problem: impl Display, remedy: &'static str) -> Self {
        Self::Read(ReadError {
            path: path.to_owned(),
            message: format!("{}: {problem}", path.display()),
            source: None,
            remedy,
        })
    }

    /// Whether what is to be read is not there.
    #[cfg(feature = "run")]
    pub(crate) fn is_missing(&self) -> bool {
        let Self::Read(error) = self else {
            return false;
        };
        let kind = error.source.as_ref().map(io::Error::kind);
        kind == Some(io::ErrorKind::NotFound)
    }
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
