//! Arrays in an archive of numpy: a zip file with one `.npy` file for each.

use super::npy::{ArrayWriter, Header, Number, read_entries};
use isosheet_files::{Allowance, FileError, input, memory};
use std::fs::File;
use std::io::{self, BufReader, Read, Seek, SeekFrom, Write};
use std::path::Path;
use zip::result::ZipError;
use zip::write::SimpleFileOptions;
use zip::{CompressionMethod, DateTime, ZipArchive, ZipWriter};

/// How the arrays of an archive are written.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Packing {
    Compressed,
    /// Byte for byte: compressed to a small part of their length, arrays would not be read again.
    Plain,
}

/// Whether arrays of so many bytes are read from an archive of so many.
pub(super) fn is_read(arrays: u64, archive: u64) -> bool {
    arrays <= most(archive)
}

/// The bytes that the arrays of an archive of some length may take.
fn most(archive: u64) -> u64 {
    let length = usize::try_from(archive).unwrap_or(usize::MAX);
    Allowance::of(length).half().all() as u64
}

/// Writes arrays.
pub(super) struct ArchiveWriter<W: Write + Seek> {
    zip: ZipWriter<UntilFailure<W>>,
    packing: Packing,
    /// The bytes of all arrays.
    bytes: u64,
}

/// A file to which nothing more is written once that has failed, without a further word: the library ends an
/// archive that is given up, and prints what goes wrong with that.
struct UntilFailure<W> {
    file: W,
    /// After a failure the place and the length that the file would have.
    lost: Option<[u64; 2]>,
    /// The place in the file.
    place: u64,
}

impl<W> UntilFailure<W> {
    fn new(file: W) -> Self {
        Self {
            file,
            lost: None,
            place: 0,
        }
    }

    /// Takes note of a failure.
    fn note<T>(&mut self, done: io::Result<T>) -> io::Result<T> {
        if done
            .as_ref()
            .is_err_and(|e| e.kind() != io::ErrorKind::Interrupted)
        {
            self.lost = Some([self.place; 2]);
        }
        done
    }
}

impl<W: Write> Write for UntilFailure<W> {
    fn write(&mut self, bytes: &[u8]) -> io::Result<usize> {
        if let Some([place, length]) = &mut self.lost {
            *place += bytes.len() as u64;
            *length = (*length).max(*place);
            return Ok(bytes.len());
        }
        let written = self.file.write(bytes);
        self.place += *written.as_ref().unwrap_or(&0) as u64;
        self.note(written)
    }

    fn flush(&mut self) -> io::Result<()> {
        if self.lost.is_some() {
            return Ok(());
        }
        let flushed = self.file.flush();
        self.note(flushed)
    }
}

impl<W: Seek> Seek for UntilFailure<W> {
    fn seek(&mut self, to: SeekFrom) -> io::Result<u64> {
        if let Some([place, length]) = &mut self.lost {
            *place = match to {
                SeekFrom::Start(place) => place,
                SeekFrom::Current(by) => place.saturating_add_signed(by),
                SeekFrom::End(by) => length.saturating_add_signed(by),
            };
            return Ok(*place);
        }
        let sought = self.file.seek(to);
        self.place = *sought.as_ref().unwrap_or(&self.place);
        self.note(sought)
    }
}

/// The error of the system, where it is one.
fn of_archive(error: ZipError) -> io::Error {
    match error {
        ZipError::Io(error) => error,
        error => io::Error::other(error),
    }
}

impl<W: Write + Seek> ArchiveWriter<W> {
    pub(super) fn new(file: W, packing: Packing) -> Self {
        Self {
            zip: ZipWriter::new(UntilFailure::new(file)),
            packing,
            bytes: 0,
        }
    }

    /// Adds an array with the values of its entries by rows.
    pub(super) fn put<T: Number>(
        &mut self,
        name: &str,
        shape: &[u64],
        values: impl Iterator<Item = T>,
    ) -> io::Result<()> {
        self.begin::<T>(name, shape)?;
        let mut writer = ArrayWriter::new::<T>(&mut self.zip, shape)?;
        values
            .into_iter()
            .try_for_each(|value| writer.push(value))?;
        writer.finish()
    }

