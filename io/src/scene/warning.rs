//! What to know of a scene before it is run.

use super::bytes::bytes_in_words;
use super::key::Key;
use isosheet_mesh::wording::{brief, counted};
use isosheet_mesh::{Advice, VertexId};
use std::path::PathBuf;
use thiserror::Error;

/// A reason why a scene that can start may not do what was meant.
#[derive(Clone, Debug, PartialEq, Error)]
#[non_exhaustive]
pub enum SceneWarning {
    /// A sheet of rods is clamped where no line of edges of its mesh runs along the clamp
    /// ([`SheetModel::clamps_across_the_mesh`](isosheet_dynamics::SheetModel::clamps_across_the_mesh)).
    #[error(
        "no line of edges of the mesh runs along the clamp by {}: the {} beside its free part are on no line, so \
         that the rods cannot fold there, and most such sheets lock",
        keys(.supports), counted(.edge.len(), "vertex", "vertices")
    )]
    ClampAcrossMesh {
        /// The supports of the scene that make the clamp, by number.
        supports: Vec<usize>,
        /// The clamped vertices beside the free part of the sheet.
        edge: Vec<VertexId>,
    },
    /// A run writes much.
    #[error("the files of the run need about {}", bytes_in_words(*bytes as f64))]
    Disk {
        /// Length of all files, bytes.
        bytes: u64,
    },
    /// A run needs most of the free memory.
    #[error("the run needs about {} of memory, more than half of what is free", bytes_in_words(*bytes as f64))]
    Memory {
        /// Bytes.
        bytes: u64,
    },
    /// A run takes long.
    #[error("the run takes {} or more", counted(*days as usize, "day", "days"))]
    Time {
        /// Wall time on one core of a sheet of rods without contact, days.
        days: u64,
    },
    /// Sheets of rods are closed surfaces: these have `3V - E = 3 chi`, at most the six degrees of freedom of
    /// a rigid body, and almost all of them are rigid ([`Dof`](isosheet_mesh::Dof)).
    #[error(
        "{}: a sheet of rigid rods without a boundary cannot bend",
        closed_parts(*closed, *parts)
    )]
    Closed {
        /// The number of closed parts.
        closed: usize,
        /// The number of all parts.
        parts: usize,
    },
    /// A sheet of a file is so wide that the unit of the file is probably not the metre.
    #[error("the sheet is {} m wide, as the numbers of a file are taken for metres", brief(*width))]
    WideFile {
        /// The largest extent along an axis, metres.
        width: f64,
    },
    /// A sheet is so wide that its lengths are probably not in metres.
    #[error("`{key}` is {} m wide", brief(*width))]
    Wide {
        /// The sheet.
        key: Key,
        /// The largest extent along an axis, metres.
        width: f64,
    },
    /// A point is farther from the sheet whose nearest vertex it chooses than that is wide.
    #[error(
        "`{key}` is {} m away from the nearest vertex, and the sheet is {} m wide",
        brief(*distance), brief(*width)
    )]
    FarPoint {
        /// The point.
        key: Key,
        /// The distance of the nearest vertex, metres.
        distance: f64,
        /// The largest extent of the sheet along an axis, metres.
        width: f64,
    },
    /// Faces of a crease pattern were clockwise and have been reversed.
    #[error(
        "{} of {} are clockwise: they were reversed, with the mountains and valleys at them",
        counted(*faces, "face", "faces"), path.display()
    )]
    ReversedFaces {
        /// The file.
        path: PathBuf,
        /// How many.
        faces: usize,
    },
}

impl Advice for SceneWarning {
    fn advice(&self) -> Option<&'static str> {
        Some(match self {
            Self::ClampAcrossMesh { .. } => {
                "name what the sheet is made of, `sheet.material`, which makes it elastic; or make a mesh with a line \
                 of edges along the clamp"
            }
            Self::Disk { .. } => "take fewer frames a second, `output.frames_per_second`",
            Self::Memory { .. } => "make the mesh coarser",
            Self::Time { .. } => "make the mesh coarser, the steps longer or the time shorter",
            Self::Closed { .. } => "cut it open along some edges, or make it an obstacle",
            Self::WideFile { .. } => {
                "of a file in millimetres write `scale = 0.001` beside `path` in the scene"
            }
            Self::Wide { .. } => "give lengths in metres",
            Self::FarPoint { .. } => {
                "give coordinates in metres of where the sheet is at the start: `isosheet info` gives its bounds"
            }
            Self::ReversedFaces { .. } => {
                "a valley folds towards the side from which its faces are counter-clockwise in the file: if the sheet \
                 folds the wrong way, list the faces counter-clockwise there"
            }
        })
    }
}

/// The keys of supports.
fn keys(numbers: &[usize]) -> String {
    let keys: Vec<String> = numbers.iter().map(|k| format!("`support[{k}]`")).collect();
    keys.join(" and ")
}

/// How many parts of a surface are closed.
fn closed_parts(closed: usize, parts: usize) -> String {
    match closed {
        all if all == parts => "the surface is closed".to_owned(),
        some => format!("{some} of the {parts} parts are closed surfaces"),
    }
}
