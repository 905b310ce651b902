//! Motions whose frames need not all be in memory.

use super::data::FrameData;
use isosheet_files::FileError;
use std::convert::Infallible;
use std::ops::ControlFlow;

/// A frame of a motion.
#[derive(Clone, Copy, Debug)]
pub struct MotionFrame<'a> {
    /// Its number, from 0.
    pub number: usize,
    /// Time, seconds.
    pub t: f64,
    /// Positions (length 3V, metres).
    pub x: &'a [f64],
    /// What it has besides.
    pub data: FrameData<'a>,
    /// The values of the fields of a page, where it is shown on one.
    pub fields: &'a [&'a [f64]],
}

/// Frames that are shown one after the other, as often as they are asked for.
pub trait MotionFrames {
    /// Why a frame cannot be shown.
    type Error;

    /// Shows the frames in their order, until `show` breaks.
    fn each(
        &self,
        show: &mut dyn FnMut(&MotionFrame<'_>) -> ControlFlow<()>,
    ) -> Result<(), Self::Error>;
}

/// Why the frames of a motion cannot be written.
#[derive(Debug)]
pub enum WriteMotionError<E> {
    /// One of them cannot be shown.
    Frame(E),
    /// They are no trajectory, or it cannot be written.
    Trajectory(FileError),
}

impl<E> From<FileError> for WriteMotionError<E> {
    fn from(error: FileError) -> Self {
        Self::Trajectory(error)
    }
}

impl From<WriteMotionError<Infallible>> for FileError {
    fn from(error: WriteMotionError<Infallible>) -> Self {
        match error {
            WriteMotionError::Frame(never) => match never {},
            WriteMotionError::Trajectory(error) => error,
        }
    }
}
