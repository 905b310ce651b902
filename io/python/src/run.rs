//! What a run has written.

use crate::arrays::{array, rows, slices};
use crate::error::{of_run, plain};
use crate::picture::{Kind, Shown, framed, options};
use crate::recorded::Run;
use crate::scene::Scene;
use crate::value::to_python;
use isosheet_formats::{HistoryRow, LoadKind, LoadRow, SeriesOptions, write_frame, write_series};
use isosheet_page::PageOptions;
use isosheet_runs as run;
use isosheet_runs::Recording;
use numpy::{PyArray1, PyArray2, PyArray3, PyArrayMethods};
use pyo3::exceptions::{PyIndexError, PyValueError};
use pyo3::prelude::*;
use pyo3::types::{PyDict, PyTuple, PyType};
use std::collections::BTreeMap;
use std::path::PathBuf;
use toml::Value;

/// A column of the history: its name and its values.
type Column<T> = (&'static str, fn(&HistoryRow) -> T);

impl Run {
    /// What a folder has.
    pub(crate) fn read(py: Python<'_>, folder: PathBuf) -> PyResult<Self> {
        let recording = py.detach(|| Recording::read(&folder));
        let recording = recording.map_err(|e| of_run(py, &e))?;
        Ok(Self { folder, recording })
    }

    /// The run with so many frames a second, if that is asked for.
    fn at_rate(
        &self,
        py: Python<'_>,
        every: usize,
        fps: Option<f64>,
    ) -> PyResult<Option<Recording>> {
        let Some(rate) = fps else { return Ok(None) };
        if every != 1 {
            return Err(PyValueError::new_err(
                "every and fps both choose frames; give one of them",
            ));
        }
        let mut run = Self::read(py, self.folder.clone())?.recording;
        let all = [0, self.recording.trajectory.len().saturating_sub(1)];
        let changed = py.detach(|| self.recording.trajectory.at_rate(rate, all));
        run.trajectory = changed.map_err(|e| plain(py, &e))?;
        Ok(Some(run))
    }

    /// The frame of a number or the one that is nearest to a time, seconds, if one is asked for.
    fn frame_at(&self, frame: Option<isize>, time: Option<f64>) -> PyResult<Option<usize>> {
        let trajectory = &self.recording.trajectory;
        let count = trajectory.len();
        match (frame, time) {
            (None, None) => Ok(None),
            (Some(_), Some(_)) => Err(PyValueError::new_err(
                "frame and time both choose a frame; give one of them",
            )),
            (Some(frame), None) => {
                let number = match frame < 0 {
                    true => count.checked_add_signed(frame),
                    false => Some(frame.unsigned_abs()),
                };
                let number = number.filter(|k| *k < count).ok_or_else(|| {
                    PyIndexError::new_err(format!(
                        "the run has {count} frames, and no frame {frame}"
                    ))
                })?;
                Ok(Some(number))
            }
            (None, Some(time)) => {
                let number = trajectory.nearest(time).ok_or_else(|| {
                    PyValueError::new_err(format!(
                        "there is no frame near {time} s; give a time of the run, seconds"
                    ))
                })?;
                Ok(Some(number))
            }
        }
    }

    /// The values of all frames one after the other, and how many each frame has; `None` if frames have none.
    fn frames<'a>(
        &'a self,
        frame: impl Fn(usize) -> Option<&'a [f64]>,
    ) -> Option<(Vec<f64>, usize)> {
        let width = frame(0)?.len();
        let frames = (0..self.recording.trajectory.len()).filter_map(frame);
        Some((frames.flatten().copied().collect(), width))
    }

    /// Values of shape (T, N).
    fn numbers<'py, 'a>(
        &'a self,
        py: Python<'py>,
        frame: impl Fn(usize) -> Option<&'a [f64]>,
    ) -> PyResult<Option<Bound<'py, PyArray2<f64>>>> {
        let Some((values, width)) = self.frames(frame) else {
            return Ok(None);
        };
        let count = self.recording.trajectory.len();
        array(py, &values).reshape([count, width]).map(Some)
    }

    /// Vectors of shape (T, V, 3).
    fn vectors<'py, 'a>(
        &'a self,
        py: Python<'py>,
        frame: impl Fn(usize) -> Option<&'a [f64]>,
    ) -> PyResult<Option<Bound<'py, PyArray3<f64>>>> {
        self.tuples(py, 3, frame)
    }

    /// Tuples of n numbers, of shape (T, N, n).
    fn tuples<'py, 'a>(
        &'a self,
        py: Python<'py>,
        n: usize,
        frame: impl Fn(usize) -> Option<&'a [f64]>,
    ) -> PyResult<Option<Bound<'py, PyArray3<f64>>>> {
        let Some((values, width)) = self.frames(frame) else {
            return Ok(None);
        };
        let count = self.recording.trajectory.len();
        array(py, &values).reshape([count, width / n, n]).map(Some)
    }
}

