//! Lengths at rest that change by themselves.

use isosheet_motion::{Profile, ProfileError};
use std::sync::Arc;

/// The part by which the lengths of a face grow, a function of time; none by default.
#[derive(Debug, Clone, Default, PartialEq)]
pub(super) struct Swelling(Option<Arc<Profile>>);

impl Swelling {
    pub(super) fn of(part: Profile) -> Result<Self, ProfileError> {
        part.validate()?;
        Ok(Self(Some(Arc::new(part))))
    }

    pub(super) fn part(&self, t: f64) -> f64 {
        self.0.as_ref().map_or(0.0, |part| part.value(t))
    }

    /// The square of the factor by which lengths are multiplied.
    pub(super) fn growth(&self, t: f64) -> f64 {
        let factor = 1.0 + self.part(t);
        factor * factor
    }

    pub(super) fn is_driven(&self) -> bool {
        self.0.as_ref().is_some_and(|part| !part.is_constant())
    }
}
