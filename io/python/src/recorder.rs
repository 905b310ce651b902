//! Recordings of simulations.

use crate::recorded::Run;
use isosheet_runs::{Recording, RecordingEnd};
use pyo3::exceptions::PyValueError;
use pyo3::prelude::*;
use std::path::PathBuf;
use std::sync::{Mutex, PoisonError};

/// What ends a recording; `None` if it has been ended already.
type End = dyn Fn(Python<'_>, RecordingEnd) -> PyResult<Option<Recording>> + Send + Sync;

/// What records the steps of a simulation in a folder; Simulation.record makes it.
///
/// Leaving the `with` statement ends the recording, after an exception too, and writes the page and the
/// summary:
///
///     >>> simulation = isosheet.Simulation(isosheet.Scene.new("hanging"))
///     >>> with simulation.record("hanging-run") as recorder:
///     ...     for _ in range(10):
///     ...         report = simulation.step()
///     >>> recorder.run.summary["steps"]
///     10
#[pyclass(frozen, module = "isosheet")]
pub(crate) struct Recorder {
    end: Box<End>,
    folder: PathBuf,
    run: Mutex<Option<Py<Run>>>,
}

impl Recorder {
    pub(crate) fn new(end: Box<End>, folder: PathBuf) -> Self {
        let run = Mutex::new(None);
        Self { end, folder, run }
    }

    fn ended(&self) -> Option<Py<Run>> {
        let run = self.run.lock().unwrap_or_else(PoisonError::into_inner);
        run.as_ref()
            .map(|run| Python::attach(|py| run.clone_ref(py)))
    }

    fn end(&self, py: Python<'_>, end: RecordingEnd) -> PyResult<Py<Run>> {
        if let Some(run) = self.ended() {
            return Ok(run);
        }
        let Some(recording) = (self.end)(py, end)? else {
            return Err(PyValueError::new_err(
                "the recording has been ended already",
            ));
        };
        let folder = self.folder.clone();
        let run = Py::new(py, Run { folder, recording })?;
        let mut kept = self.run.lock().unwrap_or_else(PoisonError::into_inner);
        *kept = Some(run.clone_ref(py));
        Ok(run)
    }
}

#[pymethods]
impl Recorder {
    fn __enter__(slf: Py<Self>) -> Py<Self> {
        slf
    }

    #[pyo3(signature = (kind, value, traceback))]
    fn __exit__(
        &self,
        py: Python<'_>,
        kind: &Bound<'_, PyAny>,
        value: &Bound<'_, PyAny>,
        traceback: &Bound<'_, PyAny>,
    ) -> PyResult<bool> {
        let _ = (value, traceback);
        let end = match kind.is_none() {
            true => RecordingEnd::Program,
            false => RecordingEnd::Error,
        };
        self.end(py, end)?;
        Ok(false)
    }

    /// Ends the recording, writes the page and the summary, and returns the `Run`.
    fn close(&self, py: Python<'_>) -> PyResult<Py<Run>> {
        self.end(py, RecordingEnd::Program)
    }

    /// The folder.
    #[getter]
    fn folder(&self) -> PathBuf {
        self.folder.clone()
    }

    /// What was recorded, up to now while the recording goes on.
    #[getter]
    fn run(&self, py: Python<'_>) -> PyResult<Py<Run>> {
        match self.ended() {
            Some(run) => Ok(run),
            None => Py::new(py, Run::read(py, self.folder.clone())?),
        }
    }

    fn __repr__(&self) -> String {
        format!("<isosheet.Recorder in {}>", self.folder.display())
    }
}
