//! Scenes.

use crate::error::{of_file, of_run};
use crate::gradient::{Differentiated, Quantity, gradient};
use crate::mesh::Mesh;
use crate::recorded::Run;
use crate::signals::Signals;
use crate::value::{Remade, edits_as_texts, remade, table, to_python};
use isosheet_adjoint::{AdjointOptions, Branches};
use isosheet_runs as run;
use isosheet_scenes::{Key, SceneFile, SceneFileError, StartingPoint};
use pyo3::exceptions::{PyKeyError, PyKeyboardInterrupt, PyValueError};
use pyo3::prelude::*;
use pyo3::types::{PyDict, PyString};
use std::collections::HashMap;
use std::path::{Path, PathBuf};
use toml::Value;

/// A scene: everything that decides how a simulation goes. The keys are the keys of scene files.
///
/// The keys are given as keyword arguments, see `Scene.from_dict`. `Scene.from_toml` reads a file,
/// `Scene.new` makes a scene to start from. A scene never changes; Scene.edit makes another one.
///
///     >>> scene = isosheet.Scene(
///     ...     sheet={"mesh": {"square": {"side": 0.2, "level": 2}}, "density": 0.08},
///     ...     forces={"gravity": [0, 0, -9.81]},
///     ... )
///     >>> scene["stop.time"]
///     1.0
#[pyclass(frozen, module = "isosheet")]
pub(crate) struct Scene {
    file: SceneFile,
}

impl Scene {
    pub(crate) fn of(file: SceneFile) -> Self {
        Self { file }
    }

    pub(crate) fn file(&self) -> &SceneFile {
        &self.file
    }

    /// The scene with all its values, including values that its text leaves out.
    fn whole(&self) -> PyResult<Value> {
        let value = Value::try_from(self.file.scene());
        value.map_err(|e| PyValueError::new_err(e.to_string()))
    }
}

/// The edits of a dictionary as texts.
fn edits(edits: &Bound<'_, PyDict>) -> PyResult<Vec<String>> {
    edits_as_texts(edits, Mesh::value_of)
}

/// A scene file in a text.
fn parse(text: String, folder: &Path) -> Result<SceneFile, SceneFileError> {
    SceneFile::parse(text, &folder.join("scene.toml"), &[])
}

impl Scene {
    /// The scene of a dictionary.
    fn of_keys(py: Python<'_>, scene: &Bound<'_, PyDict>, folder: &Path) -> PyResult<Self> {
        let mut scene = table(scene, Mesh::value_of)?;
        let version = Value::Integer(isosheet_scenes::VERSION.into());
        scene.entry("version").or_insert(version);
        let file = parse(scene.to_string(), folder);
        file.map(Self::of).map_err(|e| of_file(py, &e))
    }
}

#[pymethods]
impl Scene {
    #[new]
    #[pyo3(signature = (*, folder = PathBuf::new(), **keys))]
    fn with_keys(
        py: Python<'_>,
        folder: PathBuf,
        keys: Option<&Bound<'_, PyDict>>,
    ) -> PyResult<Self> {
        match keys {
            Some(keys) => Self::of_keys(py, keys, &folder),
            None => Self::of_keys(py, &PyDict::new(py), &folder),
        }
    }

