//! Exceptions: each has advice, and key and time where the error has them.

use isosheet_dynamics::StepError;
use isosheet_mesh::Advice;
use isosheet_runs::RunError;
use isosheet_scenes as scene;
use isosheet_scenes::{FailedStep, SceneFileError};
use pyo3::create_exception;
use pyo3::exceptions::{PyException, PyKeyboardInterrupt};
use pyo3::prelude::*;
use pyo3::types::PyDict;

create_exception!(
    isosheet,
    Error,
    PyException,
    "An error of isosheet.\n\n\
     It has `advice`, the `key` of the scene and the `time` where these are known, and None else:\n\n\
     >>> try:\n\
     ...     isosheet.Mesh([[0, 0, 0], [1, 0, 0], [0, 1, 0]], [[0, 1, 3]])\n\
     ... except isosheet.Error as error:\n\
     ...     print(error.key)\n\
     None"
);
create_exception!(
    isosheet,
    SceneError,
    Error,
    "A scene that is wrong, or cannot be changed so.\n\n\
     `problems` has all that was found, each with file, line, key, message and remedy:\n\n\
     >>> try:\n\
     ...     isosheet.Scene.new(\"hanging\", {\"sheet.density\": -1})\n\
     ... except isosheet.SceneError as error:\n\
     ...     print([problem[\"key\"] for problem in error.problems])\n\
     ['sheet.density']"
);
create_exception!(
    isosheet,
    StepFailed,
    Error,
    "A step that failed; the simulation is as it was before it.\n\n\
     A pin pulls the sheet beyond the limit of its strain:\n\n\
     >>> scene = isosheet.Scene(\n\
     ...     sheet={\"mesh\": {\"square\": {\"side\": 0.1, \"level\": 1}}, \"material\": \"office paper\"},\n\
     ...     support=[\n\
     ...         {\"at\": {\"vertices\": [0]}},\n\
     ...         {\"at\": {\"vertices\": [24]}, \"hold\": {\"moving_pin\": {\"x\": {\"ramp\": {\"to\": 0.1, \"end\": 0.1}}}}},\n\
     ...     ],\n\
     ... )\n\
     >>> try:\n\
     ...     isosheet.Simulation(scene).run(0.1)\n\
     ... except isosheet.StepFailed as error:\n\
     ...     print(error.key)\n\
     support[1].hold"
);
create_exception!(
    isosheet,
    RunFailed,
    Error,
    "A run that cannot start, go on or be read.\n\n\
     >>> try:\n\
     ...     isosheet.Run(\"nowhere\")\n\
     ... except isosheet.RunFailed as error:\n\
     ...     print(\"no run\")\n\
     no run"
);

/// What an exception says besides its text.
#[derive(Default)]
struct Details<'a> {
    key: Option<String>,
    time: Option<f64>,
    advice: Option<String>,
    problems: &'a [scene::PlacedProblem],
}

impl Details<'_> {
    /// Puts the details on an exception.
    fn put(self, py: Python<'_>, error: PyErr) -> PyErr {
        let set = || -> PyResult<()> {
            let value = error.value(py);
            value.setattr("key", self.key)?;
            value.setattr("time", self.time)?;
            value.setattr("advice", self.advice)?;
            let problems = self.problems.iter().map(|p| problem(py, p));
            value.setattr("problems", problems.collect::<PyResult<Vec<_>>>()?)
        };
        match set() {
            Ok(()) => error,
            Err(failed) => failed,
        }
    }
}

fn problem<'py>(py: Python<'py>, problem: &scene::PlacedProblem) -> PyResult<Bound<'py, PyDict>> {
    let dict = PyDict::new(py);
    dict.set_item("file", &problem.file)?;
    dict.set_item("line", problem.line)?;
    dict.set_item("column", problem.column)?;
    dict.set_item("key", &problem.key)?;
    dict.set_item("message", &problem.message)?;
    dict.set_item("remedy", &problem.remedy)?;
    Ok(dict)
}

/// A text with the advice of the error below it, as the command writes it.
fn text(error: &impl Advice) -> String {
    match error.advice() {
        Some(advice) => format!("{error}\n  = help: {advice}"),
        None => error.to_string(),
    }
}

/// An error that has advice alone.
pub(crate) fn plain(py: Python<'_>, error: &impl Advice) -> PyErr {
    advised(py, Error::new_err(text(error)), error)
}

fn advised(py: Python<'_>, exception: PyErr, error: &impl Advice) -> PyErr {
    let advice = error.advice().map(str::to_owned);
    let details = Details {
        advice,
        ..Details::default()
    };
    details.put(py, exception)
}

/// The details of an error of a scene: the first problem is the one that is meant.
fn of_problems(
    py: Python<'_>,
    exception: PyErr,
    error: &scene::SceneError,
    time: Option<f64>,
) -> PyErr {
    let problems = error.placed();
    let first = problems.first();
    let details = Details {
        key: first.map(|p| p.key.clone()),
        time,
        advice: first.and_then(|p| p.remedy.clone()),
        problems: &problems,
    };
    details.put(py, exception)
}

/// An error of a scene.
pub(crate) fn of_scene(py: Python<'_>, error: &scene::SceneError) -> PyErr {
    of_problems(py, SceneError::new_err(error.to_string()), error, None)
}

/// An error of a scene file or of an edit.
pub(crate) fn of_file(py: Python<'_>, error: &SceneFileError) -> PyErr {
    match error {
        SceneFileError::Scene(error) => of_scene(py, error),
        SceneFileError::Edit(edit) => {
            let key = edit.edit.split('=').next().unwrap_or_default().trim();
            let details = Details {
                key: Some(key.to_owned()),
                advice: edit.advice().map(str::to_owned),
                ..Details::default()
            };
            details.put(py, SceneError::new_err(text(error)))
        }
        _ => advised(py, SceneError::new_err(text(error)), error),
    }
}

/// An error of a step at a time, seconds.
pub(crate) fn of_step(py: Python<'_>, error: &FailedStep, time: f64) -> PyErr {
    if let Some(step @ StepError::Interrupted { .. }) = &error.step {
        return PyKeyboardInterrupt::new_err(step.to_string());
    }
    let exception = StepFailed::new_err(error.to_string());
    of_problems(py, exception, &error.scene, Some(time))
}

/// An error of a run.
pub(crate) fn of_run(py: Python<'_>, error: &RunError) -> PyErr {
    match error {
        RunError::Scene(error) => of_scene(py, error),
        RunError::SceneFile(error) => of_file(py, error),
        RunError::Step(error) => {
            of_problems(py, StepFailed::new_err(error.to_string()), error, None)
        }
        error => advised(py, RunFailed::new_err(text(error)), error),
    }
}

/// Adds the exceptions to the module. What an exception does not know is `None`.
pub(crate) fn add_to(module: &Bound<'_, PyModule>) -> PyResult<()> {
    let py = module.py();
    let base = py.get_type::<Error>();
    for name in ["key", "time", "advice"] {
        base.setattr(name, py.None())?;
    }
    base.setattr("problems", Vec::<u8>::new())?;
    module.add("Error", base)?;
    module.add("SceneError", py.get_type::<SceneError>())?;
    module.add("StepFailed", py.get_type::<StepFailed>())?;
    module.add("RunFailed", py.get_type::<RunFailed>())
}
