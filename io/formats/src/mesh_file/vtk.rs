//! Reading polygons of VTK files.

mod legacy;
#[cfg(test)]
mod tests;
mod xml;

pub(super) use legacy::parse as parse_legacy;
pub(super) use xml::parse as parse_xml;

use super::error::{CORRECT, Located, Location};
use super::faces::Polyhedron;
use isosheet_files::DataError;

/// The polygons of a file, and the time that it gives them.
#[derive(Debug, Default)]
pub(super) struct TimedPolygons {
    pub(super) mesh: Polyhedron,
    /// In the unit of the file.
    pub(super) time: Option<f64>,
}

impl TimedPolygons {
    /// Adds points, and polygons between them: their corners one after the other, and where each polygon
    /// ends.
    pub(super) fn add(
        &mut self,
        points: &[f64],
        corners: &[i64],
        ends: &[i64],
    ) -> Result<(), DataError> {
        let first = self.mesh.positions.len() as i64 / 3;
        for p in points.as_chunks::<3>().0 {
            self.mesh.push_vertex(*p)?;
        }
        let mut start = 0;
        for &end in ends {
            let range = usize::try_from(end).ok().map(|end| start..end);
            let own = range.and_then(|range| corners.get(range));
            let face = self.mesh.face_count();
            let own = own.ok_or_else(|| {
                let (from, to, count) = (start, end, corners.len());
                let message =
                    format!("polygon {face} has the corners {from} to {to} of {count} corners");
                DataError::new(message, CORRECT).at(face)
            })?;
            start += own.len();
            let own = own.iter().map(|v| v.saturating_add(first));
            self.mesh.push_face(own, Location::Face(face));
        }
        Ok(())
    }
}

/// Something is wrong that has no place in the file.
fn plain(problem: DataError) -> Located {
    (None, problem.into())
}

/// Cells that are no polygons.
fn strips() -> DataError {
    let message = "the file has strips of triangles";
    DataError::new(
        message,
        "export polygons (ParaView: the filter Triangulate)",
    )
}

/// A kind of data that has no polygons.
fn other_data(kind: &str) -> DataError {
    let message = format!("the file has data of the kind {kind:?}, and polygons are read");
    DataError::new(
        message,
        "export a surface (ParaView: the filter Extract Surface)",
    )
}
