//! Checks of lists. The name of a list is only made up when it is needed for an error.

use super::error::ViewError;

/// The largest number that a list may have. Box sizes and second differences of such numbers are finite.
const LARGEST: f64 = 1e300;

pub(super) fn length(what: &str, got: usize, expected: usize) -> Result<(), ViewError> {
    length_of(got, expected, || what.into())
}

pub(super) fn length_of(
    got: usize,
    expected: usize,
    what: impl Fn() -> String,
) -> Result<(), ViewError> {
    if got == expected {
        return Ok(());
    }
    Err(ViewError::Length {
        what: what(),
        got,
        expected,
    })
}

pub(super) fn finite(what: &str, values: &[f64]) -> Result<(), ViewError> {
    finite_of(values, || what.into())
}

pub(super) fn finite_of(values: &[f64], what: impl Fn() -> String) -> Result<(), ViewError> {
    match values.iter().position(|v| v.is_nan() || v.abs() > LARGEST) {
        None => Ok(()),
        Some(index) => Err(ViewError::NotFinite {
            what: what(),
            index,
            value: values[index],
        }),
    }
}

/// Checks values that a logarithmic scale shows: none is negative.
pub(super) fn not_negative(values: &[f64], what: impl Fn() -> String) -> Result<(), ViewError> {
    match values.iter().position(|&v| v < 0.0) {
        None => Ok(()),
        Some(index) => Err(ViewError::Negative {
            what: what(),
            index,
            value: values[index],
        }),
    }
}

pub(super) fn times(what: &str, times: &[f64]) -> Result<(), ViewError> {
    finite(what, times)?;
    match times.windows(2).position(|w| w[1] < w[0]) {
        None => Ok(()),
        Some(k) => Err(ViewError::Time {
            what: what.into(),
            index: k + 1,
            time: times[k + 1],
            before: times[k],
        }),
    }
}

pub(super) fn vertices(what: &str, list: &[u32], vertices: usize) -> Result<(), ViewError> {
    match list.iter().position(|&v| v as usize >= vertices) {
        None => Ok(()),
        Some(index) => Err(ViewError::Vertex {
            what: what.into(),
            index,
            vertex: list[index],
            vertices,
        }),
    }
}
