//! What a run writes.

use crate::words::key::Key;
use crate::words::part::Part;
use crate::words::problem::Checks;
use crate::words::unit::Unit;
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

/// What a run writes, besides the history and the summary.
///
/// ```toml
/// [output]
/// frames_per_second = 60
/// obj = true
/// ```
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema, Part)]
#[serde(default, deny_unknown_fields)]
#[checked]
pub struct Output {
    /// Frames per second of simulated time. A frame is taken after a whole number of steps, the nearest to
    /// this rate.
    pub frames_per_second: f64,
    /// Time between two checkpoints, seconds of wall time: the most that is lost when the process is killed.
    /// With 0 there is a checkpoint after every step.
    pub checkpoint_interval: f64,
    /// Whether the frames are written as `trajectory.npz`.
    pub trajectory: bool,
    /// Whether the frames are written as OBJ files in the folder `obj`.
    pub obj: bool,
    /// Whether the 3D page of the run is written as `index.html`.
    pub page: bool,
    /// Whether the page can show the curvature of the sheet across its rulings, and its Gauss curvature, as
    /// colours, and `trajectory.npz` has them. They are made of the positions: pictures and VTK files can
    /// have them of every run.
    pub curvature: bool,
}

impl Default for Output {
    fn default() -> Self {
        Self {
            frames_per_second: 30.0,
            checkpoint_interval: 10.0,
            trajectory: true,
            obj: false,
            page: true,
            curvature: false,
        }
    }
}

impl Output {
    pub(crate) fn check(&self, key: &Key, checks: &mut Checks) {
        let rate = self.frames_per_second;
        checks.positive(key.name("frames_per_second"), rate, Unit::PerSecond);
        let interval = self.checkpoint_interval;
        checks.not_negative(key.name("checkpoint_interval"), interval, Unit::Second);
    }

    /// Number of steps of `h` seconds from one frame to the next, at least one.
    pub fn steps_per_frame(&self, h: f64) -> u64 {
        (1.0 / (self.frames_per_second * h)).round().max(1.0) as u64
    }
}
