//! Runs of scenes that survive being killed.
//!
//! [`simulate`] runs a scene in a folder:
//!
//! | file | what |
//! |---|---|
//! | `scene.toml` | the scene as it is run, edits included; mesh files are copied to `meshes/` |
//! | `history.csv` | one row for each step ([`HistoryRow`](isosheet_formats::HistoryRow)) |
//! | `loads.csv` | the loads of each support and obstacle at each step ([`LoadRow`](isosheet_formats::LoadRow)), if there are any |
//! | `measures.csv` | what each measure of the scene shows at the start and at each step ([`MeasureRow`](isosheet_formats::MeasureRow)), if there are any |
//! | `events.csv` | what was taken up and released ([`EventRow`](isosheet_formats::EventRow)), if anything can be |
//! | `trajectory.npz` | the frames ([`Trajectory`]), when the run ends, fails or is stopped |
//! | `obj/` | the frames as OBJ files, at the end, if the scene asks for them |
//! | `index.html` | the 3D page of the run ([`view`](isosheet_page)), unless the scene says `page = false` |
//! | `summary.json` | what came of it ([`Summary`]), last: a folder that has it is complete |
//! | `frames.bin` | the frames with checksums, from which a lost trajectory is written again |
//! | `checkpoint.bin` | what is needed to go on |
//! | `run.lock` | locked while a process works in the folder |
//!
//! A folder with a complete run of the same scene is left as it is. One with a part of it is continued, and
//! gives the same bits as a run without a stop. A folder with another scene, with other files, or in use by
//! another process is refused; [`simulate_anew`] deletes the run of another scene. When the process is
//! killed, at most the steps since the last checkpoint are lost
//! ([`Output::checkpoint_interval`](isosheet_scenes::Output::checkpoint_interval)).
//!
//! A [`Recorder`] writes the same folder of a simulation whose steps a program takes.
//!
//! A [`Sweep`] makes many runs of one scene, and [`Collection`] makes one table of their summaries.

mod balance;
mod checkpoint;
mod collect;
mod coloured;
mod commit;
mod constraints;
mod control;
mod elastic;
mod ending;
mod energy;
mod error;
mod estimate;
mod extend;
mod extension_error;
mod fit;
mod flat_vertex;
mod fold_order;
mod fold_verdict;
mod folder;
mod frame_field;
mod frames;
mod ground;
mod held_open;
mod incidence;
mod intervention;
mod kept;
mod last_change;
mod layer_drawing;
mod layers;
mod layers_error;
mod overlap;
mod page;
mod passing;
mod plan;
mod recorder;
mod recording;
mod replay;
mod round_off;
mod row;
mod rulings;
mod scene_family;
mod series_body;
mod spool;
mod stepping;
mod steps;
mod summary;
mod sweep;
mod time_error;
mod trial;
mod vibration;
mod warning;
mod watch;
mod writer;

pub use balance::ForceBalance;
pub use collect::Collection;
pub use commit::note_commit;
pub use constraints::HoldingBody;
pub use elastic::{Bend, BendAtRest, ElasticSummary};
pub use energy::EnergySummary;
pub use error::RunError;
pub use estimate::Estimate;
pub use extend::extend_folder;
pub use extension_error::ExtensionError;
pub use fit::{
    Fit, FitError, FitProgress, FitRange, FitRuns, FitTarget, Fitted, FittedValue, ReachedTarget,
};
pub use flat_vertex::UnfoldableVertex;
pub use fold_order::{FoldOrder, GroupFold};
pub use fold_verdict::{FoldVerdict, FoldedCrease};
pub use folder::{
    Existing, SceneHash, check_folder, check_run, holds_other_files, holds_run, remove_unfinished,
    run_of_file,
};
pub use frame_field::FrameField;
pub use held_open::TouchingFaces;
pub use incidence::Incidence;
pub use intervention::Intervention;
pub use kept::{KeptAngles, KeptBend, KeptFold};
pub use layers::Layers;
pub use layers_error::LayersError;
pub use page::write_page;
pub use recorder::{ExistingRun, RecordedStepError, Recorder, RecorderOptions, RecordingEnd};
pub use recording::Recording;
pub use replay::{measure_series, replay_of};
pub use row::row_of_step;
pub use rulings::RecordedRulings;
pub use scene_family::{SceneFamily, SceneFamilyError};
pub use series_body::series_body;
pub use summary::{EndReason, Ending, Measured, SheetPlace, Summary};
pub use sweep::{RefusedRuns, Sweep, SweepError, SweepRun, SweepRunner, Variation};
pub use time_error::TimeError;
pub use trial::{FoldTrial, folds_to};
pub use vibration::Vibration;
pub use watch::{Beginning, StepPart, Tick, TraceSink, Watch};

