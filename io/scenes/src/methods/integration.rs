//! How the motion of a scene is computed.

use crate::methods::chart::ChartKey;
use isosheet_dynamics::{Method, StepControl};

/// How the motion is computed.
#[derive(Clone, Debug, PartialEq)]
pub enum Integration {
    /// Over all positions.
    Free {
        /// The integrator.
        method: Method,
        /// What happens to rejected steps.
        control: StepControl,
    },
    /// In the chart that exists at the start.
    InChart(ChartKey),
}
