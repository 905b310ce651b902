//! The output folder: nothing half-written, and a record of what is up to date.
//!
//! Each piece of work (a *unit*: a figure or a run) is made in a working folder inside `.stamps` and moved
//! into place when it is complete; its stamp in `.stamps` is removed before and written after that. A stamp
//! counts only while its options, the program and the files it lists are the same, so a rerun makes again
//! whatever changed or was cut short.
//!
//! The lock file in `.stamps` also marks a folder as the program's own: a folder that has other files and not
//! this one is refused, and only what lies in `.stamps` is ever cleaned up.

mod draft;
mod error;

pub(crate) use draft::Draft;
pub(crate) use error::StoreError;

use error::{reading, writing};

use crate::interrupt;
use crate::progress;
use anyhow::{Context, Result};
use serde::de::DeserializeOwned;
use serde::{Deserialize, Serialize};
use serde_json::Value;
use std::fs::{self, File};
use std::io::Write;
use std::path::{Path, PathBuf};

/// Folder of the program's own records and of its unfinished work.
const RECORDS: &str = ".stamps";

/// The file in [`RECORDS`] that marks a folder as the program's own, locked while a process works there.
const MARKER: &str = "isosheet-xtask.lock";

/// Prefix of unfinished work in [`RECORDS`]; whatever a killed process left is removed at the next start.
const PARTIAL: &str = "partial-";

/// Whether a unit was finished.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub(crate) enum Extent {
    /// All of it.
    #[default]
    Complete,
    /// Cut short by Ctrl-C; readable, and made again next time.
    Partial,
}

/// What is known about a unit that has been made.
#[derive(Clone, Debug, Serialize, Deserialize)]
pub(crate) struct Stamp {
    /// Name of the unit.
    pub(crate) unit: String,
    /// Options it was made with.
    pub(crate) options: Value,
    /// Version of this package.
    pub(crate) version: String,
    /// Fingerprint of the program file.
    pub(crate) program: String,
    /// Whether it was finished.
    pub(crate) extent: Extent,
    /// Its files and folders, relative to the output folder.
    pub(crate) entries: Vec<String>,
    /// What it found.
    pub(crate) facts: Value,
}

/// A piece of work that is kept once it is complete.
#[derive(Clone, Debug)]
pub(crate) struct Unit {
    /// Name of its stamp.
    pub(crate) name: String,
    /// Its name for people.
    pub(crate) title: String,
    /// What it depends on besides the program: with other options it is made again.
    pub(crate) options: Value,
}

/// The output folder, locked against other processes.
#[derive(Debug)]
pub(crate) struct Store {
    root: PathBuf,
    program: String,
    /// Held until the end: the lock goes with the file.
    _lock: File,
}

impl Store {
    /// Creates the folder when missing, checks that it is empty or this program's own and that it can be
    /// written to, locks it and removes what a killed process left.
    pub(crate) fn open(root: &Path) -> Result<Self, StoreError> {
        let folder = || root.to_owned();
        let unwritable = |source| StoreError::Unwritable {
            folder: folder(),
            source,
        };
        fs::create_dir_all(root).map_err(unwritable)?;
        let records = root.join(RECORDS);
        if !records.join(MARKER).is_file() && !is_empty(root).map_err(unwritable)? {
            return Err(StoreError::Foreign { folder: folder() });
        }
        fs::create_dir_all(&records).map_err(unwritable)?;
        let lock = File::create(records.join(MARKER)).map_err(unwritable)?;
        lock.try_lock().map_err(|error| match error {
            fs::TryLockError::WouldBlock => StoreError::Busy { folder: folder() },
            fs::TryLockError::Error(source) => unwritable(source),
        })?;
        tempfile::tempfile_in(root).map_err(unwritable)?;
        for entry in fs::read_dir(&records).map_err(unwritable)?.flatten() {
            if entry.file_name().to_string_lossy().starts_with(PARTIAL) {
                remove(&entry.path()).map_err(unwritable)?;
            }
        }
        Ok(Self {
            root: folder(),
            program: program_fingerprint(),
            _lock: lock,
        })
    }

    /// The folder.
    pub(crate) fn root(&self) -> &Path {
        &self.root
    }

    fn stamp_path(&self, unit: &str) -> PathBuf {
        self.root.join(RECORDS).join(format!("{unit}.json"))
    }

    /// The stamp of a unit, whether up to date or not; `None` when there is none or it cannot be read.
    pub(crate) fn stamp(&self, unit: &str) -> Option<Stamp> {
        serde_json::from_slice(&fs::read(self.stamp_path(unit)).ok()?).ok()
    }

