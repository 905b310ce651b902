//! What has no derivative.

use isosheet_mesh::Advice;
use std::borrow::Cow;

/// Something has no derivative that was asked for.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
#[error("{of} has no derivative by {by}")]
pub struct NoDerivative {
    /// What has none, such as "a law of friction".
    pub of: Cow<'static, str>,
    /// By what it was asked for, such as "the velocities at the start of a step".
    pub by: &'static str,
}

impl NoDerivative {
    /// Of a type that does not say how it depends on something.
    pub fn of_type<T: ?Sized>(by: &'static str) -> Self {
        let name = std::any::type_name::<T>();
        let of = format!("the type {name}").into();
        Self { of, by }
    }
}

impl Advice for NoDerivative {
    fn advice(&self) -> Option<&'static str> {
        Some("pass it by, take differences of runs, or leave it out of the scene")
    }
}
