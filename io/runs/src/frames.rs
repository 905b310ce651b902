//! The frames of a run: one file that grows while it goes on.

use super::RunError;
use super::error::BEGIN_ANEW;
use crc::{CRC_64_XZ, Crc};
use isosheet_files::{FileError, input};
use isosheet_formats::{FrameData, FrameQuantity, MeshCounts, MotionFrame, MotionFrames};
use isosheet_mesh::wording::counted;
use isosheet_scenes::Setup;
use std::fs::File;
use std::io::{self, BufReader, ErrorKind, Read, Seek, SeekFrom, Write};
use std::ops::ControlFlow;
use std::path::{Path, PathBuf};

/// First bytes of the file; the last two are the version of the format.
const MAGIC: &[u8; 8] = b"isofrm02";
/// First bytes of files without bends beside creases.
const WITHOUT_BENDS: &[u8; 8] = b"isofrm01";

/// Sum over a frame.
const SUM: Crc<u64> = Crc::<u64>::new(&CRC_64_XZ);

/// A file of frames of equal length: after the eight bytes `isofrm02`, for each frame time (seconds),
/// positions (`3V`, metres) and, of runs that have them, the forces of the rods (newtons, tension positive),
/// the forces of contact (`3V`, newtons), the gaps of the vertices (metres), the plastic angles of the edges
/// (radians), the plastic curvatures of the faces (`2F`, 1/m) and the bends beside creases (radians for each
/// edge), as little-endian `f64`, and the CRC-64 of these bytes.
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
    /// Of each quantity the values, none in runs without it.
    pub(crate) data: [Vec<f64>; FrameQuantity::COUNT],
}

impl Frame {
    /// The frame of a record without its sum.
    fn of(record: &[u8], shape: FrameShape) -> Self {
        let numbers = record.as_chunks::<8>().0.iter();
        let mut numbers = numbers.map(|bytes| f64::from_le_bytes(*bytes));
        Self {
            t: numbers.next().unwrap_or_default(),
            x: numbers.by_ref().take(shape.coordinates).collect(),
            data: shape.data.map(|n| numbers.by_ref().take(n).collect()),
        }
    }

    /// What the frame has besides positions.
    pub(crate) fn data(&self) -> FrameData<'_> {
        FrameData::each(|quantity| &self.data[quantity as usize])
    }
}

/// How many numbers a frame has.
#[derive(Clone, Copy, Debug)]
pub(crate) struct FrameShape {
    /// `3V`.
    pub(crate) coordinates: usize,
    /// How many numbers each quantity has, zero of what there is not.
    pub(crate) data: [usize; FrameQuantity::COUNT],
}

impl FrameShape {
    /// The shape of the frames of a run.
    pub(crate) fn of(setup: &Setup) -> Self {
        let model = &setup.model;
        let topology = setup.sheet.topology();
        let counts = MeshCounts {
            vertices: topology.vertex_count(),
            edges: topology.edge_count(),
            faces: topology.face_count(),
        };
        let is_there = |quantity| match quantity {
            FrameQuantity::RodForces => setup.has_rod_forces(),
            FrameQuantity::ContactForces | FrameQuantity::Gaps => setup.contacts.is_some(),
            FrameQuantity::PlasticAngles => model.plastic_angles(&model.memories()).is_some(),
            FrameQuantity::PlasticCurvatures => {
                model.plastic_curvatures(&model.memories()).is_some()
            }
            FrameQuantity::CreaseBends => setup.has_creases_in_sheets(),
            // They are made of positions when they are asked for.
            FrameQuantity::Rulings
            | FrameQuantity::RulingCurvatures
            | FrameQuantity::GaussCurvatures => false,
        };
        let size = |q: FrameQuantity| if is_there(q) { q.size(counts) } else { 0 };
        Self {
            coordinates: 3 * counts.vertices,
            data: FrameQuantity::ALL.map(size),
        }
    }

    /// The shape of the frames in a file, which may be of a version that had no bends beside creases. A file
    /// that cannot be read counts as one of the present version.
    pub(crate) fn in_file(mut self, path: &Path) -> Self {
        let mut magic = [0; MAGIC.len()];
        let begun = input::open(path).and_then(|mut file| read_whole(&mut file, &mut magic));
        if begun.is_ok() && magic == *WITHOUT_BENDS {
            self.data[FrameQuantity::CreaseBends as usize] = 0;
        }
        self
    }

    /// Whether frames have a quantity.
    pub(crate) fn has(self, quantity: FrameQuantity) -> bool {
        self.data[quantity as usize] > 0
    }

    /// Length of a frame with its sum.
    pub(crate) fn bytes(self) -> usize {
        8 * (2 + self.coordinates + self.data.iter().sum::<usize>())
    }
}

