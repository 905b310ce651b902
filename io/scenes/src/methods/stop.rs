//! When a run ends.

use crate::words::key::Key;
use crate::words::part::Part;
use crate::words::problem::Checks;
use crate::words::unit::Unit;
use isosheet_mesh::wording::{brief, given};
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

/// Most steps of a run: a history of so many rows has a hundred gigabytes, and at ten microseconds a step,
/// the least that a step of the smallest sheets takes, the run goes on for three hours.
const MOST_STEPS: f64 = 1e9;

/// When a run ends: at the first of these conditions that holds after a step.
///
/// ```toml
/// [stop]
/// time = 5
/// rest = { speed = 0.001, duration = 0.2 }
/// ```
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema, Part)]
#[serde(default, deny_unknown_fields)]
pub struct Stop {
    /// Simulated time, seconds.
    pub time: f64,
    /// Rest of the sheet, after all functions of time but sines have come to their ends.
    pub rest: Option<Rest>,
    /// Size of the force at a support that ends the run, newtons: the sum over the vertices that a support
    /// holds.
    pub support_force: Option<f64>,
}

/// Rest: all vertices are slow for some time.
///
/// ```toml
/// [stop]
/// rest = { speed = 0.001, duration = 0.2 }
/// ```
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema, Part)]
#[serde(deny_unknown_fields)]
pub struct Rest {
    /// Largest speed of a vertex, m/s.
    pub speed: f64,
    /// For how long, seconds of simulated time.
    pub duration: f64,
}

impl Default for Stop {
    /// After one second.
    fn default() -> Self {
        Self {
            time: 1.0,
            rest: None,
            support_force: None,
        }
    }
}

impl Stop {
    /// Whether one of the forces of the supports (newtons) ends the run. They are asked for only where the
    /// run may end at one.
    pub fn is_force_reached(&self, supports: impl FnOnce() -> Vec<[f64; 3]>) -> bool {
        let size = |f: &[f64; 3]| f.iter().map(|c| c * c).sum::<f64>().sqrt();
        let is_above = |limit| supports().iter().any(|f| size(f) > limit);
        self.support_force.is_some_and(is_above)
    }

    /// Checks the conditions for a run in steps of `step` seconds.
    pub(crate) fn check(&self, step: f64, key: &Key, checks: &mut Checks) {
        checks.positive(key.name("time"), self.time, Unit::Second);
        let steps = self.time / step;
        if step > 0.0 && self.time.is_finite() && steps > MOST_STEPS {
            let time = self.time;
            let message = format!(
                "{} s in steps of {} s are {} steps",
                given(time),
                given(step),
                brief(steps)
            );
            let remedy = "choose a shorter time or a longer `method.step`, for at most 1e9 steps";
            checks.report(key.name("time"), message, remedy);
        }
        if let Some(rest) = &self.rest {
            checks.positive(key.name("rest.speed"), rest.speed, Unit::MetrePerSecond);
            checks.positive(key.name("rest.duration"), rest.duration, Unit::Second);
        }
        checks.positive(key.name("support_force"), self.support_force, Unit::Newton);
    }
}