use checkpoint::{RunProgress, StepsBy};
use folder::{FolderState, RunFolder, RunInputs, stored_scene};
use frames::StoredFrames;
use isosheet_files::{FileError, read_json, write_json};
use isosheet_formats::{MotionFrames, Row, Trajectory, WriteMotionError, frame_path, write_obj};
use isosheet_page::PageOptions;
use isosheet_scenes::{Kept, SceneFile, Setup, UnderWay};
use page::write_page_of;
use plan::{AtStart, Plan, Rows};
use recording::RunFrames;
pub use row::row_of_start;
use rulings::RuledFrames;
use std::io::ErrorKind;
use std::ops::ControlFlow;
use std::path::Path;
use std::sync::Arc;
use std::time::{Duration, Instant};
use stepping::Stepping;
use steps::step_count;
use writer::RunWriter;

/// How a call of [`simulate`] ended.
#[derive(Clone, Debug, PartialEq)]
pub enum Outcome {
    /// The run was complete already.
    AlreadyComplete(Box<Summary>),
    /// The run is complete now.
    Complete(Box<Summary>),
    /// The watcher asked for a stop. A checkpoint was written; the same call continues.
    Interrupted,
}

/// Runs a scene in a folder, from the last checkpoint if there is one.
///
/// ```
/// use isosheet_runs::{Outcome, simulate};
/// use isosheet_scenes::{Mesh, Scene, SceneFile, SheetKey};
/// use std::ops::ControlFlow;
///
/// # fn main() -> Result<(), Box<dyn std::error::Error>> {
/// # let folder = tempfile::tempdir()?;
/// # let folder = folder.path().join("fall");
/// let mut scene = Scene::new(SheetKey::new(Mesh::Disk { radius: 0.1, rings: 2 }));
/// scene.forces.gravity = Some([0.0, 0.0, -9.81]);
/// let file = SceneFile::of(scene, &folder)?;
/// let outcome = simulate(&file, &folder, &mut |_: &_| ControlFlow::Continue(()))?;
/// assert!(matches!(outcome, Outcome::Complete(summary) if summary.steps == 60));
/// # Ok(())
/// # }
/// ```
///
/// # Errors
/// [`RunError`]; whatever was recorded up to the last checkpoint stays.
pub fn simulate(
    file: &SceneFile,
    folder: &Path,
    watch: &mut dyn Watch,
) -> Result<Outcome, RunError> {
    let ended = simulate_in(file, folder, Existing::Continue, Wanted::Files, watch)?;
    Ok(ended.outcome)
}

/// Runs a scene in a folder as [`simulate`] does, and returns what the run recorded: nothing of one that was
/// interrupted.
///
/// # Errors
/// As [`simulate`].
pub fn simulate_recorded(
    file: &SceneFile,
    folder: &Path,
    watch: &mut dyn Watch,
) -> Result<Option<Recording>, RunError> {
    let wanted = Wanted::Recording;
    let ended = simulate_in(file, folder, Existing::Continue, wanted, watch)?;
    match (ended.outcome, ended.recorded) {
        (Outcome::Interrupted, _) => Ok(None),
        (_, Some((mut recording, frames))) => {
            recording.load(frames, folder)?;
            Ok(Some(recording))
        }
        (_, None) => Recording::read(folder).map(Some),
    }
}

/// Runs a scene in a folder from the start. A run that the folder holds, of whatever scene, is deleted
/// before: the files that [`simulate`] writes, and no others.
///
/// # Errors
/// As [`simulate`]. A folder that is not that of a run, or in which another process works, is refused, and
/// nothing is deleted there.
pub fn simulate_anew(
    file: &SceneFile,
    folder: &Path,
    watch: &mut dyn Watch,
) -> Result<Outcome, RunError> {
    let ended = simulate_in(file, folder, Existing::Delete, Wanted::Files, watch)?;
    Ok(ended.outcome)
}

