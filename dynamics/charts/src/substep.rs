//! One step in a chart: proposals of the method, judged by the step control.

use super::energy_bound::{EnergyBound, Verdict};
use super::simulation::ChartSimulation;
use super::state::StepRange;
use super::stepping::PhaseState;
use super::{ChartDynamicsError, ChartStepControl, ChartStepReport, Rebase};

impl ChartSimulation {
    /// Take one step.
    ///
    /// # Errors
    /// [`ChartDynamicsError::StepTooSmall`] of the step control; with a fixed step the error of the step
    /// itself. The state is that before the step then.
    pub fn step(&mut self) -> Result<ChartStepReport, ChartDynamicsError> {
        self.step_within(f64::INFINITY)
    }

    /// As [`ChartSimulation::step`], of at most `limit` seconds. A step cut short by the limit does not
    /// enter [`ChartSimulation::step_range`] and leaves the step control where it was.
    ///
    /// # Errors
    /// As [`ChartSimulation::step`].
    pub(crate) fn step_within(
        &mut self,
        limit: f64,
    ) -> Result<ChartStepReport, ChartDynamicsError> {
        let before = self.motion();
        self.replaced = None;
        let taken = self.attempt_within(limit);
        if taken.is_err() {
            self.restore(before);
        }
        taken
    }

    /// As [`ChartSimulation::step_within`], without a way back.
    fn attempt_within(&mut self, limit: f64) -> Result<ChartStepReport, ChartDynamicsError> {
        let mut rebased = false;
        if self.options.rebase == Rebase::WhenNeeded && !self.motion.is_fresh {
            let margin = self
                .stepper
                .mechanics
                .chart()
                .margin(&self.motion.state.x)?;
            let growth = self.motion.growth;
            if margin < self.options.margin_limit || growth > self.options.growth_limit {
                self.rebase()?;
                rebased = true;
            }
        }
        if self.motion.since_check >= self.options.condition_interval {
            self.check_condition()?;
        }
        let bound = EnergyBound::new(self.options.control, self.motion.next_step);
        let h = bound.planned().min(limit);
        ChartSubstep::new(self, bound, h, rebased).take(h)
    }
}

/// A step to be proposed and taken.
struct ChartSubstep<'a> {
    simulation: &'a mut ChartSimulation,
    bound: EnergyBound,
    /// Whether the step is shorter than planned because the caller wants it so.
    is_cut_short: bool,
    rejected: u32,
    is_rebased: bool,
}

/// What follows from a refusal.
enum Decision {
    /// The step is proposed again in a new chart.
    Rebase,
    /// A step of this length is proposed, seconds.
    Shorten(f64),
    /// There is no step.
    Stop(ChartDynamicsError),
}

/// Why a step in a chart is not taken as proposed.
pub(super) enum SubstepRefusal {
    /// It changes the Hamiltonian by this much, joules.
    Energy(f64),
    /// There is no such step.
    Failed(ChartDynamicsError),
}

impl<'a> ChartSubstep<'a> {
    /// Of at most `h` seconds.
    pub(super) fn new(
        simulation: &'a mut ChartSimulation,
        bound: EnergyBound,
        h: f64,
        is_rebased: bool,
    ) -> Self {
        Self {
            is_cut_short: h < bound.planned(),
            simulation,
            bound,
            rejected: 0,
            is_rebased,
        }
    }

    fn t(&self) -> f64 {
        self.simulation.motion.t
    }

    /// A step of `h` seconds changed the Hamiltonian by `change`, or failed with an error.
    fn shorten(&mut self, h: f64, change: f64, error: Option<ChartDynamicsError>) -> Decision {
        if let Verdict::Shorten(shorter) = self.bound.judge(h, change) {
            self.rejected += 1;
            return Decision::Shorten(shorter);
        }
        Decision::Stop(match (self.bound.control(), error) {
            (ChartStepControl::Adaptive { min, tolerance, .. }, error) => {
                ChartDynamicsError::StepTooSmall {
                    t: self.t(),
                    minimum: min,
                    tolerance,
                    change,
                    cause: error.map_or("the change is too large".to_owned(), |e| e.to_string()),
                }
            }
            (ChartStepControl::Fixed(_), Some(error)) => error,
            // The bound of a fixed step refuses what is not a number, and nothing else.
            (ChartStepControl::Fixed(_), None) => ChartDynamicsError::NotFinite { t: self.t() },
        })
    }

