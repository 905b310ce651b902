//! What can be wrong with a glTF file.

use isosheet_mesh::Advice;
use thiserror::Error;

/// A glTF file that cannot be used.
#[derive(Debug, Error)]
#[non_exhaustive]
pub enum GltfProblem {
    /// The file breaks the rules of the format.
    #[error("the file is not valid glTF: {0}")]
    Format(String),
    /// The file needs an extension that is not supported, such as compressed meshes.
    #[error("the file needs the extension {name}, which is not supported")]
    Extension {
        /// The extension.
        name: String,
    },
    /// There is no mesh, or none of that name.
    #[error("there is no mesh {} (the meshes of the file are {names:?})", wanted.as_deref().unwrap_or("at all"))]
    NoMesh {
        /// The name that was asked for.
        wanted: Option<String>,
        /// The names of the meshes in the file; a mesh without a name has an empty one.
        names: Vec<String>,
    },
    /// A part of a mesh is points or lines.
    #[error("part {primitive} of mesh {mesh} is made of {mode}")]
    Mode {
        /// The mesh, from 0.
        mesh: usize,
        /// The part, from 0.
        primitive: usize,
        /// What it is made of.
        mode: String,
    },
    /// An array of numbers is missing or of another type.
    #[error("part {primitive} of mesh {mesh}: {array} {problem}")]
    Array {
        /// The mesh, from 0.
        mesh: usize,
        /// The part, from 0.
        primitive: usize,
        /// "positions" or "indices".
        array: &'static str,
        /// What is wrong.
        problem: String,
    },
    /// A buffer is a file of its own, where this is refused.
    #[error("buffer {buffer} is the file {file:?}")]
    Separate {
        /// The buffer, from 0.
        buffer: usize,
        /// The file.
        file: String,
    },
    /// A buffer cannot be read.
    #[error("buffer {buffer}: {problem}")]
    Buffer {
        /// The buffer, from 0.
        buffer: usize,
        /// What is wrong.
        problem: String,
    },
}

impl Advice for GltfProblem {
    fn advice(&self) -> Option<&'static str> {
        match self {
            Self::Format(..) => Some("export the file again; the Khronos glTF validator says more"),
            Self::Extension { .. } => Some("export the file without it"),
            Self::NoMesh { .. } => Some("name a mesh of the file, or export it with one"),
            Self::Mode { .. } => Some("export it as triangles, or without this part"),
            Self::Array { .. } => Some("export the file again"),
            Self::Separate { .. } => Some("export the mesh as one file, as .glb"),
            Self::Buffer { .. } => Some("keep the file and its buffers together, or use .glb"),
        }
    }
}
