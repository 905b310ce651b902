//! The folder of a run.

use super::RunError;
use crate::format::atomic::is_unfinished;
use crate::format::write_atomically;
use crate::scene::{Problem, Scene, SceneError, SceneFile};
use crc::{CRC_64_XZ, Crc};
use std::fmt;
use std::fs::{self, File, TryLockError};
use std::io::{self, ErrorKind, Write};
use std::path::{Path, PathBuf};

/// Locked while a process works in the folder; also marks a folder as that of a run.
const LOCK: &str = "run.lock";

/// The folder of copied mesh files.
const MESHES: &str = "meshes";

/// CRC-64 of a scene, in a canonical form, and of the mesh files that it names: the same for the same run,
/// wherever the files lie and whatever comments the scene has.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct SceneHash(u64);

impl fmt::Display for SceneHash {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{:016x}", self.0)
    }
}

/// A scene with the bytes of the mesh files that it names.
pub(crate) struct Material<'a> {
    pub(crate) file: &'a SceneFile,
    meshes: Vec<(PathBuf, Vec<u8>)>,
    pub(crate) hash: SceneHash,
}

impl<'a> Material<'a> {
    /// Reads the mesh files of a scene.
    pub(crate) fn read(file: &'a SceneFile) -> Result<Self, RunError> {
        let mut meshes = Vec::new();
        for (key, path) in file.scene().files() {
            let path = file.folder().join(path);
            let bytes = fs::read(&path).map_err(|e| {
                let message = format!("cannot read {}: {e}", path.display());
                let remedy = "check the path, which is relative to the scene";
                let problem = Problem::new(key.name("path"), message, remedy);
                SceneError::from(problem).in_text(file.text())
            })?;
            meshes.push((path, bytes));
        }
        let hash = hash(file.scene(), &meshes);
        Ok(Self { file, meshes, hash })
    }

    /// Copies the mesh files and writes the scene that names the copies.
    fn store(&self, folder: &Path) -> Result<(), RunError> {
        let mut names = Vec::new();
        for (k, (path, bytes)) in self.meshes.iter().enumerate() {
            let name = path.file_name().unwrap_or_default().to_string_lossy();
            let name = Path::new(MESHES).join(format!("{k}-{name}"));
            write_atomically(&folder.join(&name), |w| w.write_all(bytes))?;
            names.push(name);
        }
        let stored = self.file.with_files(&names)?;
        let text = &stored.text().text;
        write_atomically(&folder.join(RunFolder::SCENE), |w| {
            w.write_all(text.as_bytes())
        })?;
        Ok(())
    }
}

fn hash(scene: &Scene, meshes: &[(PathBuf, Vec<u8>)]) -> SceneHash {
    const SUM: Crc<u64> = Crc::<u64>::new(&CRC_64_XZ);
    let mut scene = scene.clone();
    for (_, file) in scene.files_mut() {
        file.path = PathBuf::new();
    }
    let mut sum = SUM.digest();
    let canonical = serde_json::to_vec(&scene);
    sum.update(&canonical.expect("numbers, names and lists have a form in JSON"));
    for (_, bytes) in meshes {
        sum.update(&(bytes.len() as u64).to_le_bytes());
        sum.update(bytes);
    }
    SceneHash(sum.finalize())
}

/// What is in a folder at the start.
pub(crate) enum Contents {
    /// A complete run of the same scene.
    Complete(RunFolder),
    /// Nothing that could be continued.
    Empty(RunFolder),
    /// A checkpoint of the same scene.
    Partial(RunFolder),
}

/// What becomes of a run that a folder holds at the start.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Existing {
    /// A run of the same scene is continued, one of another scene is refused.
    Continue,
    /// It is deleted.
    Delete,
}

/// The folder of a run, locked against other processes.
#[derive(Debug)]
pub(crate) struct RunFolder {
    root: PathBuf,
    /// Held until the end: the lock goes with the file.
    _lock: File,
}

impl RunFolder {
    pub(crate) const SCENE: &'static str = "scene.toml";
    pub(crate) const SUMMARY: &'static str = "summary.json";
    pub(crate) const CHECKPOINT: &'static str = "checkpoint.bin";
    pub(crate) const FRAMES: &'static str = "frames.bin";
    pub(crate) const HISTORY: &'static str = "history.csv";
    pub(crate) const LOADS: &'static str = "loads.csv";
    pub(crate) const MEASURES: &'static str = "measures.csv";
    pub(crate) const TRAJECTORY: &'static str = "trajectory.npz";
    pub(crate) const PAGE: &'static str = "index.html";
    pub(crate) const OBJ: &'static str = "obj";

    /// Whether a folder is that of a run, complete or not.
    #[cfg(feature = "picture")]
    pub(crate) fn is_run(root: &Path) -> bool {
        root.join(Self::SCENE).is_file() && root.join(LOCK).is_file()
    }

