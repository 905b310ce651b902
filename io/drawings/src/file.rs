//! Files of drawings.

use super::options::DrawingOptions;
use crate::{Drawing, dxf, svg};
use isosheet_files::{DataError, FileError, input};
use std::path::Path;

/// A format of drawings, as the extension of a file says.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[non_exhaustive]
pub enum DrawingFormat {
    /// Scalable Vector Graphics, `.svg`.
    Svg,
    /// Drawing Exchange Format as text, `.dxf`.
    Dxf,
}

impl DrawingFormat {
    /// The format of a file by its extension, in capital or small letters; `None` for all others.
    pub fn of(path: &Path) -> Option<Self> {
        let found = path.extension()?;
        let known = [("svg", Self::Svg), ("dxf", Self::Dxf)];
        let known = known
            .into_iter()
            .find(|(e, _)| found.eq_ignore_ascii_case(e));
        known.map(|(_, format)| format)
    }
}

/// Reads a drawing, whose extension says which format it has.
///
/// # Errors
/// [`FileError`] with the file and what is wrong.
pub fn read_drawing(path: &Path, options: &DrawingOptions) -> Result<Drawing, FileError> {
    let bytes = input::read(path).map_err(|e| FileError::unreadable(path, e))?;
    parse_drawing(&bytes, path, options)
}

/// Reads the bytes of a drawing, whose name says which format it has.
///
/// # Errors
/// [`FileError`] with the file and what is wrong.
pub fn parse_drawing(
    bytes: &[u8],
    path: &Path,
    options: &DrawingOptions,
) -> Result<Drawing, FileError> {
    let bytes = input::without_mark(bytes);
    let drawing = match DrawingFormat::of(path) {
        Some(DrawingFormat::Svg) => {
            svg::parse(bytes, svg::Areas::Outlined, options.unit, options.scale)
        }
        Some(DrawingFormat::Dxf) => dxf::parse(bytes, options.unit, options.scale),
        None => {
            let message = "it is no drawing by its name";
            Err(DataError::new(message, "name a file .svg or .dxf"))
        }
    };
    drawing.map_err(|e| {
        let remedy = e.remedy.unwrap_or("export it again");
        FileError::content(path, e, remedy)
    })
}
