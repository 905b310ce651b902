//! Scene files.

use crate::building::build::Kept;
use crate::text::changed::written;
use crate::text::form::form_problems;
use crate::whole::switches::Switches;
use crate::words::edit::{self, EditError};
use crate::words::error::{SceneError, SceneText};
use crate::words::key::Key;
use crate::words::problem::Problem;
use crate::words::toml_problem::{syntax_problem, toml_problem};
use crate::{Scene, Setup};
use isosheet_drawings::DrawingFormat;
use isosheet_dynamics::Checkpoint;
use isosheet_files::{FileError, input};
use isosheet_formats::MeshFormat;
use isosheet_mesh::Advice;
use serde::Deserialize;
use std::path::{Path, PathBuf};
use std::sync::OnceLock;
use thiserror::Error;
use toml::de::DeTable;
use toml_edit::DocumentMut;

/// A scene with its text, and the folder that its paths are relative to.
#[derive(Clone, Debug)]
pub struct SceneFile {
    scene: Scene,
    /// The text that was read.
    read: SceneText,
    /// The keys whose values have been changed since.
    changed: Vec<Key>,
    /// The text of the scene as it is, once somebody has asked for it.
    text: OnceLock<SceneText>,
    folder: PathBuf,
}

impl PartialEq for SceneFile {
    fn eq(&self, other: &Self) -> bool {
        let same = self.scene == other.scene && self.folder == other.folder;
        same && self.text() == other.text()
    }
}

/// A scene file that cannot be used.
#[derive(Debug, Error)]
pub enum SceneFileError {
    /// The file cannot be read, or is a mesh file by its name.
    #[error(transparent)]
    Read(#[from] FileError),
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
            Self::Read(error) => error.advice(),
            Self::Edit(error) => error.advice(),
            Self::Scene(error) => error.advice(),
        }
    }
}

/// Refuses what is a mesh file by its name: as TOML it is wrong in a way that helps nobody.
fn refuse_mesh(path: &Path) -> Result<(), FileError> {
    match MeshFormat::of(path) {
        _ if DrawingFormat::of(path).is_some() => {
            let remedy = "name it in a scene, `mesh = { drawing = { path = ..., spacing = ... } }`: `isosheet new` writes a \
                          scene to start from; `isosheet fold` folds crease patterns without one";
            let problem = "it is a drawing and no scene";
            Err(FileError::content(path, problem, remedy))
        }
        None => Ok(()),
        Some(_) => {
            let remedy = "name it in a scene, `mesh = { file = { path = ... } }`: `isosheet new` writes a scene to start \
                          from";
            let problem = "it is a mesh file and no scene";
            Err(FileError::content(path, problem, remedy))
        }
    }
}

