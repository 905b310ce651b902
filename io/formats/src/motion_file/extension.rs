//! What the end of a file's name says.

use std::path::Path;

/// Whether a name ends with this extension, in letters of either case.
pub(super) fn has_extension(path: &Path, extension: &str) -> bool {
    path.extension()
        .is_some_and(|e| e.eq_ignore_ascii_case(extension))
}
