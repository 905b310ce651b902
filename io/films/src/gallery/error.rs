//! Why there is no gallery.

use isosheet_files::FileError;
use isosheet_mesh::Advice;
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
    /// The folder holds files that do not belong to a gallery.
    #[error("{} holds files and is not the folder of a gallery", folder.display())]
    Foreign {
        /// The folder.
        folder: PathBuf,
    },
    /// A link has the name of the folder of pages and pictures.
    #[error("{} is a link or no folder", path.display())]
    Linked {
        /// The folder.
        path: PathBuf,
    },
    /// A file or a folder cannot be read or written.
    #[error(transparent)]
    File(#[from] FileError),
}

impl Advice for GalleryError {
    fn advice(&self) -> Option<&'static str> {
        match self {
            Self::NoRuns { .. } => Some("name folders in which `isosheet simulate` has written"),
            Self::Foreign { .. } | Self::Linked { .. } => {
                Some("choose an empty or a new folder with --out")
            }
            Self::File(error) => error.advice(),
        }
    }
}

fn list(folders: &[PathBuf]) -> String {
    let names: Vec<String> = folders.iter().map(|f| f.display().to_string()).collect();
    names.join(", ")
}
