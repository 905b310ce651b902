//! PLY files (Polygon File Format).

use super::ExportError;
use isosheet_files::write_atomically;
use std::io::Write;
use std::path::Path;

/// Writes one mesh, binary and little-endian, with coordinates of 64 bits.
pub(super) fn write(path: &Path, faces: &[[u32; 3]], x: &[f64]) -> Result<(), ExportError> {
    Ok(write_atomically(path, |w| {
        writeln!(w, "ply\nformat binary_little_endian 1.0\ncomment isosheet")?;
        writeln!(w, "element vertex {}", x.len() / 3)?;
        writeln!(w, "property double x\nproperty double y\nproperty double z")?;
        writeln!(w, "element face {}", faces.len())?;
        writeln!(w, "property list uchar uint vertex_indices\nend_header")?;
        for c in x {
            w.write_all(&c.to_le_bytes())?;
        }
        for face in faces {
            w.write_all(&[3])?;
            for v in face {
                w.write_all(&v.to_le_bytes())?;
            }
        }
        Ok(())
    })?)
}
