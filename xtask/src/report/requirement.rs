//! Requirements: measured numbers with the bounds that the documentation claims. A report that misses one
//! fails, unless the requirement is declared to be missed.

use super::Table;
use crate::failure::ReportError;
use anyhow::Result;
use serde::{Deserialize, Serialize};

/// The relative error of lengths that accepted steps of BDF2 and implicit Euler with rods keep, as the
/// documentation says.
pub(crate) const LENGTHS: f64 = 1e-12;

/// On which side of its bound a measured number has to be.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub(crate) enum Bound {
    AtMost,
    AtLeast,
    Above,
}

impl Bound {
    /// For people.
    pub(crate) fn words(self) -> &'static str {
        match self {
            Self::AtMost => "at most",
            Self::AtLeast => "at least",
            Self::Above => "above",
        }
    }
}

/// A requirement, and what was measured.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub(crate) struct Requirement {
    /// What has to meet it: a model, a method.
    pub(crate) of: String,
    /// What is required, in words, without the bound.
    pub(crate) quantity: String,
    pub(crate) side: Bound,
    pub(crate) bound: f64,
    /// The worst value measured; nothing where a run that it needs did not end.
    pub(crate) measured: Option<f64>,
    /// Why it may be missed: an open limitation, or a number that depends on the machine.
    pub(crate) declared: Option<String>,
}

impl Requirement {
    /// A requirement on the worst of some values, which are missing of runs that did not end; no values at all
    /// are missing, too.
    pub(crate) fn of(
        of: impl Into<String>,
        quantity: impl Into<String>,
        (side, bound): (Bound, f64),
        values: &[Option<f64>],
    ) -> Self {
        let finite = |v: &Option<f64>| v.filter(|v| v.is_finite());
        let known: Option<Vec<f64>> = values.iter().map(finite).collect();
        let worst = match side {
            Bound::AtMost => f64::max,
            Bound::AtLeast | Bound::Above => f64::min,
        };
        Self {
            of: of.into(),
            quantity: quantity.into(),
            side,
            bound,
            measured: known.and_then(|values| values.into_iter().reduce(worst)),
            declared: None,
        }
    }

    /// Whether the requirement is met; a missing value does not meet it.
    pub(crate) fn is_met(&self) -> bool {
        self.measured.is_some_and(|value| match self.side {
            Bound::AtMost => value <= self.bound,
            Bound::AtLeast => value >= self.bound,
            Bound::Above => value > self.bound,
        })
    }

    /// Whether the report fails by it.
    fn fails(&self) -> bool {
        !self.is_met() && self.declared.is_none()
    }

    fn verdict(&self) -> &'static str {
        match (self.is_met(), &self.declared) {
            (true, None) => "yes",
            (true, Some(_)) => "yes, here",
            (false, None) => "NO",
            (false, Some(_)) => "no, as declared",
        }
    }
}

/// The requirements of the parts of a report as a table.
pub(crate) fn requirements(caption: &str, all: &[(String, Requirement)]) -> Table {
    Table::of(
        caption,
        all,
        &[
            ("part", &|(part, _)| part.as_str().into()),
            ("quantity", &|(_, r)| r.quantity.as_str().into()),
            ("of", &|(_, r)| r.of.as_str().into()),
            ("required", &|(_, r)| r.side.words().into()),
            ("bound", &|(_, r)| r.bound.into()),
            ("measured", &|(_, r)| r.measured.into()),
            ("met", &|(_, r)| r.verdict().into()),
            ("declared", &|(_, r)| r.declared.clone().into()),
        ],
    )
    .named("targets")
}

/// # Errors
/// [`ReportError::Missed`] if a requirement is missed that is not declared to be.
pub(crate) fn demand(all: &[(String, Requirement)]) -> Result<()> {
    let missed = all.iter().filter(|(_, r)| r.fails());
    let names: Vec<String> = missed
        .map(|(part, r)| format!("{part}: {} ({})", r.quantity, r.of))
        .collect();
    if names.is_empty() {
        return Ok(());
    }
    let names = names.join(", ");
    Err(ReportError::Missed { names }.into())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_worst_value_decides_and_a_missing_one_fails() {
        let of = |side, values: &[Option<f64>]| Requirement::of("m", "q", (side, 2.0), values);
        let met = |values: &[Option<f64>]| {
            [Bound::AtMost, Bound::AtLeast].map(|side| of(side, values).is_met())
        };
        assert_eq!(met(&[Some(1.0), Some(2.0)]), [true, false]);
        assert_eq!(met(&[Some(2.0), Some(3.0)]), [false, true]);
        assert_eq!(met(&[Some(2.0), None]), [false, false]);
        assert_eq!(met(&[Some(2.0), Some(f64::NAN)]), [false, false]);
        assert_eq!(met(&[]), [false, false]);
        assert!(!of(Bound::Above, &[Some(2.0), Some(3.0)]).is_met());
        let worst = of(Bound::AtMost, &[Some(1.0), Some(5.0)]);
        assert_eq!(worst.measured, Some(5.0));
        let csv = requirements("c", &[("y".into(), worst)]).csv().unwrap();
        let text = String::from_utf8(csv).unwrap();
        assert!(text.ends_with("y,q,m,at most,2,5,NO,\n"), "{text}");
    }

    #[test]
    fn a_missed_requirement_ends_a_report_unless_it_is_declared() {
        let missed = Requirement::of("m", "q", (Bound::AtMost, 2.0), &[Some(3.0)]);
        let declared = Requirement {
            declared: Some("locks".into()),
            ..missed.clone()
        };
        let met = Requirement::of("m", "q", (Bound::AtMost, 2.0), &[Some(1.0)]);
        let all = |list: &[&Requirement]| {
            let named = list.iter().map(|r| ("y".to_owned(), (*r).clone()));
            demand(&named.collect::<Vec<_>>())
        };
        assert!(all(&[&met, &declared]).is_ok());
        let error = all(&[&met, &missed]).unwrap_err();
        assert!(error.to_string().ends_with("y: q (m)"), "{error}");
    }
}
