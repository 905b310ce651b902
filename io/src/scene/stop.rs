//! When a run ends.

use super::problem::{Checks, Key};
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

/// When a run ends: at the first of these conditions that holds after a step.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(default, deny_unknown_fields)]
pub struct Stop {
    /// Simulated time, seconds.
    pub time: f64,
    /// Rest of the sheet.
    pub rest: Option<Rest>,
    /// Size of the force at a support that ends the run, newtons: the sum over the vertices that a support
    /// holds.
    pub support_force: Option<f64>,
}

/// Rest: all vertices are slow for some time.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
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
    pub(crate) fn check(&self, key: &Key, checks: &mut Checks) {
        checks.positive(key.name("time"), self.time, "s");
        if let Some(rest) = &self.rest {
            checks.positive(key.name("rest.speed"), rest.speed, "m/s");
            checks.positive(key.name("rest.duration"), rest.duration, "s");
        }
        if let Some(force) = self.support_force {
            checks.positive(key.name("support_force"), force, "N");
        }
    }
}
