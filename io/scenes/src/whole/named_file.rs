//! Files that a scene names.

use crate::Scene;
use crate::words::key::{Key, KeyPart};
use crate::words::part::{all, all_mut};
use std::path::PathBuf;

/// What a file of a scene is.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum FileKind {
    /// A mesh, whose file is read as it is.
    Mesh,
    /// A mesh in motion, of whose files one archive is made.
    Motion,
}

/// A file that a scene names.
pub struct NamedFile<'a> {
    /// The place of the file in the scene.
    pub key: Key,
    /// What it is.
    pub kind: FileKind,
    /// Its path, relative to the scene.
    pub path: &'a mut PathBuf,
}

impl Scene {
    /// The files that the scene names, in the order of the scene.
    pub fn files(&self) -> Vec<(Key, PathBuf)> {
        let paths = all::<PathBuf>(self, Key::root()).into_iter();
        paths
            .map(|(at, path)| (file_of(&at.key), path.clone()))
            .collect()
    }

    /// The files that the scene names, so that their paths can be changed.
    pub fn files_mut(&mut self) -> Vec<NamedFile<'_>> {
        let paths = all_mut(self, Key::root()).into_iter();
        let named = paths.map(|(at, path)| {
            let key = file_of(&at.key);
            let is_motion =
                matches!(key.parts().last(), Some(KeyPart::Name(name)) if name == "sequence");
            let kind = if is_motion {
                FileKind::Motion
            } else {
                FileKind::Mesh
            };
            NamedFile { key, kind, path }
        });
        named.collect()
    }
}

/// The place of the file of a path.
fn file_of(path: &Key) -> Key {
    path.above().unwrap_or_default()
}
