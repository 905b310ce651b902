//! Wavefront OBJ files.

use super::{ExportError, Series};
use crate::format::atomic::write_atomically;
use crate::format::obj_write::{Extras, frame_path, write_lines};
use std::io::Write;
use std::path::{Path, PathBuf};

/// Writes one mesh.
pub(super) fn write(
    path: &Path,
    faces: &[[u32; 3]],
    x: &[f64],
    extras: &Extras<'_>,
) -> Result<(), ExportError> {
    Ok(write_atomically(path, |w| {
        write_lines(w, faces.iter().copied(), x, extras)
    })?)
}

/// Texture coordinates, and a group for each of several sheets.
pub(super) fn extras<'a>(series: &'a Series<'_>) -> Extras<'a> {
    let sheets = series.sheets().iter();
    Extras {
        uv: series.uv(),
        groups: sheets.map(|s| (&*s.name, s.part.faces.start)).collect(),
    }
}

/// Writes one file for each frame in a folder, and beside it one with the bodies in their places, one object
/// each; of bodies that rest a single one.
pub(super) fn write_series(path: &Path, series: &Series<'_>) -> Result<Vec<PathBuf>, ExportError> {
    let folder = path.with_extension("");
    let mut files = Vec::new();
    let bodies = series.bodies();
    let rest = bodies.iter().all(|body| body.rests());
    for (k, &frame) in series.frames().iter().enumerate() {
        if !bodies.is_empty() && (k == 0 || !rest) {
            let file = folder.join(format!("bodies_{frame:05}.obj"));
            write_bodies(&file, series, frame)?;
            files.push(file);
        }
    }
    let extras = extras(series);
    for &frame in series.frames() {
        let file = frame_path(&folder, frame);
        write(&file, series.faces(), series.state(frame).1, &extras)?;
        files.push(file);
    }
    Ok(files)
}

/// Writes the bodies in their places in one frame.
fn write_bodies(path: &Path, series: &Series<'_>, frame: usize) -> Result<(), ExportError> {
    Ok(write_atomically(path, |w| {
        let mut first = 1;
        for body in series.bodies() {
            writeln!(w, "o {}", body.name)?;
            for [x, y, z] in body.placed(frame).as_chunks::<3>().0 {
                writeln!(w, "v {x} {y} {z}")?;
            }
            for face in &body.faces {
                let [a, b, c] = face.map(|v| u64::from(v) + first);
                writeln!(w, "f {a} {b} {c}")?;
            }
            first += (body.positions.len() / 3) as u64;
        }
        Ok(())
    })?)
}
