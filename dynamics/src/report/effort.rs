//! Counters of a step, with its watch and its trace.

use isosheet_model::Reason;
use isosheet_model::TraceEvent;
use std::fmt;
use std::ops::ControlFlow;

/// Progress of a step under way, see [`Simulation::step_watched`](crate::Simulation::step_watched).
#[derive(Debug, Clone, Copy, PartialEq)]
#[non_exhaustive]
pub struct StepProgress {
    /// End of the accepted sub-steps, seconds.
    pub t: f64,
    /// Newton iterations, rejected sub-steps included.
    pub iterations: usize,
    /// Matrix factorisations, rejected sub-steps included.
    pub factorisations: usize,
}

/// Decides before each factorisation whether a step continues.
pub(crate) type Watch<'w> = &'w mut dyn FnMut(&StepProgress) -> ControlFlow<()>;

/// Receives the events of a trace.
pub(crate) type TraceSink = dyn FnMut(&TraceEvent) + Send;

/// Counters of a step, rejected sub-steps included.
#[derive(Default)]
pub(crate) struct SolverEffort<'w> {
    /// Newton iterations.
    pub(crate) iterations: usize,
    /// Matrix factorisations.
    pub(crate) factorisations: usize,
    /// Start of the sub-step, seconds.
    pub(crate) t: f64,
    watch: Option<Watch<'w>>,
    sink: Option<&'w mut TraceSink>,
    is_interrupted: bool,
    /// Factorisations when it last began.
    begun: usize,
    /// Largest number of factorisations from there on.
    limit: Option<usize>,
    is_spent: bool,
}

impl<'w> SolverEffort<'w> {
    /// Counters at zero, with a watch and a trace.
    pub(crate) fn new(watch: Option<Watch<'w>>, sink: Option<&'w mut TraceSink>) -> Self {
        Self {
            watch,
            sink,
            ..Self::default()
        }
    }

    /// Whether events are traced.
    pub(crate) fn is_traced(&self) -> bool {
        self.sink.is_some()
    }

    /// Traces an event; it is not computed without a trace.
    pub(crate) fn trace(&mut self, event: impl FnOnce() -> TraceEvent) {
        if let Some(sink) = &mut self.sink {
            sink(&event());
        }
    }

    /// The cause of a failure: [`Reason::Ended`] if the iteration was ended, else the one given.
    pub(crate) fn failed(&self, reason: Reason) -> Reason {
        match self.is_spent || self.is_interrupted {
            true => Reason::Ended,
            false => reason,
        }
    }

    /// Whether the watch ended the step; later proposals are meaningless.
    pub(crate) fn is_interrupted(&self) -> bool {
        self.is_interrupted
    }

    /// Begins at a state, with a limit of factorisations until the next one.
    pub(crate) fn begin(&mut self, limit: Option<usize>) {
        self.begun = self.factorisations;
        self.limit = limit;
        self.is_spent = false;
    }

    /// Removes the limit until the next accepted state.
    pub(crate) fn lift_limit(&mut self) {
        self.limit = None;
        self.is_spent = false;
    }

    /// Factorisations since the last accepted state.
    pub(crate) fn spent(&self) -> usize {
        self.factorisations - self.begun
    }

    /// Whether the limit was reached; later proposals are meaningless.
    pub(crate) fn is_spent(&self) -> bool {
        self.is_spent
    }

    /// Whether the watch lets the step continue; once refused, the answer stays.
    pub(crate) fn goes_on(&mut self) -> bool {
        let progress = StepProgress {
            t: self.t,
            iterations: self.iterations,
            factorisations: self.factorisations,
        };
        if let Some(watch) = &mut self.watch
            && !self.is_interrupted
        {
            self.is_interrupted = watch(&progress).is_break();
        }
        !self.is_interrupted
    }

    /// Counts the next factorisation; false if the step has ended.
    pub(crate) fn count_factorisation(&mut self) -> bool {
        self.is_spent |= self.limit.is_some_and(|limit| self.spent() >= limit);
        let goes_on = !self.is_spent && self.goes_on();
        self.factorisations += usize::from(goes_on);
        goes_on
    }
}

impl fmt::Debug for SolverEffort<'_> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.debug_struct("SolverEffort")
            .field("iterations", &self.iterations)
            .field("factorisations", &self.factorisations)
            .field("is_interrupted", &self.is_interrupted)
            .finish_non_exhaustive()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{EnergyMomentumOptions, Method, SheetModel, Simulation, State, StepError};
    use crate::{RattleOptions, leave_flat};
    use isosheet_mesh::{MassKind, VertexId, generate};

    const H: f64 = 1.0 / 240.0;

    /// A folded sheet that hangs at a corner.
    fn hanging(method: Method) -> Simulation {
        let sheet = generate::isotropic_square(2, 0.21).unwrap();
        let model = SheetModel::new(&sheet, 3.5e-3, MassKind::Lumped)
            .unwrap()
            .with_gravity()
            .with_pins(&[VertexId(0)])
            .unwrap();
        let mut x = sheet.positions().to_vec();
        leave_flat(&model, &mut x, 0.1, 1).unwrap();
        Simulation::new(model, State::at_rest(x), method).unwrap()
    }

    fn methods() -> Vec<Method> {
        vec![
            Method::default(),
            Method::ImplicitEuler(crate::ImplicitOptions::default()),
            Method::EnergyMomentum(EnergyMomentumOptions::default()),
            Method::Rattle(RattleOptions::default()),
        ]
    }

    /// A watch sees the work grow and changes nothing; wherever it ends a step, the state is that of the last
    /// sub-step, and from there the motion goes on as if it had never been interrupted.
    #[test]
    fn an_interrupted_step_leaves_no_trace() {
        for method in methods() {
            let mut plain = hanging(method.clone());
            let mut watched = hanging(method.clone());
            let mut interrupted = hanging(method.clone());
            for _ in 0..2 {
                let mut seen: Vec<StepProgress> = Vec::new();
                let mut watch = |progress: &StepProgress| {
                    seen.push(*progress);
                    ControlFlow::Continue(())
                };
                let report = watched.step_watched(H, &mut watch).unwrap();
                assert_eq!(plain.step(H).unwrap(), report);
                assert!(!seen.is_empty(), "{method:?}");
                assert!(seen.is_sorted_by_key(|p| p.factorisations + p.iterations));
                let last = seen.last().unwrap();
                assert!(last.factorisations <= report.factorisations);
                for end in 0..seen.len().min(12) {
                    let start = interrupted.state().clone();
                    let mut asked = 0;
                    let mut watch = |_: &StepProgress| {
                        asked += 1;
                        match asked > end {
                            true => ControlFlow::Break(()),
                            false => ControlFlow::Continue(()),
                        }
                    };
                    let error = interrupted.step_watched(H, &mut watch).unwrap_err();
                    assert_eq!(error, StepError::Interrupted { t: start.t });
                    assert_eq!(interrupted.state(), &start);
                    assert_eq!(
                        asked,
                        end + 1,
                        "a watch that has ended a step is not asked again"
                    );
                }
                interrupted.step(H).unwrap();
                assert_eq!(interrupted.state(), plain.state());
            }
        }
    }
}
