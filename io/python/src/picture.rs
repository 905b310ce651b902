//! Pictures and films of runs, and pages in notebooks.

use crate::error::plain;
use isosheet_files::write_atomically;
use isosheet_films::{Film, FilmError, FilmOptions, Viewpoint};
use isosheet_pictures::PictureError;
use isosheet_runs::Recording;
use pyo3::exceptions::PyValueError;
use pyo3::prelude::*;
use std::io::Write;
use std::path::Path;

/// What is written.
#[derive(Clone, Copy, PartialEq, Eq)]
pub(crate) enum Kind {
    /// A PNG file of one frame.
    Picture,
    /// An animated PNG file.
    Film,
}

/// Frames of a run, and how they are shown.
pub(crate) struct Shown<'a> {
    pub(crate) recording: &'a Recording,
    pub(crate) frames: Vec<usize>,
    pub(crate) options: FilmOptions,
}

/// A quantity with the values at both ends of its scale of colours.
pub(crate) type Coloured = (Option<String>, Option<[f64; 2]>);

/// How a run is shown.
pub(crate) fn options(
    height: usize,
    view: Option<(f64, f64)>,
    (colour, range): Coloured,
) -> FilmOptions {
    FilmOptions {
        height,
        view: view.map(|(azimuth, elevation)| Viewpoint { azimuth, elevation }),
        colour,
        range,
        ..FilmOptions::default()
    }
}

impl Shown<'_> {
    pub(crate) fn write(self, py: Python<'_>, path: &Path, kind: Kind) -> PyResult<()> {
        let extension = path.extension().unwrap_or_default().to_ascii_lowercase();
        let (known, remedy) = match kind {
            Kind::Picture => (["png", "png"], "a picture is a .png file"),
            Kind::Film => (
                ["apng", "png"],
                "a film is an .apng file, or with ffmpeg an .mp4, .webm, .mov, .mkv, .avi or .gif file",
            ),
        };
        let is_encoded = kind == Kind::Film && Film::is_encoded(path);
        if !is_encoded && !known.iter().any(|known| extension == *known) {
            let message = format!("{} has another extension: {remedy}", path.display());
            return Err(PyValueError::new_err(message));
        }
        if is_encoded {
            let encoded = py.detach(|| {
                Film::new(self.recording, self.frames, &self.options)?.encode(path, |_| ())
            });
            return encoded.map_err(|e: FilmError| plain(py, &e));
        }
        let bytes = py.detach(|| -> Result<Vec<u8>, PictureError> {
            let film = Film::new(self.recording, self.frames, &self.options)?;
            match kind {
                Kind::Picture => film.picture(0)?.to_png(),
                Kind::Film => film.animation(|_| ()),
            }
        });
        let bytes = bytes.map_err(|e| plain(py, &e))?;
        let written = py.detach(|| write_atomically(path, |w| w.write_all(&bytes)));
        written.map_err(|e| plain(py, &e))
    }
}

/// A page in a frame of a notebook, which may do nothing but run its own program.
pub(crate) fn framed(page: &str) -> String {
    let page = page.replace('&', "&amp;").replace('"', "&quot;");
    format!(
        "<iframe srcdoc=\"{page}\" sandbox=\"allow-scripts\" \
         style=\"width: 100%; height: 640px; border: 0\"></iframe>"
    )
}
