//! Files and text that subcommands write.

use super::failure::{Code, Done, Failure};
use super::printable::printable;
use isosheet_runs::run_of_file;
use std::ffi::OsStr;
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

/// What is said of a file that a run has written; nothing of others.
fn belongs(out: &Path) -> Option<String> {
    let run = run_of_file(out)?;
    Some(format!(
        "{} is a file of the run in {}",
        out.display(),
        run.display()
    ))
}

/// Refuses to replace a file of a run by what is no part of it.
pub(super) fn refuse_file_of_run(out: &Path) -> Done {
    match belongs(out) {
        None => Ok(()),
        Some(message) => Err(Failure::misuse(message).remedy("choose another name")),
    }
}

/// Refuses to replace a file whose name ends otherwise than the names of what is written, such as a scene by
/// a page.
pub(super) fn refuse_other_kind(out: &Path, extensions: &[&str], what: &str) -> Done {
    let has = |e: &OsStr| extensions.iter().any(|known| e.eq_ignore_ascii_case(known));
    if !out.is_file() || out.extension().is_some_and(has) {
        return Ok(());
    }
    let other = || format!("{} is a file that is no {what}", out.display());
    let message = belongs(out).unwrap_or_else(other);
    let remedy = format!("choose another name, which ends with .{}", extensions[0]);
    Err(Failure::misuse(message).remedy(remedy))
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
