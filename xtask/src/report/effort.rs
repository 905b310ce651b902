//! How much work a report puts in.

use serde::{Deserialize, Serialize};
use std::time::Duration;

/// How much work a report puts in.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub(crate) enum Effort {
    /// Seconds: shows that everything works, and no result.
    Quick,
    /// Minutes.
    Standard,
    /// As long as it takes.
    Full,
}

impl Effort {
    /// The effort that the flags `--quick` and `--full` ask for.
    pub(crate) fn of_flags([quick, full]: [bool; 2]) -> Self {
        match (quick, full) {
            (true, _) => Self::Quick,
            (_, true) => Self::Full,
            _ => Self::Standard,
        }
    }

    /// The value for this effort.
    pub(crate) fn pick<T>(self, quick: T, standard: T, full: T) -> T {
        match self {
            Self::Quick => quick,
            Self::Standard => standard,
            Self::Full => full,
        }
    }

    /// The value for quick runs, or that for all others.
    pub(crate) fn quick_or<T>(self, quick: T, other: T) -> T {
        if self == Self::Quick { quick } else { other }
    }

    /// A limit of wall time (seconds) for quick runs and for all others.
    pub(crate) fn patience(self, quick: f64, other: f64) -> Duration {
        Duration::from_secs_f64(self.quick_or(quick, other))
    }
}
