//! The curvature that a sheet has by itself.

use crate::meshes::direction::Direction;
use crate::meshes::mesh_file::MeshFileKey;
use crate::time::profile::ProfileKey;
use crate::words::key::Key;
use crate::words::part::Part;
use crate::words::problem::Checks;
use crate::words::unit::Unit;
use isosheet_dynamics::Curvature;
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

/// A curvature that a sheet has by itself: paper that curls, a poster off a roll, a bilayer. It is given by
/// radii, by its components, or by another shape of the mesh.
///
/// ```toml
/// [sheet]
/// material = "office paper"
/// curl = { along = [1, 0, 0], radius = 0.05 }
/// ```
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema, Part)]
#[serde(deny_unknown_fields)]
pub struct CurlKey {
    /// The direction along which the sheet is curved, in the frame of the mesh, of any length. By default the
    /// direction of the sheet.
    #[serde(default)]
    pub along: Option<[f64; 3]>,
    /// Radius of curvature, metres: positive where the sheet rolls up with the front of its faces inside,
    /// from which their corners run counter-clockwise. If left out, the sheet is straight along the
    /// direction.
    #[serde(default)]
    pub radius: Option<f64>,
    /// Radius of curvature across this direction, metres. If left out, the sheet is straight across.
    #[serde(default)]
    pub across_radius: Option<f64>,
    /// In place of `radius`: curvature `k11` along the direction, 1/m.
    #[serde(default)]
    pub curvature: Option<f64>,
    /// In place of `across_radius`: curvature `k22` across it, 1/m.
    #[serde(default)]
    pub across_curvature: Option<f64>,
    /// Twist `k12`, 1/m: the angle in radians by which a line across the direction turns in a metre. A narrow
    /// strip with this alone is a helicoid.
    #[serde(default)]
    pub twist: Option<f64>,
    /// In place of all of these: a shape with the vertices and faces of `mesh`, whose curvature the sheet
    /// has, face by face. The sheet keeps the lengths of `mesh`.
    #[serde(default)]
    pub shape: Option<MeshFileKey>,
    /// A factor of time by which the curvatures are multiplied.
    #[serde(default = "one")]
    #[unit(Factor)]
    pub profile: ProfileKey,
}

fn one() -> ProfileKey {
    ProfileKey::Constant(1.0)
}

impl CurlKey {
    /// The curvature by its direction, of a curl without a shape.
    pub(crate) fn tensor(&self) -> Curvature {
        let either = |k: Option<f64>, radius: Option<f64>| {
            k.or(radius.map(|radius| 1.0 / radius)).unwrap_or(0.0)
        };
        Curvature {
            along: either(self.curvature, self.radius),
            across: either(self.across_curvature, self.across_radius),
            twist: self.twist.unwrap_or(0.0),
        }
    }

    pub(crate) fn check(&self, of_sheet: Option<&Direction>, key: &Key, checks: &mut Checks) {
        if let Some(along) = &self.along {
            checks.direction(key.name("along"), along);
        }
        for (name, radius) in [
            ("radius", self.radius),
            ("across_radius", self.across_radius),
        ] {
            checks.positive(key.name(name), radius.map(f64::abs), Unit::Metre);
        }
        for (name, k) in [
            ("curvature", self.curvature),
            ("across_curvature", self.across_curvature),
            ("twist", self.twist),
        ] {
            if let Some(k) = k {
                checks.number(key.name(name), k, Unit::PerMetre);
            }
        }
        for (k, radius, names) in [
            (self.curvature, self.radius, ["curvature", "radius"]),
            (
                self.across_curvature,
                self.across_radius,
                ["across_curvature", "across_radius"],
            ),
        ] {
            if k.is_some() && radius.is_some() {
                let [k, radius] = names;
                let message = format!("`{k}` and `{radius}` are the same curvature");
                checks.report(key.name(k), message, "give one of them");
            }
        }
        let numbers = [
            self.radius,
            self.across_radius,
            self.curvature,
            self.across_curvature,
            self.twist,
        ];
        let has_numbers = numbers.iter().any(Option::is_some);
        if self.shape.is_some() {
            if has_numbers || self.along.is_some() {
                let message = "the curvature is given twice, by a shape and by numbers";
                checks.report(key.clone(), message, "give one of them");
            }
        } else if !has_numbers {
            let message = "nothing says how the sheet is curved";
            let remedy = "give `radius`, `curvature`, `across_curvature`, `twist` or `shape`";
            checks.report(key.clone(), message, remedy);
        } else if self.along.is_none() && of_sheet.is_none() {
            let message = "the curvature has no direction";
            checks.report(key.clone(), message, "give `along`, for instance [1, 0, 0]");
        }
    }
}
