//! Functions of time.

use crate::words::key::Key;
use crate::words::part::{Part, Place};
use crate::words::problem::Checks;
use crate::words::unit::Unit;
use isosheet_dynamics as engine;
use isosheet_dynamics::ProfileError;
use isosheet_mesh::Advice;
use schemars::JsonSchema;
use serde::de::value::MapAccessDeserializer;
use serde::de::{MapAccess, Visitor};
use serde::{Deserialize, Deserializer, Serialize};
use std::fmt;

/// A function of time: a number for a value that stays the same, or a `Course`. A displacement is in metres,
/// an angle in degrees, a load in newtons.
///
/// The method evaluates the function at the end of each step. A function that turns back within a step by
/// more than a quarter of its range is refused; a sine with three steps in a period turns back by that much.
/// An angle of a motion that changes by more than half a turn in a step is refused, too.
///
/// ```toml
/// [[forces.load]]
/// at = { vertices = [0] }
/// direction = [0, 0, 1]
/// size = { ramp = { to = 0.05, end = 0.5 } }
/// ```
#[derive(Clone, Debug, PartialEq, Serialize, JsonSchema)]
#[serde(untagged)]
pub enum ProfileKey {
    /// One value at all times.
    Constant(f64),
    /// A value that changes.
    Course(Course),
}

/// A value that changes with time.
///
/// ```toml
/// [[forces.acceleration]]
/// direction = [1, 0, 0]
/// size = { sine = { amplitude = 3, frequency = 2 } }
/// ```
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case", deny_unknown_fields)]
pub enum Course {
    /// A linear change.
    Ramp(Change),
    /// A change that begins and ends smoothly: `10 s^3 - 15 s^4 + 6 s^5` of the time that has passed.
    SmoothStep(Change),
    /// A feed that gets going: with a constant acceleration up to a constant rate.
    RunUp {
        /// Value up to `begin`.
        #[serde(default)]
        from: f64,
        /// Rate from `end` on, per second.
        rate: f64,
        /// When the change begins, seconds.
        #[serde(default)]
        begin: f64,
        /// When the rate is reached, seconds.
        end: f64,
    },
    /// `mean + amplitude sin(360 frequency t + phase)`, the argument in degrees.
    Sine {
        /// Mean value.
        #[serde(default)]
        mean: f64,
        /// Amplitude.
        amplitude: f64,
        /// Frequency, hertz.
        frequency: f64,
        /// Phase at time zero, degrees.
        #[serde(default)]
        phase: f64,
    },
    /// Through keyframes, constant before the first and after the last.
    Keyframes {
        /// The course between keyframes.
        #[serde(default)]
        interpolation: InterpolationKey,
        /// Pairs of time (seconds) and value, in the order of time.
        keys: Vec<[f64; 2]>,
        /// The times at which the rate really jumps, seconds: there the method begins anew. If left out, at
        /// each keyframe; a smooth motion that was sampled has none, `[]`.
        #[serde(default, skip_serializing_if = "Option::is_none")]
        kinks: Option<Vec<f64>>,
    },
}

/// A change from one value to another.
///
/// ```toml
/// [[crease]]
/// at = { line = { from = [0, 0.1, 0], to = [0.2, 0.1, 0] } }
/// stiffness = 0.01
/// angle = { smooth_step = { from = 0, to = 120, begin = 0.2, end = 1.2 } }
/// ```
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Change {
    /// Value up to `begin`.
    #[serde(default)]
    pub from: f64,
    /// Value from `end` on.
    pub to: f64,
    /// When the change begins, seconds.
    #[serde(default)]
    pub begin: f64,
    /// When the change is complete, seconds.
    pub end: f64,
}

/// The course between keyframes.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
pub enum InterpolationKey {
    /// Straight lines.
    #[default]
    Linear,
    /// Cubic polynomials with a continuous rate, which do not overshoot.
    MonotoneCubic,
}

impl Part for ProfileKey {
    fn check_own(&self, at: &Place, checks: &mut Checks) {
        let unit = at
            .unit
            .expect("fields that are functions of time have a unit");
        self.check(at.key.clone(), unit, checks);
    }
}

impl Default for ProfileKey {
    /// Zero at all times.
    fn default() -> Self {
        Self::Constant(0.0)
    }
}

impl From<f64> for ProfileKey {
    fn from(value: f64) -> Self {
        Self::Constant(value)
    }
}

impl ProfileKey {
    /// From zero at the time zero smoothly to `value` at the time `end` (seconds).
    pub fn smooth_step(value: f64, end: f64) -> Self {
        Self::Course(Course::SmoothStep(Change {
            to: value,
            end,
            ..Change::default()
        }))
    }

    /// The value at time `t` (seconds), in the unit of what it drives.
    pub fn value(&self, t: f64) -> f64 {
        self.as_given().value(t)
    }

    /// The smallest and the largest value until time `t` (seconds) of one that is used from time zero on.
    pub fn range(&self, t: f64) -> [f64; 2] {
        let values = match self {
            Self::Course(Course::RunUp { .. }) => vec![self.value(0.0), self.value(t)],
            Self::Course(Course::Sine {
                mean, amplitude, ..
            }) => vec![mean - amplitude, mean + amplitude],
            _ => self.numbers().1,
        };
        let none = [f64::INFINITY, f64::NEG_INFINITY];
        let widen = |[low, high]: [f64; 2], value: f64| [low.min(value), high.max(value)];
        values.into_iter().fold(none, widen)
    }

