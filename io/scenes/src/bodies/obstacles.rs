//! Bodies that the sheet meets.

use crate::bodies::friction::FrictionKey;
use crate::meshes::mesh_file::{Files, MeshFileKey};
use crate::meshes::outline::Outline;
use crate::meshes::sequence::Sequence;
use crate::time::pose::{MotionKey, Pose};
use crate::words::key::Key;
use crate::words::part::Part;
use crate::words::problem::{Checks, Problem};
use crate::words::unit::Unit;
use isosheet_geometry as geometry;
use isosheet_geometry::{SurfaceError, TriangleSurface, rounded_line};
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};
use std::sync::Arc;

/// A body at rest or in prescribed motion.
///
/// ```toml
/// [[obstacle]]
/// shape = { box = { size = [0.5, 0.5, 0.3] } }
/// pose = { position = [0, 0, -0.2] }
/// motion = { z = { smooth_step = { to = 0.1, end = 1 } } }
/// friction = 0.3
/// ```
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema, Part)]
#[serde(deny_unknown_fields)]
#[checked]
pub struct ObstacleKey {
    /// Its name, by which `contact.pair` names it. If left out, it has none.
    #[serde(default)]
    pub name: Option<String>,
    /// Its form.
    pub shape: ShapeKey,
    /// Where it is while displacements and angle of its motion are zero.
    #[serde(default)]
    pub pose: Pose,
    /// How it moves.
    #[serde(default)]
    pub motion: MotionKey,
    /// Friction with the sheet.
    #[serde(default)]
    pub friction: FrictionKey,
}

/// The form of a body in its own frame.
///
/// ```toml
/// [[obstacle]]
/// shape = { capsule = { radius = 0.05, length = 0.3 } }
/// pose = { position = [0, 0, -0.1], turn = { axis = [1, 0, 0], angle = 90 } }
/// ```
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema, Part)]
#[serde(rename_all = "snake_case", deny_unknown_fields)]
pub enum ShapeKey {
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
    /// An upright prism with its middle at the origin.
    Prism {
        /// Its outline in the xy plane: convex, counter-clockwise.
        outline: Outline,
        /// Its height, metres.
        height: f64,
    },
    /// A square plate with a square opening about the z axis.
    Frame {
        /// Side of the plate, metres.
        outer: f64,
        /// Side of the opening, metres.
        opening: f64,
        /// Height of its lower face, metres.
        bottom: f64,
        /// Height of its upper face, metres.
        top: f64,
    },
    /// A thin wall that follows a line in the xz plane and extends along y, half to either side.
    Wall(Wall),
    /// Triangles from a program: a solid if they are closed, otherwise a surface with two sides.
    Triangles {
        /// Coordinates of the vertices, metres.
        vertices: Vec<[f64; 3]>,
        /// Vertices of each triangle by their numbers, from 0, counter-clockwise as seen from outside.
        faces: Vec<[u32; 3]>,
    },
    /// The triangles of a mesh file: a solid if they are closed, otherwise a surface with two sides.
    File(MeshFileKey),
    /// A mesh in motion, which may deform: a surface with two sides. It is an obstacle alone, has no other
    /// `motion`, and passes through other obstacles.
    Sequence(Sequence),
}

/// A thin wall with two sides.
///
/// ```toml
/// [[obstacle]]
/// shape = { wall = { line = [[0, 0], [0.3, 0], [0.5, 0.2]], corner_radius = 0.1, width = 0.4 } }
/// pose = { position = [0, 0, -1] }
/// ```
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema, Part)]
#[serde(deny_unknown_fields)]
pub struct Wall {
    /// The points of its line, x and z in metres.
    pub line: Vec<[f64; 2]>,
    /// Radius of the corners of the line, metres.
    #[serde(default)]
    pub corner_radius: f64,
    /// Its width along y, metres.
    pub width: f64,
}

impl Wall {
    /// Its line with the corners rounded, x and z in metres.
    ///
    /// # Errors
    /// [`SurfaceError`] naming the point or length that cannot be used.
    pub fn rounded(&self) -> Result<Vec<[f64; 2]>, SurfaceError> {
        rounded_line(&self.line, self.corner_radius)
    }

    fn surface(&self) -> Result<TriangleSurface, SurfaceError> {
        TriangleSurface::wall(&self.rounded()?, self.width)
    }
}

impl ObstacleKey {
    /// A body at rest without friction.
    pub fn new(shape: ShapeKey) -> Self {
        Self {
            name: None,
            shape,
            pose: Pose::default(),
            motion: MotionKey::default(),
            friction: FrictionKey::default(),
        }
    }

    /// What it is called in messages and results: its name, or `obstacle[0]` by its number in the scene.
    pub fn called(&self, number: usize) -> String {
        let numbered = || Key::root().name("obstacle").entry(number).to_string();
        self.name.clone().unwrap_or_else(numbered)
    }

    pub(crate) fn check(&self, key: &Key, checks: &mut Checks) {
        self.shape.check(&key.name("shape"), checks);
        if matches!(self.shape, ShapeKey::Sequence(_)) && self.motion != MotionKey::default() {
            let message = "the obstacle is a mesh in motion, and moves besides";
            let remedy = "leave out `motion`, and place the mesh by `pose`";
            checks.report(key.name("motion"), message, remedy);
        }
    }
}

