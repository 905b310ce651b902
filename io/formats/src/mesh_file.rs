//! Reading meshes from files of other programs.

mod assignment;
mod drawing;
mod error;
mod face_groups;
mod faces;
mod fold;
mod fold_frame;
mod format;
mod gltf;
mod mesh;
mod obj;
mod off;
mod options;
mod pattern;
mod plane;
mod ply;
mod polygon;
mod repair;
mod stl;
#[cfg(test)]
mod tests;
mod vtk;
mod weld;

pub use assignment::EdgeAssignment;
pub use error::{Location, MeshFileError, MeshFileProblem};
pub use face_groups::FaceGroups;
pub use fold_frame::FoldFrame;
pub use format::MeshFormat;
pub use mesh::{FileCrease, MeshFile, ReadingChanges};
pub use options::{MeshOptions, Polygons, SeparateBuffers};
pub use repair::Repair;

pub(super) use fold::LineRecord;
pub(super) use plane::{Point, distance, twice_area};

use error::Located;
use isosheet_files::{DataError, input};
use isosheet_mesh::Sheet;
use std::path::Path;

/// Reads a mesh file with default options: [`read_mesh_with`].
///
/// ```
/// # let folder = tempfile::tempdir()?;
/// # let path = folder.path().join("panel.off");
/// std::fs::write(&path, "OFF\n4 1 0\n0 0 0\n2 0 0\n2 1 0\n0 1 0\n4 0 1 2 3\n")?;
/// let mesh = isosheet_formats::read_mesh(&path)?;
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
        let found = match extension.to_string_lossy() {
            none if none.is_empty() => "a name without extension".to_owned(),
            some => format!(".{some}"),
        };
        let known = MeshFormat::ALL.map(|f| format!(".{}", f.extension()));
        let known = known.join(", ");
        let message = format!("{found} is no known format of meshes (known are {known})");
        let has = |other: &str| extension.eq_ignore_ascii_case(other);
        let remedy = match is_picture(path) {
            true => "trace the picture in a drawing program, and save its lines as .svg",
            false if has("abc") => {
                "in the program that wrote it, export a mesh as .glb, .ply or .obj, and a mesh in motion as one of these for each frame"
            }
            false if has("fbx") => {
                "in the program that wrote it, export the mesh as .glb, .ply or .obj; Blender opens .fbx files and exports these"
            }
            false => "convert the file to a known format",
        };
        error(DataError::new(message, remedy).into())
    })?;
    let bytes = input::read(path).map_err(|e| error(MeshFileProblem::Read(e)))?;
    parse_mesh(&bytes, format, path, options)
}

/// Whether a file is a picture by its name.
fn is_picture(path: &Path) -> bool {
    const PICTURES: [&str; 9] = [
        "png", "jpg", "jpeg", "gif", "webp", "bmp", "tif", "tiff", "pdf",
    ];
    let extension = path.extension().unwrap_or_default();
    PICTURES.iter().any(|e| extension.eq_ignore_ascii_case(e))
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
/// have these, there or beneath it; otherwise `path` is used in errors only.
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
        let message = "a frame is asked for, and only FOLD files have frames";
        let error = DataError::new(message, "leave the frame out");
        return Err((None, MeshFileProblem::Frame(error)));
    }
    if options.mesh.is_some() && !matches!(format, MeshFormat::Gltf | MeshFormat::Glb) {
        let message = "a mesh is named, and only the meshes of glTF files have names";
        let error = DataError::new(message, "leave the name out");
        return Err((None, MeshFileProblem::Name(error)));
    }
    let text = input::without_mark(bytes);
    let bytes = match format {
        // A binary file may begin with any bytes.
        MeshFormat::Glb => bytes,
        MeshFormat::Stl if !text.starts_with(b"solid") => bytes,
        _ => text,
    };
    let mut mesh = match format {
        MeshFormat::Obj => obj::parse(bytes)?.assemble(options)?,
        MeshFormat::Off => off::parse(bytes)?.assemble(options)?,
        MeshFormat::Stl => stl::parse(bytes)?.assemble_copies(options)?,
        MeshFormat::Ply => ply::parse(bytes)?.assemble(options)?,
        MeshFormat::Fold => fold::parse(bytes, options)?,
        MeshFormat::Gltf | MeshFormat::Glb => {
            gltf::parse(bytes, path, options)?.assemble_copies(options)?
        }
        MeshFormat::Vtk => timed(vtk::parse_legacy(bytes)?, options)?,
        MeshFormat::Vtp => timed(vtk::parse_xml(bytes)?, options)?,
        MeshFormat::Svg | MeshFormat::Cp | MeshFormat::Opx => {
            drawing::parse(bytes, format, options)?
        }
    };
    mesh.path = path.to_owned();
    if let (Some(tolerance), false) = (options.weld, format.is_drawing()) {
        mesh.weld(tolerance, &[]);
    }
    Ok(mesh)
}

/// The mesh of polygons that a file gives a time.
fn timed(polygons: vtk::TimedPolygons, options: &MeshOptions) -> Result<MeshFile, Located> {
    let mut mesh = polygons.mesh.assemble(options)?;
    mesh.time = polygons.time;
    Ok(mesh)
}
