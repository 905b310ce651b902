//! The commit that a program was built from.

use isosheet_scenes::Warning;
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

/// What to know of a run that a program of another commit began. Nothing is known where one of them is.
pub(super) fn other_build(begun: Option<&str>, now: Option<&str>) -> Option<Warning> {
    let (begun, now) = begun.zip(now).filter(|(begun, now)| begun != now)?;
    Some(Warning::new(
        format!(
            "the run was begun by a program that was built from commit {begun}, and goes on with one from {now}: it may \
             not have the bits of a run by one of them alone"
        ),
        "continue it with the program that began it, or run the scene with --force, which replaces the run",
    ))
}

/// What was noted.
pub(super) fn noted() -> Option<String> {
    COMMIT.get().cloned()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_run_of_another_build_is_told() {
        let told = other_build(Some("aaaa"), Some("bbbb")).expect("other commits");
        assert!(told.message.contains("aaaa") && told.message.contains("bbbb"));
        for [begun, now] in [
            [Some("aaaa"), Some("aaaa")],
            [None, Some("bbbb")],
            [Some("aaaa"), None],
        ] {
            assert_eq!(other_build(begun, now), None);
        }
    }
}
