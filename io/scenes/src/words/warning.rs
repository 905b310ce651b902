//! What to know of a scene before it is run, and of a run before its results are used.

use isosheet_mesh::Advice;
use thiserror::Error;

/// A reason why a scene that can start may not do what was meant, or why the results of a complete run may
/// differ from a real sheet.
#[derive(Clone, Debug, PartialEq, Eq, Error)]
#[error("{message}")]
pub struct Warning {
    /// What may be wrong, with the numbers.
    pub message: String,
    /// What to do about it.
    pub remedy: &'static str,
}

impl Warning {
    /// What is suspicious, and what to do about it.
    pub fn new(message: String, remedy: &'static str) -> Self {
        Self { message, remedy }
    }
}

impl Advice for Warning {
    fn advice(&self) -> Option<&'static str> {
        Some(self.remedy)
    }
}