/// What is wanted of a run.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Wanted {
    /// Its files.
    Files,
    /// What it recorded, too.
    Recording,
}

/// How a run ended, and what it recorded, where that is wanted or its page is made of it.
struct Ended {
    outcome: Outcome,
    recorded: Option<(Recording, RunFrames)>,
}

impl From<Outcome> for Ended {
    fn from(outcome: Outcome) -> Self {
        Self {
            outcome,
            recorded: None,
        }
    }
}

/// How far a run has begun whose folder is not known yet.
enum Begun {
    /// Its scene is built.
    Built(Box<Setup>),
    /// It can start.
    Started(Box<UnderWay>),
}

fn simulate_in(
    file: &SceneFile,
    folder: &Path,
    existing: Existing,
    wanted: Wanted,
    watch: &mut dyn Watch,
) -> Result<Ended, RunError> {
    let clock = Instant::now();
    if folder.as_os_str().is_empty() {
        return Err(RunError::NoFolder);
    }
    let mut kept = Kept::in_folder(file.folder());
    let material = RunInputs::read(file, &mut kept.files)?;
    let hash = material.hash;
    if existing == Existing::Continue && RunFolder::is_complete(folder, &material)? {
        let summary = complete_summary(folder, hash)?;
        return Ok(Outcome::AlreadyComplete(Box::new(summary)).into());
    }
    let setup = file.build_with(&mut kept)?;
    let estimate = Estimate::of(file.scene(), &setup);
    let mut warnings = [setup.warnings(), estimate.warnings(folder)].concat();
    let plan = Plan {
        file,
        hash,
        start: AtStart::of(&setup),
        rows: match file.scene().output.page || wanted == Wanted::Recording {
            true => Rows::InMemory,
            false => Rows::InFiles,
        },
        steps_by: StepsBy::Scene,
    };
    let facts = &plan.start.facts;
    // A scene that cannot start leaves the folder as it was.
    let continued = existing == Existing::Continue && RunFolder::has_checkpoint(folder);
    let begun = match continued {
        true => Begun::Built(Box::new(setup)),
        false => {
            estimate.check(file, folder)?;
            Begun::Started(Box::new(started(file, setup)?))
        }
    };
    let (open, saved) = match RunFolder::open(folder, &material, existing)? {
        FolderState::Complete(open) => {
            let summary = complete_summary(folder, hash)?;
            let lost = !open.path(RunFolder::TRAJECTORY).is_file();
            if file.scene().output.trajectory && lost {
                write_trajectory(&open, &plan, summary.frames)?;
            }
            return Ok(Outcome::AlreadyComplete(Box::new(summary)).into());
        }
        FolderState::Empty(open) => (open, None),
        FolderState::Partial(open) => {
            let saved = checkpoint::read(&open.path(RunFolder::CHECKPOINT))?;
            check_origin(&open, &saved.0, &hash.to_string())?;
            warnings.extend(commit::other_build(
                saved.0.commit.as_deref(),
                commit::noted().as_deref(),
            ));
            (open, Some(saved))
        }
    };
    let (under_way, saved) = match (saved, begun) {
        (Some((progress, checkpoint)), begun) => {
            let setup = match begun {
                Begun::Built(setup) if setup.is_at(&checkpoint) => *setup,
                _ => file.build_at_with(&mut kept, &checkpoint)?,
            };
            let resume = |setup: Setup| setup.resume(checkpoint);
            let under_way = UnderWay::begin(file.scene(), setup, resume)?;
            (under_way, Some(progress))
        }
        (None, Begun::Started(under_way)) => (*under_way, None),
        (None, Begun::Built(setup)) => (started(file, *setup)?, None),
    };
    let mut stepping = Stepping::begin(&plan, &open, &mut kept, under_way, saved, clock)?;
    watch.begin(&Beginning {
        steps: stepping.writer.progress.steps,
        of: step_count(file.scene()),
        modelled: facts.modelled.clone(),
        vertices: facts.sheet.topology().vertex_count(),
        warnings,
    });
    if let Some(sink) = watch.trace() {
        stepping.under_way.simulation.set_trace(sink);
    }
    let interval = file.scene().output.checkpoint_interval;
    let advanced = advance(&mut stepping, interval, watch);
    if file.scene().output.trajectory {
        let written = write_trajectory(&open, &plan, 0);
        // The failure of the run is what has to be said.
        advanced.and(written)?;
    } else {
        advanced?;
    }
    let Stepping {
        writer, under_way, ..
    } = stepping;
    let RunWriter {
        progress, tables, ..
    } = writer;
    let recorded = match (progress.ending.is_some(), tables) {
        (true, Some(tables)) => {
            let model = Arc::clone(under_way.simulation.model());
            let built = (plan.start.clone(), model);
            Some(Recording::of(folder, material.stored, built, tables))
        }
        _ => None,
    };
    finish(&plan, &open, &progress, recorded)
}

