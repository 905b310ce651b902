//! Writing meshes and moving sheets for other programs.

mod body;
mod csv;
mod error;
mod flat;
mod fold;
mod gltf;
mod moving;
mod obj;
mod off;
mod pc2;
mod ply;
mod series;
mod sheets;
mod solid;
mod stl;
#[cfg(test)]
mod tests;
mod usda;
mod vtk;

pub use body::{BodyPose, SeriesBody};
pub use error::ExportError;
pub use gltf::MOST_KEY_FRAMES;
pub use obj::{frame_path, write_obj};
pub use series::{FieldSupport, Series, SeriesField, SeriesOptions};
pub use solid::thickened;

use super::mesh_file::MeshFile;
use moving::Moving;
use obj::Extras;
use std::path::{Path, PathBuf};

/// A format in which one mesh is written, as the extension of a file says.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[non_exhaustive]
pub enum ExportMeshFormat {
    /// Wavefront OBJ, `.obj`: all digits.
    Obj,
    /// Object File Format, `.off`: all digits.
    Off,
    /// Binary stereolithography, `.stl`: 32-bit floats, no shared vertices.
    Stl,
    /// Binary little-endian Polygon File Format, `.ply`: all digits.
    Ply,
    /// FOLD 1.2, `.fold`: all digits, with edges, assignments and fold angles.
    Fold,
    /// Binary glTF 2.0, `.glb`: 32-bit floats, y upwards.
    Glb,
    /// Universal Scene Description as text, `.usda`: 32-bit floats, z upwards.
    Usda,
}

impl ExportMeshFormat {
    /// All formats.
    pub const ALL: [Self; 7] = [
        Self::Obj,
        Self::Off,
        Self::Stl,
        Self::Ply,
        Self::Fold,
        Self::Glb,
        Self::Usda,
    ];

    /// The extension, without a dot.
    pub fn extension(self) -> &'static str {
        match self {
            Self::Obj => "obj",
            Self::Off => "off",
            Self::Stl => "stl",
            Self::Ply => "ply",
            Self::Fold => "fold",
            Self::Glb => "glb",
            Self::Usda => "usda",
        }
    }
}

/// A format in which the frames of a moving sheet are written, as the extension of a file says.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[non_exhaustive]
pub enum SeriesFormat {
    /// One OBJ file for each frame in a folder: for `run.obj`, `run/frame_00000.obj` and so on, numbered
    /// as in the trajectory, and bodies in `run/bodies_00000.obj`. All digits; no times.
    Obj,
    /// One FOLD 1.2 file with a frame for each frame, `.fold`: all digits, times, fold angles of all edges.
    Fold,
    /// Binary glTF 2.0, `.glb`: morph targets with an animation of their weights, 32-bit floats, y
    /// upwards; at most [`MOST_KEY_FRAMES`] frames, chosen evenly.
    Glb,
    /// Universal Scene Description as text with time samples, `.usda`: 32-bit floats, z upwards.
    Usda,
    /// A point cache with the mesh of the first frame beside it, `.pc2` and `.obj`: 32-bit floats, no times.
    Pc2,
    /// A collection of VTK files, one for each frame: for `run.pvd`, `run/frame_00000.vtp` and so on. All
    /// digits, times, strain and fold angle of the edges and the fields of the series. Bodies have a
    /// collection of their own, `run-bodies.pvd`.
    Pvd,
    /// A table with a line for each vertex of each frame, `.csv`: frame, time, vertex, x, y, z and the fields
    /// of vertices, with all digits.
    Csv,
    /// A numpy archive, `.npz`: a [`Trajectory`](super::Trajectory) of these frames, with all digits.
    Npz,
}

impl SeriesFormat {
    /// All formats.
    pub const ALL: [Self; 8] = [
        Self::Obj,
        Self::Fold,
        Self::Glb,
        Self::Usda,
        Self::Pc2,
        Self::Pvd,
        Self::Csv,
        Self::Npz,
    ];

    /// The extension, without a dot.
    pub fn extension(self) -> &'static str {
        match self {
            Self::Obj => "obj",
            Self::Fold => "fold",
            Self::Glb => "glb",
            Self::Usda => "usda",
            Self::Pc2 => "pc2",
            Self::Pvd => "pvd",
            Self::Csv => "csv",
            Self::Npz => "npz",
        }
    }
}

/// What was written.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Exported {
    /// The files, the one that was asked for last.
    pub files: Vec<PathBuf>,
    /// The frames of the trajectory that they have.
    pub frames: Vec<usize>,
    /// How many files of an earlier export were removed: numbered files by the same names, of frames that
    /// this one has not.
    pub removed: usize,
}

