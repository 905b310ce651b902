//! How much work a report puts in.

use serde::{Deserialize, Serialize};

/// How much work a report puts in.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Serialize, Deserialize)]
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
}
