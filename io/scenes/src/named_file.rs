//! Files that a scene names.

use super::key::Key;
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

impl<'a> NamedFile<'a> {
    /// A mesh file.
    pub(super) fn mesh(key: Key, path: &'a mut PathBuf) -> Self {
        let kind = FileKind::Mesh;
        Self { key, kind, path }
    }

    /// A mesh in motion.
    pub(super) fn motion(key: Key, path: &'a mut PathBuf) -> Self {
        let kind = FileKind::Motion;
        Self { key, kind, path }
    }
}
