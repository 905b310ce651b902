//! Checks of lists. The name of a list is only made up when it is needed for an error.

use isosheet_files::DataError;
use isosheet_mesh::wording::{counted, given};
use isosheet_mesh::{Advice, Topology};

/// The largest number that a list may have. Box sizes and second differences of such numbers are finite.
const LARGEST: f64 = 1e300;

pub(super) fn length(what: &str, got: usize, expected: usize) -> Result<(), DataError> {
    length_of(got, expected, || what.into())
}

pub(super) fn length_of(
    got: usize,
    expected: usize,
    what: impl Fn() -> String,
) -> Result<(), DataError> {
    if got == expected {
        return Ok(());
    }
    let what = what();
    Err(DataError::plain(format!(
        "{what}: the length is {got} and has to be {expected}"
    )))
}

pub(super) fn finite(what: &str, values: &[f64]) -> Result<(), DataError> {
    finite_of(values, || what.into())
}

pub(super) fn finite_of(values: &[f64], what: impl Fn() -> String) -> Result<(), DataError> {
    let is_wrong = |v: &f64| v.is_nan() || v.abs() > LARGEST;
    let remedy = "give finite numbers below 1e300 in size";
    refuse(values, is_wrong, "", remedy, what)
}

/// Checks values that a logarithmic scale shows: none is negative.
pub(super) fn not_negative(values: &[f64], what: impl Fn() -> String) -> Result<(), DataError> {
    let remedy = "use a linear scale or sizes";
    refuse(
        values,
        |v| *v < 0.0,
        ", which has no logarithm",
        remedy,
        what,
    )
}

/// Refuses a list with a number that cannot be used, of which it is said why.
fn refuse(
    values: &[f64],
    is_wrong: impl Fn(&f64) -> bool,
    why: &str,
    remedy: &'static str,
    what: impl Fn() -> String,
) -> Result<(), DataError> {
    let Some(index) = values.iter().position(is_wrong) else {
        return Ok(());
    };
    let (what, value) = (what(), values[index]);
    let message = format!("{what}: entry {index} is {}{why}", given(value));
    Err(DataError::new(message, remedy).at(index).value(value))
}

pub(super) fn times(what: &str, times: &[f64]) -> Result<(), DataError> {
    finite(what, times)?;
    match times.windows(2).position(|w| w[1] < w[0]) {
        None => Ok(()),
        Some(k) => {
            let [before, time] = [times[k], times[k + 1]].map(given);
            let message = format!("{what}: entry {} is {time} s after {before} s", k + 1);
            let error = DataError::new(message, "give the times in ascending order");
            Err(error.at(k + 1).value(times[k + 1]))
        }
    }
}

pub(super) fn vertices(what: &str, list: &[u32], vertices: usize) -> Result<(), DataError> {
    match list.iter().position(|&v| v as usize >= vertices) {
        None => Ok(()),
        Some(index) => {
            let vertex = list[index];
            let message = format!(
                "{what}: entry {index} is the vertex {vertex}, but the mesh has {}, counted from 0",
                counted(vertices, "vertex", "vertices")
            );
            Err(DataError::plain(message).at(index))
        }
    }
}

/// The connectivity of triangles.
pub(super) fn topology(vertices: usize, faces: &[[u32; 3]]) -> Result<Topology, DataError> {
    Topology::from_faces(vertices, faces).map_err(|e| {
        DataError::plain(format!("the triangles of the sheet: {e}")).remedy(e.advice())
    })
}

/// There is no frame.
pub fn no_frames() -> DataError {
    let remedy = "give the positions at one time at least";
    DataError::new("the replay has no frames", remedy)
}
