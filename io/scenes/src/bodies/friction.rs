//! Coefficients of friction.

use crate::words::key::Key;
use crate::words::part::Part;
use crate::words::problem::Checks;
use crate::words::unit::Unit;
use isosheet_dynamics::contact::Coefficients;
use schemars::JsonSchema;
use serde::de::value::MapAccessDeserializer;
use serde::de::{MapAccess, Visitor};
use serde::{Deserialize, Deserializer, Serialize};
use std::fmt;

/// Coulomb friction: a number, which is the coefficient at rest and in motion, or both of them.
///
/// ```toml
/// [[obstacle]]
/// shape = "half_space"
/// friction = { static = 0.5, kinetic = 0.3 }
/// ```
#[derive(Clone, Copy, Debug, PartialEq, Serialize, JsonSchema, Part)]
#[serde(untagged)]
#[checked]
pub enum FrictionKey {
    /// The coefficient at rest and in motion.
    Same(f64),
    /// One of each.
    Each(FrictionCoefficients),
}

/// The coefficients of friction at rest and in motion.
///
/// ```toml
/// [contact]
/// self_contact = true
/// friction = { static = 0.4, kinetic = 0.25 }
/// ```
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize, JsonSchema, Part)]
#[serde(deny_unknown_fields)]
pub struct FrictionCoefficients {
    /// The static coefficient, at least the kinetic one, up to which surfaces that touch rest.
    #[serde(rename = "static")]
    pub at_rest: f64,
    /// The kinetic coefficient, of surfaces that slide.
    pub kinetic: f64,
}

impl Default for FrictionKey {
    fn default() -> Self {
        Self::Same(0.0)
    }
}

impl fmt::Display for FrictionKey {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Same(coefficient) => coefficient.fmt(f),
            Self::Each(FrictionCoefficients { at_rest, kinetic }) => {
                write!(f, "{at_rest} (static), {kinetic} (kinetic)")
            }
        }
    }
}

impl From<f64> for FrictionKey {
    fn from(coefficient: f64) -> Self {
        Self::Same(coefficient)
    }
}

impl FrictionKey {
    pub(crate) fn check(&self, key: &Key, checks: &mut Checks) {
        let Self::Each(FrictionCoefficients { at_rest, kinetic }) = *self else {
            checks.not_negative(key.clone(), self.coefficients().rest, Unit::One);
            return;
        };
        checks.not_negative(key.name("static"), at_rest, Unit::One);
        checks.not_negative(key.name("kinetic"), kinetic, Unit::One);
        if kinetic > at_rest {
            let message = format!("it is {kinetic}, above the static coefficient, {at_rest}");
            checks.report(key.name("kinetic"), message, "swap them");
        }
    }

    pub(crate) fn coefficients(self) -> Coefficients {
        match self {
            Self::Same(coefficient) => Coefficients::equal(coefficient),
            Self::Each(FrictionCoefficients { at_rest, kinetic }) => Coefficients {
                rest: at_rest,
                sliding: kinetic,
            },
        }
    }
}

impl<'de> Deserialize<'de> for FrictionKey {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        deserializer.deserialize_any(FrictionVisitor)
    }
}

struct FrictionVisitor;

impl<'de> Visitor<'de> for FrictionVisitor {
    type Value = FrictionKey;

    fn expecting(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str("a coefficient, or a table of `static` and `kinetic`")
    }

    fn visit_f64<E>(self, value: f64) -> Result<FrictionKey, E> {
        Ok(FrictionKey::Same(value))
    }

    fn visit_i64<E>(self, value: i64) -> Result<FrictionKey, E> {
        Ok(FrictionKey::Same(value as f64))
    }

    fn visit_u64<E>(self, value: u64) -> Result<FrictionKey, E> {
        Ok(FrictionKey::Same(value as f64))
    }

    fn visit_map<A: MapAccess<'de>>(self, map: A) -> Result<FrictionKey, A::Error> {
        let each = FrictionCoefficients::deserialize(MapAccessDeserializer::new(map))?;
        Ok(FrictionKey::Each(each))
    }
}
