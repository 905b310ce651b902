//! Meshes in motion, from files.

use super::key::Key;
use super::problem::Checks;
use super::unit::Unit;
use super::up_axis::UpAxis;
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};
use std::path::PathBuf;

/// A mesh in motion: the positions of its vertices at several times, in an archive of numpy (`.npz`) with the arrays
/// `t` (T times, seconds), `x` (T x V x 3) and `faces` (F x 3, from 0). The `trajectory.npz` of a run is one, and
/// `numpy.savez("body.npz", t=t, x=x, faces=faces)` writes one. Between these times vertices go straight on at
/// constant speed, before and after they rest.
///
/// ```toml
/// [[obstacle]]
/// shape = { sequence = { path = "body.npz", up = "y" } }
/// ```
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Sequence {
    /// Path of the file, relative to the scene file.
    pub path: PathBuf,
    /// Length of one unit of the file, metres: 0.001 for a file in millimetres.
    #[serde(default = "one")]
    pub scale: f64,
    /// The axis of the file that points upwards; it becomes z.
    #[serde(default)]
    pub up: UpAxis,
    /// What is added to the times of the file, seconds.
    #[serde(default)]
    pub delay: f64,
}

fn one() -> f64 {
    1.0
}

impl Sequence {
    /// A file in metres with z upwards, at its own times.
    pub fn new(path: impl Into<PathBuf>) -> Self {
        Self {
            path: path.into(),
            scale: 1.0,
            up: UpAxis::Z,
            delay: 0.0,
        }
    }

    pub(crate) fn check(&self, key: &Key, checks: &mut Checks) {
        checks.positive(key.name("scale"), self.scale, Unit::Metre);
        checks.number(key.name("delay"), self.delay, Unit::Second);
        if self.path.as_os_str().is_empty() {
            checks.report(key.name("path"), "the path is empty", "name an .npz file");
        }
    }
}
