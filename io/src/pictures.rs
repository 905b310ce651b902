//! Frames of a run as pictures, for `isosheet convert`.

use super::failure::{Code, Done, Failure};
use super::message::counted;
use super::progress::DrawingProgress;
use super::write::to_stdout;
use isosheet_files::{NumberedFiles, write_atomically};
use isosheet_films::{Film, FilmOptions};
use isosheet_mesh::Advice;
use isosheet_pictures::PictureError;
use isosheet_runs::Recording;
use rayon::prelude::*;
use std::io::Write;
use std::path::Path;
use std::sync::atomic::{AtomicUsize, Ordering};

/// Files of pictures.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum PictureFormat {
    /// One frame.
    Png,
    /// All frames, animated.
    AnimatedPng,
    /// All frames, as another program encodes them.
    Film,
}

impl PictureFormat {
    /// The format that the extension of a file says, if it is one of pictures.
    pub(crate) fn of(path: &Path) -> Option<Self> {
        let extension = path.extension()?.to_str()?.to_ascii_lowercase();
        match extension.as_str() {
            "png" => Some(Self::Png),
            "apng" => Some(Self::AnimatedPng),
            _ => Film::is_encoded(path).then_some(Self::Film),
        }
    }
}

/// Which frames are drawn.
#[derive(Clone, Copy, Debug)]
pub(crate) enum FrameChoice {
    /// One.
    One(usize),
    /// Every so many frames one, from the first to the last.
    Many {
        first: usize,
        last: usize,
        every: usize,
    },
}

/// Every how many frames, whose times are these (seconds), browsers show one in real time: fifty a second at
/// most.
pub(super) fn shown_by_browsers(times: &[f64]) -> usize {
    const MOST: f64 = 50.0;
    let rate = match times {
        [first, .., last] => (times.len() - 1) as f64 / (last - first),
        _ => MOST,
    };
    // Conversion from floats saturates.
    (rate / MOST - 1e-6).ceil().max(1.0) as usize
}

/// Draws frames of a run.
pub(crate) fn write(
    recording: &Recording,
    choice: FrameChoice,
    format: PictureFormat,
    options: &FilmOptions,
    path: &Path,
) -> Done {
    let count = recording.trajectory.len();
    let frames: Vec<usize> = match (format, choice) {
        (PictureFormat::AnimatedPng | PictureFormat::Film, FrameChoice::One(_)) => {
            let message = "--frame is for .png: a film has many frames";
            return Err(wrong(
                message,
                "choose frames with --frames A..B or --every N",
            ));
        }
        (_, FrameChoice::One(frame)) => vec![frame],
        // (A range far beyond the end is not written down frame by frame.)
        (_, FrameChoice::Many { first, last, every }) => {
            match [first, last].into_iter().find(|frame| *frame >= count) {
                Some(beyond) => vec![beyond],
                None => (first..=last).step_by(every).collect(),
            }
        }
    };
    if let Some(frame) = frames.iter().find(|frame| **frame >= count) {
        let count = counted(count, "frame", "frames");
        let message = format!("the run has {count}, counted from 0, and no frame {frame}");
        return Err(wrong(&message, "choose one of them"));
    }
    let failed = |e: PictureError| match e {
        PictureError::Options(_) => Failure::of(Code::CommandLine, &e),
        _ => input(&e),
    };
    let film = Film::new(recording, frames, options).map_err(failed)?;
    let progress = DrawingProgress::new(film.len());
    let picture = |place: usize| film.picture(place).and_then(|image| image.to_png());
    let save = |path: &Path, bytes: Result<Vec<u8>, PictureError>| {
        let bytes = bytes.map_err(failed)?;
        let written = write_atomically(path, |w| w.write_all(&bytes));
        written.map_err(|e| Failure::of(Code::Output, &e))
    };
    let numbered = numbered(path);
    let saved = match (format, choice) {
        (PictureFormat::Film, _) => {
            let encoded = film.encode(path, |k| progress.drawn(k));
            encoded.map_err(|e| Failure::of(Code::Output, &e))
        }
        (PictureFormat::AnimatedPng, _) => save(path, film.animation(|k| progress.drawn(k))),
        (_, FrameChoice::One(_)) => save(path, picture(0)),
        (_, FrameChoice::Many { .. }) => {
            let drawn = AtomicUsize::new(0);
            let one = |place: usize| {
                let saved = save(&numbered.path(place), picture(place));
                progress.drawn(drawn.fetch_add(1, Ordering::Relaxed) + 1);
                saved
            };
            // Each thread draws one picture, unless memory holds fewer.
            let threads = rayon::current_num_threads();
            film.at_once(threads).map_err(failed).and_then(|batch| {
                let batch = if batch < threads { batch } else { film.len() };
                (0..film.len()).step_by(batch).try_for_each(|first| {
                    let end = film.len().min(first + batch);
                    (first..end).into_par_iter().try_for_each(one)
                })
            })
        }
    };
    progress.end();
    saved?;
    let mut removed = 0;
    let name = match (format, choice) {
        (PictureFormat::Png, FrameChoice::Many { .. }) => {
            let places: Vec<usize> = (0..film.len()).collect();
            let kept = numbered.keep_only(&places);
            removed = kept.map_err(|e| Failure::of(Code::Output, &e))?;
            let [first, last] = [0, film.len() - 1].map(|place| numbered.path(place));
            format!("{} to {}", first.display(), last.display())
        }
        _ => path.display().to_string(),
    };
    to_stdout(&format!(
        "{name}: {}{}\n",
        counted(film.len(), "frame", "frames"),
        removed_in_words(removed)
    ))
}

/// What an export removed of an earlier one, in words; nothing if it removed nothing.
pub(crate) fn removed_in_words(files: usize) -> String {
    match files {
        0 => String::new(),
        n => format!(
            " ({} of an earlier export removed)",
            counted(n, "file", "files")
        ),
    }
}

/// The files of many pictures, counted from 0 without gaps, as programs for films expect.
fn numbered(path: &Path) -> NumberedFiles {
    let extension = path.extension().unwrap_or_default().to_string_lossy();
    NumberedFiles::new(&path.with_extension(""), "frame", &extension)
}

pub(super) fn wrong(message: &str, remedy: &str) -> Failure {
    Failure::misuse(message).remedy(remedy)
}

pub(super) fn input(error: &impl Advice) -> Failure {
    Failure::of(Code::Input, error)
}