impl FrameFile {
    /// Starts a new file.
    pub(crate) fn create(path: &Path) -> Result<Self, FileError> {
        let begun = input::replace(path).and_then(|mut file| {
            file.write_all(MAGIC)?;
            Ok(file)
        });
        let file = begun.map_err(|e| FileError::unwritable(path, e))?;
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
    /// [`RunError`] if the file cannot be opened, has fewer frames, or one of them is damaged.
    pub(crate) fn resume(path: &Path, count: u64, shape: FrameShape) -> Result<Self, RunError> {
        let mut frames = Frames::open(path, shape)?;
        for k in 0..count {
            if frames.next_record()?.is_none() {
                let problem = format!("it ends after frame {k}, {count} were written");
                return Err(FileError::content(path, problem, BEGIN_ANEW).into());
            }
        }
        let length = MAGIC.len() as u64 + count * shape.bytes() as u64;
        let opened = input::reopen(path, File::options().write(true));
        let continued = opened.and_then(|mut file| {
            file.set_len(length)?;
            file.seek(SeekFrom::End(0))?;
            Ok(file)
        });
        let file = continued.map_err(|e| FileError::unwritable(path, e))?;
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
    ) -> Result<(), FileError> {
        self.record.clear();
        self.record.extend(t.to_le_bytes());
        let further = FrameQuantity::ALL.map(|quantity| quantity.of(data));
        for numbers in std::iter::once(x).chain(further) {
            let bytes = numbers.iter().flat_map(|c| c.to_le_bytes());
            self.record.extend(bytes);
        }
        let sum = SUM.checksum(&self.record);
        self.record.extend(sum.to_le_bytes());
        let written = self.file.write_all(&self.record);
        written.map_err(|e| FileError::unwritable(&self.path, e))?;
        self.count += 1;
        Ok(())
    }

    /// Takes the last frame back.
    pub(crate) fn take_back(&mut self) -> Result<(), FileError> {
        let end = self.file.stream_position();
        let cut = end.and_then(|end| {
            // All frames have the length of the last one.
            let length = end.saturating_sub(self.record.len() as u64);
            self.file.set_len(length)?;
            self.file.seek(SeekFrom::End(0))
        });
        cut.map_err(|e| FileError::unwritable(&self.path, e))?;
        self.count -= 1;
        Ok(())
    }

    /// Waits until all frames are on the disk.
    pub(crate) fn sync(&self) -> Result<(), FileError> {
        let synced = self.file.sync_data();
        synced.map_err(|e| FileError::unwritable(&self.path, e))
    }
}

/// The frames of a file, one after the other.
struct Frames<'a> {
    path: &'a Path,
    file: BufReader<File>,
    /// How many were read.
    count: u64,
    record: Vec<u8>,
}

impl<'a> Frames<'a> {
    fn open(path: &'a Path, shape: FrameShape) -> Result<Self, FileError> {
        let read = |source: io::Error| match source.kind() {
            ErrorKind::NotFound => {
                let problem = "it is missing, which has the frames of the run";
                FileError::content(path, problem, BEGIN_ANEW)
            }
            _ => FileError::unreadable(path, source),
        };
        let mut file = BufReader::new(input::open(path).map_err(read)?);
        let mut magic = [0; MAGIC.len()];
        let found = read_whole(&mut file, &mut magic).map_err(read)?;
        let is_older = magic == *WITHOUT_BENDS && !shape.has(FrameQuantity::CreaseBends);
        if !found || !(magic == *MAGIC || is_older) {
            let problem = "it is not a file of frames of this version";
            return Err(FileError::content(path, problem, BEGIN_ANEW));
        }
        Ok(Self {
            path,
            file,
            count: 0,
            record: vec![0; shape.bytes()],
        })
    }

    /// The numbers of the next frame as bytes; none at the end of the file, where the last frame may be a
    /// part of one.
    fn next_record(&mut self) -> Result<Option<&[u8]>, FileError> {
        let found = read_whole(&mut self.file, &mut self.record);
        if !found.map_err(|source| FileError::unreadable(self.path, source))? {
            return Ok(None);
        }
        let frame = self.count;
        self.count += 1;
        match self.record.split_last_chunk::<8>() {
            Some((numbers, sum)) if SUM.checksum(numbers).to_le_bytes() == *sum => {
                Ok(Some(numbers))
            }
            _ => {
                let problem = format!("frame {frame} is damaged, its checksum is wrong");
                let remedy = "give the `simulate` command again, which takes up a run that is not complete at its \
                              last checkpoint; if it names the same frame, run the scene again with --force";
                Err(FileError::content(self.path, problem, remedy))
            }
        }
    }
}

/// Fills a buffer; false where the file ends before.
fn read_whole(file: &mut impl Read, buffer: &mut [u8]) -> io::Result<bool> {
    match file.read_exact(buffer) {
        Ok(()) => Ok(true),
        Err(error) if error.kind() == ErrorKind::UnexpectedEof => Ok(false),
        Err(error) => Err(error),
    }
}

