//! What to know of a scene before it is run.

use super::in_words::bytes_in_words;
use super::setup::Setup;
use isosheet_mesh::wording::counted;
use isosheet_mesh::{Advice, VertexId};
use thiserror::Error;

/// A reason why a scene that can start may not do what was meant.
#[derive(Clone, Debug, PartialEq, Eq, Error)]
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
}

impl Advice for SceneWarning {
    fn advice(&self) -> Option<&'static str> {
        match self {
            Self::ClampAcrossMesh { .. } => Some(
                "name what the sheet is made of, `sheet.material`, which makes it elastic; or make a mesh with a line of \
                 edges along the clamp",
            ),
            Self::Disk { .. } => Some("take fewer frames a second, `output.frames_per_second`"),
            Self::Memory { .. } => Some("make the mesh coarser"),
            Self::Time { .. } => {
                Some("make the mesh coarser, the steps longer or the time shorter")
            }
        }
    }
}

impl Setup {
    /// What to know before the scene is run.
    pub fn warnings(&self) -> Vec<SceneWarning> {
        let clamps = self.model.clamps_across_the_mesh(&self.start.x);
        let warning = |edge: Vec<VertexId>| {
            let pins = edge.iter().filter_map(|v| self.origins.pins.get(v));
            let mut supports: Vec<usize> = pins.copied().collect();
            supports.sort_unstable();
            supports.dedup();
            SceneWarning::ClampAcrossMesh { supports, edge }
        };
        clamps
            .into_iter()
            .map(|clamp| warning(clamp.edge))
            .collect()
    }
}

/// The keys of supports.
fn keys(numbers: &[usize]) -> String {
    let keys: Vec<String> = numbers.iter().map(|k| format!("`support[{k}]`")).collect();
    keys.join(" and ")
}
