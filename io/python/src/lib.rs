//! The Python module `isosheet`: a thin layer over scenes, simulations and runs.
//!
//! | file | what |
//! |---|---|
//! | `scene.rs`, `value.rs` | scenes, and Python's values as values of TOML |
//! | `simulation.rs`, `report.rs` | simulations and what a step reports |
//! | `mesh.rs`, `foreign.rs` | meshes from arrays, generators, files and other libraries |
//! | `materials.rs` | the catalogue |
//! | `recorder.rs` | recordings of simulations |
//! | `run.rs`, `picture.rs` | what a run has written, and files of it |
//! | `error.rs`, `arrays.rs` | exceptions with advice, numpy arrays |
//!
//! Arrays are copies: the memory of a simulation changes with each step. Whatever takes long lets other
//! threads of Python run.

mod arrays;
#[path = "../../src/bin/isosheet/commit.rs"]
mod commit;
mod error;
mod foreign;
mod gradient;
mod materials;
mod mesh;
mod picture;
mod recorded;
mod recorder;
mod report;
mod run;
mod scene;
mod signals;
mod simulation;
mod value;

use pyo3::prelude::*;
use std::ffi::OsString;
use std::io::Write;
use std::path::PathBuf;

/// Does what a command line says, whose first word names the command, and returns the exit code.
///
/// A sweep starts the command anew for each of its runs, as the program of the first word.
#[pyfunction]
fn command(py: Python<'_>, words: Vec<OsString>) -> u8 {
    let program = words
        .first()
        .map_or_else(|| "isosheet".into(), PathBuf::from);
    py.detach(|| {
        let code = isosheet_io::run(words, &program);
        // Python does not end the process as a program of Rust does. Nobody is left to be told that stdout is
        // closed.
        let _ = std::io::stdout().flush();
        code
    })
}

#[pymodule]
fn _isosheet(module: &Bound<'_, PyModule>) -> PyResult<()> {
    if let Some(commit) = commit::commit() {
        isosheet_runs::note_commit(commit);
    }
    module.add("__version__", env!("CARGO_PKG_VERSION"))?;
    module.add_class::<mesh::Mesh>()?;
    module.add_class::<report::StepReport>()?;
    module.add_class::<recorded::Run>()?;
    module.add_class::<recorder::Recorder>()?;
    module.add_class::<scene::Scene>()?;
    module.add_class::<simulation::Simulation>()?;
    module.add_function(wrap_pyfunction!(command, module)?)?;
    module.add_function(wrap_pyfunction!(materials::materials, module)?)?;
    error::add_to(module)
}
