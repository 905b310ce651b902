//! What moves as the scene prescribes.

use crate::model::support::Support;
use std::fmt;

/// What moves as the scene prescribes.
#[derive(Debug, Clone, Copy, PartialEq, Eq, serde::Serialize)]
#[serde(rename_all = "snake_case")]
pub enum Driver {
    /// A support.
    Support(Support),
    /// A body, by its number.
    Body(usize),
}

impl fmt::Display for Driver {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Support(support) => write!(f, "{support}"),
            Self::Body(body) => write!(f, "body {body}"),
        }
    }
}

/// What a driver does between the state and the time for which positions are sought, at the minimum.
#[derive(Debug, Clone, Copy)]
pub(super) struct Drive {
    pub(super) by: Driver,
    /// The size of its force on the sheet, in units of stiffness times metres.
    pub(super) force: f64,
    /// The force times the displacement along it.
    pub(super) work: f64,
    /// How far it moves, metres.
    pub(super) displacement: f64,
}
