//! Numbered files of an export, one for each frame.

use crate::{FileError, WriteError};
use std::ffi::OsStr;
use std::fs;
use std::io::ErrorKind;
use std::path::{Path, PathBuf};

/// The files `NAME_00000.EXTENSION` and so on of a folder: their names sort as their numbers do.
#[derive(Clone, Debug)]
pub struct NumberedFiles {
    folder: PathBuf,
    name: &'static str,
    extension: String,
}

impl NumberedFiles {
    /// The files of a name and an extension in a folder, which need not exist.
    pub fn new(folder: &Path, name: &'static str, extension: &str) -> Self {
        Self {
            folder: folder.to_owned(),
            name,
            extension: extension.to_owned(),
        }
    }

    /// The name of the file of a number.
    pub fn name(&self, number: usize) -> String {
        format!("{}_{number:05}.{}", self.name, self.extension)
    }

    /// The file of a number.
    pub fn path(&self, number: usize) -> PathBuf {
        self.folder.join(self.name(number))
    }

    /// The number of the file that has a name, if it is one that [`name`](Self::name) gives.
    pub fn number(&self, name: &OsStr) -> Option<usize> {
        let stem = name.to_str()?.strip_suffix(&self.extension)?;
        let digits = stem.strip_suffix('.')?.strip_prefix(self.name)?;
        let number = digits.strip_prefix('_')?.parse().ok()?;
        (name == OsStr::new(&self.name(number))).then_some(number)
    }

    /// Removes the files of other numbers than these (ascending), which an earlier export has left, and
    /// returns how many there were. Files of other names and folders stay. For exports whose own files are
    /// complete.
    ///
    /// # Errors
    /// [`FileError`] if the folder cannot be listed or a file cannot be removed.
    pub fn keep_only(&self, numbers: &[usize]) -> Result<usize, FileError> {
        let unreadable = |source| FileError::unreadable(&self.folder, source);
        let entries = match fs::read_dir(&self.folder) {
            Ok(entries) => entries,
            Err(error) if error.kind() == ErrorKind::NotFound => return Ok(0),
            Err(error) => return Err(unreadable(error)),
        };
        let mut removed = 0;
        for entry in entries {
            let entry = entry.map_err(unreadable)?;
            let number = self.number(&entry.file_name());
            let is_kept = number.is_none_or(|number| numbers.binary_search(&number).is_ok());
            if is_kept || entry.file_type().map_err(unreadable)?.is_dir() {
                continue;
            }
            let path = entry.path();
            fs::remove_file(&path).map_err(|source| WriteError::Remove { path, source })?;
            removed += 1;
        }
        Ok(removed)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Nothing is removed but files whose names the export itself would give.
    #[test]
    fn other_files_stay() {
        let dir = tempfile::tempdir().unwrap();
        let files = NumberedFiles::new(dir.path(), "frame", "obj");
        let stale = ["frame_00001.obj", "frame_00003.obj", "frame_123456.obj"];
        let others = [
            "frame_00000.obj",
            "frame_00002.obj",
            "frame_1.obj",
            "frame_000001.obj",
            "frame_00001.OBJ",
            "frame_00001.obj.bak",
            "frame_00001.png",
            "frame_00001obj",
            "frame_+0001.obj",
            "frame_-0001.obj",
            "my_frame_00001.obj",
            "bodies_00001.obj",
            ".frame_00001.obj",
        ];
        for name in stale.iter().chain(&others) {
            fs::write(dir.path().join(name), name).unwrap();
        }
        let folder = files.path(9);
        fs::create_dir(&folder).unwrap();
        assert_eq!(files.keep_only(&[0, 2]).unwrap(), stale.len());
        for name in stale {
            assert!(!dir.path().join(name).exists(), "{name}");
        }
        for name in others {
            assert!(dir.path().join(name).exists(), "{name}");
        }
        assert!(folder.is_dir());
        assert_eq!(files.keep_only(&[0, 2]).unwrap(), 0);
        let missing = NumberedFiles::new(&dir.path().join("none"), "frame", "obj");
        assert_eq!(missing.keep_only(&[]).unwrap(), 0);
    }

    #[test]
    fn numbers_come_back_from_names() {
        let files = NumberedFiles::new(Path::new("a"), "frame", "vtp");
        for (number, name) in [(0, "frame_00000.vtp"), (1_234_567, "frame_1234567.vtp")] {
            assert_eq!(files.path(number), Path::new("a").join(name));
            assert_eq!(files.number(OsStr::new(name)), Some(number));
        }
    }
}
