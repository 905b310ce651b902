//! What is wrong with a scene, and where.

use crate::words::key::Key;
use crate::words::unit::Unit;
use crate::words::warning::Warning;
use isosheet_mesh::Advice;
use isosheet_mesh::wording::given;
use std::fmt;
use std::ops::Range;

/// Something that is wrong with a scene. Shown as key and message, without the remedy.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Problem {
    /// Where, as far as known.
    pub key: Key,
    /// What is wrong.
    pub message: String,
    /// What to do about it.
    pub remedy: Option<String>,
    /// The bytes of the text that are to blame, where the key alone does not say it.
    pub span: Option<Range<usize>>,
}

impl Problem {
    /// A problem at a key.
    pub fn new(key: Key, message: impl Into<String>, remedy: impl Into<String>) -> Self {
        Self {
            key,
            message: message.into(),
            remedy: Some(remedy.into()),
            span: None,
        }
    }

    /// A problem that another error describes; its advice is the remedy.
    pub(crate) fn from_error(key: Key, error: &impl Advice) -> Self {
        Self {
            key,
            message: error.to_string(),
            remedy: error.advice().map(str::to_owned),
            span: None,
        }
    }
}

impl fmt::Display for Problem {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        if !self.key.parts().is_empty() {
            write!(f, "{}: ", self.key)?;
        }
        f.write_str(&self.message)
    }
}

/// A number with its unit, if it has one.
fn quantity(value: f64, unit: Unit) -> String {
    format!("{} {}", given(value), unit.symbol())
        .trim_end()
        .to_owned()
}

/// A remedy that names the unit, if there is one.
fn in_unit(remedy: &str, unit: Unit) -> String {
    match unit.symbol() {
        "" => remedy.to_owned(),
        symbol => format!("{remedy}, in {symbol}"),
    }
}

/// Collects all range errors of a scene.
#[derive(Debug, Default)]
pub(crate) struct Checks {
    pub(crate) problems: Vec<Problem>,
    /// Numbers that no sheet of this world has.
    pub(crate) doubts: Vec<Warning>,
}

impl Checks {
    pub(crate) fn report(
        &mut self,
        key: Key,
        message: impl Into<String>,
        remedy: impl Into<String>,
    ) {
        self.problems.push(Problem::new(key, message, remedy));
    }

    /// A number above zero, in the range of its unit, if there is one.
    pub(crate) fn positive(&mut self, key: Key, value: impl Into<Option<f64>>, unit: Unit) {
        let Some(value) = value.into() else {
            return;
        };
        if value.is_finite() && value > 0.0 {
            let least = unit.range().least;
            return self.in_range(key, value, least, unit);
        }
        let value = quantity(value, unit);
        let message = format!("`{key}` is {value}, which is not a positive number");
        self.report(key, message, in_unit("give a number above 0", unit));
    }

    /// A number of at least zero, in the range of its unit, if there is one.
    pub(crate) fn not_negative(&mut self, key: Key, value: impl Into<Option<f64>>, unit: Unit) {
        let Some(value) = value.into() else {
            return;
        };
        if value.is_finite() && value >= 0.0 {
            return self.in_range(key, value, 0.0, unit);
        }
        let value = quantity(value, unit);
        let message = format!("`{key}` is {value}, which is less than 0 or not finite");
        self.report(key, message, in_unit("give 0 or a positive number", unit));
    }

    /// A finite number whose size is between `least` and the most of its unit.
    fn in_range(&mut self, key: Key, value: f64, least: f64, unit: Unit) {
        let range = unit.range();
        if (least..=range.most).contains(&value.abs()) {
            return self.question(&key, value, unit);
        }
        let sign = if value < 0.0 { "-" } else { "" };
        let (bound, side) = match value.abs() > range.most {
            true => (range.most, "at most"),
            false => (least, "at least"),
        };
        let message = format!(
            "`{key}` is {}, which is out of range",
            quantity(value, unit)
        );
        let remedy = in_unit(&format!("give {side} {sign}{}", given(bound)), unit);
        self.report(key, message, format!("{remedy}: {}", range.reason));
    }

    /// Questions a number that is larger than numbers of its unit usually are.
    fn question(&mut self, key: &Key, value: f64, unit: Unit) {
        let Some(usual) = unit.range().usual else {
            return;
        };
        if value.abs() > usual.most {
            let message = format!(
                "`{key}` is {}, which is hardly meant: {}",
                quantity(value, unit),
                usual.compare
            );
            self.doubts.push(Warning::new(
                message,
                "give it in the unit that the message has",
            ));
        }
    }

    /// A number from `least` to `most`, if there is one.
    pub(crate) fn within(
        &mut self,
        key: Key,
        value: impl Into<Option<f64>>,
        [least, most]: [f64; 2],
    ) {
        if let Some(value) = value.into().filter(|v| !(least..=most).contains(v)) {
            let message = format!("`{key}` is {}, which is out of range", given(value));
            let remedy = format!("give a number from {} to {}", given(least), given(most));
            self.report(key, message, remedy);
        }
    }

    /// A whole number of at least `least`, and not above the largest one of TOML.
    pub(crate) fn count(
        &mut self,
        key: Key,
        value: impl TryInto<i64> + Copy + fmt::Display,
        least: i64,
    ) {
        let remedy = match value.try_into() {
            Ok(whole) if whole >= least => return,
            Ok(_) => format!("give at least {least}"),
            Err(_) => format!("give at most {}", i64::MAX),
        };
        self.report(key.clone(), format!("`{key}` is {value}"), remedy);
    }

    /// A finite number that is not above the range of its unit.
    pub(crate) fn number(&mut self, key: Key, value: f64, unit: Unit) {
        if value.is_finite() {
            return self.in_range(key, value, 0.0, unit);
        }
        let message = format!("`{key}` is {}", given(value));
        self.report(key, message, "give a finite number");
    }

    /// Finite components that are not above the range of their unit.
    pub(crate) fn finite(&mut self, key: Key, vector: &[f64], unit: Unit) {
        if let Some((k, value)) = vector.iter().enumerate().find(|(_, c)| !c.is_finite()) {
            let message = format!("`{key}` has the component {}", given(*value));
            return self.report(key.entry(k), message, "give finite numbers");
        }
        for (k, value) in vector.iter().enumerate() {
            self.in_range(key.entry(k), *value, 0.0, unit);
        }
    }

    /// Points with finite coordinates, metres.
    pub(crate) fn points<const N: usize>(&mut self, key: Key, points: &[[f64; N]]) {
        for (key, point) in key.entries(points) {
            self.finite(key, point, Unit::Metre);
        }
    }

    /// A line between two different points, metres.
    pub(crate) fn line(&mut self, key: &Key, from: &[f64; 3], to: &[f64; 3]) {
        self.finite(key.name("from"), from, Unit::Metre);
        self.finite(key.name("to"), to, Unit::Metre);
        if from == to {
            let message = "the line begins where it ends";
            self.report(key.name("to"), message, "give two different points");
        }
    }

    /// Finite components that are not all zero.
    pub(crate) fn direction(&mut self, key: Key, vector: &[f64; 3]) {
        let length2: f64 = vector.iter().map(|c| c * c).sum();
        if let Some((k, value)) = vector.iter().enumerate().find(|(_, c)| !c.is_finite()) {
            let message = format!("`{key}` has the component {}", given(*value));
            self.report(key.entry(k), message, "give finite numbers");
        } else if !length2.is_normal() {
            let message =
                format!("`{key}` has no direction: its length is zero, or its square out of range");
            self.report(key, message, "give a vector of about unit length");
        }
    }
}
