//! The output folder of a report, and which of its pieces of work are up to date.
//!
//! Each piece of work (a *unit*: a figure, a run, a case) writes its files, each of which appears when it is
//! complete, and after them its stamp in `.stamps`. A stamp counts only while its options, the program and
//! the files it lists are the same, so a rerun makes again whatever changed or was cut short.
//!
//! The lock file in `.stamps` also marks a folder as the program's own: a folder that has other files and not
//! this one is refused. Quick results are not mixed with others: they have the same names.

use crate::interrupt;
use crate::progress;
use crate::report::Effort;
use crate::sources::commit;
use anyhow::{Context, Result, bail};
use isosheet_files::{FileError, read_json, write_atomically, write_json};
use isosheet_runs::{RunError, holds_other_files, remove_unfinished};
use serde::de::DeserializeOwned;
use serde::{Deserialize, Serialize};
use serde_json::{Value, json};
use std::collections::HashSet;
use std::fs::{self, File};
use std::hash::{DefaultHasher, Hash, Hasher};
use std::io::{self, Write};
use std::path::{Path, PathBuf};
use std::sync::{Mutex, PoisonError};

/// Folder of the program's own records.
const RECORDS: &str = ".stamps";

/// The file in [`RECORDS`] that marks a folder as the program's own, locked while a process works there.
const MARKER: &str = "isosheet-xtask.lock";

/// The file in [`RECORDS`] that says whose results the folder has.
const CLAIM: &str = "report.json";

/// The report that a folder belongs to, and the effort of all its results.
#[derive(Debug, PartialEq, Serialize, Deserialize)]
struct Claim {
    report: String,
    effort: Effort,
}

/// What is known about a unit that has been made.
#[derive(Debug, Serialize, Deserialize)]
struct Stamp {
    /// Options it was made with.
    options: Value,
    /// Fingerprint of the program file.
    program: u64,
    /// Its files and folders, relative to the output folder.
    entries: Vec<String>,
    /// What it found.
    facts: Value,
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

/// What is up to date of a report: only results of this build, so that all of a page were made alike.
#[derive(Debug)]
pub(crate) struct Kept<T> {
    pub(crate) records: Vec<T>,
    /// Titles of the units that another build made, or whose files are gone.
    pub(crate) left_out: Vec<String>,
}

/// What is said of units that are left out.
const OUTDATED: &str = "left out: another build of the program made it, or its files are gone";

/// Whether units that are up to date are made again.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Remake {
    Never,
    /// Once in this process.
    Once,
}

/// The output folder, locked against other processes.
#[derive(Debug)]
pub(crate) struct Store {
    root: PathBuf,
    pub(crate) effort: Effort,
    program: u64,
    /// The commit when the folder was opened, of results that the book shows.
    commit: Option<String>,
    remake: Remake,
    /// Units that this process has made.
    made: Mutex<HashSet<String>>,
    /// Held until the end: the lock goes with the file.
    _lock: File,
}

/// The files of a unit.
#[derive(Debug)]
pub(crate) struct Files<'a> {
    store: &'a Store,
    entries: Vec<String>,
}

impl Files<'_> {
    /// Writes a file, given relative to the output folder.
    pub(crate) fn write(&mut self, path: &str, bytes: &[u8]) -> Result<(), FileError> {
        self.entries.push(path.to_owned());
        self.store.write(path, bytes)
    }

    /// Makes an empty folder, given relative to the output folder, and returns its path.
    pub(crate) fn folder(&mut self, path: &str) -> io::Result<PathBuf> {
        self.entries.push(path.to_owned());
        let folder = self.store.root.join(path);
        remove(&folder)?;
        fs::create_dir_all(&folder)?;
        Ok(folder)
    }
}

impl Store {
    /// As [`Store::open`], for results that the book shows unless they are quick: it knows the commit.
    pub(crate) fn of_report(
        root: &Path,
        report: &str,
        effort: Effort,
        remake: Remake,
    ) -> Result<Self> {
        let mut store = Self::open(root, report, effort, remake)?;
        if effort != Effort::Quick {
            store.commit = Some(commit());
        }
        Ok(store)
    }

