//! Ctrl-C: the first one asks the work to stop at the next frame, a second one ends the process at once.

use anyhow::Context;
use isosheet_dynamics::{Simulation, StepReport};
use std::ops::ControlFlow;
use std::sync::atomic::{AtomicBool, Ordering};

static REQUESTED: AtomicBool = AtomicBool::new(false);

/// Takes over Ctrl-C.
pub(crate) fn install() -> anyhow::Result<()> {
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
