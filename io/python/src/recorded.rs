//! A run with what it recorded; its methods are in `run.rs`.

use isosheet_runs::Recording;
use pyo3::prelude::*;
use std::path::PathBuf;

/// What a run has written to a folder, complete or not.
///
/// folder: the folder of `isosheet simulate` or of Scene.simulate.
///
///     >>> run = isosheet.Scene.new("hanging", {"stop.time": 0.1}).simulate("sheet-run")
///     >>> run.x.shape[0] == run.time.size
///     True
///
/// Numbers of frames, vertices, faces and edges are T, V, F and E. In a notebook a run shows its 3D page.
#[pyclass(frozen, module = "isosheet")]
pub(crate) struct Run {
    pub(crate) folder: PathBuf,
    pub(crate) recording: Recording,
}
