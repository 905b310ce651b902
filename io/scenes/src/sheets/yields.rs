//! When sheets and creases yield.

use crate::words::key::Key;
use crate::words::part::Part;
use crate::words::problem::Checks;
use crate::words::unit::Unit;
use isosheet_dynamics::Yield;
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

/// When the sheet yields in bending, so that bends stay: the moment `M` of a metre of width is `D (k - p)`
/// with the rigidity `D`, the curvature `k` and the plastic curvature `p`, which grows where `|M - hardening
/// p|` would be more than `moment`. A sheet in `layers` begins to yield at its faces, at two thirds of that.
/// For `bdf2` and `implicit_euler`.
///
/// ```toml
/// [sheet]
/// mesh = { rectangle = { width = 0.1, height = 0.02, columns = 20, rows = 4 } }
/// material = "aluminium sheet"
/// yield = {}
/// ```
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize, JsonSchema, Part)]
#[serde(default, deny_unknown_fields)]
#[checked]
pub struct SheetYield {
    /// Moment at which a metre of the sheet yields, N m per m: `s h^2 / 4` where the material yields at the
    /// stress `s` and is `h` thick. By default the moment of the material.
    pub moment: Option<f64>,
    /// Growth of this moment by plastic curvature, N m. By default the hardening of the material if `moment`
    /// is left out too, and otherwise 0.
    pub hardening: Option<f64>,
    /// Number of layers of each half of the sheet, each of which yields by itself, at the points of Gauss and
    /// Legendre. With 11, bends that stay have an error of 1 %; with 1, the sheet yields in the whole of its
    /// thickness at once.
    pub layers: usize,
}

impl Default for SheetYield {
    fn default() -> Self {
        Self {
            moment: None,
            hardening: None,
            layers: Yield::LAYERS,
        }
    }
}

fn one_layer() -> usize {
    1
}

/// Checks a number of layers.
fn check_layers(key: &Key, layers: usize, checks: &mut Checks) {
    let most = Yield::MAX_LAYERS as f64;
    checks.within(key.name("layers"), layers as f64, [1.0, most]);
}

/// When a crease yields, so that it stays folded: its moment is `stiffness (angle - p)` with the plastic
/// angle `p`, which grows where `|M - hardening p|` would be more than `moment`. For `bdf2` and
/// `implicit_euler`.
///
/// ```toml
/// [[crease]]
/// at = { line = { from = [0, 0.1, 0], to = [0.2, 0.1, 0] } }
/// stiffness = 0.02
/// yield = { moment = 0.01, hardening = 0.002 }
/// ```
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize, JsonSchema, Part)]
#[serde(deny_unknown_fields)]
#[checked]
pub struct CreaseYield {
    /// Moment at which a metre of the crease yields, N (newton metres per metre): `stiffness` times the angle
    /// in radians from which it springs back.
    pub moment: f64,
    /// Growth of this moment by plastic angle, N (newton metres per radian and metre).
    #[serde(default)]
    pub hardening: f64,
    /// Number of layers of each half of its section, each of which yields by itself: with
    /// more than 1 it begins to yield at two thirds of `moment`, more and more of it up to that.
    #[serde(default = "one_layer")]
    pub layers: usize,
}

impl SheetYield {
    /// Its numbers, of a sheet whose material yields as given; nothing without a moment.
    pub(crate) fn numbers(&self, of_material: Option<Yield>) -> Option<Yield> {
        let moment = self.moment.or(of_material.map(|y| y.moment))?;
        let of_material = of_material.filter(|_| self.moment.is_none());
        let hardening = self.hardening.or(of_material.map(|y| y.hardening));
        Some(Yield {
            moment,
            hardening: hardening.unwrap_or(0.0),
            layers: self.layers,
        })
    }

    pub(crate) fn check(&self, key: &Key, checks: &mut Checks) {
        checks.positive(key.name("moment"), self.moment, Unit::Newton);
        checks.not_negative(key.name("hardening"), self.hardening, Unit::NewtonMetre);
        check_layers(key, self.layers, checks);
    }
}

impl CreaseYield {
    /// The yield of an edge of a length, metres.
    pub(crate) fn of_edge(&self, length: f64) -> Yield {
        Yield {
            moment: self.moment * length,
            hardening: self.hardening * length,
            layers: self.layers,
        }
    }

    pub(crate) fn check(&self, key: &Key, checks: &mut Checks) {
        checks.positive(key.name("moment"), self.moment, Unit::Newton);
        checks.not_negative(key.name("hardening"), self.hardening, Unit::Newton);
        check_layers(key, self.layers, checks);
    }
}
