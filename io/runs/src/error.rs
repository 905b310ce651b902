//! Why a run cannot go on.

use super::extension_error::ExtensionError;
use isosheet_files::{DataError, FileError};
use isosheet_formats::ExportError;
use isosheet_mesh::Advice;
use isosheet_mesh::wording::given;
use isosheet_scenes::{SceneError, SceneFileError};
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
    /// The run cannot go on until a later time.
    #[error("the run in {} cannot go on until {} s: {cause}", folder.display(), given(*until))]
    Extension {
        /// The folder.
        folder: PathBuf,
        /// The time, seconds.
        until: f64,
        /// Why.
        cause: ExtensionError,
    },
    /// The folder holds a run, which a recording would replace.
    #[error("{} holds a run", folder.display())]
    Taken {
        /// The folder.
        folder: PathBuf,
    },
    /// The scene reads a file or a folder of the run that is to be deleted.
    #[error(
        "the scene reads {}, which is in the folder of the run that would be deleted, {}",
        path.display(), folder.display()
    )]
    ReadByScene {
        /// The folder.
        folder: PathBuf,
        /// What the scene reads.
        path: PathBuf,
    },
    /// A program took the steps of the run, which its scene alone does not continue.
    #[error(
        "the run in {} was recorded by a program, which took its steps and may change the scene between them: the scene \
         alone does not continue it",
        folder.display()
    )]
    Recorded {
        /// The folder.
        folder: PathBuf,
    },
    /// The scene of a simulation was changed so that its recording cannot go on.
    #[error("`{key}` was changed so that the files of the recording would have other columns")]
    NotRecordable {
        /// The key of the scene.
        key: String,
    },
    /// A file of the run cannot be read or written, or is damaged.
    #[error(transparent)]
    File(#[from] FileError),
    /// The run cannot be shown as a page.
    #[error("no page of the run can be made: {0}")]
    Page(#[from] DataError),
    /// An OBJ file cannot be written.
    #[error(transparent)]
    Obj(#[from] ExportError),
}

/// What to do about a damaged file of a run.
pub(super) const BEGIN_ANEW: &str = "run the scene again with --force, which replaces the run";

impl Advice for RunError {
    fn advice(&self) -> Option<&'static str> {
        match self {
            Self::Scene(error) => error.advice(),
            Self::Step(error) => error.advice(),
            Self::SceneFile(error) => error.advice(),
            Self::OtherScene { .. } => Some(
                "continue that run by `isosheet resume DIR`, run the scene with --force, which replaces it, or choose another folder for the run",
            ),
            Self::NoFolder => Some("name a folder; `.` is the current one"),
            Self::Foreign { .. } => Some("choose an empty or a new folder for the run"),
            Self::NotOwn { .. } => Some(
                "a run writes to no other files than its own: remove it, or choose another folder for the run",
            ),
            Self::Busy { .. } => Some("wait for it or choose another folder for the run"),
            Self::Unwritable { .. } => Some(
                "check the permissions and the free space, or choose another folder for the run",
            ),
            Self::NoRun { .. } => Some("name the folder that `isosheet simulate` wrote"),
            Self::OtherVersion { .. } => Some(
                "continue it with that version, run the scene with --force, which replaces it, or choose another folder for the run",
            ),
            Self::Taken { .. } => {
                Some("choose another folder, or have the run replaced: `replace=True` in Python")
            }
            Self::ReadByScene { .. } => Some("choose another folder for the run (`--out`)"),
            Self::Recorded { .. } => Some(
                "have that program make it again, with `replace=True` in Python, or run the scene of the folder from its start in another folder; `isosheet page` and `isosheet convert` show what was recorded",
            ),
            Self::NotRecordable { .. } => Some(
                "have it in the scene from the start, with no effect at first; or end the recording and begin another",
            ),
            Self::Extension { cause, .. } => cause.advice(),
            Self::File(error) => error.advice(),
            Self::Page(error) => error.advice(),
            Self::Obj(error) => error.advice(),
        }
    }
}
