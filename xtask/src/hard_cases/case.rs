//! What a hard case is, and what is found in it.

use super::file::CaseFile;
use super::scenes::STRAIN;
use crate::draw::Charts;
use crate::report::{Bound, Effort, Finding, Picture, Section, Table, Verdict};
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

/// Finds what there is to be found in a case, or a part of it.
pub(crate) type Code = fn(&mut Findings, Effort) -> Result<()>;

/// What is done in a case.
#[derive(Clone, Copy)]
pub(crate) enum Work {
    /// Whatever the function does.
    Code(Code),
    /// What a file says, and what a function adds to it: naive methods, closed forms, pictures.
    File(&'static CaseFile, Option<Code>),
}

impl Case {
    /// Runs it.
    pub(super) fn find(&self, found: &mut Findings, effort: Effort) -> Result<()> {
        match self.run {
            Work::Code(work) => work(found, effort),
            Work::File(file, beside) => {
                file.run(found, effort)?;
                beside.map_or(Ok(()), |code| code(found, effort))
            }
        }
    }
}

impl std::fmt::Debug for Case {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.write_str(self.name)
    }
}

/// What a naive method did.
#[derive(Clone, Debug, Serialize, Deserialize)]
pub(crate) struct Naive {
    pub(crate) method: String,
    /// What was measured, and the bound beyond which the method has failed.
    pub(crate) finding: Finding,
}

impl Naive {
    pub(super) fn failed(&self) -> bool {
        self.finding.verdict() != Verdict::Passed
    }
}

/// What was found in a case.
#[derive(Clone, Debug, Default)]
pub(crate) struct Findings {
    pub(crate) naive: Vec<Naive>,
    pub(crate) here: &'static str,
    pub(crate) checks: Vec<Finding>,
    pub(crate) pictures: Vec<Picture>,
    pub(crate) tables: Vec<Table>,
}

impl Findings {
    /// What a naive method did: a number, and the bound beyond which the method has failed.
    pub(super) fn naive(
        &mut self,
        method: &str,
        quantity: impl Into<String>,
        value: f64,
        bound: Bound,
    ) -> &mut Finding {
        let at = self.naive.len();
        self.naive.push(Naive {
            method: method.to_owned(),
            finding: Finding::new(quantity, value, bound),
        });
        &mut self.naive[at].finding
    }

    /// What a naive method did that may break down, which is a failure.
    pub(super) fn naive_run(
        &mut self,
        method: &str,
        quantity: impl Into<String>,
        outcome: Result<f64, String>,
        bound: Bound,
    ) {
        let value = outcome.as_ref().copied().unwrap_or(f64::NAN);
        let finding = self.naive(method, quantity, value, bound);
        finding.remark(outcome.err());
    }

    /// A number with an upper bound.
    pub(super) fn at_most(
        &mut self,
        what: impl Into<String>,
        value: f64,
        bound: f64,
    ) -> &mut Finding {
        self.check(what.into(), value, Bound::AtMost(bound))
    }

    /// A number with a lower bound.
    pub(super) fn at_least(
        &mut self,
        what: impl Into<String>,
        value: f64,
        bound: f64,
    ) -> &mut Finding {
        self.check(what.into(), value, Bound::AtLeast(bound))
    }

    pub(super) fn check(&mut self, what: String, value: f64, bound: Bound) -> &mut Finding {
        let at = self.checks.len();
        self.checks.push(Finding::new(what, value, bound));
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
    pub(super) fn at_most(&mut self, quantity: &str, value: f64, bound: f64) -> &mut Finding {
        self.check(quantity, value, Bound::AtMost(bound))
    }

    /// A number with a lower bound.
    pub(super) fn at_least(&mut self, quantity: &str, value: f64, bound: f64) -> &mut Finding {
        self.check(quantity, value, Bound::AtLeast(bound))
    }

    /// The largest edge strain of the run, bounded by [`STRAIN`].
    pub(super) fn strain(&mut self, quantity: &str) -> &mut Finding {
        self.at_most(quantity, self.course.strain, STRAIN)
    }

    fn check(&mut self, quantity: &str, value: f64, bound: Bound) -> &mut Finding {
        let (what, value) = (
            format!("{}: {quantity}", self.what),
            self.course.if_good(value),
        );
        self.findings.check(what, value, bound).ended(self.course)
    }
}

impl Finding {
    /// Notes when and why the run ended, if it did so early.
    pub(super) fn ended(&mut self, course: &Course) -> &mut Self {
        self.stopped = course.failure().map(|_| course.time);
        self.remark(course.failure())
    }
}

/// What is kept about a case.
#[derive(Clone, Debug, Serialize, Deserialize)]
pub(crate) struct Record {
    pub(crate) name: String,
    pub(crate) title: String,
    pub(crate) section: Section,
    pub(crate) naive: Vec<Naive>,
    pub(crate) checks: Vec<Finding>,
    /// Wall time, seconds.
    pub(crate) wall: f64,
}

impl Record {
    /// The worst verdict of the checks.
    pub(super) fn verdict(&self) -> Verdict {
        let verdicts = self.checks.iter().map(Finding::verdict);
        verdicts.max().unwrap_or(Verdict::Passed)
    }
}
