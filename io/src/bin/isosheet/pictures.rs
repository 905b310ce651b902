//! Frames of a run as pictures, for `isosheet convert`.

use crate::Done;
use crate::exit::{Code, Failure};
use crate::message::{counted, print_message};
use crate::write::to_stdout;
use isosheet_io::Advice;
use isosheet_io::run::{Film, FilmOptions, Recording};
use isosheet_io::write_atomically;
use std::io::Write;
use std::path::Path;

/// Files of pictures.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum PictureFormat {
    /// One frame.
    Png,
    /// One frame as a vector drawing.
    Svg,
    /// All frames, animated.
    AnimatedPng,
}

impl PictureFormat {
    /// The format that the extension of a file says, if it is one of pictures.
    pub(crate) fn of(path: &Path) -> Option<Self> {
        let extension = path.extension()?.to_str()?.to_ascii_lowercase();
        match extension.as_str() {
            "png" => Some(Self::Png),
            "svg" => Some(Self::Svg),
            "apng" => Some(Self::AnimatedPng),
            _ => None,
        }
    }
}

/// Which frames are drawn.
#[derive(Clone, Copy, Debug)]
pub(crate) struct FrameChoice {
    /// One frame; the last one if there is no choice.
    pub(crate) frame: Option<usize>,
    /// Every so many frames one.
    pub(crate) every: Option<usize>,
}

/// Draws frames of a run.
pub(crate) fn write(
    recording: &Recording,
    choice: FrameChoice,
    format: PictureFormat,
    path: &Path,
) -> Done {
    let count = recording.trajectory.len();
    let frames: Vec<usize> = match (format, choice) {
        (PictureFormat::Png | PictureFormat::Svg, FrameChoice { every: Some(_), .. }) => {
            let message = "--every is for .apng: a .png or .svg file has one frame";
            return Err(wrong(message, "choose the frame with --frame K"));
        }
        (PictureFormat::AnimatedPng, FrameChoice { frame: Some(_), .. }) => {
            let message = "--frame is for .png and .svg: an .apng file has many frames";
            return Err(wrong(message, "choose frames with --every N"));
        }
        (PictureFormat::Png | PictureFormat::Svg, FrameChoice { frame, .. }) => {
            vec![frame.unwrap_or(count.saturating_sub(1))]
        }
        (PictureFormat::AnimatedPng, FrameChoice { every, .. }) => {
            (0..count).step_by(every.unwrap_or(1).max(1)).collect()
        }
    };
    if let Some(frame) = frames.iter().find(|frame| **frame >= count) {
        let count = counted(count, "frame", "frames");
        let message = format!("the run has {count}, counted from 0, and no frame {frame}");
        return Err(wrong(&message, "choose one of them"));
    }
    let film =
        Film::new(recording, frames.clone(), &FilmOptions::default()).map_err(|e| input(&e))?;
    for body in film.undrawn() {
        print_message(format_args!(
            "not drawn: obstacle[{body}], since pictures have no half-spaces, balls and capsules"
        ));
    }
    let bytes = match format {
        PictureFormat::Png => film.picture(0).and_then(|image| image.to_png()),
        PictureFormat::Svg => film.svg(0).map(String::into_bytes),
        PictureFormat::AnimatedPng => film.animation(),
    };
    let bytes = bytes.map_err(|e| input(&e))?;
    let written = write_atomically(path, |w| w.write_all(&bytes));
    written.map_err(|e| Failure::of(Code::Output, &e))?;
    let count = counted(frames.len(), "frame", "frames");
    to_stdout(&format!("{}: {count}\n", path.display()))
}

fn wrong(message: &str, remedy: &str) -> Failure {
    Failure::new(Code::Input, message).remedy(remedy)
}

fn input(error: &impl Advice) -> Failure {
    Failure::of(Code::Input, error)
}
