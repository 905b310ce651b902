//! How a sheet starts.

use crate::meshes::mesh_file::MeshFileKey;
use crate::words::key::Key;
use crate::words::part::Part;
use crate::words::problem::Checks;
use crate::words::unit::Unit;
use nalgebra::Vector3;
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

/// How the sheet starts.
///
/// ```toml
/// [sheet]
/// start = { perturbation = 0.01, seed = 1, velocity = [1, 0, 2], spin = { axis = [0, 1, 0], rate = 360 } }
/// ```
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize, JsonSchema, Part)]
#[serde(default, deny_unknown_fields)]
#[checked]
pub struct StartKey {
    /// A mesh file with the vertices and faces of `mesh` in the same order, with the positions at the start.
    /// It is placed as the rest shape is. With rigid rods, lengths that differ from the rest lengths by up to
    /// 1e-4 of these, as in files of six digits, are corrected by moving the vertices.
    pub file: Option<MeshFileKey>,
    /// The positions of the vertices of `mesh` at the start as a list, in its order, metres.
    pub positions: Option<Vec<[f64; 3]>>,
    /// Velocities of the vertices of `mesh` in space, in its order, m/s, beside `velocity` and `spin`.
    pub velocities: Option<Vec<[f64; 3]>>,
    /// Size of a random displacement of all free vertices, as a part of the mean edge length, from 0 to 1:
    /// conservative methods cannot start from a flat sheet under load.
    pub perturbation: f64,
    /// Another number gives another displacement.
    pub seed: u64,
    /// Velocity in space, m/s: the sheet is thrown. Vertices that a pin holds move with the pin.
    pub velocity: [f64; 3],
    /// Rotation beside the velocity. If left out, the sheet does not turn.
    pub spin: Option<Spin>,
}

/// A rotation with which a sheet or a body starts: `v(x) = velocity + w × (x - centre)`.
///
/// ```toml
/// [sheet.start]
/// velocity = [0, 0, 3]
/// spin = { axis = [1, 0, 0], rate = 720 }
/// ```
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize, JsonSchema, Part)]
#[serde(deny_unknown_fields)]
#[checked]
pub struct Spin {
    /// Direction of the axis in space, of any length; it turns counter-clockwise seen against it.
    pub axis: [f64; 3],
    /// Angular velocity, degrees/s.
    pub rate: f64,
    /// A point of the axis, metres. If left out, the centre of mass.
    #[serde(default)]
    pub centre: Option<[f64; 3]>,
}

impl StartKey {
    pub(crate) fn check(&self, key: &Key, checks: &mut Checks) {
        let size = key.name("perturbation");
        checks.within(size, self.perturbation, [0.0, 1.0]);
        if let Some(positions) = &self.positions {
            let key = key.name("positions");
            checks.points(key.clone(), positions);
            if self.file.is_some() {
                let message = "the start is given twice, by a list of positions and by a file";
                checks.report(key, message, "leave one of both out");
            }
        }
        for (key, velocity) in key
            .name("velocities")
            .entries(self.velocities.as_deref().unwrap_or_default())
        {
            checks.finite(key, velocity, Unit::MetrePerSecond);
        }
        checks.count(key.name("seed"), self.seed, 0);
        checks.finite(key.name("velocity"), &self.velocity, Unit::MetrePerSecond);
    }

    /// Whether the sheet starts with another shape than that of its mesh.
    pub(crate) fn has_shape(&self) -> bool {
        self.file.is_some() || self.positions.is_some()
    }

    /// Whether the sheet starts in motion.
    pub(crate) fn is_moving(&self) -> bool {
        self.velocity != [0.0; 3]
            || self.velocities.is_some()
            || self.spin.is_some_and(|spin| spin.rate != 0.0)
    }

    /// The velocities of points (metres) whose centre of mass is given, m/s.
    pub(crate) fn velocities(&self, points: &[[f64; 3]], centre: Vector3<f64>) -> Vec<[f64; 3]> {
        velocities(points, self.velocity, self.spin, centre)
    }
}

impl Spin {
    pub(crate) fn check(&self, key: &Key, checks: &mut Checks) {
        checks.direction(key.name("axis"), &self.axis);
        checks.number(key.name("rate"), self.rate, Unit::Degree);
        if let Some(centre) = &self.centre {
            checks.finite(key.name("centre"), centre, Unit::Metre);
        }
    }
}

/// The velocities of points (metres) of what moves with a velocity (m/s) and a spin, and whose centre of mass
/// is given, m/s.
pub(crate) fn velocities(
    points: &[[f64; 3]],
    velocity: [f64; 3],
    spin: Option<Spin>,
    centre: Vector3<f64>,
) -> Vec<[f64; 3]> {
    let linear = Vector3::from(velocity);
    let Some(spin) = spin else {
        return vec![velocity; points.len()];
    };
    let angular = spin.rate.to_radians() * Vector3::from(spin.axis).normalize();
    let centre = spin.centre.map_or(centre, Vector3::from);
    let of = |p: &[f64; 3]| (linear + angular.cross(&(Vector3::from(*p) - centre))).into();
    points.iter().map(of).collect()
}