    /// Adds an array whose rows `rows` puts, one after the other.
    pub(super) fn put_rows(
        &mut self,
        name: &str,
        shape: &[u64],
        rows: impl FnOnce(&mut dyn FnMut(&[f64]) -> io::Result<()>) -> io::Result<()>,
    ) -> io::Result<()> {
        self.begin::<f64>(name, shape)?;
        let mut writer = ArrayWriter::new::<f64>(&mut self.zip, shape)?;
        rows(&mut |row| row.iter().try_for_each(|value| writer.push(*value)))?;
        writer.finish()
    }

    /// Begins the file of an array.
    fn begin<T>(&mut self, name: &str, shape: &[u64]) -> io::Result<()> {
        let bytes = shape.iter().product::<u64>() * size_of::<T>() as u64;
        self.bytes += bytes_read(shape.iter().product(), size_of::<T>());
        let method = match self.packing {
            Packing::Compressed => CompressionMethod::Deflated,
            Packing::Plain => CompressionMethod::Stored,
        };
        let options = SimpleFileOptions::default()
            .compression_method(method)
            // A fixed date (that of an empty entry, 1980), so that equal runs give equal files.
            .last_modified_time(DateTime::default())
            // An entry of more than 4 GiB, with its header, has another form.
            .large_file(bytes > u64::from(u32::MAX) / 2);
        self.zip
            .start_file(file_of(name), options)
            .map_err(of_archive)
    }

    /// Ends the archive, and returns the bytes that its arrays take when they are read.
    pub(super) fn finish(self) -> io::Result<u64> {
        self.zip.finish().map_err(of_archive)?;
        Ok(self.bytes)
    }
}

/// The memory for so many entries of some bytes, which may become floats.
fn bytes_read(entries: u64, size: usize) -> u64 {
    entries.saturating_mul(size.max(size_of::<f64>()) as u64)
}

/// Reads arrays.
pub(super) struct ArchiveReader<'a, R> {
    zip: ZipArchive<R>,
    /// The bytes that further arrays may take, by the length of the archive and by the memory that there is.
    left: [u64; 2],
    /// For messages.
    path: &'a Path,
}

/// An array: its shape and its entries by rows.
pub(super) type Shaped<T> = (Vec<u64>, Vec<T>);

impl<'a> ArchiveReader<'a, BufReader<File>> {
    pub(super) fn open(path: &'a Path) -> io::Result<Self> {
        Self::new(BufReader::new(input::open(path)?), path)
    }
}

impl<'a, R: Read + Seek> ArchiveReader<'a, R> {
    /// Reads what is an archive as a whole; `path` is used in errors only.
    pub(super) fn new(mut archive: R, path: &'a Path) -> io::Result<Self> {
        let length = archive.seek(SeekFrom::End(0))?;
        let zip = ZipArchive::new(archive)?;
        // What is read is used, too.
        let left = [most(length), memory::free() / 2];
        Ok(Self { zip, left, path })
    }

    /// An array of so many dimensions.
    pub(super) fn get<T: Number>(
        &mut self,
        name: &'static str,
        dimensions: usize,
    ) -> Result<Shaped<T>, FileError> {
        let found = self.get_if_there(name, dimensions)?;
        found.ok_or_else(|| wrong_array(self.path, name, "it is missing"))
    }

    /// An array of so many dimensions, which need not be there, of integers or floats of any size.
    pub(super) fn numbers_if_there(
        &mut self,
        name: &'static str,
        dimensions: usize,
    ) -> Result<Option<Shaped<f64>>, FileError> {
        let Some(kind) = self.kind_if_there(name)? else {
            return Ok(None);
        };
        let read = match kind.trim_matches(['\'', '"', '<', '>', '|']) {
            f64::KIND => Self::as_floats::<f64>,
            f32::KIND => Self::as_floats::<f32>,
            i64::KIND => Self::as_floats::<i64>,
            i32::KIND => Self::as_floats::<i32>,
            i16::KIND => Self::as_floats::<i16>,
            i8::KIND => Self::as_floats::<i8>,
            u64::KIND => Self::as_floats::<u64>,
            u32::KIND => Self::as_floats::<u32>,
            u16::KIND => Self::as_floats::<u16>,
            u8::KIND => Self::as_floats::<u8>,
            _ => {
                let problem = format!("array `{name}`: its type is {kind}");
                let remedy =
                    "save numbers: `t.astype(float)`, `x.astype(float)`, `faces.astype(int)`";
                return Err(FileError::content(self.path, problem, remedy));
            }
        };
        read(self, name, dimensions).map(Some)
    }

