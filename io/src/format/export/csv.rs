//! Positions and fields of vertices as a table.

use super::{ExportError, FieldSupport, Series};
use crate::format::atomic::write_atomically;
use std::io::Write;
use std::path::{Path, PathBuf};

/// Writes a line for each vertex of each frame: its position, then the fields of vertices.
pub(super) fn write_series(path: &Path, series: &Series<'_>) -> Result<Vec<PathBuf>, ExportError> {
    write_atomically(path, |w| {
        writeln!(w, "frame,t,vertex,x,y,z{}", further_names(series))?;
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

/// The columns of a field in the table, which has those of vertices.
fn columns(support: FieldSupport) -> Option<usize> {
    match support {
        FieldSupport::Vertices => Some(1),
        FieldSupport::VertexVectors => Some(3),
        FieldSupport::Edges | FieldSupport::Faces => None,
    }
}

/// The names of the columns after the positions, each after a comma. Those of a vector end in `_x`, `_y`,
/// `_z`.
fn further_names(series: &Series<'_>) -> String {
    let mut names = String::new();
    for (field, _) in series.fields(0) {
        let endings: &[&str] = match columns(field.support) {
            Some(1) => &[""],
            Some(_) => &["_x", "_y", "_z"],
            None => &[],
        };
        for ending in endings {
            names.push(',');
            names += &quoted(&format!("{}{ending}", field.name));
        }
    }
    names
}

/// A cell of a table, in quotes where it needs them.
fn quoted(text: &str) -> String {
    if text.contains([',', '"', '\n', '\r']) {
        format!("\"{}\"", text.replace('"', "\"\""))
    } else {
        text.to_owned()
    }
}
