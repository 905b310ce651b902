//! Where the mesh of a sheet comes from.

use super::error::SceneError;
use super::key::Key;
use super::outline::Outline;
use super::pattern::{
    DegreeFour, EdgeRoles, Hypar, Kresling, Miura, SquareTwist, Waterbomb, Yoshimura, check_angle,
};
use super::problem::{Checks, Problem};
use super::unit::Unit;
use crate::format::{
    self, FoldFrame, FoldProblem, GltfProblem, MeshFileError, MeshFileProblem, MeshOptions,
    Polygons, ReadingChanges, SeparateBuffers, read_mesh_with,
};
use isosheet_mesh::Advice;
use isosheet_mesh::Sheet;
use isosheet_mesh::generate::{self, FoldPattern, GenerateError};
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};
use std::path::{Path, PathBuf};

/// Where a mesh comes from. Generated ones are flat in the plane z = 0.
///
/// ```toml
/// [sheet]
/// mesh = { rectangle = { width = 0.297, height = 0.21, columns = 12, rows = 8, diagonals = "rising" } }
/// ```
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case", deny_unknown_fields)]
pub enum Mesh {
    /// The square `[0, side] x [0, side]` in the union-jack pattern, 2^(level + 1) cells each way.
    Square {
        /// Side, metres.
        side: f64,
        /// Level of refinement: 0 to 4 have 9, 25, 81, 289 and 1089 vertices.
        level: u32,
    },
    /// The rectangle `[0, width] x [0, height]` in cells of two triangles. Vertex (i, j) has the number
    /// i + j (columns + 1).
    Rectangle {
        /// Extent along x, metres.
        width: f64,
        /// Extent along y, metres.
        height: f64,
        /// Number of cells along x.
        columns: usize,
        /// Number of cells along y.
        rows: usize,
        /// How the cells are cut.
        #[serde(default)]
        diagonals: Diagonals,
    },
    /// A disk about the origin in concentric rings of triangles.
    Disk {
        /// Radius, metres.
        radius: f64,
        /// Number of rings.
        rings: usize,
    },
    /// A ring about the origin.
    Annulus {
        /// Inner radius, metres.
        inner: f64,
        /// Outer radius, metres.
        outer: f64,
        /// Number of vertices of each circle.
        segments: usize,
        /// Number of rings of triangles.
        rings: usize,
    },
    /// A circular sector in triangles about one vertex, that with the number 0: glued along its straight sides
    /// it is a cone.
    Fan {
        /// Radius, metres.
        radius: f64,
        /// Angle, degrees, below 360, and below 180 for each triangle.
        opening: f64,
        /// Number of triangles.
        triangles: usize,
    },
    /// An irregular triangulation of a polygon.
    Polygon {
        /// The outline.
        outline: Outline,
        /// Length of the edges, about, metres.
        spacing: f64,
        /// Another number gives another triangulation.
        #[serde(default)]
        seed: u64,
    },
    /// A polygon in concentric rings of triangles about the origin: the lines from there to the corners are
    /// edges. The outline has to run counter-clockwise round the origin.
    PolygonRings {
        /// The outline.
        outline: Outline,
        /// Number of rings.
        rings: usize,
    },
    /// The regular octagon about the origin with 244 vertices and 440 faces, a lattice of triangles.
    Octagon {
        /// Radius of the circle through the corners, metres.
        radius: f64,
    },
    /// Miura's crease pattern, with mountains and valleys.
    Miura(Miura),
    /// A crease pattern of four creases that meet in a vertex.
    DegreeFour(DegreeFour),
    /// The waterbomb tessellation, with mountains and valleys.
    Waterbomb(Waterbomb),
    /// Yoshimura's crease pattern, with mountains and valleys.
    Yoshimura(Yoshimura),
    /// Kresling's crease pattern, with mountains and valleys.
    Kresling(Kresling),
    /// The pleated hyperbolic paraboloid, with mountains and valleys.
    Hypar(Hypar),
    /// The square twist, with mountains and valleys.
    SquareTwist(SquareTwist),
    /// The triangles of a small mesh, or of a program.
    Triangles {
        /// Coordinates of the vertices, metres.
        vertices: Vec<[f64; 3]>,
        /// Vertices of each triangle by their numbers, from 0, counter-clockwise as seen from the same side.
        faces: Vec<[u32; 3]>,
    },
    /// A mesh file: OBJ, OFF, STL, PLY, FOLD (with its crease pattern) or glTF.
    File(MeshFile),
}