impl SceneFile {
    /// Reads a scene file, makes edits of the form `key=value` and checks the result.
    ///
    /// # Errors
    /// [`SceneFileError`], with all problems that were found.
    pub fn read(path: &Path, edits: &[String]) -> Result<Self, SceneFileError> {
        refuse_mesh(path)?;
        let text = input::read_text(path).map_err(|e| FileError::unreadable(path, e))?;
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
            edits: edits.to_vec(),
        };
        if !edits.is_empty() {
            let parsed = text.text.parse::<DocumentMut>();
            let mut document =
                parsed.map_err(|e| SceneError::from(syntax_problem(&e)).in_text(&text))?;
            edit::apply(&mut document, edits)?;
            text.text = document.to_string();
        }
        let scene = scene_of(&text.text).map_err(|e| e.in_text(&text))?;
        let folder = path.parent().unwrap_or(Path::new(""));
        Ok(Self::new(scene, text, folder))
    }

    fn new(scene: Scene, read: SceneText, folder: &Path) -> Self {
        Self {
            scene,
            read,
            changed: Vec::new(),
            text: OnceLock::new(),
            folder: folder.to_owned(),
        }
    }

    /// A scene that was made in a program; its paths are relative to `folder`.
    ///
    /// # Errors
    /// [`SceneError`] with all problems that were found.
    pub fn of(scene: Scene, folder: &Path) -> Result<Self, SceneError> {
        scene.validate()?;
        let text = toml::to_string(&scene).map_err(|e| {
            let message = format!("the scene cannot be written as TOML: {e}");
            let remedy = format!(
                "whole numbers go up to {}, and paths have to be valid UTF-8",
                i64::MAX
            );
            Problem::new(Key::root(), message, remedy)
        })?;
        let text = SceneText {
            path: folder.join("scene.toml"),
            text,
            edits: Vec::new(),
        };
        Ok(Self::new(scene, text, folder))
    }

    /// The scene file with other values at some keys.
    ///
    /// # Errors
    /// [`SceneError`], shown at its place in the text of the changed scene.
    pub fn changed(
        &self,
        scene: Scene,
        keys: impl IntoIterator<Item = Key>,
    ) -> Result<Self, SceneError> {
        let mut file = Self {
            scene,
            text: OnceLock::new(),
            ..self.clone()
        };
        for key in keys {
            if !file.changed.contains(&key) {
                file.changed.push(key);
            }
        }
        let valid = file.scene.validate();
        valid.map_err(|e| e.in_text(file.text()))?;
        Ok(file)
    }

    /// The scene.
    pub fn scene(&self) -> &Scene {
        &self.scene
    }

    /// Its text, edits included.
    pub fn text(&self) -> &SceneText {
        self.text.get_or_init(|| {
            let SceneText { path, text, edits } = &self.read;
            let text = match self.changed.is_empty() {
                true => text.clone(),
                false => {
                    let written = written(text, &self.scene, &self.changed);
                    // Without a place for its values in the text that was read.
                    written.unwrap_or_else(|| toml::to_string(&self.scene).unwrap_or_default())
                }
            };
            SceneText {
                path: path.clone(),
                text,
                edits: edits.clone(),
            }
        })
    }

    /// The number at a key of the text, if there is one.
    pub fn number(&self, key: &Key) -> Option<f64> {
        let whole = self.text().text.parse().ok().map(toml::Value::Table)?;
        let value = key.find(&whole)?;
        value.as_float().or(value.as_integer().map(|n| n as f64))
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
        self.build_with(&mut Kept::in_folder(&self.folder))
    }

    /// Makes everything that a simulation needs, of what is kept of the scene where it can be.
    pub fn build_with(&self, kept: &mut Kept) -> Result<Setup, SceneError> {
        self.with_text(self.scene.build_with(kept))
    }

    /// Makes everything that a simulation needs which goes on from a checkpoint: what holds is what held
    /// there.
    ///
    /// # Errors
    /// As [`SceneFile::build`]; [`SceneError`] if the checkpoint is that of another scene.
    pub fn build_at(&self, checkpoint: &Checkpoint) -> Result<Setup, SceneError> {
        self.build_at_with(&mut Kept::in_folder(&self.folder), checkpoint)
    }

    /// Makes what goes on from a checkpoint, of what is kept of the scene where it can be.
    pub fn build_at_with(
        &self,
        kept: &mut Kept,
        checkpoint: &Checkpoint,
    ) -> Result<Setup, SceneError> {
        let switches = Switches::of_note(&self.scene, checkpoint.note());
        let setup = switches.and_then(|switches| self.scene.build_switched(kept, &switches));
        self.with_text(setup)
    }

    /// What was built of the scene, with the text for its errors.
    fn with_text(&self, setup: Result<Setup, SceneError>) -> Result<Setup, SceneError> {
        let mut setup = setup.map_err(|e| e.in_text(self.text()))?;
        setup.text = Some(self.text().clone());
        Ok(setup)
    }

    /// The scene file with other paths of mesh files, one for each of [`Scene::files`].
    ///
    /// # Errors
    /// [`SceneError`] if a path is empty.
    pub fn with_files(&self, names: &[PathBuf]) -> Result<Self, SceneError> {
        let mut scene = self.scene.clone();
        let mut keys = Vec::new();
        for (file, name) in scene.files_mut().into_iter().zip(names) {
            *file.path = name.clone();
            keys.push(file.key.name("path"));
        }
        self.changed(scene, keys)
    }
}

/// The scene of a text that is read once: for its form and for its values.
fn scene_of(text: &str) -> Result<Scene, SceneError> {
    let in_words = |e: &toml::de::Error| SceneError::from(toml_problem(e));
    let table = DeTable::parse(text).map_err(|e| in_words(&e))?;
    SceneError::of(form_problems(table.get_ref()))?;
    let scene = Scene::deserialize(toml::Deserializer::from(table)).map_err(|e| in_words(&e))?;
    scene.validate()?;
    Ok(scene)
}
