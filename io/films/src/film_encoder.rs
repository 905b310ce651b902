//! Films that ffmpeg encodes, a program that is called where it is installed.

use super::Film;
use isosheet_files::{FileError, prepare_folder};
use isosheet_mesh::Advice;
use isosheet_pictures::PictureError;
use rayon::prelude::*;
use std::fs;
use std::io::{self, Read, Write};
use std::path::Path;
use std::process::{Child, Command, Stdio};
use std::sync::atomic::{AtomicUsize, Ordering};

/// The program.
const PROGRAM: &str = "ffmpeg";

/// The extensions of films that it is asked for.
const FORMATS: [&str; 7] = ["mp4", "m4v", "mov", "webm", "mkv", "avi", "gif"];

/// Pictures that are drawn before they are passed on, if memory holds so many.
const AT_ONCE: usize = 16;

/// Why a film is not encoded.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum FilmError {
    /// A frame cannot be drawn.
    #[error(transparent)]
    Picture(#[from] PictureError),
    /// The file cannot be written.
    #[error(transparent)]
    File(#[from] FileError),
    /// The program cannot be called.
    #[error("films of this format are encoded by {PROGRAM}, which cannot be called: {0}")]
    NoEncoder(io::Error),
    /// The program does not write the film.
    #[error("{PROGRAM} does not write the film: {0}")]
    Encoder(String),
}

impl Advice for FilmError {
    fn advice(&self) -> Option<&'static str> {
        match self {
            Self::Picture(error) => error.advice(),
            Self::File(error) => error.advice(),
            Self::NoEncoder(_) => Some(
                "install ffmpeg (https://ffmpeg.org) so that it is found, or write an .apng file, which browsers show",
            ),
            Self::Encoder(_) => Some("choose another format or place, such as film.mp4"),
        }
    }
}

impl Film<'_> {
    /// Whether the extension of a file is that of a film that [`encode`](Self::encode) writes.
    pub fn is_encoded(path: &Path) -> bool {
        let extension = path.extension().unwrap_or_default();
        FORMATS
            .iter()
            .any(|format| extension.eq_ignore_ascii_case(format))
    }

    /// All pictures in real time as a film, whose format the extension of the file says, encoded by ffmpeg. A
    /// file that is there is replaced once the film is complete. `drawn` is told the number of pictures that
    /// are drawn, from whatever thread.
    ///
    /// # Errors
    /// [`FilmError`] if a frame cannot be drawn, or ffmpeg is not there or fails.
    pub fn encode(&self, path: &Path, drawn: impl Fn(usize) + Sync) -> Result<(), FilmError> {
        let other = |error: io::Error| FileError::unwritable(path, error);
        let folder = prepare_folder(path)?;
        let unfinished = tempfile::Builder::new().prefix(".film-").tempdir_in(folder);
        let unfinished = unfinished.map_err(other)?;
        let film = Path::new("film").with_extension(path.extension().unwrap_or_default());
        let film = unfinished.path().join(film);
        let mut encoder = self.encoder(&film)?;
        let fed = self.feed(&mut encoder, drawn);
        let mut said = String::new();
        if let Some(mut errors) = encoder.stderr.take() {
            // What it says is for the message alone.
            let _ = errors.read_to_string(&mut said);
        }
        let ended = encoder.wait().map_err(other)?;
        match fed {
            Err(Fed::Picture(error)) => return Err(error.into()),
            // Whoever closes the pipe has said why.
            Err(Fed::Closed(error)) if ended.success() => {
                return Err(FilmError::Encoder(error.to_string()));
            }
            _ => {}
        }
        if !ended.success() {
            let last = said.trim().lines().last().unwrap_or("it says no reason");
            return Err(FilmError::Encoder(last.to_owned()));
        }
        Ok(fs::rename(&film, path).map_err(other)?)
    }

    /// The program, which waits for pictures.
    fn encoder(&self, output: &Path) -> Result<Child, FilmError> {
        let [width, height] = self.size();
        let mut command = Command::new(PROGRAM);
        command
            .args([
                "-y",
                "-loglevel",
                "error",
                "-f",
                "rawvideo",
                "-pixel_format",
                "rgb24",
            ])
            .args(["-video_size", &format!("{width}x{height}")])
            .args(["-framerate", &format!("{:.6}", self.rate()), "-i", "pipe:0"]);
        if !output
            .extension()
            .is_some_and(|e| e.eq_ignore_ascii_case("gif"))
        {
            // What all players take: colours at half the resolution, and so an even number of pixels each
            // way.
            command.args([
                "-vf",
                "pad=ceil(iw/2)*2:ceil(ih/2)*2",
                "-pix_fmt",
                "yuv420p",
            ]);
        }
        command
            .arg(output)
            .stdin(Stdio::piped())
            .stdout(Stdio::null())
            .stderr(Stdio::piped())
            .spawn()
            .map_err(FilmError::NoEncoder)
    }

    /// Draws pictures and passes them on.
    fn feed(&self, encoder: &mut Child, drawn: impl Fn(usize) + Sync) -> Result<(), Fed> {
        let Some(mut pipe) = encoder.stdin.take() else {
            return Ok(());
        };
        let count = AtomicUsize::new(0);
        let one = |place: usize| {
            let picture = self.picture(place).map(|image| image.to_rgb());
            drawn(count.fetch_add(1, Ordering::Relaxed) + 1);
            picture
        };
        let batch = self.at_once(AT_ONCE).map_err(Fed::Picture)?;
        for first in (0..self.len()).step_by(batch) {
            let some = first..self.len().min(first + batch);
            let pictures: Result<Vec<_>, _> = some.into_par_iter().map(one).collect();
            for picture in pictures.map_err(Fed::Picture)? {
                pipe.write_all(&picture).map_err(Fed::Closed)?;
            }
        }
        Ok(())
    }
}

/// Why not all pictures were passed on.
enum Fed {
    Picture(PictureError),
    Closed(io::Error),
}
