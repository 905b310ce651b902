//! Where the mesh of a sheet comes from.

use crate::meshes::direction::FaceTexture;
use crate::meshes::drawing::DrawingFile;
use crate::meshes::mesh_file::{Files, MeshFileKey};
use crate::meshes::outline::Outline;
use crate::meshes::pattern::{
    DegreeFourKey, EdgeRoles, Hypar, Kresling, MiuraKey, SquareTwist, Waterbomb, Yoshimura,
};
use crate::meshes::strip_between::StripBetween;
use crate::words::error::SceneError;
use crate::words::key::Key;
use crate::words::part::Part;
use crate::words::problem::{Checks, Problem};
use crate::words::unit::Unit;
use isosheet_formats::{DrawnEdges, FaceGroups, MeshFile, MeshFileProblem, ReadingChanges};
use isosheet_mesh::generate::{FoldPattern, GenerateError};
use isosheet_mesh::{Advice, MeshError, Sheet, generate};
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};
use std::path::Path;

/// Where a mesh comes from. Generated ones are flat in the plane z = 0, but for a strip between two curves.
///
/// ```toml
/// [sheet]
/// mesh = { rectangle = { width = 0.297, height = 0.21, columns = 12, rows = 8, diagonals = "rising" } }
/// ```
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema, Part)]
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
        diagonals: DiagonalsKey,
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
    /// A circular sector in triangles about the vertex 0: glued along its straight sides it is a cone.
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
    Miura(MiuraKey),
    /// A crease pattern of four creases that meet in a vertex.
    DegreeFour(DegreeFourKey),
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
    /// The developable strip between two curves, in space.
    StripBetween(StripBetween),
    /// The triangles of a small mesh, or of a program.
    Triangles {
        /// Coordinates of the vertices, metres.
        vertices: Vec<[f64; 3]>,
        /// Vertices of each triangle by their numbers, from 0, counter-clockwise as seen from the same side.
        faces: Vec<[u32; 3]>,
    },
    /// A mesh file: OBJ, OFF, STL, PLY, FOLD (with its crease pattern) or glTF.
    File(MeshFileKey),
    /// A drawing: SVG or DXF, with its creases, cuts and holes.
    Drawing(DrawingFile),
}

/// How the cells of a rectangle are cut into triangles.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize, JsonSchema, Part)]
#[serde(rename_all = "snake_case")]
pub enum DiagonalsKey {
    /// In alternating directions.
    #[default]
    UnionJack,
    /// All from lower right to upper left.
    Falling,
    /// All from lower left to upper right.
    Rising,
}

/// An argument of a generator.
enum Argument {
    /// In metres.
    Length(f64),
    /// Of at least so many.
    Count(usize, i64),
    /// In degrees, between 0 and a largest one, both excluded.
    Angle(f64, f64),
}

impl Argument {
    fn check(self, key: Key, checks: &mut Checks) {
        match self {
            Self::Length(length) => checks.positive(key, length, Unit::Metre),
            Self::Count(count, least) => checks.count(key, count, least),
            Self::Angle(angle, most) if !(angle > 0.0 && angle < most) => {
                let message = format!("`{key}` is {angle} degrees");
                let remedy = format!("give more than 0 and less than {most}");
                checks.report(key, message, remedy);
            }
            Self::Angle(..) => {}
        }
    }
}

