//! Wavefront OBJ files.

use super::{ExportError, Series, folder_of};
use crate::format::atomic::write_atomically;
use crate::format::obj_write::{frame_path, write_lines};
use std::path::{Path, PathBuf};

/// Writes one mesh.
pub(super) fn write(path: &Path, faces: &[[u32; 3]], x: &[f64]) -> Result<(), ExportError> {
    Ok(write_atomically(path, |w| {
        write_lines(w, faces.iter().copied(), x)
    })?)
}

/// Writes one file for each frame in a folder.
pub(super) fn write_series(path: &Path, series: &Series<'_>) -> Result<Vec<PathBuf>, ExportError> {
    let folder = folder_of(path);
    let mut files = Vec::new();
    for &frame in series.frames() {
        let file = frame_path(&folder, frame);
        write(&file, series.faces(), series.state(frame).1)?;
        files.push(file);
    }
    Ok(files)
}