/// The whole frames of a file, of which one is in memory at a time.
#[derive(Clone, Debug)]
pub(crate) struct StoredFrames {
    pub(crate) path: PathBuf,
    pub(crate) shape: FrameShape,
    /// The least number of frames: for a complete run the number in its summary, and 0 for a run in progress.
    pub(crate) least: u64,
}

impl MotionFrames for StoredFrames {
    type Error = RunError;

    fn each(
        &self,
        show: &mut dyn FnMut(&MotionFrame<'_>) -> ControlFlow<()>,
    ) -> Result<(), RunError> {
        let mut frames = Frames::open(&self.path, self.shape)?;
        let mut number = 0;
        while let Some(record) = frames.next_record()? {
            let frame = Frame::of(record, self.shape);
            let shown = show(&MotionFrame {
                number,
                t: frame.t,
                x: &frame.x,
                data: frame.data(),
                fields: &[],
            });
            if shown.is_break() {
                return Ok(());
            }
            number += 1;
        }
        Ok(check_whole(&self.path, "frame", number as u64, self.least)?)
    }
}

/// Refuses a file of a complete run that has fewer frames or rows than the summary of the run says.
///
/// # Errors
/// [`FileError`] with both numbers.
pub(super) fn check_whole(
    path: &Path,
    what: &str,
    found: u64,
    least: u64,
) -> Result<(), FileError> {
    if found >= least {
        return Ok(());
    }
    let problem = format!(
        "it ends after {}, and the complete run has {least} by its summary",
        counted(found as usize, what, &format!("{what}s"))
    );
    let remedy = "copy the file again from where it is whole, or run the scene again with --force, which replaces the \
                  run; of frames.bin and trajectory.npz the one that is cut off may be deleted if the other is whole";
    Err(FileError::content(path, problem, remedy))
}

#[cfg(test)]
mod tests {
    use super::*;
    use isosheet_mesh::Advice;

    fn read_frames(path: &Path, shape: FrameShape) -> Result<Vec<Frame>, RunError> {
        let path = path.to_owned();
        let mut all = Vec::new();
        StoredFrames {
            path,
            shape,
            least: 0,
        }
        .each(&mut |frame| {
            all.push(Frame {
                t: frame.t,
                x: frame.x.to_vec(),
                data: FrameQuantity::ALL.map(|quantity| quantity.of(&frame.data).to_vec()),
            });
            ControlFlow::Continue(())
        })?;
        Ok(all)
    }

    #[test]
    fn frames_come_back_and_continue_where_they_are_told() {
        let dir = tempfile::tempdir().unwrap();
        let path = dir.path().join("frames.bin");
        let shape = FrameShape {
            coordinates: 6,
            data: [1, 6, 2, 1, 2, 1, 0, 0, 0],
        };
        let frame = |k: usize| Frame {
            t: k as f64 / 3.0,
            x: (0..6).map(|i| (k * 6 + i) as f64 / 7.0).collect(),
            data: [
                vec![k as f64 - 0.5],
                (0..6).map(|i| (k + i) as f64 / 11.0).collect(),
                vec![1e-3, k as f64 * 1e-4],
                vec![k as f64 + 0.1],
                vec![k as f64 + 30.0, -0.2],
                vec![k as f64 - 0.3],
                Vec::new(),
                Vec::new(),
                Vec::new(),
            ],
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

    #[test]
    fn every_damaged_byte_is_noticed() {
        let dir = tempfile::tempdir().unwrap();
        let path = dir.path().join("frames.bin");
        let shape = FrameShape {
            coordinates: 3,
            data: [0; FrameQuantity::COUNT],
        };
        let mut file = FrameFile::create(&path).unwrap();
        for k in 0..3 {
            file.append(f64::from(k), &[1.0, 2.0, 3.0], &FrameData::default())
                .unwrap();
        }
        let whole = std::fs::read(&path).unwrap();
        assert_eq!(whole.len(), MAGIC.len() + 3 * shape.bytes());
        for at in 0..whole.len() {
            let mut damaged = whole.clone();
            damaged[at] ^= 0x10;
            std::fs::write(&path, &damaged).unwrap();
            let error = read_frames(&path, shape).unwrap_err();
            let of_frame = at.checked_sub(MAGIC.len()).map(|at| at / shape.bytes());
            let says = match of_frame {
                None => "it is not a file of frames".to_owned(),
                Some(frame) => format!(": frame {frame} is damaged"),
            };
            assert!(error.to_string().contains(&says), "byte {at}: {error}");
            assert!(error.advice().is_some());
            // What follows the frames that a run continues after does not count.
            let resumed = FrameFile::resume(&path, 1, shape);
            assert_eq!(
                resumed.is_ok(),
                of_frame.is_some_and(|k| k >= 1),
                "byte {at}"
            );
        }
        // As versions without sums wrote it.
        std::fs::write(&path, &whole[MAGIC.len()..]).unwrap();
        let error = read_frames(&path, shape).unwrap_err();
        assert!(error.to_string().contains("of this version"), "{error}");
    }
}
