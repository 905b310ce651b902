//! What a run recorded, complete or not.

use super::folder::{RunFolder, stored_scene};
use super::frames::{FrameShape, StoredFrames, check_whole};
use super::plan::AtStart;
use super::series_body::series_body;
use super::{RunError, Summary};
use isosheet_collide::Obstacle;
use isosheet_dynamics::SheetModel;
use isosheet_files::{FileError, read_json};
use isosheet_formats::{
    EventRow, ExportError, HistoryRow, LoadRow, MeasureRow, MeshCounts, MotionFrame, MotionFrames,
    Series, SeriesBody, SeriesOptions, Trajectory, read_events, read_history, read_loads,
    read_measures,
};
use isosheet_mesh::{Sheet, VertexId};
use isosheet_scenes::{Facts, SceneFile};
use nalgebra::{Isometry3, Vector3};
use std::ops::{ControlFlow, Deref, DerefMut};
use std::path::Path;
use std::sync::Arc;

/// What a run recorded: everything that a page or a film of it needs.
#[derive(Debug)]
pub struct Recording {
    /// The name of the folder, without `-run` at its end.
    pub name: String,
    /// The scene as it was run.
    pub scene: SceneFile,
    /// What is known of the scene at its start. A recording has its fields.
    pub facts: Arc<Facts>,
    /// Vertices of sheets that rods to pins keep in place
    /// ([`immobile_vertices`](isosheet_dynamics::immobile_vertices)).
    pub immobile: Vec<VertexId>,
    /// The model.
    pub(crate) model: Arc<SheetModel>,
    /// How many numbers a frame has.
    pub(crate) shape: FrameShape,
    /// The frames with the mesh.
    pub trajectory: Trajectory,
    /// One row for each step, that of the start first.
    pub history: Vec<HistoryRow>,
    /// The loads of supports and obstacles at the end of each step.
    pub loads: Vec<LoadRow>,
    /// What the measures of the scene show at the start and at the end of each step.
    pub measures: Vec<MeasureRow>,
    /// What was taken up and released.
    pub events: Vec<EventRow>,
    /// What came of the run, if it is complete.
    pub summary: Option<Summary>,
}

impl Deref for Recording {
    type Target = Facts;

    fn deref(&self) -> &Facts {
        &self.facts
    }
}

impl DerefMut for Recording {
    fn deref_mut(&mut self) -> &mut Facts {
        Arc::make_mut(&mut self.facts)
    }
}

impl Recording {
    /// Reads the folder of a run. That of a run that goes on, that failed or was interrupted has the frames
    /// up to now.
    ///
    /// # Errors
    /// [`RunError::NoRun`] if the folder is not that of a run, [`RunError`] if a file cannot be read, or has
    /// fewer frames or rows than the summary of a complete run says.
    pub fn read(folder: &Path) -> Result<Self, RunError> {
        let (mut recording, frames) = Self::open(folder)?;
        recording.load(frames, folder)?;
        Ok(recording)
    }

    /// Reads the frames of the run in a folder, all of them into memory.
    pub(crate) fn load(&mut self, frames: RunFrames, folder: &Path) -> Result<(), RunError> {
        self.trajectory = match frames {
            RunFrames::Whole(trajectory) => *trajectory,
            // The trajectory of a run that goes on is that of its last stop.
            RunFrames::Stored(frames) => match &self.summary {
                Some(summary) if is_whole(folder) => whole_trajectory(folder, summary)?,
                _ => frames.trajectory(&self.sheet)?,
            },
        };
        Ok(())
    }

