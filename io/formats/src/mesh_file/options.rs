//! How a mesh file is read.

use super::error::MeshFileProblem;
use super::fold_frame::FoldFrame;
use isosheet_files::DataError;
use isosheet_mesh::wording::given;

/// What to do with faces of more than three corners.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Polygons {
    /// Refuse the file. In a model of rods a polygon's diagonals are lines along which the sheet can fold,
    /// and its author did not draw them.
    Refuse,
    /// Cut each polygon into triangles, corner after corner by the shortest cut inside (so a quad is cut
    /// along its shorter diagonal). [`MeshFile::diagonals`] lists the cuts.
    ///
    /// [`MeshFile::diagonals`]: super::MeshFile::diagonals
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
    /// copy of a vertex the same digits. Different meshes of a glTF file stay apart then, where they touch.
    pub weld: Option<f64>,
    /// Of FOLD files: the frame. `None` (the default) is the first with vertices. Other files have no frames
    /// and are refused with this option.
    pub frame: Option<FoldFrame>,
    /// Of glTF files: the name of the mesh. `None` (the default) is all meshes that the scene of the file
    /// shows. Other files are refused with this option.
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
    /// [`MeshFileProblem::Options`] if the tolerance is negative or not finite.
    pub fn validate(&self) -> Result<(), MeshFileProblem> {
        match self.weld {
            Some(tolerance) if !(tolerance >= 0.0 && tolerance.is_finite()) => {
                let found = given(tolerance);
                let message = format!("the tolerance for welding vertices is {found}");
                let remedy = "give a length of 0 or more in the unit of the file";
                let error = DataError::new(message, remedy).value(tolerance);
                Err(MeshFileProblem::Options(error))
            }
            _ => Ok(()),
        }
    }
}
