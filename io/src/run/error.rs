//! Why a run cannot go on.

use crate::format::{DataError, ExportError, HistoryError, JsonError, TrajectoryError, WriteError};
use crate::scene::{SceneError, SceneFileError};
use isosheet_mesh::Advice;
use std::io;
use std::path::PathBuf;
use thiserror::Error;

/// Why a run cannot start or go on.
#[derive(Debug, Error)]
#[non_exhaustive]
pub enum RunError {
    /// The scene cannot be simulated.
    #[error(transparent)]
    Scene(#[from] SceneError),
    /// A step failed. What was recorded up to the last checkpoint stays.
    #[error("{0}")]
    Step(SceneError),
    /// A scene file cannot be used.
    #[error(transparent)]
    SceneFile(#[from] SceneFileError),
    /// The folder holds the run of another scene.
    #[error(
        "{} holds a run of another scene (see {})", folder.display(),
        folder.join("scene.toml").display()
    )]
    OtherScene {
        /// The folder.
        folder: PathBuf,
    },
    /// The path of the folder is empty.
    #[error("the path of the folder is empty")]
    NoFolder,
    /// The folder holds other files.
    #[error(
        "{} holds files and is not the folder of a run",
        folder.display()
    )]
    Foreign {
        /// The folder.
        folder: PathBuf,
    },
    /// A link, a pipe or a folder has the name of a file of the run, or a link that of a folder.
    #[error(
        "{} is a link, or no file or folder such as a run has", path.display()
    )]
    NotOwn {
        /// The file or folder.
        path: PathBuf,
    },
    /// Another process works in the folder.
    #[error(
        "another process is writing to {}", folder.display()
    )]
    Busy {
        /// The folder.
        folder: PathBuf,
    },
    /// The folder cannot be made or written to.
    #[error(
        "cannot write to the folder {}: {source}", folder.display()
    )]
    Unwritable {
        /// The folder.
        folder: PathBuf,
        /// What the system said.
        source: io::Error,
    },
    /// There is no run in the folder.
    #[error(
        "{} is not the folder of a run: it has no scene.toml",
        folder.display()
    )]
    NoRun {
        /// The folder.
        folder: PathBuf,
    },
    /// A file of the run cannot be read or is damaged.
    #[error("{}: {problem}", path.display())]
    Damaged {
        /// The file.
        path: PathBuf,
        /// What is wrong.
        problem: String,
    },
    /// A frame of the run is damaged.
    #[error("{}: frame {frame} is damaged, its checksum is wrong", path.display())]
    DamagedFrame {
        /// The file.
        path: PathBuf,
        /// The number of the frame, from 0.
        frame: u64,
    },
    /// The file with the frames of the run is gone.
    #[error("{} is missing, which has the frames of the run", path.display())]
    NoFrames {
        /// The file.
        path: PathBuf,
    },
    /// The run was begun by another version of the program, which does not compute the same bits.
    #[error(
        "the run in {} was begun by version {begun} of the program, this is {}", folder.display(), env!("CARGO_PKG_VERSION")
    )]
    OtherVersion {
        /// The folder.
        folder: PathBuf,
        /// The version that began the run.
        begun: String,
    },
    /// A file of the run cannot be read.
    #[error("cannot read {}: {source}", path.display())]
    Read {
        /// The file.
        path: PathBuf,
        /// What the system said.
        source: io::Error,
    },
    /// A file cannot be written.
    #[error(transparent)]
    Write(#[from] WriteError),
    /// The history cannot be written.
    #[error(transparent)]
    History(#[from] HistoryError),
    /// The frames cannot be written or read.
    #[error(transparent)]
    Trajectory(#[from] TrajectoryError),
    /// The summary cannot be written or read.
    #[error(transparent)]
    Json(#[from] JsonError),
    /// The run cannot be shown as a page.
    #[error("no page of the run can be made: {0}")]
    Page(#[from] DataError),
    /// An OBJ file cannot be written.
    #[error(transparent)]
    Obj(#[from] ExportError),
}

impl Advice for RunError {
    fn advice(&self) -> Option<&'static str> {
        match self {
            Self::Scene(error) => error.advice(),
            Self::Step(error) => error.advice(),
            Self::SceneFile(error) => error.advice(),
            Self::OtherScene { .. } => {
                Some("replace it with --force, or choose another folder with --out")
            }
            Self::NoFolder => Some("name a folder; `.` is the current one"),
            Self::Foreign { .. } => Some("choose an empty or a new folder with --out"),
            Self::NotOwn { .. } => Some(
                "a run writes to no other files than its own: remove it, or choose another folder with --out",
            ),
            Self::Busy { .. } => Some("wait for it or choose another folder with --out"),
            Self::Unwritable { .. } => Some(
                "check the permissions and the free space, or choose another folder with --out",
            ),
            Self::NoRun { .. } => Some("name the folder that `isosheet simulate` wrote"),
            Self::Damaged { .. } | Self::NoFrames { .. } => {
                Some("run the scene again with --force, which replaces the run")
            }
            Self::DamagedFrame { .. } => Some(
                "give the `simulate` command again, which takes up a run that is not complete at its last \
                 checkpoint; if it names the same frame, run the scene again with --force",
            ),
            Self::OtherVersion { .. } => Some(
                "continue it with that version, replace it with --force, or choose another folder with --out",
            ),
            Self::Read { .. } => Some("check the path"),
            Self::Write(error) => error.advice(),
            Self::History(error) => error.advice(),
            Self::Trajectory(error) => error.advice(),
            Self::Json(error) => error.advice(),
            Self::Page(error) => error.advice(),
            Self::Obj(error) => error.advice(),
        }
    }
}
