//! Gradients of runs.

use crate::error::plain;
use isosheet_adjoint::{AdjointError, AdjointOptions, Branches, OfState, Run, Share};
use isosheet_dynamics::State;
use isosheet_runs::SceneFamily;
use isosheet_scenes::SceneFile;
use numpy::{PyArray1, PyArray3, PyArrayMethods, PyReadonlyArray3};
use pyo3::exceptions::PyValueError;
use pyo3::prelude::*;
use pyo3::types::PyDict;

/// The value of a loss with its derivatives by keys.
pub(crate) type Differentiated<'py> = (f64, Bound<'py, PyDict>);

/// Runs a scene, hands times and positions to `loss`, and goes back over the run.
pub(crate) fn gradient<'py>(
    py: Python<'py>,
    file: &SceneFile,
    loss: &Bound<'py, PyAny>,
    of: Vec<String>,
    branches: Branches,
) -> PyResult<Differentiated<'py>> {
    let text = file.text();
    let family = SceneFamily::of_text(&text.text, &text.path, Vec::new(), of);
    let family = family.map_err(|e| plain(py, &e))?;
    let plan = family.plan().map_err(|e| plain(py, &e))?;
    let values = family.values().map_err(|e| plain(py, &e))?;
    let options = AdjointOptions {
        branches,
        ..AdjointOptions::default()
    };
    let failed = |e: AdjointError| plain(py, &e);
    let run = Run::record(&family, &values, plan, options).map_err(failed)?;
    let (times, shape, positions) = arrays(py, run.states())?;
    let (value, slopes): (f64, PyReadonlyArray3<'_, f64>) =
        loss.call1((times, positions))?.extract()?;
    let slopes = slopes.as_array();
    if slopes.shape() != shape {
        let message = format!(
            "the derivatives have the shape {:?}, and the positions {shape:?}",
            slopes.shape()
        );
        return Err(PyValueError::new_err(message));
    }
    let slopes: Vec<f64> = slopes.iter().copied().collect();
    let width = 3 * shape[1];
    let share = |n: usize, state: &State| {
        let own = &slopes[n * width..(n + 1) * width];
        let mut of = OfState::zeros(state.x.len());
        of.x.copy_from_slice(own);
        own.iter()
            .any(|slope| *slope != 0.0)
            .then_some(Share::of_state(0.0, of))
    };
    let gradient = run.gradient(&share).map_err(failed)?;
    let by_keys = PyDict::new(py);
    for (key, slope) in family.keys().iter().zip(&gradient.of_numbers) {
        by_keys.set_item(key, slope)?;
    }
    Ok((value, by_keys))
}

/// Times (T), the shape (T, V, 3), and positions of it.
#[expect(clippy::type_complexity, reason = "two arrays and their shape")]
fn arrays<'py>(
    py: Python<'py>,
    states: &[State],
) -> PyResult<(
    Bound<'py, PyArray1<f64>>,
    [usize; 3],
    Bound<'py, PyArray3<f64>>,
)> {
    let times: Vec<f64> = states.iter().map(|state| state.t).collect();
    let width = states.first().map_or(0, |state| state.x.len());
    let shape = [states.len(), width / 3, 3];
    let all: Vec<f64> = states.iter().flat_map(|state| &state.x).copied().collect();
    let positions = PyArray1::from_vec(py, all).reshape(shape)?;
    Ok((PyArray1::from_vec(py, times), shape, positions))
}
