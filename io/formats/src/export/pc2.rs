//! PC2 point caches.

use super::error::{fits, single};
use super::{ExportError, Series, obj};
use isosheet_files::{DataError, write_atomically};
use std::io::Write;
use std::path::{Path, PathBuf};

/// Writes the point cache and, beside it, the mesh of the first frame as OBJ. A mesh that is there without a
/// point cache is not replaced: it may be the one that the run was made of.
///
/// The header has the name of the format, its version 1, the number of points, the first frame 0, one frame a
/// sample, and the number of samples; little-endian `f32` coordinates of all points follow, sample after
/// sample.
pub(super) fn write_series(path: &Path, series: &Series<'_>) -> Result<Vec<PathBuf>, ExportError> {
    let limit = i32::MAX as usize;
    let points: i32 = fits("vertices", series.topology().vertex_count(), limit)?;
    let samples: i32 = fits("frames", series.frames().len(), limit)?;
    for &frame in series.frames() {
        single(series.state(frame).1)?;
    }
    let mesh = path.with_extension("obj");
    if mesh.exists() && !path.exists() {
        let message = format!("{}, which is there, would be replaced too", mesh.display());
        return Err(DataError::new(message, "choose another name").into());
    }
    obj::write(
        &mesh,
        series.faces(),
        series.state(series.frames()[0]).1,
        &obj::extras(series),
    )?;
    write_atomically(path, |w| {
        w.write_all(b"POINTCACHE2\0")?;
        w.write_all(&1_i32.to_le_bytes())?;
        w.write_all(&points.to_le_bytes())?;
        w.write_all(&0.0_f32.to_le_bytes())?;
        w.write_all(&1.0_f32.to_le_bytes())?;
        w.write_all(&samples.to_le_bytes())?;
        for &frame in series.frames() {
            for &c in series.state(frame).1 {
                w.write_all(&(c as f32).to_le_bytes())?;
            }
        }
        Ok(())
    })?;
    Ok(vec![mesh, path.to_owned()])
}
