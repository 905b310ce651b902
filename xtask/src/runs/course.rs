//! The course of a run: its steps until the end, until rest or until a limit, and the worst of them.

use crate::interrupt::{self, Interrupted};
use crate::report::Cost;
use cpu_time::ThreadTime;
use isosheet_dynamics::{Observer, RunEnd, Simulation, StepError, StepProgress, StepReport};
use std::cell::Cell;
use std::ops::ControlFlow;
use std::time::{Duration, Instant};

/// How a run ended.
#[derive(Clone, Debug, Default, PartialEq)]
pub(crate) enum Ending {
    /// The whole time was simulated, or as much of it as supports that pull a sheet taut leave.
    #[default]
    Complete,
    /// The sheet came to rest.
    Rest,
    /// Whoever looked at the steps had seen enough.
    Stopped,
    /// The limit of the time of the processor, seconds, was reached.
    CpuTime(f64),
    /// The solver returned an error: its kind and its message.
    Error { kind: String, message: String },
}

impl Ending {
    /// The ending by an error, with the names of the error and of the one behind it as they are in the code.
    pub(crate) fn of(error: &impl std::error::Error, cause: &impl std::fmt::Debug) -> Self {
        let variant = |debug: String| {
            let end = debug.find(|c: char| !c.is_alphanumeric());
            debug[..end.unwrap_or(debug.len())].to_owned()
        };
        let (kind, cause) = (variant(format!("{error:?}")), variant(format!("{cause:?}")));
        Self::Error {
            kind: if cause == kind {
                kind
            } else {
                format!("{kind} ({cause})")
            },
            message: error.to_string(),
        }
    }

    /// The ending by an error of a step.
    fn of_step(error: &StepError) -> Self {
        match error {
            StepError::StepTooSmall { cause, .. } => Self::of(error, &**cause),
            _ => Self::of(error, error),
        }
    }

    /// The ending in a word or two.
    pub(crate) fn name(&self) -> &str {
        match self {
            Self::Complete => "complete",
            Self::Rest => "at rest",
            Self::Stopped => "stopped",
            Self::CpuTime(_) => "CPU time over",
            Self::Error { kind, .. } => kind,
        }
    }

    /// The message of an error, nothing otherwise.
    pub(crate) fn message(&self) -> &str {
        match self {
            Self::Error { message, .. } => message,
            _ => "",
        }
    }
}

/// What happened in a run, up to its last complete step.
#[derive(Clone, Debug, Default)]
pub(crate) struct Course {
    pub(crate) ending: Ending,
    /// Time at the end, seconds.
    pub(crate) time: f64,
    /// What the steps cost; looking at them does not count.
    pub(crate) cost: Cost,
    /// Most factorisations in one step.
    pub(crate) worst: usize,
    /// Factorisations in vain before a sheet was refused because it locks ([`StepError::Locked`]), the most
    /// of all runs.
    pub(crate) in_vain: Option<usize>,
    /// Largest relative error of an edge length.
    pub(crate) strain: f64,
    /// Largest violation of the equations of isometry (see [`StepReport::constrained_strain`]).
    pub(crate) violation: f64,
    /// Smallest gap, metres; nothing without contact, or if nothing ever came within reach.
    pub(crate) gap: Option<f64>,
    /// Largest absolute energy error, joules.
    pub(crate) drift: f64,
    /// Largest kinetic energy, joules.
    pub(crate) most_kinetic: f64,
    /// Largest speed of a vertex after the last step, metres per second.
    pub(crate) speed: f64,
}

impl Course {
    /// Takes a step into account; its times are known to the caller alone.
    pub(crate) fn add(&mut self, report: &StepReport) {
        self.cost.add(report);
        self.time = report.t;
        self.worst = self.worst.max(report.factorisations);
        self.strain = self.strain.max(report.strain);
        self.violation = self.violation.max(report.constrained_strain);
        // An infinite gap means that nothing is within reach.
        let gap = report.gap.filter(|gap| gap.is_finite());
        self.gap = [self.gap, gap].into_iter().flatten().reduce(f64::min);
        self.drift = self.drift.max(report.energy_drift.abs());
        self.most_kinetic = self.most_kinetic.max(report.kinetic);
    }

    /// Takes another run into account: the worst of both, and the first ending that is none as planned.
    pub(crate) fn add_run(&mut self, other: Self) {
        self.cost.add_run(&other.cost);
        self.worst = self.worst.max(other.worst);
        self.in_vain = self.in_vain.max(other.in_vain);
        self.strain = self.strain.max(other.strain);
        self.violation = self.violation.max(other.violation);
        self.gap = [self.gap, other.gap].into_iter().flatten().reduce(f64::min);
        self.drift = self.drift.max(other.drift);
        self.most_kinetic = self.most_kinetic.max(other.most_kinetic);
        if self.is_good() {
            (self.ending, self.time, self.speed) = (other.ending, other.time, other.speed);
        }
    }

    /// Whether the run reached its end.
    pub(crate) fn is_good(&self) -> bool {
        matches!(self.ending, Ending::Complete | Ending::Rest)
    }

