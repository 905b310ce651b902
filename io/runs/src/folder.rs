//! The folder of a run.

use super::error::BEGIN_ANEW;
use super::{RunError, Summary};
use crc::{CRC_64_XZ, Crc};
use isosheet_files::{FileError, NumberedFiles, input, is_unfinished, read_json, write_atomically};
use isosheet_formats::sources;
use isosheet_scenes::{FileKind, Files, Problem, Scene, SceneError, SceneFile};
use std::ffi::OsString;
use std::fmt;
use std::fs::{self, File, Metadata, TryLockError};
use std::io::{self, ErrorKind, Write};
use std::path::{Path, PathBuf};
use std::sync::Arc;

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
pub(crate) struct RunInputs<'a> {
    pub(crate) file: &'a SceneFile,
    meshes: Vec<Arc<[u8]>>,
    /// The scene as the folder of a run has it, which names copies of the mesh files.
    pub(crate) stored: SceneFile,
    pub(crate) hash: SceneHash,
}

impl<'a> RunInputs<'a> {
    /// Reads the mesh files of a scene.
    pub(crate) fn read(file: &'a SceneFile, files: &mut Files) -> Result<Self, RunError> {
        let (mut meshes, mut names) = (Vec::new(), Vec::new());
        let mut scene = file.scene().clone();
        for (k, of) in scene.files_mut().into_iter().enumerate() {
            let in_scene = |problem: Problem| SceneError::from(problem).in_text(file.text());
            let name = of.path.file_name().unwrap_or_default().to_string_lossy();
            let (bytes, name) = match of.kind {
                FileKind::Mesh => {
                    let bytes = files.contents(of.path).map_err(|e| {
                        let path = file.folder().join(&*of.path);
                        let message = format!("cannot read {}: {e}", path.display());
                        let remedy = "check the path, which is relative to the scene";
                        in_scene(Problem::new(of.key.name("path"), message, remedy))
                    })?;
                    (bytes, format!("{k}-{name}"))
                }
                FileKind::Motion => {
                    let bytes = files.motion(of.path, &of.key).map_err(in_scene)?;
                    let stem = name.strip_suffix(".npz").unwrap_or(&name);
                    (bytes, format!("{k}-{}.npz", stem.replace('*', "")))
                }
            };
            meshes.push(bytes);
            names.push(Path::new(MESHES).join(name));
        }
        Ok(Self {
            hash: hash(file.scene(), &meshes),
            stored: file.with_files(&names)?,
            file,
            meshes,
        })
    }

    /// Refuses a folder with a file or a folder that the scene reads.
    fn check_apart(&self, root: &Path) -> Result<(), RunError> {
        let Ok(outer) = fs::canonicalize(root) else {
            return Ok(());
        };
        for (_, path) in self.file.scene().files() {
            let path = self.file.folder().join(path);
            let inner = sources(&Path::new(".").join(&path)).into_iter();
            let mut inner = inner.filter_map(|path| fs::canonicalize(path).ok());
            if inner.any(|inner| inner.starts_with(&outer)) {
                return Err(RunError::ReadByScene {
                    folder: root.to_owned(),
                    path,
                });
            }
        }
        Ok(())
    }

    /// Copies the mesh files and writes the scene that names the copies.
    fn store(&self, folder: &Path) -> Result<(), RunError> {
        let names = self.stored.scene().files().into_iter();
        for ((_, name), bytes) in names.zip(&self.meshes) {
            write_atomically(&folder.join(&name), |w| w.write_all(bytes))?;
        }
        let text = &self.stored.text().text;
        write_atomically(&folder.join(RunFolder::SCENE), |w| {
            w.write_all(text.as_bytes())
        })?;
        Ok(())
    }
}