    /// Creates the folder when missing, checks that it is empty or that of the same report, has no results of
    /// another kind and can be written to, and locks it. Full results take the place of quick ones.
    pub(crate) fn open(root: &Path, report: &str, effort: Effort, remake: Remake) -> Result<Self> {
        let lock = lock(root)?;
        remove_unfinished(root)?;
        let store = Self {
            root: root.to_owned(),
            effort,
            program: fingerprint()?,
            commit: None,
            remake,
            made: Mutex::default(),
            _lock: lock,
        };
        let path = store.record(CLAIM);
        let folder = root.display();
        if let Ok(Claim {
            report: of,
            effort: before,
        }) = read_json(&path)
        {
            let is_quick = [before, effort].map(|effort| effort == Effort::Quick);
            if of != report {
                bail!("{folder} has results of {of}: choose another folder with --out");
            } else if is_quick == [false, true] {
                bail!(
                    "{folder} has results that are not quick, which quick ones would replace: choose another"
                );
            } else if is_quick == [true, false] {
                progress::note("quick results", "removed");
                store.clear()?;
            }
        }
        // This also tells whether the folder can be written to, before any work.
        let report = report.to_owned();
        write_json(&path, &Claim { report, effort })?;
        Ok(store)
    }

    /// The commit that results are of, if the book shows them.
    pub(crate) fn commit(&self) -> Option<&str> {
        self.commit.as_deref()
    }

    /// A file of [`RECORDS`].
    fn record(&self, name: &str) -> PathBuf {
        self.root.join(RECORDS).join(name)
    }

    /// Files that a report makes of several units, and that no stamp lists.
    pub(crate) fn files(&self) -> Files<'_> {
        let entries = Vec::new();
        Files {
            store: self,
            entries,
        }
    }

    /// The path of a file.
    pub(crate) fn path(&self, file: &str) -> PathBuf {
        self.root.join(file)
    }

    /// A unit that depends on the effort alone.
    pub(crate) fn unit(&self, name: impl Into<String>, title: impl Into<String>) -> Unit {
        let (name, title) = (name.into(), title.into());
        let options = json!({ "effort": self.effort });
        Unit {
            name,
            title,
            options,
        }
    }

    fn stamp(&self, unit: &Unit) -> Option<Stamp> {
        let stamp = read_json(&self.record(&format!("{}.json", unit.name)));
        stamp.ok().filter(|s: &Stamp| s.options == unit.options)
    }

    /// What a unit found: as it was kept if it is up to date, or made now by `work` and kept.
    ///
    /// # Errors
    /// Errors of `work`, with the title; [`Interrupted`](interrupt::Interrupted) before it begins; errors of
    /// the folder.
    pub(crate) fn keep<T: Serialize + DeserializeOwned>(
        &self,
        unit: &Unit,
        work: impl FnOnce(&mut Files<'_>) -> Result<T>,
    ) -> Result<T> {
        let made = || self.made.lock().unwrap_or_else(PoisonError::into_inner);
        let is_kept = self.remake == Remake::Never || made().contains(&unit.name);
        if let Some(found) = self.kept(unit).filter(|_| is_kept) {
            progress::note(&unit.title, "up to date");
            return Ok(found);
        }
        interrupt::check()?;
        let path = self.record(&format!("{}.json", unit.name));
        remove(&path)?;
        let mut files = self.files();
        let found = work(&mut files).with_context(|| unit.title.clone())?;
        let stamp = Stamp {
            options: unit.options.clone(),
            program: self.program,
            entries: files.entries,
            facts: serde_json::to_value(&found)?,
        };
        write_json(&path, &stamp)?;
        made().insert(unit.name.clone());
        Ok(found)
    }

    /// What an up-to-date unit found; `None` where there is none, or none in the present layout.
    pub(crate) fn kept<T: DeserializeOwned>(&self, unit: &Unit) -> Option<T> {
        let is_there = |entry: &String| self.root.join(entry).exists();
        let stamp = self.stamp(unit).filter(|s| s.program == self.program)?;
        let stamp = Some(stamp).filter(|s| s.entries.iter().all(is_there))?;
        serde_json::from_value(stamp.facts).ok()
    }

    /// What is up to date of some units, and which of them have results that are not.
    pub(crate) fn all_kept<T: DeserializeOwned>(&self, units: Vec<Unit>) -> Kept<T> {
        let (mut records, mut left_out) = (Vec::new(), Vec::new());
        for unit in units {
            if let Some(found) = self.kept(&unit) {
                records.push(found);
            } else if self.stamp(&unit).is_some() {
                progress::note(&unit.title, OUTDATED);
                left_out.push(unit.title);
            }
        }
        Kept { records, left_out }
    }

    /// Removes all units with their files.
    fn clear(&self) -> io::Result<()> {
        for entry in fs::read_dir(self.root.join(RECORDS))? {
            let path = entry?.path();
            if let Ok(stamp) = read_json::<Stamp>(&path) {
                // The stamp last: a clearing that is cut short is done again.
                let files = stamp.entries.iter().map(|e| self.root.join(e));
                files.chain([path]).try_for_each(|path| remove(&path))?;
            }
        }
        Ok(())
    }

    /// Writes a file of the output folder in one piece.
    pub(crate) fn write(&self, path: &str, bytes: &[u8]) -> Result<(), FileError> {
        write_atomically(&self.path(path), |w| w.write_all(bytes))
    }
}

