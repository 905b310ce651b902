//! Errors that say what to do.

use std::error::Error;

/// An error that says what to do about it.
///
/// The text of an error ([`Display`](std::fmt::Display)) is short and says what is wrong, with the values at
/// which it was found. What to do is kept apart from it, so that a program can show both, and a table of
/// results the text alone.
///
/// ```
/// use isosheet_mesh::{Advice, Sheet};
/// let error = Sheet::new(vec![0.0; 9], &[]).unwrap_err();
/// assert_eq!(error.to_string(), "the mesh has no faces");
/// assert_eq!(error.advice(), Some("give at least one triangle"));
/// assert_eq!(error.with_advice(), "the mesh has no faces; give at least one triangle");
/// ```
pub trait Advice: Error {
    /// What to do, as a clause that can follow the text of the error and a semicolon. `None` where the text
    /// says all that is known.
    fn advice(&self) -> Option<&'static str>;

    /// The text of the error and, after a semicolon, the advice.
    fn with_advice(&self) -> String {
        match self.advice() {
            Some(advice) => format!("{self}; {advice}"),
            None => self.to_string(),
        }
    }
}