    /// All but the frames, of which the trajectory has none, and what shows these one at a time.
    pub(crate) fn open(folder: &Path) -> Result<(Self, RunFrames), RunError> {
        let scene = stored_scene(folder)?;
        let setup = scene.build()?;
        let summary = folder.join(RunFolder::SUMMARY);
        let summary = summary.is_file().then(|| read_json(&summary)).transpose()?;
        let (start, model) = (AtStart::of(&setup), Arc::new(setup.model));
        let tables = Tables::read(folder)?;
        let (mut recording, mut frames) = Self::of(folder, scene, (start, model), tables);
        recording.summary = summary;
        if let (Some(summary), RunFrames::Stored(stored)) = (&recording.summary, &mut frames) {
            let history = folder.join(RunFolder::HISTORY);
            let rows = recording.history.len() as u64;
            check_whole(&history, "row", rows, summary.steps + 1)?;
            stored.least = summary.frames;
            if is_whole(folder) && !stored.path.is_file() {
                frames = RunFrames::Whole(Box::new(whole_trajectory(folder, summary)?));
            }
        }
        Ok((recording, frames))
    }

    /// The recording of a run that is not complete yet, without its frames, and what shows these one at a
    /// time. It is made of the scene of the run, what that was built to, and its tables.
    pub(crate) fn of(
        folder: &Path,
        scene: SceneFile,
        (start, model): (AtStart, Arc<SheetModel>),
        tables: Tables,
    ) -> (Self, RunFrames) {
        let AtStart {
            facts,
            shape,
            immobile,
        } = start;
        let path = folder.join(RunFolder::FRAMES);
        let shape = shape.in_file(&path);
        let frames = RunFrames::Stored(StoredFrames {
            path,
            shape,
            least: 0,
        });
        let recording = Self {
            name: name_of(folder),
            scene,
            trajectory: Trajectory::new(&facts.sheet),
            facts,
            immobile,
            model,
            shape,
            history: tables.history,
            loads: tables.loads,
            measures: tables.measures,
            events: tables.events,
            summary: None,
        };
        (recording, frames)
    }

    /// Leaves the sheets alone: without obstacles, and without bodies and meshes in motion, which are parts
    /// of the mesh.
    pub fn leave_out_bodies(&mut self) {
        let count = self.scene.scene().sheet.len();
        let facts = Arc::make_mut(&mut self.facts);
        facts.obstacles.clear();
        facts.parts.truncate(count);
        let Some((_, last)) = facts.parts.last() else {
            return;
        };
        let counts = MeshCounts {
            vertices: last.vertices.end,
            edges: last.edges.end,
            faces: last.faces.end,
        };
        let faces = &facts.sheet.topology().faces()[..counts.faces];
        let faces: Vec<[u32; 3]> = faces.iter().map(|face| face.map(|v| v.0)).collect();
        let positions = facts.sheet.positions()[..3 * counts.vertices].to_vec();
        if let Ok(sheets) = Sheet::new(positions, &faces) {
            facts.sheet = sheets;
            self.trajectory = self.trajectory.of_first(counts);
            if let Some(assignments) = &mut facts.fold_assignments {
                assignments.truncate(counts.edges);
            }
        }
        if facts.parts.len() == 1 {
            facts.parts.clear();
        }
    }

    /// The frames for files of other programs, with bodies, the names of sheets and what edges are meant to
    /// do.
    ///
    /// # Errors
    /// [`ExportError`] for options that choose no frames.
    pub fn series(&self, options: &SeriesOptions) -> Result<Series<'_>, ExportError> {
        let mut series = Series::new(&self.trajectory, options)?;
        if let Some(assignments) = &self.fold_assignments {
            series = series.with_assignments(assignments.clone())?;
        }
        if !self.parts.is_empty() {
            series = series.with_sheets(&self.parts)?;
        }
        series.with_bodies(self.exported_bodies())
    }

    /// The obstacles that do not deform for files of other programs, `obstacle_0` and so on by their numbers
    /// in the scene, with their poses in the frames of the trajectory. Of a half-space there is a square that
    /// is larger than what the sheet passes through.
    pub fn exported_bodies(&self) -> Vec<SeriesBody> {
        let times = self.trajectory.times();
        let start = times.first().copied().unwrap_or_default();
        let body = |(k, obstacle): (usize, &Obstacle)| {
            let origin = obstacle.motion().pose(start).translation.vector;
            let frames = (0..times.len()).filter_map(|k| self.trajectory.frame(k));
            let points = frames.flat_map(|x| x.as_chunks::<3>().0);
            let far = points.map(|p| (Vector3::from(*p) - origin).norm());
            // Half as far again as the farthest point of the sheet.
            let half = 1.5 * far.fold(0.0, f64::max);
            let name = format!("obstacle_{}", self.origins.obstacle_number(k));
            series_body(name, obstacle, times, half)
        };
        self.obstacles.iter().enumerate().map(body).collect()
    }

    /// The pose of each obstacle at time `t` (seconds), in the order of the scene.
    pub fn poses(&self, t: f64) -> Vec<Isometry3<f64>> {
        let bodies = self.obstacles.iter();
        bodies.map(|body| body.motion().pose(t)).collect()
    }
}

