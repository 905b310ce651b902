//! The mesh files of a scene.

use crate::meshes::foreign;
use crate::meshes::sequence::Sequence;
use crate::meshes::up_axis::UpAxis;
use crate::words::key::Key;
use crate::words::part::Part;
use crate::words::problem::{Checks, Problem};
use crate::words::unit::Unit;
use isosheet_files::input;
use isosheet_formats::{
    FoldFrame, MeshFile, MeshFileError, MeshFileProblem, MeshFormat, MeshOptions, MovingMesh,
    Polygons, SeparateBuffers, motion_archive, parse_mesh, read_mesh_with,
};
use isosheet_mesh::Advice;
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};
use std::collections::BTreeMap;
use std::io;
use std::path::{Path, PathBuf};
use std::sync::Arc;

/// A mesh in a file.
///
/// ```toml
/// [sheet]
/// mesh = { file = { path = "crane.fold", scale = 0.001, frame = 0 } }
/// ```
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize, JsonSchema, Part)]
#[serde(deny_unknown_fields)]
#[checked]
pub struct MeshFileKey {
    /// Path of the mesh file, relative to the scene file.
    pub path: PathBuf,
    /// Length of one unit of the file, metres: 0.001 for a file in millimetres. A FOLD file with a unit of
    /// length and a glTF file are in metres, and `scale` multiplies that unit.
    #[serde(default = "one")]
    pub scale: f64,
    /// The axis of the file that points upwards; it becomes z. Leave it out for a glTF file, which has y
    /// upwards by definition and is turned.
    #[serde(default)]
    pub up: UpAxis,
    /// What to do with faces of more than three corners.
    #[serde(default)]
    pub polygons: PolygonFaces,
    /// The frame of a FOLD file whose vertices are taken, by its number from 0 or by its title; if left out,
    /// the first one with vertices. Frame 0 is the key frame of the file. One file can give the flat crease
    /// pattern to `sheet.mesh` and a folded form of it to `sheet.start.file`.
    #[serde(default)]
    #[schemars(with = "Option<foreign::FoldFrame>")]
    pub frame: Option<FoldFrame>,
    /// The name of the mesh of a glTF file that is taken; if left out, all meshes that its scene shows, each
    /// where its nodes place it.
    #[serde(default)]
    pub mesh: Option<String>,
}

fn one() -> f64 {
    1.0
}

/// What to do with faces of more than three corners.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize, JsonSchema, Part)]
#[serde(rename_all = "snake_case")]
pub enum PolygonFaces {
    /// Refuse the file: new diagonals are new lines along which the sheet can fold.
    #[default]
    Refuse,
    /// Cut them into triangles.
    Triangulate,
}

impl MeshFileKey {
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
        self.up.check(&self.path, key, checks);
        if self.path.as_os_str().is_empty() {
            checks.report(key.name("path"), "the path is empty", "name a mesh file");
        }
    }

    fn options(&self) -> MeshOptions {
        MeshOptions {
            polygons: match self.polygons {
                PolygonFaces::Refuse => Polygons::Refuse,
                PolygonFaces::Triangulate => Polygons::Triangulate,
            },
            // The folder of a run keeps a copy of one file for each mesh.
            buffers: SeparateBuffers::Refuse,
            frame: self.frame.clone(),
            mesh: self.mesh.clone(),
            ..MeshOptions::default()
        }
    }

    /// Puts a mesh as the file has it in metres and with z upwards.
    fn place(&self, mesh: &mut MeshFile) {
        for p in mesh.positions.as_chunks_mut::<3>().0 {
            *p = self.up.place(p.map(|c| self.scale * c));
        }
    }
}

/// The mesh files of a scene. Each is read once and each mesh in it parsed once, however often the scene is
/// built.
#[derive(Debug, Default)]
pub struct Files {
    /// The folder that their paths are relative to.
    folder: PathBuf,
    contents: BTreeMap<PathBuf, Arc<[u8]>>,
    /// The archives of meshes in motion.
    motions: BTreeMap<PathBuf, Arc<[u8]>>,
    meshes: Vec<(MeshFileKey, Arc<MeshFile>)>,
    sequences: Vec<(Sequence, Arc<MovingMesh>)>,
}

impl Files {
    /// Files by their paths relative to a folder, of which none has been read.
    pub fn in_folder(folder: &Path) -> Self {
        Self {
            folder: folder.to_owned(),
            ..Self::default()
        }
    }

