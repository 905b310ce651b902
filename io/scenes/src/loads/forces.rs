//! Forces on the sheet.

use crate::loads::follower_loads::{GasKey, Moment, Pressure};
use crate::meshes::selection::Selection;
use crate::time::profile::ProfileKey;
use crate::words::key::Key;
use crate::words::part::Part;
use crate::words::plain_name::check_name;
use crate::words::problem::Checks;
use crate::words::unit::Unit;
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};
use std::collections::BTreeSet;

/// Gravity on earth, the example of the schema. (Without features that other crates bring, `schemars` reads
/// names and no arrays.)
const EARTH: [f64; 3] = [0.0, 0.0, -9.81];

/// Forces on the sheet besides the forces of supports and contact.
///
/// ```toml
/// [forces]
/// gravity = [0, 0, -9.81]
///
/// [[forces.load]]
/// at = { vertices = [0] }
/// direction = [1, 0, 0]
/// size = 0.01
/// ```
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize, JsonSchema, Part)]
#[serde(default, deny_unknown_fields)]
#[checked]
pub struct Forces {
    /// Acceleration of gravity, m/s2: `[0, 0, -9.81]` on earth. Without it there is no gravity.
    #[schemars(example = EARTH)]
    pub gravity: Option<[f64; 3]>,
    /// Loads on vertices.
    pub load: Vec<Load>,
    /// Pressures on faces.
    pub pressure: Vec<Pressure>,
    /// Gas in closed surfaces.
    pub gas: Vec<GasKey>,
    /// Moments on lines of edges.
    pub moment: Vec<Moment>,
    /// Uniform accelerations that change with time, such as the acceleration of a frame that is shaken.
    pub acceleration: Vec<Acceleration>,
}

/// A load that some vertices share equally.
///
/// ```toml
/// [[forces.load]]
/// at = { vertices = [0, 1] }
/// direction = [0, 0, 1]
/// size = { ramp = { to = 0.05, end = 0.5 } }
/// ```
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema, Part)]
#[serde(deny_unknown_fields)]
#[checked]
pub struct Load {
    /// The name of the sheet, if there are several and not the vertices of all are meant.
    #[serde(default)]
    pub sheet: Option<String>,
    /// Which vertices.
    pub at: Selection,
    /// Direction in space, of any length; in the frame of the sheet the direction at the start.
    pub direction: [f64; 3],
    /// What the direction turns with.
    #[serde(default)]
    pub frame: Frame,
    /// Size of the whole load, newtons.
    #[unit(Newton)]
    pub size: ProfileKey,
}

/// What the direction of a load turns with.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize, JsonSchema, Part)]
#[serde(rename_all = "snake_case")]
pub enum Frame {
    /// It stays fixed in space.
    #[default]
    Space,
    /// It turns with the faces around each vertex, and is given at the start.
    Sheet,
}

/// A uniform acceleration of the whole sheet.
///
/// ```toml
/// [[forces.acceleration]]
/// direction = [1, 0, 0]
/// size = { sine = { amplitude = 3, frequency = 2 } }
/// ```
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema, Part)]
#[serde(deny_unknown_fields)]
#[checked]
pub struct Acceleration {
    /// Direction in space, of any length.
    pub direction: [f64; 3],
    /// Size, m/s2.
    #[unit(MetrePerSquareSecond)]
    pub size: ProfileKey,
}

impl Forces {
    /// Refuses names of gases and pressures that stand twice or that tables cannot have.
    fn check_names(&self, key: &Key, checks: &mut Checks) {
        let [gas_key, pressure_key] = ["gas", "pressure"].map(|name| key.name(name));
        let gases = gas_key.entries(&self.gas);
        let gases = gases.map(|(key, gas)| (key, gas.name.as_ref(), "a gas"));
        let pressures = pressure_key.entries(&self.pressure);
        let pressures = pressures.map(|(key, p)| (key, p.name.as_ref(), "a pressure"));
        let mut names = BTreeSet::new();
        for (key, name, of) in gases.chain(pressures) {
            let Some(name) = name else { continue };
            check_name(name, key.name("name"), of, checks);
            if !names.insert(name) {
                let message = format!("another gas or pressure has the name `{name}`");
                let remedy = "give each gas and pressure a name of its own";
                checks.report(key.name("name"), message, remedy);
            }
        }
    }

    pub(crate) fn check(&self, key: &Key, checks: &mut Checks) {
        if let Some(gravity) = &self.gravity {
            checks.finite(key.name("gravity"), gravity, Unit::MetrePerSquareSecond);
        }
        self.check_names(key, checks);
    }
}

impl Load {
    pub(crate) fn check(&self, key: &Key, checks: &mut Checks) {
        checks.direction(key.name("direction"), &self.direction);
    }
}

impl Acceleration {
    pub(crate) fn check(&self, key: &Key, checks: &mut Checks) {
        checks.direction(key.name("direction"), &self.direction);
    }
}
