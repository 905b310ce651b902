//! What a hard case is, and what is found in it.

use super::file::CaseFile;
use super::scenes::STRAIN;
use crate::draw::Charts;
use crate::report::{Effort, Picture, Section, Table, number};
use crate::runs::Course;
use anyhow::Result;
use serde::{Deserialize, Serialize};

/// A hard case.
pub(crate) struct Case {
    /// Name on the command line.
    pub(crate) name: &'static str,
    pub(crate) title: &'static str,
    /// What should happen.
    pub(crate) expected: &'static str,
    /// What is done.
    pub(crate) run: Work,
}

/// What is done in a case.
#[derive(Clone, Copy)]
pub(crate) enum Work {
    /// Whatever the function does.
    Code(fn(&mut Findings, Effort) -> Result<()>),
    /// What a file says.
    File(&'static CaseFile),
}

impl Case {
    /// Runs it.
    pub(super) fn find(&self, found: &mut Findings, effort: Effort) -> Result<()> {
        match self.run {
            Work::Code(work) => work(found, effort),
            Work::File(file) => file.run(found, effort),
        }
    }
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
    /// Declared an open limitation, and within its bounds here: the declaration is wrong.
    Cured,
    /// Out of bounds, but by less than the open limitation declares: the declaration is wrong.
    Improved,
    Failed,
}

impl Verdict {
    /// For people.
    pub(super) fn text(self) -> &'static str {
        match self {
            Self::Passed => "pass",
            Self::Limitation => "open limitation",
            Self::Cured => "FAIL (cured: remove the declaration)",
            Self::Improved => "FAIL (better than declared: correct the declaration)",
            Self::Failed => "FAIL",
        }
    }

    /// Whether the report fails by it.
    pub(super) fn is_failure(self) -> bool {
        match self {
            Self::Passed | Self::Limitation => false,
            Self::Cured | Self::Improved | Self::Failed => true,
        }
    }
}

/// What an open limitation does, instead of keeping the bound.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub(crate) enum Shortfall {
    /// The number lies between these two, outside of its bound.
    #[serde(rename = "between")]
    Value([f64; 2]),
    /// The run stops between these two times, seconds.
    Stops {
        at: [f64; 2],
        /// Part of the error message.
        saying: String,
    },
}

impl Shortfall {
    /// A run that stops between two times, seconds, with an error message that holds the given text.
    pub(super) fn stops(at: [f64; 2], saying: &str) -> Self {
        Self::Stops {
            at,
            saying: saying.to_owned(),
        }
    }

    /// For people.
    pub(super) fn text(&self) -> String {
        match self {
            Self::Value([a, b]) => format!("{} to {}", number(*a), number(*b)),
            Self::Stops { at: [a, b], saying } => {
                format!("stops after {} to {} s: “{saying}”", number(*a), number(*b))
            }
        }
    }
}

/// An open limitation: a bound that is known not to be kept.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub(crate) struct Limitation {
    /// Why.
    pub(crate) why: String,
    /// What happens instead.
    #[serde(flatten)]
    pub(crate) shortfall: Shortfall,
}

/// A measured number and its bound.
#[derive(Clone, Debug, Serialize, Deserialize)]
pub(crate) struct Check {
    pub(crate) what: String,
    /// The number; `None` when the run did not get so far or it is not finite.
    pub(crate) value: Option<f64>,
    pub(crate) bound: Bound,
    /// Set if the bound is known not to be kept.
    pub(crate) limitation: Option<Limitation>,
    /// When the run ended early, seconds.
    pub(crate) stopped: Option<f64>,
    /// What was said instead of a number.
    pub(crate) remark: Option<String>,
}

impl Check {
    pub(super) fn verdict(&self) -> Verdict {
        let holds = self.value.is_some_and(|v| self.bound.holds(v));
        match (holds, &self.limitation) {
            (true, None) => Verdict::Passed,
            (true, Some(_)) => Verdict::Cured,
            (false, Some(limitation)) => self.compare(&limitation.shortfall),
            (false, None) => Verdict::Failed,
        }
    }

