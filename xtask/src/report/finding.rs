//! Findings: measured numbers with the bounds that the documentation claims. A report whose finding is out of
//! bounds fails, unless that is declared an open limitation; a declaration that is wrong fails it as well.

use super::{Table, number};
use anyhow::{Result, ensure};
use serde::{Deserialize, Serialize};

/// The relative error of lengths that accepted steps of BDF2 and implicit Euler with rods keep, as the
/// documentation says.
pub(crate) const LENGTHS: f64 = 1e-12;

/// Where a measured number has to lie.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub(crate) enum Bound {
    AtMost(f64),
    AtLeast(f64),
    Above(f64),
}

impl Bound {
    fn holds(self, value: f64) -> bool {
        match self {
            Self::AtMost(b) => value <= b,
            Self::AtLeast(b) => value >= b,
            Self::Above(b) => value > b,
        }
    }

    /// How bad a value is: more is worse.
    pub(crate) fn badness(self, value: f64) -> f64 {
        match self {
            Self::AtMost(_) => value,
            Self::AtLeast(_) | Self::Above(_) => -value,
        }
    }

    /// For people.
    pub(crate) fn text(self) -> String {
        match self {
            Self::AtMost(b) => format!("≤ {}", number(b)),
            Self::AtLeast(b) => format!("≥ {}", number(b)),
            Self::Above(b) => format!("> {}", number(b)),
        }
    }

    /// For programs: the kind and the number.
    fn columns(self) -> (&'static str, f64) {
        match self {
            Self::AtMost(b) => ("at_most", b),
            Self::AtLeast(b) => ("at_least", b),
            Self::Above(b) => ("above", b),
        }
    }
}

/// What a finding says.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub(crate) enum Verdict {
    Passed,
    /// Out of bounds, and known to be: an open limitation.
    Limitation,
    /// Out of bounds, but by less than the open limitation declares: the declaration is wrong.
    Improved,
    /// Declared an open limitation, and within its bounds here: the declaration is wrong.
    Cured,
    Failed,
}

impl Verdict {
    /// For people.
    pub(crate) fn text(self) -> &'static str {
        match self {
            Self::Passed => "pass",
            Self::Limitation => "open limitation",
            Self::Cured => "FAIL (cured: remove the declaration)",
            Self::Improved => "FAIL (better than declared: correct the declaration)",
            Self::Failed => "FAIL",
        }
    }

    /// Whether the report fails by it.
    pub(crate) fn is_failure(self) -> bool {
        !matches!(self, Self::Passed | Self::Limitation)
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
    /// It may be anything: it depends on the machine, or on how much the report was asked to do.
    Varies,
}

