//! Which frames of a motion a page shows.

use isosheet_files::DataError;
use isosheet_formats::{MotionFrame, MotionFrames};
use std::ops::ControlFlow;

/// Which frames of a run are kept: every `stride`-th one and the last one.
#[derive(Clone, Copy, Debug)]
pub(super) struct KeptFrames {
    /// The number of all frames, at least one.
    pub(super) frames: usize,
    pub(super) stride: usize,
}

impl KeptFrames {
    fn has(self, frame: usize) -> bool {
        frame < self.frames && (frame.is_multiple_of(self.stride) || frame + 1 == self.frames)
    }

    /// Their numbers.
    pub(super) fn numbers(self) -> impl Iterator<Item = usize> + Clone {
        (0..self.frames).filter(move |&frame| self.has(frame))
    }

    /// Shows the frames of a motion, in their order, until `show` breaks.
    pub(super) fn each<M: MotionFrames>(
        self,
        motion: &M,
        show: &mut dyn FnMut(&MotionFrame<'_>) -> ControlFlow<()>,
    ) -> Result<(), M::Error> {
        motion.each(&mut |frame| match self.has(frame.number) {
            true => show(frame),
            false => ControlFlow::Continue(()),
        })
    }

    /// Shows the frames of a motion, in their order, until `show` fails.
    pub(super) fn try_each<M: MotionFrames<Error: From<DataError>>>(
        self,
        motion: &M,
        mut show: impl FnMut(&MotionFrame<'_>) -> Result<(), DataError>,
    ) -> Result<(), M::Error> {
        let mut done = Ok(());
        self.each(motion, &mut |frame| {
            done = show(frame);
            match done {
                Ok(()) => ControlFlow::Continue(()),
                Err(_) => ControlFlow::Break(()),
            }
        })?;
        Ok(done?)
    }
}
