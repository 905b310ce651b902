//! Simulations.

use crate::arrays::{array, rows, slices, vectors};
use crate::error::{of_file, of_run, of_scene, of_step, plain};
use crate::mesh::{Mesh, edges};
use crate::picture::framed;
use crate::recorder;
use crate::report::StepReport;
use crate::scene::Scene;
use crate::signals::Signals;
use crate::value::{Remade, edits as edits_of, remade, table};
use isosheet_dynamics as dynamics;
use isosheet_dynamics::{Checkpoint, StepProgress};
use isosheet_files::DataError;
use isosheet_formats::Trajectory;
use isosheet_mesh::VertexId;
use isosheet_page::{PageOptions, Replay};
use isosheet_runs::{
    ExistingRun, RecordedStepError, Recorder, RecorderOptions, Recording, RecordingEnd, replay_of,
};
use isosheet_scenes::{FramePose, Key, KeyError, LiveScene, Problem, Target};
use numpy::{PyArray1, PyArray2};
use pyo3::exceptions::{PyKeyError, PyValueError};
use pyo3::prelude::*;
use pyo3::types::{PyBytes, PyDict};
use std::ops::ControlFlow;
use std::path::PathBuf;
use std::sync::{Mutex, PoisonError};

/// A simulation of a scene, at its start.
///
/// scene: a Scene.
///
///     >>> simulation = isosheet.Simulation(isosheet.Scene.new("hanging"))
///     >>> reports = simulation.run(0.1)
///     >>> simulation.x.shape == simulation.v.shape
///     True
///
/// Arrays are copies, because the next step changes the memory of the simulation. Numbers of vertices, faces
/// and edges are V, F and E; units are metres, seconds, newtons and joules. Steps let other threads of Python
/// run; a simulation that several threads use does what they ask for one after the other.
#[pyclass(frozen, module = "isosheet")]
pub(crate) struct Simulation {
    inner: Mutex<Inner>,
}

/// A simulation, and what records it.
struct Inner {
    live: LiveScene,
    recorder: Option<Recorder>,
}

impl Inner {
    fn step(
        &mut self,
        h: f64,
        watch: &mut dyn FnMut(&StepProgress) -> ControlFlow<()>,
    ) -> Result<dynamics::StepReport, RecordedStepError> {
        match &mut self.recorder {
            Some(recorder) => recorder.step(&mut self.live, h, watch),
            None => Ok(self.live.step_watched(h, watch)?),
        }
    }
}

impl Simulation {
    fn of(live: LiveScene) -> Self {
        let recorder = None;
        Self {
            inner: Mutex::new(Inner { live, recorder }),
        }
    }

    /// Does something with the simulation while other threads of Python run.
    fn with<R: Send>(&self, py: Python<'_>, f: impl FnOnce(&mut LiveScene) -> R + Send) -> R {
        self.with_recorder(py, |inner| f(&mut inner.live))
    }

    /// Does something with the simulation and with what records it.
    fn with_recorder<R: Send>(&self, py: Python<'_>, f: impl FnOnce(&mut Inner) -> R + Send) -> R {
        py.detach(|| f(&mut self.inner.lock().unwrap_or_else(PoisonError::into_inner)))
    }

    /// Ends the recording; nothing if there is none.
    fn end_recording(&self, py: Python<'_>, end: RecordingEnd) -> PyResult<Option<Recording>> {
        let ended = self.with_recorder(py, |inner| {
            let recorder = inner.recorder.take()?;
            Some(recorder.finish(&inner.live, end))
        });
        ended.transpose().map_err(|e| of_run(py, &e))
    }

    /// The page of the present state.
    fn replay(&self, py: Python<'_>) -> PyResult<Replay> {
        let replay = self.with(py, |live| -> Result<Replay, DataError> {
            let mut trajectory = Trajectory::new(&live.facts().sheet);
            trajectory.push(live.simulation().state().t, &live.positions())?;
            let parts = live.facts().parts.iter();
            Ok(Replay {
                title: "simulation".into(),
                sheets: parts.map(|(_, part)| part.faces.len()).collect(),
                pins: live.pins().iter().map(|v| v.0).collect(),
                summary: vec![("modelled".into(), live.facts().modelled.join(", "))],
                scene: live.file().text().text.clone(),
                ..replay_of(
                    &live.facts().sheet,
                    &live.facts().obstacles,
                    &trajectory,
                    &[],
                )?
            })
        });
        replay.map_err(|e| plain(py, &e))
    }

