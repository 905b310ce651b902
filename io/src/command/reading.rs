//! What reading a mesh changed, in words.

use crate::MeshFile;

/// What reading a mesh changed, as a line; none if nothing.
pub(super) fn what_reading_did(mesh: &MeshFile) -> String {
    match mesh.changes.is_nothing() {
        true => String::new(),
        false => format!("note: {}\n", mesh.changes),
    }
}