/// A mesh in a file.
///
/// ```toml
/// [sheet]
/// mesh = { file = { path = "crane.fold", scale = 0.001, frame = 0 } }
/// ```
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct MeshFile {
    /// Path of the mesh file, relative to the scene file.
    pub path: PathBuf,
    /// Length of one unit of the file, metres: 0.001 for a file in millimetres.
    #[serde(default = "one")]
    pub scale: f64,
    /// The axis of the file that points upwards; it becomes z.
    #[serde(default)]
    pub up: UpAxis,
    /// What to do with faces of more than three corners.
    #[serde(default)]
    pub polygons: PolygonFaces,
    /// Of a FOLD file: the frame whose vertices are taken, by its number from 0 or by its title; if left out,
    /// the first one with vertices. Frame 0 is the key frame of the file. One file can give the flat crease
    /// pattern to `sheet.mesh` and a folded form of it to `sheet.start.file`.
    #[serde(default)]
    pub frame: Option<FoldFrame>,
    /// Of a glTF file: the name of the mesh that is taken; if left out, all meshes that its scene shows, each
    /// where its nodes place it.
    #[serde(default)]
    pub mesh: Option<String>,
}

fn one() -> f64 {
    1.0
}

/// How the cells of a rectangle are cut into triangles.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
pub enum Diagonals {
    /// In alternating directions.
    #[default]
    UnionJack,
    /// All from lower right to upper left.
    Falling,
    /// All from lower left to upper right.
    Rising,
}

/// The axis of a file that points upwards.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
pub enum UpAxis {
    /// z: coordinates are used as they are.
    #[default]
    Z,
    /// y: (x, y, z) becomes (x, -z, y).
    Y,
}

/// What to do with faces of more than three corners.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
pub enum PolygonFaces {
    /// Refuse the file: new diagonals are new lines along which the sheet can fold.
    #[default]
    Refuse,
    /// Cut them into triangles.
    Triangulate,
}

impl MeshFile {
    /// A file in metres with z upwards.
    pub fn new(path: impl Into<PathBuf>) -> Self {
        Self {
            path: path.into(),
            scale: 1.0,
            ..Self::default()
        }
    }

    pub(crate) fn check(&self, key: &Key, checks: &mut Checks) {
        checks.positive(key.name("scale"), self.scale, Unit::Metre);
        if self.path.as_os_str().is_empty() {
            checks.report(key.name("path"), "the path is empty", "name a mesh file");
        }
    }

    /// Reads the file, in metres and with z upwards; relative paths are relative to `folder`.
    pub(crate) fn read(&self, key: &Key, folder: &Path) -> Result<format::MeshFile, Problem> {
        self.read_frame(self.frame.as_ref(), folder).map_err(|e| {
            let name = match &e.problem {
                problem if is_about_frame(problem) => "frame",
                MeshFileProblem::NoNames | MeshFileProblem::Gltf(GltfProblem::NoMesh { .. })
                    if self.mesh.is_some() =>
                {
                    "mesh"
                }
                _ => "path",
            };
            Problem::new(key.name(name), e.to_string(), file_remedy(&e))
        })
    }

    /// Reads another frame in the same way.
    pub(crate) fn read_frame(
        &self,
        frame: Option<&FoldFrame>,
        folder: &Path,
    ) -> Result<format::MeshFile, MeshFileError> {
        let options = MeshOptions {
            polygons: match self.polygons {
                PolygonFaces::Refuse => Polygons::Refuse,
                PolygonFaces::Triangulate => Polygons::Triangulate,
            },
            // The folder of a run keeps a copy of one file for each mesh.
            buffers: SeparateBuffers::Refuse,
            frame: frame.cloned(),
            mesh: self.mesh.clone(),
            ..MeshOptions::default()
        };
        let path = folder.join(&self.path);
        let mut mesh = read_mesh_with(&path, &options)?;
        for p in mesh.positions.as_chunks_mut::<3>().0 {
            let [x, y, z] = p.map(|c| self.scale * c);
            *p = match self.up {
                UpAxis::Z => [x, y, z],
                UpAxis::Y => [x, -z, y],
            };
        }
        Ok(mesh)
    }
}

/// A mesh, and what its edges are meant to do if it is a crease pattern.
pub(crate) struct RestMesh {
    pub(crate) sheet: Sheet,
    pub(crate) roles: Option<EdgeRoles>,
    /// What reading a file changed.
    pub(crate) changes: ReadingChanges,
}

impl RestMesh {
    fn of(pattern: FoldPattern, roles: EdgeRoles) -> Self {
        Self {
            roles: Some(roles),
            ..Self::plain(pattern.sheet)
        }
    }

