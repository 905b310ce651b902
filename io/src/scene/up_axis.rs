//! Which axis of a file points upwards.

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

/// The axis of a file that points upwards.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
#[cfg_attr(feature = "cli", derive(clap::ValueEnum))]
pub enum UpAxis {
    /// z: coordinates are used as they are.
    #[default]
    Z,
    /// y: (x, y, z) becomes (x, -z, y).
    Y,
}

impl UpAxis {
    /// A point of a file with z upwards.
    pub(crate) fn place(self, [x, y, z]: [f64; 3]) -> [f64; 3] {
        match self {
            Self::Z => [x, y, z],
            Self::Y => [x, -z, y],
        }
    }
}