    /// A copy of something that the engine has.
    fn copied<R: Send>(
        &self,
        py: Python<'_>,
        f: impl FnOnce(&dynamics::Simulation) -> R + Send,
    ) -> R {
        self.with(py, |live| f(live.simulation()))
    }

    /// A step of `h` seconds, or of the next one of a run until a time; nothing at its end.
    fn advance(&self, py: Python<'_>, length: Length) -> PyResult<Option<StepReport>> {
        let mut signals = Signals::default();
        let stepped = self.with_recorder(py, |inner| {
            let live = &inner.live;
            let h = match length {
                Length::Given(h) => h,
                Length::OfScene => live.file().scene().method.step,
                Length::Until(end) => live.next_step(end)?,
            };
            let stepped = inner.step(h, &mut |_| signals.ask());
            Some(stepped.map_err(|e| (e, inner.live.simulation().state().t)))
        });
        match stepped {
            None => Ok(None),
            Some(Ok(report)) => Ok(Some(report.into())),
            Some(Err((RecordedStepError::Step(error), t))) => {
                Err(signals.raised.unwrap_or_else(|| of_step(py, &error, t)))
            }
            Some(Err((RecordedStepError::Run(error), _))) => Err(of_run(py, &error)),
        }
    }
}

/// The pose that a dictionary is, to which the motion at a key is driven.
fn pose_of(key: &Key, pose: &Bound<'_, PyDict>) -> PyResult<FramePose> {
    let values = table(pose, Mesh::value_of)?;
    values.try_into().map_err(|e: toml::de::Error| {
        let message = format!("what `{key}` is driven to is no pose: {}", e.message());
        let remedy =
            "give `position`, three metres, and `orientation`, a unit quaternion w, x, y, z";
        of_scene(
            pose.py(),
            &Problem::new(key.clone(), message, remedy).into(),
        )
    })
}

/// The length of a step.
enum Length {
    /// In seconds.
    Given(f64),
    OfScene,
    /// The next one of a run until this time, seconds.
    Until(f64),
}

#[pymethods]
impl Simulation {
    #[new]
    fn new(py: Python<'_>, scene: &Scene) -> PyResult<Self> {
        let file = scene.file().clone();
        let live = py.detach(|| LiveScene::start(file));
        live.map(Self::of).map_err(|e| of_scene(py, &e))
    }

    /// The simulation at a checkpoint, bit for bit.
    ///
    /// scene: the scene of the simulation when the checkpoint was made (Simulation.scene).
    /// checkpoint: what Simulation.checkpoint returned.
    #[staticmethod]
    fn resume(py: Python<'_>, scene: &Scene, checkpoint: &[u8]) -> PyResult<Self> {
        let file = scene.file().clone();
        let checkpoint = Checkpoint::from_bytes(checkpoint).map_err(|e| plain(py, &e))?;
        let live = py.detach(|| LiveScene::resume(file, checkpoint));
        live.map(Self::of).map_err(|e| of_scene(py, &e))
    }

    /// The present state as bytes, from which Simulation.resume goes on with the same bits.
    fn checkpoint<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyBytes>> {
        let bytes = self.copied(py, |s| s.checkpoint().to_bytes());
        let bytes = bytes.map_err(|e| plain(py, &e))?;
        Ok(PyBytes::new(py, &bytes))
    }

