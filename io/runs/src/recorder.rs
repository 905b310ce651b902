//! Recordings of simulations whose steps a program takes.

use super::checkpoint::StepsBy;
use super::control::Control;
use super::folder::{Existing, FolderState, RunFolder, RunInputs, SceneHash, stored_scene};
use super::frames::FrameShape;
use super::intervention::note;
use super::plan::{AtStart, Plan, Rows};
use super::recording::Recording;
use super::row::row_of_start;
use super::steps::{ROUND_OFF, step_length};
use super::summary::{EndReason, Ending};
use super::writer::RunWriter;
use super::{RunError, finish, write_trajectory};
use isosheet_dynamics::{StepProgress, StepReport};
use isosheet_files::{FileError, write_atomically};
use isosheet_formats::{EventRow, FrameQuantity, Row};
use isosheet_mesh::Advice;
use isosheet_scenes::{FailedStep, Files, Key, LiveScene, Scene, SceneFile, UnderWay};
use std::io::Write;
use std::ops::ControlFlow;
use std::path::Path;
use std::sync::Arc;
use std::time::{Duration, Instant};
use thiserror::Error;

/// How a simulation is recorded.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct RecorderOptions {
    /// Frames per second of simulated time; without it the number of the scene.
    pub frames_per_second: Option<f64>,
    /// What becomes of a run that the folder holds.
    pub existing: ExistingRun,
}

/// What becomes of a run that the folder of a recording holds.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum ExistingRun {
    /// It stays, and the recording is refused.
    #[default]
    Keep,
    /// Its files are deleted, and no others.
    Delete,
}

/// What is noted of steps that the recording does not have.
const UNRECORDED: &str = "steps that were not recorded";

/// Why a recording ends.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum RecordingEnd {
    /// The program that takes the steps is done.
    Program,
    /// An error ended it.
    Error,
}

/// A step that failed, or that could not be recorded.
#[derive(Debug, Error)]
pub enum RecordedStepError {
    /// The step failed, see [`LiveScene::step_watched`].
    #[error(transparent)]
    Step(#[from] FailedStep),
    /// The step cannot be recorded. It has been taken unless this is [`RunError::NotRecordable`].
    #[error(transparent)]
    Run(#[from] RunError),
}

impl Advice for RecordedStepError {
    fn advice(&self) -> Option<&'static str> {
        match self {
            Self::Step(error) => error.advice(),
            Self::Run(error) => error.advice(),
        }
    }
}

/// Writes the folder of a run, see [`simulate`](super::simulate), of a simulation whose steps a program takes
/// and whose scene it may change in between. Without changes the files have the bits of
/// [`simulate`](super::simulate) up to the wall times.
///
/// The scene in the folder is the one at the beginning, with functions of time as they were driven and with
/// the time at which the recording ended. What else was changed is in
/// [`Summary::control`](super::Summary::control).
///
/// ```
/// use isosheet_runs::{Recorder, RecorderOptions, RecordingEnd};
/// use isosheet_scenes::{LiveScene, Mesh, Scene, SceneFile, SheetKey};
/// use std::ops::ControlFlow;
///
/// # fn main() -> Result<(), Box<dyn std::error::Error>> {
/// # let folder = tempfile::tempdir()?;
/// # let folder = folder.path().join("fall");
/// let mut scene = Scene::new(SheetKey::new(Mesh::Disk { radius: 0.1, rings: 2 }));
/// scene.forces.gravity = Some([0.0, 0.0, -9.81]);
/// let mut live = LiveScene::start(SceneFile::of(scene, &folder)?)?;
/// let mut recorder = Recorder::begin(&mut live, &folder, &RecorderOptions::default())?;
/// for _ in 0..6 {
///     recorder.step(&mut live, 1.0 / 60.0, &mut |_| ControlFlow::Continue(()))?;
/// }
/// let recording = recorder.finish(&live, RecordingEnd::Program)?;
/// assert_eq!(recording.trajectory.len(), 4);
/// # Ok(())
/// # }
/// ```
pub struct Recorder {
    folder: RunFolder,
    /// The scene that the recording began with, as the folder has it.
    begun: SceneFile,
    /// The scene of the simulation at the last step.
    scene: Scene,
    hash: SceneHash,
    shape: FrameShape,
    writer: RunWriter,
    control: Control,
    /// When the last recorded step ended, seconds.
    reached: f64,
    /// What was taken up and released after it, which counts once there is another one.
    events: Vec<EventRow>,
    last: Option<LastStep>,
    /// What was wrong with the step after it, if that failed.
    failed: Option<String>,
    interval: Duration,
}

/// The last step that was recorded.
struct LastStep {
    report: StepReport,
    /// How the run ends with it by its scene.
    ending: Option<Ending>,
    frame: LastFrame,
}

/// Whether a step has a frame.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum LastFrame {
    None,
    /// As its number asks for.
    Regular,
    /// As the last one of the run alone.
    OfEnd,
}

