//! Reading meshes from files of other programs.

mod error;
mod faces;
mod fold;
mod gltf;
mod obj;
mod off;
mod ply;
mod polygon;
mod repair;
mod stl;
#[cfg(test)]
mod tests;
mod weld;

pub use error::{MeshFileError, MeshFileProblem, Place};
pub use fold::{FoldFrame, FoldProblem};
pub use gltf::GltfProblem;
pub use repair::Repair;

use error::Located;
use isosheet_mesh::generate::FoldAssignment;
use isosheet_mesh::{Sheet, Topology, VertexId};
use std::path::{Path, PathBuf};

/// A format of meshes, as the extension of a file says.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[non_exhaustive]
pub enum MeshFormat {
    /// Wavefront OBJ, `.obj`.
    Obj,
    /// Object File Format of Geomview, `.off`.
    Off,
    /// Stereolithography, binary or text, `.stl`.
    Stl,
    /// Polygon File Format of Stanford, binary or text, `.ply`.
    Ply,
    /// Flexible Origami List Datastructure 1.0 to 1.2, `.fold`.
    Fold,
    /// Graphics Library Transmission Format 2.0 as text with its buffers, `.gltf`.
    Gltf,
    /// The same in one binary file, `.glb`.
    Glb,
}

impl MeshFormat {
    /// All formats that are read.
    pub const ALL: [Self; 7] = [
        Self::Obj,
        Self::Off,
        Self::Stl,
        Self::Ply,
        Self::Fold,
        Self::Gltf,
        Self::Glb,
    ];

    /// The extension, without a dot.
    pub fn extension(self) -> &'static str {
        match self {
            Self::Obj => "obj",
            Self::Off => "off",
            Self::Stl => "stl",
            Self::Ply => "ply",
            Self::Fold => "fold",
            Self::Gltf => "gltf",
            Self::Glb => "glb",
        }
    }

    /// The format of a file by its extension, in capital or small letters; `None` for all others.
    pub fn of(path: &Path) -> Option<Self> {
        let found = path.extension()?;
        Self::ALL
            .into_iter()
            .find(|f| found.eq_ignore_ascii_case(f.extension()))
    }
}

/// What to do with faces of more than three corners.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Polygons {
    /// Refuse the file. In a model of rods a polygon's diagonals are lines along which the sheet can fold,
    /// and its author did not draw them.
    Refuse,
    /// Cut each polygon into triangles from that one of its corners which sees all others and needs the
    /// shortest cuts (so a quad is cut along its shorter diagonal). [`MeshFile::diagonals`] lists the cuts.
    Triangulate,
}

/// What to do with glTF files whose buffers are files of their own.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum SeparateBuffers {
    /// Read them; their paths are relative to the file.
    Read,
    /// Refuse the file: it cannot be copied or sent alone.
    Refuse,
}

/// How to read a mesh file.
#[derive(Clone, Debug, PartialEq)]
pub struct MeshOptions {
    /// Faces of more than three corners: cut into triangles unless asked otherwise.
    pub polygons: Polygons,
    /// Vertices that are at most so far apart, in the unit of the file, become one: the first of them. `None`
    /// (the default) welds STL and glTF files with tolerance 0, and other files not at all: STL has no shared
    /// vertices and glTF none between faces with different normals, but programs that write them give each
    /// copy of a vertex the same digits.
    pub weld: Option<f64>,
    /// Of FOLD files: the frame. `None` (the default) is the first with vertices. Other files have no frames
    /// and are refused with this option.
    pub frame: Option<FoldFrame>,
    /// Of glTF files: the name of the mesh. `None` (the default) is the first of the file.
    pub mesh: Option<String>,
    /// Of glTF files: buffers in files of their own, which are read unless asked otherwise.
    pub buffers: SeparateBuffers,
}

impl Default for MeshOptions {
    fn default() -> Self {
        Self {
            polygons: Polygons::Triangulate,
            weld: None,
            frame: None,
            mesh: None,
            buffers: SeparateBuffers::Read,
        }
    }
}

impl MeshOptions {
    /// Checks the values.
    ///
    /// # Errors
    /// [`MeshFileProblem::WeldTolerance`] if the tolerance is negative or not finite.
    pub fn validate(&self) -> Result<(), MeshFileProblem> {
        match self.weld {
            Some(tolerance) if !(tolerance >= 0.0 && tolerance.is_finite()) => {
                Err(MeshFileProblem::WeldTolerance { tolerance })
            }
            _ => Ok(()),
        }
    }
}

/// What an edge of a FOLD file is meant to do.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum EdgeAssignment {
    /// `B`: the boundary of the sheet.
    Boundary,
    /// `M`: folds away from the side from which faces are counter-clockwise.
    Mountain,
    /// `V`: folds towards that side.
    Valley,
    /// `F`: stays flat.
    Flat,
    /// `U`, or not said.
    Unassigned,
    /// `C`: the sheet is cut here; its two sides have vertices of their own.
    Cut,
    /// `J`: joins two triangles of one panel; stays flat.
    Join,
}

