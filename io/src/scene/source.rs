//! Scene files.

use super::edit::{self, EditError};
use super::error::{SceneError, SceneText};
use super::form::form_problems;
use super::key::Key;
use super::problem::Problem;
use super::sheets::sheet_key;
use super::toml_problem::{syntax_problem, toml_problem};
use super::{Scene, Setup};
use crate::format::{MeshFormat, input};
use isosheet_mesh::{Advice, generate::FoldAssignment};
use std::io;
use std::path::{Path, PathBuf};
use thiserror::Error;
use toml::de::DeTable;
use toml_edit::{DocumentMut, Value};

/// A scene with its text, and the folder that its paths are relative to.
#[derive(Clone, Debug, PartialEq)]
pub struct SceneFile {
    scene: Scene,
    text: SceneText,
    folder: PathBuf,
}

/// A scene file that cannot be used.
#[derive(Debug, Error)]
pub enum SceneFileError {
    /// The file cannot be read.
    #[error("cannot read the scene {}: {source}", path.display())]
    Read {
        /// The file.
        path: PathBuf,
        /// What the system said.
        source: io::Error,
    },
    /// The file is a mesh file by its name.
    #[error("{} is a mesh file and no scene", path.display())]
    Mesh {
        /// The file.
        path: PathBuf,
    },
    /// An edit cannot be made.
    #[error(transparent)]
    Edit(#[from] EditError),
    /// The scene is wrong.
    #[error(transparent)]
    Scene(#[from] SceneError),
}

impl Advice for SceneFileError {
    fn advice(&self) -> Option<&'static str> {
        match self {
            Self::Read { .. } => Some("check the path and the permissions"),
            Self::Mesh { .. } => Some(
                "name it in a scene, `mesh = { file = { path = ... } }`: `isosheet new` writes a scene to start from",
            ),
            Self::Edit(error) => error.advice(),
            Self::Scene(error) => error.advice(),
        }
    }
}

/// Refuses what is a mesh file by its name: as TOML it is wrong in a way that helps nobody.
fn refuse_mesh(path: &Path) -> Result<(), SceneFileError> {
    match MeshFormat::of(path) {
        None => Ok(()),
        Some(_) => Err(SceneFileError::Mesh {
            path: path.to_owned(),
        }),
    }
}

impl SceneFile {
    /// Reads a scene file, makes edits of the form `key=value` and checks the result.
    ///
    /// # Errors
    /// [`SceneFileError`], with all problems that were found.
    pub fn read(path: &Path, edits: &[String]) -> Result<Self, SceneFileError> {
        refuse_mesh(path)?;
        let text = input::read_text(path).map_err(|source| SceneFileError::Read {
            path: path.to_owned(),
            source,
        })?;
        Self::parse(text, path, edits)
    }

    /// [`SceneFile::read`] for a text in memory; `path` is used for messages and for relative paths.
    ///
    /// # Errors
    /// As [`SceneFile::read`].
    pub fn parse(text: String, path: &Path, edits: &[String]) -> Result<Self, SceneFileError> {
        refuse_mesh(path)?;
        let mut text = SceneText {
            path: path.to_owned(),
            text,
        };
        if !edits.is_empty() {
            let parsed = text.text.parse::<DocumentMut>();
            let mut document =
                parsed.map_err(|e| SceneError::from(syntax_problem(&e)).in_text(&text))?;
            edit::apply(&mut document, edits)?;
            text.text = document.to_string();
        }
        if let Ok(table) = DeTable::parse(&text.text) {
            SceneError::of(form_problems(table.get_ref())).map_err(|e| e.in_text(&text))?;
        }
        let scene: Scene = toml::from_str(&text.text)
            .map_err(|e| SceneError::from(toml_problem(&e)).in_text(&text))?;
        scene.validate().map_err(|e| e.in_text(&text))?;
        let folder = path.parent().unwrap_or(Path::new("")).to_owned();
        Ok(Self {
            scene,
            text,
            folder,
        })
    }

    /// A scene that was made in a program; its paths are relative to `folder`.
    ///
    /// # Errors
    /// [`SceneError`] with all problems that were found.
    pub fn of(scene: Scene, folder: &Path) -> Result<Self, SceneError> {
        scene.validate()?;
        let text = toml::to_string(&scene).map_err(|e| {
            let remedy = "paths of mesh files have to be valid UTF-8";
            Problem::new(
                Key::root(),
                format!("the scene cannot be written: {e}"),
                remedy,
            )
        })?;
        Ok(Self {
            scene,
            text: SceneText {
                path: folder.join("scene.toml"),
                text,
            },
            folder: folder.to_owned(),
        })
    }

    /// The scene.
    pub fn scene(&self) -> &Scene {
        &self.scene
    }

    /// Its text, edits included.
    pub fn text(&self) -> &SceneText {
        &self.text
    }

    /// The folder that its paths are relative to.
    pub fn folder(&self) -> &Path {
        &self.folder
    }

    /// Makes everything that a simulation needs.
    ///
    /// # Errors
    /// [`SceneError`], shown at its place in the text.
    pub fn build(&self) -> Result<Setup, SceneError> {
        let setup = self.scene.build(&self.folder);
        let mut setup = setup.map_err(|e| e.in_text(&self.text))?;
        setup.text = Some(self.text.clone());
        Ok(setup)
    }

    /// What each edge of the sheet, or of all sheets one after the other, is meant to do, if there is a
    /// crease pattern among the meshes; `None` for an edge of which the pattern does not say it.
    ///
    /// # Errors
    /// [`SceneError`] if the mesh cannot be made.
    pub fn fold_assignments(&self) -> Result<Option<Vec<Option<FoldAssignment>>>, SceneError> {
        let sheets = &self.scene.sheet;
        let mut all = Vec::new();
        for (k, sheet) in sheets.iter().enumerate() {
            let key = sheet_key(sheets.len(), k);
            let mesh = sheet.refined(&key, &self.folder);
            let mesh = mesh.map_err(|e| SceneError::from(e).in_text(&self.text))?;
            let edges = mesh.refined.sheet().topology().edge_count();
            all.push(mesh.roles.map_or(vec![None; edges], |r| r.assignments));
        }
        let all = all.concat();
        Ok(all.iter().any(Option::is_some).then_some(all))
    }

    /// The same scene with other paths of mesh files, one for each of [`Scene::files`].
    ///
    /// # Errors
    /// [`SceneFileError`] if the text does not take the paths.
    pub fn with_files(&self, names: &[PathBuf]) -> Result<Self, SceneFileError> {
        let edits: Vec<String> = self
            .scene
            .files()
            .iter()
            .zip(names)
            .map(|((key, _), name)| {
                let name = Value::from(name.to_string_lossy().as_ref());
                format!("{key}.path={name}")
            })
            .collect();
        Self::parse(self.text.text.clone(), &self.text.path, &edits)
    }
}