impl Recorder {
    /// Begins to record a simulation in a folder, with a frame of its present state.
    ///
    /// # Errors
    /// [`RunError::Taken`] if the folder holds a run that is to be kept, and the errors of
    /// [`simulate`](super::simulate).
    pub fn begin(
        live: &mut LiveScene,
        folder: &Path,
        options: &RecorderOptions,
    ) -> Result<Self, RunError> {
        let clock = Instant::now();
        if folder.as_os_str().is_empty() {
            return Err(RunError::NoFolder);
        }
        let existing = match options.existing {
            ExistingRun::Keep if RunFolder::holds_run(folder) => {
                return Err(RunError::Taken {
                    folder: folder.to_owned(),
                });
            }
            ExistingRun::Keep => Existing::Continue,
            ExistingRun::Delete => Existing::Delete,
        };
        let scene = live.file().scene().clone();
        let file = match options.frames_per_second {
            Some(rate) => {
                let mut scene = scene.clone();
                scene.output.frames_per_second = rate;
                let key = Key::root().name("output.frames_per_second");
                live.file().changed(scene, [key])?
            }
            None => live.file().clone(),
        };
        let material = RunInputs::read(&file, live.files())?;
        let open = match RunFolder::open(folder, &material, existing)? {
            FolderState::Empty(open) => open,
            FolderState::Complete(_) | FolderState::Partial(_) => {
                return Err(RunError::Taken {
                    folder: folder.to_owned(),
                });
            }
        };
        let begun = stored_scene(open.root())?;
        let under_way = live.under_way();
        let start = row_of_start(&under_way.simulation).check_finite();
        start.map_err(FileError::from)?;
        let plan = Plan {
            file: &begun,
            hash: material.hash,
            start: AtStart::of(&begun.build()?),
            rows: Rows::InMemory,
            steps_by: StepsBy::Program,
        };
        let mut writer = RunWriter::begin(&plan, &open, under_way, None, clock)?;
        let shape = plan.start.shape;
        let reached = under_way.simulation.state().t;
        if reached > 0.0 {
            note(&mut writer.progress.control, UNRECORDED, reached, false);
            writer.save(&under_way.simulation.checkpoint())?;
        }
        let interval = begun.scene().output.checkpoint_interval;
        Ok(Self {
            hash: material.hash,
            folder: open,
            begun,
            scene,
            shape,
            writer,
            control: Control::default(),
            reached,
            events: Vec::new(),
            last: None,
            failed: None,
            interval: Duration::try_from_secs_f64(interval).unwrap_or(Duration::MAX),
        })
    }

    /// The folder.
    pub fn folder(&self) -> &Path {
        self.folder.root()
    }

