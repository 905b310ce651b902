//! Files that somebody else may have made: what is read, and what is found where a file is to be written.
//!
//! Inputs are regular files: a pipe or a device would be waited for, or read until memory ends. What a file
//! names is looked for in its own folder alone. A file that is written on is not looked for through links.

use std::fs::{self, File, Metadata, OpenOptions};
use std::io::{self, ErrorKind, Read};
use std::path::{Component, Path, PathBuf};

/// The largest file that is read as a whole, bytes: some twenty million triangles of a mesh.
pub const LARGEST: u64 = 2 << 30;

/// Opens a regular file to be read.
pub fn open(path: &Path) -> io::Result<File> {
    // What opening a device does is not known, so that it is not tried.
    refuse_irregular(&fs::metadata(path)?)?;
    regular(File::options().read(true), &[Flag::Immediately], path)
}

/// Reads a regular file as a whole.
pub fn read(path: &Path) -> io::Result<Vec<u8>> {
    let file = open(path)?;
    let length = file.metadata()?.len();
    let mut bytes = Vec::new();
    bytes.try_reserve(length.min(LARGEST) as usize)?;
    file.take(LARGEST + 1).read_to_end(&mut bytes)?;
    if bytes.len() as u64 > LARGEST {
        let problem = format!("it has more than {LARGEST} bytes");
        return Err(io::Error::new(ErrorKind::FileTooLarge, problem));
    }
    Ok(bytes)
}

/// The bytes of a text without the mark of their order, with which some programs begin UTF-8.
pub fn without_mark(bytes: &[u8]) -> &[u8] {
    bytes.strip_prefix(b"\xef\xbb\xbf").unwrap_or(bytes)
}

/// Reads a regular file of text as a whole.
pub fn read_text(path: &Path) -> io::Result<String> {
    String::from_utf8(without_mark(&read(path)?).to_vec()).map_err(|error| {
        let at = error.utf8_error().valid_up_to();
        let problem = format!("byte {at} is not UTF-8, as text has to be");
        io::Error::new(ErrorKind::InvalidData, problem)
    })
}

/// The file that a file of a folder names: it lies in that folder or beneath it, by its name and with all
/// links followed.
pub fn within(folder: &Path, name: &Path) -> io::Result<PathBuf> {
    let outside = || {
        let problem = "it leads out of its folder";
        io::Error::new(ErrorKind::PermissionDenied, problem)
    };
    let is_plain = |part| matches!(part, Component::Normal(_) | Component::CurDir);
    if !name.components().all(is_plain) {
        return Err(outside());
    }
    let folder = match folder.as_os_str().is_empty() {
        true => Path::new(".").canonicalize()?,
        false => folder.canonicalize()?,
    };
    let path = folder.join(name).canonicalize()?;
    match path.starts_with(&folder) {
        true => Ok(path),
        false => Err(outside()),
    }
}

/// Makes a new file in place of one of this name. A link is replaced, and what it leads to stays.
pub fn replace(path: &Path) -> io::Result<File> {
    match fs::symlink_metadata(path) {
        Ok(found) if found.is_symlink() || found.is_file() => fs::remove_file(path)?,
        Ok(found) => refuse_irregular(&found)?,
        Err(error) if error.kind() == ErrorKind::NotFound => {}
        Err(error) => return Err(error),
    }
    File::create_new(path)
}

/// Opens a regular file to write on it as `options` say, where no link has its name.
pub fn reopen(path: &Path, options: &mut OpenOptions) -> io::Result<File> {
    match fs::symlink_metadata(path) {
        Ok(found) => refuse_irregular(&found)?,
        Err(error) if error.kind() == ErrorKind::NotFound => {}
        Err(error) => return Err(error),
    }
    regular(options, &[Flag::Immediately, Flag::NoLink], path)
}

/// How a file is opened, where the system can be told.
#[derive(Clone, Copy)]
enum Flag {
    /// Nothing is waited for.
    Immediately,
    /// A link is refused.
    NoLink,
}

/// Opens a file, and refuses all but regular ones: by then another may have the name that was looked at.
fn regular(options: &mut OpenOptions, flags: &[Flag], path: &Path) -> io::Result<File> {
    #[cfg(unix)]
    {
        use rustix::fs::OFlags;
        use std::os::unix::fs::OpenOptionsExt;
        let flag = |flag: &Flag| match flag {
            Flag::Immediately => OFlags::NONBLOCK,
            Flag::NoLink => OFlags::NOFOLLOW,
        };
        let all: OFlags = flags.iter().map(flag).collect();
        options.custom_flags(all.bits() as i32);
    }
    #[cfg(not(unix))]
    let _ = flags;
    let file = options.open(path)?;
    refuse_irregular(&file.metadata()?)?;
    Ok(file)
}

fn refuse_irregular(found: &Metadata) -> io::Result<()> {
    if found.is_file() {
        return Ok(());
    }
    if found.is_dir() {
        return Err(io::Error::new(ErrorKind::IsADirectory, "it is a folder"));
    }
    let what = match found.is_symlink() {
        true => "it is a link",
        false => "it is a pipe or a device, and no regular file",
    };
    Err(io::Error::new(ErrorKind::InvalidInput, what))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_a_file_names_lies_in_its_folder() {
        let dir = tempfile::tempdir().unwrap();
        let folder = dir.path().join("scene");
        fs::create_dir_all(folder.join("meshes")).unwrap();
        fs::write(dir.path().join("secret"), "s").unwrap();
        fs::write(folder.join("meshes/a.bin"), "a").unwrap();
        let inside = within(&folder, Path::new("./meshes/a.bin")).unwrap();
        assert_eq!(read(&inside).unwrap(), b"a");
        for name in ["../secret", "meshes/../../secret", "/etc/hostname"] {
            let error = within(&folder, Path::new(name)).unwrap_err();
            assert_eq!(error.kind(), ErrorKind::PermissionDenied, "{name}");
        }
        #[cfg(unix)]
        {
            std::os::unix::fs::symlink(dir.path(), folder.join("link")).unwrap();
            let error = within(&folder, Path::new("link/secret")).unwrap_err();
            assert_eq!(error.kind(), ErrorKind::PermissionDenied);
        }
    }

    #[cfg(unix)]
    #[test]
    fn devices_are_not_read_and_links_not_written_through() {
        for device in ["/dev/zero", "/dev/null"] {
            let error = read(Path::new(device)).unwrap_err();
            assert!(error.to_string().contains("a device"), "{error}");
        }
        let dir = tempfile::tempdir().unwrap();
        let (target, link) = (dir.path().join("target"), dir.path().join("link"));
        fs::write(&target, "mine").unwrap();
        std::os::unix::fs::symlink(&target, &link).unwrap();
        assert!(reopen(&link, File::options().write(true)).is_err());
        drop(replace(&link).unwrap());
        assert_eq!(fs::read_to_string(&target).unwrap(), "mine");
        assert_eq!(fs::read_to_string(&link).unwrap(), "");
        assert!(replace(Path::new("/dev/null")).is_err());
        // As a device, what is no file keeps its place.
        let socket = dir.path().join("socket");
        let _listener = std::os::unix::net::UnixListener::bind(&socket).unwrap();
        assert!(crate::write_atomically(&socket, |_| Ok(())).is_err());
        assert!(fs::symlink_metadata(&socket).is_ok_and(|found| !found.is_file()));
    }
}