    /// For `pickle` and `copy`: the scene and a checkpoint, from which the copy goes on with the same bits.
    fn __reduce__<'py>(slf: &Bound<'py, Self>) -> PyResult<Remade<'py>> {
        let (py, own) = (slf.py(), slf.get());
        let scene = Bound::new(py, own.scene(py))?.into_any();
        remade(slf, "resume", vec![scene, own.checkpoint(py)?.into_any()])
    }

    /// Advances by `h` seconds, by default the step of the scene, and returns a `StepReport`.
    ///
    /// Raises `ValueError` for a length that is not positive; `StepFailed`, which has key, time and advice.
    /// Then and after Ctrl-C the state is that of the last accepted sub-step.
    #[pyo3(signature = (h = None))]
    fn step(&self, py: Python<'_>, h: Option<f64>) -> PyResult<Option<StepReport>> {
        if let Some(h) = h.filter(|h| !(h.is_finite() && *h > 0.0)) {
            let message = format!("h is {h}; a step has a positive length in seconds");
            return Err(PyValueError::new_err(message));
        }
        self.advance(py, h.map_or(Length::OfScene, Length::Given))
    }

    /// Takes steps of the scene until the time `until` (seconds), the last one as short as that asks for.
    ///
    /// each: a function that is called after every step with its report, and ends the run by returning True.
    ///
    /// Returns the reports. Raises `ValueError` for a time that is no number, and takes no step for one that
    /// has passed. Ctrl-C raises `KeyboardInterrupt` within a step or after it, and the run can go on.
    #[pyo3(signature = (until, each = None))]
    fn run(
        &self,
        py: Python<'_>,
        until: f64,
        each: Option<&Bound<'_, PyAny>>,
    ) -> PyResult<Vec<Py<StepReport>>> {
        if until.is_nan() {
            return Err(PyValueError::new_err(
                "until is nan; give a time in seconds",
            ));
        }
        let mut reports = Vec::new();
        while let Some(report) = self.advance(py, Length::Until(until))? {
            let report = Py::new(py, report)?;
            let ends = match each {
                None => false,
                Some(each) => each
                    .call1((&report,))?
                    .extract::<Option<bool>>()?
                    .unwrap_or(false),
            };
            reports.push(report);
            py.check_signals()?;
            if ends {
                break;
            }
        }
        Ok(reports)
    }

    /// Records all steps from now on in a folder, as `isosheet simulate` does: page, frames, history, loads,
    /// measures, summary. Use it in a ``with`` statement, or call its `close`.
    ///
    /// fps: frames per second of simulated time, by default as in the scene.
    /// every: the number of steps from one frame to the next, in place of `fps`.
    /// replace: whether a run that the folder holds is deleted; without it, it is kept, and `RunFailed`
    /// raised.
    ///
    /// Without changes between the steps the files have the bits of the files of the command, but for wall
    /// times. The scene in the folder has what was driven as it went, and ends where the recording does; what
    /// else was changed is in ``run.summary["control"]``.
    ///
    ///     >>> simulation = isosheet.Simulation(isosheet.Scene.new("hanging"))
    ///     >>> with simulation.record("hanging-run", every=1):
    ///     ...     report = simulation.step()
    #[pyo3(signature = (folder, *, fps = None, every = None, replace = false))]
    fn record(
        slf: &Bound<'_, Self>,
        folder: PathBuf,
        fps: Option<f64>,
        every: Option<u64>,
        replace: bool,
    ) -> PyResult<recorder::Recorder> {
        let py = slf.py();
        if every == Some(0) || every.is_some() && fps.is_some() {
            let message = "give `fps`, or `every`, a number of steps from 1";
            return Err(PyValueError::new_err(message));
        }
        let begun = slf.get().with_recorder(py, |inner| {
            if let Some(recorder) = &inner.recorder {
                return Ok(Some(recorder.folder().to_owned()));
            }
            let step = inner.live.file().scene().method.step;
            let options = RecorderOptions {
                frames_per_second: fps.or(every.map(|steps| 1.0 / (steps as f64 * step))),
                existing: match replace {
                    true => ExistingRun::Delete,
                    false => ExistingRun::Keep,
                },
            };
            let recorder = Recorder::begin(&mut inner.live, &folder, &options)?;
            inner.recorder = Some(recorder);
            Ok(None)
        });
        match begun.map_err(|e| of_run(py, &e))? {
            None => {
                let simulation = slf.clone().unbind();
                let end = move |py: Python<'_>, end| simulation.get().end_recording(py, end);
                Ok(recorder::Recorder::new(Box::new(end), folder))
            }
            Some(other) => Err(PyValueError::new_err(format!(
                "the simulation is recorded in {} already; end that recording first",
                other.display()
            ))),
        }
    }

    /// The 3D page of the present state, one text of HTML that needs no other file and no connection.
    fn html(&self, py: Python<'_>) -> PyResult<String> {
        let replay = self.replay(py)?;
        let page = py.detach(|| replay.to_html_with(&PageOptions::default()));
        page.map_err(|e| plain(py, &e))
    }

    /// Opens the 3D page of the present state in the browser; returns the file.
    fn show<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyAny>> {
        let page = self.html(py)?;
        py.import("isosheet._show")?.call_method1("show", (page,))
    }

    /// The 3D page of the present state in a frame of a notebook.
    fn _repr_html_(&self, py: Python<'_>) -> PyResult<String> {
        Ok(framed(&self.html(py)?))
    }

    /// Changes values of the scene from now on: ``simulation.change({"forces.gravity": [0, 0, 0]})``.
    ///
    /// What acts on the sheet may change: forces, creases, damping, air, bodies, friction, motions of
    /// supports. What a change does at once counts as work. Raises `SceneError`, and then nothing has
    /// changed.
    fn change(&self, py: Python<'_>, edits: &Bound<'_, PyDict>) -> PyResult<()> {
        let edits = edits_of(edits, Mesh::value_of)?;
        self.with(py, |live| live.change(&edits))
            .map_err(|e| of_file(py, &e))
    }

    /// Lets functions of time go from their present values to others, along a ramp until the time `until`
    /// (seconds):
    /// ``simulation.drive({"support[0].hold.moving_pin.z": 0.01}, until=simulation.time + 0.1)``.
    ///
    /// Values have the units of scenes: metres, degrees, newtons. A rigid motion goes to a pose:
    /// ``simulation.drive({"obstacle[0].motion": {"position": p, "orientation": q}}, until=0.1)``, with the
    /// origin of its frame p, metres, and a unit quaternion q, w x y z, that takes directions of the frame to
    /// directions of space. The frame of an obstacle is its own, and that of a support,
    /// `support[0].hold.moving_clamp`, the one of space at the start, if the scene says no other with
    /// `poses`. Until then the origin goes straight, and the frame turns about one axis, the shorter way
    /// round.
    fn drive(&self, py: Python<'_>, targets: &Bound<'_, PyDict>, until: f64) -> PyResult<()> {
        let target = |(key, value): (Bound<'_, PyAny>, Bound<'_, PyAny>)| {
            let text: String = key.extract()?;
            let key: Key = text
                .parse()
                .map_err(|e: KeyError| PyKeyError::new_err(e.to_string()))?;
            match value.cast::<PyDict>() {
                Ok(pose) => {
                    let pose = pose_of(&key, pose)?;
                    Ok((key, Target::Pose(pose)))
                }
                Err(_) => Ok((key, Target::Value(value.extract()?))),
            }
        };
        let targets = targets
            .iter()
            .map(target)
            .collect::<PyResult<Vec<(Key, Target)>>>()?;
        self.with(py, |live| live.drive(&targets, until))
            .map_err(|e| of_file(py, &e))
    }

    /// The scene with all changes.
    #[getter]
    fn scene(&self, py: Python<'_>) -> Scene {
        Scene::of(self.with(py, |live| live.file().clone()))
    }

    /// What is modelled, in words.
    #[getter]
    fn modelled(&self, py: Python<'_>) -> Vec<String> {
        self.with(py, |live| live.facts().modelled.to_vec())
    }

    /// Of several sheets the vertices of each by its name, as slices:
    /// ``simulation.x[simulation.sheets["top"]]``. Empty for one sheet.
    #[getter]
    fn sheets<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyDict>> {
        slices(py, &self.with(py, |live| live.facts().parts.to_vec()))
    }

    /// Time, seconds.
    #[getter]
    fn time(&self, py: Python<'_>) -> f64 {
        self.copied(py, |s| s.state().t)
    }

    /// Positions of the vertices, metres: a copy of shape (V, 3).
    #[getter]
    fn x<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyArray2<f64>>> {
        vectors(py, &self.with(py, |live| live.positions().into_owned()))
    }

    /// Velocities of the vertices, m/s: a copy of shape (V, 3).
    #[getter]
    fn v<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyArray2<f64>>> {
        vectors(py, &self.with(py, |live| live.velocities().into_owned()))
    }

    /// Corners of the triangles, of shape (F, 3).
    #[getter]
    fn faces<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyArray2<u32>>> {
        rows(py, &self.with(py, |live| live.facts().sheet.face_indices()))
    }

    /// Ends of the edges, of shape (E, 2).
    #[getter]
    fn edges<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyArray2<u32>>> {
        rows(py, &self.with(py, |live| edges(&live.facts().sheet)))
    }

    /// Rest lengths of the edges, metres, of shape (E,).
    #[getter]
    fn rest_lengths<'py>(&self, py: Python<'py>) -> Bound<'py, PyArray1<f64>> {
        array(
            py,
            &self.with(py, |live| live.facts().sheet.lengths().to_vec()),
        )
    }

    /// Masses of the vertices, kg, of shape (V,); zero for vertices of rigid bodies.
    #[getter]
    fn masses<'py>(&self, py: Python<'py>) -> Bound<'py, PyArray1<f64>> {
        array(py, &self.with(py, |live| live.masses()))
    }

    /// Numbers of the pinned vertices, at rest or in motion.
    #[getter]
    fn pins<'py>(&self, py: Python<'py>) -> Bound<'py, PyArray1<u32>> {
        let pins: Vec<VertexId> = self.with(py, |live| live.pins());
        array(py, &pins.iter().map(|v| v.0).collect::<Vec<_>>())
    }

    /// Forces of pins, curves and surfaces on the sheet in the last step, newtons, at the vertices that they
    /// hold, of shape (V, 3); zero before the first step.
    #[getter]
    fn reactions<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyArray2<f64>>> {
        vectors(py, &self.with(py, |live| live.reactions()))
    }

    /// Force of each support of the scene on the sheet in the last step, newtons, of shape (supports, 3).
    #[getter]
    fn support_forces<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyArray2<f64>>> {
        rows(py, &self.with(py, |live| live.support_forces()))
    }

    /// Force of the sheet on each obstacle of the scene, newtons, of shape (obstacles, 3).
    #[getter]
    fn obstacle_forces<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyArray2<f64>>> {
        let loads = self.with(py, |live| live.obstacle_loads());
        rows(
            py,
            &loads
                .iter()
                .map(|load| load.force)
                .collect::<Vec<[f64; 3]>>(),
        )
    }

    /// Force of contact on each rigid body of the scene, newtons, of shape (bodies, 3).
    #[getter]
    fn body_forces<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyArray2<f64>>> {
        let loads = self.with(py, |live| live.body_loads());
        rows(
            py,
            &loads
                .iter()
                .map(|load| load.force)
                .collect::<Vec<[f64; 3]>>(),
        )
    }

    /// Centre of mass of each rigid body of the scene, metres, of shape (bodies, 3).
    #[getter]
    fn body_centres<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyArray2<f64>>> {
        let centres = self.with(py, |live| {
            let x = &live.simulation().state().x;
            let bodies = live.facts().bodies.iter();
            bodies.map(|body| body.centre(x)).collect::<Vec<[f64; 3]>>()
        });
        rows(py, &centres)
    }

    /// Forces of contact on the vertices, newtons, of shape (V, 3); None without contact.
    #[getter]
    fn contact_forces<'py>(&self, py: Python<'py>) -> PyResult<Option<Bound<'py, PyArray2<f64>>>> {
        let forces = self.copied(py, |s| s.surface_forces());
        forces.map(|f| vectors(py, &f)).transpose()
    }

    /// Forces of the rods in the last step, newtons, tension positive, of shape (E,); None of sheets without
    /// rods.
    #[getter]
    fn rod_forces<'py>(&self, py: Python<'py>) -> Option<Bound<'py, PyArray1<f64>>> {
        let forces = self.with(py, |live| live.rod_forces());
        forces.map(|f| array(py, &f))
    }

    /// Energies, joules: "kinetic", "potential" (contact included) and "total".
    #[getter]
    fn energies<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyDict>> {
        let (kinetic, total) =
            self.copied(py, |s| (s.model().kinetic_energy(&s.state().v), s.energy()));
        let energies = PyDict::new(py);
        energies.set_item("kinetic", kinetic)?;
        energies.set_item("potential", total - kinetic)?;
        energies.set_item("total", total)?;
        Ok(energies)
    }

    /// Smallest gap, metres: None without contact, infinite where nothing is close.
    #[getter]
    fn gap(&self, py: Python<'_>) -> Option<f64> {
        self.copied(py, |s| s.contacts().map(|c| c.gap()))
    }

    /// Smallest gap of each vertex and of its edges and faces, metres, at most the distance from which
    /// contact acts, of shape (V,); None without contact.
    #[getter]
    fn gaps<'py>(&self, py: Python<'py>) -> Option<Bound<'py, PyArray1<f64>>> {
        let gaps = self.copied(py, |s| s.vertex_gaps());
        gaps.map(|g| array(py, &g))
    }

    /// Largest relative error of an edge length.
    #[getter]
    fn strain(&self, py: Python<'_>) -> f64 {
        self.copied(py, |s| s.model().edges().max_strain(&s.state().x))
    }

    fn __repr__(&self, py: Python<'_>) -> String {
        let (t, count) = self.copied(py, |s| (s.state().t, s.model().topology().vertex_count()));
        format!("<isosheet.Simulation of {count} vertices at {t} s>")
    }
}