    /// Advances the simulation by `h` seconds as [`LiveScene::step_watched`] does, and records it.
    ///
    /// # Errors
    /// [`RecordedStepError`].
    pub fn step(
        &mut self,
        live: &mut LiveScene,
        h: f64,
        watch: &mut dyn FnMut(&StepProgress) -> ControlFlow<()>,
    ) -> Result<StepReport, RecordedStepError> {
        self.note_changes(live, h)?;
        let mut recorded = Ok(());
        let stepped = live.step_observed(h, watch, &mut |under_way, report| {
            recorded = self.record(under_way, report);
        });
        self.failed = stepped.as_ref().err().and_then(FailedStep::in_short);
        let report = stepped?;
        recorded?;
        self.events = live.events().to_vec();
        if self.writer.clock.elapsed() >= self.interval {
            self.save(live)?;
        }
        Ok(report)
    }

    /// Notes what the program did since the last step, before another one of `h` seconds.
    fn note_changes(&mut self, live: &LiveScene, h: f64) -> Result<(), RunError> {
        let t = live.simulation().state().t;
        let progress = &mut self.writer.progress;
        if *live.file().scene() != self.scene {
            let simulation = live.simulation();
            let bends = simulation.plastic_curvatures().is_some();
            let columns = [
                (
                    "contact",
                    FrameQuantity::Gaps,
                    simulation.contacts().is_some(),
                ),
                (
                    "crease",
                    FrameQuantity::PlasticAngles,
                    simulation.plastic_angles().is_some(),
                ),
                ("sheet", FrameQuantity::PlasticCurvatures, bends),
                (
                    "crease",
                    FrameQuantity::CreaseBends,
                    simulation.bends_at_creases().is_some(),
                ),
            ];
            let mut columns = columns.into_iter();
            if let Some((key, ..)) = columns.find(|(_, of, has)| *has != self.shape.has(*of)) {
                return Err(RunError::NotRecordable { key: key.into() });
            }
            let after = live.file().scene();
            self.control
                .change(&self.scene, after, t, &mut progress.control)?;
            self.scene = after.clone();
        }
        if t != self.reached {
            note(&mut progress.control, UNRECORDED, t, false);
        }
        if live.hand().is_some() {
            note(&mut progress.control, "a hand", t, false);
        }
        let expected = step_length(self.begun.scene(), progress.steps + 1);
        if (h - expected).abs() > ROUND_OFF * expected {
            note(&mut progress.control, "method.step", t, false);
        }
        Ok(())
    }

    /// Records a step that has been taken.
    fn record(&mut self, under_way: &UnderWay, report: &StepReport) -> Result<(), RunError> {
        let writer = &mut self.writer;
        if matches!(&self.last, Some(last) if last.frame == LastFrame::OfEnd) {
            writer.take_back_frame()?;
        }
        writer.record_events(std::mem::take(&mut self.events))?;
        let scene = self.begun.scene();
        writer.record_step(scene, under_way, report)?;
        let reason = writer.end_reason(scene, under_way, report);
        let is_end = is_end(scene, report.t);
        let reason = reason.filter(|reason| *reason != EndReason::Time || is_end);
        let every = scene.output.steps_per_frame(scene.method.step);
        let frame = match writer.progress.steps.is_multiple_of(every) {
            true => LastFrame::Regular,
            false if reason.is_some() => LastFrame::OfEnd,
            false => LastFrame::None,
        };
        if frame != LastFrame::None {
            writer.record_frame(under_way)?;
        }
        self.reached = under_way.simulation.state().t;
        self.last = Some(LastStep {
            ending: reason.map(|reason| writer.ending(under_way, reason, report)),
            report: report.clone(),
            frame,
        });
        Ok(())
    }

    /// Writes a checkpoint, and the scene as it went.
    fn save(&mut self, live: &LiveScene) -> Result<(), RunError> {
        if !self.writer.progress.control.is_empty() {
            let stop = self.begun.scene().stop.time.max(self.reached);
            self.store_scene(stop)?;
        }
        self.writer.save(&live.simulation().checkpoint())
    }