fn hash(scene: &Scene, meshes: &[Arc<[u8]>]) -> SceneHash {
    const SUM: Crc<u64> = Crc::<u64>::new(&CRC_64_XZ);
    let mut scene = scene.clone();
    for file in scene.files_mut() {
        *file.path = PathBuf::new();
    }
    let mut sum = SUM.digest();
    let canonical = serde_json::to_vec(&scene);
    sum.update(&canonical.expect("numbers, names and lists have a form in JSON"));
    for bytes in meshes {
        sum.update(&(bytes.len() as u64).to_le_bytes());
        sum.update(bytes);
    }
    SceneHash(sum.finalize())
}

/// What is in a folder at the start.
pub(crate) enum FolderState {
    /// A complete run of the same scene.
    Complete(RunFolder),
    /// Nothing that could be continued.
    Empty(RunFolder),
    /// A checkpoint of the same scene.
    Partial(RunFolder),
}

/// What becomes of a run that a folder holds at the start.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Existing {
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
    lock: File,
}

/// Gives the lock up at once. (A file that is closed keeps it as long as another process has a copy, such as
/// one that has been forked at that moment and has not yet become another program.)
impl Drop for RunFolder {
    fn drop(&mut self) {
        let _ = self.lock.unlock();
    }
}

impl RunFolder {
    pub(crate) const SCENE: &'static str = "scene.toml";
    pub(crate) const SUMMARY: &'static str = "summary.json";
    pub(crate) const CHECKPOINT: &'static str = "checkpoint.bin";
    pub(crate) const FRAMES: &'static str = "frames.bin";
    pub(crate) const HISTORY: &'static str = "history.csv";
    pub(crate) const LOADS: &'static str = "loads.csv";
    pub(crate) const MEASURES: &'static str = "measures.csv";
    pub(crate) const EVENTS: &'static str = "events.csv";
    pub(crate) const TRAJECTORY: &'static str = "trajectory.npz";
    pub(crate) const PAGE: &'static str = "index.html";
    pub(crate) const OBJ: &'static str = "obj";

    /// The files of a run in its folder. The summary is the first to be deleted, so that what is left after a
    /// kill is not taken for a complete run.
    const FILES: [&'static str; 10] = [
        Self::SUMMARY,
        Self::CHECKPOINT,
        Self::PAGE,
        Self::TRAJECTORY,
        Self::FRAMES,
        Self::HISTORY,
        Self::LOADS,
        Self::MEASURES,
        Self::EVENTS,
        Self::SCENE,
    ];

    /// Whether a folder holds a run, complete or not.
    pub(crate) fn holds_run(root: &Path) -> bool {
        root.join(Self::SCENE).is_file() && Self::is_marked(root)
    }

    /// Whether a folder is marked as that of a run: by the lock, or by a summary, as the empty file of the
    /// lock may have been lost with a copy.
    fn is_marked(root: &Path) -> bool {
        root.join(LOCK).is_file() || read_json::<Summary>(&root.join(Self::SUMMARY)).is_ok()
    }

    /// Whether the folder holds a complete run of the scene with all its files. Such a run is not touched:
    /// its folder may be read-only.
    pub(crate) fn is_complete(root: &Path, material: &RunInputs<'_>) -> Result<bool, RunError> {
        let complete = root.join(Self::SUMMARY).is_file() && Self::is_marked(root);
        if complete {
            check_scene(root, material)?;
        }
        let trajectory = &material.file.scene().output.trajectory;
        Ok(complete && (!trajectory || root.join(Self::TRAJECTORY).is_file()))
    }

    /// Whether the folder seems to hold a run that can be continued.
    pub(crate) fn has_checkpoint(root: &Path) -> bool {
        root.join(Self::CHECKPOINT).is_file()
    }

