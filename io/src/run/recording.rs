//! What a run recorded, complete or not.

use super::RunError;
use super::folder::RunFolder;
use super::frames::{Frame, read_frames};
use crate::format::{HistoryRow, Trajectory, read_history};
use crate::scene::SceneFile;
use isosheet_collide::Obstacle;
use isosheet_mesh::Sheet;
use nalgebra::Isometry3;
use std::path::Path;

/// What a run recorded: everything that a page or a film of it needs.
#[derive(Debug)]
pub struct Recording {
    /// The scene as it was run.
    pub scene: SceneFile,
    /// The sheet in its rest shape, placed in space.
    pub sheet: Sheet,
    /// The bodies, in the order of the scene.
    pub obstacles: Vec<Obstacle>,
    /// The frames with the mesh.
    pub trajectory: Trajectory,
    /// One row for each step, that of the start first.
    pub history: Vec<HistoryRow>,
}

impl Recording {
    /// Reads the folder of a run. That of a run that goes on, or that was interrupted, has the frames up to
    /// now.
    ///
    /// # Errors
    /// [`RunError::NoRun`] if the folder is not that of a run, [`RunError`] if a file cannot be read.
    pub fn read(folder: &Path) -> Result<Self, RunError> {
        let scene = open_scene(folder)?;
        let setup = scene.build()?;
        let complete = folder.join(RunFolder::TRAJECTORY);
        let trajectory = if complete.is_file() {
            Trajectory::read(&complete)?
        } else {
            let path = folder.join(RunFolder::FRAMES);
            let frames = read_frames(&path, setup.start.x.len());
            let frames = frames.map_err(|source| RunError::Read { path, source })?;
            trajectory_of(&setup.sheet, &frames)?
        };
        Ok(Self {
            sheet: setup.sheet,
            obstacles: setup.obstacles,
            trajectory,
            history: read_history(&folder.join(RunFolder::HISTORY))?,
            scene,
        })
    }

    /// The pose of each body at time `t` (seconds), in the order of the scene.
    pub fn poses(&self, t: f64) -> Vec<Isometry3<f64>> {
        let bodies = self.obstacles.iter();
        bodies.map(|body| body.motion().pose(t)).collect()
    }
}

/// The scene of a folder.
pub(crate) fn open_scene(folder: &Path) -> Result<SceneFile, RunError> {
    let path = folder.join(RunFolder::SCENE);
    if !path.is_file() {
        return Err(RunError::NoRun {
            folder: folder.to_owned(),
        });
    }
    Ok(SceneFile::read(&path, &[])?)
}

/// The trajectory of some frames.
pub(crate) fn trajectory_of(sheet: &Sheet, frames: &[Frame]) -> Result<Trajectory, RunError> {
    let mut trajectory = Trajectory::new(sheet);
    for frame in frames {
        trajectory.push(frame.t, &frame.x)?;
    }
    Ok(trajectory)
}
