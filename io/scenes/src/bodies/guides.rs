//! Joints that guide bodies.

use crate::time::profile::ProfileKey;
use crate::words::key::Key;
use crate::words::part::Part;
use crate::words::problem::Checks;
use crate::words::unit::Unit;
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

/// A joint between a body and space, without friction.
///
/// ```toml
/// [[body]]
/// shape = { box = { size = [0.2, 0.02, 0.02] } }
/// density = 1000
/// guide = { hinge = { point = [-0.1, 0, 0], axis = [0, 1, 0] } }
/// ```
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema, Part)]
#[serde(rename_all = "snake_case", deny_unknown_fields)]
#[checked]
pub enum Guide {
    /// The body turns about an axis.
    Hinge {
        /// A point of the axis, metres.
        point: [f64; 3],
        /// Its direction, of any length; positive angles turn counter-clockwise seen against it.
        axis: [f64; 3],
        /// Stiffness of a spring at the hinge, N m/rad; without one there is none.
        #[serde(default)]
        stiffness: f64,
        /// The angle at which the spring is at rest, degrees; 0 is where the body is at the start. A stiff
        /// spring drives the body along it.
        #[serde(default)]
        #[unit(Degree)]
        rest: ProfileKey,
        /// Damping at the hinge, N m s/rad.
        #[serde(default)]
        damping: f64,
    },
    /// The body is displaced along a direction and does not turn.
    Slider {
        /// The direction, of any length.
        direction: [f64; 3],
        /// Stiffness of a spring along it, N/m; without one there is none.
        #[serde(default)]
        stiffness: f64,
        /// The displacement at which the spring is at rest, metres; 0 is where the body is at the start.
        #[serde(default)]
        #[unit(Metre)]
        rest: ProfileKey,
        /// Damping along it, N s/m.
        #[serde(default)]
        damping: f64,
    },
    /// The body turns about a point in all directions.
    Ball {
        /// The point, metres.
        point: [f64; 3],
    },
}

/// A force on a body.
///
/// ```toml
/// [[body]]
/// shape = { sphere = { radius = 0.05 } }
/// mass = 0.1
/// force = [{ direction = [1, 0, 0], size = { ramp = { to = 2, end = 1 } } }]
/// ```
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema, Part)]
#[serde(deny_unknown_fields)]
#[checked]
pub struct BodyForceKey {
    /// Direction in space, of any length.
    pub direction: [f64; 3],
    /// Size, newtons.
    #[unit(Newton)]
    pub size: ProfileKey,
    /// The point of the body on which it acts, by its place at the start, metres; if left out, the centre of
    /// mass.
    #[serde(default)]
    pub at: Option<[f64; 3]>,
}

/// A torque on a body.
///
/// ```toml
/// [[body]]
/// shape = { cylinder = { radius = 0.05, height = 0.1 } }
/// mass = 0.1
/// torque = [{ axis = [0, 0, 1], size = 0.01 }]
/// ```
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema, Part)]
#[serde(deny_unknown_fields)]
#[checked]
pub struct BodyTorqueKey {
    /// Its axis in space, of any length; positive sizes turn counter-clockwise seen against it.
    pub axis: [f64; 3],
    /// Size, N m.
    #[unit(NewtonMetre)]
    pub size: ProfileKey,
}

impl Guide {
    pub(crate) fn check(&self, key: &Key, checks: &mut Checks) {
        match self {
            Self::Hinge {
                point,
                axis,
                stiffness,
                damping,
                ..
            } => {
                let key = key.name("hinge");
                checks.finite(key.name("point"), point, Unit::Metre);
                checks.direction(key.name("axis"), axis);
                checks.not_negative(key.name("stiffness"), *stiffness, Unit::NewtonMetre);
                checks.not_negative(key.name("damping"), *damping, Unit::NewtonMetre);
            }
            Self::Slider {
                direction,
                stiffness,
                damping,
                ..
            } => {
                let key = key.name("slider");
                checks.direction(key.name("direction"), direction);
                checks.not_negative(key.name("stiffness"), *stiffness, Unit::NewtonPerMetre);
                checks.not_negative(key.name("damping"), *damping, Unit::NewtonPerMetre);
            }
            Self::Ball { point } => {
                checks.finite(key.name("ball.point"), point, Unit::Metre);
            }
        }
    }

    /// The point about which it lets a body turn.
    pub(crate) fn point(&self) -> Option<[f64; 3]> {
        match self {
            Self::Hinge { point, .. } | Self::Ball { point } => Some(*point),
            Self::Slider { .. } => None,
        }
    }

    pub(crate) fn name(&self) -> &'static str {
        match self {
            Self::Hinge { .. } => "hinge",
            Self::Slider { .. } => "slider",
            Self::Ball { .. } => "ball",
        }
    }
}

impl BodyForceKey {
    pub(crate) fn check(&self, key: &Key, checks: &mut Checks) {
        checks.direction(key.name("direction"), &self.direction);
        if let Some(point) = &self.at {
            checks.finite(key.name("at"), point, Unit::Metre);
        }
    }
}

impl BodyTorqueKey {
    pub(crate) fn check(&self, key: &Key, checks: &mut Checks) {
        checks.direction(key.name("axis"), &self.axis);
    }
}