    /// Creates the folder when missing, and locks it.
    fn claim(root: &Path) -> Result<Self, RunError> {
        let unwritable = |source| RunError::Unwritable {
            folder: root.to_owned(),
            source,
        };
        fs::create_dir_all(root).map_err(unwritable)?;
        if holds_other_files(root, &[LOCK]).map_err(unwritable)? && !Self::is_marked(root) {
            return Err(RunError::Foreign {
                folder: root.to_owned(),
            });
        }
        refuse_links(root)?;
        let lock = input::reopen(&root.join(LOCK), File::options().create(true).append(true));
        let lock = lock.map_err(unwritable)?;
        match lock.try_lock() {
            Ok(()) => {}
            Err(TryLockError::WouldBlock) => {
                return Err(RunError::Busy {
                    folder: root.to_owned(),
                });
            }
            Err(TryLockError::Error(source)) => return Err(unwritable(source)),
        }
        Ok(Self {
            root: root.to_owned(),
            lock,
        })
    }

    /// Claims the folder and says what is in it.
    pub(crate) fn open(
        root: &Path,
        material: &RunInputs<'_>,
        existing: Existing,
    ) -> Result<FolderState, RunError> {
        let unwritable = |source| RunError::Unwritable {
            folder: root.to_owned(),
            source,
        };
        if existing == Existing::Delete {
            material.check_apart(root)?;
        }
        let folder = Self::claim(root)?;
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
            return Ok(FolderState::Complete(folder));
        }
        if Self::has_checkpoint(root) {
            return Ok(FolderState::Partial(folder));
        }
        if !stored {
            material.store(root)?;
        }
        Ok(FolderState::Empty(folder))
    }

    /// Removes the unfinished files that a killed process left.
    fn remove_parts(&self) -> io::Result<()> {
        let folders = [self.root.clone(), self.path(MESHES), self.path(Self::OBJ)];
        folders
            .iter()
            .try_for_each(|folder| remove_unfinished(folder))
    }

    /// Deletes the files of a run, and no others: of its folders the frames, and the meshes that the stored
    /// scene names. Folders that hold anything else stay.
    fn delete_run(&self) -> io::Result<()> {
        let meshes = match SceneFile::read(&self.path(Self::SCENE), &[]) {
            Ok(stored) => stored_meshes(stored.scene()),
            // Nothing is known of them then.
            Err(_) => Vec::new(),
        };
        let of_frames = NumberedFiles::new(&self.path(Self::OBJ), "frame", "obj");
        let frames = names_in(&self.path(Self::OBJ))?.into_iter();
        let frames = frames.filter(|name| of_frames.number(name).is_some());
        let own = Self::FILES.map(PathBuf::from).into_iter();
        let own = own.chain(frames.map(|name| Path::new(Self::OBJ).join(name)));
        for name in own.chain(meshes) {
            match fs::remove_file(self.root.join(name)) {
                Err(error) if error.kind() != ErrorKind::NotFound => return Err(error),
                _ => {}
            }
        }
        for folder in [Self::OBJ, MESHES] {
            match fs::remove_dir(self.path(folder)) {
                Err(error)
                    if ![ErrorKind::NotFound, ErrorKind::DirectoryNotEmpty]
                        .contains(&error.kind()) =>
                {
                    return Err(error);
                }
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

/// Whether a folder holds a run, complete or not.
pub fn holds_run(folder: &Path) -> bool {
    RunFolder::holds_run(folder)
}

/// The folder of the run that has written a file, by whatever links; none of other files.
///
/// What is exported of a run must not be written there: the run could not be read any more.
pub fn run_of_file(path: &Path) -> Option<PathBuf> {
    let path = path.canonicalize().ok()?;
    let folder = path.parent()?;
    let name = path.file_name()?;
    let is_own = name == LOCK || RunFolder::FILES.iter().any(|own| name == *own);
    if is_own && RunFolder::holds_run(folder) {
        return Some(folder.to_owned());
    }
    let is_beneath = [MESHES, RunFolder::OBJ].map(|own| folder.ends_with(own));
    let root = folder.parent().filter(|_| is_beneath.contains(&true))?;
    RunFolder::holds_run(root).then(|| root.to_owned())
}

/// Refuses a folder that no run can be written to: one that has other files, or in which another process
/// works. One that does not exist is not made.
///
/// # Errors
/// As [`simulate`](super::simulate) refuses it.
pub fn check_folder(root: &Path) -> Result<(), RunError> {
    match root.try_exists() {
        _ if root.as_os_str().is_empty() => Err(RunError::NoFolder),
        Ok(false) => Ok(()),
        _ => RunFolder::claim(root).map(drop),
    }
}

/// Refuses a folder that holds the run of none of some scenes, one of which is to run there; where the run
/// that it holds is to be deleted, one with a file that these scenes read.
///
/// # Errors
/// As [`simulate`](super::simulate) refuses it.
pub fn check_run(root: &Path, scenes: &[SceneFile], existing: Existing) -> Result<(), RunError> {
    if !RunFolder::holds_run(root) {
        return Ok(());
    }
    let mut refused = Ok(());
    for scene in scenes {
        let material = RunInputs::read(scene, &mut Files::in_folder(scene.folder()))?;
        refused = match existing {
            Existing::Continue => check_scene(root, &material),
            Existing::Delete => material.check_apart(root),
        };
        if refused.is_ok() {
            break;
        }
    }
    refused
}

/// Refuses a folder with links, or with anything else that a run does not make, under the names of its files
/// and folders: nothing is written or deleted through them.
fn refuse_links(root: &Path) -> Result<(), RunError> {
    let files = RunFolder::FILES.into_iter().chain([LOCK]);
    let files = files.map(|name| (root.join(name), Metadata::is_file as fn(&Metadata) -> bool));
    let folders = [MESHES, RunFolder::OBJ].into_iter();
    let folders = folders.map(|name| (root.join(name), Metadata::is_dir as fn(&Metadata) -> bool));
    for (path, is_own) in files.chain(folders) {
        match fs::symlink_metadata(&path) {
            Ok(found) if !is_own(&found) => return Err(RunError::NotOwn { path }),
            _ => {}
        }
    }
    Ok(())
}

/// The copied mesh files that a stored scene names, relative to the folder of its run.
fn stored_meshes(scene: &Scene) -> Vec<PathBuf> {
    let files = scene.files().into_iter().map(|(_, path)| path);
    let is_copy = |path: &PathBuf| path.parent() == Some(Path::new(MESHES));
    files.filter(is_copy).collect()
}

/// The names of what is in a folder, nothing if there is none.
fn names_in(folder: &Path) -> io::Result<Vec<OsString>> {
    match fs::read_dir(folder) {
        Ok(entries) => entries.map(|entry| Ok(entry?.file_name())).collect(),
        Err(error) if error.kind() == ErrorKind::NotFound => Ok(Vec::new()),
        Err(error) => Err(error),
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

/// The scene that is stored in the folder of a run. Its mesh files are in the folder.
///
/// # Errors
/// [`RunError::NoRun`] without one, [`RunError::File`] if it names files that are not in the folder.
pub(crate) fn stored_scene(root: &Path) -> Result<SceneFile, RunError> {
    if root.as_os_str().is_empty() {
        return Err(RunError::NoFolder);
    }
    let path = root.join(RunFolder::SCENE);
    if !path.is_file() {
        return Err(RunError::NoRun {
            folder: root.to_owned(),
        });
    }
    let stored = SceneFile::read(&path, &[])?;
    for (_, name) in stored.scene().files() {
        if let Err(error) = input::within(root, &name) {
            let problem = format!("it names the mesh file {}: {error}", name.display());
            return Err(FileError::content(&path, problem, BEGIN_ANEW).into());
        }
    }
    Ok(stored)
}

/// Refuses a folder with a run of another scene.
fn check_scene(root: &Path, material: &RunInputs<'_>) -> Result<(), RunError> {
    let stored = stored_scene(root)?;
    let stored = RunInputs::read(&stored, &mut Files::in_folder(root))?;
    if stored.hash == material.hash {
        return Ok(());
    }
    Err(RunError::OtherScene {
        folder: root.to_owned(),
    })
}
