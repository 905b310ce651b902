//! Contact of the sheet with itself and with obstacles.

use crate::bodies::body;
use crate::bodies::friction::FrictionKey;
use crate::bodies::obstacle_names;
use crate::bodies::obstacles::ShapeKey;
use crate::holding::switch::When;
use crate::words::key::Key;
use crate::words::part::Part;
use crate::words::problem::Checks;
use crate::words::unit::Unit;
use crate::{BodyKey, ObstacleKey};
use isosheet_collide::{ContactOptions, Stiffness};
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

/// Contact. Without obstacles, bodies and self-contact nothing of it is modelled.
///
/// ```toml
/// [contact]
/// self_contact = true
/// friction = 0.3
/// activation = 0.001
/// ```
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize, JsonSchema, Part)]
#[serde(default, deny_unknown_fields)]
#[schemars(rename = "Contact")]
pub struct ContactSettings {
    /// Whether the sheet meets itself, and several sheets meet themselves and one another.
    pub self_contact: bool,
    /// Friction of sheets and bodies with themselves and one another. (That of an obstacle is given with the
    /// obstacle.)
    pub friction: FrictionKey,
    /// Friction between two of several sheets, bodies and obstacles, where it is another.
    pub pair: Vec<SheetPairKey>,
    /// Gap below which contact acts, metres; if left out, 1 % of the mean edge length and at most half the
    /// smallest height of a face.
    pub activation: Option<f64>,
    /// Stiffness of the contact potential, joules; if left out, it follows from masses and forces.
    pub stiffness: Option<f64>,
    /// Speed below which sliding counts as rest, m/s; if left out, 1 % of the mean edge length per second.
    pub rest_speed: Option<f64>,
}

/// Friction between two of several sheets, bodies and obstacles with a `name`, or of a sheet with itself.
///
/// ```toml
/// [[sheet]]
/// name = "cover"
/// mesh = { square = { side = 0.1, level = 1 } }
///
/// [[sheet]]
/// name = "page"
/// mesh = { square = { side = 0.1, level = 1 } }
/// placement = { position = [0, 0, 0.01] }
///
/// [contact]
/// self_contact = true
///
/// [[contact.pair]]
/// sheets = ["cover", "page"]
/// friction = 0.6
/// ```
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema, Part)]
#[serde(deny_unknown_fields)]
pub struct SheetPairKey {
    /// The names of the two: sheets, bodies, and at most one obstacle.
    pub sheets: [String; 2],
    /// Friction between the two.
    pub friction: FrictionKey,
    /// When they begin to meet; if left out, at the start. Before, they pass through each other. They must
    /// not touch at that moment.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub from: Option<When>,
    /// When they cease to meet; if left out, never.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub until: Option<When>,
}

impl ContactSettings {
    pub(crate) fn check(
        &self,
        bodies: &[BodyKey],
        obstacles: &[ObstacleKey],
        key: &Key,
        checks: &mut Checks,
    ) {
        for (k, (key, pair)) in key.name("pair").entries(&self.pair).enumerate() {
            let is_same = |other: &SheetPairKey| {
                let [first, second] = &pair.sheets;
                other.sheets == pair.sheets || [second, first] == other.sheets.each_ref()
            };
            if let Some(other) = self.pair[..k].iter().position(is_same) {
                let message = format!("`contact.pair[{other}]` is of the same two");
                let remedy = "describe how two of them meet in one entry";
                checks.report(key.name("sheets"), message, remedy);
            }
            let is_body = |name: &String| body::number_of(bodies, name).is_some();
            let is_obstacle = |name: &String| obstacle_names::number_of(obstacles, name).is_some();
            let switch = match (&pair.from, &pair.until) {
                (Some(_), _) => Some("from"),
                (None, Some(_)) => Some("until"),
                (None, None) => None,
            };
            let deforms = |name: &String| {
                let number = obstacle_names::number_of(obstacles, name);
                number.is_some_and(|k| matches!(obstacles[k].shape, ShapeKey::Sequence(_)))
            };
            let is_rigid = |name: &String| is_obstacle(name) && !deforms(name);
            if let Some(switch) = switch.filter(|_| pair.sheets.iter().any(is_rigid)) {
                let message = "contact with an obstacle that does not deform begins with the run and never ends";
                let remedy = "leave the key out; an obstacle may move to where it is in the way, and away from there";
                checks.report(key.name(switch), message, remedy);
            }
            match pair.sheets.iter().filter(|name| is_obstacle(name)).count() {
                0 if !self.self_contact && !pair.sheets.iter().any(is_body) => {
                    let remedy = "write `self_contact = true`, or leave the pair out";
                    checks.report(key, "sheets do not meet one another", remedy);
                }
                0 | 1 => {}
                _ => checks.report(
                    key.name("sheets"),
                    "obstacles do not meet one another",
                    "name a sheet or a body and an obstacle",
                ),
            }
        }
        let lengths = [
            ("activation", self.activation, Unit::Metre),
            ("stiffness", self.stiffness, Unit::Joule),
            ("rest_speed", self.rest_speed, Unit::MetrePerSecond),
        ];
        for (name, value, unit) in lengths {
            if let Some(value) = value {
                checks.positive(key.name(name), value, unit);
            }
        }
    }

    /// The options of the engine for a sheet of some thickness (metres), with the automatic values where the
    /// scene gives none.
    pub(crate) fn options(&self, automatic: ContactOptions, thickness: f64) -> ContactOptions {
        ContactOptions {
            activation: self.activation.unwrap_or(automatic.activation),
            thickness,
            stiffness: self
                .stiffness
                .map_or(automatic.stiffness, Stiffness::Joules),
            rest_speed: self.rest_speed.unwrap_or(automatic.rest_speed),
            ..automatic
        }
    }
}
