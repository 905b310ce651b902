//! Signals of Python while Rust computes.

use isosheet_runs::{StepPart, Tick, Watch};
use pyo3::prelude::*;
use std::ops::ControlFlow;
use std::time::{Duration, Instant};

/// Asks Python now and then whether Ctrl-C was pressed.
#[derive(Default)]
pub(crate) struct Signals {
    asked: Option<Instant>,
    /// The exception of a handler of signals, once it has been raised.
    pub(crate) raised: Option<PyErr>,
}

/// Time between two questions: nobody notices a tenth of a second, and a thread of Python that computes hands
/// over the interpreter every 5 ms.
const PATIENCE: Duration = Duration::from_millis(100);

impl Signals {
    /// Whether to go on.
    pub(crate) fn ask(&mut self) -> ControlFlow<()> {
        let now = Instant::now();
        if *self.asked.get_or_insert(now) + PATIENCE > now {
            return ControlFlow::Continue(());
        }
        self.asked = Some(now);
        match Python::attach(|py| py.check_signals()) {
            Ok(()) => ControlFlow::Continue(()),
            Err(error) => {
                self.raised = Some(error);
                ControlFlow::Break(())
            }
        }
    }
}

impl Watch for Signals {
    fn within_step(&mut self, _part: &StepPart) -> ControlFlow<()> {
        self.ask()
    }

    fn step(&mut self, _tick: &Tick) -> ControlFlow<()> {
        self.ask()
    }
}
