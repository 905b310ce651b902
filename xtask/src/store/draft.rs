//! Units in the making.

use super::error::{StoreError, writing};
use std::fs;
use std::path::PathBuf;
use tempfile::TempDir;

/// A unit in the making: dropped without [`Store::commit`](super::Store::commit) it leaves no trace.
#[derive(Debug)]
pub(crate) struct Draft {
    pub(super) folder: TempDir,
    /// Its files and folders, relative to the output folder.
    pub(super) entries: Vec<String>,
}

impl Draft {
    /// Adds a file, given relative to the output folder.
    pub(crate) fn write(&mut self, path: &str, bytes: &[u8]) -> Result<(), StoreError> {
        let target = self.folder.path().join(path);
        let failed = writing(&target);
        if let Some(parent) = target.parent() {
            fs::create_dir_all(parent).map_err(&failed)?;
        }
        fs::write(&target, bytes).map_err(&failed)?;
        self.entries.push(path.to_owned());
        Ok(())
    }

    /// Adds a folder, given relative to the output folder, and returns where to fill it.
    pub(crate) fn folder(&mut self, path: &str) -> Result<PathBuf, StoreError> {
        let target = self.folder.path().join(path);
        fs::create_dir_all(&target).map_err(writing(&target))?;
        self.entries.push(path.to_owned());
        Ok(target)
    }
}
