//! How the program fails: what is said, and the exit code.

use crate::interrupt::Interrupted;
use anyhow::Error;
use std::process::ExitCode;

/// An error with its causes, each unless the text before holds it already: many messages name their cause.
fn explain(error: &Error) -> String {
    let mut text = error.to_string();
    for cause in error.chain().skip(1).map(ToString::to_string) {
        if !text.contains(&cause) {
            text.push_str(": ");
            text.push_str(&cause);
        }
    }
    text
}

/// Says what went wrong, and returns the exit code: 130 after Ctrl-C, and 1 otherwise.
pub(crate) fn report(error: &Error) -> ExitCode {
    eprintln!("error: {}", explain(error));
    let is_stopped = error.chain().any(|cause| cause.is::<Interrupted>());
    ExitCode::from(if is_stopped { 130 } else { 1 })
}

#[cfg(test)]
mod tests {
    use super::*;
    use isosheet_files::{FileError, WriteError};

    #[test]
    fn causes_are_told_once() {
        let error = Error::from(FileError::from(WriteError::Write {
            path: "a".into(),
            source: std::io::Error::other("disk full"),
        }));
        let error = error.context("figure 3");
        assert_eq!(explain(&error), "figure 3: cannot write a: disk full");
    }
}