    /// Of which it is not known what its edges are meant to do.
    fn plain(sheet: Sheet) -> Self {
        Self {
            sheet,
            roles: None,
            changes: ReadingChanges::default(),
        }
    }
}

impl Mesh {
    /// The name of the key.
    pub(crate) fn name(&self) -> &'static str {
        match self {
            Self::Square { .. } => "square",
            Self::Rectangle { .. } => "rectangle",
            Self::Disk { .. } => "disk",
            Self::Annulus { .. } => "annulus",
            Self::Fan { .. } => "fan",
            Self::Polygon { .. } => "polygon",
            Self::PolygonRings { .. } => "polygon_rings",
            Self::Octagon { .. } => "octagon",
            Self::Miura(_) => "miura",
            Self::DegreeFour(_) => "degree_four",
            Self::Waterbomb(_) => "waterbomb",
            Self::Yoshimura(_) => "yoshimura",
            Self::Kresling(_) => "kresling",
            Self::Hypar(_) => "hypar",
            Self::SquareTwist(_) => "square_twist",
            Self::Triangles { .. } => "triangles",
            Self::File(_) => "file",
        }
    }

    pub(crate) fn check(&self, key: &Key, checks: &mut Checks) {
        let key = key.name(self.name());
        let mut length =
            |name: &str, value: f64| checks.positive(key.name(name), value, Unit::Metre);
        match self {
            Self::Square { side, .. } => length("side", *side),
            Self::Rectangle {
                width,
                height,
                columns,
                rows,
                ..
            } => {
                length("width", *width);
                length("height", *height);
                checks.count(key.name("columns"), *columns, 1);
                checks.count(key.name("rows"), *rows, 1);
            }
            Self::Disk { radius, rings } => {
                length("radius", *radius);
                checks.count(key.name("rings"), *rings, 1);
            }
            Self::Annulus {
                inner,
                outer,
                segments,
                rings,
            } => {
                length("inner", *inner);
                length("outer", *outer);
                checks.count(key.name("segments"), *segments, 3);
                checks.count(key.name("rings"), *rings, 1);
            }
            Self::Fan {
                radius,
                opening,
                triangles,
            } => {
                length("radius", *radius);
                let most = 360_f64.min(180.0 * (*triangles).max(1) as f64);
                check_angle(key.name("opening"), *opening, most, checks);
                checks.count(key.name("triangles"), *triangles, 1);
            }
            Self::Polygon {
                outline, spacing, ..
            } => {
                length("spacing", *spacing);
                outline.check(&key.name("outline"), checks);
            }
            Self::PolygonRings { outline, rings } => {
                outline.check(&key.name("outline"), checks);
                checks.count(key.name("rings"), *rings, 1);
            }
            Self::Octagon { radius } => length("radius", *radius),
            Self::Miura(miura) => miura.check(&key, checks),
            Self::DegreeFour(vertex) => vertex.check(&key, checks),
            Self::Waterbomb(pattern) => pattern.check(&key, checks),
            Self::Yoshimura(pattern) => pattern.check(&key, checks),
            Self::Kresling(pattern) => pattern.check(&key, checks),
            Self::Hypar(pattern) => pattern.check(&key, checks),
            Self::SquareTwist(twist) => twist.check(&key, checks),
            Self::Triangles { vertices, .. } => {
                for (k, vertex) in vertices.iter().enumerate() {
                    checks.finite(key.name("vertices").entry(k), vertex, Unit::Metre);
                }
            }
            Self::File(file) => file.check(&key, checks),
        }
    }

    /// The sheet of the mesh; files are relative to `folder`.
    ///
    /// # Errors
    /// [`SceneError`] if the mesh cannot be made.
    pub fn sheet(&self, folder: &Path) -> Result<Sheet, SceneError> {
        let (key, mut checks) = (Key::root().name("mesh"), Checks::default());
        self.check(&key, &mut checks);
        SceneError::of(checks.problems)?;
        Ok(self.build(&key, folder)?.sheet)
    }

    /// Makes the mesh; files are relative to `folder`.
    pub(crate) fn build(&self, key: &Key, folder: &Path) -> Result<RestMesh, Problem> {
        let key = key.name(self.name());
        let made = match self {
            Self::Square { side, level } => generate::isotropic_square(*level, *side),
            Self::Rectangle {
                width,
                height,
                columns,
                rows,
                diagonals,
            } => {
                let diagonals = match diagonals {
                    Diagonals::UnionJack => generate::Diagonals::UnionJack,
                    Diagonals::Falling => generate::Diagonals::Falling,
                    Diagonals::Rising => generate::Diagonals::Rising,
                };
                generate::grid(*columns, *rows, *width, *height, diagonals)
            }
            Self::Disk { radius, rings } => generate::disk(*rings, *radius),
            Self::Annulus {
                inner,
                outer,
                segments,
                rings,
            } => generate::annulus(*segments, *rings, *inner, *outer),
            Self::Fan {
                radius,
                opening,
                triangles,
            } => generate::fan(*triangles, *radius, opening.to_radians()),
            Self::Polygon {
                outline,
                spacing,
                seed,
            } => generate::delaunay(&outline.corners(), *spacing, *seed),
            Self::PolygonRings { outline, rings } => {
                generate::polygon_rings(&outline.corners(), *rings)
            }
            Self::Octagon { radius } => generate::octagon_244(*radius),
            Self::Miura(miura) => {
                let pattern = miura.pattern().map_err(|e| generator_problem(&key, &e))?;
                let roles = Miura::roles(&pattern);
                return Ok(RestMesh::of(pattern, roles));
            }
            Self::DegreeFour(vertex) => return of_pattern(&key, vertex.pattern()),
            Self::Waterbomb(pattern) => return of_pattern(&key, pattern.pattern()),
            Self::Yoshimura(pattern) => return of_pattern(&key, pattern.pattern()),
            Self::Kresling(pattern) => return of_pattern(&key, pattern.pattern()),
            Self::Hypar(pattern) => return of_pattern(&key, pattern.pattern()),
            Self::SquareTwist(twist) => return of_pattern(&key, twist.pattern()),
            Self::Triangles { vertices, faces } => {
                let sheet = Sheet::new(vertices.as_flattened().to_vec(), faces);
                let sheet = sheet.map_err(|e| Problem::from_error(key.name("faces"), &e))?;
                return Ok(RestMesh::plain(sheet));
            }
            Self::File(file) => return read_sheet(file, &key, folder),
        };
        let sheet = made.map_err(|e| generator_problem(&key, &e))?;
        Ok(RestMesh::plain(sheet))
    }
}

