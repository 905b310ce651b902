//! Data that cannot be used.

use isosheet_mesh::Advice;
use thiserror::Error;

/// Data that cannot be used: what is wrong, which part and which value are to blame, and what to do.
#[derive(Clone, Debug, PartialEq, Error)]
#[error("{message}")]
#[non_exhaustive]
pub struct DataError {
    /// What is wrong, with all that is to blame.
    pub message: String,
    /// The number of the part to blame, counted as the message does.
    pub index: Option<usize>,
    /// The number that cannot be used.
    pub value: Option<f64>,
    /// What to do.
    pub remedy: Option<&'static str>,
}

impl DataError {
    /// What is wrong, and what to do.
    pub fn new(message: impl Into<String>, remedy: &'static str) -> Self {
        Self {
            remedy: Some(remedy),
            ..Self::plain(message)
        }
    }

    /// What is wrong, where that says all that is known.
    pub fn plain(message: impl Into<String>) -> Self {
        Self {
            message: message.into(),
            index: None,
            value: None,
            remedy: None,
        }
    }

    /// This error with what to do, if anything.
    pub fn remedy(self, remedy: Option<&'static str>) -> Self {
        Self { remedy, ..self }
    }

    /// This error with the number of the part to blame.
    pub fn at(self, index: usize) -> Self {
        Self {
            index: Some(index),
            ..self
        }
    }

    /// This error with the number that cannot be used.
    pub fn value(self, value: f64) -> Self {
        Self {
            value: Some(value),
            ..self
        }
    }
}

impl Advice for DataError {
    fn advice(&self) -> Option<&'static str> {
        self.remedy
    }
}