impl ShapeKey {
    pub(crate) fn check(&self, key: &Key, checks: &mut Checks) {
        let shape = key.name(self.name());
        let mut length =
            |name: &str, value: f64| checks.positive(shape.name(name), value, Unit::Metre);
        match self {
            ShapeKey::HalfSpace => {}
            ShapeKey::Box { size } => {
                for (k, extent) in size.iter().enumerate() {
                    checks.positive(shape.name("size").entry(k), *extent, Unit::Metre);
                }
            }
            ShapeKey::Sphere { radius } => length("radius", *radius),
            ShapeKey::Cylinder { radius, height } => {
                length("radius", *radius);
                length("height", *height);
            }
            ShapeKey::Capsule {
                radius,
                length: distance,
            } => {
                length("radius", *radius);
                if *distance == 0.0 {
                    let message = "the capsule has no length: it is a sphere";
                    let remedy = "write `sphere = { radius = ... }`, or give a length above 0";
                    checks.report(shape.name("length"), message, remedy);
                } else {
                    checks.positive(shape.name("length"), *distance, Unit::Metre);
                }
            }
            ShapeKey::Prism { outline, height } => {
                length("height", *height);
                outline.check(&shape.name("outline"), checks);
            }
            ShapeKey::Frame {
                outer,
                opening,
                bottom,
                top,
            } => {
                length("outer", *outer);
                length("opening", *opening);
                checks.number(shape.name("bottom"), *bottom, Unit::Metre);
                checks.number(shape.name("top"), *top, Unit::Metre);
            }
            ShapeKey::Wall(wall) => {
                length("width", wall.width);
                checks.points(shape.name("line"), &wall.line);
                checks.count(shape.name("line"), wall.line.len(), 2);
                checks.not_negative(shape.name("corner_radius"), wall.corner_radius, Unit::Metre);
            }
            ShapeKey::Triangles { vertices, .. } => checks.points(shape.name("vertices"), vertices),
            ShapeKey::File(_) | ShapeKey::Sequence(_) => {}
        }
    }

    pub(crate) fn name(&self) -> &'static str {
        match self {
            Self::HalfSpace => "half_space",
            Self::Box { .. } => "box",
            Self::Sphere { .. } => "sphere",
            Self::Cylinder { .. } => "cylinder",
            Self::Capsule { .. } => "capsule",
            Self::Prism { .. } => "prism",
            Self::Frame { .. } => "frame",
            Self::Wall(_) => "wall",
            Self::Triangles { .. } => "triangles",
            Self::File(_) => "file",
            Self::Sequence(_) => "sequence",
        }
    }

    /// Makes the shape; `key` is its place.
    pub(crate) fn build(&self, key: &Key, files: &mut Files) -> Result<geometry::Shape, Problem> {
        let solid = |surface: Result<TriangleSurface, SurfaceError>| {
            let surface = surface.map_err(|e| form_problem(&key.name(self.name()), &e))?;
            Ok(geometry::Shape::Surface(Arc::new(surface)))
        };
        Ok(match self {
            Self::HalfSpace => geometry::Shape::HalfSpace,
            Self::Box { size } => geometry::Shape::Cuboid {
                half: size.map(|s| 0.5 * s),
            },
            Self::Sphere { radius } => geometry::Shape::Sphere { radius: *radius },
            Self::Cylinder { radius, height } => geometry::Shape::Cylinder {
                radius: *radius,
                half_height: 0.5 * height,
            },
            Self::Capsule { radius, length } => geometry::Shape::Capsule {
                radius: *radius,
                half_length: 0.5 * length,
            },
            Self::Prism { outline, height } => {
                return solid(TriangleSurface::prism(&outline.corners(), *height));
            }
            Self::Frame {
                outer,
                opening,
                bottom,
                top,
            } => return solid(TriangleSurface::frame(*outer, *opening, [*bottom, *top])),
            Self::Wall(wall) => return solid(wall.surface()),
            Self::Triangles { vertices, faces } => {
                return solid(TriangleSurface::new(vertices.as_flattened(), faces));
            }
            Self::File(file) => {
                let key = key.name("file");
                let mesh = files.read(file, &key)?;
                let surface =
                    TriangleSurface::new(&mesh.positions, &mesh.faces).map_err(|error| {
                        let message = format!("{}: {error}", file.path.display());
                        let remedy =
                            "repair the surface, `isosheet check` says what else is wrong with it";
                        Problem::new(key.name("path"), message, remedy)
                    })?;
                geometry::Shape::Surface(Arc::new(surface))
            }
            Self::Sequence(_) => {
                let message = "a mesh in motion has no form of its own";
                return Err(Problem::new(
                    key.name("sequence"),
                    message,
                    "make it an `[[obstacle]]`",
                ));
            }
        })
    }
}

/// The problem of a surface made by formula, at the value that the error names.
fn form_problem(key: &Key, error: &SurfaceError) -> Problem {
    let key = match error {
        SurfaceError::Length { name, .. } if !name.contains(' ') => key.name(name),
        _ => key.clone(),
    };
    Problem::from_error(key, error)
}