    /// Why the run did not reach its end, for people.
    pub(crate) fn failure(&self) -> Option<String> {
        match &self.ending {
            Ending::Complete | Ending::Rest => None,
            Ending::Stopped => Some("stopped".into()),
            Ending::CpuTime(limit) => Some(format!("{limit} s of CPU time were over")),
            Ending::Error { message, .. } => Some(message.clone()),
        }
    }

    /// Wall seconds for a simulated second; nothing if not a single step was completed.
    pub(crate) fn rate(&self) -> Option<f64> {
        (self.time > 0.0).then(|| self.cost.wall / self.time)
    }

    /// Seconds of the processor for a simulated second; nothing if not a single step was completed.
    pub(crate) fn cpu_rate(&self) -> Option<f64> {
        (self.time > 0.0).then(|| self.cost.cpu / self.time)
    }
}

/// Clocks of the wall and of the thread.
#[derive(Debug)]
struct Clocks {
    wall: Instant,
    cpu: ThreadTime,
}

/// What clocks show.
#[derive(Debug, Default)]
struct Spent {
    wall: Duration,
    cpu: Duration,
}

impl Clocks {
    fn start() -> Self {
        Self {
            wall: Instant::now(),
            cpu: ThreadTime::now(),
        }
    }

    fn spent(&self) -> Spent {
        Spent {
            wall: self.wall.elapsed(),
            cpu: self.cpu.elapsed(),
        }
    }

    /// Sets the times of a run without the time that looking at it has taken.
    fn cost(&self, looking: &Spent, cost: &mut Cost) {
        let spent = self.spent();
        cost.wall = spent.wall.saturating_sub(looking.wall).as_secs_f64();
        cost.cpu = spent.cpu.saturating_sub(looking.cpu).as_secs_f64();
    }
}

/// How long a run goes on.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Plan {
    /// Length of a step, seconds.
    pub(crate) step: f64,
    /// Longest time simulated, seconds.
    pub(crate) duration: f64,
    /// The run ends early when the sheet is at rest: when the largest speed of a vertex (m/s) has been below
    /// this bound for [`QUIET`] steps. `None`: it does not end early.
    pub(crate) rest_speed: Option<f64>,
    /// Longest time of the processor on the thread of a course, seconds. A run ends in the step in which it
    /// is over, or after it, unless it is the last one.
    pub(crate) patience: f64,
}

/// Steps below the bound of speed after which a sheet is called at rest: one alone may be a turning point.
pub(crate) const QUIET: usize = 5;

/// For runs at which nobody looks.
pub(crate) fn unseen(_simulation: &Simulation, _report: &StepReport) -> ControlFlow<()> {
    ControlFlow::Continue(())
}

/// Largest speed of a vertex, metres per second.
fn largest_speed(simulation: &Simulation) -> f64 {
    let velocities = simulation.state().v.as_chunks::<3>().0.iter();
    let squares = velocities.map(|v| v.iter().map(|c| c * c).sum::<f64>());
    squares.fold(0.0, f64::max).sqrt()
}

/// Ends a run within a step when its time of the processor is over or Ctrl-C was pressed: a step of a sheet
/// that locks can take minutes.
struct Limit<'a> {
    begun: ThreadTime,
    patience: f64,
    /// The time of looking at steps, which does not count.
    seen: &'a Cell<Duration>,
}

impl Observer for Limit<'_> {
    fn step(&mut self, _: &Simulation, _: &StepReport) -> ControlFlow<()> {
        ControlFlow::Continue(())
    }

    fn within(&mut self, _: &StepProgress) -> ControlFlow<()> {
        let cpu = self.begun.elapsed().saturating_sub(self.seen.get());
        match interrupt::requested() || cpu.as_secs_f64() > self.patience {
            true => ControlFlow::Break(()),
            false => ControlFlow::Continue(()),
        }
    }
}

impl Plan {
    /// So many seconds in steps of so many, whatever the sheet does and however long it takes.
    pub(crate) fn new(step: f64, duration: f64) -> Self {
        Self {
            step,
            duration,
            rest_speed: None,
            patience: f64::INFINITY,
        }
    }

    /// This plan with an end of the run when the sheet is at rest, see [`Plan::rest_speed`].
    pub(crate) fn until_rest(self, speed: f64) -> Self {
        Self {
            rest_speed: Some(speed),
            ..self
        }
    }

    /// This plan with a limit of the time of the processor, seconds.
    pub(crate) fn within(self, patience: f64) -> Self {
        Self { patience, ..self }
    }

