//! Why the output folder cannot be used.

use std::path::{Path, PathBuf};

/// Why the output folder cannot be used.
#[derive(Debug, thiserror::Error)]
pub(crate) enum StoreError {
    #[error("cannot write to the folder {}: {source}; choose another with --out", folder.display())]
    Unwritable {
        folder: PathBuf,
        source: std::io::Error,
    },
    #[error(
        "{} holds files that are not results of this program; choose an empty or a new folder with --out", folder.display()
    )]
    Foreign { folder: PathBuf },
    #[error("another process is writing to {}; wait for it or choose another folder with --out", folder.display())]
    Busy { folder: PathBuf },
    #[error("cannot write {}: {source}", path.display())]
    Write {
        path: PathBuf,
        source: std::io::Error,
    },
    #[error("cannot read {}: {source}", path.display())]
    Read {
        path: PathBuf,
        source: std::io::Error,
    },
}

/// The error of a file that cannot be written.
pub(super) fn writing(path: &Path) -> impl Fn(std::io::Error) -> StoreError {
    let path = path.to_owned();
    move |source| StoreError::Write {
        path: path.clone(),
        source,
    }
}

/// The error of a file or folder that cannot be read.
pub(super) fn reading(path: &Path) -> impl Fn(std::io::Error) -> StoreError {
    let path = path.to_owned();
    move |source| StoreError::Read {
        path: path.clone(),
        source,
    }
}
