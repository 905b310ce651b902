//! What a hard case is, and what is found in it.

use crate::draw::Drawing;
use crate::figures::{Picture, PictureRef, Table};
use anyhow::Result;
use serde::{Deserialize, Serialize};

/// How much work to put in.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub(crate) enum Effort {
    /// Seconds.
    Quick,
    /// Minutes.
    Standard,
    /// As long as it takes.
    Full,
}

impl Effort {
    /// The value for this effort.
    pub(super) fn pick<T>(self, quick: T, standard: T, full: T) -> T {
        match self {
            Self::Quick => quick,
            Self::Standard => standard,
            Self::Full => full,
        }
    }
}

/// A hard case.
pub(crate) struct Case {
    /// Name on the command line.
    pub(crate) name: &'static str,
    pub(crate) title: &'static str,
    /// What should happen.
    pub(crate) expected: &'static str,
    /// Runs it.
    pub(crate) run: fn(Effort) -> Result<Findings>,
}

impl std::fmt::Debug for Case {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.write_str(self.name)
    }
}

/// Where a measured number has to lie.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub(crate) enum Bound {
    AtMost(f64),
    AtLeast(f64),
}

impl Bound {
    fn holds(self, value: f64) -> bool {
        match self {
            Self::AtMost(b) => value <= b,
            Self::AtLeast(b) => value >= b,
        }
    }

    /// For people.
    pub(super) fn text(self) -> String {
        match self {
            Self::AtMost(b) => format!("≤ {}", number(b)),
            Self::AtLeast(b) => format!("≥ {}", number(b)),
        }
    }
}

/// How a check ended.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub(crate) enum Verdict {
    Passed,
    /// Out of bounds, and known to be: an open limitation.
    Limitation,
    /// Declared an open limitation, and within its bounds here.
    Cured,
    Failed,
}

impl Verdict {
    /// For people.
    pub(super) fn text(self) -> &'static str {
        match self {
            Self::Passed => "pass",
            Self::Limitation => "open limitation",
            Self::Cured => "pass, though declared a limitation",
            Self::Failed => "FAIL",
        }
    }
}

/// A measured number and its bound.
#[derive(Clone, Debug, Serialize, Deserialize)]
pub(crate) struct Check {
    pub(crate) what: String,
    /// The number; `None` when the run did not get so far or it is not finite.
    pub(crate) value: Option<f64>,
    pub(crate) bound: Bound,
    /// Why it is known to fail, for an open limitation.
    pub(crate) limitation: Option<String>,
    /// What was said instead of a number.
    pub(crate) remark: Option<String>,
}

impl Check {
    pub(super) fn verdict(&self) -> Verdict {
        let holds = self.value.is_some_and(|v| self.bound.holds(v));
        match (holds, &self.limitation) {
            (true, None) => Verdict::Passed,
            (true, Some(_)) => Verdict::Cured,
            (false, Some(_)) => Verdict::Limitation,
            (false, None) => Verdict::Failed,
        }
    }
}

/// What a naive method did.
#[derive(Clone, Debug, Serialize, Deserialize)]
pub(crate) struct Naive {
    pub(crate) method: String,
    pub(crate) outcome: String,
    /// Whether it failed.
    pub(crate) failed: bool,
}

/// What was found in a case.
#[derive(Clone, Debug, Default)]
pub(crate) struct Findings {
    pub(crate) naive: Vec<Naive>,
    pub(crate) here: String,
    pub(crate) checks: Vec<Check>,
    pub(crate) pictures: Vec<Picture>,
    pub(crate) tables: Vec<Table>,
}

impl Findings {
    /// What a naive method did.
    pub(super) fn naive(
        &mut self,
        method: &str,
        outcome: impl Into<String>,
        failed: bool,
    ) -> &mut Self {
        self.naive.push(Naive {
            method: method.to_owned(),
            outcome: outcome.into(),
            failed,
        });
        self
    }