/// Values of all frames, frame by frame.
fn frames_of(values: &[f64], count: usize) -> Vec<&[f64]> {
    values
        .chunks((values.len() / count.max(1)).max(1))
        .collect()
}

#[pymethods]
impl Run {
    #[new]
    fn new(py: Python<'_>, folder: PathBuf) -> PyResult<Self> {
        Self::read(py, folder)
    }

    /// For `pickle` and `copy`: the folder, from which the run is read again.
    fn __reduce__<'py>(slf: &Bound<'py, Self>) -> PyResult<(Bound<'py, PyType>, (PathBuf,))> {
        let folder = &slf.get().folder;
        let whole = std::path::absolute(folder).unwrap_or_else(|_| folder.clone());
        Ok((slf.get_type(), (whole,)))
    }

    /// The folder.
    #[getter]
    fn folder(&self) -> PathBuf {
        self.folder.clone()
    }

    /// The scene as it was run.
    #[getter]
    fn scene(&self) -> Scene {
        Scene::of(self.recording.scene.clone())
    }

    /// What was modelled, in words.
    #[getter]
    fn modelled(&self) -> Vec<String> {
        self.recording.modelled.clone()
    }

    /// Of several sheets the vertices of each by its name, as slices: ``run.x[:, run.sheets["top"]]``.
    ///
    /// Empty for one sheet.
    #[getter]
    fn sheets<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyDict>> {
        slices(py, &self.recording.parts)
    }

    /// Times of the frames, seconds, of shape (T,).
    #[getter]
    fn time<'py>(&self, py: Python<'py>) -> Bound<'py, PyArray1<f64>> {
        array(py, self.recording.trajectory.times())
    }

    /// Positions of the vertices in the frames, metres, of shape (T, V, 3).
    #[getter]
    fn x<'py>(&self, py: Python<'py>) -> PyResult<Option<Bound<'py, PyArray3<f64>>>> {
        self.vectors(py, |k| self.recording.trajectory.frame(k))
    }

    /// Corners of the triangles, of shape (F, 3).
    #[getter]
    fn faces<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyArray2<u32>>> {
        rows(py, self.recording.trajectory.faces())
    }

    /// Ends of the edges, of shape (E, 2).
    #[getter]
    fn edges<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyArray2<u32>>> {
        rows(py, self.recording.trajectory.edges())
    }

    /// Rest lengths of the edges, metres, of shape (E,).
    #[getter]
    fn rest_lengths<'py>(&self, py: Python<'py>) -> Bound<'py, PyArray1<f64>> {
        array(py, self.recording.trajectory.rest_lengths())
    }

    /// Forces of the rods in the frames, newtons, tension positive, of shape (T, E); None of sheets without
    /// rods.
    #[getter]
    fn rod_forces<'py>(&self, py: Python<'py>) -> PyResult<Option<Bound<'py, PyArray2<f64>>>> {
        self.numbers(py, |k| self.recording.trajectory.rod_forces(k))
    }

    /// Forces of contact on the vertices in the frames, newtons, of shape (T, V, 3); None without contact.
    #[getter]
    fn contact_forces<'py>(&self, py: Python<'py>) -> PyResult<Option<Bound<'py, PyArray3<f64>>>> {
        self.vectors(py, |k| self.recording.trajectory.contact_forces(k))
    }

    /// Smallest gap of each vertex in the frames, metres, of shape (T, V); None without contact.
    #[getter]
    fn gaps<'py>(&self, py: Python<'py>) -> PyResult<Option<Bound<'py, PyArray2<f64>>>> {
        self.numbers(py, |k| self.recording.trajectory.gaps(k))
    }

    /// Plastic angles of the edges in the frames, radians, positive for valleys, of shape (T, E); None where
    /// no edge can yield.
    #[getter]
    fn plastic_angles<'py>(&self, py: Python<'py>) -> PyResult<Option<Bound<'py, PyArray2<f64>>>> {
        self.numbers(py, |k| self.recording.trajectory.plastic_angles(k))
    }

    /// Bends of the faces beside creases in the frames, radians, positive for valleys, of shape (T, E), 0 at
    /// other edges: the angle between the faces at a crease is its fold angle and this bend. None where no
    /// crease is in a sheet that bends.
    #[getter]
    fn crease_bends<'py>(&self, py: Python<'py>) -> PyResult<Option<Bound<'py, PyArray2<f64>>>> {
        self.numbers(py, |k| self.recording.trajectory.crease_bends(k))
    }

    /// Principal values of the plastic curvature of the faces in the frames, 1/m, the larger one in size
    /// first, positive for valleys, of shape (T, F, 2); None where no face can yield.
    #[getter]
    fn plastic_curvatures<'py>(
        &self,
        py: Python<'py>,
    ) -> PyResult<Option<Bound<'py, PyArray3<f64>>>> {
        self.tuples(py, 2, |k| self.recording.trajectory.plastic_curvatures(k))
    }

    /// Unit vectors along the rulings of the faces in the frames, of shape (T, F, 3): the straight lines of a
    /// bent sheet, the direction of the principal curvature that is smaller in size, with the component of
    /// largest size positive. Zero where a face has none: where it is not bent beyond noise, or alike in all
    /// directions. They are made of the positions whenever they are asked for.
    #[getter]
    fn rulings<'py>(&self, py: Python<'py>) -> PyResult<Option<Bound<'py, PyArray3<f64>>>> {
        let Some(all) = py.detach(|| self.recording.rulings()) else {
            return Ok(None);
        };
        let frames = frames_of(&all.directions, self.recording.trajectory.len());
        self.tuples(py, 3, |k| frames.get(k).copied())
    }

    /// Principal curvatures across the rulings, 1/m, positive for valleys, of shape (T, F); 0 where a face
    /// has none.
    #[getter]
    fn ruling_curvatures<'py>(
        &self,
        py: Python<'py>,
    ) -> PyResult<Option<Bound<'py, PyArray2<f64>>>> {
        let Some(all) = py.detach(|| self.recording.rulings()) else {
            return Ok(None);
        };
        let frames = frames_of(&all.curvatures, self.recording.trajectory.len());
        self.numbers(py, |k| frames.get(k).copied())
    }

    /// Gauss curvatures at the vertices, less the rest shape, 1/m2, of shape (T, V): how far the sheet is
    /// from developable.
    #[getter]
    fn gauss_curvatures<'py>(
        &self,
        py: Python<'py>,
    ) -> PyResult<Option<Bound<'py, PyArray2<f64>>>> {
        let Some(all) = py.detach(|| self.recording.rulings()) else {
            return Ok(None);
        };
        let frames = frames_of(&all.gauss_curvatures, self.recording.trajectory.len());
        self.numbers(py, |k| frames.get(k).copied())
    }

    /// One array for each column of `history.csv`, with a row for the start and for every step: "time", "h",
    /// "substeps", "iterations", "factorisations", "rejected", "kinetic", "potential", "total", "drift" (of
    /// the total energy), "work", and what "damped", "friction" and "plastic" bending have dissipated (the
    /// last is NaN where nothing can yield), "strain", "gap" (NaN without contact). Seconds, joules, metres.
    #[getter]
    fn history<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyDict>> {
        let rows = &self.recording.history;
        let columns = PyDict::new(py);
        let numbers: [Column<f64>; 12] = [
            ("time", |row| row.t),
            ("h", |row| row.h),
            ("kinetic", |row| row.kinetic),
            ("potential", |row| row.potential),
            ("total", |row| row.total),
            ("drift", |row| row.drift),
            ("work", |row| row.work),
            ("damped", |row| row.damped),
            ("friction", |row| row.friction),
            ("strain", |row| row.strain),
            ("gap", |row| row.gap.unwrap_or(f64::NAN)),
            ("plastic", |row| row.plastic.unwrap_or(f64::NAN)),
        ];
        for (name, of) in numbers {
            columns.set_item(name, array(py, &rows.iter().map(of).collect::<Vec<_>>()))?;
        }
        let counts: [Column<usize>; 4] = [
            ("substeps", |row| row.substeps),
            ("iterations", |row| row.iterations),
            ("factorisations", |row| row.factorisations),
            ("rejected", |row| row.rejected),
        ];
        for (name, of) in counts {
            let column: Vec<u64> = rows.iter().map(|row| of(row) as u64).collect();
            columns.set_item(name, array(py, &column))?;
        }
        Ok(columns)
    }

    /// What each `[[measure]]` of the scene shows by its name, and of each gas "gas[0].pressure" (pascals
    /// above vacuum), "gas[0].gauge_pressure" and "gas[0].volume" (or with the name of the gas), in the unit
    /// of its quantity, at the start and at the end of every step: at the times of `history["time"]`. Of a
    /// run that is not complete the last one may be missing.
    #[getter]
    fn measures<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyDict>> {
        let columns = PyDict::new(py);
        for series in run::measure_series(&self.recording.measures, &self.recording.facts.measures)
        {
            columns.set_item(series.name, array(py, &series.values))?;
        }
        Ok(columns)
    }

    /// The loads of `loads.csv` at the ends of the steps, by "support[0]", ..., "obstacle[0]", ...,
    /// "body[0]", ... and "guide[0]", ... with the numbers of bodies; obstacles and bodies that the scene
    /// gives a name, by that: a dict of "time" of shape (S,), seconds, "force" of shape (S, 3), newtons, and
    /// "torque" of shape (S, 3), newton metres: from a support on the sheet, with the torque about the mean
    /// of its vertices; from the sheet on an obstacle, with the torque about the origin of its own frame; on
    /// a body from all that touches it, with the torque about its centre of mass; from a guide on its body.
    #[getter]
    fn loads<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyDict>> {
        // Supports come first, then obstacles, bodies and guides, by their numbers.
        let mut bodies: BTreeMap<(LoadKind, usize), Vec<&LoadRow>> = BTreeMap::new();
        for row in &self.recording.loads {
            bodies.entry((row.on, row.number)).or_default().push(row);
        }
        let loads = PyDict::new(py);
        for ((on, number), steps) in bodies {
            let scene = self.recording.scene.scene();
            let called = match on {
                LoadKind::Obstacle => scene.obstacle.get(number).map(|o| o.called(number)),
                LoadKind::Body => scene.body.get(number).map(|b| b.called(number)),
                LoadKind::Support | LoadKind::Guide => None,
            };
            let kind = match on {
                LoadKind::Support => "support",
                LoadKind::Obstacle => "obstacle",
                LoadKind::Body => "body",
                LoadKind::Guide => "guide",
            };
            let columns = PyDict::new(py);
            let times: Vec<f64> = steps.iter().map(|row| row.t).collect();
            let forces: Vec<[f64; 3]> = steps.iter().map(|row| row.force).collect();
            columns.set_item("time", array(py, &times))?;
            columns.set_item("force", rows(py, &forces)?)?;
            let torques: Vec<[f64; 3]> = steps.iter().map(|row| row.torque).collect();
            columns.set_item("torque", rows(py, &torques)?)?;
            let name = called.unwrap_or_else(|| format!("{kind}[{number}]"));
            loads.set_item(name, columns)?;
        }
        Ok(loads)
    }

    /// The units of what `history`, `measures` and the forces of `loads` show, by their names; "" of numbers
    /// without one.
    #[getter]
    fn units<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyDict>> {
        let units = PyDict::new(py);
        for name in self.loads(py)?.keys() {
            units.set_item(name, "N")?;
        }
        for name in self.history(py)?.keys() {
            let unit = match name.extract::<String>()?.as_str() {
                "time" | "h" => "s",
                "gap" => "m",
                "strain" | "substeps" | "iterations" | "factorisations" | "rejected" => "",
                _ => "J",
            };
            units.set_item(name, unit)?;
        }
        for gauge in &self.recording.facts.measures {
            units.set_item(&gauge.name, gauge.unit())?;
        }
        Ok(units)
    }

    /// What `summary.json` says; None of a run that is not complete.
    #[getter]
    fn summary<'py>(&self, py: Python<'py>) -> PyResult<Option<Bound<'py, PyAny>>> {
        let Some(summary) = &self.recording.summary else {
            return Ok(None);
        };
        let value = Value::try_from(summary);
        let value = value.map_err(|e| PyValueError::new_err(e.to_string()))?;
        to_python(py, &value).map(Some)
    }

    /// The 3D page of the run, one text of HTML that needs no other file and no connection.
    ///
    /// budget: the largest size, bytes; of a run that needs more, every second, fourth, ... frame is kept.
    #[pyo3(signature = (budget = PageOptions::default().budget))]
    fn html(&self, py: Python<'_>, budget: usize) -> PyResult<String> {
        let page = py.detach(|| {
            self.recording
                .replay()?
                .to_html_with(&PageOptions { budget })
        });
        page.map_err(|e| plain(py, &e))
    }

    /// Writes the 3D page of the run to a file.
    fn write_page(&self, py: Python<'_>, path: PathBuf) -> PyResult<()> {
        let written = py.detach(|| run::write_page(&self.folder, &path, &PageOptions::default()));
        written.map(drop).map_err(|e| of_run(py, &e))
    }

    /// The 3D page in a frame of a notebook.
    fn _repr_html_(&self, py: Python<'_>) -> PyResult<String> {
        Ok(framed(&self.html(py, PageOptions::default().budget)?))
    }

    /// Opens the 3D page in the browser; returns its file, which is a temporary one.
    fn show<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyAny>> {
        let page = self.html(py, PageOptions::default().budget)?;
        py.import("isosheet._show")?.call_method1("show", (page,))
    }

    /// Writes frames as a file of another program, whose format the extension says: .usda, .glb, .pvd, .pc2,
    /// .obj, .fold, .csv or .npz; see `isosheet convert`. A picture or a film is written by `picture` and
    /// `film`.
    ///
    /// frame: one frame alone, by its number, from the end where negative; then .stl, .off and .ply, too.
    /// time: one frame alone, the one that is nearest to a time, seconds; of two that are as near the later.
    /// every: every so many frames one.
    /// fps: frames a second in place of the recorded frames, between which vertices go straight on.
    ///
    /// Returns the files, the one with that name last. ``run.save("cloth.usda", fps=24)``,
    /// ``run.save("end.obj", frame=-1)``
    #[pyo3(signature = (path, *, frame = None, time = None, every = 1, fps = None))]
    fn save(
        &self,
        py: Python<'_>,
        path: PathBuf,
        frame: Option<isize>,
        time: Option<f64>,
        every: usize,
        fps: Option<f64>,
    ) -> PyResult<Vec<PathBuf>> {
        if let Some(folder) = run::run_of_file(&path) {
            return Err(PyValueError::new_err(format!(
                "{} is a file of the run in {}; choose another name",
                path.display(),
                folder.display()
            )));
        }
        if let Some(number) = self.frame_at(frame, time)? {
            if every != 1 || fps.is_some() {
                return Err(PyValueError::new_err(
                    "every and fps choose many frames, and frame and time one; leave out one or the other",
                ));
            }
            let saved = py.detach(|| {
                let series = self.recording.series(&SeriesOptions::default())?;
                write_frame(&path, &series, number)
            });
            return saved.map(|()| vec![path]).map_err(|e| plain(py, &e));
        }
        let options = SeriesOptions {
            every,
            rate: fps.unwrap_or(SeriesOptions::default().rate),
            ..SeriesOptions::default()
        };
        let other = self.at_rate(py, every, fps)?;
        let recording = other.as_ref().unwrap_or(&self.recording);
        let saved = py.detach(|| write_series(&path, &recording.series(&options)?));
        saved.map(|saved| saved.files).map_err(|e| plain(py, &e))
    }

    /// Writes a shaded picture of a frame as a PNG file: ``run.picture("end.png")``.
    ///
    /// frame: its number, from the end where negative; by default the last one.
    /// time: the frame that is nearest to a time, seconds, in its place.
    /// height: pixels; the width follows from what is seen.
    /// view: where the viewer is, degrees counter-clockwise from the x axis and above the horizon.
    /// colour: a quantity that the sheet is coloured by, such as "gap", with a scale of colours below the
    ///     sheet; an unknown name raises an `Error` with the names that the run has.
    /// range: the values at both ends of the scale, by default those in what is drawn.
    #[pyo3(signature = (path, frame = None, *, time = None, height = 480, view = None, colour = None, range = None))]
    #[expect(clippy::too_many_arguments, reason = "keywords of Python")]
    fn picture(
        &self,
        py: Python<'_>,
        path: PathBuf,
        frame: Option<isize>,
        time: Option<f64>,
        height: usize,
        view: Option<(f64, f64)>,
        colour: Option<String>,
        range: Option<[f64; 2]>,
    ) -> PyResult<()> {
        let last = || self.frame_at(Some(-1), None);
        let number = match self.frame_at(frame, time)? {
            Some(number) => Some(number),
            None => last()?,
        };
        let shown = Shown {
            recording: &self.recording,
            frames: number.into_iter().collect(),
            options: options(height, view, (colour, range)),
        };
        shown.write(py, &path, Kind::Picture)
    }

    /// Writes shaded pictures of the frames in real time as an animated PNG file, which browsers and
    /// notebooks show, or where ffmpeg is installed as an .mp4, .webm or .gif file:
    /// ``run.film("cloth.apng")``.
    ///
    /// every and fps are as in `save`, height, view, colour and range as in `picture`.
    #[pyo3(signature = (path, *, every = 1, fps = None, height = 480, view = None, colour = None, range = None))]
    #[expect(clippy::too_many_arguments, reason = "keywords of Python")]
    fn film(
        &self,
        py: Python<'_>,
        path: PathBuf,
        every: usize,
        fps: Option<f64>,
        height: usize,
        view: Option<(f64, f64)>,
        colour: Option<String>,
        range: Option<[f64; 2]>,
    ) -> PyResult<()> {
        if every == 0 {
            return Err(PyValueError::new_err(
                "every is 0; give a number of frames from 1",
            ));
        }
        let other = self.at_rate(py, every, fps)?;
        let recording = other.as_ref().unwrap_or(&self.recording);
        let shown = Shown {
            recording,
            frames: (0..recording.trajectory.len()).step_by(every).collect(),
            options: options(height, view, (colour, range)),
        };
        shown.write(py, &path, Kind::Film)
    }

    /// Plots quantities over time with matplotlib, which is no part of isosheet:
    /// ``run.plot("tip", "total")``.
    ///
    /// names: measures, columns of the history, or bodies of `loads`, of which the size of the force is
    ///     shown; by default all measures, or the energies.
    /// ax: the axes of matplotlib, by default the current ones.
    ///
    /// Returns the axes. Raises `KeyError` for a name that there is not.
    #[pyo3(signature = (*names, ax = None))]
    fn plot<'py>(
        slf: &Bound<'py, Self>,
        names: &Bound<'py, PyTuple>,
        ax: Option<&Bound<'py, PyAny>>,
    ) -> PyResult<Bound<'py, PyAny>> {
        let show = slf.py().import("isosheet._show")?;
        show.call_method1("plot", (slf, names, ax))
    }

    fn __repr__(&self) -> String {
        let (frames, folder) = (self.recording.trajectory.len(), self.folder.display());
        format!("<isosheet.Run {folder} of {frames} frames>")
    }
}