/// Creates a folder when missing and locks it.
fn lock(root: &Path) -> Result<File, RunError> {
    let folder = || root.to_owned();
    let unwritable = |source| RunError::Unwritable {
        folder: folder(),
        source,
    };
    let records = root.join(RECORDS);
    fs::create_dir_all(root).map_err(unwritable)?;
    let has_others =
        || Ok(holds_other_files(root, &[RECORDS])? || holds_other_files(&records, &[])?);
    if !records.join(MARKER).is_file() && has_others().map_err(unwritable)? {
        return Err(RunError::Foreign { folder: folder() });
    }
    fs::create_dir_all(&records).map_err(unwritable)?;
    let lock = File::create(records.join(MARKER)).map_err(unwritable)?;
    match lock.try_lock() {
        Ok(()) => Ok(lock),
        Err(fs::TryLockError::WouldBlock) => Err(RunError::Busy { folder: folder() }),
        Err(fs::TryLockError::Error(source)) => Err(unwritable(source)),
    }
}

/// Removes a file or a folder, if it exists.
fn remove(path: &Path) -> io::Result<()> {
    if path.is_dir() && !path.is_symlink() {
        fs::remove_dir_all(path)
    } else if path.exists() {
        fs::remove_file(path)
    } else {
        Ok(())
    }
}

/// A hash of the program file: figures made by another build are not taken for current ones.
fn fingerprint() -> io::Result<u64> {
    let mut hasher = DefaultHasher::new();
    fs::read(std::env::current_exe()?)?.hash(&mut hasher);
    Ok(hasher.finish())
}

#[cfg(test)]
mod tests {
    use super::*;

    fn open(folder: &Path) -> Result<Store> {
        Store::open(folder, "a", Effort::Standard, Remake::Never)
    }

    fn unit(options: i32) -> Unit {
        Unit {
            name: "one".into(),
            title: "first".into(),
            options: json!(options),
        }
    }

    fn names(folder: &Path) -> Vec<String> {
        let entries = fs::read_dir(folder).unwrap().flatten();
        let names = entries.map(|e| e.file_name().to_string_lossy().into_owned());
        let sorted: std::collections::BTreeSet<_> = names.collect();
        sorted.into_iter().collect()
    }

    /// What was finished is not made again, unless its options are others or a file is missing.
    #[test]
    fn units_are_kept_until_something_changes() {
        let folder = tempfile::tempdir().unwrap();
        let store = open(folder.path()).unwrap();
        let make = |options, value: f64| {
            store.keep(&unit(options), |files| {
                files.write("tables/one.csv", b"a")?;
                fs::write(files.folder("runs/one")?.join(value.to_string()), "")?;
                Ok(value)
            })
        };
        assert_eq!(make(1, 0.5).unwrap(), 0.5);
        assert_eq!(make(1, 0.7).unwrap(), 0.5);
        assert_eq!(store.kept::<Vec<f64>>(&unit(1)), None, "another layout");
        assert_eq!(make(2, 0.7).unwrap(), 0.7);
        assert_eq!(names(&folder.path().join("runs/one")), ["0.7"]);
        fs::remove_file(folder.path().join("tables/one.csv")).unwrap();
        assert_eq!(store.kept::<f64>(&unit(2)), None, "a file is missing");
        let failed = store.keep(&unit(2), |_| Err::<f64, _>(anyhow::anyhow!("lost")));
        assert_eq!(format!("{:#}", failed.unwrap_err()), "first: lost");
        assert!(store.stamp(&unit(2)).is_none(), "made again next time");
    }

