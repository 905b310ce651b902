//! What is known of a run before its first step.

use super::checkpoint::StepsBy;
use super::folder::SceneHash;
use super::frames::FrameShape;
use isosheet_dynamics::immobile_vertices;
use isosheet_mesh::VertexId;
use isosheet_scenes::{Facts, SceneFile, Setup};
use std::sync::Arc;

/// What is known of a run before its first step.
pub(crate) struct Plan<'a> {
    /// The scene that is run.
    pub(crate) file: &'a SceneFile,
    pub(crate) hash: SceneHash,
    pub(crate) start: AtStart,
    pub(crate) rows: Rows,
    pub(crate) steps_by: StepsBy,
}

/// What of a scene is shown with what a run recorded.
#[derive(Clone, Debug)]
pub(crate) struct AtStart {
    pub(crate) facts: Arc<Facts>,
    /// How many numbers a frame has.
    pub(crate) shape: FrameShape,
    /// Vertices of sheets that rods to pins keep in place.
    pub(crate) immobile: Vec<VertexId>,
}

/// Where the rows of the tables of a run are, while it goes on.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Rows {
    /// In its files.
    InFiles,
    /// In its files, and in memory for what is made of them at the end.
    InMemory,
}

impl AtStart {
    /// What a scene was built to.
    pub(crate) fn of(setup: &Setup) -> Self {
        let carriers: Vec<VertexId> = setup.bodies.iter().flat_map(|body| body.vertices).collect();
        let mut immobile = immobile_vertices(&setup.model, &setup.start.x);
        immobile.retain(|v| !carriers.contains(v) && !setup.origins.is_driven(*v));
        Self {
            facts: Arc::clone(&setup.facts),
            shape: FrameShape::of(setup),
            immobile,
        }
    }
}