/// An edge of a FOLD file, or a diagonal of one of its polygons.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct FileCrease {
    /// The vertices at its ends, from 0.
    pub ends: [u32; 2],
    /// What it is meant to do; diagonals stay flat.
    pub assignment: EdgeAssignment,
    /// The fold angle that the file gives, in radians within [-pi, pi], positive for a valley.
    pub angle: Option<f64>,
}

/// What reading changed besides cutting polygons into triangles.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct ReadingChanges {
    /// Vertices that were welded to another one.
    pub welded_vertices: usize,
    /// Faces that were removed because two of their corners were welded.
    pub collapsed_faces: usize,
    /// Faces of flat crease patterns that were clockwise and have been reversed.
    pub reversed_faces: usize,
    /// Vertices that were added because the sheet is cut there.
    pub vertices_at_cuts: usize,
}

/// The vertices and triangles of a mesh file, as numbered there (from 0), not yet checked to be a surface.
#[derive(Clone, Debug, PartialEq)]
pub struct MeshFile {
    /// Coordinates x0 y0 z0 x1 ..., in the file's unit and axes. Two formats say what these are, and are
    /// converted: FOLD files with a unit of length to metres; glTF files, which have y upwards, to z upwards.
    pub positions: Vec<f64>,
    /// Triangles, as wound in the file.
    pub faces: Vec<[u32; 3]>,
    /// How many faces had more than three corners and were cut.
    pub polygons: usize,
    /// The cuts of these: edges that are not in the file, inside of what was one flat panel.
    pub diagonals: Vec<[u32; 2]>,
    /// The edges of a FOLD file and the diagonals; empty for other formats.
    pub creases: Vec<FileCrease>,
    /// What reading changed.
    pub changes: ReadingChanges,
    path: PathBuf,
}

impl MeshFile {
    /// A mesh that is in no file.
    pub(crate) fn of_frame(
        positions: Vec<f64>,
        faces: Vec<[u32; 3]>,
        creases: Vec<FileCrease>,
    ) -> Self {
        Self {
            positions,
            faces,
            polygons: 0,
            diagonals: Vec::new(),
            creases,
            changes: ReadingChanges::default(),
            path: PathBuf::new(),
        }
    }

    /// The number of vertices, used or not.
    pub fn vertex_count(&self) -> usize {
        self.positions.len() / 3
    }

    /// The file that the mesh was read from; empty for a frame of a run.
    pub fn path(&self) -> &Path {
        &self.path
    }

    /// Removes vertices that belong to no face and renumbers the rest in order; returns how many were
    /// removed.
    pub fn drop_unreferenced(&mut self) -> usize {
        let mut used = vec![false; self.vertex_count()];
        for &v in self.faces.iter().flatten() {
            used[v as usize] = true;
        }
        let mut label = vec![0u32; used.len()];
        let mut kept = Vec::with_capacity(self.positions.len());
        for (v, _) in used.iter().enumerate().filter(|(_, u)| **u) {
            label[v] = (kept.len() / 3) as u32;
            kept.extend_from_slice(&self.positions[3 * v..3 * v + 3]);
        }
        self.diagonals
            .retain(|e| e.iter().all(|&v| used[v as usize]));
        self.creases
            .retain(|c| c.ends.iter().all(|&v| used[v as usize]));
        self.relabel(&label);
        let removed = used.len() - kept.len() / 3;
        self.positions = kept;
        removed
    }

    /// Gives each vertex that faces and edges refer to a new number.
    fn relabel(&mut self, label: &[u32]) {
        let edges = self.diagonals.iter_mut().flatten();
        let creases = self.creases.iter_mut().flat_map(|c| &mut c.ends);
        for v in self.faces.iter_mut().flatten().chain(edges).chain(creases) {
            *v = label[*v as usize];
        }
    }

    /// Checks that the faces are an oriented surface of rigid triangles, and makes it a sheet.
    ///
    /// # Errors
    /// [`MeshFileProblem::Mesh`] with the file's name. Indices in it are counted from 0.
    pub fn into_sheet(self) -> Result<Sheet, MeshFileError> {
        let Self {
            positions,
            faces,
            path,
            ..
        } = self;
        Sheet::new(positions, &faces).map_err(|e| MeshFileError {
            path,
            place: None,
            problem: e.into(),
        })
    }

