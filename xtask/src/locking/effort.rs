//! How much time the report may take.

use serde::{Deserialize, Serialize};
use std::time::Duration;

/// How much time the report may take.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub(crate) enum LockingEffort {
    /// Seconds: few sheets on coarse meshes, which show that everything works.
    Quick,
    /// About a quarter of an hour.
    Full,
}

impl LockingEffort {
    /// The value for this effort.
    pub(super) fn pick<T>(self, quick: T, full: T) -> T {
        match self {
            Self::Quick => quick,
            Self::Full => full,
        }
    }

    /// A limit of wall time, seconds.
    pub(super) fn patience(self, quick: f64, full: f64) -> Duration {
        Duration::from_secs_f64(self.pick(quick, full))
    }
}
