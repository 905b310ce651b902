//! Why a fit cannot be made.

use crate::RunError;
use isosheet_files::DataError;
use isosheet_formats::MeshFileError;
use isosheet_mesh::Advice;
use isosheet_mesh::wording::{brief, given};
use isosheet_scenes::SceneFileError;
use std::path::PathBuf;
use thiserror::Error;

/// Why a fit cannot be made.
#[derive(Debug, Error)]
#[non_exhaustive]
pub enum FitError {
    /// There is no key or no target, or a key is given twice or changes a part of another one.
    #[error(transparent)]
    Keys(DataError),
    /// The scene cannot be read, or is wrong with the values at the start.
    #[error(transparent)]
    Scene(#[from] SceneFileError),
    /// The scene has no measure of a name.
    #[error("the scene has no measure `{name}`{}", in_words(.known))]
    NoMeasure {
        /// The name.
        name: String,
        /// The names of its measures.
        known: Vec<String>,
    },
    /// The mesh file of a target cannot be read.
    #[error(transparent)]
    Mesh(#[from] MeshFileError),
    /// A mesh has other vertices than the scene.
    #[error("{} has {found} vertices, and the scene has {expected}", path.display())]
    Vertices {
        /// The mesh file.
        path: PathBuf,
        /// Its number of vertices.
        found: usize,
        /// The number of the scene.
        expected: usize,
    },
    /// Targets of different units have no common measure of their differences.
    #[error("the targets have the units {} and {}", units[0], units[1])]
    Units {
        /// Two of them.
        units: [String; 2],
    },
    /// The run at the start of the search, or one beside it, fails.
    #[error("the run with {edits} fails: {source}")]
    Run {
        /// The values of the keys.
        edits: String,
        /// Why.
        #[source]
        source: RunError,
    },
    /// A key whose value is a whole number.
    #[error("`{key}` takes whole numbers")]
    Whole {
        /// The key.
        key: String,
    },
    /// A small change of a key has no effect on the targets.
    #[error("a change of `{key}` by {} at {} changes nothing of the targets", brief(*step), given(*value))]
    NoEffect {
        /// The key.
        key: String,
        /// The change.
        step: f64,
        /// Its value.
        value: f64,
    },
    /// Whoever waits for the fit has given up.
    #[error("interrupted")]
    Interrupted,
}

fn in_words(names: &[String]) -> String {
    match names {
        [] => String::new(),
        names => format!(", but {}", names.join(", ")),
    }
}

impl Advice for FitError {
    fn advice(&self) -> Option<&'static str> {
        match self {
            Self::Keys(error) => error.advice(),
            Self::Scene(error) => error.advice(),
            Self::NoMeasure { .. } => Some("add a `[[measure]]` to the scene"),
            Self::Mesh(error) => error.advice(),
            Self::Vertices { .. } => Some(
                "give a mesh of the vertices of the scene in their order, as `isosheet convert RUN FILE --frame last` writes",
            ),
            Self::Units { .. } => {
                Some("give each target its standard deviation, for example `tip=-0.05+-0.001`")
            }
            Self::Run { source, .. } => source.advice().or(Some(
                "begin at other values of the keys, or give ranges in which all runs come to their end",
            )),
            Self::Whole { .. } => Some("compare some of its values by `isosheet sweep`"),
            Self::NoEffect { .. } => Some(
                "leave the key out, or choose targets that depend on it; a key with which the run changes by leaps is one for \
                 `isosheet sweep`",
            ),
            Self::Interrupted => None,
        }
    }
}
