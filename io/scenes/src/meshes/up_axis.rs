//! Which axis of a file points upwards.

use crate::words::key::Key;
use crate::words::part::Part;
use crate::words::problem::Checks;
use isosheet_formats::says_up;
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};
use std::path::Path;

/// The axis of a file that points upwards.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize, JsonSchema, Part)]
#[serde(rename_all = "snake_case")]
pub enum UpAxis {
    /// z: coordinates are used as they are.
    #[default]
    Z,
    /// y: (x, y, z) becomes (x, -z, y).
    Y,
}

impl UpAxis {
    /// Refuses another axis than z for a file that says itself which one points upwards; `key` is the place
    /// of the file in the scene.
    pub(crate) fn check(self, path: &Path, key: &Key, checks: &mut Checks) {
        if self != Self::Z && says_up(path) {
            checks.report(
                key.name("up"),
                "the file itself says which axis points upwards, and is read with z upwards",
                "leave `up` out",
            );
        }
    }

    /// A point of a file with z upwards.
    pub fn place(self, [x, y, z]: [f64; 3]) -> [f64; 3] {
        match self {
            Self::Z => [x, y, z],
            Self::Y => [x, -z, y],
        }
    }
}
