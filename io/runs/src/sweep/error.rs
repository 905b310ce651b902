//! Why a sweep cannot be made, run or collected.

use super::run::SweepRun;
use isosheet_files::{DataError, FileError};
use isosheet_mesh::Advice;
use isosheet_scenes::SceneFileError;
use std::path::PathBuf;
use thiserror::Error;

/// Why a sweep cannot be made, run or collected.
#[derive(Debug, Error)]
#[non_exhaustive]
pub enum SweepError {
    /// There is no key, two keys change the same part of the scene, or there are too many runs.
    #[error(transparent)]
    Keys(DataError),
    /// A path cannot be part of a line of text.
    #[error("{} is not valid UTF-8 or has a control character", path.display())]
    Path {
        /// The path.
        path: PathBuf,
    },
    /// The scene file cannot be read.
    #[error(transparent)]
    Scene(#[from] SceneFileError),
    /// Some runs cannot start.
    #[error("{}", messages(.0))]
    Refused(Vec<RefusedRuns>),
    /// The folder has another sweep.
    #[error(
        "{} holds another sweep (see {})", folder.display(), folder.join("runs.csv").display()
    )]
    OtherSweep {
        /// The folder.
        folder: PathBuf,
    },
    /// The folder has other files.
    #[error(
        "{} holds files and is not the folder of a sweep",
        folder.display()
    )]
    Foreign {
        /// The folder.
        folder: PathBuf,
    },
    /// A folder has neither a sweep nor a run.
    #[error(
        "{} is the folder neither of a sweep (with runs.csv) nor of a run (with scene.toml)", folder.display()
    )]
    NothingToCollect {
        /// The folder.
        folder: PathBuf,
    },
    /// A file or a folder cannot be read or written, or is not what it should be.
    #[error(transparent)]
    File(#[from] FileError),
}

impl Advice for SweepError {
    fn advice(&self) -> Option<&'static str> {
        match self {
            Self::Keys(error) => error.advice(),
            Self::Path { .. } => Some("rename it or choose another --out"),
            Self::Scene(error) => error.advice(),
            Self::OtherSweep { .. } => Some(
                "choose another folder with --out, or add values at the end of the list of its first key",
            ),
            Self::Foreign { .. } => Some("choose an empty or a new folder with --out"),
            Self::NothingToCollect { .. } => {
                Some("name folders that `isosheet sweep` or `isosheet simulate` wrote")
            }
            Self::File(error) => error.advice(),
            Self::Refused(..) => None,
        }
    }
}

/// Runs of a sweep that cannot start for the same reason.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct RefusedRuns {
    /// The first of them.
    pub first: SweepRun,
    /// Number of the other ones.
    pub others: usize,
    /// What is wrong with the first one, shown at its place in the scene.
    pub message: String,
    /// What is wrong, without the place.
    pub(crate) problem: String,
}

impl RefusedRuns {
    /// What is wrong, without the place in a text, which differs between runs.
    pub(crate) fn problem_of(error: &SceneFileError) -> String {
        match error {
            SceneFileError::Scene(error) => {
                let problems = error.problems().iter();
                problems.map(|p| format!("{p}\n")).collect()
            }
            other => other.to_string(),
        }
    }
}

fn messages(refused: &[RefusedRuns]) -> String {
    let message = |runs: &RefusedRuns| {
        let others = match runs.others {
            0 => String::new(),
            1 => " and another run".to_owned(),
            n => format!(" and {n} other runs"),
        };
        let (folder, edits) = (&runs.first.folder, runs.first.edits.join(", "));
        format!(
            "run {folder} ({edits}){others} cannot start:\n{}",
            runs.message
        )
    };
    let all: Vec<String> = refused.iter().map(message).collect();
    format!("nothing was run or written\n{}", all.join("\n\n"))
}
