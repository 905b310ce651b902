//! Claims that are known not to be kept, with the cause: the file `limitations.toml`. It is read as a report
//! is written, so that what was measured does not depend on it.

use crate::report::{Effort, Finding, Shortfall};
use crate::sources::root;
use anyhow::{Context, Result};
use serde::Deserialize;
use std::collections::BTreeMap;
use std::fs;

/// The file.
#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct Limitations {
    /// Why claims are not kept, by a word.
    reasons: BTreeMap<String, String>,
    limitation: Vec<Declared>,
}

/// A claim that is not kept.
#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields)]
struct Declared {
    experiment: String,
    quantity: String,
    /// Squares across.
    across: usize,
    /// The word for why.
    why: String,
    /// Between which errors, per cent, the largest one lies on all meshes; nothing where a run does not end.
    between: Option<[f64; 2]>,
}

impl Limitations {
    /// Reads the file.
    pub(super) fn read() -> Result<Self> {
        let path = root().join("xtask/src/validation/limitations.toml");
        let named = || path.display().to_string();
        let text = fs::read_to_string(&path).with_context(named)?;
        toml::from_str(&text).with_context(named)
    }

    /// Says in a finding that its claim is known not to be kept, where that is so. A quick report has some of
    /// the meshes alone, whose largest error may be smaller.
    pub(super) fn declare(
        &self,
        finding: &mut Finding,
        [experiment, quantity]: [&str; 2],
        across: usize,
        effort: Effort,
    ) {
        let mut all = self.limitation.iter();
        let is_it = |d: &&Declared| {
            d.experiment == experiment && d.quantity == quantity && d.across == across
        };
        if let Some(declared) = all.find(is_it) {
            let value = declared.between.map_or(Shortfall::Varies, Shortfall::Value);
            let shortfall = effort.quick_or(Shortfall::Varies, value);
            finding.limited(&self.reasons[&declared.why], shortfall);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::super::EXPERIMENTS;
    use super::*;

    #[test]
    fn what_is_declared_exists_and_has_a_reason() {
        let all = Limitations::read().unwrap();
        for declared in &all.limitation {
            let found = EXPERIMENTS.iter().find(|e| e.name == declared.experiment);
            let quantities = (found.expect("an experiment").quantities)();
            let is_named = quantities.iter().any(|q| q.name == declared.quantity);
            assert!(is_named, "{declared:?}");
            assert!(all.reasons.contains_key(&declared.why), "{declared:?}");
        }
    }
}
