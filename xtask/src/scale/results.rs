//! Everything measured.

use super::drape::DrapeRow;
use super::measure::Row;
use super::whole::WholeRun;
use crate::timing::Work;

/// Everything measured.
#[derive(Clone, Debug)]
pub(super) struct Results {
    pub(super) hanging: Vec<Row>,
    pub(super) draping: Vec<DrapeRow>,
    /// Whole runs, and the limit of wall time of each, seconds.
    pub(super) whole: Vec<WholeRun>,
    pub(super) limit: f64,
}

impl Results {
    /// The whole runs of a scene.
    pub(super) fn whole_of(&self, scene: Work) -> Vec<&WholeRun> {
        self.whole.iter().filter(|r| r.scene == scene).collect()
    }
}
