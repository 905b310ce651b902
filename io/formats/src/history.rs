//! The history of a run: one row per step.

use crc::{CRC_64_XZ, Crc, Digest};
use isosheet_mesh::wording::brief;
use std::fmt;
use std::fs::File;
use std::io::{self, Read, Seek, Write};
use std::marker::PhantomData;
use std::path::{Path, PathBuf};

use isosheet_files::{DataError, FileError, WriteError, input, prepare_folder};
use serde::de::DeserializeOwned;
use serde::{Deserialize, Serialize};

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

/// Writes a history row by row: every row is on disk when [`HistoryWriter::append`] returns, so that the file
/// of an interrupted run ends with its last complete step.
///
/// ```
/// use isosheet_formats::{HistoryRow, HistoryWriter, read_history};
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
    /// [`DataError`] naming the column.
    fn check_finite(&self) -> Result<(), DataError> {
        match self.numbers().find(|(_, v)| !v.is_finite()) {
            None => Ok(()),
            Some((column, value)) => {
                let (t, found) = (brief(self.time()), brief(value));
                let message =
                    format!("{column} at t = {t} s is {found}, and the row was not written");
                let remedy = "go back to the last good step, with which the history ends";
                Err(DataError::new(message, remedy).value(value))
            }
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
    /// [`WriteError`].
    pub fn create(path: &Path) -> Result<Self, FileError> {
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

    /// Continues a history after what was written of it, an earlier value of [`RowWriter::written`]; what
    /// follows is cut off.
    ///
    /// # Errors
    /// [`FileError::Read`] if the file cannot be opened, does not have as many bytes, or these are others.
    pub fn resume(path: &Path, written: Written) -> Result<Self, FileError> {
        let length = written.length;
        let read = |source| FileError::unreadable(path, source);
        let remedy = "start the run anew in another folder";
        let file = input::reopen(path, File::options().read(true).write(true));
        let mut file = file.map_err(read)?;
        let found = file.metadata().map_err(read)?.len();
        if found < length {
            let problem =
                format!("it has {found} bytes, {length} were written: it was cut or replaced");
            return Err(FileError::content(path, problem, remedy));
        }
        let sum = sum_of(&mut (&file).take(length)).map_err(read)?;
        if sum.clone().finalize() != written.sum {
            let problem = "it was changed since it was written, its checksum is wrong";
            return Err(FileError::content(path, problem, remedy));
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
    /// [`WriteError`].
    pub fn sync(&self) -> Result<(), FileError> {
        let synced = self.file.sync_data();
        synced.map_err(|e| FileError::unwritable(&self.path, e))
    }

    /// Adds a row.
    ///
    /// # Errors
    /// [`FileError::Data`] naming the column of a number that is not finite, in which case nothing is
    /// written; [`FileError::Write`].
    pub fn append(&mut self, row: &R) -> Result<(), FileError> {
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
    ) -> Result<(), FileError> {
        let failed = |source| FileError::unwritable(&self.path, source);
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
/// [`FileError::Read`] for a file that is missing, has other columns, or an unreadable row before the last.
pub fn read_history(path: &Path) -> Result<Vec<HistoryRow>, FileError> {
    read_rows(path)
}

/// Reads what a [`RowWriter`] has written.
pub(crate) fn read_rows<R: Row + DeserializeOwned>(path: &Path) -> Result<Vec<R>, FileError> {
    let text = input::read(path).map_err(|e| FileError::unreadable(path, e))?;
    // A complete row ends with a line break.
    let complete = text.iter().rposition(|&b| b == b'\n').map_or(0, |k| k + 1);
    let mut reader = csv::Reader::from_reader(&text[..complete]);
    let header = reader
        .headers()
        .map(|h| h.iter().map(str::to_owned).collect::<Vec<_>>())
        .unwrap_or_default();
    if header != R::COLUMNS {
        let (columns, found) = (R::COLUMNS.join(","), header.join(","));
        let problem = format!("it does not start with the columns {columns}, but with {found:?}");
        let remedy = "name the file of a run, such as its history.csv";
        return Err(FileError::content(path, problem, remedy));
    }
    // Rows are read by the order of their columns, so that a row may hold vectors.
    reader.set_headers(csv::StringRecord::new());
    let mut rows = Vec::new();
    for (k, record) in reader.records().enumerate() {
        let row = record.and_then(|record| record.deserialize(None));
        rows.push(row.map_err(|e| {
            let problem = format!("row {}: {e}", k + 1);
            FileError::content(path, problem, "correct or remove the row")
        })?);
    }
    Ok(rows)
}

#[cfg(test)]
mod tests;
