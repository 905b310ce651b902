//! Ctrl-C: the first one asks the work to stop at the next frame, a second one ends the process at once.

use anyhow::Context;
use isosheet_dynamics::{Simulation, StepReport};
use std::ops::ControlFlow;
use std::sync::atomic::{AtomicBool, Ordering};

/// How a command ended when it did not fail.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Outcome {
    /// Everything asked for is there.
    Complete,
    /// Stopped with Ctrl-C; what was finished has been kept.
    Interrupted,
}

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

/// Does pieces of work one after the other until all are done or Ctrl-C ends one of them with
/// [`Interrupted`].
pub(crate) fn each<T>(
    items: impl IntoIterator<Item = T>,
    mut work: impl FnMut(T) -> anyhow::Result<()>,
) -> anyhow::Result<Outcome> {
    for item in items {
        match check()
            .map_err(anyhow::Error::from)
            .and_then(|()| work(item))
        {
            Ok(()) => {}
            Err(error) if error.is::<Interrupted>() => return Ok(Outcome::Interrupted),
            Err(error) => return Err(error),
        }
    }
    Ok(Outcome::Complete)
}