    /// What each edge of a topology of the faces is meant to do; `None` unless the file is a FOLD file with
    /// edges, and for an edge inside the sheet that the file leaves unassigned.
    pub fn fold_assignments(&self, t: &Topology) -> Option<Vec<Option<FoldAssignment>>> {
        if self.creases.is_empty() {
            return None;
        }
        let mut assignments = vec![None; t.edge_count()];
        for crease in &self.creases {
            let [a, b] = crease.ends.map(VertexId);
            let inside = a.index().max(b.index()) < t.vertex_count();
            if let Some(e) = inside.then(|| t.find_edge(a, b)).flatten() {
                assignments[e.index()] = match crease.assignment {
                    EdgeAssignment::Mountain => Some(FoldAssignment::Mountain),
                    EdgeAssignment::Valley => Some(FoldAssignment::Valley),
                    EdgeAssignment::Flat | EdgeAssignment::Join => Some(FoldAssignment::Flat),
                    EdgeAssignment::Boundary | EdgeAssignment::Unassigned | EdgeAssignment::Cut => {
                        None
                    }
                };
            }
        }
        for e in t.edge_ids().filter(|&e| t.is_boundary_edge(e)) {
            assignments[e.index()] = Some(FoldAssignment::Boundary);
        }
        Some(assignments)
    }
}

/// Reads a mesh file with default options: [`read_mesh_with`].
///
/// ```
/// # let folder = tempfile::tempdir()?;
/// # let path = folder.path().join("panel.off");
/// std::fs::write(&path, "OFF\n4 1 0\n0 0 0\n2 0 0\n2 1 0\n0 1 0\n4 0 1 2 3\n")?;
/// let mesh = isosheet_io::read_mesh(&path)?;
/// assert_eq!(mesh.faces, [[0, 1, 2], [0, 2, 3]]);
/// assert_eq!(mesh.diagonals, [[0, 2]]);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
///
/// # Errors
/// [`MeshFileError`] with the file, the place and what is wrong.
pub fn read_mesh(path: &Path) -> Result<MeshFile, MeshFileError> {
    read_mesh_with(path, &MeshOptions::default())
}

/// Reads the vertices and faces of a mesh file, whose extension says which format it has ([`MeshFormat`]).
///
/// # Errors
/// [`MeshFileError`] with the file, the place and what is wrong.
pub fn read_mesh_with(path: &Path, options: &MeshOptions) -> Result<MeshFile, MeshFileError> {
    let error = |problem| MeshFileError {
        path: path.to_owned(),
        place: None,
        problem,
    };
    // Of a path that leads nowhere the extension is not the problem.
    std::fs::metadata(path).map_err(|e| error(MeshFileProblem::Read(e)))?;
    let format = MeshFormat::of(path).ok_or_else(|| {
        let extension = path.extension().unwrap_or_default();
        error(MeshFileProblem::Extension {
            extension: extension.to_string_lossy().into_owned(),
        })
    })?;
    let bytes = std::fs::read(path).map_err(|e| error(MeshFileProblem::Read(e)))?;
    parse_mesh(&bytes, format, path, options)
}

/// Reads a sheet from a mesh file: triangles only, an oriented surface that uses every vertex.
///
/// # Errors
/// [`MeshFileError`] with the file, the place and what is wrong.
pub fn read_sheet(path: &Path) -> Result<Sheet, MeshFileError> {
    let options = MeshOptions {
        polygons: Polygons::Refuse,
        ..MeshOptions::default()
    };
    read_mesh_with(path, &options)?.into_sheet()
}

/// [`read_mesh_with`] for a file in memory. The folder of `path` is where glTF files with separate buffers
/// have these; otherwise `path` is used in errors only.
///
/// # Errors
/// As [`read_mesh_with`].
pub fn parse_mesh(
    bytes: &[u8],
    format: MeshFormat,
    path: &Path,
    options: &MeshOptions,
) -> Result<MeshFile, MeshFileError> {
    parse(bytes, format, path, options).map_err(|(place, problem)| MeshFileError {
        path: path.to_owned(),
        place,
        problem,
    })
}

fn parse(
    bytes: &[u8],
    format: MeshFormat,
    path: &Path,
    options: &MeshOptions,
) -> Result<MeshFile, Located> {
    options.validate().map_err(|problem| (None, problem))?;
    if options.frame.is_some() && format != MeshFormat::Fold {
        return Err((None, MeshFileProblem::NoFrames));
    }
    let mut mesh = match format {
        MeshFormat::Obj => obj::parse(bytes)?.assemble(options)?,
        MeshFormat::Off => off::parse(bytes)?.assemble(options)?,
        MeshFormat::Stl => stl::parse(bytes)?.assemble(options)?,
        MeshFormat::Ply => ply::parse(bytes)?.assemble(options)?,
        MeshFormat::Fold => fold::parse(bytes, options)?,
        MeshFormat::Gltf | MeshFormat::Glb => {
            gltf::parse(bytes, path, options)?.assemble(options)?
        }
    };
    mesh.path = path.to_owned();
    let weld_by_default = match format {
        MeshFormat::Stl | MeshFormat::Gltf | MeshFormat::Glb => Some(0.0),
        _ => None,
    };
    if let Some(tolerance) = options.weld.or(weld_by_default) {
        mesh.weld(tolerance);
    }
    Ok(mesh)
}
