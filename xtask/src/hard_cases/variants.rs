//! The variants of the scene of a case: all combinations of some values of some keys.

use crate::report::Effort;
use anyhow::Result;
use isosheet_runs::{Sweep, Variation};
use serde::Deserialize;
use std::collections::BTreeMap;
use std::path::Path;

/// Some keys of a scene and the values that they take.
#[derive(Clone, Debug, Deserialize)]
pub(super) struct Variants {
    /// The least effort of the reports that have these runs.
    #[serde(default = "least")]
    effort: Effort,
    #[serde(flatten)]
    keys: BTreeMap<String, Vec<toml::Value>>,
}

fn least() -> Effort {
    Effort::Quick
}

impl Variants {
    /// Whether it varies a key.
    pub(super) fn varies(&self, key: &str) -> bool {
        self.keys.contains_key(key)
    }

    /// The edits of each run in a report of some effort.
    pub(super) fn edits(&self, scene: &Path, effort: Effort) -> Result<Vec<Vec<String>>> {
        if effort < self.effort {
            return Ok(Vec::new());
        }
        let mut variations: Vec<Variation> = Vec::new();
        for (key, values) in &self.keys {
            let values: Vec<String> = values.iter().map(toml::Value::to_string).collect();
            variations.push(format!("{key}={}", values.join(",")).parse()?);
        }
        let sweep = Sweep::new(scene, Path::new("."), Vec::new(), variations)?;
        Ok(sweep.runs().map(|run| run.edits).collect())
    }
}