    /// Makes the proposal the state; after an error [`ChartSimulation::restore`] has to follow.
    fn apply(&mut self, trial: PhaseState, h: f64) -> Result<ChartStepReport, ChartDynamicsError> {
        let simulation = &mut *self.simulation;
        simulation.motion.growth = simulation.stepper.growth()?;
        let motion = &mut simulation.motion;
        let energy_change = trial.hamiltonian - motion.hamiltonian;
        if !(self.is_cut_short && self.rejected == 0) {
            motion.next_step = self.bound.next(h, energy_change.abs());
        }
        let start = (motion.t, std::mem::replace(&mut motion.state, trial));
        motion.t += h;
        motion.is_fresh = false;
        motion.since_check += 1;
        let driven = simulation.drive_work((start.0, &start.1.x), h)?;
        let before_damping = simulation.motion.state.hamiltonian;
        let potential = simulation.damp(h)?;
        let motion = &mut simulation.motion;
        if !self.is_cut_short || self.rejected > 0 {
            let so_far = motion.range.unwrap_or(StepRange {
                min: h,
                max: h,
                steps: 0,
            });
            motion.range = Some(StepRange {
                min: so_far.min.min(h),
                max: so_far.max.max(h),
                steps: so_far.steps + 1,
            });
        }
        let system = simulation.stepper.mechanics.system();
        Ok(ChartStepReport {
            t: motion.t,
            h,
            rejected: self.rejected,
            kinetic: motion.hamiltonian - potential,
            potential,
            energy_change,
            damped: before_damping - motion.hamiltonian,
            strain: system.max_strain(&motion.state.x),
            driven,
            rebased: self.is_rebased,
        })
    }
}

impl ChartSubstep<'_> {
    /// Takes a step of at most `h` seconds.
    fn take(mut self, mut h: f64) -> Result<ChartStepReport, ChartDynamicsError> {
        loop {
            let refusal = match self.propose(h) {
                Ok(trial) => return self.apply(trial, h),
                Err(refusal) => refusal,
            };
            match self.decide(refusal, h) {
                Decision::Rebase => {
                    self.is_rebased = true;
                    self.simulation.rebase()?;
                }
                Decision::Shorten(shorter) => h = shorter,
                Decision::Stop(error) => return Err(error),
            }
        }
    }

    /// The state after a step of `h` seconds.
    fn propose(&mut self, h: f64) -> Result<PhaseState, SubstepRefusal> {
        let ChartSimulation {
            stepper,
            motion,
            options,
            ..
        } = &mut *self.simulation;
        let t = motion.t + h;
        if let Some((support, value)) = stepper.mechanics.model().find_bad_motion(t) {
            let error = ChartDynamicsError::Motion { support, value, t };
            return Err(SubstepRefusal::Failed(error));
        }
        let trial = stepper
            .attempt(motion.t, &motion.state, h)
            .map_err(SubstepRefusal::Failed)?;
        let change = (trial.hamiltonian - motion.hamiltonian).abs();
        if self.bound.judge(h, change) != Verdict::Accept {
            return Err(SubstepRefusal::Energy(change));
        }
        let strain = stepper.mechanics.system().max_strain(&trial.x);
        if strain > options.failure_strain {
            return Err(SubstepRefusal::Failed(ChartDynamicsError::Diverged {
                t: motion.t + h,
                strain,
                limit: options.failure_strain,
            }));
        }
        Ok(trial)
    }

    fn decide(&mut self, refusal: SubstepRefusal, h: f64) -> Decision {
        let may_rebase = self.simulation.options.rebase == Rebase::WhenNeeded
            && !self.simulation.motion.is_fresh;
        match refusal {
            SubstepRefusal::Failed(ChartDynamicsError::Chart(_)) if may_rebase => Decision::Rebase,
            // The edge lengths have drifted over many steps, or a prescribed motion is not finite: a shorter
            // step does not help.
            SubstepRefusal::Failed(
                error @ (ChartDynamicsError::Diverged { .. } | ChartDynamicsError::Motion { .. }),
            ) => Decision::Stop(error),
            SubstepRefusal::Failed(error) => self.shorten(h, f64::NAN, Some(error)),
            SubstepRefusal::Energy(change) => self.shorten(h, change, None),
        }
    }
}
