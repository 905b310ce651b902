//! What the forces of supports leave of the balance of forces and torques in a run.

use isosheet_dynamics::Simulation;
use isosheet_mesh::wording::brief;
use serde::{Deserialize, Serialize};
use std::fmt;

/// The largest sums of all forces and torques (of supports, contact, weight and loads, less the rate of the
/// momentum), beside the largest forces and torques of the supports. Sums are zero where all forces are
/// right, to the tolerance of the steps.
///
/// Of sheets without rods it is that of every step with BDF2 and implicit Euler, of others that of the end.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct ForceBalance {
    /// Largest sum of all forces, newtons.
    pub force: f64,
    /// Largest sum of the magnitudes of the forces of the supports, newtons.
    pub forces: f64,
    /// Largest sum of all torques about the middle of the sheets, newton metres.
    pub torque: f64,
    /// Largest sum of the magnitudes of the torques of the supports about it, newton metres.
    pub torques: f64,
}

impl fmt::Display for ForceBalance {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let [force, forces] = [self.force, self.forces].map(brief);
        write!(f, "{force} N of {forces} N")
    }
}

impl ForceBalance {
    /// Takes in a step, if its balance costs nothing.
    pub(crate) fn after(before: Option<Self>, simulation: &Simulation) -> Option<Self> {
        match simulation.model().rods().is_empty() {
            true => Self::at_end(before, simulation),
            false => before,
        }
    }

    /// Takes in the last step of a run.
    pub(crate) fn at_end(before: Option<Self>, simulation: &Simulation) -> Option<Self> {
        let Some(now) = simulation.imbalance() else {
            return before;
        };
        let before = before.unwrap_or_default();
        Some(Self {
            force: before.force.max(now.force.norm()),
            forces: before.forces.max(now.forces),
            torque: before.torque.max(now.torque.norm()),
            torques: before.torques.max(now.torques),
        })
    }

    /// Part of the forces of the supports that is not balanced.
    pub fn part(&self) -> f64 {
        if self.force > 0.0 {
            self.force / self.forces
        } else {
            0.0
        }
    }
}