    /// The profile as the engine has it, values multiplied by `scale`.
    pub(crate) fn scaled(&self, scale: f64) -> engine::Profile {
        let course = match self {
            Self::Constant(value) => return engine::Profile::Constant(scale * value),
            Self::Course(course) => course,
        };
        match course {
            Course::Ramp(c) => engine::Profile::Ramp {
                from: scale * c.from,
                to: scale * c.to,
                begin: c.begin,
                end: c.end,
            },
            Course::SmoothStep(c) => engine::Profile::SmoothStep {
                from: scale * c.from,
                to: scale * c.to,
                begin: c.begin,
                end: c.end,
            },
            Course::RunUp {
                from,
                rate,
                begin,
                end,
            } => engine::Profile::RunUp {
                from: scale * from,
                rate: scale * rate,
                begin: *begin,
                end: *end,
            },
            Course::Sine {
                mean,
                amplitude,
                frequency,
                phase,
            } => engine::Profile::Sine {
                mean: scale * mean,
                amplitude: scale * amplitude,
                frequency: *frequency,
                phase: phase.to_radians(),
            },
            Course::Keyframes {
                interpolation,
                keys,
                ..
            } => engine::Profile::Keyframes {
                interpolation: match interpolation {
                    InterpolationKey::Linear => engine::Interpolation::Linear,
                    InterpolationKey::MonotoneCubic => engine::Interpolation::MonotoneCubic,
                },
                keys: keys.iter().map(|[t, value]| [*t, scale * value]).collect(),
            },
        }
    }

    /// The times at which the rate or the acceleration jumps, seconds.
    pub fn breaks(&self) -> Vec<f64> {
        let kinks = match self {
            Self::Course(Course::Keyframes { kinks, .. }) => kinks.clone(),
            _ => None,
        };
        kinks.unwrap_or_else(|| self.as_given().breaks())
    }

    /// The profile in metres, newtons or other units that scene and engine share.
    pub(crate) fn as_given(&self) -> engine::Profile {
        self.scaled(1.0)
    }

    /// The profile of an angle, degrees here and radians in the engine.
    pub(crate) fn as_angle(&self) -> engine::Profile {
        self.scaled(1.0_f64.to_radians())
    }

    /// Times and values, of which any may be out of range.
    pub(crate) fn numbers(&self) -> (Vec<f64>, Vec<f64>) {
        let course = match self {
            Self::Constant(value) => return (Vec::new(), vec![*value]),
            Self::Course(course) => course,
        };
        match course {
            Course::Ramp(c) | Course::SmoothStep(c) => (vec![c.begin, c.end], vec![c.from, c.to]),
            Course::RunUp {
                from,
                rate,
                begin,
                end,
            } => (vec![*begin, *end], vec![*from, rate * (end - begin)]),
            Course::Sine {
                mean, amplitude, ..
            } => (Vec::new(), vec![*mean, *amplitude]),
            Course::Keyframes { keys, .. } => keys.iter().map(|[t, v]| (*t, *v)).unzip(),
        }
    }

    /// Checks the course; `unit` is that of what it drives.
    fn check(&self, key: Key, unit: Unit, checks: &mut Checks) {
        let Err(error) = self.as_given().validate() else {
            let (times, values) = self.numbers();
            for time in times {
                checks.number(key.clone(), time, Unit::Second);
            }
            for value in values {
                checks.number(key.clone(), value, unit);
            }
            if let Self::Course(Course::Sine { frequency, .. }) = self {
                checks.number(key.name("sine.frequency"), *frequency, Unit::PerSecond);
            }
            if let Self::Course(Course::Keyframes { kinks, .. }) = self {
                let kinks = kinks.as_deref().unwrap_or_default();
                for (key, time) in key.name("keyframes.kinks").entries(kinks) {
                    checks.number(key, *time, Unit::Second);
                }
            }
            return;
        };
        let form = match self {
            Self::Constant(_) => None,
            Self::Course(Course::Ramp(_)) => Some("ramp"),
            Self::Course(Course::SmoothStep(_)) => Some("smooth_step"),
            Self::Course(Course::RunUp { .. }) => Some("run_up"),
            Self::Course(Course::Sine { .. }) => Some("sine"),
            Self::Course(Course::Keyframes { .. }) => Some("keyframes"),
        };
        let mut place = form.map_or(key.clone(), |form| key.name(form));
        match error {
            ProfileError::NotFinite { name, .. } if form.is_some() => place = place.name(name),
            ProfileError::Duration { .. } => place = place.name("end"),
            ProfileError::NoKeyframes => place = place.name("keys"),
            ProfileError::Keyframe { index, .. } | ProfileError::Order { index, .. } => {
                place = place.name("keys").entry(index);
            }
            _ => {}
        }
        let message = format!("the profile `{key}` cannot be used: {error}");
        checks.problems.push(crate::Problem {
            key: place,
            message,
            remedy: error.advice().map(str::to_owned),
            span: None,
        });
    }
}

impl<'de> Deserialize<'de> for ProfileKey {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        deserializer.deserialize_any(ProfileVisitor)
    }
}

struct ProfileVisitor;

impl<'de> Visitor<'de> for ProfileVisitor {
    type Value = ProfileKey;

    fn expecting(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(
            "a number, or one of `ramp`, `smooth_step`, `run_up`, `sine`, `keyframes` as a table",
        )
    }

    fn visit_f64<E>(self, value: f64) -> Result<ProfileKey, E> {
        Ok(ProfileKey::Constant(value))
    }

    fn visit_i64<E>(self, value: i64) -> Result<ProfileKey, E> {
        Ok(ProfileKey::Constant(value as f64))
    }

    fn visit_u64<E>(self, value: u64) -> Result<ProfileKey, E> {
        Ok(ProfileKey::Constant(value as f64))
    }

    fn visit_map<A: MapAccess<'de>>(self, map: A) -> Result<ProfileKey, A::Error> {
        Course::deserialize(MapAccessDeserializer::new(map)).map(ProfileKey::Course)
    }
}
