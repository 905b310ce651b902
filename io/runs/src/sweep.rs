//! Sweeps: the runs of a scene with all combinations of some values of some keys.
//!
//! The folder of a sweep has
//!
//! | file | what |
//! |---|---|
//! | `runs.csv` | the runs: number, folder, and the value of every key of the sweep |
//! | `commands.txt` | a line of shell for each run, which simulates the scene with its edits |
//! | `000`, `001`, ... | the folders of the runs |
//! | `000.log`, `001.log`, ... | what the runs said, where `isosheet sweep` ran them |
//!
//! The last key changes fastest. Values that are added to the first key add runs at the end and keep the
//! numbers of all others.

mod engine;
mod error;
mod run;
mod shell;
mod table;
mod variation;

pub use engine::SweepRunner;
pub use error::{RefusedRuns, SweepError};
pub use run::SweepRun;
pub use variation::Variation;

pub(crate) use table::SweepTable;

use super::folder::holds_other_files;
use isosheet_files::{DataError, FileError, input, write_atomically};
use isosheet_scenes::{Edit, Key, SceneFile, SceneFileError};
use shell::shell_word;
use std::io::Write;
use std::path::{Path, PathBuf};

/// A sweep: all combinations of the values of some keys of a scene.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Sweep {
    scene: String,
    folder: String,
    edits: Vec<String>,
    variations: Vec<Variation>,
    count: usize,
}

impl Sweep {
    /// Most runs of a sweep: a hundred times the longest array that Slurm accepts as it is installed (1001),
    /// and a check of all of them takes minutes. A larger number is taken for a mistake.
    pub const MOST_RUNS: usize = run::MOST_RUNS;

    const TABLE: &'static str = "runs.csv";
    const COMMANDS: &'static str = "commands.txt";

    /// The sweep of a scene over `variations`, to be run in `folder`; `edits` of the form `key=value` are
    /// made in every run before. Nothing is read or written yet.
    ///
    /// # Errors
    /// [`SweepError`] without keys, for a key that is given twice or contains another one, for an edit that
    /// every run would overwrite, for more than [`Sweep::MOST_RUNS`] runs, and for paths that a line of text
    /// cannot hold.
    pub fn new(
        scene: &Path,
        folder: &Path,
        edits: Vec<String>,
        variations: Vec<Variation>,
    ) -> Result<Self, SweepError> {
        if variations.is_empty() {
            let remedy = "name one, for example `stop.time=0.5,1,2`";
            let error = DataError::new("a sweep needs a key with values", remedy);
            return Err(SweepError::Keys(error));
        }
        let places: Vec<_> = variations.iter().map(Variation::place).collect();
        for edit in &edits {
            // One that is none is refused where the scene is read.
            let Ok(Edit { key: place, .. }) = edit.parse() else {
                continue;
            };
            if let Some(i) = places.iter().position(|over| place.is_within(over)) {
                let message = format!("the values of `{}` overwrite `{edit}`", variations[i].key());
                let error = DataError::new(message, "take the edit out");
                return Err(SweepError::Keys(error));
            }
        }
        for (j, second) in places.iter().enumerate() {
            let overlaps = |first: &&Key| first.is_within(second) || second.is_within(first);
            if let Some(i) = places[..j].iter().position(overlaps) {
                let [first, second] = [i, j].map(|k| variations[k].key());
                let message = format!("`{first}` and `{second}` change the same part of the scene");
                let error = DataError::new(message, "give one key with all its values");
                return Err(SweepError::Keys(error));
            }
        }
        let counts = variations.iter().map(|v| v.values().len());
        let count = counts.fold(1, usize::saturating_mul);
        if count > Self::MOST_RUNS {
            let message = format!("these are {count} runs, more than {}", Self::MOST_RUNS);
            let error = DataError::new(message, "give fewer values, or make several sweeps");
            return Err(SweepError::Keys(error));
        }
        Ok(Self {
            scene: absolute(scene)?,
            folder: absolute(folder)?,
            edits,
            variations,
            count,
        })
    }

    /// Number of runs, at least one.
    #[expect(clippy::len_without_is_empty, reason = "a sweep has at least one run")]
    pub fn len(&self) -> usize {
        self.count
    }

    /// The run with a number below [`Sweep::len`].
    pub fn run(&self, number: usize) -> SweepRun {
        let (mut rest, mut values) = (number, Vec::with_capacity(self.variations.len()));
        for variation in self.variations.iter().rev() {
            let all = variation.values();
            values.push(all[rest % all.len()].clone());
            rest /= all.len();
        }
        values.reverse();
        let own = self.variations.iter().zip(&values);
        let own = own.map(|(variation, value)| format!("{}={value}", variation.key()));
        SweepRun {
            number,
            folder: format!("{number:03}"),
            edits: self.edits.iter().cloned().chain(own).collect(),
            values,
        }
    }