    /// Whether the folder holds a complete run of the scene with all its files. Such a run is not touched:
    /// its folder may be read-only.
    pub(crate) fn is_complete(root: &Path, material: &Material<'_>) -> Result<bool, RunError> {
        let complete = root.join(Self::SUMMARY).is_file() && root.join(LOCK).is_file();
        if complete {
            check_scene(root, material)?;
        }
        let trajectory = &material.file.scene().output.trajectory;
        Ok(complete && (!trajectory || root.join(Self::TRAJECTORY).is_file()))
    }

    /// Creates the folder when missing, locks it and says what is in it.
    pub(crate) fn open(
        root: &Path,
        material: &Material<'_>,
        existing: Existing,
    ) -> Result<Contents, RunError> {
        let unwritable = |source| RunError::Unwritable {
            folder: root.to_owned(),
            source,
        };
        fs::create_dir_all(root).map_err(unwritable)?;
        if holds_other_files(root, &[LOCK]).map_err(unwritable)? && !root.join(LOCK).is_file() {
            return Err(RunError::Foreign {
                folder: root.to_owned(),
            });
        }
        let lock = File::create(root.join(LOCK)).map_err(unwritable)?;
        match lock.try_lock() {
            Ok(()) => {}
            Err(TryLockError::WouldBlock) => {
                return Err(RunError::Busy {
                    folder: root.to_owned(),
                });
            }
            Err(TryLockError::Error(source)) => return Err(unwritable(source)),
        }
        let folder = Self {
            root: root.to_owned(),
            _lock: lock,
        };
        folder.remove_parts().map_err(unwritable)?;
        if existing == Existing::Delete {
            folder.delete_run().map_err(unwritable)?;
        }
        // The scene is stored after the mesh files.
        let stored = root.join(Self::SCENE).is_file();
        if stored {
            check_scene(root, material)?;
        }
        // Another process may have completed the run before the lock was free.
        if root.join(Self::SUMMARY).is_file() {
            return Ok(Contents::Complete(folder));
        }
        if root.join(Self::CHECKPOINT).is_file() {
            return Ok(Contents::Partial(folder));
        }
        if !stored {
            material.store(root)?;
        }
        Ok(Contents::Empty(folder))
    }

    /// Removes the unfinished files that a killed process left.
    fn remove_parts(&self) -> io::Result<()> {
        let folders = [self.root.clone(), self.path(MESHES), self.path(Self::OBJ)];
        folders
            .iter()
            .try_for_each(|folder| remove_unfinished(folder))
    }

    /// Deletes the files of a run, and no others. The summary is the first, so that what is left after a kill
    /// is not taken for a complete run.
    fn delete_run(&self) -> io::Result<()> {
        let files = [
            Self::SUMMARY,
            Self::CHECKPOINT,
            Self::PAGE,
            Self::TRAJECTORY,
            Self::FRAMES,
            Self::HISTORY,
            Self::LOADS,
            Self::MEASURES,
            Self::SCENE,
        ];
        let folders = [Self::OBJ, MESHES];
        let deleted = files.map(|name| fs::remove_file(self.path(name)));
        let deleted = deleted.into_iter();
        let deleted = deleted.chain(folders.map(|name| fs::remove_dir_all(self.path(name))));
        for result in deleted {
            match result {
                Err(error) if error.kind() != ErrorKind::NotFound => return Err(error),
                _ => {}
            }
        }
        Ok(())
    }

    pub(crate) fn root(&self) -> &Path {
        &self.root
    }

    pub(crate) fn path(&self, name: &str) -> PathBuf {
        self.root.join(name)
    }
}

/// Whether a folder holds anything besides `own` files and unfinished ones, which killed processes leave. A
/// folder that does not exist holds nothing, and what is no folder is left to the error of writing to it.
///
/// # Errors
/// What the system says where the folder cannot be listed.
pub fn holds_other_files(folder: &Path, own: &[&str]) -> io::Result<bool> {
    let entries = match fs::read_dir(folder) {
        Ok(entries) => entries,
        Err(e) if [ErrorKind::NotFound, ErrorKind::NotADirectory].contains(&e.kind()) => {
            return Ok(false);
        }
        Err(error) => return Err(error),
    };
    for entry in entries {
        let name = entry?.file_name();
        if !is_unfinished(&name) && !own.iter().any(|own| name == *own) {
            return Ok(true);
        }
    }
    Ok(false)
}

/// Removes the unfinished files that killed processes left in a folder, if it exists.
///
/// # Errors
/// What the system says where the folder cannot be listed or a file cannot be removed.
pub fn remove_unfinished(folder: &Path) -> io::Result<()> {
    if !folder.is_dir() {
        return Ok(());
    }
    for entry in fs::read_dir(folder)? {
        let entry = entry?;
        if is_unfinished(&entry.file_name()) {
            fs::remove_file(entry.path())?;
        }
    }
    Ok(())
}

/// Refuses a folder with a run of another scene.
fn check_scene(root: &Path, material: &Material<'_>) -> Result<(), RunError> {
    let stored = SceneFile::read(&root.join(RunFolder::SCENE), &[])?;
    let stored = Material::read(&stored)?.hash;
    if stored == material.hash {
        return Ok(());
    }
    Err(RunError::OtherScene {
        folder: root.to_owned(),
    })
}
