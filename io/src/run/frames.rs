//! The frames of a run while it goes on: one file that grows.

use crate::format::{FrameData, WriteError};
use crate::scene::Setup;
use std::fs::File;
use std::io::{self, Seek, SeekFrom, Write};
use std::path::{Path, PathBuf};

/// A file of frames of equal length: time (seconds), positions (`3V`, metres) and, of runs that have them,
/// the forces of the rods (newtons, tension positive), the forces of contact (`3V`, newtons) and the gaps of
/// the vertices (metres), little-endian `f64`.
#[derive(Debug)]
pub(crate) struct FrameFile {
    path: PathBuf,
    file: File,
    count: u64,
    /// One frame as bytes.
    record: Vec<u8>,
}

/// One frame.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Frame {
    pub(crate) t: f64,
    pub(crate) x: Vec<f64>,
    /// Empty in runs without them.
    pub(crate) rod_forces: Vec<f64>,
    /// Empty in runs without contact.
    pub(crate) contact_forces: Vec<f64>,
    /// Empty in runs without contact.
    pub(crate) gaps: Vec<f64>,
}

impl Frame {
    /// What the frame has besides positions.
    pub(crate) fn data(&self) -> FrameData<'_> {
        FrameData {
            rod_forces: &self.rod_forces,
            contact_forces: &self.contact_forces,
            gaps: &self.gaps,
        }
    }
}

/// How many numbers a frame has.
#[derive(Clone, Copy, Debug)]
pub(crate) struct FrameShape {
    /// `3V`.
    pub(crate) coordinates: usize,
    /// One for each rod, or zero.
    pub(crate) rod_forces: usize,
    /// One for each vertex, or zero. There are three times as many numbers of forces of contact.
    pub(crate) gaps: usize,
}

impl FrameShape {
    /// That of the frames of a run.
    pub(crate) fn of(setup: &Setup) -> Self {
        let coordinates = setup.start.x.len();
        let if_there = |is_there: bool, count: usize| if is_there { count } else { 0 };
        Self {
            coordinates,
            rod_forces: if_there(setup.has_rod_forces(), setup.model.rods().len()),
            gaps: if_there(setup.contacts.is_some(), coordinates / 3),
        }
    }

    fn bytes(self) -> usize {
        8 * (1 + self.coordinates + self.rod_forces + 4 * self.gaps)
    }
}

impl FrameFile {
    /// Starts a new file.
    pub(crate) fn create(path: &Path) -> Result<Self, WriteError> {
        let file = File::create(path).map_err(|source| WriteError::Write {
            path: path.to_owned(),
            source,
        })?;
        Ok(Self {
            path: path.to_owned(),
            file,
            count: 0,
            record: Vec::new(),
        })
    }

    /// Continues a file after its first `count` frames; what follows them is cut off.
    ///
    /// # Errors
    /// [`io::Error`] if the file cannot be opened or has fewer frames.
    pub(crate) fn resume(path: &Path, count: u64, shape: FrameShape) -> io::Result<Self> {
        let mut file = File::options().write(true).open(path)?;
        let length = count * shape.bytes() as u64;
        let found = file.metadata()?.len();
        if found < length {
            let problem = format!("it has {found} bytes, {length} were written");
            return Err(io::Error::other(problem));
        }
        file.set_len(length)?;
        file.seek(SeekFrom::End(0))?;
        Ok(Self {
            path: path.to_owned(),
            file,
            count,
            record: Vec::new(),
        })
    }

    /// Number of frames.
    pub(crate) fn count(&self) -> u64 {
        self.count
    }

    /// Adds a frame.
    pub(crate) fn append(
        &mut self,
        t: f64,
        x: &[f64],
        data: &FrameData<'_>,
    ) -> Result<(), WriteError> {
        self.record.clear();
        self.record.extend(t.to_le_bytes());
        for numbers in [x, data.rod_forces, data.contact_forces, data.gaps] {
            let bytes = numbers.iter().flat_map(|c| c.to_le_bytes());
            self.record.extend(bytes);
        }
        let written = self.file.write_all(&self.record);
        written.map_err(|source| self.failed(source))?;
        self.count += 1;
        Ok(())
    }

    /// Waits until all frames are on the disk.
    pub(crate) fn sync(&self) -> Result<(), WriteError> {
        self.file.sync_data().map_err(|source| self.failed(source))
    }

    fn failed(&self, source: io::Error) -> WriteError {
        WriteError::Write {
            path: self.path.clone(),
            source,
        }
    }
}

/// Reads all whole frames.
pub(crate) fn read_frames(path: &Path, shape: FrameShape) -> io::Result<Vec<Frame>> {
    let bytes = std::fs::read(path)?;
    let frame = |record: &[u8]| {
        let mut numbers = record
            .as_chunks::<8>()
            .0
            .iter()
            .map(|b| f64::from_le_bytes(*b));
        Frame {
            t: numbers.next().unwrap_or_default(),
            x: numbers.by_ref().take(shape.coordinates).collect(),
            rod_forces: numbers.by_ref().take(shape.rod_forces).collect(),
            contact_forces: numbers.by_ref().take(3 * shape.gaps).collect(),
            gaps: numbers.collect(),
        }
    };
    let records = bytes.chunks_exact(shape.bytes());
    Ok(records.map(frame).collect())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn frames_come_back_and_continue_where_they_are_told() {
        let dir = tempfile::tempdir().unwrap();
        let path = dir.path().join("frames.bin");
        let shape = FrameShape {
            coordinates: 6,
            rod_forces: 1,
            gaps: 2,
        };
        let frame = |k: usize| Frame {
            t: k as f64 / 3.0,
            x: (0..6).map(|i| (k * 6 + i) as f64 / 7.0).collect(),
            rod_forces: vec![k as f64 - 0.5],
            contact_forces: (0..6).map(|i| (k + i) as f64 / 11.0).collect(),
            gaps: vec![1e-3, k as f64 * 1e-4],
        };
        let add =
            |file: &mut FrameFile, frame: &Frame| file.append(frame.t, &frame.x, &frame.data());
        let mut file = FrameFile::create(&path).unwrap();
        for k in 0..4 {
            add(&mut file, &frame(k)).unwrap();
        }
        file.sync().unwrap();
        let frames = read_frames(&path, shape).unwrap();
        assert_eq!(frames, (0..4).map(frame).collect::<Vec<_>>());
        // Half a frame, as a full disk leaves it.
        File::options()
            .append(true)
            .open(&path)
            .unwrap()
            .write_all(&[1; 20])
            .unwrap();
        assert_eq!(read_frames(&path, shape).unwrap(), frames);
        let mut resumed = FrameFile::resume(&path, 2, shape).unwrap();
        add(&mut resumed, &frame(2)).unwrap();
        assert_eq!(resumed.count(), 3);
        assert_eq!(read_frames(&path, shape).unwrap(), frames[..3]);
        assert!(FrameFile::resume(&path, 4, shape).is_err());
    }
}
