//! Arrays in an archive of numpy: a zip file with one `.npy` file for each.

use super::TrajectoryError;
use npyz::npz::file_name_from_array_name;
use npyz::{AutoSerialize, Deserialize, NpyFile, Order, WriteOptions, WriterBuilder};
use std::fs::File;
use std::io::{self, BufReader, Seek, SeekFrom, Write};
use std::path::Path;
use zip::result::ZipError;
use zip::write::SimpleFileOptions;
use zip::{CompressionMethod, DateTime, ZipArchive, ZipWriter};

/// Writes arrays.
pub(super) struct ArchiveWriter<W: Write + Seek>(ZipWriter<UntilError<W>>);

/// Writes until that fails, and only seems to write from then on. An archive that is given up after an error
/// is ended by its library, which would print what fails then.
struct UntilError<W> {
    inner: W,
    has_failed: bool,
    /// Where the next byte goes.
    place: u64,
    /// Where the last byte ends.
    end: u64,
}

impl<W> UntilError<W> {
    fn new(inner: W) -> Self {
        Self {
            inner,
            has_failed: false,
            place: 0,
            end: 0,
        }
    }

    /// Does something, or nothing after an error.
    fn unless_failed<T>(
        &mut self,
        otherwise: T,
        f: impl FnOnce(&mut W) -> io::Result<T>,
    ) -> io::Result<T> {
        if self.has_failed {
            return Ok(otherwise);
        }
        let done = f(&mut self.inner);
        let is_final = |e: &io::Error| e.kind() != io::ErrorKind::Interrupted;
        self.has_failed = done.as_ref().is_err_and(is_final);
        done
    }
}

impl<W: Write> Write for UntilError<W> {
    fn write(&mut self, bytes: &[u8]) -> io::Result<usize> {
        let written = self.unless_failed(bytes.len(), |w| w.write(bytes))?;
        self.place += written as u64;
        self.end = self.end.max(self.place);
        Ok(written)
    }

    fn flush(&mut self) -> io::Result<()> {
        self.unless_failed((), |w| w.flush())
    }
}

impl<W: Seek> Seek for UntilError<W> {
    fn seek(&mut self, to: SeekFrom) -> io::Result<u64> {
        let place = match to {
            SeekFrom::Start(place) => place,
            SeekFrom::Current(by) => self.place.saturating_add_signed(by),
            SeekFrom::End(by) => self.end.saturating_add_signed(by),
        };
        self.place = self.unless_failed(place, |w| w.seek(to))?;
        Ok(self.place)
    }
}

impl<W: Write + Seek> ArchiveWriter<W> {
    pub(super) fn new(file: W) -> Self {
        Self(ZipWriter::new(UntilError::new(file)))
    }

    /// Adds an array with the values of its entries by rows.
    pub(super) fn put<T: AutoSerialize>(
        &mut self,
        name: &str,
        shape: &[u64],
        values: impl Iterator<Item = T>,
    ) -> io::Result<()> {
        let bytes = shape.iter().product::<u64>() * size_of::<T>() as u64;
        let options = SimpleFileOptions::default()
            .compression_method(CompressionMethod::Deflated)
            // A fixed date (that of an empty entry, 1980), so that equal runs give equal files.
            .last_modified_time(DateTime::default())
            // An entry of more than 4 GiB, with its header, has another form.
            .large_file(bytes > u64::from(u32::MAX) / 2);
        self.0
            .start_file(file_name_from_array_name(name), options)?;
        let options = WriteOptions::new().default_dtype().shape(shape);
        let mut writer = options.writer(&mut self.0).begin_nd()?;
        writer.extend(values)?;
        writer.finish()
    }

    pub(super) fn finish(self) -> io::Result<()> {
        self.0.finish()?;
        Ok(())
    }
}

/// Reads arrays.
pub(super) struct ArchiveReader<'a> {
    zip: ZipArchive<BufReader<File>>,
    /// For messages.
    path: &'a Path,
}

/// An array: its shape and its entries by rows.
pub(super) type Shaped<T> = (Vec<u64>, Vec<T>);

impl<'a> ArchiveReader<'a> {
    pub(super) fn open(path: &'a Path) -> io::Result<Self> {
        let zip = ZipArchive::new(BufReader::new(File::open(path)?))?;
        Ok(Self { zip, path })
    }

    /// An array of so many dimensions.
    pub(super) fn get<T: Deserialize>(
        &mut self,
        name: &'static str,
        dimensions: usize,
    ) -> Result<Shaped<T>, TrajectoryError> {
        let found = self.get_if_there(name, dimensions)?;
        found.ok_or_else(|| TrajectoryError::Array {
            path: self.path.to_owned(),
            array: name,
            problem: "it is missing".to_owned(),
        })
    }

    /// An array of so many dimensions, which need not be there.
    pub(super) fn get_if_there<T: Deserialize>(
        &mut self,
        name: &'static str,
        dimensions: usize,
    ) -> Result<Option<Shaped<T>>, TrajectoryError> {
        let error = |problem: String| TrajectoryError::Array {
            path: self.path.to_owned(),
            array: name,
            problem,
        };
        let entry = match self.zip.by_name(&file_name_from_array_name(name)) {
            Err(ZipError::FileNotFound) => return Ok(None),
            other => other.map_err(|e| error(e.to_string()))?,
        };
        let npy = NpyFile::new(entry).map_err(|e| error(e.to_string()))?;
        let shape = npy.shape().to_vec();
        if shape.len() != dimensions {
            return Err(error(format!(
                "it has {} dimensions, {dimensions} expected",
                shape.len()
            )));
        }
        if npy.header().order() != Order::C {
            return Err(error(
                "it is stored by columns; save it with numpy.ascontiguousarray".to_owned(),
            ));
        }
        let expected = shape.iter().try_fold(1u64, |n, &k| n.checked_mul(k));
        let expected =
            expected.ok_or_else(|| error(format!("its shape {shape:?} is impossible")))?;
        let values = npy
            .try_data::<T>()
            .map_err(|npy| error(format!("its type is {:?}", npy.dtype().descr())))?;
        let values: Vec<T> = values
            .collect::<Result<_, _>>()
            .map_err(|e| error(e.to_string()))?;
        if values.len() as u64 != expected {
            return Err(error(format!(
                "it holds {} values, {expected} expected",
                values.len()
            )));
        }
        Ok(Some((shape, values)))
    }
}