impl Shortfall {
    /// For people.
    pub(crate) fn text(&self) -> String {
        match self {
            Self::Value([a, b]) => format!("{} to {}", number(*a), number(*b)),
            Self::Stops { at: [a, b], saying } => {
                format!("stops after {} to {} s: “{saying}”", number(*a), number(*b))
            }
            Self::Varies => "varies".into(),
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
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub(crate) struct Finding {
    /// What it is a number of: a model, a method; empty where there is but one.
    pub(crate) of: String,
    /// What was measured, in words, with its unit.
    pub(crate) quantity: String,
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

impl Finding {
    /// A number with its bound.
    pub(crate) fn new(quantity: impl Into<String>, value: f64, bound: Bound) -> Self {
        Self {
            of: String::new(),
            quantity: quantity.into(),
            value: value.is_finite().then_some(value),
            bound,
            limitation: None,
            stopped: None,
            remark: None,
        }
    }

    /// The worst of some numbers of a model or a method, which are missing of runs that did not end; of no
    /// numbers at all it is missing, too.
    pub(crate) fn worst(
        of: impl Into<String>,
        quantity: impl Into<String>,
        bound: Bound,
        values: &[Option<f64>],
    ) -> Self {
        let all: Option<Vec<f64>> = values.iter().copied().collect();
        let worse = |a: f64, b: f64| match bound.badness(a) >= bound.badness(b) || a.is_nan() {
            true => a,
            false => b,
        };
        let worst = all.and_then(|values| values.into_iter().reduce(worse));
        Self {
            of: of.into(),
            ..Self::new(quantity, worst.unwrap_or(f64::NAN), bound)
        }
    }

    /// What it says.
    pub(crate) fn verdict(&self) -> Verdict {
        let holds = self.value.is_some_and(|v| self.bound.holds(v));
        let shortfall = self.limitation.as_ref().map(|l| &l.shortfall);
        match (holds, shortfall) {
            (true, None | Some(Shortfall::Varies)) => Verdict::Passed,
            (true, Some(_)) => Verdict::Cured,
            (false, Some(shortfall)) => self.compare(shortfall),
            (false, None) => Verdict::Failed,
        }
    }

    /// The verdict on a number out of bounds, for which a shortfall is declared.
    fn compare(&self, shortfall: &Shortfall) -> Verdict {
        match shortfall {
            Shortfall::Value(range) => self.value.map_or(Verdict::Failed, |value| {
                place(
                    self.bound.badness(value),
                    range.map(|r| self.bound.badness(r)),
                )
            }),
            Shortfall::Stops { at, saying } => match (self.stopped, &self.remark) {
                (Some(t), Some(remark)) if remark.contains(saying) => place(-t, at.map(|t| -t)),
                _ => Verdict::Failed,
            },
            Shortfall::Varies => Verdict::Limitation,
        }
    }

    /// Declares that the bound is known not to be kept, why, and what happens instead.
    pub(crate) fn limited(&mut self, why: &str, shortfall: Shortfall) -> &mut Self {
        self.limitation = Some(Limitation {
            why: why.to_owned(),
            shortfall,
        });
        self
    }

    /// Adds a remark, such as the error message of a run that was refused.
    pub(crate) fn remark(&mut self, text: Option<String>) -> &mut Self {
        self.remark = text;
        self
    }

    /// What was measured, for people.
    pub(crate) fn measured(&self) -> String {
        match (self.value, &self.remark, self.stopped) {
            (Some(v), ..) => number(v),
            (None, Some(_), Some(t)) => format!("stopped after {} s", number(t)),
            (None, Some(_), None) => "stopped".into(),
            (None, None, _) => "no number".into(),
        }
    }
}

/// Compares a quantity of which less is better with what is declared.
fn place(value: f64, [a, b]: [f64; 2]) -> Verdict {
    if value > a.max(b) {
        Verdict::Failed
    } else if value < a.min(b) {
        Verdict::Improved
    } else {
        Verdict::Limitation
    }
}

/// Findings with the part or the case of a report that each is of, as a table: the same columns in all
/// reports.
pub(crate) fn findings<'a>(
    caption: &str,
    all: impl IntoIterator<Item = (&'a str, &'a Finding)>,
) -> Table {
    let declared = |f: &Finding| f.limitation.clone();
    Table::of(
        caption,
        all,
        &[
            ("case", &|(case, _)| (*case).into()),
            ("of", &|(_, f)| f.of.as_str().into()),
            ("quantity", &|(_, f)| f.quantity.as_str().into()),
            ("value", &|(_, f)| f.value.into()),
            ("bound_kind", &|(_, f)| f.bound.columns().0.into()),
            ("bound", &|(_, f)| f.bound.columns().1.into()),
            ("verdict", &|(_, f)| f.verdict().text().into()),
            ("limitation", &|(_, f)| declared(f).map(|l| l.why).into()),
            ("declared", &|(_, f)| {
                declared(f).map(|l| l.shortfall.text()).into()
            }),
            ("stopped_s", &|(_, f)| f.stopped.into()),
            ("remark", &|(_, f)| f.remark.clone().into()),
        ],
    )
    .named("findings")
}

/// # Errors
/// There is a finding by which the report fails.
pub(crate) fn demand<'a>(all: impl IntoIterator<Item = (&'a str, &'a Finding)>) -> Result<()> {
    let failed = all.into_iter().filter(|(_, f)| f.verdict().is_failure());
    let names: Vec<String> = failed
        .map(|(case, f)| match f.of.as_str() {
            "" => format!("{case}: {}", f.quantity),
            of => format!("{case}: {} ({of})", f.quantity),
        })
        .collect();
    let all = names.join(", ");
    ensure!(
        names.is_empty(),
        "findings are out of bounds, or not out of them as declared: {all}; see the page, or findings.csv"
    );
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;

    fn found(value: f64, bound: Bound) -> Finding {
        Finding::new("q", value, bound)
    }

    #[test]
    fn the_worst_value_decides_and_a_missing_one_fails() {
        let worst = |bound, values: &[Option<f64>]| Finding::worst("m", "q", bound, values);
        let passed = |values: &[Option<f64>]| {
            [Bound::AtMost(2.0), Bound::AtLeast(2.0)]
                .map(|bound| worst(bound, values).verdict() == Verdict::Passed)
        };
        assert_eq!(passed(&[Some(1.0), Some(2.0)]), [true, false]);
        assert_eq!(passed(&[Some(2.0), Some(3.0)]), [false, true]);
        assert_eq!(passed(&[Some(2.0), None]), [false, false]);
        assert_eq!(passed(&[Some(2.0), Some(f64::NAN)]), [false, false]);
        assert_eq!(passed(&[Some(f64::NAN), Some(2.0)]), [false, false]);
        assert_eq!(passed(&[]), [false, false]);
        let touching = worst(Bound::Above(2.0), &[Some(2.0), Some(3.0)]);
        assert_eq!(
            (touching.value, touching.verdict()),
            (Some(2.0), Verdict::Failed)
        );
        let most = worst(Bound::AtMost(2.0), &[Some(1.0), Some(5.0)]);
        let csv = findings("c", [("y", &most)]).csv().unwrap();
        let text = String::from_utf8(csv).unwrap();
        assert!(text.ends_with("y,m,q,5,at_most,2,FAIL,,,,\n"), "{text}");
    }

    #[test]
    fn a_declared_limitation_is_checked_on_both_sides() {
        let verdict = |value, bound| {
            let mut finding = found(value, bound);
            finding.limited("x", Shortfall::Value([3.0, 5.0])).verdict()
        };
        let most = |value| verdict(value, Bound::AtMost(2.0));
        assert_eq!(most(4.0), Verdict::Limitation);
        assert_eq!(most(1.0), Verdict::Cured);
        assert_eq!(most(2.5), Verdict::Improved);
        assert_eq!(most(6.0), Verdict::Failed);
        assert_eq!(most(f64::NAN), Verdict::Failed);
        let least = |value| verdict(value, Bound::AtLeast(9.0));
        assert_eq!(least(4.0), Verdict::Limitation);
        assert_eq!(least(9.0), Verdict::Cured);
        assert_eq!(least(6.0), Verdict::Improved);
        assert_eq!(least(2.0), Verdict::Failed);
    }

    #[test]
    fn a_declared_error_has_to_come_in_its_time() {
        let verdict = |stopped: Option<f64>, value: f64, said: &str| {
            let mut finding = found(value, Bound::AtMost(2.0));
            finding.limited(
                "x",
                Shortfall::Stops {
                    at: [1.0, 2.0],
                    saying: "step size is 0.5 s".to_owned(),
                },
            );
            finding.stopped = stopped;
            finding
                .remark(stopped.map(|_| format!("the {said}")))
                .verdict()
        };
        let (none, right) = (f64::NAN, "step size is 0.5 s");
        assert_eq!(verdict(Some(1.5), none, right), Verdict::Limitation);
        // Too early, later than declared, with another error, not at all.
        assert_eq!(verdict(Some(0.5), none, right), Verdict::Failed);
        assert_eq!(verdict(Some(2.5), none, right), Verdict::Improved);
        assert_eq!(
            verdict(Some(1.5), none, "step size is 0.25 s"),
            Verdict::Failed
        );
        assert_eq!(verdict(None, 1.0, right), Verdict::Cured);
        assert_eq!(verdict(None, 3.0, right), Verdict::Failed);
    }

    #[test]
    fn reports_fail_by_what_is_not_declared_or_wrongly_declared() {
        let [good, missed] = [1.0, 3.0].map(|value| found(value, Bound::AtMost(2.0)));
        let mut varies = missed.clone();
        varies.limited("the machine", Shortfall::Varies);
        assert!(demand([("a", &good), ("b", &varies)]).is_ok());
        let error = demand([("a", &good), ("b", &missed)]).unwrap_err();
        assert!(error.to_string().contains("declared: b: q;"), "{error}");
        let mut cured = good;
        cured.limited("x", Shortfall::Value([3.0, 4.0]));
        assert!(demand([("a", &cured)]).is_err());
    }
}
