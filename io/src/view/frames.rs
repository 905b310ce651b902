//! The frames of a page, which need not all be in memory.

use super::error::ViewError;
use std::ops::ControlFlow;

/// Which frames of a run are kept: every `stride`-th one and the last one.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Kept {
    /// The number of all frames, at least one.
    pub(crate) frames: usize,
    pub(crate) stride: usize,
}

impl Kept {
    fn has(self, frame: usize) -> bool {
        frame < self.frames && (frame.is_multiple_of(self.stride) || frame + 1 == self.frames)
    }

    /// Their numbers.
    pub(crate) fn numbers(self) -> impl Iterator<Item = usize> + Clone {
        (0..self.frames).filter(move |&frame| self.has(frame))
    }
}

/// What a page shows of a frame.
pub(crate) struct ShownFrame<'a> {
    /// Its number in the run, from 0.
    pub(crate) number: usize,
    /// Positions (length 3V, metres).
    pub(crate) x: &'a [f64],
    /// The values of each field of the page.
    pub(crate) values: &'a [&'a [f64]],
}

/// Frames of a page, which are shown one after the other, as often as they are asked for.
pub(crate) trait ShownFrames {
    /// Why a frame cannot be shown.
    type Error: From<ViewError>;

    /// Shows the frames that are kept, in their order, until `show` breaks.
    fn each(
        &self,
        kept: Kept,
        show: &mut dyn FnMut(&ShownFrame<'_>) -> ControlFlow<()>,
    ) -> Result<(), Self::Error>;

    /// Shows the frames that are kept, in their order, until `show` fails.
    fn try_each(
        &self,
        kept: Kept,
        mut show: impl FnMut(&ShownFrame<'_>) -> Result<(), ViewError>,
    ) -> Result<(), Self::Error>
    where
        Self: Sized,
    {
        let mut done = Ok(());
        self.each(kept, &mut |frame| {
            done = show(frame);
            match done {
                Ok(()) => ControlFlow::Continue(()),
                Err(_) => ControlFlow::Break(()),
            }
        })?;
        Ok(done?)
    }
}
