//! Meshes in motion from files of other programs and from runs, each made one archive of numpy.

mod extension;
mod listed;
mod named;
mod samples;
#[cfg(test)]
mod tests;

use super::MeshFormat;
use extension::has_extension;
use isosheet_files::{FileError, input};
use std::path::Path;
use std::path::PathBuf;

/// The name of the trajectory in the folder of a run.
const TRAJECTORY: &str = "trajectory.npz";

/// Whether files of this name say which axis points upwards, so that their meshes, in motion or not, are read
/// with z upwards.
pub fn says_up(path: &Path) -> bool {
    MeshFormat::of(path).is_some_and(MeshFormat::says_up)
}

/// The files and folders that a mesh in motion, or the mesh of a file, is read from.
pub fn sources(path: &Path) -> Vec<PathBuf> {
    if named::is_pattern(path) {
        return path.parent().map(Path::to_owned).into_iter().collect();
    }
    let listed = match is_list(path) {
        true => listed::files(path).map(|(_, files)| files),
        false => Ok(Vec::new()),
    };
    let own = std::iter::once(path.to_owned());
    own.chain(listed.unwrap_or_default()).collect()
}

/// Whether a file is a list of mesh files.
fn is_list(path: &Path) -> bool {
    has_extension(path, "pvd") || has_extension(path, "series")
}

/// The archive that [`MovingMesh::parse`](super::MovingMesh::parse) reads of the mesh in motion at a path:
///
/// - an archive itself (`.npz`), or the folder of a run, which has one;
/// - a list of mesh files with their times, `.pvd` or `.series`;
/// - a folder of numbered mesh files, or such files by a pattern with one `*` for their numbers.
///
/// # Errors
/// [`FileError::Read`], naming the file and the sample.
pub fn motion_archive(path: &Path) -> Result<Vec<u8>, FileError> {
    let has = |extension: &str| has_extension(path, extension);
    let read = |path: &Path| input::read(path).map_err(|e| FileError::unreadable(path, e));
    let mesh = if named::is_pattern(path) {
        named::of_pattern(path)?
    } else if path.is_dir() {
        match path.join(TRAJECTORY) {
            trajectory if trajectory.is_file() => return read(&trajectory),
            _ if path.join("scene.toml").is_file() => {
                let remedy = "continue the run by `isosheet resume`, or let its scene have `output.trajectory`";
                let problem = format!("the folder of the run has no {TRAJECTORY}");
                return Err(FileError::content(path, problem, remedy));
            }
            _ => named::of_folder(path)?,
        }
    } else if has("npz") {
        return read(path);
    } else if is_list(path) {
        listed::read(path)?
    } else {
        // Of a path that leads nowhere the extension is not the problem.
        std::fs::metadata(path).map_err(|e| FileError::unreadable(path, e))?;
        return Err(FileError::content(
            path,
            "it is no mesh in motion",
            "export one .glb, .ply or .obj file for each frame, with numbers, and name them by their folder or by a \
             pattern such as `walk_*.obj`; .npz, .pvd and .series files and the folders of runs are read as well",
        ));
    };
    mesh.archive().map_err(|e| FileError::unreadable(path, e))
}
