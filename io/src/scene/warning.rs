//! What to know of a scene before it is run.

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
}

impl Advice for SceneWarning {
    fn advice(&self) -> Option<&'static str> {
        match self {
            Self::ClampAcrossMesh { .. } => Some(
                "name what the sheet is made of, `sheet.material`, which makes it elastic; or make a mesh with a line of \
                 edges along the clamp",
            ),
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
