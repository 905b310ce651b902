//! Sheets along whose both sides the air flows.

use crate::meshes::selection::Selection;
use crate::words::key::Key;
use crate::words::part::Part;
use crate::words::problem::Checks;
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

/// A sheet along whose both sides the air flows and which it leaves at an edge, as a wing or a flag in a
/// steady wind: it has lift, drag that goes with it, the inertia of the air that moves along with the sheet,
/// and a wake that the wind carries on. It holds at small angles between sheet and wind, 15 degrees as a
/// rule, beyond which the flow separates; the drag across faces, which stays, is all that bounds the motion
/// there. For the methods BDF2 and implicit Euler.
///
/// Each face carries a vortex ring: a step solves a dense system of as many equations.
///
/// ```toml
/// [air]
/// wind = [6, 0, 0]
/// [air.attached]
/// trailing = { half_space = { point = [0.3, 0, 0], normal = [1, 0, 0] } }
/// ```
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema, Part)]
#[serde(deny_unknown_fields)]
#[checked]
pub struct AttachedFlowKey {
    /// The name of the sheet, if there are several and not all are meant.
    #[serde(default)]
    pub sheet: Option<String>,
    /// Where the air leaves the sheet: the edges of its boundary whose two ends are selected.
    pub trailing: Selection,
    /// The number of rows of vortices that the wake has, one for each step; one more row has all that is
    /// behind them. At least 2. If left out, 80.
    #[serde(default = "rows")]
    pub rows: usize,
}

fn rows() -> usize {
    isosheet_attached_flow::AttachedFlow::ROWS
}

impl AttachedFlowKey {
    pub(crate) fn check(&self, key: &Key, checks: &mut Checks) {
        checks.count(key.name("rows"), self.rows, 2);
    }
}
