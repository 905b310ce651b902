//! The meshes of files for which a scene is composed.

use super::composing::Composing;
use super::failure::{Code, Failure};
use super::info::refuse_folder;
use super::message::print_progress;
use super::{action_scene::SheetSource, face_moments::FaceMoments};
use isosheet_drawings::{DrawingFormat, DrawingOptions};
use isosheet_formats::{DrawnSheet, MeshFormat, MeshOptions, Polygons, read_mesh_with};
use isosheet_mesh::Topology;
use isosheet_mesh::wording::{brief, counted};
use isosheet_scenes::{DrawingFile, MeshFileKey, PolygonFaces, UpAxis, size as extent};
use std::path::Path;

/// Edges of the mesh of a drawing are about this part of its longest side.
const SPACING: f64 = 0.04;

/// A mesh that a file gives.
#[derive(Debug)]
pub(super) struct Given {
    /// The vertices with z upwards, in the unit of the file.
    pub(super) positions: Vec<[f64; 3]>,
    pub(super) faces: Vec<[u32; 3]>,
    up: UpAxis,
}

/// A sheet that a file gives, as a scene has it.
pub(super) struct GivenSheet {
    pub(super) source: SheetSource,
    /// The vertices, metres.
    pub(super) positions: Vec<[f64; 3]>,
    pub(super) faces: usize,
    pub(super) moments: FaceMoments,
}

impl Given {
    /// Reads a mesh file, of which `up` points upwards if its format does not say it.
    pub(super) fn read(file: &Path, up: UpAxis) -> Result<Self, Failure> {
        refuse_folder(file)?;
        let options = MeshOptions {
            polygons: Polygons::Triangulate,
            ..MeshOptions::default()
        };
        let mesh = read_mesh_with(file, &options).map_err(|e| Failure::of(Code::Input, &e))?;
        if let Some(did) = mesh.what_reading_did() {
            print_progress(format_args!("note: {}: {did}", file.display()));
        }
        let up = match MeshFormat::of(file) {
            Some(format) if format.says_up() => UpAxis::Z,
            _ => up,
        };
        let points = mesh.positions.as_chunks::<3>().0.iter();
        let given = Self {
            positions: points.map(|p| up.place(*p)).collect(),
            faces: mesh.faces,
            up,
        };
        match extent(&given.positions) > 0.0 {
            true => Ok(given),
            false => {
                let message = format!("{} has no extent", file.display());
                Err(Failure::new(Code::Input, message).remedy("correct its coordinates"))
            }
        }
    }

    /// The file as a scene names it, with a unit of so many metres.
    pub(super) fn file(&self, path: &Path, scale: f64) -> MeshFileKey {
        MeshFileKey {
            scale,
            up: self.up,
            polygons: PolygonFaces::Triangulate,
            ..MeshFileKey::new(path)
        }
    }
}

impl GivenSheet {
    /// Reads a mesh file or a drawing. The longest side is that of the command line; if that has none, of a
    /// mesh `size` (metres), and of a drawing its own.
    pub(super) fn read(
        file: &Path,
        composing: &Composing,
        up: UpAxis,
        size: f64,
    ) -> Result<Self, Failure> {
        let path = composing.named_from_scene(file, file)?;
        if DrawingFormat::of(file).is_some() {
            return Self::drawn(file, &path, composing.size());
        }
        let given = Given::read(file, up)?;
        let own = extent(&given.positions);
        let scale = composing.size().unwrap_or(size) / own;
        if composing.size().is_none() && scale != 1.0 {
            print_progress(format_args!(
                "note: {} is {} m long, and is scaled by {} to {size} m: `--size` gives its longest side in metres",
                file.display(),
                brief(own),
                brief(scale)
            ));
        }
        let source = SheetSource::File(given.file(&path, scale));
        Self::of_one_piece(file, source, scaled(&given.positions, scale), &given.faces)
    }

    /// Refuses a file with several pieces: one would be held, or above the body, and the others not.
    fn of_one_piece(
        file: &Path,
        source: SheetSource,
        positions: Vec<[f64; 3]>,
        faces: &[[u32; 3]],
    ) -> Result<Self, Failure> {
        // What is no surface has one problem more, of which the scene says where it is.
        let pieces =
            Topology::from_faces(positions.len(), faces).map_or(1, |t| t.component_count());
        if pieces > 1 {
            let message = format!(
                "{} has {}",
                file.display(),
                counted(pieces, "separate piece", "separate pieces")
            );
            return Err(Failure::new(Code::Input, message).remedy(
                "give each command a file with one piece; pieces that meet in vertices at the same place are joined by \
                 `isosheet convert --weld`",
            ));
        }
        Ok(Self {
            moments: moments(file, &positions, faces)?,
            source,
            positions,
            faces: faces.len(),
        })
    }

    fn drawn(file: &Path, path: &Path, size: Option<f64>) -> Result<Self, Failure> {
        let read = |options: &DrawingOptions| {
            DrawnSheet::read(file, options).map_err(|e| {
                let failure = Failure::of(Code::Input, &e);
                match failure.remedy {
                    Some(_) => failure,
                    None => failure.remedy(
                        "make a mesh of it by `isosheet mesh`, which has options for that, and take the mesh",
                    ),
                }
            })
        };
        let longest = |spacing| -> Result<f64, Failure> {
            let size = read(&DrawingOptions::with_spacing(spacing))?.report.size;
            Ok(size[0].max(size[1]))
        };
        let coarse = longest(COARSE)?;
        let [own, size] = match size {
            None => [coarse; 2],
            // With the points on its curves that the sheet has.
            Some(size) => [longest(SPACING * coarse)?, size],
        };
        let options = DrawingOptions {
            scale: size / own,
            ..DrawingOptions::with_spacing(SPACING * size)
        };
        let drawn = read(&options)?;
        let source = SheetSource::Drawing(DrawingFile {
            scale: options.scale,
            ..DrawingFile::new(path, options.spacing)
        });
        let positions = drawn.mesh.positions.as_chunks::<3>().0.to_vec();
        Self::of_one_piece(file, source, positions, &drawn.mesh.faces)
    }
}

/// What the faces of a file are like as a whole.
pub(super) fn moments(
    file: &Path,
    positions: &[[f64; 3]],
    faces: &[[u32; 3]],
) -> Result<FaceMoments, Failure> {
    FaceMoments::of(positions, faces).ok_or_else(|| {
        let message = format!("the faces of {} have no area", file.display());
        Failure::new(Code::Input, message).remedy("correct its coordinates")
    })
}

/// A spacing that no drawing is as large as, metres.
const COARSE: f64 = 1e6;

/// Points in another unit.
pub(super) fn scaled(points: &[[f64; 3]], scale: f64) -> Vec<[f64; 3]> {
    points.iter().map(|p| p.map(|c| scale * c)).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use isosheet_formats::{MeshFile, write_mesh};

    /// A glTF file has z upwards once it is read, whatever points upwards in other files.
    #[test]
    fn gltf_is_turned_once() {
        let dir = tempfile::tempdir().unwrap();
        let x = [[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [0.0, 1.0, 0.5]];
        let mesh = MeshFile::of_frame(x.as_flattened().to_vec(), vec![[0, 1, 2]], Vec::new());
        let path = dir.path().join("roof.glb");
        write_mesh(&path, &mesh).unwrap();
        for up in [UpAxis::Z, UpAxis::Y] {
            let given = Given::read(&path, up).unwrap();
            assert_eq!(given.positions, x);
            assert_eq!(given.file(&path, 1.0).up, UpAxis::Z);
        }
    }
}
