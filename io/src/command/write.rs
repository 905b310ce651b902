//! Files and text that subcommands write.

use super::failure::{Code, Done, Failure};
use super::printable::printable;
use std::io::Write;
use std::path::Path;

/// Writes text to stdout.
pub(crate) fn to_stdout(text: &str) -> Done {
    bytes_to_stdout(printable(text, &[]).as_bytes())
}

/// Writes bytes to stdout.
pub(crate) fn bytes_to_stdout(bytes: &[u8]) -> Done {
    match std::io::stdout().write_all(bytes) {
        // A reader such as `head` has enough.
        Err(e) if e.kind() == std::io::ErrorKind::BrokenPipe => Ok(()),
        Err(e) => {
            let message = format!("cannot write to standard output: {e}");
            let failure = Failure::new(Code::Output, message);
            Err(failure.remedy("check where it goes, and the free space there"))
        }
        Ok(()) => Ok(()),
    }
}

/// Whether two paths lead to one file or folder, by whatever names and links.
pub(crate) fn is_same_file(a: &Path, b: &Path) -> bool {
    #[cfg(unix)]
    {
        use std::os::unix::fs::MetadataExt;
        let id = |path: &Path| std::fs::metadata(path).map(|m| (m.dev(), m.ino())).ok();
        id(a).is_some() && id(a) == id(b)
    }
    #[cfg(not(unix))]
    {
        let place = |path: &Path| path.canonicalize().ok();
        place(a).is_some() && place(a) == place(b)
    }
}
