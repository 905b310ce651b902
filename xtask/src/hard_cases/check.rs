//! The bounds of a case.

use super::case::CaseRun;
use super::variants::Variants;
use crate::report::{Bound, Finding, Limitation, Shortfall};
use anyhow::{Result, ensure};
use serde::Deserialize;
use std::collections::BTreeMap;

/// The quantity that is no number of a run: how many runs stop before their end.
const STOPPED: &str = "stopped";

/// A bound, or two.
#[derive(Clone, Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct Check {
    /// [`STOPPED`], or a number of each run by its place in `summary.json`, of which the worst counts.
    quantity: String,
    /// The runs that it is for, by values of variants; all if left out.
    #[serde(default)]
    only: BTreeMap<String, toml::Value>,
    at_most: Option<f64>,
    at_least: Option<f64>,
    limitation: Option<Limitation>,
}

impl Check {
    /// Whether the check is right for a case with these variants.
    pub(super) fn validate(&self, variants: &[Variants]) -> Result<()> {
        let (count, words) = (self.bounds().count(), self.words());
        ensure!(count > 0, "`{words}` has no bound: `at_most` or `at_least`");
        ensure!(
            count == 1 || self.limitation.is_none(),
            "a limitation is of one bound: `{words}`"
        );
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
        match self.quantity.as_str() {
            STOPPED => format!("{runs}: number that stop early"),
            quantity => format!("{runs}: {quantity}"),
        }
    }

    /// Judges the runs that it is for.
    pub(super) fn judge(&self, runs: &[&CaseRun]) -> Result<Vec<Finding>> {
        let stops = |l: &Limitation| matches!(l.shortfall, Shortfall::Stops { .. });
        ensure!(
            runs.len() == 1 || !self.limitation.as_ref().is_some_and(stops),
            "a limitation with `stops` is of one run: `{}`",
            self.words()
        );
        let findings = self.bounds().map(|bound| {
            let mut finding = match self.quantity.as_str() {
                STOPPED => self.count(runs, bound),
                _ => self.worst(runs, bound)?,
            };
            finding.limitation.clone_from(&self.limitation);
            Ok(finding)
        });
        findings.collect()
    }

    /// How many runs stopped, and why the first of them did.
    fn count(&self, runs: &[&CaseRun], bound: Bound) -> Finding {
        let stopped: Vec<_> = runs.iter().filter_map(|r| r.stopped.as_ref()).collect();
        let mut finding = Finding::new(self.words(), stopped.len() as f64, bound);
        finding.remark(stopped.first().map(|stopped| stopped.why.clone()));
        finding
    }

    /// The worst run: one without the number, or the one that is farthest on the wrong side.
    fn worst(&self, runs: &[&CaseRun], bound: Bound) -> Result<Finding> {
        let value = |run: &CaseRun| run.number(&self.quantity);
        let badness = |run: &CaseRun| value(run).map_or(f64::INFINITY, |v| bound.badness(v));
        let worst = runs.iter().max_by(|a, b| badness(a).total_cmp(&badness(b)));
        let worst = worst.expect("there are runs");
        let (found, stopped) = (value(worst), worst.stopped.as_ref());
        let words = self.words();
        ensure!(
            stopped.is_some() || found.is_some(),
            "a run has no number of `{words}`"
        );
        let mut finding = Finding::new(words, found.unwrap_or(f64::NAN), bound);
        finding.stopped = stopped.map(|stopped| stopped.time);
        finding.remark(stopped.map(|stopped| stopped.why.clone()));
        Ok(finding)
    }
}
