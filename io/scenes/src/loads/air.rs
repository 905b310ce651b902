//! The air around the sheet.

use crate::AttachedFlowKey;
use crate::time::profile::ProfileKey;
use crate::words::key::Key;
use crate::words::part::Part;
use crate::words::problem::Checks;
use crate::words::unit::Unit;
use isosheet_dynamics as engine;
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

/// Air at rest or in motion, which drags at each face of the sheet by the square of the relative velocity;
/// without `[air]` there is none. With the velocity of the air relative to the face across it, `u_n`, and
/// along it, `u_t`, the force on both sides of a face of area `A` together is
/// `density A / 2 (normal |u_n| u_n + tangential |u_t| u_t)`, as of separated flow. Only `attached` flow has
/// lift and a wake. No face or obstacle shelters another.
///
/// ```toml
/// [air]
/// wind = [{ sine = { mean = 4, amplitude = 2, frequency = 0.7 } }, 0, 0]
/// ```
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema, Part)]
#[serde(default, deny_unknown_fields)]
#[checked]
pub struct AirKey {
    /// Density, kg/m3; by default of air at 20 degrees Celsius.
    pub density: f64,
    /// Coefficient of the drag across the face, of a plate with its two sides: 1.17 of squares and disks, up
    /// to 2 of long strips.
    pub normal: f64,
    /// Coefficient of the friction along the face, of both sides together: `2.7 / sqrt(Re)` of a laminar
    /// boundary layer.
    pub tangential: f64,
    /// Components of the velocity of the air, m/s. A gust is a component that changes with time.
    #[unit(MetrePerSecond)]
    pub wind: [ProfileKey; 3],
    /// The sheet along which the air flows. Without it the flow separates everywhere.
    pub attached: Option<AttachedFlowKey>,
}

impl Default for AirKey {
    /// Still air.
    fn default() -> Self {
        let engine::Air {
            density,
            normal,
            tangential,
            ..
        } = engine::Air::default();
        Self {
            density,
            normal,
            tangential,
            wind: Default::default(),
            attached: None,
        }
    }
}

impl AirKey {
    pub(crate) fn check(&self, key: &Key, checks: &mut Checks) {
        let density = Unit::KilogramPerCubicMetre;
        checks.not_negative(key.name("density"), self.density, density);
        checks.not_negative(key.name("normal"), self.normal, Unit::One);
        checks.not_negative(key.name("tangential"), self.tangential, Unit::One);
    }

    /// The air as the engine has it.
    pub(crate) fn as_engine(&self) -> engine::Air {
        engine::Air {
            density: self.density,
            normal: self.normal,
            tangential: self.tangential,
            wind: self.wind.each_ref().map(ProfileKey::as_given).into(),
        }
    }
}
