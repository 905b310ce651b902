//! Why there is no gallery.

use crate::format::{JsonError, WriteError};
use isosheet_mesh::Advice;
use std::io;
use std::path::PathBuf;

/// Why a gallery cannot be made.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum GalleryError {
    /// There are no runs.
    #[error("there is no folder of a run in {}", list(folders))]
    NoRuns {
        /// Where they were looked for.
        folders: Vec<PathBuf>,
    },
    /// The folder holds files that are not those of a gallery.
    #[error("{} holds files and is not the folder of a gallery", folder.display())]
    Foreign {
        /// The folder.
        folder: PathBuf,
    },
    /// The entries name a run as no gallery does.
    #[error("{} names the run {name:?}, which is no name of a file of a gallery", path.display())]
    Name {
        /// The file with the entries.
        path: PathBuf,
        /// The name.
        name: String,
    },
    /// A link has the name of the folder of pages and pictures.
    #[error("{} is a link or no folder", path.display())]
    Linked {
        /// The folder.
        path: PathBuf,
    },
    /// A folder cannot be read.
    #[error("cannot read {}: {source}", path.display())]
    Read {
        /// The folder.
        path: PathBuf,
        /// What the system says.
        source: io::Error,
    },
    /// A file cannot be written.
    #[error(transparent)]
    Write(#[from] WriteError),
    /// The entries cannot be read or written.
    #[error(transparent)]
    Json(#[from] JsonError),
}

impl Advice for GalleryError {
    fn advice(&self) -> Option<&'static str> {
        match self {
            Self::NoRuns { .. } => Some("name folders in which `isosheet simulate` has written"),
            Self::Foreign { .. } | Self::Name { .. } | Self::Linked { .. } => {
                Some("choose an empty or a new folder with --out")
            }
            Self::Read { .. } => Some("check the path and the permissions"),
            Self::Write(error) => error.advice(),
            Self::Json(error) => error.advice(),
        }
    }
}

fn list(folders: &[PathBuf]) -> String {
    let names: Vec<String> = folders.iter().map(|f| f.display().to_string()).collect();
    names.join(", ")
}
