//! Runs of equal steps with observers.

use crate::report::effort::StepProgress;
use crate::report::step_report::StepReport;
use crate::{Simulation, State};
use isosheet_model::StepError;
use std::ops::ControlFlow;

/// Observer of a run; closures `FnMut(&Simulation, &StepReport) -> ControlFlow<()>` are observers.
pub trait Observer {
    /// Called once before the first step.
    fn start(&mut self, _simulation: &Simulation) {}

    /// Called after every step. [`ControlFlow::Break`] ends the run after this step.
    fn step(&mut self, simulation: &Simulation, report: &StepReport) -> ControlFlow<()>;

    /// Called before each factorisation within a step, see [`Simulation::step_watched`].
    /// [`ControlFlow::Break`] ends the run there, with [`StepError::Interrupted`].
    fn within(&mut self, _progress: &StepProgress) -> ControlFlow<()> {
        ControlFlow::Continue(())
    }
}

impl<F: FnMut(&Simulation, &StepReport) -> ControlFlow<()>> Observer for F {
    fn step(&mut self, simulation: &Simulation, report: &StepReport) -> ControlFlow<()> {
        self(simulation, report)
    }
}

/// Keeps the initial state and every n-th one.
#[derive(Debug, Clone, PartialEq)]
pub struct Frames {
    every: usize,
    steps: usize,
    states: Vec<State>,
}

impl Frames {
    /// One frame in `every` steps; zero counts as one.
    pub fn every(every: usize) -> Self {
        Self {
            every: every.max(1),
            steps: 0,
            states: Vec::new(),
        }
    }

    /// The frames, the initial state first.
    pub fn states(&self) -> &[State] {
        &self.states
    }
}

impl Observer for Frames {
    fn start(&mut self, simulation: &Simulation) {
        self.states.push(simulation.state().clone());
    }

    fn step(&mut self, simulation: &Simulation, _report: &StepReport) -> ControlFlow<()> {
        self.steps += 1;
        if self.steps.is_multiple_of(self.every) {
            self.states.push(simulation.state().clone());
        }
        ControlFlow::Continue(())
    }
}

/// Keeps the report of every step.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct History {
    reports: Vec<StepReport>,
}

impl History {
    /// The reports.
    pub fn reports(&self) -> &[StepReport] {
        &self.reports
    }
}

impl Observer for History {
    fn step(&mut self, _simulation: &Simulation, report: &StepReport) -> ControlFlow<()> {
        self.reports.push(report.clone());
        ControlFlow::Continue(())
    }
}

/// How a run ended.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum RunEnd {
    /// The duration has passed.
    Complete,
    /// An observer ended it.
    Stopped,
    /// The step control stopped at a taut state
    /// ([`Unsatisfiable::StopTaut`](crate::Unsatisfiable::StopTaut)).
    Taut,
}

/// Relative tolerance of a whole number of steps: round-off of the product of a step and up to a million
/// steps.
const ROUND_OFF: f64 = 1e-9;