/// Takes steps until the run ends or the watcher asks for a stop.
fn advance(
    stepping: &mut Stepping<'_>,
    interval: f64,
    watch: &mut dyn Watch,
) -> Result<(), RunError> {
    // More seconds than a duration can hold are as good as never.
    let interval = Duration::try_from_secs_f64(interval).unwrap_or(Duration::MAX);
    while stepping.writer.progress.ending.is_none() {
        let Some(tick) = stepping.step(watch)? else {
            break;
        };
        let go_on = watch.step(&tick);
        let due = stepping.writer.clock.elapsed() >= interval;
        if due || go_on.is_break() || stepping.writer.progress.ending.is_some() {
            stepping.save()?;
        }
        if go_on.is_break() {
            break;
        }
    }
    Ok(())
}

/// Writes the frames of a run as a trajectory; as many as its summary says at `least`, if it is complete.
fn write_trajectory(folder: &RunFolder, plan: &Plan<'_>, least: u64) -> Result<(), RunError> {
    let trajectory = Trajectory::new(&plan.start.facts.sheet);
    let path = folder.path(RunFolder::TRAJECTORY);
    let frames = StoredFrames {
        least,
        ..stored_frames(folder, plan)
    };
    let scene = plan.file.scene();
    let ruled = match scene.output.curvature {
        true => RuledFrames::new(&frames, &plan.start.facts, scene.sheet.len()),
        false => None,
    };
    let written = match ruled {
        Some(ruled) => trajectory.write_motion(&path, &ruled),
        None => trajectory.write_motion(&path, &frames),
    };
    written.map_err(|error| match error {
        WriteMotionError::Frame(error) => error,
        WriteMotionError::Trajectory(error) => error.into(),
    })
}

fn stored_frames(folder: &RunFolder, plan: &Plan<'_>) -> StoredFrames {
    StoredFrames {
        path: folder.path(RunFolder::FRAMES),
        shape: plan.start.shape,
        least: 0,
    }
}

/// Continues the run in a folder, with the scene that is stored there.
///
/// # Errors
/// As [`simulate`]; [`RunError::NoRun`] if the folder is not that of a run.
pub fn resume_folder(folder: &Path, watch: &mut dyn Watch) -> Result<Outcome, RunError> {
    simulate(&stored_scene(folder)?, folder, watch)
}

/// The summary of a complete run.
fn complete_summary(folder: &Path, hash: SceneHash) -> Result<Summary, RunError> {
    let summary: Summary = read_json(&folder.join(RunFolder::SUMMARY))?;
    if summary.scene != hash.to_string() {
        return Err(RunError::OtherScene {
            folder: folder.to_owned(),
        });
    }
    Ok(summary)
}

/// The simulation at the start, whose energies can be written.
fn started(file: &SceneFile, setup: Setup) -> Result<UnderWay, RunError> {
    let started = UnderWay::begin(file.scene(), setup, Setup::start)?;
    let start = row_of_start(&started.simulation).check_finite();
    start.map_err(FileError::from)?;
    Ok(started)
}