    /// The stamp of a unit if it is complete and was made by this program with these options.
    pub(crate) fn current(&self, unit: &str, options: &Value) -> Option<Stamp> {
        self.stamp(unit).filter(|s| {
            s.extent == Extent::Complete
                && s.options == *options
                && s.program == self.program
                && s.version == env!("CARGO_PKG_VERSION")
                && s.entries.iter().all(|e| self.root.join(e).exists())
        })
    }

    /// What a unit found: as it was kept if it is up to date, or made now by `work`, which writes its files
    /// into the draft, and kept.
    ///
    /// # Errors
    /// Those of `work`, with the title; [`Interrupted`](interrupt::Interrupted) before it begins; those of
    /// the folder.
    pub(crate) fn keep<T: Serialize + DeserializeOwned>(
        &self,
        unit: &Unit,
        work: impl FnOnce(&mut Draft) -> Result<T>,
    ) -> Result<T> {
        if let Some(found) = self.kept(unit) {
            progress::note(&unit.title, "up to date");
            return Ok(found);
        }
        interrupt::check()?;
        let mut draft = self.draft()?;
        let found = work(&mut draft).with_context(|| unit.title.clone())?;
        let facts = serde_json::to_value(&found)?;
        self.commit(draft, &unit.name, &unit.options, Extent::Complete, facts)?;
        Ok(found)
    }

    /// What an up-to-date unit found; `None` where there is none, or none in the present layout.
    pub(crate) fn kept<T: DeserializeOwned>(&self, unit: &Unit) -> Option<T> {
        let stamp = self.current(&unit.name, &unit.options)?;
        serde_json::from_value(stamp.facts).ok()
    }

    /// What a complete unit found that was made with the same options, by whichever program.
    pub(crate) fn earlier<T: DeserializeOwned>(&self, unit: &Unit) -> Option<T> {
        let stamp = self.stamp(&unit.name)?;
        let is_whole = stamp.extent == Extent::Complete && stamp.options == unit.options;
        is_whole.then(|| serde_json::from_value(stamp.facts).ok())?
    }

    /// The files of all stamps.
    fn stamps(&self) -> Result<Vec<PathBuf>, StoreError> {
        let folder = self.root.join(RECORDS);
        let listing = fs::read_dir(&folder).map_err(reading(&folder))?;
        Ok(listing.flatten().map(|entry| entry.path()).collect())
    }

    /// Forgets all units whose names start with `prefix`, so that they are made again.
    pub(crate) fn forget(&self, prefix: &str) -> Result<(), StoreError> {
        for stamp in self.stamps()? {
            let name = stamp.file_name().unwrap_or_default().to_string_lossy();
            if name.starts_with(prefix) {
                fs::remove_file(&stamp).map_err(writing(&stamp))?;
            }
        }
        Ok(())
    }

    /// Removes all units with their files.
    pub(crate) fn clear(&self) -> Result<(), StoreError> {
        for path in self.stamps()? {
            let unit = path.file_stem().unwrap_or_default().to_string_lossy();
            let Some(stamp) = self.stamp(&unit) else {
                continue;
            };
            // The stamp last: a clearing that is cut short is done again.
            let files = stamp.entries.iter().map(|e| self.root.join(e));
            for path in files.chain([path]).filter(|p| p.exists()) {
                remove(&path).map_err(writing(&path))?;
            }
        }
        Ok(())
    }

    /// A working folder for a unit.
    pub(crate) fn draft(&self) -> Result<Draft, StoreError> {
        let folder = tempfile::Builder::new()
            .prefix(PARTIAL)
            .tempdir_in(self.root.join(RECORDS))
            .map_err(|source| StoreError::Unwritable {
                folder: self.root.clone(),
                source,
            })?;
        Ok(Draft {
            folder,
            entries: Vec::new(),
        })
    }

    /// Moves a draft into place and stamps it.
    pub(crate) fn commit(
        &self,
        draft: Draft,
        unit: &str,
        options: &Value,
        extent: Extent,
        facts: Value,
    ) -> Result<Stamp, StoreError> {
        let stamp_path = self.stamp_path(unit);
        if stamp_path.exists() {
            fs::remove_file(&stamp_path).map_err(writing(&stamp_path))?;
        }
        let discarded = draft.folder.path().join(".discarded");
        for (k, entry) in draft.entries.iter().enumerate() {
            let target = self.root.join(entry);
            let write = writing(&target);
            if let Some(parent) = target.parent() {
                fs::create_dir_all(parent).map_err(&write)?;
            }
            if target.is_dir() {
                fs::create_dir_all(&discarded).map_err(&write)?;
                fs::rename(&target, discarded.join(k.to_string())).map_err(&write)?;
            }
            fs::rename(draft.folder.path().join(entry), &target).map_err(write)?;
        }
        let stamp = Stamp {
            unit: unit.to_owned(),
            options: options.clone(),
            version: env!("CARGO_PKG_VERSION").to_owned(),
            program: self.program.clone(),
            extent,
            entries: draft.entries,
            facts,
        };
        self.write_json(&format!("{RECORDS}/{unit}.json"), &stamp)?;
        Ok(stamp)
    }

