//! Ctrl-C: the first one asks the work to stop at the next frame, a second one ends the process at once.

use anyhow::{Context, Result};
use isosheet_dynamics::{Simulation, StepReport};
use isosheet_runs as run;
use isosheet_runs::{Outcome, RunError, StepPart, Summary, Tick, Watch};
use isosheet_scenes::SceneFile;
use std::ops::ControlFlow;
use std::path::Path;
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
#[error("stopped by Ctrl-C; the same command goes on from what was finished and kept")]
pub(crate) struct Interrupted;

/// [`Interrupted`] when Ctrl-C was pressed.
pub(crate) fn check() -> Result<(), Interrupted> {
    if requested() {
        Err(Interrupted)
    } else {
        Ok(())
    }
}

/// Whether work goes on: until [`requested`].
pub(crate) fn flow() -> ControlFlow<()> {
    match requested() {
        true => ControlFlow::Break(()),
        false => ControlFlow::Continue(()),
    }
}

/// An observer that ends a run after the step in which Ctrl-C was pressed. [`check`] says whether it did.
pub(crate) fn observe(_simulation: &Simulation, _report: &StepReport) -> ControlFlow<()> {
    flow()
}

/// Runs a scene in a folder until its end, unless [`requested`]: then within a step. `step` sees every step.
///
/// # Errors
/// [`Interrupted`]; what went wrong with the run stands inside.
pub(crate) fn simulate(
    file: &SceneFile,
    folder: &Path,
    step: &mut dyn FnMut(&Tick),
) -> Result<Result<Summary, RunError>, Interrupted> {
    struct Watching<'a>(&'a mut dyn FnMut(&Tick));
    impl Watch for Watching<'_> {
        fn within_step(&mut self, _: &StepPart) -> ControlFlow<()> {
            flow()
        }

        fn step(&mut self, tick: &Tick) -> ControlFlow<()> {
            (self.0)(tick);
            flow()
        }
    }
    match run::simulate(file, folder, &mut Watching(step)) {
        Ok(Outcome::Complete(summary) | Outcome::AlreadyComplete(summary)) => Ok(Ok(*summary)),
        Ok(Outcome::Interrupted) => Err(Interrupted),
        Err(error) => Ok(Err(error)),
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
