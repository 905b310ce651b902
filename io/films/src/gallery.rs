//! One page of many runs.

mod entry;
mod error;
mod page;

pub use entry::GalleryEntry;
pub use error::GalleryError;

use super::{Film, FilmOptions};
use entry::RUNS;
use isosheet_files::{FileError, read_json, write_atomically, write_json};
use isosheet_page::PageOptions;
use isosheet_pictures::PictureError;
use isosheet_runs::{Recording, RunError, Sweep, holds_other_files, holds_run, remove_unfinished};
use std::collections::HashSet;
use std::fs;
use std::io::Write;
use std::path::{Path, PathBuf};

/// Height of the pictures, pixels.
const PICTURE_HEIGHT: usize = 300;

/// A folder with one page that shows many runs: of each a picture, its name, what its scene says of itself,
/// the key numbers, and a link to the page that plays it.
///
/// | file | what |
/// |---|---|
/// | `index.html` | the gallery |
/// | `runs/NAME.html` | the 3D page of a run |
/// | `runs/NAME.png` | its last frame |
/// | `gallery.json` | the entries as data ([`GalleryEntry`]), written last |
///
/// The folder refers to nothing outside of it and can be moved or sent. Making the gallery again replaces it.
#[derive(Clone, Debug, PartialEq)]
pub struct Gallery {
    /// The runs that are shown, in the order in which they were found.
    pub entries: Vec<GalleryEntry>,
    /// Folders that cannot be shown, with the reason: runs without a frame yet, damaged files, folders that
    /// cannot be read. The page lists them at its end.
    pub left_out: Vec<(PathBuf, String)>,
}

impl Gallery {
    const INDEX: &'static str = "index.html";
    const DATA: &'static str = "gallery.json";

    /// Makes the gallery of all runs in `folders` and beneath them, in the order of `folders` and, beneath
    /// each, of names. Links to other folders are not followed. After a kill the same call makes the gallery
    /// anew and removes what the killed process left unfinished.
    ///
    /// # Errors
    /// [`GalleryError::NoRuns`] if there are none, [`GalleryError::Foreign`] if `out` holds other files,
    /// [`GalleryError`] if a folder cannot be read or written.
    pub fn make(folders: &[PathBuf], out: &Path) -> Result<Self, GalleryError> {
        let (mut found, mut left_out) = (Vec::new(), Vec::new());
        for root in folders {
            for folder in find(root, &mut found)? {
                search(&folder, &mut found, &mut left_out);
            }
        }
        let mut seen = HashSet::new();
        found.retain(|folder: &PathBuf| seen.insert(folder.canonicalize().ok()));
        if found.is_empty() {
            let folders = folders.to_vec();
            return Err(GalleryError::NoRuns { folders });
        }
        let before = Self::before(out)?;
        let runs = out.join(RUNS);
        if fs::symlink_metadata(&runs).is_ok_and(|found| !found.is_dir()) {
            return Err(GalleryError::Linked { path: runs });
        }
        for folder in [out.to_owned(), out.join(RUNS)] {
            // Files that cannot be removed are in nobody's way.
            let _ = remove_unfinished(&folder);
        }
        let made = fs::create_dir_all(&runs);
        made.map_err(|e| FileError::unwritable(&runs, e))?;
        let mut gallery = Self {
            entries: Vec::new(),
            left_out,
        };
        let mut names = HashSet::new();
        for folder in found {
            match Shown::read(&folder, &runs) {
                Ok(shown) => {
                    let name = unused(&file_name(&folder), &mut names);
                    let [page, picture] = files(&name).map(|file| out.join(file));
                    write_atomically(&page, |w| w.write_all(shown.page.as_bytes()))?;
                    write_atomically(&picture, |w| w.write_all(&shown.picture))?;
                    gallery.entries.push(entry(name, folder, &shown.recording));
                }
                Err(reason) => gallery.left_out.push((folder, reason)),
            }
        }
        let page = page::page(&gallery.entries, &gallery.left_out);
        write_atomically(&out.join(Self::INDEX), |w| w.write_all(page.as_bytes()))?;
        write_json(&out.join(Self::DATA), &gallery.entries)?;
        for old in before
            .iter()
            .filter(|old| !names.contains(&old.name.to_lowercase()))
        {
            for file in files(&old.name) {
                // What is left of an earlier gallery is in nobody's way.
                let _ = fs::remove_file(out.join(file));
            }
        }
        Ok(gallery)
    }

    /// The entries of the gallery that is in a folder already.
    fn before(out: &Path) -> Result<Vec<GalleryEntry>, GalleryError> {
        let data = out.join(Self::DATA);
        if data.is_file() {
            let entries: Vec<GalleryEntry> = read_json(&data)?;
            return match entries.iter().find(|entry| !is_plain(&entry.name)) {
                None => Ok(entries),
                Some(GalleryEntry { name, .. }) => {
                    let problem = format!(
                        "it names the run {name:?}, which is no name of a file of a gallery"
                    );
                    let remedy = "choose an empty or a new folder with --out";
                    Err(FileError::content(&data, problem, remedy).into())
                }
            };
        }
        let path = || out.to_owned();
        match holds_other_files(out, &[RUNS, Self::INDEX]) {
            Ok(false) => Ok(Vec::new()),
            Ok(true) => Err(GalleryError::Foreign { folder: path() }),
            Err(source) => Err(FileError::unreadable(&path(), source).into()),
        }
    }
}

