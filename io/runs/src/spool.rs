//! The frames of a page on the disk, while the page is made.

use super::RunError;
use super::frame_field::{FrameField, check_frame};
use isosheet_files::FileError;
use isosheet_formats::{FrameData, MotionFrame, MotionFrames};
use isosheet_mesh::Sheet;
use isosheet_page::no_frames;
use isosheet_scenes::bounds;
use std::fs::File;
use std::io::{self, BufReader, BufWriter, Read, Seek, Write};
use std::ops::ControlFlow;
use std::path::{Path, PathBuf};

/// Positions and values of fields of all frames in a file without a name, which ends with the process. They
/// are computed once, and a page needs them several times.
pub(super) struct Spool {
    folder: PathBuf,
    file: File,
    /// How many numbers a frame has of each list: positions, and the values of each field.
    sizes: Vec<usize>,
    /// Times of the frames, seconds.
    pub(super) times: Vec<f64>,
    /// The lower and the upper corner of the box of all positions, metres.
    pub(super) corners: [[f64; 3]; 2],
}

impl Spool {
    /// Writes what a page shows of the frames of a motion to a file in a folder.
    pub(super) fn of<M: MotionFrames<Error = RunError>>(
        motion: &M,
        sheet: &Sheet,
        fields: &[FrameField<'_>],
        folder: &Path,
    ) -> Result<Self, RunError> {
        let unwritable = |source| RunError::Unwritable {
            folder: folder.to_owned(),
            source,
        };
        let mut spool = Self {
            folder: folder.to_owned(),
            file: tempfile::tempfile_in(folder).map_err(unwritable)?,
            sizes: Vec::new(),
            times: Vec::new(),
            corners: bounds([]),
        };
        let mut file = BufWriter::new(spool.file.try_clone().map_err(unwritable)?);
        let mut done = Ok(());
        motion.each(&mut |frame| {
            done = check_frame(frame, sheet)
                .map_err(RunError::from)
                .and_then(|()| spool.add(frame, fields, &mut file).map_err(unwritable));
            match done {
                Ok(()) => ControlFlow::Continue(()),
                Err(_) => ControlFlow::Break(()),
            }
        })?;
        done?;
        file.flush().map_err(unwritable)?;
        Ok(spool)
    }

    fn add(
        &mut self,
        frame: &MotionFrame<'_>,
        fields: &[FrameField<'_>],
        file: &mut impl Write,
    ) -> io::Result<()> {
        let mut sizes = vec![write_numbers(file, frame.x)?];
        for field in fields {
            sizes.push(write_numbers(file, &field.values(frame))?);
        }
        self.sizes = sizes;
        let own = bounds(frame.x.as_chunks::<3>().0);
        self.corners = match self.times.is_empty() {
            true => own,
            false => bounds(self.corners.iter().chain(&own)),
        };
        self.times.push(frame.t);
        Ok(())
    }
}

/// Writes numbers, and returns how many there are.
fn write_numbers(file: &mut impl Write, numbers: &[f64]) -> io::Result<usize> {
    for number in numbers {
        file.write_all(&number.to_le_bytes())?;
    }
    Ok(numbers.len())
}

impl MotionFrames for Spool {
    type Error = RunError;

    fn each(
        &self,
        show: &mut dyn FnMut(&MotionFrame<'_>) -> ControlFlow<()>,
    ) -> Result<(), RunError> {
        let unreadable = |source| FileError::unreadable(&self.folder, source);
        let mut file = BufReader::new(&self.file);
        file.rewind().map_err(unreadable)?;
        let mut bytes = vec![0; 8 * self.sizes.iter().sum::<usize>()];
        for (number, &t) in self.times.iter().enumerate() {
            file.read_exact(&mut bytes).map_err(unreadable)?;
            let numbers = bytes.as_chunks::<8>().0.iter();
            let numbers: Vec<f64> = numbers.map(|bytes| f64::from_le_bytes(*bytes)).collect();
            let mut rest = &numbers[..];
            let lists = self.sizes.iter().map(|&size| {
                let (list, further) = rest.split_at(size);
                rest = further;
                list
            });
            let lists: Vec<&[f64]> = lists.collect();
            let Some((x, fields)) = lists.split_first() else {
                return Err(no_frames().into());
            };
            let frame = MotionFrame {
                number,
                t,
                x,
                data: FrameData::default(),
                fields,
            };
            if show(&frame).is_break() {
                break;
            }
        }
        Ok(())
    }
}