/// A mesh, and what its edges are meant to do if it is a crease pattern.
pub(crate) struct RestMesh {
    pub(crate) sheet: Sheet,
    pub(crate) roles: Option<EdgeRoles>,
    /// The groups of faces that a file names.
    pub(crate) groups: FaceGroups,
    /// The texture coordinates of its faces, if a file has any.
    pub(crate) texture: Vec<FaceTexture>,
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
            groups: FaceGroups::default(),
            texture: Vec::new(),
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
            Self::StripBetween(_) => "strip_between",
            Self::Triangles { .. } => "triangles",
            Self::File(_) => "file",
            Self::Drawing(_) => "drawing",
        }
    }

    /// The arguments of its generator that are lengths, counts and angles, by their keys.
    fn arguments(&self) -> Vec<(&'static str, Argument)> {
        use Argument::{Angle, Count, Length};
        match self {
            Self::Square { side, .. } => vec![("side", Length(*side))],
            Self::Rectangle {
                width,
                height,
                columns,
                rows,
                ..
            } => vec![
                ("width", Length(*width)),
                ("height", Length(*height)),
                ("columns", Count(*columns, 1)),
                ("rows", Count(*rows, 1)),
            ],
            Self::Disk { radius, rings } => {
                vec![("radius", Length(*radius)), ("rings", Count(*rings, 1))]
            }
            Self::Annulus {
                inner,
                outer,
                segments,
                rings,
            } => vec![
                ("inner", Length(*inner)),
                ("outer", Length(*outer)),
                ("segments", Count(*segments, 3)),
                ("rings", Count(*rings, 1)),
            ],
            Self::Fan {
                radius,
                opening,
                triangles,
            } => {
                let most = 360_f64.min(180.0 * (*triangles).max(1) as f64);
                vec![
                    ("radius", Length(*radius)),
                    ("opening", Angle(*opening, most)),
                    ("triangles", Count(*triangles, 1)),
                ]
            }
            Self::Polygon { spacing, .. } => vec![("spacing", Length(*spacing))],
            Self::PolygonRings { rings, .. } => vec![("rings", Count(*rings, 1))],
            Self::Octagon { radius } => vec![("radius", Length(*radius))],
            Self::Miura(miura) => vec![
                ("straight", Length(miura.straight)),
                ("zigzag", Length(miura.zigzag)),
                ("columns", Count(miura.columns, 1)),
                ("rows", Count(miura.rows, 1)),
                ("angle", Angle(miura.angle, 90.0)),
            ],
            Self::DegreeFour(vertex) => vec![("radius", Length(vertex.radius))],
            Self::Waterbomb(pattern) => vec![
                ("columns", Count(pattern.columns, 1)),
                ("rows", Count(pattern.rows, 1)),
                ("side", Length(pattern.side)),
            ],
            Self::Yoshimura(pattern) => vec![
                ("columns", Count(pattern.columns, 1)),
                ("rows", Count(pattern.rows, 1)),
                ("base", Length(pattern.base)),
                ("height", Length(pattern.height)),
            ],
            Self::Kresling(pattern) => vec![
                ("columns", Count(pattern.columns, 1)),
                ("rows", Count(pattern.rows, 1)),
                ("base", Length(pattern.base)),
                ("side", Length(pattern.side)),
                ("angle", Angle(pattern.angle, 90.0)),
            ],
            Self::Hypar(pattern) => vec![
                ("rings", Count(pattern.rings, 1)),
                ("side", Length(pattern.side)),
            ],
            Self::SquareTwist(twist) => vec![
                ("side", Length(twist.side)),
                ("square", Length(twist.square)),
                ("angle", Angle(twist.angle, 90.0)),
            ],
            Self::StripBetween(_) | Self::Triangles { .. } | Self::File(_) | Self::Drawing(_) => {
                Vec::new()
            }
        }
    }

    pub(crate) fn check(&self, key: &Key, checks: &mut Checks) {
        let key = key.name(self.name());
        for (name, argument) in self.arguments() {
            argument.check(key.name(name), checks);
        }
        match self {
            Self::Polygon { outline, seed, .. } => {
                checks.count(key.name("seed"), *seed, 0);
                outline.check(&key.name("outline"), checks);
            }
            Self::PolygonRings { outline, .. } => outline.check(&key.name("outline"), checks),
            Self::DegreeFour(vertex) => {
                for (k, sector) in vertex.sectors.iter().enumerate() {
                    let sector = Argument::Angle(*sector, 180.0);
                    sector.check(key.name("sectors").entry(k), checks);
                }
            }
            Self::StripBetween(strip) => strip.check(&key, checks),
            Self::Triangles { vertices, .. } => {
                checks.points(key.name("vertices"), vertices);
            }
            _ => {}
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
        Ok(self.build(&key, &mut Files::in_folder(folder))?.sheet)
    }

    /// Makes the mesh.
    pub(crate) fn build(&self, key: &Key, files: &mut Files) -> Result<RestMesh, Problem> {
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
                    DiagonalsKey::UnionJack => generate::Diagonals::UnionJack,
                    DiagonalsKey::Falling => generate::Diagonals::Falling,
                    DiagonalsKey::Rising => generate::Diagonals::Rising,
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
                let roles = MiuraKey::roles(&pattern);
                return Ok(RestMesh::of(pattern, roles));
            }
            Self::DegreeFour(vertex) => return of_pattern(&key, vertex.pattern()),
            Self::Waterbomb(p) => {
                return of_pattern(&key, generate::waterbomb(p.columns, p.rows, p.side));
            }
            Self::Yoshimura(p) => {
                return of_pattern(
                    &key,
                    generate::yoshimura(p.columns, p.rows, p.base, p.height),
                );
            }
            Self::Kresling(p) => {
                return of_pattern(
                    &key,
                    generate::kresling(p.columns, p.rows, p.base, p.side, p.angle.to_radians()),
                );
            }
            Self::Hypar(p) => return of_pattern(&key, generate::hypar(p.rings, p.side)),
            Self::SquareTwist(p) => {
                return of_pattern(
                    &key,
                    generate::square_twist(p.side, p.square, p.angle.to_radians()),
                );
            }
            Self::StripBetween(strip) => {
                return Ok(RestMesh::plain(strip.strip(&key, files)?.sheet));
            }
            Self::Triangles { vertices, faces } => {
                let sheet = Sheet::new(vertices.as_flattened().to_vec(), faces);
                let sheet = sheet.map_err(|e| Problem::from_error(key.name("faces"), &e))?;
                return Ok(RestMesh::plain(sheet));
            }
            Self::File(file) => return read_sheet(file, &key, files),
            Self::Drawing(drawing) => {
                let drawn = drawing.sheet(&key, files)?;
                return rest_mesh(&drawn.mesh).map_err(|e| Problem::from_error(key, &e));
            }
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

fn read_sheet(file: &MeshFileKey, key: &Key, files: &mut Files) -> Result<RestMesh, Problem> {
    let mesh = files.read(file, key)?;
    rest_mesh(&mesh).map_err(|error| {
        let path = file.path.display();
        let remedy = match MeshFile::clone(&mesh).repair() {
            Ok(_) => format!("`isosheet check {path} --fix -o FILE` repairs what can be repaired"),
            Err(error) => {
                let advice = error.advice().unwrap_or("edit the mesh there");
                format!("this cannot be repaired automatically: {advice}")
            }
        };
        let error = MeshFileProblem::from(error);
        Problem::new(key.name("path"), format!("{path}: {error}"), remedy)
    })
}

/// The sheet of a mesh with what is said of its edges and faces.
fn rest_mesh(mesh: &MeshFile) -> Result<RestMesh, MeshError> {
    let sheet = Sheet::new(mesh.positions.clone(), &mesh.faces)?;
    let assignments = mesh.fold_assignments(sheet.topology());
    Ok(RestMesh {
        roles: assignments.map(|assignments| EdgeRoles {
            assignments,
            drawn: DrawnEdges::of(mesh),
            ..EdgeRoles::default()
        }),
        sheet,
        groups: mesh.groups.clone(),
        texture: mesh.texture.clone(),
        changes: mesh.changes,
    })
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
