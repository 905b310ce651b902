//! Runs that go on beyond the end that their scene named.

use super::checkpoint::{self, RunProgress};
use super::extension_error::ExtensionError;
use super::folder::{Existing, FolderState, RunFolder, RunInputs, stored_scene};
use super::steps::{has_short_step, step_count};
use super::summary::EndReason;
use super::{Outcome, RunError, Watch, check_origin, simulate};
use isosheet_files::write_atomically;
use isosheet_scenes::{Files, SceneFile};
use std::fs;
use std::io::{ErrorKind, Write};
use std::path::Path;

/// Continues the run in a folder until time `until` (seconds), later than the `stop.time` of its scene, with
/// the same bits as a run of a scene with that `stop.time`; the scene in the folder is changed to it. The
/// same call continues a run that was stopped on that way.
///
/// # Errors
/// As [`simulate`]; [`RunError::NoRun`] if the folder is not that of a run, [`RunError::Extension`] if the
/// run cannot go on like that. Then nothing has changed.
pub fn extend_folder(
    folder: &Path,
    until: f64,
    watch: &mut dyn Watch,
) -> Result<Outcome, RunError> {
    let stored = stored_scene(folder)?;
    let refuse = |cause| RunError::Extension {
        folder: folder.to_owned(),
        until,
        cause,
    };
    if !until.is_finite() {
        return Err(refuse(ExtensionError::NotFinite));
    }
    let text = stored.text();
    let edit = format!("stop.time={until:?}");
    let longer = SceneFile::parse(text.text.clone(), &text.path, &[edit])?;
    let mut files = Files::in_folder(folder);
    let inputs = RunInputs::read(&stored, &mut files)?;
    let hash = RunInputs::read(&longer, &mut files)?.hash.to_string();
    let (open, is_complete) = match RunFolder::open(folder, &inputs, Existing::Continue)? {
        FolderState::Complete(open) => (open, true),
        FolderState::Partial(open) | FolderState::Empty(open) => (open, false),
    };
    if !is_complete && until == stored.scene().stop.time {
        drop(open);
        return simulate(&stored, folder, watch);
    }
    let checkpoint = open.path(RunFolder::CHECKPOINT);
    let saved = match checkpoint.is_file() {
        true => Some(checkpoint::read(&checkpoint)?),
        false => None,
    };
    let begun = inputs.hash.to_string();
    // A process that was killed here may have left the checkpoint of the longer run.
    let is_known = hash != begun && saved.as_ref().is_some_and(|(p, _)| p.scene == hash);
    if !is_known {
        may_go_on(&stored, saved.as_ref().map(|(progress, _)| progress), until).map_err(refuse)?;
    }
    // What the longer run needs, before anything of the run changes.
    let needed = match (is_complete, &saved) {
        (false, None) => &[][..],
        _ => &[RunFolder::CHECKPOINT, RunFolder::FRAMES],
    };
    if let Some(&file) = needed.iter().find(|file| !open.path(file).is_file()) {
        return Err(refuse(ExtensionError::Deleted { file }));
    }
    longer.build()?;
    if let Some((mut progress, simulation)) = saved {
        let expected = match is_known {
            true => &hash,
            false => &begun,
        };
        check_origin(&open, &progress, expected)?;
        reopen(&mut progress, &stored);
        progress.scene = hash;
        let summary = open.path(RunFolder::SUMMARY);
        match fs::remove_file(&summary) {
            Err(error) if error.kind() != ErrorKind::NotFound => {
                return Err(RunError::Unwritable {
                    folder: folder.to_owned(),
                    source: error,
                });
            }
            _ => {}
        }
        checkpoint::write(&checkpoint, &progress, &simulation)?;
    }
    let scene = open.path(RunFolder::SCENE);
    write_atomically(&scene, |w| w.write_all(longer.text().text.as_bytes()))?;
    drop(open);
    simulate(&longer, folder, watch)
}

/// Whether a run of a scene can go on until a later time.
fn may_go_on(
    file: &SceneFile,
    progress: Option<&RunProgress>,
    until: f64,
) -> Result<(), ExtensionError> {
    let scene = file.scene();
    let time = scene.stop.time;
    if until <= time {
        return Err(ExtensionError::Earlier { time });
    }
    match progress.and_then(|progress| progress.ending.as_ref()) {
        Some(ending) if ending.reason != EndReason::Time => Err(ExtensionError::Ended {
            reason: ending.reason,
        }),
        Some(_) if has_short_step(scene) => Err(ExtensionError::ShortStep { time }),
        _ => Ok(()),
    }
}

/// Takes back what belongs to the end of a run alone: the ending, and a frame beside the regular ones.
fn reopen(progress: &mut RunProgress, file: &SceneFile) {
    let scene = file.scene();
    let regular = scene.output.steps_per_frame(scene.method.step);
    let is_last = progress.ending.take().is_some() && progress.steps == step_count(scene);
    if is_last && !progress.steps.is_multiple_of(regular) {
        progress.frames -= 1;
    }
}
