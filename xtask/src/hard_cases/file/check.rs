//! The bounds of a case that is a file.

use super::Ran;
use super::variants::Variants;
use crate::hard_cases::case::Findings;
use crate::report::{Bound, Limitation, Shortfall};
use anyhow::{Result, bail, ensure};
use serde::Deserialize;
use serde_json::Value;
use std::collections::BTreeMap;

/// The quantity that counts runs: those that stop before their end.
const STOPPED: &str = "stopped";

/// A bound, or two.
#[derive(Clone, Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct FileCheck {
    /// A number of the summary by its path, or `stopped`.
    quantity: String,
    /// The runs that it is for, by values of variants; all if left out.
    #[serde(default)]
    only: BTreeMap<String, toml::Value>,
    at_most: Option<f64>,
    at_least: Option<f64>,
    limitation: Option<Limitation>,
}

impl FileCheck {
    /// Whether the check is right for a case with these variants.
    pub(super) fn validate(&self, variants: &[Variants]) -> Result<()> {
        let (count, quantity) = (self.bounds().count(), &self.quantity);
        ensure!(
            count > 0,
            "`{quantity}` has no bound: `at_most` or `at_least`"
        );
        ensure!(
            count == 1 || self.limitation.is_none(),
            "a limitation is of one bound: `{quantity}`"
        );
        let mut values = [self.at_most, self.at_least].into_iter().flatten();
        ensure!(
            values.all(f64::is_finite),
            "a bound of `{quantity}` is not finite"
        );
        if let Some(
            Shortfall::Value([low, high])
            | Shortfall::Stops {
                at: [low, high], ..
            },
        ) = self.limitation.as_ref().map(|l| &l.shortfall)
        {
            ensure!(
                low <= high,
                "the limitation of `{quantity}` ends before it begins"
            );
        }
        for key in self.only.keys() {
            let known = variants.iter().any(|v| v.varies(key));
            ensure!(known, "`{key}` of `only` is none of the variants");
        }
        Ok(())
    }

    fn bounds(&self) -> impl Iterator<Item = Bound> {
        let bounds = [
            self.at_most.map(Bound::AtMost),
            self.at_least.map(Bound::AtLeast),
        ];
        bounds.into_iter().flatten()
    }

    /// Whether the check is for a run with these edits.
    pub(super) fn is_for(&self, edits: &[String]) -> bool {
        let mut wanted = self.only.iter();
        wanted.all(|(key, value)| edits.contains(&format!("{key}={value}")))
    }

    /// The check in words.
    pub(super) fn words(&self) -> String {
        let only = self.only.iter();
        let only: Vec<String> = only
            .map(|(key, value)| format!("{key} = {value}"))
            .collect();
        let runs = match only.is_empty() {
            true => "all runs".to_owned(),
            false => only.join(", "),
        };
        let quantity = match self.quantity.as_str() {
            STOPPED => "number that stop early",
            path => path,
        };
        format!("{runs}: {quantity}")
    }

    /// Judges the runs that it is for.
    pub(super) fn judge(&self, found: &mut Findings, runs: &[&Ran]) -> Result<()> {
        let stops = |l: &Limitation| matches!(l.shortfall, Shortfall::Stops { .. });
        ensure!(
            runs.len() == 1 || !self.limitation.as_ref().is_some_and(stops),
            "a limitation with `stops` is of one run: `{}`",
            self.words()
        );
        for bound in self.bounds() {
            let check = match self.quantity.as_str() {
                STOPPED => {
                    let stopped: Vec<_> = runs.iter().filter_map(|r| r.stopped.as_ref()).collect();
                    let check = found.check(self.words(), stopped.len() as f64, bound);
                    check.remark(stopped.first().map(|(_, why)| why.clone()))
                }
                path => {
                    // The worst run: one without the number, or the one that is farthest on the wrong side.
                    let pointer = format!("/{}", path.replace('.', "/"));
                    let value = |run: &Ran| run.summary.pointer(&pointer).and_then(Value::as_f64);
                    let badness =
                        |run: &Ran| value(run).map_or(f64::INFINITY, |v| bound.badness(v));
                    let worst = runs.iter().max_by(|a, b| badness(a).total_cmp(&badness(b)));
                    let worst = worst.expect("there are runs");
                    if worst.stopped.is_none() && value(worst).is_none() {
                        bail!("the summary has no number `{path}`");
                    }
                    let check = found.check(self.words(), value(worst).unwrap_or(f64::NAN), bound);
                    check.stopped = worst.stopped.as_ref().map(|(t, _)| *t);
                    check.remark(worst.stopped.as_ref().map(|(_, why)| why.clone()))
                }
            };
            check.limitation.clone_from(&self.limitation);
        }
        Ok(())
    }
}
