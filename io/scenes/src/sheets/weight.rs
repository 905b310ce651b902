//! Weights that are fixed to vertices.

use crate::meshes::selection::Selection;
use crate::words::key::Key;
use crate::words::part::Part;
use crate::words::problem::Checks;
use crate::words::unit::Unit;
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

/// An additional mass that some vertices share equally: a clip at a corner, a batten in a hem. It is heavy
/// and inert, and has no extent.
///
/// ```toml
/// [[weight]]
/// at = { nearest = [[0.2, 0.0, 0.0]] }
/// mass = 0.005
/// ```
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema, Part)]
#[serde(deny_unknown_fields)]
#[checked]
pub struct Weight {
    /// The name of the sheet, if there are several and not the vertices of all are meant.
    #[serde(default)]
    pub sheet: Option<String>,
    /// Which vertices.
    pub at: Selection,
    /// The whole mass, kilograms.
    pub mass: f64,
}

impl Weight {
    pub(crate) fn check(&self, key: &Key, checks: &mut Checks) {
        checks.positive(key.name("mass"), self.mass, Unit::Kilogram);
    }
}