    /// Results of another build are not shown beside the results of this one.
    #[test]
    fn results_of_another_build_are_left_out_by_name() {
        let folder = tempfile::tempdir().unwrap();
        let mut store = open(folder.path()).unwrap();
        let named = |name: &str| Unit {
            name: name.into(),
            title: format!("the {name}"),
            ..unit(1)
        };
        store.keep(&named("old"), |_| Ok(1.0)).unwrap();
        store.program += 1;
        store.keep(&named("new"), |_| Ok(2.0)).unwrap();
        let units = || ["old", "new", "missing"].map(named).to_vec();
        let kept: Kept<f64> = store.all_kept(units());
        assert_eq!(
            (kept.records, kept.left_out),
            (vec![2.0], vec!["the old".to_owned()])
        );
        store.keep(&named("old"), |_| Ok(3.0)).unwrap();
        let kept: Kept<f64> = store.all_kept(units());
        assert_eq!((kept.records, kept.left_out), (vec![3.0, 2.0], Vec::new()));
    }

    #[test]
    fn units_are_made_again_once_when_asked() {
        let folder = tempfile::tempdir().unwrap();
        for value in [1.0, 2.0] {
            let store = Store::open(folder.path(), "a", Effort::Standard, Remake::Once).unwrap();
            assert_eq!(store.keep(&unit(1), |_| Ok(value)).unwrap(), value);
            assert_eq!(store.keep(&unit(1), |_| Ok(9.0)).unwrap(), value);
        }
    }

    #[test]
    fn folders_of_others_are_refused_and_left_alone() {
        for theirs in [".partial-work/f", "index.html", ".stamps/f"] {
            let folder = tempfile::tempdir().unwrap();
            let file = folder.path().join(theirs);
            fs::create_dir_all(file.parent().unwrap()).unwrap();
            fs::write(&file, "mine").unwrap();
            let before = names(folder.path());
            let error = open(folder.path()).unwrap_err();
            assert!(matches!(
                error.downcast_ref(),
                Some(RunError::Foreign { .. })
            ));
            assert_eq!(fs::read(&file).unwrap(), b"mine");
            assert_eq!(names(folder.path()), before);
        }
        // Killed before the marker was there.
        let folder = tempfile::tempdir().unwrap();
        fs::create_dir(folder.path().join(RECORDS)).unwrap();
        assert!(open(folder.path()).is_ok());
    }

    #[test]
    fn quick_results_are_replaced_and_others_are_not() {
        let folder = tempfile::tempdir().unwrap();
        let of = |report| Store::open(folder.path(), report, Effort::Quick, Remake::Never);
        let store = of("a").unwrap();
        let write = |files: &mut Files<'_>| Ok(files.write("figures/one.svg", b"<svg/>")?);
        store.keep(&unit(1), write).unwrap();
        fs::write(folder.path().join("figures/notes.txt"), "mine").unwrap();
        drop(store);
        assert!(open(folder.path()).unwrap().stamp(&unit(1)).is_none());
        assert_eq!(names(&folder.path().join("figures")), ["notes.txt"]);
        let error = of("b").unwrap_err();
        assert_eq!(error.to_string().matches("results of a").count(), 1);
        let error = of("a").unwrap_err();
        assert!(error.to_string().contains("not quick"), "{error}");
    }

    #[test]
    fn one_process_at_a_time() {
        let folder = tempfile::tempdir().unwrap();
        let first = open(folder.path()).unwrap();
        let error = open(folder.path()).unwrap_err();
        assert!(matches!(error.downcast_ref(), Some(RunError::Busy { .. })));
        drop(first);
        assert!(open(folder.path()).is_ok());
    }
}
