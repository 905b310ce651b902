//! Files that appear only when they are complete.

use crate::file_error::{FileError, WriteError};
use std::fs::{self, File};
use std::io::{self, BufWriter, Write};
use std::path::{Path, PathBuf};

/// What [`write_atomically`] hands to its closure: buffered, and seekable as zip archives need it.
pub type FileWriter<'a> = BufWriter<&'a File>;

/// How the names of temporary files begin.
const PREFIX: &str = ".";

/// How the names of temporary files end.
const SUFFIX: &str = ".part";

/// Whether a file is what [`write_atomically`] leaves when the process is killed.
pub fn is_unfinished(name: &std::ffi::OsStr) -> bool {
    let name = name.to_string_lossy();
    name.starts_with(PREFIX) && name.ends_with(SUFFIX)
}

/// Creates the missing parent folders of `path` and returns the folder; refuses a path of something else than
/// a file.
pub fn prepare_folder(path: &Path) -> Result<PathBuf, FileError> {
    if path.file_name().is_none() {
        let path = path.to_owned();
        return Err(WriteError::NoFileName { path }.into());
    }
    if path.is_dir() {
        let path = path.to_owned();
        return Err(WriteError::IsFolder { path }.into());
    }
    // A device or a pipe would lose its place to the file.
    if path.exists() && !path.is_file() {
        let source = io::Error::new(io::ErrorKind::InvalidInput, "it is no regular file");
        return Err(FileError::unwritable(path, source));
    }
    let folder = match path.parent() {
        Some(p) if !p.as_os_str().is_empty() => p.to_owned(),
        _ => PathBuf::from("."),
    };
    match fs::create_dir_all(&folder) {
        Ok(()) => Ok(folder),
        Err(source) => Err(WriteError::CreateFolder { folder, source }.into()),
    }
}

/// Writes a file so that it is either complete or not there: `write` fills a temporary file in the same
/// folder, which then takes the name `path`, replacing an older file. Missing parent folders are created.
///
/// When `write` fails, when the process is killed or the disk is full, an older file of that name stays as it
/// was.
///
/// ```
/// use std::io::Write;
/// # let folder = tempfile::tempdir()?;
/// # let path = folder.path().join("runs/note.txt");
/// isosheet_files::write_atomically(&path, |w| writeln!(w, "done"))?;
/// assert_eq!(std::fs::read_to_string(&path)?, "done\n");
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
///
/// # Errors
/// [`FileError::Write`] naming the file or folder; errors that `write` returns become [`WriteError::Write`].
pub fn write_atomically<T>(
    path: &Path,
    write: impl FnOnce(&mut FileWriter<'_>) -> io::Result<T>,
) -> Result<T, FileError> {
    let folder = prepare_folder(path)?;
    let failed = |source| FileError::unwritable(path, source);
    let mut builder = tempfile::Builder::new();
    builder.prefix(PREFIX).suffix(SUFFIX);
    // Temporary files are private by default; a result should be as readable as any other new file.
    #[cfg(unix)]
    builder.permissions(std::os::unix::fs::PermissionsExt::from_mode(0o666));
    let file = builder
        .tempfile_in(&folder)
        .map_err(|e| WriteError::CreateFile {
            folder,
            source: without_path(e),
        })?;
    let value = {
        let mut buffered = BufWriter::new(file.as_file());
        let value = write(&mut buffered).map_err(failed)?;
        buffered.flush().map_err(failed)?;
        value
    };
    match file.persist(path) {
        Ok(_) => Ok(value),
        Err(e) => {
            let (path, source) = (path.to_owned(), e.error);
            Err(WriteError::Persist { path, source }.into())
        }
    }
}

/// The error of the system without the name of the temporary file.
fn without_path(error: io::Error) -> io::Error {
    match error.kind() {
        io::ErrorKind::Other => error,
        kind => kind.into(),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn entries(folder: &Path) -> Vec<String> {
        let mut names: Vec<String> = fs::read_dir(folder)
            .unwrap()
            .map(|e| e.unwrap().file_name().into_string().unwrap())
            .collect();
        names.sort();
        names
    }

    #[test]
    fn replaces_whole_files_and_leaves_nothing_behind() {
        let dir = tempfile::tempdir().unwrap();
        let path = dir.path().join("a/b/c.txt");
        write_atomically(&path, |w| w.write_all(b"first")).unwrap();
        let error = write_atomically(&path, |w| {
            w.write_all(&[b'x'; 100_000])?;
            Err::<(), _>(io::Error::other("out of ideas"))
        });
        let text = error.unwrap_err().to_string();
        assert!(
            text.contains("c.txt") && text.contains("out of ideas"),
            "{text}"
        );
        assert_eq!(
            fs::read_to_string(&path).unwrap(),
            "first",
            "the older file is untouched"
        );
        assert_eq!(
            write_atomically(&path, |w| w.write_all(b"second").map(|()| 7)).unwrap(),
            7
        );
        assert_eq!(fs::read_to_string(&path).unwrap(), "second");
        assert_eq!(entries(path.parent().unwrap()), ["c.txt"]);
    }

    #[test]
    fn a_panic_leaves_nothing_behind() {
        let dir = tempfile::tempdir().unwrap();
        let path = dir.path().join("c.txt");
        let result = std::panic::catch_unwind(|| {
            let _ = write_atomically(&path, |_| -> io::Result<()> { panic!("interrupted") });
        });
        assert!(result.is_err());
        assert!(entries(dir.path()).is_empty());
    }

    #[cfg(unix)]
    #[test]
    fn results_are_readable_by_others_as_far_as_the_mask_allows() {
        use std::os::unix::fs::PermissionsExt;
        let dir = tempfile::tempdir().unwrap();
        let (path, plain) = (dir.path().join("c.txt"), dir.path().join("plain.txt"));
        write_atomically(&path, |w| w.write_all(b"x")).unwrap();
        fs::write(&plain, b"x").unwrap();
        let mode = |p: &Path| fs::metadata(p).unwrap().permissions().mode();
        assert_eq!(mode(&path), mode(&plain));
    }

    #[test]
    fn bad_places_are_named() {
        let dir = tempfile::tempdir().unwrap();
        let file = dir.path().join("file");
        fs::write(&file, b"x").unwrap();
        let inside_a_file = file.join("sub/c.txt");
        assert!(matches!(
            write_atomically(&inside_a_file, |_| Ok(())),
            Err(FileError::Write(WriteError::CreateFolder { .. }))
        ));
        assert!(matches!(
            write_atomically(dir.path(), |_| Ok(())),
            Err(FileError::Write(WriteError::IsFolder { .. }))
        ));
        assert!(matches!(
            write_atomically(Path::new(".."), |_| Ok(())),
            Err(FileError::Write(WriteError::NoFileName { .. }))
        ));
        assert!(matches!(
            write_atomically(Path::new(""), |_| Ok(())),
            Err(FileError::Write(WriteError::NoFileName { .. }))
        ));
    }
}