    /// The verdict on a check out of bounds, for which a shortfall is declared.
    fn compare(&self, shortfall: &Shortfall) -> Verdict {
        match shortfall {
            Shortfall::Value(range) => match (self.value, self.bound) {
                (Some(v), Bound::AtMost(_)) => place(-v, range.map(|r| -r)),
                (Some(v), Bound::AtLeast(_)) => place(v, *range),
                (None, _) => Verdict::Failed,
            },
            Shortfall::Stops { at, saying } => match (self.stopped, &self.remark) {
                (Some(t), Some(remark)) if remark.contains(saying) => place(t, *at),
                _ => Verdict::Failed,
            },
        }
    }
}

/// Compares a quantity of which more is better with what is declared.
fn place(value: f64, [a, b]: [f64; 2]) -> Verdict {
    if value < a.min(b) {
        Verdict::Failed
    } else if value > a.max(b) {
        Verdict::Improved
    } else {
        Verdict::Limitation
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
    /// What a naive method did, and whether it failed.
    pub(super) fn naive(&mut self, method: &str, outcome: impl Into<String>, failed: bool) {
        self.naive.push(Naive {
            method: method.to_owned(),
            outcome: outcome.into(),
            failed,
        });
    }

    /// What a naive method did that may break down, which is a failure.
    pub(super) fn naive_run<T>(
        &mut self,
        method: &str,
        outcome: Result<T, String>,
        judge: impl FnOnce(T) -> (String, bool),
    ) {
        let (text, failed) = outcome.map_or_else(|e| (format!("{e}."), true), judge);
        self.naive(method, text, failed);
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

    pub(super) fn check(&mut self, what: String, value: f64, bound: Bound) -> &mut Check {
        let at = self.checks.len();
        self.checks.push(Check {
            what,
            value: value.is_finite().then_some(value),
            bound,
            limitation: None,
            stopped: None,
            remark: None,
        });
        &mut self.checks[at]
    }

    /// Numbers of a run, which are none if it ended early; `what` says which run.
    pub(super) fn of<'a>(&'a mut self, course: &'a Course, what: impl Into<String>) -> Judge<'a> {
        Judge {
            findings: self,
            course,
            what: what.into(),
        }
    }

    /// Charts.
    pub(super) fn drawing(&mut self, file: &str, drawing: &Charts, alt: &str) {
        self.pictures.push(Picture::svg(file, drawing, alt));
    }
}

/// Judges the numbers of a run.
pub(super) struct Judge<'a> {
    findings: &'a mut Findings,
    course: &'a Course,
    what: String,
}

impl Judge<'_> {
    /// A number with an upper bound.
    pub(super) fn at_most(&mut self, quantity: &str, value: f64, bound: f64) -> &mut Check {
        self.check(quantity, value, Bound::AtMost(bound))
    }

    /// A number with a lower bound.
    pub(super) fn at_least(&mut self, quantity: &str, value: f64, bound: f64) -> &mut Check {
        self.check(quantity, value, Bound::AtLeast(bound))
    }

    /// The largest edge strain of the run, bounded by [`STRAIN`].
    pub(super) fn strain(&mut self, quantity: &str) -> &mut Check {
        self.at_most(quantity, self.course.strain, STRAIN)
    }

    fn check(&mut self, quantity: &str, value: f64, bound: Bound) -> &mut Check {
        let (what, value) = (
            format!("{}: {quantity}", self.what),
            self.course.if_good(value),
        );
        self.findings.check(what, value, bound).ended(self.course)
    }
}

impl Check {
    /// Declares that the bound is known not to be kept, why, and what happens instead.
    pub(super) fn limited(&mut self, why: &str, shortfall: Shortfall) -> &mut Self {
        self.limitation = Some(Limitation {
            why: why.to_owned(),
            shortfall,
        });
        self
    }

