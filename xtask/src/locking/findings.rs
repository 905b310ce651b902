//! What a yardstick found.

use super::table::Results;
use serde::{Deserialize, Serialize};

/// What a yardstick found.
#[derive(Clone, Debug, Default, Serialize, Deserialize)]
pub(super) struct Findings {
    /// Tables of the page, which are files as well.
    pub(super) tables: Vec<Results>,
    /// Tables that are files alone: every single run.
    pub(super) files: Vec<Results>,
    /// What the numbers say, one sentence or two each.
    pub(super) remarks: Vec<String>,
}

impl Findings {
    /// One table of the page.
    pub(super) fn table(table: Results) -> Self {
        Self {
            tables: vec![table],
            ..Self::default()
        }
    }
}
