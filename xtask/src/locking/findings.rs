//! What a yardstick found.

use super::targets::Target;
use crate::report::Table;
use serde::{Deserialize, Serialize};

/// What a yardstick found.
#[derive(Clone, Debug, Default, Serialize, Deserialize)]
pub(super) struct Findings {
    /// Tables of the page, which are files as well.
    pub(super) tables: Vec<Table>,
    /// Tables that are files alone: every single run.
    pub(super) files: Vec<Table>,
    /// What the numbers say, one sentence or two each.
    pub(super) remarks: Vec<String>,
    /// What the models are required to reach here.
    pub(super) targets: Vec<Target>,
}