/// Refuses a checkpoint of another scene, where the one in the folder was changed since, or of another
/// version.
fn check_origin(folder: &RunFolder, progress: &RunProgress, hash: &str) -> Result<(), RunError> {
    let root = folder.root().to_owned();
    if progress.scene != hash {
        return Err(RunError::OtherScene { folder: root });
    }
    if progress.steps_by == StepsBy::Program {
        return Err(RunError::Recorded { folder: root });
    }
    if progress.version != env!("CARGO_PKG_VERSION") {
        return Err(RunError::OtherVersion {
            folder: root,
            begun: progress.version.clone(),
        });
    }
    Ok(())
}

/// Writes the files that only a complete run has, the summary last. A run that has not ended was stopped.
fn finish(
    plan: &Plan<'_>,
    folder: &RunFolder,
    progress: &RunProgress,
    mut recorded: Option<(Recording, RunFrames)>,
) -> Result<Ended, RunError> {
    let Some(ending) = progress.ending.clone() else {
        return Ok(Outcome::Interrupted.into());
    };
    let clock = Instant::now();
    let facts = &plan.start.facts;
    let topology = facts.sheet.topology();
    let output = &plan.file.scene().output;
    if output.obj {
        write_obj_files(folder, plan)?;
    }
    let sheets = facts.parts.iter().enumerate();
    let sheets =
        sheets.map(|(k, part)| SheetPlace::new(part, progress.sheet_strains.get(k).copied()));
    let summary = Summary {
        program: "isosheet".into(),
        version: env!("CARGO_PKG_VERSION").into(),
        commit: commit::noted(),
        scene: plan.hash.to_string(),
        wall_time: progress.wall + clock.elapsed().as_secs_f64(),
        modelled: facts.modelled.clone(),
        sheets: sheets.collect(),
        vertices: topology.vertex_count(),
        faces: topology.face_count(),
        steps: progress.steps,
        frames: progress.frames,
        largest_strain: progress.strain,
        largest_displacement: progress.displacement,
        energy: progress.energy,
        balance: progress.balance.or(progress.end_balance),
        incidence: progress.incidence,
        time_error: progress.time_error,
        vibration: progress
            .vibrations
            .fastest(facts.mass, facts.sheet.mean_length()),
        thickness: plan.file.scene().largest_thickness(),
        smallest_gap: progress.gap,
        iterations: progress.iterations,
        factorisations: progress.factorisations,
        rejected: progress.rejected,
        elastic: progress.elastic,
        control: progress.control.clone(),
        measures: progress.measured.clone(),
        ending,
    };
    if let Some((recording, frames)) = &mut recorded {
        recording.summary = Some(summary.clone());
        if output.page {
            write_page_before(folder, recording, frames)?;
        }
    }
    write_json(&folder.path(RunFolder::SUMMARY), &summary)?;
    let outcome = Outcome::Complete(Box::new(summary));
    Ok(Ended { outcome, recorded })
}

/// Writes the frames as OBJ files.
fn write_obj_files(folder: &RunFolder, plan: &Plan<'_>) -> Result<(), RunError> {
    let obj = folder.path(RunFolder::OBJ);
    let (topology, mut done) = (plan.start.facts.sheet.topology(), Ok(()));
    stored_frames(folder, plan).each(&mut |frame| {
        done = write_obj(&frame_path(&obj, frame.number), topology, frame.x);
        match done {
            Ok(()) => ControlFlow::Continue(()),
            Err(_) => ControlFlow::Break(()),
        }
    })?;
    Ok(done?)
}

/// Writes the page of a run whose summary is not in the folder yet. A run that no page can show is complete
/// all the same: [`write_page`] says why there is none.
fn write_page_before(
    folder: &RunFolder,
    recording: &Recording,
    frames: &RunFrames,
) -> Result<(), RunError> {
    let path = folder.path(RunFolder::PAGE);
    match write_page_of(recording, frames, &path, &PageOptions::default()) {
        Err(RunError::Page(_)) => match std::fs::remove_file(&path) {
            Err(source) if source.kind() != ErrorKind::NotFound => Err(RunError::Unwritable {
                folder: folder.root().to_owned(),
                source,
            }),
            _ => Ok(()),
        },
        other => other.map(drop),
    }
}

/// The code of the README is compiled and run as a test.
#[cfg(doctest)]
#[doc = include_str!("../README.md")]
struct Readme;
