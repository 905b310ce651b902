//! The history of a run: one row per step.

use crc::{CRC_64_XZ, Crc, Digest};
use isosheet_mesh::Advice;
use isosheet_mesh::wording::brief;
use std::fmt;
use std::fs::File;
use std::io::{self, Read, Seek, Write};
use std::marker::PhantomData;
use std::path::{Path, PathBuf};

use serde::de::DeserializeOwned;
use serde::{Deserialize, Serialize};
use thiserror::Error;

use crate::format::atomic::{WriteError, prepare_folder};
use crate::format::input;

/// One step of a run. The field order is the column order of the file.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct HistoryRow {
    /// Time at the end of the step, in seconds.
    pub t: f64,
    /// Length of the step, in seconds; 0 in a row for the start.
    pub h: f64,
    /// Parts that the step was divided into; 0 in a row for the start.
    pub substeps: usize,
    /// Iterations that the step took.
    pub iterations: usize,
    /// Matrix factorisations that the step took.
    pub factorisations: usize,
    /// Sub-steps that were tried and rejected.
    pub rejected: usize,
    /// Kinetic energy, in joules.
    pub kinetic: f64,
    /// Potential energy, in joules.
    pub potential: f64,
    /// Total energy, in joules.
    #[serde(rename = "H")]
    pub total: f64,
    /// Change of the total energy since the start, in joules.
    #[serde(rename = "dH")]
    pub drift: f64,
    /// Work of moving supports and bodies and of applied forces since the start, in joules.
    pub work: f64,
    /// What velocity damping has dissipated since the start, in joules.
    pub damped: f64,
    /// What friction has dissipated since the start, in joules.
    pub friction: f64,
    /// What yielding has dissipated since the start, in joules; empty in the file for a run in which nothing
    /// can yield. `dH - work + damped + friction + plastic` is the error of the energy balance.
    pub plastic: Option<f64>,
    /// Largest relative change of an edge length.
    pub strain: f64,
    /// Smallest distance between surfaces that could come into contact, in metres; empty in the file for a
    /// run without contact.
    pub gap: Option<f64>,
}

/// The column names, in order.
const COLUMNS: [&str; 16] = [
    "t",
    "h",
    "substeps",
    "iterations",
    "factorisations",
    "rejected",
    "kinetic",
    "potential",
    "H",
    "dH",
    "work",
    "damped",
    "friction",
    "plastic",
    "strain",
    "gap",
];

/// A history that cannot be written or read.
#[derive(Debug, Error)]
#[non_exhaustive]
pub enum HistoryError {
    /// The file could not be created or written.
    #[error(transparent)]
    File(#[from] WriteError),
    /// A value is NaN or infinite.
    #[error(
        "{column} at t = {t} s is {value}, and the row was not written",
        t = brief(*t), value = brief(*value)
    )]
    NotFinite {
        /// The column.
        column: &'static str,
        /// The time of the row, in seconds.
        t: f64,
        /// The value.
        value: f64,
    },
    /// A file could not be read.
    #[error("cannot read {}: {source}", path.display())]
    Read {
        /// The file.
        path: PathBuf,
        /// What the system said.
        source: io::Error,
    },
    /// A history that is to be continued has lost rows.
    #[error(
        "{} has {found} bytes, {length} were written: it was cut or replaced",
        path.display()
    )]
    Shorter {
        /// The file.
        path: PathBuf,
        /// Its length in bytes.
        found: u64,
        /// The length that it had.
        length: u64,
    },
    /// A history that is to be continued was changed.
    #[error("{} was changed since it was written, its checksum is wrong", path.display())]
    Changed {
        /// The file.
        path: PathBuf,
    },
    /// The first line is not the expected one.
    #[error("{} does not start with the columns {columns}, but with {found:?}", path.display())]
    Header {
        /// The file.
        path: PathBuf,
        /// The columns that were expected.
        columns: String,
        /// The first line.
        found: String,
    },
    /// A row is not readable.
    #[error("row {row} of {}: {problem}", path.display())]
    Row {
        /// The file.
        path: PathBuf,
        /// The row, 1 for the first below the header.
        row: usize,
        /// What is wrong.
        problem: String,
    },
}

impl Advice for HistoryError {
    fn advice(&self) -> Option<&'static str> {
        match self {
            Self::File(error) => error.advice(),
            Self::NotFinite { .. } => {
                Some("go back to the last good step, with which the history ends")
            }
            Self::Read { .. } => Some("check the path"),
            Self::Shorter { .. } | Self::Changed { .. } => {
                Some("start the run anew in another folder")
            }
            Self::Header { .. } => Some("name the file of a run, such as its history.csv"),
            Self::Row { .. } => Some("correct or remove the row"),
        }
    }
}