    /// Writes the scene as it went, which stops at a time, seconds.
    fn store_scene(&mut self, stop: f64) -> Result<SceneFile, RunError> {
        let root = self.folder.root();
        if self.control.is_empty() && stop == self.begun.scene().stop.time {
            return Ok(self.begun.clone());
        }
        let rows = self.writer.tables.iter().flat_map(|tables| &tables.history);
        let times: Vec<f64> = rows.map(|row| row.t).collect();
        let store = |file: &SceneFile| -> Result<SceneFile, RunError> {
            let text = &file.text().text;
            write_atomically(&self.folder.path(RunFolder::SCENE), |w| {
                w.write_all(text.as_bytes())
            })?;
            stored_scene(root)
        };
        let went = self.control.scene(&self.begun, &times, stop);
        let went = match went.filter(|went| went.build().is_ok()) {
            Some(went) => store(&went)?,
            // A scene that begins with what the functions were driven to may be none that can start.
            None => {
                for done in &mut self.writer.progress.control {
                    done.in_scene = false;
                }
                store(&self.begun)?
            }
        };
        self.hash = RunInputs::read(&went, &mut Files::in_folder(root))?.hash;
        self.writer.progress.scene = self.hash.to_string();
        Ok(went)
    }

    /// Ends the recording and writes what a complete run has, the summary last; returns what was recorded.
    /// Without a step there is no run, and what it has is its start; where the first step failed, it is a run
    /// of the start alone.
    ///
    /// # Errors
    /// [`RunError`] if a file cannot be written.
    pub fn finish(mut self, live: &LiveScene, end: RecordingEnd) -> Result<Recording, RunError> {
        let root = self.folder.root().to_owned();
        let last = self.last.take();
        if last.is_none() && self.failed.is_none() {
            drop(self);
            return Recording::read(&root);
        }
        let has_frame = last
            .as_ref()
            .is_none_or(|last| last.frame != LastFrame::None);
        let under_way = live.under_way();
        let t = live.simulation().state().t;
        if t != self.reached {
            note(&mut self.writer.progress.control, UNRECORDED, t, false);
        } else if !has_frame {
            self.writer.record_frame(under_way)?;
        }
        let by_scene = last.as_ref().is_none_or(|last| last.ending.is_some());
        let end_of_scene = self.begun.scene().stop.time;
        let is_within = by_scene && self.reached < end_of_scene;
        let stop = match is_within || is_end(self.begun.scene(), self.reached) {
            true => end_of_scene,
            false => self.reached,
        };
        let file = self.store_scene(stop)?;
        let reason = match end {
            RecordingEnd::Program => EndReason::Program,
            RecordingEnd::Error => EndReason::Error,
        };
        let ended = match last {
            None => self.writer.ending_at_start(under_way, reason),
            Some(last) => {
                let of_program = || self.writer.ending(under_way, reason, &last.report);
                last.ending.unwrap_or_else(of_program)
            }
        };
        let failed = self.failed.take();
        self.writer.progress.ending = Some(Ending { failed, ..ended });
        if self.writer.progress.control.is_empty() {
            self.writer.progress.steps_by = StepsBy::Scene;
        }
        self.writer.save(&live.simulation().checkpoint())?;
        let setup = file.build()?;
        let plan = Plan {
            file: &file,
            hash: self.hash,
            start: AtStart {
                shape: self.shape,
                ..AtStart::of(&setup)
            },
            rows: Rows::InMemory,
            steps_by: StepsBy::Program,
        };
        if file.scene().output.trajectory {
            write_trajectory(&self.folder, &plan, 0)?;
        }
        let RunWriter {
            progress, tables, ..
        } = self.writer;
        let built = (plan.start.clone(), Arc::new(setup.model));
        let recorded = Recording::of(&root, file.clone(), built, tables.unwrap_or_default());
        let ended = finish(&plan, &self.folder, &progress, Some(recorded))?;
        match ended.recorded {
            Some((mut recording, frames)) => {
                recording.load(frames, &root)?;
                Ok(recording)
            }
            None => Recording::read(&root),
        }
    }
}

/// Whether the time of a scene has passed at a time, seconds, and no more.
fn is_end(scene: &Scene, t: f64) -> bool {
    (t - scene.stop.time).abs() <= ROUND_OFF * scene.method.step
}
