//! Numpy arrays of what Rust has as slices, and slices of them.

use isosheet_mesh::Part;
use numpy::{Element, PyArray1, PyArray2, PyArrayMethods};
use pyo3::exceptions::PyValueError;
use pyo3::intern;
use pyo3::prelude::*;
use pyo3::types::{PyDict, PySlice};

/// The vertices of each of several sheets by its name, as slices.
pub(crate) fn slices<'py>(
    py: Python<'py>,
    parts: &[(String, Part)],
) -> PyResult<Bound<'py, PyDict>> {
    let slices = PyDict::new(py);
    for (name, part) in parts {
        let (begin, end) = (part.vertices.start as isize, part.vertices.end as isize);
        slices.set_item(name, PySlice::new(py, begin, end, 1))?;
    }
    Ok(slices)
}

/// A copy of numbers in a row.
pub(crate) fn array<'py, T: Element>(py: Python<'py>, values: &[T]) -> Bound<'py, PyArray1<T>> {
    PyArray1::from_slice(py, values)
}

/// A copy of rows of `N` numbers, of shape (rows, N).
pub(crate) fn rows<'py, T: Element, const N: usize>(
    py: Python<'py>,
    rows: &[[T; N]],
) -> PyResult<Bound<'py, PyArray2<T>>> {
    array(py, rows.as_flattened()).reshape([rows.len(), N])
}

/// A copy of coordinates x0 y0 z0 x1 ..., of shape (vertices, 3).
pub(crate) fn vectors<'py>(py: Python<'py>, x: &[f64]) -> PyResult<Bound<'py, PyArray2<f64>>> {
    rows(py, x.as_chunks::<3>().0)
}

/// Most numbers of an array: for ten times as many vertices as a sheet may have for its runs to end.
const MOST_NUMBERS: usize = 10_000_000;

/// Refuses arrays of numpy that have a mask, which a scene has no place for, or more numbers than any scene.
pub(crate) fn refuse_array(value: &Bound<'_, PyAny>) -> PyResult<()> {
    let py = value.py();
    // Of other arrays `mask` is a method.
    let mask = value.getattr_opt(intern!(py, "mask"))?;
    if mask.is_some_and(|mask| !mask.is_callable()) {
        let message = "the array has a mask, and a scene has numbers alone; give the numbers that are \
                       meant, by `array.compressed()` or `array.filled(value)`";
        return Err(PyValueError::new_err(message));
    }
    let Some(size) = value.getattr_opt(intern!(py, "size"))? else {
        return Ok(());
    };
    match size.extract::<usize>() {
        Ok(size) if size > MOST_NUMBERS => Err(PyValueError::new_err(format!(
            "the array has {size} numbers, and at most {MOST_NUMBERS} have a place in a scene"
        ))),
        _ => Ok(()),
    }
}