    fn as_floats<T: Number>(
        &mut self,
        name: &'static str,
        dimensions: usize,
    ) -> Result<Shaped<f64>, FileError> {
        let (shape, values) = self.get::<T>(name, dimensions)?;
        Ok((shape, values.into_iter().map(T::as_f64).collect()))
    }

    /// The type of the entries of an array as numpy writes it, if the array is there.
    fn kind_if_there(&mut self, name: &'static str) -> Result<Option<String>, FileError> {
        let error = |problem: String| wrong_array(self.path, name, &problem);
        let mut entry = match self.zip.by_name(&file_of(name)) {
            Err(ZipError::FileNotFound) => return Ok(None),
            other => other.map_err(|e| error(e.to_string()))?,
        };
        let header = Header::read(&mut entry).map_err(|e| error(e.to_string()))?;
        Ok(Some(header.kind))
    }

    /// An array of so many dimensions, which need not be there.
    pub(super) fn get_if_there<T: Number>(
        &mut self,
        name: &'static str,
        dimensions: usize,
    ) -> Result<Option<Shaped<T>>, FileError> {
        let error = |problem: String| wrong_array(self.path, name, &problem);
        let mut entry = match self.zip.by_name(&file_of(name)) {
            Err(ZipError::FileNotFound) => return Ok(None),
            other => other.map_err(|e| error(e.to_string()))?,
        };
        let announced = entry.size();
        let header = Header::read(&mut entry).map_err(|e| error(e.to_string()))?;
        let shape = &header.shape;
        if shape.len() != dimensions {
            return Err(error(format!(
                "it has {} dimensions, {dimensions} expected",
                shape.len()
            )));
        }
        if header.by_columns {
            return Err(error(
                "it is stored by columns; save it with numpy.ascontiguousarray".to_owned(),
            ));
        }
        let expected = shape.iter().try_fold(1u64, |n, &k| n.checked_mul(k));
        let expected =
            expected.ok_or_else(|| error(format!("its shape {shape:?} is impossible")))?;
        let order = header
            .order_of::<T>()
            .ok_or_else(|| error(format!("its type is {}", header.kind)))?;
        let bytes = expected.saturating_mul(size_of::<T>() as u64);
        if bytes > announced {
            return Err(error(format!(
                "its shape {shape:?} needs {bytes} bytes, and it has {announced}"
            )));
        }
        let memory = bytes_read(expected, size_of::<T>());
        let [of_file, free] = self.left;
        if memory > of_file {
            let problem = format!(
                "array `{name}`: it takes {memory} bytes, more than the {of_file} that an archive of this length \
                 may take"
            );
            let remedy = "save the arrays without compression: `numpy.savez`";
            return Err(FileError::content(self.path, problem, remedy));
        }
        if memory > free {
            return Err(error(format!(
                "it needs {memory} bytes, and there is memory for {free}"
            )));
        }
        let mut read = Vec::new();
        let reserved = read.try_reserve_exact(expected as usize);
        reserved.map_err(|e| error(e.to_string()))?;
        let done = read_entries(&mut entry, order, expected as usize, &mut read);
        done.map_err(|e| error(e.to_string()))?;
        self.left = self.left.map(|left| left - memory);
        Ok(Some((header.shape, read)))
    }
}

/// The file of an array in an archive.
fn file_of(array: &str) -> String {
    format!("{array}.npy")
}

/// An array of a file that is missing or of another type or shape.
pub(super) fn wrong_array(path: &Path, name: &str, problem: &str) -> FileError {
    let problem = format!("array `{name}`: {problem}");
    let remedy = "give a trajectory that this program wrote, and that memory can hold";
    FileError::content(path, problem, remedy)
}