    /// All runs.
    pub fn runs(&self) -> impl Iterator<Item = SweepRun> + '_ {
        (0..self.count).map(|number| self.run(number))
    }

    /// The folder of the sweep, absolute.
    pub fn folder(&self) -> &Path {
        Path::new(&self.folder)
    }

    pub(crate) fn folder_text(&self) -> &str {
        &self.folder
    }

    pub(crate) fn commands_path(&self) -> String {
        within(&self.folder, Self::COMMANDS)
    }

    /// The arguments with which the command `isosheet` simulates a run.
    pub fn arguments(&self, run: &SweepRun) -> Vec<String> {
        let mut arguments = vec!["simulate".to_owned(), self.scene.clone()];
        for edit in &run.edits {
            arguments.extend(["--set".to_owned(), edit.clone()]);
        }
        let out = within(&self.folder, &run.folder);
        arguments.extend(["--out".to_owned(), out]);
        arguments
    }

    /// Checks that every run can start, as `isosheet check` does it.
    ///
    /// # Errors
    /// [`SweepError::Scene`] if the scene file cannot be read or an edit cannot be made,
    /// [`SweepError::Refused`] with all that is wrong in any run.
    pub fn check(&self) -> Result<(), SweepError> {
        let path = Path::new(&self.scene);
        let text = input::read_text(path)
            .map_err(|e| SceneFileError::from(FileError::unreadable(path, e)))?;
        let mut refused: Vec<RefusedRuns> = Vec::new();
        for run in self.runs() {
            let start = || -> Result<(), SceneFileError> {
                SceneFile::parse(text.clone(), path, &run.edits)?
                    .build()?
                    .start()?;
                Ok(())
            };
            let error = match start() {
                Ok(()) => continue,
                // An edit that no scene can take says what is wrong by itself.
                Err(error @ SceneFileError::Edit(_)) => return Err(error.into()),
                Err(error) => error,
            };
            let problem = RefusedRuns::problem_of(&error);
            match refused.iter_mut().find(|r| r.problem == problem) {
                Some(same) => same.others += 1,
                None => refused.push(RefusedRuns {
                    problem,
                    message: error.to_string(),
                    others: 0,
                    first: run,
                }),
            }
        }
        if refused.is_empty() {
            return Ok(());
        }
        Err(SweepError::Refused(refused))
    }

    /// Writes the table and the lines of shell to the folder of the sweep, which is made where it is missing.
    /// The lines call `program`, a word or path.
    ///
    /// # Errors
    /// [`SweepError::OtherSweep`] if the folder has a table that this one does not begin with,
    /// [`SweepError::Foreign`] if it has other files, [`SweepError`] if it cannot be written.
    pub fn write(&self, program: &str) -> Result<(), SweepError> {
        let table = self.table();
        let path = self.folder().join(Self::TABLE);
        match SweepTable::read(&path) {
            Ok(stored) if table.begins_with(&stored) => {}
            Ok(_) => {
                let folder = self.folder().to_owned();
                return Err(SweepError::OtherSweep { folder });
            }
            Err(error) if error.is_missing() => self.refuse_other_files()?,
            Err(error) => return Err(error.into()),
        }
        table.write(&path)?;
        let commands = self.folder().join(Self::COMMANDS);
        write_atomically(&commands, |w| {
            self.runs().try_for_each(|run| {
                let words = self.arguments(&run);
                let words: Vec<String> = words.iter().map(|word| shell_word(word)).collect();
                writeln!(w, "{} {}", shell_word(program), words.join(" "))
            })
        })?;
        Ok(())
    }

    fn table(&self) -> SweepTable {
        SweepTable {
            keys: self.variations.iter().map(|v| v.key().to_owned()).collect(),
            runs: self.runs().map(|run| (run.folder, run.values)).collect(),
        }
    }

    /// Refuses a folder with other files than the unfinished ones of a sweep that was killed at once.
    fn refuse_other_files(&self) -> Result<(), SweepError> {
        let path = || self.folder().to_owned();
        match holds_other_files(self.folder(), &[]) {
            Ok(false) => Ok(()),
            Ok(true) => Err(SweepError::Foreign { folder: path() }),
            Err(source) => Err(FileError::unreadable(&path(), source).into()),
        }
    }

    /// The table of the sweep in a folder; none if there is no sweep.
    pub(crate) fn table_in(folder: &Path) -> Result<Option<SweepTable>, SweepError> {
        let path = folder.join(Self::TABLE);
        if !path.is_file() {
            return Ok(None);
        }
        Ok(Some(SweepTable::read(&path)?))
    }

    /// The values of the keys of the sweep that a run belongs to; none if it belongs to none that can be
    /// read.
    pub fn values_of(folder: &Path) -> Vec<(String, String)> {
        let of_sweep = || {
            let whole = folder.canonicalize().ok()?;
            let table = Self::table_in(whole.parent()?).ok()??;
            let name = whole.file_name()?.to_str()?;
            let (_, values) = table.runs.into_iter().find(|(folder, _)| folder == name)?;
            Some(table.keys.into_iter().zip(values).collect())
        };
        of_sweep().unwrap_or_default()
    }
}

/// A path that does not depend on the current folder, as text for a line of shell.
fn absolute(path: &Path) -> Result<String, SweepError> {
    let whole = std::path::absolute(path).map_err(|e| FileError::unreadable(path, e))?;
    match whole.to_str() {
        Some(text) if !text.chars().any(char::is_control) => Ok(text.to_owned()),
        _ => Err(SweepError::Path { path: whole }),
    }
}

/// The path of a file in a folder, both of which are text.
fn within(folder: &str, name: &str) -> String {
    let path: PathBuf = [folder, name].iter().collect();
    path.to_string_lossy().into_owned()
}

#[cfg(test)]
mod tests;