    /// What a scene is called with, for completion: the keys of the schema.
    #[classattr]
    fn __signature__(py: Python<'_>) -> PyResult<Bound<'_, PyAny>> {
        let inspect = py.import("inspect")?;
        let parameter = inspect.getattr("Parameter")?;
        let keyword = parameter.getattr("KEYWORD_ONLY")?;
        let schema = isosheet_scenes::schema();
        let keys = schema["properties"].as_object().into_iter().flatten();
        let keys = keys
            .map(|(key, _)| key.as_str())
            .filter(|key| *key != "sheet");
        let parameters = ["sheet", "folder"].into_iter().chain(keys).map(|key| {
            let options = PyDict::new(py);
            match key {
                "sheet" => {}
                "folder" => options.set_item("default", "")?,
                "version" => options.set_item("default", isosheet_scenes::VERSION)?,
                _ => options.set_item("default", py.None())?,
            }
            parameter.call((key, &keyword), Some(&options))
        });
        let parameters = parameters.collect::<PyResult<Vec<_>>>()?;
        inspect.call_method1("Signature", (parameters,))
    }

    /// The scene of a file, or of a text.
    ///
    /// `text_or_path`: a path, or a text of TOML, which is told by its having more than one line.
    /// edits: keys with new values in place of the file's values, such as {"stop.time": 0.5}.
    ///
    /// Raises `SceneError` with all problems that were found.
    #[staticmethod]
    #[pyo3(signature = (text_or_path, edits = None))]
    fn from_toml(
        py: Python<'_>,
        text_or_path: &Bound<'_, PyAny>,
        edits: Option<&Bound<'_, PyDict>>,
    ) -> PyResult<Self> {
        let edits = edits.map_or_else(|| Ok(Vec::new()), self::edits)?;
        let text = text_or_path.cast::<PyString>().ok();
        let text: Option<String> = text.map(|t| t.extract()).transpose()?;
        let file = match text.filter(|t| t.contains('\n')) {
            Some(text) => SceneFile::parse(text, Path::new("scene.toml"), &edits),
            None => SceneFile::read(&text_or_path.extract::<PathBuf>()?, &edits),
        };
        file.map(Self::of).map_err(|e| of_file(py, &e))
    }

    /// The scene of a dictionary, which has the keys of a scene file; `version` may be left out.
    ///
    /// Values are numbers, texts, lists, dictionaries, objects of dataclasses, numpy arrays, paths and
    /// meshes; what is None is left out. Paths are relative to `folder`.
    #[staticmethod]
    #[pyo3(signature = (scene, folder = PathBuf::new()))]
    fn from_dict(py: Python<'_>, scene: &Bound<'_, PyDict>, folder: PathBuf) -> PyResult<Self> {
        Self::of_keys(py, scene, &folder)
    }

    /// A commented scene to start from, of a kind of `isosheet new`: "hanging", "clamp", "drape" and so on.
    #[staticmethod]
    #[pyo3(signature = (kind = "hanging", edits = None))]
    fn new(py: Python<'_>, kind: &str, edits: Option<&Bound<'_, PyDict>>) -> PyResult<Self> {
        let edits = edits.map_or_else(|| Ok(Vec::new()), self::edits)?;
        let known = StartingPoint::ALL;
        let point = known
            .into_iter()
            .find(|p| p.name() == kind)
            .ok_or_else(|| {
                let names: Vec<&str> = known.iter().map(|p| p.name()).collect();
                PyValueError::new_err(format!(
                    "there is no scene \"{kind}\"; the kinds are {}",
                    names.join(", ")
                ))
            })?;
        let file = SceneFile::parse(point.text().to_owned(), Path::new("scene.toml"), &edits);
        file.map(Self::of).map_err(|e| of_file(py, &e))
    }

    /// The scene with other values: ``scene.edit({"obstacle[0].friction": 0.8})``.
    fn edit(&self, py: Python<'_>, edits: &Bound<'_, PyDict>) -> PyResult<Self> {
        let text = self.file.text();
        let file = SceneFile::parse(text.text.clone(), &text.path, &self::edits(edits)?);
        file.map(Self::of).map_err(|e| of_file(py, &e))
    }

    /// The scene without motion: its steps end at equilibria, one step where nothing depends on time.
    fn at_rest(&self, py: Python<'_>) -> PyResult<Self> {
        let (scene, keys) = self.file.scene().at_rest();
        let file = self.file.changed(scene, keys);
        file.map(Self::of).map_err(|e| of_file(py, &e.into()))
    }

    /// The scene of a text, as if it had been read from a path.
    #[staticmethod]
    fn _of_text(py: Python<'_>, text: String, path: PathBuf) -> PyResult<Self> {
        let file = SceneFile::parse(text, &path, &[]);
        file.map(Self::of).map_err(|e| of_file(py, &e))
    }

    /// For `pickle` and `copy`: text and path. Mesh files that the scene names are not part of it.
    fn __reduce__<'py>(slf: &Bound<'py, Self>) -> PyResult<Remade<'py>> {
        let (py, text) = (slf.py(), slf.get().file.text());
        let path = text.path.to_string_lossy();
        let arguments = [&text.text, &*path].map(|text| PyString::new(py, text).into_any());
        remade(slf, "_of_text", arguments.into())
    }

    /// The scene as TOML, with comments and edits.
    #[getter]
    fn text(&self) -> &str {
        &self.file.text().text
    }

    /// All values as a dictionary, including values that the text leaves out.
    fn to_dict<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyAny>> {
        to_python(py, &self.whole()?)
    }

    /// The value at a key such as "method.step" or "support[0].at".
    fn __getitem__<'py>(&self, py: Python<'py>, key: &str) -> PyResult<Bound<'py, PyAny>> {
        let whole = self.whole()?;
        let missing = || PyKeyError::new_err(key.to_owned());
        let parts: Key = key.parse().map_err(|_| missing())?;
        let found = parts.find(&whole);
        to_python(py, found.ok_or_else(missing)?)
    }

    /// What to know before the scene is run, in words.
    fn warnings(&self, py: Python<'_>) -> PyResult<Vec<String>> {
        let setup = py.detach(|| self.file.build());
        let setup = setup.map_err(|e| of_file(py, &e.into()))?;
        Ok(setup.warnings().iter().map(ToString::to_string).collect())
    }

    /// Runs the scene in a folder, as `isosheet simulate` does: a complete run is left as it is, a part of
    /// one is continued. Returns what the run wrote.
    ///
    /// Raises `StepFailed` or `RunFailed`; `KeyboardInterrupt` after Ctrl-C, when the same call continues.
    fn simulate(&self, py: Python<'_>, folder: PathBuf) -> PyResult<Run> {
        let mut signals = Signals::default();
        let run = py.detach(|| run::simulate_recorded(&self.file, &folder, &mut signals));
        match run.map_err(|e| of_run(py, &e))? {
            None => Err(signals
                .raised
                .unwrap_or_else(|| PyKeyboardInterrupt::new_err(()))),
            Some(recording) => Ok(Run { folder, recording }),
        }
    }

    /// Runs the scene and differentiates a loss of its positions by the values of keys, for about the price
    /// of two runs (docs/gradients.md).
    ///
    /// ``loss(times, positions)`` gets arrays of the shapes (T,) and (T, V, 3), at the start and after each
    /// step, and returns a number and its derivatives by the positions, of the same shape. Returns the number
    /// and a dictionary with its derivatives by the keys. What has no derivative raises `Error`, which names
    /// it with its time, or counts as constant and is named by a warning with ``branches="pass by"``.
    ///
    /// The loss gets what ``also`` names as further arguments, and returns its derivatives by them, too:
    /// ``"velocities"`` (T, V, 3) in m/s, ``"support_forces"`` (T, V, 3), the force of supports on each
    /// vertex in N, zero at the start, and ``"energies"`` (T, 2), the kinetic and the potential energy
    /// without contact in J.
    ///
    /// ``sizes`` has the sizes of keys whose values say little about them: by how much each has to change to
    /// make another scene. Positions of obstacles and bodies have theirs.
    ///
    ///     >>> def height(times, positions):
    ///     ...     slopes = numpy.zeros_like(positions)
    ///     ...     slopes[-1, 3, 2] = 1.0
    ///     ...     return positions[-1, 3, 2], slopes
    ///     >>> value, slopes = scene.gradient(height, of=["sheet.density", "forces.gravity[2]"])
    #[pyo3(signature = (loss, of, branches = "refuse", also = Names::default(), sizes = HashMap::new()))]
    fn gradient<'py>(
        &self,
        py: Python<'py>,
        loss: &Bound<'py, PyAny>,
        of: Names,
        branches: &str,
        also: Names,
        sizes: HashMap<String, f64>,
    ) -> PyResult<Differentiated<'py>> {
        let branches = match branches {
            "refuse" => Branches::Refuse,
            "pass by" => Branches::PassBy,
            other => {
                let message = format!("branches is {other:?}; give \"refuse\" or \"pass by\"");
                return Err(PyValueError::new_err(message));
            }
        };
        let (of, also) = (of.0, also.0);
        let also: PyResult<Vec<Quantity>> = also.iter().map(|name| Quantity::named(name)).collect();
        if let Some((key, size)) = sizes
            .iter()
            .find(|(key, size)| !of.contains(key) || !(size.is_finite() && **size > 0.0))
        {
            let message = format!(
                "sizes has {size} for {key:?}; give positive numbers for keys of `of` alone"
            );
            return Err(PyValueError::new_err(message));
        }
        let size = |key: &String| sizes.get(key).copied().unwrap_or(0.0);
        let options = AdjointOptions {
            branches,
            sizes: of.iter().map(size).collect(),
            ..AdjointOptions::default()
        };
        gradient(py, &self.file, loss, of, &also?, options)
    }

    fn __eq__(&self, other: &Self) -> bool {
        self.file.scene() == other.file.scene()
    }

    fn __repr__(&self) -> String {
        format!("<isosheet.Scene {}>", self.file.text().path.display())
    }
}

/// A list of names; one text is a list of one name.
#[derive(Default)]
struct Names(Vec<String>);

impl FromPyObject<'_, '_> for Names {
    type Error = PyErr;

    fn extract(object: Borrowed<'_, '_, PyAny>) -> PyResult<Self> {
        Ok(Self(match object.extract() {
            Ok(name) => vec![name],
            Err(_) => object.extract()?,
        }))
    }
}
