//! Options that are out of range.

use isosheet_mesh::Advice;
use isosheet_mesh::wording::given;

/// An option that makes no sense.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
#[error(
    "option {name} is {value}, outside the range from {min} to {max}",
    value = given(*value), min = given(*min), max = given(*max)
)]
pub struct OptionsError {
    /// Name of the option.
    pub name: &'static str,
    /// Its value.
    pub value: f64,
    /// Smallest value that makes sense.
    pub min: f64,
    /// Largest value that makes sense.
    pub max: f64,
}

impl Advice for OptionsError {
    fn advice(&self) -> Option<&'static str> {
        Some("give a value in this range")
    }
}

impl OptionsError {
    /// Checks that a value is in its range.
    ///
    /// # Errors
    /// [`OptionsError`] where it is not, or is not a number.
    pub fn check_range(name: &'static str, value: f64, min: f64, max: f64) -> Result<(), Self> {
        if (min..=max).contains(&value) {
            Ok(())
        } else {
            Err(Self {
                name,
                value,
                min,
                max,
            })
        }
    }

    /// Checks that a count is from one to a million.
    ///
    /// # Errors
    /// [`OptionsError`] where it is not.
    pub fn check_count(name: &'static str, value: usize) -> Result<(), Self> {
        Self::check_range(name, value as f64, 1.0, 1e6)
    }
}
