//! When what holds is taken up and released.

use crate::measures::measure::Measure;
use crate::words::key::Key;
use crate::words::part::Part;
use crate::words::problem::Checks;
use crate::words::unit::Unit;
use isosheet_mesh::wording::given;
use schemars::JsonSchema;
use serde::de::value::MapAccessDeserializer;
use serde::de::{MapAccess, Visitor};
use serde::{Deserialize, Deserializer, Serialize};
use std::fmt;

/// When something is taken up or released: a time in seconds, or a `Condition`. It happens at the end of the
/// first step at which the time has come or the condition holds, once.
///
/// ```toml
/// [[support]]
/// at = { vertices = [0] }
/// until = 0.5
///
/// [[support]]
/// at = { vertices = [4] }
/// until = { force = 2.0 }
/// ```
#[derive(Clone, Debug, PartialEq, Serialize, JsonSchema, Part)]
#[serde(untagged)]
pub enum When {
    /// At a time, seconds.
    Time(f64),
    /// When a condition holds.
    Condition(Condition),
}

/// A condition that is looked at after each step.
///
/// ```toml
/// [[measure]]
/// name = "height"
/// at = { vertices = [8] }
/// quantity = "z"
///
/// [[support]]
/// at = { vertices = [0] }
/// until = { measure = { name = "height", above = 0.1 } }
/// ```
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema, Part)]
#[serde(rename_all = "snake_case", deny_unknown_fields)]
pub enum Condition {
    /// Its own force has reached so many newtons. The force of a support is the sum over its vertices. Each
    /// pair of a seam has its own force, and tears for itself.
    Force(f64),
    /// A measure of the scene has passed a threshold.
    Measure(Threshold),
}

/// A threshold of a measure: one of `above` and `below`.
///
/// ```toml
/// [[measure]]
/// name = "tip"
/// at = { vertices = [8] }
/// quantity = "z"
///
/// [[support]]
/// at = { vertices = [0] }
/// until = { measure = { name = "tip", below = -0.02 } }
/// ```
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema, Part)]
#[serde(deny_unknown_fields)]
pub struct Threshold {
    /// The name of the measure.
    pub name: String,
    /// What it has to be above, in the unit of the measure.
    #[serde(default)]
    pub above: Option<f64>,
    /// What it has to be below, in the unit of the measure.
    #[serde(default)]
    pub below: Option<f64>,
}

impl Threshold {
    /// Whether a value of the measure has passed it.
    pub fn is_passed(&self, value: f64) -> bool {
        self.above.is_some_and(|least| value > least) || self.below.is_some_and(|most| value < most)
    }
}

/// What is taken up and released, by its number in the scene.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub(crate) enum Holder {
    Support(usize),
    Glue(usize),
    Contact(usize),
}

/// The time during which something holds.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Period<'a> {
    pub(crate) of: Holder,
    pub(crate) from: Option<&'a When>,
    pub(crate) until: Option<&'a When>,
}

impl Holder {
    pub(crate) fn key(self) -> Key {
        let root = Key::root();
        match self {
            Self::Support(k) => root.name("support").entry(k),
            Self::Glue(k) => root.name("glue").entry(k),
            Self::Contact(k) => root.name("contact.pair").entry(k),
        }
    }
}

impl Period<'_> {
    /// The key that a problem of both is reported at.
    pub(crate) fn first_name(&self) -> &'static str {
        match self.from {
            Some(_) => "from",
            None => "until",
        }
    }

    pub(crate) fn check(&self, measures: &[Measure], checks: &mut Checks) {
        let key = self.of.key();
        for (name, when) in [("from", self.from), ("until", self.until)] {
            if let Some(when) = when {
                when.check(&key.name(name), measures, checks);
            }
        }
        if let Some(When::Condition(Condition::Force(_))) = self.from {
            checks.report(
                key.name("from.force"),
                "what does not hold yet carries no force",
                "name a time or a measure",
            );
        }
        if let (Holder::Contact(_), Some(When::Condition(Condition::Force(_)))) =
            (self.of, self.until)
        {
            checks.report(
                key.name("until.force"),
                "contact is not released by its force",
                "name a time or a measure",
            );
        }
        if let (Some(When::Time(from)), Some(When::Time(until))) = (self.from, self.until)
            && until <= from
        {
            checks.report(
                key.name("until"),
                format!(
                    "it is released at {} s, before it is taken up at {} s",
                    given(*until),
                    given(*from)
                ),
                "let `until` be later than `from`; what is released and taken up again is two entries",
            );
        }
    }
}

impl When {
    fn check(&self, key: &Key, measures: &[Measure], checks: &mut Checks) {
        match self {
            Self::Time(t) => checks.positive(key.clone(), *t, Unit::Second),
            Self::Condition(Condition::Force(force)) => {
                checks.positive(key.name("force"), *force, Unit::Newton);
            }
            Self::Condition(Condition::Measure(threshold)) => {
                threshold.check(&key.name("measure"), measures, checks);
            }
        }
    }
}

impl Threshold {
    fn check(&self, key: &Key, measures: &[Measure], checks: &mut Checks) {
        if !measures.iter().any(|measure| measure.name == self.name) {
            let names: Vec<String> = measures.iter().map(|m| format!("`{}`", m.name)).collect();
            let remedy = match names.is_empty() {
                true => "describe it by `[[measure]]`".to_owned(),
                false => format!("the measures of the scene are {}", names.join(", ")),
            };
            let message = format!("there is no measure `{}`", self.name);
            checks.report(key.name("name"), message, remedy);
        }
        for (name, value) in [("above", self.above), ("below", self.below)] {
            if let Some(value) = value {
                checks.number(key.name(name), value, Unit::Metre);
            }
        }
        if self.above.is_some() == self.below.is_some() {
            let message = match self.above {
                Some(_) => "both `above` and `below` are given",
                None => "the threshold is missing",
            };
            checks.report(key.clone(), message, "give one of `above` and `below`");
        }
    }
}

impl<'de> Deserialize<'de> for When {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        deserializer.deserialize_any(WhenVisitor)
    }
}

struct WhenVisitor;

impl<'de> Visitor<'de> for WhenVisitor {
    type Value = When;

    fn expecting(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str("a time in seconds, or one of `force`, `measure` as a table")
    }

    fn visit_f64<E>(self, value: f64) -> Result<When, E> {
        Ok(When::Time(value))
    }

    fn visit_i64<E>(self, value: i64) -> Result<When, E> {
        Ok(When::Time(value as f64))
    }

    fn visit_u64<E>(self, value: u64) -> Result<When, E> {
        Ok(When::Time(value as f64))
    }

    fn visit_map<A: MapAccess<'de>>(self, map: A) -> Result<When, A::Error> {
        Condition::deserialize(MapAccessDeserializer::new(map)).map(When::Condition)
    }
}