/// Writes a history row by row: every row is on disk when [`HistoryWriter::append`] returns, so that the file
/// of an interrupted run ends with its last complete step.
///
/// ```
/// use isosheet_io::{HistoryRow, HistoryWriter, read_history};
/// # let folder = tempfile::tempdir()?;
/// # let path = folder.path().join("runs/free_fall/history.csv");
/// let mut history = HistoryWriter::create(&path)?;
/// history.append(&HistoryRow { t: 0.01, h: 0.01, iterations: 3, ..HistoryRow::default() })?;
/// assert_eq!(read_history(&path)?.len(), 1);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
pub type HistoryWriter = RowWriter<HistoryRow>;

/// A row of a table that grows while a run goes on.
pub trait Row: Serialize {
    /// The columns of the file.
    const COLUMNS: &'static [&'static str];

    /// Time of the row, seconds.
    fn time(&self) -> f64;

    /// The values that have to be finite, with their columns.
    fn numbers(&self) -> impl Iterator<Item = (&'static str, f64)>;

    /// Checks that they are.
    ///
    /// # Errors
    /// [`HistoryError::NotFinite`] naming the column.
    fn check_finite(&self) -> Result<(), HistoryError> {
        match self.numbers().find(|(_, v)| !v.is_finite()) {
            None => Ok(()),
            Some((column, value)) => Err(HistoryError::NotFinite {
                column,
                t: self.time(),
                value,
            }),
        }
    }
}

impl Row for HistoryRow {
    const COLUMNS: &'static [&'static str] = &COLUMNS;

    fn time(&self) -> f64 {
        self.t
    }

    fn numbers(&self) -> impl Iterator<Item = (&'static str, f64)> {
        let values = [
            ("t", self.t),
            ("h", self.h),
            ("kinetic", self.kinetic),
            ("potential", self.potential),
            ("H", self.total),
            ("dH", self.drift),
            ("work", self.work),
            ("damped", self.damped),
            ("friction", self.friction),
            ("plastic", self.plastic.unwrap_or(0.0)),
            ("strain", self.strain),
            ("gap", self.gap.unwrap_or(0.0)),
        ];
        values.into_iter()
    }
}

/// How much of a table was written, as a run notes it to continue the table.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub struct Written {
    /// Bytes.
    pub length: u64,
    /// CRC-64 of these bytes.
    pub sum: u64,
}

/// Sums over tables.
static SUM: Crc<u64> = Crc::<u64>::new(&CRC_64_XZ);

/// Writes a table of comma-separated values row by row, as [`HistoryWriter`] does.
pub struct RowWriter<R> {
    path: PathBuf,
    file: File,
    length: u64,
    /// Over the bytes that are written.
    sum: Digest<'static, u64>,
    rows: PhantomData<fn(&R)>,
}

impl<R> fmt::Debug for RowWriter<R> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let mut shown = f.debug_struct("RowWriter");
        shown
            .field("path", &self.path)
            .field("length", &self.length);
        shown.finish_non_exhaustive()
    }
}

impl<R: Row> RowWriter<R> {
    /// Starts a new history, replacing an older file; missing parent folders are created.
    ///
    /// # Errors
    /// [`HistoryError::File`].
    pub fn create(path: &Path) -> Result<Self, HistoryError> {
        let folder = prepare_folder(path)?;
        let file =
            input::replace(path).map_err(|source| WriteError::CreateFile { folder, source })?;
        let mut history = Self {
            path: path.to_owned(),
            file,
            length: 0,
            sum: SUM.digest(),
            rows: PhantomData,
        };
        history.write_record(|w| w.write_record(R::COLUMNS))?;
        Ok(history)
    }