    /// Writes a file of the output folder in one piece.
    pub(crate) fn write(&self, path: &str, bytes: &[u8]) -> Result<(), StoreError> {
        let target = self.root.join(path);
        let failed = writing(&target);
        let mut file = tempfile::Builder::new()
            .prefix(PARTIAL)
            .tempfile_in(self.root.join(RECORDS))
            .map_err(&failed)?;
        file.write_all(bytes).map_err(&failed)?;
        share(file.path()).map_err(&failed)?;
        file.persist(&target).map_err(|e| failed(e.error))?;
        Ok(())
    }

    /// Writes a JSON file of the output folder in one piece.
    pub(crate) fn write_json(&self, path: &str, value: &impl Serialize) -> Result<(), StoreError> {
        let text = serde_json::to_vec_pretty(value).map_err(std::io::Error::from);
        let mut text = text.map_err(writing(&self.root.join(path)))?;
        text.push(b'\n');
        self.write(path, &text)
    }

    /// Reads a file of the output folder.
    pub(crate) fn read(&self, path: &str) -> Result<Vec<u8>, StoreError> {
        let path = self.root.join(path);
        fs::read(&path).map_err(reading(&path))
    }
}

/// Whether a folder has nothing in it, or only the beginnings of a [`Store`] that was killed at once.
fn is_empty(root: &Path) -> std::io::Result<bool> {
    for entry in fs::read_dir(root)? {
        let entry = entry?;
        let begun = entry.file_name() == RECORDS
            && entry.file_type()?.is_dir()
            && fs::read_dir(entry.path())?.next().is_none();
        if !begun {
            return Ok(false);
        }
    }
    Ok(true)
}

/// Removes a file or a folder.
fn remove(path: &Path) -> std::io::Result<()> {
    if path.is_dir() && !path.is_symlink() {
        fs::remove_dir_all(path)
    } else {
        fs::remove_file(path)
    }
}

/// Temporary files are private to the user; results are readable as other new files are.
#[cfg(unix)]
fn share(path: &Path) -> std::io::Result<()> {
    use std::os::unix::fs::PermissionsExt;
    fs::set_permissions(path, fs::Permissions::from_mode(0o644))
}

#[cfg(not(unix))]
fn share(_path: &Path) -> std::io::Result<()> {
    Ok(())
}

/// 64-bit FNV-1a over the program file: figures made by an earlier build are not taken for current ones.
fn program_fingerprint() -> String {
    let bytes = std::env::current_exe()
        .and_then(fs::read)
        .unwrap_or_default();
    let hash = bytes.iter().fold(0xcbf2_9ce4_8422_2325_u64, |h, &b| {
        (h ^ u64::from(b)).wrapping_mul(0x0000_0100_0000_01b3)
    });
    format!("{hash:016x}")
}

#[cfg(test)]
mod tests {
    use super::*;
    use serde_json::json;

    /// A store in a new folder, which is removed with the first value.
    fn opened() -> (tempfile::TempDir, Store) {
        let folder = tempfile::tempdir().unwrap();
        let store = Store::open(folder.path()).unwrap();
        (folder, store)
    }

    #[test]
    fn a_unit_is_current_until_something_changes() {
        let (folder, store) = opened();
        let options = json!({"size": 3});
        assert!(store.current("one", &options).is_none());
        let mut draft = store.draft().unwrap();
        draft.write("figures/one.svg", b"<svg/>").unwrap();
        let run = draft.folder("runs/one").unwrap();
        fs::write(run.join("a.csv"), "t\n").unwrap();
        store
            .commit(draft, "one", &options, Extent::Complete, json!(7))
            .unwrap();
        assert_eq!(store.current("one", &options).unwrap().facts, json!(7));
        assert_eq!(store.read("runs/one/a.csv").unwrap(), b"t\n");
        assert!(store.current("one", &json!({"size": 4})).is_none());
        fs::remove_file(folder.path().join("figures/one.svg")).unwrap();
        assert!(
            store.current("one", &options).is_none(),
            "a file is missing"
        );
    }