    /// Notes when and why the run ended, if it did so early.
    pub(super) fn ended(&mut self, course: &Course) -> &mut Self {
        self.remark = course.failure();
        self.stopped = self.remark.as_ref().map(|_| course.time);
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
    pub(crate) section: Section,
    pub(crate) naive: Vec<Naive>,
    pub(crate) checks: Vec<Check>,
    /// Wall time, seconds.
    pub(crate) wall: f64,
}

impl Record {
    /// The worst verdict of the checks.
    pub(super) fn verdict(&self) -> Verdict {
        let has = |v| self.checks.iter().any(|c| c.verdict() == v);
        [
            Verdict::Failed,
            Verdict::Cured,
            Verdict::Improved,
            Verdict::Limitation,
        ]
        .into_iter()
        .find(|v| has(*v))
        .unwrap_or(Verdict::Passed)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::runs::Ending;

    #[test]
    fn verdicts() {
        let mut f = Findings::default();
        assert_eq!(f.at_most("a", 1.0, 2.0).verdict(), Verdict::Passed);
        assert_eq!(f.at_most("b", f64::NAN, 2.0).verdict(), Verdict::Failed);
        assert_eq!(f.at_least("c", 1.0, 2.0).verdict(), Verdict::Failed);
    }

    #[test]
    fn a_declared_limitation_is_checked_on_both_sides() {
        let mut f = Findings::default();
        let declared = Shortfall::Value([3.0, 5.0]);
        let mut most = |v| {
            f.at_most("a", v, 2.0)
                .limited("x", declared.clone())
                .verdict()
        };
        assert_eq!(most(4.0), Verdict::Limitation);
        assert_eq!(most(1.0), Verdict::Cured);
        assert_eq!(most(2.5), Verdict::Improved);
        assert_eq!(most(6.0), Verdict::Failed);
        assert_eq!(most(f64::NAN), Verdict::Failed);
        let mut least = |v| {
            f.at_least("b", v, 9.0)
                .limited("x", declared.clone())
                .verdict()
        };
        assert_eq!(least(4.0), Verdict::Limitation);
        assert_eq!(least(9.0), Verdict::Cured);
        assert_eq!(least(6.0), Verdict::Improved);
        assert_eq!(least(2.0), Verdict::Failed);
        let failures = [
            (Verdict::Passed, false),
            (Verdict::Limitation, false),
            (Verdict::Cured, true),
            (Verdict::Improved, true),
            (Verdict::Failed, true),
        ];
        for (verdict, fails) in failures {
            assert_eq!(verdict.is_failure(), fails, "{verdict:?}");
        }
    }

    #[test]
    fn a_declared_error_has_to_come_in_its_time() {
        let mut f = Findings::default();
        let declared = Shortfall::stops([1.0, 2.0], "step size is 0.5 s");
        let mut stopped = |t: Option<f64>, value: f64, h: f64| {
            let error = |_| Ending::Error {
                kind: "StepSize".into(),
                message: format!("the step size is {h} s"),
            };
            let course = Course {
                time: t.unwrap_or(3.0),
                ending: t.map_or(Ending::Complete, error),
                ..Course::default()
            };
            let check = f.at_most("a", value, 2.0);
            check
                .limited("x", declared.clone())
                .ended(&course)
                .verdict()
        };
        let none = f64::NAN;
        assert_eq!(stopped(Some(1.5), none, 0.5), Verdict::Limitation);
        // Too early, later than declared, with another error, not at all.
        assert_eq!(stopped(Some(0.5), none, 0.5), Verdict::Failed);
        assert_eq!(stopped(Some(2.5), none, 0.5), Verdict::Improved);
        assert_eq!(stopped(Some(1.5), none, 0.25), Verdict::Failed);
        assert_eq!(stopped(None, 1.0, 0.5), Verdict::Cured);
        assert_eq!(stopped(None, 3.0, 0.5), Verdict::Failed);
    }
}
