//! Bodies that the sheet meets.

use super::mesh::MeshFile;
use super::pose::{Motion, Pose};
use super::problem::{Checks, Key, Problem};
use isosheet_collide as collide;
use isosheet_collide::TriangleSurface;
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};
use std::path::Path;
use std::sync::Arc;

/// A body at rest or in prescribed motion.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Obstacle {
    /// Its form.
    pub shape: Shape,
    /// Where it is while displacements and angle of its motion are zero.
    #[serde(default)]
    pub pose: Pose,
    /// How it moves.
    #[serde(default)]
    pub motion: Motion,
    /// Coefficient of friction with the sheet.
    #[serde(default)]
    pub friction: f64,
}

/// The form of a body in its own frame.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case", deny_unknown_fields)]
pub enum Shape {
    /// Everything with z <= 0: a floor.
    HalfSpace,
    /// A box about the origin with edges along the axes.
    Box {
        /// Its extents along x, y and z, metres.
        size: [f64; 3],
    },
    /// A ball about the origin.
    Sphere {
        /// Its radius, metres.
        radius: f64,
    },
    /// A cylinder about the z axis with its middle at the origin.
    Cylinder {
        /// Its radius, metres.
        radius: f64,
        /// Its height, metres.
        height: f64,
    },
    /// A cylinder about the z axis with half balls at both ends and its middle at the origin.
    Capsule {
        /// Its radius, metres.
        radius: f64,
        /// Distance of the centres of the half balls, metres.
        length: f64,
    },
    /// The triangles of a mesh file: a solid if they are closed, otherwise a surface with two sides.
    File(MeshFile),
}

impl Obstacle {
    /// A body at rest without friction.
    pub fn new(shape: Shape) -> Self {
        Self {
            shape,
            pose: Pose::default(),
            motion: Motion::default(),
            friction: 0.0,
        }
    }

    pub(crate) fn check(&self, key: &Key, checks: &mut Checks) {
        let shape = key.name("shape").name(self.shape.name());
        let mut length = |name: &str, value: f64| checks.positive(shape.name(name), value, "m");
        match &self.shape {
            Shape::HalfSpace => {}
            Shape::Box { size } => {
                for (k, extent) in size.iter().enumerate() {
                    checks.positive(shape.name("size").entry(k), *extent, "m");
                }
            }
            Shape::Sphere { radius } => length("radius", *radius),
            Shape::Cylinder { radius, height } => {
                length("radius", *radius);
                length("height", *height);
            }
            Shape::Capsule {
                radius,
                length: distance,
            } => {
                length("radius", *radius);
                length("length", *distance);
            }
            Shape::File(file) => file.check(&shape, checks),
        }
        self.pose.check(&key.name("pose"), checks);
        self.motion.check(&key.name("motion"), checks);
        checks.not_negative(key.name("friction"), self.friction, "");
    }

    /// The body; files are relative to `folder`.
    pub(crate) fn build(&self, key: &Key, folder: &Path) -> Result<collide::Obstacle, Problem> {
        let shape = self.shape.build(&key.name("shape"), folder)?;
        let motion = self.motion.of_body(self.pose.isometry());
        let motion = isosheet_dynamics::RigidProfile::from(motion);
        collide::Obstacle::new(shape, motion).map_err(|e| Problem::from_error(key.clone(), &e))
    }
}

impl Shape {
    fn name(&self) -> &'static str {
        match self {
            Self::HalfSpace => "half_space",
            Self::Box { .. } => "box",
            Self::Sphere { .. } => "sphere",
            Self::Cylinder { .. } => "cylinder",
            Self::Capsule { .. } => "capsule",
            Self::File(_) => "file",
        }
    }

    fn build(&self, key: &Key, folder: &Path) -> Result<collide::Shape, Problem> {
        Ok(match self {
            Self::HalfSpace => collide::Shape::HalfSpace,
            Self::Box { size } => collide::Shape::Cuboid {
                half: size.map(|s| 0.5 * s),
            },
            Self::Sphere { radius } => collide::Shape::Sphere { radius: *radius },
            Self::Cylinder { radius, height } => collide::Shape::Cylinder {
                radius: *radius,
                half_height: 0.5 * height,
            },
            Self::Capsule { radius, length } => collide::Shape::Capsule {
                radius: *radius,
                half_length: 0.5 * length,
            },
            Self::File(file) => {
                let key = key.name("file");
                let mesh = file.read(&key, folder)?;
                let surface =
                    TriangleSurface::new(&mesh.positions, &mesh.faces).map_err(|error| {
                        let message = format!("{}: {error}", file.path.display());
                        let remedy =
                            "repair the surface, `isosheet check` says what else is wrong with it";
                        Problem::new(key.name("path"), message, remedy)
                    })?;
                collide::Shape::Surface(Arc::new(surface))
            }
        })
    }
}