/// Writes one mesh, atomically, in the format that the extension names ([`ExportMeshFormat`]).
///
/// # Errors
/// [`ExportError`]; nothing is written then.
pub fn write_mesh(path: &Path, mesh: &MeshFile) -> Result<(), ExportError> {
    let format = by_extension(path, &ExportMeshFormat::ALL, ExportMeshFormat::extension)?;
    let (x, faces) = (&mesh.positions[..], &mesh.faces[..]);
    error::check_mesh(x, faces)?;
    match format {
        ExportMeshFormat::Obj => obj::write(
            path,
            faces,
            x,
            &Extras::of_groups(&mesh.groups, faces.len()),
        ),
        ExportMeshFormat::Off => off::write(path, faces, x),
        ExportMeshFormat::Stl => stl::write(path, faces, x),
        ExportMeshFormat::Ply => ply::write(path, faces, x),
        ExportMeshFormat::Fold => fold::write_mesh(path, mesh),
        ExportMeshFormat::Glb => gltf::write(path, &Moving::still(faces, x)),
        ExportMeshFormat::Usda => usda::write(path, &Moving::still(faces, x)),
    }
}

/// Writes a flat mesh as [`write_mesh`]. A FOLD file has the positions of its vertices when it is folded
/// (three numbers each, metres) as a second frame.
///
/// # Errors
/// [`ExportError`]; nothing is written then.
pub fn write_pattern(path: &Path, mesh: &MeshFile, folded: &[f64]) -> Result<(), ExportError> {
    let format = by_extension(path, &ExportMeshFormat::ALL, ExportMeshFormat::extension)?;
    if format != ExportMeshFormat::Fold {
        return write_mesh(path, mesh);
    }
    error::check_mesh(&mesh.positions, &mesh.faces)?;
    error::check_mesh(folded, &mesh.faces)?;
    fold::write_folded(path, mesh, folded)
}

/// Writes one frame of a moving sheet, atomically, as one file of the format that the extension names
/// ([`ExportMeshFormat`]). OBJ, glTF and USD files have texture coordinates ([`Series::uv`]), glTF and USD
/// files the bodies too.
///
/// # Errors
/// [`ExportError`]; nothing is written then.
pub fn write_frame(path: &Path, series: &Series<'_>, frame: usize) -> Result<(), ExportError> {
    let mesh = series.mesh(frame)?;
    match by_extension(path, &ExportMeshFormat::ALL, ExportMeshFormat::extension)? {
        ExportMeshFormat::Obj => {
            obj::write(path, &mesh.faces, &mesh.positions, &obj::extras(series))
        }
        ExportMeshFormat::Glb => gltf::write(path, &series.moving(&[frame])),
        ExportMeshFormat::Usda => usda::write(path, &series.moving(&[frame])),
        _ => write_mesh(path, &mesh),
    }
}

/// Writes the frames of a moving sheet in the format that the extension names ([`SeriesFormat`]). Each file
/// is written atomically, the one of that name last. Numbered files that an earlier export by this name has
/// left are removed when all new ones are complete. No other files are removed.
///
/// # Errors
/// [`ExportError`]; other files of a format with several files may have been written then.
pub fn write_series(path: &Path, series: &Series<'_>) -> Result<Exported, ExportError> {
    let mut frames = series.frames().to_vec();
    let one = || vec![path.to_owned()];
    let (files, removed) = match by_extension(path, &SeriesFormat::ALL, SeriesFormat::extension)? {
        SeriesFormat::Obj => obj::write_series(path, series)?,
        SeriesFormat::Pvd => vtk::write_series(path, series)?,
        SeriesFormat::Fold => (fold::write_series(path, series)?, 0),
        SeriesFormat::Pc2 => (pc2::write_series(path, series)?, 0),
        SeriesFormat::Csv => (csv::write_series(path, series)?, 0),
        SeriesFormat::Glb => {
            frames = gltf::key_frames(series);
            gltf::write(path, &series.moving(&frames))?;
            (one(), 0)
        }
        SeriesFormat::Usda => {
            usda::write(path, &series.moving(&frames))?;
            (one(), 0)
        }
        SeriesFormat::Npz => {
            series.chosen()?.write(path)?;
            (one(), 0)
        }
    };
    Ok(Exported {
        files,
        frames,
        removed,
    })
}

/// The format that the extension of a file names, in capital or small letters.
fn by_extension<T: Copy>(
    path: &Path,
    known: &[T],
    extension: fn(T) -> &'static str,
) -> Result<T, ExportError> {
    let found = path.extension().unwrap_or_default();
    let format = known
        .iter()
        .find(|f| found.eq_ignore_ascii_case(extension(**f)));
    format.copied().ok_or_else(|| ExportError::Extension {
        extension: found.to_string_lossy().into_owned(),
        known: known
            .iter()
            .map(|&f| format!(".{}", extension(f)))
            .collect(),
    })
}