impl Simulation {
    /// Advances by `duration` seconds in steps of `step` seconds, the last one shorter if needed, and calls
    /// the observers in order after each.
    ///
    /// ```
    /// use isosheet_dynamics::{Frames, History, Method, RunEnd, SheetModel, Simulation, State};
    /// use isosheet_mesh::{MassKind, VertexId, generate};
    ///
    /// # fn main() -> Result<(), Box<dyn std::error::Error>> {
    /// let sheet = generate::isotropic_square(1, 0.21)?;
    /// let model = SheetModel::new(&sheet, 3.5e-3, MassKind::Lumped)?
    ///     .with_gravity()
    ///     .with_pins(&[VertexId(20)])?;
    /// let start = State::at_rest(sheet.positions().to_vec());
    /// let mut simulation = Simulation::new(model, start, Method::default())?;
    /// let (mut frames, mut history) = (Frames::every(2), History::default());
    /// let end = simulation.run(0.1, 1.0 / 60.0, &mut [&mut frames, &mut history])?;
    /// assert_eq!(end, RunEnd::Complete);
    /// assert_eq!((frames.states().len(), history.reports().len()), (4, 6));
    /// # Ok(())
    /// # }
    /// ```
    ///
    /// # Errors
    /// As [`Simulation::step`]; [`StepError::StepSize`] if the duration is not positive and finite;
    /// [`StepError::Interrupted`] if an observer ended the run within a step.
    pub fn run(
        &mut self,
        duration: f64,
        step: f64,
        observers: &mut [&mut dyn Observer],
    ) -> Result<RunEnd, StepError> {
        let start = self.state().t;
        for h in [step, duration] {
            if !(h.is_finite() && h > 0.0) {
                return Err(StepError::StepSize { h, t: start });
            }
        }
        for observer in &mut *observers {
            observer.start(self);
        }
        let count = (duration / step - ROUND_OFF).ceil().max(1.0) as u64;
        // Not from the time reached, whose round-off grows with the number of steps.
        let rest = duration - (count - 1) as f64 * step;
        let last = if (rest - step).abs() > ROUND_OFF * step {
            rest
        } else {
            step
        };
        for k in 1..=count {
            let mut watch = |p: &StepProgress| observers.iter_mut().try_for_each(|o| o.within(p));
            let report = self.step_watched(if k < count { step } else { last }, &mut watch)?;
            let mut go_on = true;
            for observer in &mut *observers {
                go_on &= observer.step(self, &report).is_continue();
            }
            if report.taut.is_some() {
                return Ok(RunEnd::Taut);
            }
            if !go_on && k < count {
                return Ok(RunEnd::Stopped);
            }
        }
        Ok(RunEnd::Complete)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{Method, SheetModel};
    use isosheet_mesh::{MassKind, Sheet, VertexId};

    /// A triangle that swings about its pinned edge.
    fn triangle() -> Simulation {
        let x = vec![0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.3, 0.8, 0.0];
        let sheet = Sheet::new(x.clone(), &[[0, 1, 2]]).expect("a triangle");
        let model = SheetModel::new(&sheet, 0.1, MassKind::Lumped)
            .and_then(|m| m.with_gravity().with_pins(&[VertexId(0), VertexId(1)]))
            .expect("valid");
        Simulation::new(model, State::at_rest(x), Method::default()).expect("valid")
    }

    /// The clock gains more than a billionth of a step by round-off in so many steps.
    #[test]
    fn a_run_of_whole_steps_has_the_bits_of_single_steps() {
        let (h, count) = (2e-3, 20_000);
        let (mut whole, mut single) = (triangle(), triangle());
        let mut history = History::default();
        let end = whole.run(count as f64 * h, h, &mut [&mut history]);
        assert_eq!(end, Ok(RunEnd::Complete));
        let reports: Vec<_> = (0..count).map(|_| single.step(h).expect("taken")).collect();
        assert!((single.state().t - count as f64 * h).abs() > ROUND_OFF * h);
        assert_eq!(history.reports(), reports);
        assert_eq!(whole.state(), single.state());
    }

    #[test]
    fn the_last_step_is_as_short_as_the_duration_asks() {
        let mut simulation = triangle();
        let mut history = History::default();
        let end = simulation.run(0.035, 0.01, &mut [&mut history]);
        assert_eq!(end, Ok(RunEnd::Complete));
        let steps: Vec<f64> = history.reports().iter().map(|r| r.h).collect();
        assert_eq!(steps[..3], [0.01; 3]);
        assert_eq!(steps.len(), 4);
        assert!((steps[3] - 0.005).abs() < 1e-15);
        assert!((simulation.state().t - 0.035).abs() < 1e-15);
    }

    #[test]
    fn an_observer_ends_a_run_within_a_step() {
        /// Ends the run at the second factorisation after so many steps.
        struct Impatient(usize);
        impl Observer for Impatient {
            fn step(&mut self, _: &Simulation, _: &StepReport) -> ControlFlow<()> {
                self.0 -= 1;
                ControlFlow::Continue(())
            }
            fn within(&mut self, progress: &StepProgress) -> ControlFlow<()> {
                match (self.0, progress.factorisations) {
                    (0, 1) => ControlFlow::Break(()),
                    _ => ControlFlow::Continue(()),
                }
            }
        }
        let mut simulation = triangle();
        let end = simulation.run(1.0, 0.01, &mut [&mut Impatient(3)]);
        let t = simulation.state().t;
        assert_eq!(end, Err(StepError::Interrupted { t }));
        assert!((t - 0.03).abs() < 1e-15, "{t}");
    }

    #[test]
    fn an_observer_ends_a_run_and_durations_without_sense_are_refused() {
        let mut simulation = triangle();
        let mut frames = Frames::every(2);
        let mut until = |_: &Simulation, report: &StepReport| match report.t {
            t if t > 0.045 => ControlFlow::Break(()),
            _ => ControlFlow::Continue(()),
        };
        let end = simulation.run(1.0, 0.01, &mut [&mut frames, &mut until]);
        assert_eq!(end, Ok(RunEnd::Stopped));
        // Those at the start and after the second and the fourth of five steps.
        assert_eq!(frames.states().len(), 3);
        let t = simulation.state().t;
        for bad in [0.0, -1.0, f64::NAN, f64::INFINITY] {
            for (duration, step) in [(bad, 0.01), (1.0, bad)] {
                let refused = simulation.run(duration, step, &mut []);
                let Err(StepError::StepSize { h, t: at }) = refused else {
                    panic!("{refused:?}");
                };
                assert_eq!((h.to_bits(), at), (bad.to_bits(), t));
            }
        }
        assert_eq!(simulation.state().t, t);
    }
}
