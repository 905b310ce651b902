//! Mesh files whose names have the number of their sample.

use super::samples::{self, SampleTimes};
use crate::{MeshFormat, MovingMesh};
use isosheet_files::FileError;
use std::collections::BTreeMap;
use std::fs;
use std::path::{Path, PathBuf};

/// Files by their numbers.
type Numbered = BTreeMap<u64, PathBuf>;

/// Whether a path is a pattern of names.
pub(super) fn is_pattern(path: &Path) -> bool {
    let name = path.file_name().unwrap_or_default();
    name.to_string_lossy().contains('*') && !path.exists()
}

/// The files whose names are a pattern with a number in place of its `*`.
pub(super) fn of_pattern(path: &Path) -> Result<MovingMesh, FileError> {
    let name = path.file_name().unwrap_or_default().to_string_lossy();
    let halves = name.split_once('*').filter(|(_, end)| !end.contains('*'));
    let (begin, end) = halves.ok_or_else(|| {
        let remedy = "write one, such as `walk_*.obj` for walk_0001.obj, walk_0002.obj, ...";
        FileError::content(path, "the pattern has several *", remedy)
    })?;
    let mut files = Numbered::new();
    let all = files_in(path.parent().unwrap_or(Path::new("")))?;
    for file in &all {
        let name = file.file_name().unwrap_or_default().to_string_lossy();
        let digits = name.strip_prefix(begin).and_then(|n| n.strip_suffix(end));
        if let Some(digits) = digits.filter(|digits| is_number(digits)) {
            add(&mut files, digits, file)?;
        }
    }
    match files.is_empty() {
        true => Err(without_samples(path, &all)),
        false => read(path, files),
    }
}

/// The numbered mesh files of a folder, whose names differ in the number alone.
pub(super) fn of_folder(path: &Path) -> Result<MovingMesh, FileError> {
    let mut all: BTreeMap<String, Numbered> = BTreeMap::new();
    let found = files_in(path)?;
    for file in &found {
        let stem = file.file_stem().unwrap_or_default().to_string_lossy();
        let extension = file.extension().unwrap_or_default().to_string_lossy();
        let begin = stem.trim_end_matches(|c: char| c.is_ascii_digit());
        let is_mesh = MeshFormat::of(file).is_some_and(|format| !format.is_drawing());
        let digits = &stem[begin.len()..];
        if is_number(digits) && is_mesh {
            let files = all.entry(format!("{begin}*.{extension}")).or_default();
            add(files, digits, file)?;
        }
    }
    if all.len() > 1 {
        let patterns: Vec<&str> = all.keys().map(String::as_str).collect();
        let problem = format!(
            "the folder has several meshes in motion: {}",
            patterns.join(", ")
        );
        let remedy = "name one of them by its pattern after the folder";
        return Err(FileError::content(path, problem, remedy));
    }
    match all.into_values().next() {
        None => Err(without_samples(path, &found)),
        Some(files) => read(path, files),
    }
}

fn read(path: &Path, files: Numbered) -> Result<MovingMesh, FileError> {
    let (numbers, files): (Vec<u64>, Vec<PathBuf>) = files.into_iter().unzip();
    samples::read(path, SampleTimes::Numbers(numbers), &files)
}

/// What is said where none of the files of a folder is a sample: what their names are.
fn without_samples(path: &Path, found: &[PathBuf]) -> FileError {
    const SHOWN: usize = 5;
    let mut names: Vec<_> = found.iter().filter_map(|file| file.file_name()).collect();
    names.sort();
    let more = names.len().saturating_sub(SHOWN);
    let shown = names.iter().take(SHOWN).map(|name| name.to_string_lossy());
    let shown: Vec<_> = shown.collect();
    let there = match (shown.len(), more) {
        (0, _) => "the folder has no files".to_owned(),
        (_, 0) => format!("the folder has {}", shown.join(", ")),
        _ => format!("the folder has {} and {more} more", shown.join(", ")),
    };
    let problem = match is_pattern(path) {
        true => format!("no file has a name of this pattern with a number for the *: {there}"),
        false => {
            format!("there are no mesh files whose names end with the number of a sample: {there}")
        }
    };
    let remedy = "export one mesh file for each sample, such as walk_0001.obj, walk_0002.obj, ...";
    FileError::content(path, problem, remedy)
}

fn add(files: &mut Numbered, digits: &str, file: &Path) -> Result<(), FileError> {
    let number = digits.parse().map_err(|_| {
        let problem = format!("its number is larger than {}", u64::MAX);
        FileError::content(file, problem, "give it a smaller number, or remove it")
    })?;
    match files.insert(number, file.to_owned()) {
        None => Ok(()),
        Some(other) => {
            let other = other.file_name().unwrap_or_default().to_string_lossy();
            let problem = format!("it has the number {number}, which {other} has too");
            let remedy = "remove or rename one of them";
            Err(FileError::content(file, problem, remedy))
        }
    }
}

fn is_number(text: &str) -> bool {
    !text.is_empty() && text.bytes().all(|b| b.is_ascii_digit())
}

fn files_in(folder: &Path) -> Result<Vec<PathBuf>, FileError> {
    let here = Path::new(".");
    let folder = if folder.as_os_str().is_empty() {
        here
    } else {
        folder
    };
    let unreadable = |e| FileError::unreadable(folder, e);
    let entries = fs::read_dir(folder).map_err(unreadable)?;
    let paths = entries.map(|entry| Ok(entry.map_err(unreadable)?.path()));
    let paths: Vec<PathBuf> = paths.collect::<Result<_, FileError>>()?;
    Ok(paths.into_iter().filter(|path| path.is_file()).collect())
}