    #[test]
    fn folders_are_replaced_whole_and_drafts_leave_nothing() {
        let (folder, store) = opened();
        for name in ["old", "new"] {
            let mut draft = store.draft().unwrap();
            fs::write(draft.folder("runs/r").unwrap().join(name), "").unwrap();
            store
                .commit(draft, "r", &json!(name), Extent::Partial, Value::Null)
                .unwrap();
        }
        drop(store.draft().unwrap());
        assert!(!folder.path().join("runs/r/old").exists());
        assert!(folder.path().join("runs/r/new").exists());
        assert!(
            store.current("r", &json!("new")).is_none(),
            "partial units are made again"
        );
        assert_eq!(names(folder.path()), [".stamps", "runs"]);
        assert_eq!(names(&folder.path().join(RECORDS)), [MARKER, "r.json"]);
    }

    fn names(folder: &Path) -> Vec<String> {
        let entries = fs::read_dir(folder).unwrap().flatten();
        let names = entries.map(|e| e.file_name().to_string_lossy().into_owned());
        names
            .collect::<std::collections::BTreeSet<_>>()
            .into_iter()
            .collect()
    }

    #[test]
    fn what_a_killed_process_left_is_removed_and_nothing_else() {
        let folder = tempfile::tempdir().unwrap();
        let records = folder.path().join(RECORDS);
        fs::create_dir(&records).unwrap();
        // Killed before the marker was there; then in the middle of two pieces of work.
        let store = Store::open(folder.path()).unwrap();
        std::mem::forget(store.draft().unwrap());
        drop(store);
        fs::write(records.join("partial-file"), "x").unwrap();
        fs::create_dir(folder.path().join(".partial-work")).unwrap();
        fs::write(folder.path().join("notes.txt"), "mine").unwrap();
        assert_eq!(names(&records).len(), 3);
        Store::open(folder.path()).unwrap();
        assert_eq!(names(&records), [MARKER]);
        assert_eq!(
            names(folder.path()),
            [".partial-work", RECORDS, "notes.txt"]
        );
    }

    #[test]
    fn folders_of_others_are_refused_and_left_alone() {
        for theirs in [".partial-work/f", "index.html", ".stamps/f"] {
            let folder = tempfile::tempdir().unwrap();
            let file = folder.path().join(theirs);
            fs::create_dir_all(file.parent().unwrap()).unwrap();
            fs::write(&file, "mine").unwrap();
            let before = names(folder.path());
            assert!(matches!(
                Store::open(folder.path()),
                Err(StoreError::Foreign { .. })
            ));
            assert_eq!(fs::read(&file).unwrap(), b"mine");
            assert_eq!(names(folder.path()), before);
        }
    }

    #[test]
    fn clearing_removes_units_and_nothing_else() {
        let (folder, store) = opened();
        let mut draft = store.draft().unwrap();
        draft.write("figures/one.svg", b"<svg/>").unwrap();
        draft.folder("runs/one").unwrap();
        store
            .commit(draft, "one", &json!(1), Extent::Complete, Value::Null)
            .unwrap();
        fs::write(folder.path().join("runs/notes.txt"), "mine").unwrap();
        store.clear().unwrap();
        assert!(store.stamp("one").is_none());
        assert_eq!(names(&folder.path().join("runs")), ["notes.txt"]);
        assert!(names(&folder.path().join("figures")).is_empty());
    }

    /// What was finished is not made again, unless its options are others.
    #[test]
    fn units_are_kept() {
        let (_folder, store) = opened();
        let unit = |options| Unit {
            name: "one".into(),
            title: "first".into(),
            options: json!(options),
        };
        let make = |options, value: f64| {
            store.keep(&unit(options), |draft| {
                draft.write("tables/one.csv", b"a")?;
                Ok(value)
            })
        };
        assert_eq!(make(1, 0.5).unwrap(), 0.5);
        assert_eq!(make(1, 0.7).unwrap(), 0.5);
        assert_eq!(store.kept::<Vec<f64>>(&unit(1)), None, "another layout");
        assert_eq!(make(2, 0.7).unwrap(), 0.7);
        assert_eq!(store.earlier::<f64>(&unit(1)), None);
        let failed = store.keep(&unit(3), |_| Err::<f64, _>(anyhow::anyhow!("lost")));
        assert_eq!(format!("{:#}", failed.unwrap_err()), "first: lost");
        assert_eq!(store.earlier::<f64>(&unit(2)), Some(0.7));
    }

    #[test]
    fn one_process_at_a_time() {
        let folder = tempfile::tempdir().unwrap();
        let first = Store::open(folder.path()).unwrap();
        assert!(matches!(
            Store::open(folder.path()),
            Err(StoreError::Busy { .. })
        ));
        drop(first);
        assert!(Store::open(folder.path()).is_ok());
    }
}
