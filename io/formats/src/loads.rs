//! The loads of supports, obstacles and bodies in a run.

use super::history::{Row, RowWriter, read_rows};
use isosheet_files::FileError;
use serde::{Deserialize, Serialize};
use std::path::Path;

/// What a load is on.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum LoadKind {
    /// A support, with force and torque of the support on the sheet.
    Support,
    /// An obstacle, with force and torque of the sheet on the obstacle.
    Obstacle,
    /// A body that responds, with force and torque of all that touches it.
    Body,
    /// The guide of a body, with force and torque of the guide on the body.
    Guide,
}

/// The load of a support, an obstacle or a body at the end of a step. The field order is the column order of
/// the file.
///
/// ```
/// use isosheet_formats::{LoadKind, LoadRow, LoadWriter, read_loads};
/// # let folder = tempfile::tempdir()?;
/// # let path = folder.path().join("loads.csv");
/// let mut loads = LoadWriter::create(&path)?;
/// let weight = LoadRow {
///     t: 0.01,
///     on: LoadKind::Support,
///     number: 0,
///     force: [0.0, 0.0, 0.98],
///     torque: [0.0; 3],
/// };
/// loads.append(&weight)?;
/// assert_eq!(read_loads(&path)?, [weight]);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct LoadRow {
    /// Time at the end of the step, seconds.
    pub t: f64,
    /// What it is on.
    pub on: LoadKind,
    /// The number of the support, the obstacle or the body in the scene, from 0.
    pub number: usize,
    /// Force, newtons.
    pub force: [f64; 3],
    /// Torque, newton metres: on an obstacle about the origin of its own frame, on a body about its centre of
    /// mass, of a guide about the point of the hinge or the joint or on a slider about the centre of mass, of
    /// a support about the mean of the places of its vertices.
    pub torque: [f64; 3],
}

/// The columns of the file.
const COLUMNS: [&str; 9] = ["t", "on", "number", "fx", "fy", "fz", "mx", "my", "mz"];

impl Row for LoadRow {
    const COLUMNS: &'static [&'static str] = &COLUMNS;

    fn time(&self) -> f64 {
        self.t
    }

    fn numbers(&self) -> impl Iterator<Item = (&'static str, f64)> {
        let values = [self.t].into_iter();
        let values = values.chain(self.force).chain(self.torque);
        let columns = ["t", "fx", "fy", "fz", "mx", "my", "mz"];
        columns.into_iter().zip(values)
    }
}

/// Writes loads row by row.
pub type LoadWriter = RowWriter<LoadRow>;

/// Reads loads. A last row that is cut short, as an interrupted run may leave it, is ignored.
///
/// # Errors
/// As [`read_history`](super::read_history).
pub fn read_loads(path: &Path) -> Result<Vec<LoadRow>, FileError> {
    read_rows(path)
}
