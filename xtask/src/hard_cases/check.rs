//! The bounds of a case.

use super::case::CaseRun;
use super::variants::Variants;
use crate::report::{Bound, Finding, Limitation, Shortfall};
use anyhow::{Result, bail, ensure};
use isosheet_runs::Summary;
use serde::{Deserialize, Serialize};
use std::collections::BTreeMap;

/// What is bounded: a number of each run, of which the worst counts, or of all runs together.
#[derive(Clone, Debug, PartialEq, Deserialize, Serialize)]
#[serde(rename_all = "snake_case")]
enum CaseQuantity {
    /// Runs that stop before their end.
    Stopped,
    LargestStrain,
    /// Metres.
    SmallestGap,
    /// Metres.
    LargestDisplacement,
    Steps,
    Rejected,
    #[serde(rename = "energy.least_potential")]
    LeastPotential,
    #[serde(rename = "energy.relative_error")]
    EnergyError,
    #[serde(rename = "energy.relative_gain")]
    EnergyGain,
    #[serde(rename = "ending.largest_speed")]
    SpeedAtEnd,
    /// A measure of the scene at the end, metres.
    Measure(String),
}

/// A bound, or two.
#[derive(Clone, Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct Check {
    quantity: CaseQuantity,
    /// The runs that it is for, by values of variants; all if left out.
    #[serde(default)]
    only: BTreeMap<String, toml::Value>,
    at_most: Option<f64>,
    at_least: Option<f64>,
    limitation: Option<Limitation>,
}

impl CaseQuantity {
    /// Of a run that came to its end. Nothing if the scene has no such measure.
    fn of(&self, summary: &Summary) -> Option<f64> {
        Some(match self {
            Self::Stopped => 0.0,
            Self::LargestStrain => summary.largest_strain,
            Self::SmallestGap => return summary.smallest_gap,
            Self::LargestDisplacement => summary.largest_displacement,
            Self::Steps => summary.steps as f64,
            Self::Rejected => summary.rejected as f64,
            Self::LeastPotential => summary.energy.least_potential,
            Self::EnergyError => summary.energy.relative_error?,
            Self::EnergyGain => summary.energy.relative_gain?,
            Self::SpeedAtEnd => summary.ending.largest_speed,
            Self::Measure(name) => summary.measures.get(name)?.last,
        })
    }

    /// Of a run that may have stopped early.
    fn of_run(&self, run: &CaseRun) -> Option<f64> {
        match (self, &run.outcome) {
            (Self::LargestStrain, _) => Some(run.largest_strain()),
            (Self::SmallestGap, _) => run.smallest_gap(),
            (_, Ok(summary)) => self.of(summary),
            (_, Err(_)) => None,
        }
    }
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
        let mut values = [self.at_most, self.at_least].into_iter().flatten();
        ensure!(
            values.all(f64::is_finite),
            "a bound of `{words}` is not finite"
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
                "the limitation of `{words}` ends before it begins"
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
        match &self.quantity {
            CaseQuantity::Stopped => format!("{runs}: number that stop early"),
            CaseQuantity::Measure(name) => format!("{runs}: measure {name} at the end, m"),
            quantity => {
                let name = serde_json::to_value(quantity).unwrap_or_default();
                format!("{runs}: {}", name.as_str().unwrap_or_default())
            }
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
            let mut finding = match self.quantity {
                CaseQuantity::Stopped => self.count(runs, bound),
                _ => self.worst(runs, bound)?,
            };
            finding.limitation.clone_from(&self.limitation);
            Ok(finding)
        });
        findings.collect()
    }

    /// How many runs stopped, and why the first of them did.
    fn count(&self, runs: &[&CaseRun], bound: Bound) -> Finding {
        let stopped: Vec<_> = runs
            .iter()
            .filter_map(|r| r.outcome.as_ref().err())
            .collect();
        let mut finding = Finding::new(self.words(), stopped.len() as f64, bound);
        finding.remark(stopped.first().map(|stopped| stopped.why.clone()));
        finding
    }

    /// The worst run: one without the number, or the one that is farthest on the wrong side.
    fn worst(&self, runs: &[&CaseRun], bound: Bound) -> Result<Finding> {
        let value = |run: &CaseRun| self.quantity.of_run(run);
        let badness = |run: &CaseRun| value(run).map_or(f64::INFINITY, |v| bound.badness(v));
        let worst = runs.iter().max_by(|a, b| badness(a).total_cmp(&badness(b)));
        let worst = worst.expect("there are runs");
        let (found, stopped) = (value(worst), worst.outcome.as_ref().err());
        if stopped.is_none() && found.is_none() {
            bail!("a run has no number of `{}`", self.words());
        }
        let mut finding = Finding::new(self.words(), found.unwrap_or(f64::NAN), bound);
        finding.stopped = stopped.map(|stopped| stopped.time);
        finding.remark(stopped.map(|stopped| stopped.why.clone()));
        Ok(finding)
    }
}
