//! Ctrl-C: the first one asks the work to stop at the next frame, a second one ends the process at once.

use anyhow::{Context, Result};
use isosheet_dynamics::{Simulation, StepReport};
use isosheet_io::Advice;
use std::ops::ControlFlow;
use std::sync::atomic::{AtomicBool, Ordering};

static REQUESTED: AtomicBool = AtomicBool::new(false);

/// Takes over Ctrl-C.
pub(crate) fn install() -> Result<()> {
    ctrlc::set_handler(|| {
        if REQUESTED.swap(true, Ordering::SeqCst) {
            std::process::exit(130);
        }
    })
    .context("cannot take over Ctrl-C")
}

/// Whether Ctrl-C was pressed.
pub(crate) fn requested() -> bool {
    REQUESTED.load(Ordering::SeqCst)
}

/// The error by which a long computation gives up when [`requested`].
#[derive(Clone, Copy, Debug, thiserror::Error)]
#[error("stopped by Ctrl-C")]
pub(crate) struct Interrupted;

impl Advice for Interrupted {
    fn advice(&self) -> Option<&'static str> {
        Some("the same command goes on from what was finished and kept")
    }
}

/// [`Interrupted`] when Ctrl-C was pressed.
pub(crate) fn check() -> Result<(), Interrupted> {
    if requested() {
        Err(Interrupted)
    } else {
        Ok(())
    }
}

/// An observer that ends a run after the step in which Ctrl-C was pressed. [`check`] says whether it did.
pub(crate) fn observe(_simulation: &Simulation, _report: &StepReport) -> ControlFlow<()> {
    if requested() {
        ControlFlow::Break(())
    } else {
        ControlFlow::Continue(())
    }
}

/// What follows work that may have been stopped by Ctrl-C: a page of what is there. Other errors end the
/// command without it.
pub(crate) fn afterwards(work: Result<()>, page: impl FnOnce() -> Result<()>) -> Result<()> {
    match work {
        Err(error) if !error.is::<Interrupted>() => Err(error),
        work => page().and(work),
    }
}
