//! Positions and fields of vertices as a table.

use super::{ExportError, FieldSupport, Series};
use isosheet_files::write_atomically;
use std::io::Write;
use std::path::{Path, PathBuf};

/// Writes a line for each vertex of each frame: its position, then the fields of vertices.
pub(super) fn write_series(path: &Path, series: &Series<'_>) -> Result<Vec<PathBuf>, ExportError> {
    write_atomically(path, |w| {
        // The names of fields are free, and may need quotes.
        let mut header = csv::Writer::from_writer(&mut *w);
        header.write_record(names(series))?;
        header.flush()?;
        drop(header);
        for &frame in series.frames() {
            let (t, x) = series.state(frame);
            let fields: Vec<(&[f64], usize)> = series
                .fields(frame)
                .filter_map(|(field, values)| Some((values, columns(field.support)?)))
                .collect();
            for (v, [x, y, z]) in x.as_chunks::<3>().0.iter().enumerate() {
                write!(w, "{frame},{t},{v},{x},{y},{z}")?;
                for (values, n) in &fields {
                    for value in &values[n * v..n * (v + 1)] {
                        write!(w, ",{value}")?;
                    }
                }
                writeln!(w)?;
            }
        }
        Ok(())
    })?;
    Ok(vec![path.to_owned()])
}

/// The columns of a field in the table, which has the fields of vertices.
fn columns(support: FieldSupport) -> Option<usize> {
    match support {
        FieldSupport::Vertices => Some(1),
        FieldSupport::VertexVectors => Some(3),
        FieldSupport::Edges | FieldSupport::Faces | FieldSupport::FaceVectors => None,
    }
}

/// The names of the columns; for a vector they end in `_x`, `_y`, `_z`.
fn names(series: &Series<'_>) -> Vec<String> {
    let mut names = ["frame", "t", "vertex", "x", "y", "z"]
        .map(str::to_owned)
        .to_vec();
    for (field, _) in series.fields(0) {
        let endings: &[&str] = match columns(field.support) {
            Some(1) => &[""],
            Some(_) => &["_x", "_y", "_z"],
            None => &[],
        };
        names.extend(endings.iter().map(|e| format!("{}{e}", field.name)));
    }
    names
}