fn of_pattern(key: &Key, pattern: Result<FoldPattern, GenerateError>) -> Result<RestMesh, Problem> {
    let pattern = pattern.map_err(|e| generator_problem(key, &e))?;
    let roles = EdgeRoles::from(&pattern);
    Ok(RestMesh::of(pattern, roles))
}

fn read_sheet(file: &MeshFile, key: &Key, folder: &Path) -> Result<RestMesh, Problem> {
    let mesh = file.read(key, folder)?;
    let sheet = Sheet::new(mesh.positions.clone(), &mesh.faces).map_err(|error| {
        let path = file.path.display();
        let remedy = format!("`isosheet check {path} --fix -o FILE` repairs what can be repaired");
        Problem::new(key.name("path"), format!("{path}: {error}"), remedy)
    })?;
    let assignments = mesh.fold_assignments(sheet.topology());
    Ok(RestMesh {
        roles: assignments.map(|assignments| EdgeRoles {
            assignments,
            ..EdgeRoles::default()
        }),
        sheet,
        changes: mesh.changes,
    })
}

/// Whether a file is refused because of the frame that is asked for.
fn is_about_frame(problem: &MeshFileProblem) -> bool {
    matches!(
        problem,
        MeshFileProblem::NoFrames | MeshFileProblem::Fold(FoldProblem::Choice { .. })
    )
}

/// What to do about a mesh file that cannot be read, in words of scenes.
fn file_remedy(error: &MeshFileError) -> String {
    match &error.problem {
        MeshFileProblem::Polygon { .. } => {
            "triangulate the file as the sheet is meant to fold, or write `polygons = \"triangulate\"` beside \
             `path`"
                .to_owned()
        }
        MeshFileProblem::Read(_) => {
            "check the path, which is relative to the scene, and the permissions".to_owned()
        }
        problem if is_about_frame(problem) => problem.advice().unwrap_or_default().to_owned(),
        problem => {
            let advice = problem.advice().map(|advice| format!("{advice}; "));
            let advice = advice.unwrap_or_default();
            format!("{advice}`isosheet check` says more about a mesh file")
        }
    }
}

/// The problem at the argument that a generator names.
fn generator_problem(key: &Key, error: &GenerateError) -> Problem {
    let key = match error {
        GenerateError::Count { name, .. }
        | GenerateError::Size { name, .. }
        | GenerateError::Angle { name, .. } => key.name(name),
        GenerateError::Order { small, .. } => key.name(small),
        GenerateError::Outline { .. } => key.name("outline"),
        _ => key.clone(),
    };
    Problem::from_error(key, error)
}
