//! Positions as a table.

use super::{ExportError, Series};
use crate::format::atomic::write_atomically;
use std::io::Write;
use std::path::{Path, PathBuf};

/// Writes a line for each vertex of each frame.
pub(super) fn write_series(path: &Path, series: &Series<'_>) -> Result<Vec<PathBuf>, ExportError> {
    write_atomically(path, |w| {
        writeln!(w, "frame,t,vertex,x,y,z")?;
        for &frame in series.frames() {
            let (t, x) = series.state(frame);
            for (v, [x, y, z]) in x.as_chunks::<3>().0.iter().enumerate() {
                writeln!(w, "{frame},{t},{v},{x},{y},{z}")?;
            }
        }
        Ok(())
    })?;
    Ok(vec![path.to_owned()])
}
