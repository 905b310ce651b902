//! Files that cannot be read or written.

use crate::DataError;
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

/// A file could not be written; nothing is left under its name that was not there before. Or one that is to
/// be replaced could not be removed.
#[derive(Debug, Error)]
#[non_exhaustive]
pub enum WriteError {
    /// The path does not end in a file name.
    #[error("{} does not name a file", path.display())]
    NoFileName {
        /// The path.
        path: PathBuf,
    },
    /// There is a folder of that name.
    #[error("{} is a folder", path.display())]
    IsFolder {
        /// The path.
        path: PathBuf,
    },
    /// The folder of the file could not be made.
    #[error("cannot create the folder {}: {source}", folder.display())]
    CreateFolder {
        /// The folder.
        folder: PathBuf,
        /// What the system said.
        source: io::Error,
    },
    /// The folder does not take a new file.
    #[error("cannot create a file in {}: {source}", folder.display())]
    CreateFile {
        /// The folder.
        folder: PathBuf,
        /// What the system said.
        source: io::Error,
    },
    /// Writing failed half way.
    #[error("cannot write {}: {source}", path.display())]
    Write {
        /// The file.
        path: PathBuf,
        /// What the system said.
        source: io::Error,
    },
    /// The complete file could not be given its name.
    #[error("cannot put the finished file in place as {}: {source}", path.display())]
    Persist {
        /// The file.
        path: PathBuf,
        /// What the system said.
        source: io::Error,
    },
    /// A file of an earlier export could not be removed.
    #[error("cannot remove {}, which an earlier export has left: {source}", path.display())]
    Remove {
        /// The file.
        path: PathBuf,
        /// What the system said.
        source: io::Error,
    },
}

impl Advice for WriteError {
    fn advice(&self) -> Option<&'static str> {
        match self {
            Self::NoFileName { .. } => Some("give a path that ends in a file name"),
            Self::IsFolder { .. } => Some("choose another file name or move the folder away"),
            Self::CreateFolder { .. } => Some("check the name and the permissions"),
            Self::CreateFile { .. } => Some("check the permissions and the free space"),
            Self::Write { .. } => Some("check the free space"),
            Self::Persist { .. } => Some("check that no other program holds it"),
            Self::Remove { .. } => Some("remove it, and check the permissions of the folder"),
        }
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
    pub fn unreadable(path: &Path, source: io::Error) -> Self {
        Self::Read(ReadError {
            path: path.to_owned(),
            message: format!("cannot read {}: {source}", path.display()),
            source: Some(source),
            remedy: "check the path and the permissions",
        })
    }

    /// What the system says of a file that is being written.
    pub fn unwritable(path: &Path, source: io::Error) -> Self {
        let path = path.to_owned();
        Self::Write(WriteError::Write { path, source })
    }

    /// What is wrong with the content of a file, and what to do.
    pub fn content(path: &Path, problem: impl Display, remedy: &'static str) -> Self {
        Self::Read(ReadError {
            path: path.to_owned(),
            message: format!("{}: {problem}", path.display()),
            source: None,
            remedy,
        })
    }

    /// Whether what is to be read is not there.
    pub fn is_missing(&self) -> bool {
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