/// Page and picture of a run, relative to the gallery.
fn files(name: &str) -> [PathBuf; 2] {
    ["html", "png"].map(|extension| Path::new(RUNS).join(format!("{name}.{extension}")))
}

/// Adds a folder if it is that of a run, and returns the folders beneath it otherwise.
fn find(folder: &Path, found: &mut Vec<PathBuf>) -> Result<Vec<PathBuf>, GalleryError> {
    if holds_run(folder) {
        found.push(folder.to_owned());
        return Ok(Vec::new());
    }
    let unreadable = |source| FileError::unreadable(folder, source);
    let mut folders = Vec::new();
    for entry in fs::read_dir(folder).map_err(unreadable)? {
        let entry = entry.map_err(unreadable)?;
        if entry.file_type().map_err(unreadable)?.is_dir() {
            folders.push(entry.path());
        }
    }
    folders.sort();
    Ok(folders)
}

/// Adds the folders of runs at and beneath a folder, and the folders that cannot be read.
fn search(folder: &Path, found: &mut Vec<PathBuf>, left_out: &mut Vec<(PathBuf, String)>) {
    match find(folder, found) {
        Ok(folders) => folders
            .iter()
            .for_each(|folder| search(folder, found, left_out)),
        Err(error) => left_out.push((folder.to_owned(), error.to_string())),
    }
}

fn entry(name: String, folder: PathBuf, recording: &Recording) -> GalleryEntry {
    let trajectory = &recording.trajectory;
    GalleryEntry {
        name,
        title: recording.name.clone(),
        caption: caption(&recording.scene.text().text),
        values: Sweep::values_of(&folder),
        t: trajectory.times().last().copied().unwrap_or_default(),
        vertices: trajectory.vertex_count(),
        summary: recording.summary.clone(),
        folder,
    }
}

/// A run with its page and its picture.
struct Shown {
    recording: Recording,
    page: String,
    picture: Vec<u8>,
}

impl Shown {
    /// Reads a run and makes both in a folder that is there, or says why that cannot be done.
    fn read(folder: &Path, out: &Path) -> Result<Self, String> {
        let words = |error: RunError| error.to_string();
        let (recording, page) =
            Recording::read_with_page(folder, out, &PageOptions::default()).map_err(words)?;
        let Some(last) = recording.trajectory.len().checked_sub(1) else {
            return Err("it has no frame yet".into());
        };
        let page = page.map_err(words)?;
        let picture = picture(&recording, last).map_err(|e| e.to_string())?;
        Ok(Self {
            recording,
            page,
            picture,
        })
    }
}

/// A frame as a PNG file.
fn picture(recording: &Recording, frame: usize) -> Result<Vec<u8>, PictureError> {
    let options = FilmOptions {
        height: PICTURE_HEIGHT,
        ..FilmOptions::default()
    };
    let film = Film::new(recording, vec![frame], &options)?;
    film.picture(0)?.to_png()
}

/// The name of the folder of a run, without `-run`, as the name of a file.
fn file_name(folder: &Path) -> String {
    let whole = folder.canonicalize().unwrap_or_else(|_| folder.to_owned());
    let name = whole.file_name().unwrap_or_default().to_string_lossy();
    let plain = |c: char| if is_plain_character(c) { c } else { '-' };
    name.strip_suffix("-run")
        .unwrap_or(&name)
        .chars()
        .map(plain)
        .collect()
}

/// What names of files in a gallery are made of.
fn is_plain_character(c: char) -> bool {
    c.is_ascii_alphanumeric() || ['-', '_', '.'].contains(&c)
}

/// Whether a gallery may have given a name to a run.
fn is_plain(name: &str) -> bool {
    !name.is_empty() && name.chars().all(is_plain_character)
}

/// A name that no other run of the gallery has.
fn unused(name: &str, names: &mut HashSet<String>) -> String {
    let name = match name.trim_matches('.') {
        "" => "run",
        name => name,
    };
    let numbered = (2..).map(|k| format!("{name}-{k}"));
    let mut candidates = std::iter::once(name.to_owned()).chain(numbered);
    let free = candidates.find(|candidate| !names.contains(&candidate.to_lowercase()));
    let free = free.expect("there are more numbers than runs");
    names.insert(free.to_lowercase());
    free
}

/// What a scene says of itself: its first comment, up to the first line that ends with a full stop.
fn caption(scene: &str) -> String {
    let comment = scene.lines().map_while(|line| line.strip_prefix('#'));
    let mut lines = Vec::new();
    for line in comment.map(str::trim) {
        lines.push(line);
        if line.ends_with('.') {
            break;
        }
    }
    lines.join(" ")
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn captions_are_first_sentences() {
        let scene = "# A cloth on\n# a table. It is round.\n# Lengths in metres.\nversion = 1\n";
        assert_eq!(caption(scene), "A cloth on a table. It is round.");
        assert_eq!(caption("version = 1\n# no caption.\n"), "");
        assert_eq!(caption("# without a stop\n\n# further"), "without a stop");
    }

    #[test]
    fn names_are_plain_and_differ() {
        let mut names = HashSet::new();
        let mut name = |folder: &str| unused(&file_name(Path::new(folder)), &mut names);
        assert_eq!(name("/none/a b\u{e4}<-run"), "a-b--");
        assert_eq!(name("/none/x/a b\u{e4}<"), "a-b---2");
        assert_eq!(name("/none/Cloth-run"), "Cloth");
        assert_eq!(name("/none/y/cloth"), "cloth-2");
        assert_eq!(name("/none/..."), "run");
    }
}