    /// Continues a history after what was written of it, an earlier value of [`RowWriter::written`]; what follows
    /// is cut off.
    ///
    /// # Errors
    /// [`HistoryError::Read`] if the file cannot be opened, [`HistoryError::Shorter`] if it does not have as
    /// many bytes, [`HistoryError::Changed`] if these are others.
    pub fn resume(path: &Path, written: Written) -> Result<Self, HistoryError> {
        let length = written.length;
        let read = |source| HistoryError::Read {
            path: path.to_owned(),
            source,
        };
        let file = input::reopen(path, File::options().read(true).write(true));
        let mut file = file.map_err(read)?;
        let found = file.metadata().map_err(read)?.len();
        if found < length {
            return Err(HistoryError::Shorter {
                path: path.to_owned(),
                found,
                length,
            });
        }
        let sum = sum_of(&mut (&file).take(length)).map_err(read)?;
        if sum.clone().finalize() != written.sum {
            return Err(HistoryError::Changed {
                path: path.to_owned(),
            });
        }
        file.set_len(length).map_err(read)?;
        file.seek(io::SeekFrom::End(0)).map_err(read)?;
        Ok(Self {
            path: path.to_owned(),
            file,
            length,
            sum,
            rows: PhantomData,
        })
    }

    /// What is written so far.
    pub fn written(&self) -> Written {
        Written {
            length: self.length,
            sum: self.sum.clone().finalize(),
        }
    }

    /// Waits until all rows are on the disk, so that they survive the end of the system too.
    ///
    /// # Errors
    /// [`HistoryError::File`].
    pub fn sync(&self) -> Result<(), HistoryError> {
        let synced = self.file.sync_data();
        Ok(synced.map_err(|source| WriteError::Write {
            path: self.path.clone(),
            source,
        })?)
    }

    /// Adds a row.
    ///
    /// # Errors
    /// [`HistoryError::NotFinite`] naming the column, in which case nothing is written;
    /// [`HistoryError::File`].
    pub fn append(&mut self, row: &R) -> Result<(), HistoryError> {
        row.check_finite()?;
        self.write_record(|w| w.serialize(row))
    }

    /// The file being written.
    pub fn path(&self) -> &Path {
        &self.path
    }

    /// Formats a record in memory and writes it with one call, so that no half row is left by a crash of this
    /// process.
    fn write_record(
        &mut self,
        record: impl FnOnce(&mut csv::Writer<&mut Vec<u8>>) -> csv::Result<()>,
    ) -> Result<(), HistoryError> {
        let failed = |source| WriteError::Write {
            path: self.path.clone(),
            source,
        };
        let mut line = Vec::with_capacity(192);
        {
            let mut writer = csv::WriterBuilder::new()
                .has_headers(false)
                .from_writer(&mut line);
            record(&mut writer).map_err(|e| failed(io::Error::other(e)))?;
            writer.flush().map_err(failed)?;
        }
        self.file.write_all(&line).map_err(failed)?;
        self.sum.update(&line);
        self.length += line.len() as u64;
        Ok(())
    }
}

/// The sum over all bytes.
fn sum_of(bytes: &mut impl Read) -> io::Result<Digest<'static, u64>> {
    let (mut sum, mut part) = (SUM.digest(), vec![0; 1 << 16]);
    loop {
        match bytes.read(&mut part)? {
            0 => return Ok(sum),
            count => sum.update(&part[..count]),
        }
    }
}

/// Reads a history. A last row that is cut short, as an interrupted run may leave it, is ignored.
///
/// # Errors
/// [`HistoryError`] for a file that is missing, has other columns, or an unreadable row before the last.
pub fn read_history(path: &Path) -> Result<Vec<HistoryRow>, HistoryError> {
    read_rows(path)
}

/// Reads what a [`RowWriter`] has written.
pub(crate) fn read_rows<R: Row + DeserializeOwned>(path: &Path) -> Result<Vec<R>, HistoryError> {
    let text = input::read(path).map_err(|source| HistoryError::Read {
        path: path.to_owned(),
        source,
    })?;
    // A complete row ends with a line break.
    let complete = text.iter().rposition(|&b| b == b'\n').map_or(0, |k| k + 1);
    let mut reader = csv::Reader::from_reader(&text[..complete]);
    let header = reader
        .headers()
        .map(|h| h.iter().map(str::to_owned).collect::<Vec<_>>())
        .unwrap_or_default();
    if header != R::COLUMNS {
        return Err(HistoryError::Header {
            path: path.to_owned(),
            columns: R::COLUMNS.join(","),
            found: header.join(","),
        });
    }
    // Rows are read by the order of their columns, so that a row may hold vectors.
    reader.set_headers(csv::StringRecord::new());
    let mut rows = Vec::new();
    for (k, record) in reader.records().enumerate() {
        let row = record.and_then(|record| record.deserialize(None));
        rows.push(row.map_err(|e| HistoryError::Row {
            path: path.to_owned(),
            row: k + 1,
            problem: e.to_string(),
        })?);
    }
    Ok(rows)
}

#[cfg(test)]
mod tests;
