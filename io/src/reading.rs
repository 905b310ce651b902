//! What reading a mesh changed, in words.

use isosheet_formats::MeshFile;

/// What reading a mesh changed, as a line; none if nothing.
pub(super) fn what_reading_did(mesh: &MeshFile) -> String {
    let did = mesh.what_reading_did();
    did.map_or(String::new(), |did| format!("note: {did}\n"))
}
