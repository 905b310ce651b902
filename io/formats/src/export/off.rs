//! OFF files (Object File Format of Geomview).

use super::ExportError;
use isosheet_files::write_atomically;
use std::io::Write;
use std::path::Path;

/// Writes one mesh as text.
pub(super) fn write(path: &Path, faces: &[[u32; 3]], x: &[f64]) -> Result<(), ExportError> {
    let points = x.as_chunks::<3>().0;
    Ok(write_atomically(path, |w| {
        writeln!(w, "OFF\n{} {} 0", points.len(), faces.len())?;
        for [x, y, z] in points {
            writeln!(w, "{x} {y} {z}")?;
        }
        for [a, b, c] in faces {
            writeln!(w, "3 {a} {b} {c}")?;
        }
        Ok(())
    })?)
}