    /// A number with an upper bound.
    pub(super) fn at_most(
        &mut self,
        what: impl Into<String>,
        value: f64,
        bound: f64,
    ) -> &mut Check {
        self.check(what.into(), value, Bound::AtMost(bound))
    }

    /// A number with a lower bound.
    pub(super) fn at_least(
        &mut self,
        what: impl Into<String>,
        value: f64,
        bound: f64,
    ) -> &mut Check {
        self.check(what.into(), value, Bound::AtLeast(bound))
    }

    fn check(&mut self, what: String, value: f64, bound: Bound) -> &mut Check {
        let at = self.checks.len();
        self.checks.push(Check {
            what,
            value: value.is_finite().then_some(value),
            bound,
            limitation: None,
            remark: None,
        });
        &mut self.checks[at]
    }

    /// A drawing.
    pub(super) fn drawing(&mut self, file: &str, drawing: &Drawing, alt: &str) -> Result<()> {
        self.pictures.push(Picture {
            file: format!("{file}.svg"),
            alt: alt.to_owned(),
            bytes: drawing.to_svg(alt)?.into_bytes(),
        });
        Ok(())
    }

    /// A table.
    pub(super) fn table(&mut self, caption: &str, head: &[&str], rows: Vec<Vec<String>>) {
        self.tables.push(Table {
            caption: caption.to_owned(),
            head: head.iter().map(|h| (*h).to_owned()).collect(),
            rows,
        });
    }
}

impl Check {
    /// Declares that this is known to fail, and why.
    pub(super) fn limited(&mut self, why: &str) -> &mut Self {
        self.limitation = Some(why.to_owned());
        self
    }

    /// Adds a remark, such as the error message of a run that was refused.
    pub(super) fn remark(&mut self, text: Option<String>) -> &mut Self {
        self.remark = text;
        self
    }
}

/// What is kept about a case.
#[derive(Clone, Debug, Serialize, Deserialize)]
pub(crate) struct Record {
    pub(crate) name: String,
    pub(crate) title: String,
    pub(crate) expected: String,
    pub(crate) naive: Vec<Naive>,
    pub(crate) here: String,
    pub(crate) checks: Vec<Check>,
    pub(crate) pictures: Vec<PictureRef>,
    pub(crate) tables: Vec<Table>,
    /// Wall time, seconds.
    pub(crate) wall: f64,
}

impl Record {
    /// The worst verdict of the checks.
    pub(super) fn verdict(&self) -> Verdict {
        let has = |v| self.checks.iter().any(|c| c.verdict() == v);
        [Verdict::Failed, Verdict::Limitation, Verdict::Cured]
            .into_iter()
            .find(|v| has(*v))
            .unwrap_or(Verdict::Passed)
    }
}

/// A number for people, with two or three digits.
pub(super) fn number(v: f64) -> String {
    if v == 0.0 {
        "0".into()
    } else if (0.01..10_000.0).contains(&v.abs()) {
        let digits = (2 - v.abs().log10().floor() as i32).clamp(0, 4) as usize;
        let text = format!("{v:.digits$}");
        if text.contains('.') {
            text.trim_end_matches('0').trim_end_matches('.').to_owned()
        } else {
            text
        }
    } else {
        format!("{v:.1e}")
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn verdicts_and_numbers() {
        let mut f = Findings::default();
        assert_eq!(f.at_most("a", 1.0, 2.0).verdict(), Verdict::Passed);
        assert_eq!(f.at_most("b", f64::NAN, 2.0).verdict(), Verdict::Failed);
        assert_eq!(f.at_least("c", 1.0, 2.0).verdict(), Verdict::Failed);
        assert_eq!(
            f.at_least("c", 1.0, 2.0).limited("x").verdict(),
            Verdict::Limitation
        );
        assert_eq!(
            f.at_least("d", 3.0, 2.0).limited("x").verdict(),
            Verdict::Cured
        );
        assert_eq!(
            [0.0, 12.0, 0.25, 1e-12, 123456.0].map(number),
            ["0", "12", "0.25", "1.0e-12", "1.2e5"]
        );
    }
}