    /// Runs a simulation as planned. `look` sees every step, and may end the run; the time that it takes does
    /// not count. An error of the solver is an ending like others, and not an error of this function.
    ///
    /// # Errors
    /// [`Interrupted`].
    pub(crate) fn run(
        &self,
        simulation: &mut Simulation,
        look: &mut dyn FnMut(&Simulation, &StepReport) -> ControlFlow<()>,
    ) -> Result<Course, Interrupted> {
        let mut course = Course::default();
        let end = simulation.state().t + self.duration - 0.5 * self.step;
        let clocks = Clocks::start();
        let (mut looking, mut quiet, mut stopped) = (Spent::default(), 0, Ending::Stopped);
        let mut limit = Limit {
            begun: clocks.cpu,
            patience: self.patience,
            seen: &Cell::default(),
        };
        let seen_until_now = limit.seen;
        let mut watch = |simulation: &Simulation, report: &StepReport| {
            let begun = Clocks::start();
            course.add(report);
            let enough = look(simulation, report);
            course.speed = largest_speed(simulation);
            let is_slow = self.rest_speed.is_some_and(|bound| course.speed < bound);
            quiet = if is_slow { quiet + 1 } else { 0 };
            let seen = begun.spent();
            looking.wall += seen.wall;
            looking.cpu += seen.cpu;
            seen_until_now.set(looking.cpu);
            clocks.cost(&looking, &mut course.cost);
            if enough.is_continue() {
                if quiet >= QUIET {
                    stopped = Ending::Rest;
                } else if course.cost.cpu > self.patience && report.t < end {
                    stopped = Ending::CpuTime(self.patience);
                } else {
                    return ControlFlow::Continue(());
                }
            }
            ControlFlow::Break(())
        };
        let end = simulation.run(
            self.duration,
            self.step,
            &mut [&mut watch, &mut interrupt::observe, &mut limit],
        );
        interrupt::check()?;
        clocks.cost(&looking, &mut course.cost);
        course.time = simulation.state().t;
        course.ending = match end {
            Ok(RunEnd::Complete | RunEnd::Taut) => Ending::Complete,
            Ok(RunEnd::Stopped) => stopped,
            Err(StepError::Interrupted { .. }) => Ending::CpuTime(self.patience),
            Err(error) => {
                if let StepError::Locked { factorisations, .. } = error {
                    course.in_vain = Some(factorisations);
                }
                Ending::of_step(&error)
            }
        };
        Ok(course)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use isosheet_dynamics::{Method, SheetModel, State};
    use isosheet_mesh::{MassKind, generate};

    fn falling() -> Simulation {
        let sheet = generate::isotropic_square(1, 1.0).unwrap();
        let model = SheetModel::new(&sheet, 0.1, MassKind::Lumped).unwrap();
        let start = State::at_rest(sheet.positions().to_vec());
        Simulation::new(model.with_gravity(), start, Method::default()).unwrap()
    }

    /// Time of the processor is that of the steps alone: neither that of waiting nor that of looking.
    #[test]
    fn processor_time_is_that_of_the_steps() {
        let plan = Plan::new(0.01, 0.1);
        let mut wait = |_: &Simulation, _: &StepReport| {
            std::thread::sleep(Duration::from_millis(5));
            let begun = ThreadTime::now();
            while begun.elapsed() < Duration::from_millis(5) {}
            ControlFlow::Continue(())
        };
        let begun = ThreadTime::now();
        let seen = plan.run(&mut falling(), &mut wait).unwrap();
        let all = begun.elapsed().as_secs_f64();
        assert!(all >= 0.05 && seen.cost.cpu > 0.0);
        assert!(seen.cost.cpu < all - 0.045, "{} of {all}", seen.cost.cpu);
        let twice = {
            let mut twice = seen.clone();
            twice.add_run(seen.clone());
            twice
        };
        assert_eq!(twice.cost.cpu, 2.0 * seen.cost.cpu);
    }

    #[test]
    fn runs_end_complete_at_rest_out_of_time_stopped_or_with_an_error() {
        let plan = Plan::new(0.01, 0.1);
        let run = |plan: Plan| plan.run(&mut falling(), &mut unseen).unwrap();
        let whole = run(plan);
        assert_eq!((&whole.ending, whole.cost.steps), (&Ending::Complete, 10));
        assert!((whole.time - 0.1).abs() < 1e-12 && whole.failure().is_none());
        let rest = run(plan.until_rest(100.0));
        assert_eq!((&rest.ending, rest.cost.steps), (&Ending::Rest, QUIET));
        let late = run(plan.within(0.0));
        assert_eq!((&late.ending, late.cost.steps), (&Ending::CpuTime(0.0), 0));
        assert_eq!((late.rate(), late.cpu_rate()), (None, None));
        assert_eq!(whole.rate(), Some(whole.cost.wall / whole.time));
        assert_eq!(whole.cpu_rate(), Some(whole.cost.cpu / whole.time));
        let mut stop = |_: &Simulation, _: &StepReport| ControlFlow::Break(());
        let stopped = plan.run(&mut falling(), &mut stop).unwrap();
        assert_eq!(stopped.ending, Ending::Stopped);
        let wrong = run(Plan::new(f64::NAN, 0.1));
        assert!(!wrong.ending.message().is_empty() && !wrong.is_good());
        let mut both = whole.clone();
        both.add_run(late.clone());
        assert_eq!((both.cost.steps, &both.ending), (10, &late.ending));
        let mut both = late.clone();
        both.add_run(whole);
        assert_eq!((both.cost.steps, both.ending), (10, late.ending));
    }
}
