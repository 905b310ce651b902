//! What a scene has to say to be run, recorded and drawn.

use anyhow::Result;
use isosheet_collide::Obstacle;
use isosheet_dynamics::Simulation;
use isosheet_mesh::Sheet;
use serde::Serialize;

/// A scene that starts at rest and is run frame by frame. Serialised it is everything that decides how the
/// run goes.
pub(crate) trait Staged: Serialize {
    /// Name of the folder of the run.
    fn name(&self) -> &str;

    /// Time between frames, seconds.
    fn frame(&self) -> f64;

    /// Number of frames after the first.
    fn frames(&self) -> usize;

    /// The sheet at rest.
    ///
    /// # Errors
    /// Sizes of which no sheet can be made.
    fn sheet(&self) -> Result<Sheet>;

    /// The bodies that the sheet meets, in the order of their loads.
    ///
    /// # Errors
    /// Sizes of which no body can be made.
    fn bodies(&self) -> Result<Vec<Obstacle>> {
        Ok(Vec::new())
    }

    /// Whether the run is over after a frame, before its last one.
    fn ends(&self, _simulation: &Simulation) -> bool {
        false
    }

    /// The simulation at its start.
    ///
    /// # Errors
    /// What makes no sense in the scene.
    fn simulation(&self, sheet: &Sheet) -> Result<Simulation>;
}