    /// The bytes of a file.
    pub fn contents(&mut self, path: &Path) -> io::Result<Arc<[u8]>> {
        if let Some(contents) = self.contents.get(path) {
            return Ok(contents.clone());
        }
        let contents: Arc<[u8]> = input::read(&self.folder.join(path))?.into();
        self.contents.insert(path.to_owned(), contents.clone());
        Ok(contents)
    }

    /// The archive of a mesh in motion; `key` is the place of the file in the scene.
    pub fn motion(&mut self, path: &Path, key: &Key) -> Result<Arc<[u8]>, Problem> {
        if let Some(archive) = self.motions.get(path) {
            return Ok(archive.clone());
        }
        let archive = motion_archive(&self.folder.join(path));
        let archive = archive.map_err(|e| Problem::from_error(key.name("path"), &e))?;
        let archive: Arc<[u8]> = archive.into();
        self.motions.insert(path.to_owned(), archive.clone());
        Ok(archive)
    }

    /// The mesh of a file, in metres and with z upwards; `key` is the place of the file in the scene.
    pub(crate) fn read(&mut self, file: &MeshFileKey, key: &Key) -> Result<Arc<MeshFile>, Problem> {
        self.mesh(file).map_err(|e| {
            let name = match &e.problem {
                MeshFileProblem::Frame(_) => "frame",
                MeshFileProblem::Name(_) => "mesh",
                _ => "path",
            };
            Problem::new(key.name(name), e.to_string(), file_remedy(&e))
        })
    }

    /// A mesh in motion, in metres and with z upwards, at times of a run to the time `end`, in seconds; `key`
    /// is the place of the file in the scene.
    pub(crate) fn sequence(
        &mut self,
        of: &Sequence,
        end: f64,
        key: &Key,
    ) -> Result<Arc<MovingMesh>, Problem> {
        if let Some((_, mesh)) = self.sequences.iter().find(|(known, _)| known == of) {
            of.check_times(mesh, end, key)?;
            return Ok(mesh.clone());
        }
        let mesh = match (&of.path, &of.frames) {
            (None, Some(frames)) => frames.mesh(&key.name("frames"))?,
            (path, _) => {
                let path = path.as_deref().unwrap_or(Path::new(""));
                let archive = self.motion(path, key)?;
                let read = MovingMesh::parse(&archive, &self.folder.join(path));
                read.map_err(|e| Problem::from_error(key.name("path"), &e))?
            }
        };
        let mesh = Arc::new(of.place(mesh, key)?);
        self.sequences.push((of.clone(), mesh.clone()));
        of.check_times(&mesh, end, key)?;
        Ok(mesh)
    }

    /// [`Self::read`] with the error of the reader.
    pub(crate) fn mesh(&mut self, file: &MeshFileKey) -> Result<Arc<MeshFile>, MeshFileError> {
        if let Some((_, mesh)) = self.meshes.iter().find(|(known, _)| known == file) {
            return Ok(mesh.clone());
        }
        let (path, options) = (self.folder.join(&file.path), file.options());
        let mut mesh = match (MeshFormat::of(&path), self.contents(&file.path)) {
            (Some(format), Ok(contents)) => parse_mesh(&contents, format, &path, &options)?,
            // It says what is wrong.
            _ => read_mesh_with(&path, &options)?,
        };
        file.place(&mut mesh);
        let mesh = Arc::new(mesh);
        self.meshes.push((file.clone(), mesh.clone()));
        Ok(mesh)
    }
}

/// What to do about a mesh file that cannot be read, in words of scenes.
fn file_remedy(error: &MeshFileError) -> String {
    match &error.problem {
        MeshFileProblem::Polygon(_) => {
            "triangulate the file as the sheet is meant to fold, or write `polygons = \"triangulate\"` beside \
             `path`"
                .to_owned()
        }
        MeshFileProblem::Read(_) => {
            "check the path, which is relative to the scene, and the permissions".to_owned()
        }
        problem @ MeshFileProblem::Frame(_) => problem.advice().unwrap_or_default().to_owned(),
        problem => {
            let advice = problem.advice().map(|advice| format!("{advice}; "));
            let advice = advice.unwrap_or_default();
            format!("{advice}`isosheet check` says more about a mesh file")
        }
    }
}
