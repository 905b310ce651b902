//! The variants of the scene of a case: all combinations of some values of some keys.

use crate::report::Effort;
use anyhow::{Context, Result, ensure};
use isosheet_io::run::{Sweep, Variation};
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
    keys: BTreeMap<String, Values>,
}

fn least() -> Effort {
    Effort::Quick
}

/// The values of a key: a list, or `"1..12"` for whole numbers.
#[derive(Clone, Debug, Deserialize)]
#[serde(
    untagged,
    expecting = "the values of a key are a list, `[0.1, 0.2]`, or a range, `\"1..12\"`"
)]
enum Values {
    List(Vec<toml::Value>),
    Range(String),
}

impl Values {
    /// As texts of TOML.
    fn texts(&self) -> Result<Vec<String>> {
        match self {
            Self::List(values) => Ok(values.iter().map(toml::Value::to_string).collect()),
            Self::Range(range) => {
                let ends = range.split_once("..").and_then(|(a, b)| {
                    let ends: (i64, i64) = (a.parse().ok()?, b.parse().ok()?);
                    Some(ends)
                });
                let (first, last) = ends
                    .filter(|(first, last)| first <= last)
                    .with_context(|| format!("`{range}` is no range such as `1..12`"))?;
                let count = first.abs_diff(last);
                ensure!(
                    count < Sweep::MOST_RUNS as u64,
                    "`{range}` are more runs than the {} of a sweep",
                    Sweep::MOST_RUNS
                );
                Ok((first..=last).map(|n| n.to_string()).collect())
            }
        }
    }
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
            variations.push(format!("{key}={}", values.texts()?.join(",")).parse()?);
        }
        let sweep = Sweep::new(scene, Path::new("."), Vec::new(), variations)?;
        Ok(sweep.runs().map(|run| run.edits).collect())
    }
}
