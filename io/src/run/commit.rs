//! The commit that a program was built from.

use std::sync::OnceLock;

static COMMIT: OnceLock<String> = OnceLock::new();

/// Says which commit the program was built from. The summaries of all runs of the process note it
/// ([`Summary::commit`](super::Summary::commit)). Only the first call counts.
///
/// A program asks this of itself, because the crate does not depend on the commit: it would be compiled anew
/// at every commit of a repository that has it.
pub fn note_commit(commit: &str) {
    COMMIT.get_or_init(|| commit.to_owned());
}

/// What was noted.
pub(super) fn noted() -> Option<String> {
    COMMIT.get().cloned()
}
