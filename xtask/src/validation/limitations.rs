//! Claims that are known not to be kept, with the cause: the file `limitations.toml`.

use crate::report::{Effort, Finding, Shortfall};
use serde::Deserialize;
use std::collections::BTreeMap;
use std::sync::LazyLock;

#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields)]
struct Contents {
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
    /// Between which errors, per cent, the largest one lies on all meshes.
    between: [f64; 2],
}

static CONTENTS: LazyLock<Contents> = LazyLock::new(|| {
    let contents = toml::from_str(include_str!("limitations.toml"));
    contents.unwrap_or_else(|error| panic!("limitations.toml: {error}"))
});

/// Says in a finding that its claim is known not to be kept, where that is so. A quick report has some of the meshes
/// alone, whose largest error may be smaller.
pub(super) fn declare(
    finding: &mut Finding,
    experiment: &str,
    quantity: &str,
    across: usize,
    effort: Effort,
) {
    let mut all = CONTENTS.limitation.iter();
    let is_it =
        |d: &&Declared| d.experiment == experiment && d.quantity == quantity && d.across == across;
    if let Some(declared) = all.find(is_it) {
        let value = Shortfall::Value(declared.between);
        let shortfall = effort.quick_or(Shortfall::Varies, value);
        finding.limited(&CONTENTS.reasons[&declared.why], shortfall);
    }
}

#[cfg(test)]
mod tests {
    use super::super::EXPERIMENTS;
    use super::*;

    #[test]
    fn what_is_declared_exists_and_has_a_reason() {
        for declared in &CONTENTS.limitation {
            let found = EXPERIMENTS.iter().find(|e| e.name == declared.experiment);
            let quantities = (found.expect("an experiment").quantities)();
            let is_named = quantities.iter().any(|q| q.name == declared.quantity);
            assert!(is_named, "{declared:?}");
            assert!(CONTENTS.reasons.contains_key(&declared.why), "{declared:?}");
        }
    }
}