/// The rows of a run for each of its steps.
#[derive(Clone, Debug, Default)]
pub(crate) struct Tables {
    pub(crate) history: Vec<HistoryRow>,
    pub(crate) loads: Vec<LoadRow>,
    pub(crate) measures: Vec<MeasureRow>,
    pub(crate) events: Vec<EventRow>,
}

impl Tables {
    /// Reads the tables that the folder of a run has.
    pub(crate) fn read(folder: &Path) -> Result<Self, RunError> {
        Ok(Self {
            history: read_history(&folder.join(RunFolder::HISTORY))?,
            loads: rows(&folder.join(RunFolder::LOADS), read_loads)?,
            measures: rows(&folder.join(RunFolder::MEASURES), read_measures)?,
            events: rows(&folder.join(RunFolder::EVENTS), read_events)?,
        })
    }
}

/// The rows of a file that only some runs have.
fn rows<R>(file: &Path, read: fn(&Path) -> Result<Vec<R>, FileError>) -> Result<Vec<R>, RunError> {
    Ok(match file.is_file() {
        true => read(file)?,
        false => Vec::new(),
    })
}

/// The name of a run: that of its folder without `-run`.
fn name_of(folder: &Path) -> String {
    let whole = folder.canonicalize().unwrap_or_else(|_| folder.to_owned());
    let name = whole.file_name().unwrap_or_default().to_string_lossy();
    name.strip_suffix("-run").unwrap_or(&name).to_owned()
}

/// The trajectory of a complete run.
fn whole_trajectory(folder: &Path, summary: &Summary) -> Result<Trajectory, RunError> {
    let path = folder.join(RunFolder::TRAJECTORY);
    let trajectory = Trajectory::read(&path)?;
    check_whole(&path, "frame", trajectory.len() as u64, summary.frames)?;
    Ok(trajectory)
}

/// Whether a folder has the trajectory of a run.
fn is_whole(folder: &Path) -> bool {
    folder.join(RunFolder::TRAJECTORY).is_file()
}

/// The frames of a run.
#[derive(Debug)]
pub(crate) enum RunFrames {
    /// On the disk.
    Stored(StoredFrames),
    /// In memory, of a complete run of which only the trajectory is left.
    Whole(Box<Trajectory>),
}

impl MotionFrames for RunFrames {
    type Error = RunError;

    fn each(
        &self,
        show: &mut dyn FnMut(&MotionFrame<'_>) -> ControlFlow<()>,
    ) -> Result<(), RunError> {
        match self {
            Self::Stored(frames) => frames.each(show),
            Self::Whole(trajectory) => {
                let Ok(()) = trajectory.each(show);
                Ok(())
            }
        }
    }
}

impl StoredFrames {
    /// All frames in memory.
    fn trajectory(&self, sheet: &Sheet) -> Result<Trajectory, RunError> {
        let (mut trajectory, mut done) = (Trajectory::new(sheet), Ok(()));
        self.each(&mut |frame| {
            done = trajectory.push_with(frame.t, frame.x, &frame.data);
            match done {
                Ok(()) => ControlFlow::Continue(()),
                Err(_) => ControlFlow::Break(()),
            }
        })?;
        done.map_err(FileError::from)?;
        Ok(trajectory)
    }
}
