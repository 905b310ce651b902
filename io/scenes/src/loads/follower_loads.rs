//! Loads that follow the sheet: pressure, enclosed gas, moments.

use crate::meshes::selection::Selection;
use crate::time::profile::ProfileKey;
use crate::words::key::Key;
use crate::words::part::Part;
use crate::words::problem::Checks;
use crate::words::unit::Unit;
use isosheet_dynamics as engine;
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

/// A pressure on one side of faces, which stays along their normals: positive towards the side from which
/// they are counter-clockwise, their front.
///
/// Where the faces enclose a volume, glued sheets together, it has a potential, `-p V`; elsewhere its
/// work is the work of a force. Sheets that are glued to each other by their rims have a common front, the
/// front of the first one that is named.
///
/// ```toml
/// [[forces.pressure]]
/// size = { smooth_step = { to = 20, end = 0.5 } }
/// ```
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema, Part)]
#[serde(deny_unknown_fields)]
#[checked]
pub struct Pressure {
    /// A name, by which measures find it.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub name: Option<String>,
    /// The names of the sheets. If left out, all of them.
    #[serde(default)]
    pub sheets: Option<Vec<String>>,
    /// The faces whose corners are all selected.
    #[serde(default = "everywhere")]
    pub at: Selection,
    /// Size, pascals.
    #[unit(Pascal)]
    pub size: ProfileKey,
}

fn everywhere() -> Selection {
    Selection::All
}

/// Gas that a closed sheet encloses, or several sheets that are glued to each other by their rims: its
/// pressure is `p = p1 (V1 / V)^n` in the volume `V`, with the pressure `p1` and the volume `V1` at the
/// start. Weight and inertia of the gas are left out.
///
/// Pressure and volume are recorded without being asked for: as the measures `gas[0].pressure` (pascals above
/// vacuum), `gas[0].gauge_pressure` (less the pressure outside) and `gas[0].volume` (cubic metres), with the
/// number of the gas, or as `NAME.pressure` and so on of one with a name.
///
/// ```toml
/// [[forces.gas]]
/// added = { smooth_step = { to = 5e-4, end = 0.5 } }
/// ```
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema, Part)]
#[serde(deny_unknown_fields)]
#[checked]
pub struct GasKey {
    /// A name, by which measures find it.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub name: Option<String>,
    /// The names of the sheets. If left out, all of them.
    #[serde(default)]
    pub sheets: Option<Vec<String>>,
    /// Pressure outside, pascals. If left out, 101325, the standard atmosphere.
    #[serde(default = "atmosphere")]
    pub ambient: f64,
    /// Pressure of the gas at the start, pascals. If left out, the pressure outside.
    #[serde(default)]
    pub pressure: Option<f64>,
    /// Exponent `n`. If left out, 1: the temperature stays the same. Air that is compressed fast has 1.4.
    #[serde(default = "isothermal")]
    pub exponent: f64,
    /// Gas that is let in, by the volume that it takes at the pressure at the start, cubic metres; gas that
    /// is let out has a negative sign. It is added to `V1`.
    #[serde(default)]
    #[unit(CubicMetre)]
    pub added: ProfileKey,
}

fn atmosphere() -> f64 {
    engine::Gas::default().ambient
}

fn isothermal() -> f64 {
    engine::Gas::default().exponent
}

/// A moment on a line of edges, which turns with the sheet.
///
/// ```toml
/// [[forces.moment]]
/// at = { half_space = { point = [0.2, 0, 0], normal = [1, 0, 0] } }
/// axis = [0, 1, 0]
/// size = { smooth_step = { to = 1e-3, end = 1 } }
/// ```
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema, Part)]
#[serde(deny_unknown_fields)]
#[checked]
pub struct Moment {
    /// The name of the sheet, if there are several.
    #[serde(default)]
    pub sheet: Option<String>,
    /// The edges whose two ends are selected. They share the moment by their lengths.
    pub at: Selection,
    /// The axis about which the moment turns at the start, right-handed, of any length. Later it turns about
    /// the edges.
    pub axis: [f64; 3],
    /// Size of the whole moment, newton metres.
    #[unit(NewtonMetre)]
    pub size: ProfileKey,
}

impl Pressure {
    pub(crate) fn check(&self, key: &Key, checks: &mut Checks) {
        check_sheets(&self.sheets, key, checks);
    }
}

impl GasKey {
    pub(crate) fn check(&self, key: &Key, checks: &mut Checks) {
        check_sheets(&self.sheets, key, checks);
        checks.positive(key.name("ambient"), self.ambient, Unit::Pascal);
        checks.positive(key.name("pressure"), self.pressure, Unit::Pascal);
        checks.positive(key.name("exponent"), self.exponent, Unit::Factor);
    }

    /// What it is called, by its number.
    pub(crate) fn called(&self, number: usize) -> String {
        let name = self.name.clone();
        name.unwrap_or_else(|| format!("gas[{number}]"))
    }

    /// As the engine has it.
    pub(crate) fn as_engine(&self) -> engine::Gas {
        engine::Gas {
            ambient: self.ambient,
            pressure: self.pressure.unwrap_or(self.ambient),
            exponent: self.exponent,
            added: self.added.as_given(),
        }
    }
}

impl Moment {
    pub(crate) fn check(&self, key: &Key, checks: &mut Checks) {
        checks.direction(key.name("axis"), &self.axis);
    }
}

/// Checks that names of sheets are named, each once.
fn check_sheets(names: &Option<Vec<String>>, key: &Key, checks: &mut Checks) {
    let key = key.name("sheets");
    let Some(names) = names else { return };
    if names.is_empty() {
        let message = "no sheet is named";
        checks.report(
            key,
            message,
            "name sheets, or leave the key out for all of them",
        );
        return;
    }
    for (i, name) in names.iter().enumerate() {
        if names[..i].contains(name) {
            let message = format!("the sheet `{name}` is named twice");
            checks.report(key.entry(i), message, "name each sheet once");
        }
    }
}
