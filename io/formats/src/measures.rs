//! The measures of a run.

use super::history::{Row, RowWriter, read_rows};
use isosheet_files::FileError;
use serde::{Deserialize, Serialize};
use std::path::Path;

/// What a measure of the scene shows at the start or at the end of a step. The field order is the column
/// order of the file.
///
/// ```
/// use isosheet_formats::{MeasureRow, MeasureWriter, read_measures};
/// # let folder = tempfile::tempdir()?;
/// # let path = folder.path().join("measures.csv");
/// let mut measures = MeasureWriter::create(&path)?;
/// let row = MeasureRow { t: 0.01, name: "tip".into(), value: -0.05 };
/// measures.append(&row)?;
/// assert_eq!(read_measures(&path)?, [row]);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct MeasureRow {
    /// Time, seconds.
    pub t: f64,
    /// The name of the measure.
    pub name: String,
    /// What it shows, in the unit of its quantity: metres, degrees, newton metres or newtons.
    pub value: f64,
}

impl Row for MeasureRow {
    const COLUMNS: &'static [&'static str] = &["t", "name", "value"];

    fn time(&self) -> f64 {
        self.t
    }

    fn numbers(&self) -> impl Iterator<Item = (&'static str, f64)> {
        [("t", self.t), ("value", self.value)].into_iter()
    }
}

/// Writes measures row by row.
pub type MeasureWriter = RowWriter<MeasureRow>;

/// Reads measures. A last row that is cut short, as an interrupted run may leave it, is ignored.
///
/// # Errors
/// As [`read_history`](super::read_history).
pub fn read_measures(path: &Path) -> Result<Vec<MeasureRow>, FileError> {
    read_rows(path)
}
