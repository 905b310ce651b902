//! Newton's method on the incremental potential of a step, in a phase.

use super::lagrangian::{Definiteness, Merit};
use super::phase::{MultiplierUpdate, Phase, Saddle, StartingPoint};
use super::problem::StepProblem;
use super::workspace::{LengthGoal, Workspace};
use crate::damped::ARMIJO;
use crate::damped::restoration::FirstMatrix;
use crate::linear::constrained::MultiplierGoal;
use crate::linear::constraint_rows::RowLoad;
use crate::report::effort::SolverEffort;
use crate::report::step_report::StepOutcome;
use crate::step::integrator::Phases;
use isosheet_materials::hessian::HessianPart;
use isosheet_model::Reason;
use isosheet_model::StepError;
use isosheet_model::{Continuation, Cut, TraceEvent};

/// How a minimisation ended.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Minimum {
    /// Whether it is one: a search also takes iterates from which it was still to go down.
    pub(crate) has_converged: bool,
    /// Relative Newton decrement before the last iteration.
    pub(crate) residual: f64,
    /// What it took.
    pub(crate) outcome: StepOutcome,
}

/// Why a phase found no minimum.
#[derive(Debug, Clone, Copy)]
pub(super) struct Failure {
    pub(super) reason: Reason,
    /// Relative Newton decrement before the last iteration.
    pub(super) residual: f64,
}

/// A search direction and what the merit function says of it.
struct Direction {
    before: Merit,
    slope: f64,
    hessian: Definiteness,
}

/// What a search direction promises.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Quality {
    /// More than the tolerance.
    Descends,
    /// No more than the tolerance: the iteration has converged.
    Converged,
    /// No more than round-off, or than what the tolerance of the lengths leaves open.
    RoundOff,
}

/// Minimises the incremental potential `Phi` along the rest lengths by steps
///
/// ```text
/// (M + h^2 (V + B + D)'' + P + r G^T G) dx + G^T L = -grad Phi - r G^T c
/// ```
///
/// with `P` the geometric stiffness of the rods (its positive part where the matrix is indefinite). The phase
/// says where the multipliers `L` come from: from the same linear system with `G dx = -c` (stabilised
/// sequential quadratic programming; Gill, Kungurtsev and Robinson, Math. Program. 163, 2017), or from rounds
/// with growing penalties `r` (augmented Lagrangian; Nocedal and Wright, "Numerical Optimization", 2006, Sec.
/// 17.3). Both solve the same kind of system. Every step is cut to its safe part in contact, brought near the
/// rest lengths where the phase asks for it (Waechter and Biegler, Math. Program. 106, 2006), and halved
/// where the merit function `Phi + (L + r c / 2) c` does not decrease. At the end the lengths are restored
/// exactly.
pub(super) struct Newton<'a, 'b, 'w> {
    work: &'a mut Workspace,
    problem: &'a mut StepProblem<'b>,
    effort: &'a mut SolverEffort<'w>,
    phase: Phase,
    round: usize,
    /// Strain before the last restoration at the end of a round, which failed.
    unrestored: f64,
    /// Such rounds in a row that have left most of the strain of the one before.
    stalled: usize,
    /// Penalty of the rods in the merit function of this round.
    penalty: f64,
    /// Iterations since the last round, continuation or the start.
    iterations: usize,
    /// All iterations.
    spent: usize,
    /// How often the iteration has gone on because friction had not settled where it had converged.
    friction_updates: usize,
    /// Whether the iteration has looked for a saddle where it had converged.
    has_sought_saddle: bool,
    /// The part of the Hessian that is tried first: all of it until that turns out to be indefinite.
    hessian: HessianPart,
    residual: f64,
    /// What the iteration before has left.
    last_residual: f64,
    outcome: StepOutcome,
}

impl<'a, 'b, 'w> Newton<'a, 'b, 'w> {
    pub(super) fn new(
        work: &'a mut Workspace,
        problem: &'a mut StepProblem<'b>,
        effort: &'a mut SolverEffort<'w>,
        phase: Phase,
    ) -> Self {
        Self {
            work,
            problem,
            effort,
            round: 0,
            unrestored: f64::INFINITY,
            stalled: 0,
            penalty: phase.merit_penalty,
            phase,
            iterations: 0,
            spent: 0,
            friction_updates: 0,
            has_sought_saddle: false,
            hessian: HessianPart::Full,
            residual: f64::INFINITY,
            last_residual: f64::INFINITY,
            outcome: StepOutcome::Newton,
        }
    }

    /// Minimises from the start of the phase.
    pub(super) fn run(mut self) -> Result<Minimum, Failure> {
        self.iterate().map_err(|reason| Failure {
            reason,
            residual: self.residual,
        })
    }

    fn iterate(&mut self) -> Result<Minimum, Reason> {
        self.begin();
        while self.iterations < self.phase.iterations && self.spent < self.phase.all_iterations {
            self.iterations += 1;
            self.spent += 1;
            let is_driven = self.work.lagrangian.is_driven(self.problem);
            let mut direction = self.direction()?;
            let mut limit = self.work.lagrangian.begin_line_search(self.problem);
            if is_driven {
                self.drive(limit)?;
                continue;
            }
            limit = self.correct(limit, &mut direction);
            limit = self.curve(limit);
            let quality = self.judge(&direction);
            let Some(length) = self.advance(limit, &direction, quality)? else {
                // What a step can still gain is round-off.
                return self
                    .restore_lengths()
                    .then(|| self.minimum())
                    .ok_or(Reason::NoDescent);
            };
            // Noise alone cuts a step that promises no more than round-off.
            if length < 1.0 && quality != Quality::RoundOff {
                self.outcome = self.outcome.max(StepOutcome::Globalised);
                continue;
            }
            let is_renewed = self.renew_friction(quality);
            if quality != Quality::Descends
                && self.is_near()
                && !self.goes_on(&direction, is_renewed)
                && self.finish()?
            {
                return Ok(self.minimum());
            }
        }
        let may_end =
            self.problem.phases == Phases::Search && !self.work.lagrangian.is_driven(self.problem);
        match may_end && self.finish()? {
            true => Ok(Minimum {
                has_converged: false,
                ..self.minimum()
            }),
            false => Err(Reason::Iterations),
        }
    }

    fn minimum(&self) -> Minimum {
        Minimum {
            has_converged: true,
            residual: self.residual,
            outcome: self.outcome,
        }
    }

    /// Places the iterate, and sets multipliers and penalties.
    fn begin(&mut self) {
        let Workspace {
            lagrangian,
            options,
            rod_stiffness,
            remembered,
            tuning,
            ..
        } = &mut *self.work;
        match (self.phase.remembers, self.phase.multipliers) {
            (true, _) => lagrangian.multipliers.copy_from_slice(remembered),
            (false, MultiplierUpdate::Solved) => lagrangian.multipliers.fill(0.0),
            (false, MultiplierUpdate::Rounds) => lagrangian.clear_multipliers(),
        }
        let first = match self.problem.has_contact() {
            true => tuning.last_stiffness,
            false => tuning.first_stiffness,
        };
        if self.phase.multipliers == MultiplierUpdate::Solved {
            // Contact is not kept to round-off.
            *rod_stiffness = rod_stiffness.max(first);
        }
        let problem = &mut *self.problem;
        match self.phase.start {
            StartingPoint::Prediction => lagrangian.predict(problem),
            StartingPoint::Lower if !problem.is_bounded() && problem.model.has_drives() => {
                lagrangian.set_stiffness(options.stiffness, options.stiffness);
                lagrangian.place_pins(problem);
                let start = lagrangian.merit(problem).value;
                lagrangian.predict(problem);
                if lagrangian.merit(problem).value >= start {
                    // It has begun before.
                    let _ = lagrangian.begin(problem);
                    lagrangian.place_pins(problem);
                }
            }
            // The prediction may be beyond an obstacle.
            StartingPoint::Lower => {}
        }
        lagrangian.set_stiffness(self.penalty, options.stiffness);
        lagrangian.merit(problem);
    }

    /// Solves for the step `-dx` at the iterate and, where the phase asks for it, for the multipliers.
    fn direction(&mut self) -> Result<Direction, Reason> {
        self.effort.iterations += 1;
        let hessian = match self.phase.multipliers {
            MultiplierUpdate::Solved => self.solve_with_multipliers()?,
            MultiplierUpdate::Rounds => self.solve()?,
        };
        if hessian == Definiteness::Modified && self.phase.multipliers == MultiplierUpdate::Rounds {
            self.outcome = self.outcome.max(StepOutcome::Globalised);
        }
        let lagrangian = &mut self.work.lagrangian;
        let before = lagrangian.merit(self.problem);
        let slope = lagrangian.slope();
        if !slope.is_finite() {
            return Err(Reason::LinearAlgebra);
        }
        Ok(Direction {
            before,
            slope,
            hessian,
        })
    }

    /// Sets the residual of a search direction; what the direction promises.
    fn judge(&mut self, direction: &Direction) -> Quality {
        let Direction { before, slope, .. } = direction;
        let tolerance = self.work.tolerance;
        self.last_residual = self.residual;
        if slope.abs() <= before.round_off + self.noise(before) {
            self.residual = 0.0;
            return Quality::RoundOff;
        }
        self.residual = (slope.abs() / before.relative_inertia).sqrt();
        match slope.abs() <= tolerance * before.relative_inertia {
            true => Quality::Converged,
            false => Quality::Descends,
        }
    }

    /// Sets the step `-dx` with the multipliers of the round.
    fn solve(&mut self) -> Result<Definiteness, Reason> {
        let stiffness = self.work.options.stiffness;
        loop {
            let lagrangian = &mut self.work.lagrangian;
            lagrangian.set_stiffness(self.penalty, stiffness);
            lagrangian.set_gradient(self.problem);
            let hessian = lagrangian
                .factorize(self.problem, RowLoad::Estimates, self.hessian, self.effort)
                .map_err(|error| failed(self.effort, &mut self.work.refusal, error))?;
            match lagrangian.solve(self.problem.model, self.effort) {
                Ok(_) => {
                    if hessian == Definiteness::Modified && self.phase.stays_semidefinite {
                        self.hessian = HessianPart::PositiveSemidefinite;
                    }
                    return Ok(hessian);
                }
                // The Hessian turned out not to be positive definite.
                Err(_) if self.hessian == HessianPart::Full => {
                    self.hessian = HessianPart::PositiveSemidefinite;
                }
                Err(_) => return Err(Reason::LinearAlgebra),
            }
        }
    }

    /// Sets the step `-dx` and the multipliers that it asks for.
    fn solve_with_multipliers(&mut self) -> Result<Definiteness, Reason> {
        let model = self.problem.model;
        let goal = self.multiplier_goal();
        let Workspace {
            lagrangian,
            rod_stiffness,
            options,
            tolerance,
            tuning,
            refusal,
            ..
        } = &mut *self.work;
        loop {
            lagrangian.set_stiffness(*rod_stiffness, options.stiffness);
            let hessian = lagrangian
                .factorize(
                    self.problem,
                    RowLoad::Multipliers,
                    self.hessian,
                    self.effort,
                )
                .map_err(|error| failed(self.effort, refusal, error))?;
            if hessian == Definiteness::Modified && self.phase.stays_semidefinite {
                self.hessian = HessianPart::PositiveSemidefinite;
            }
            lagrangian.keep_multipliers();
            let mut violation = None;
            for _ in 0..tuning.repetitions as usize {
                lagrangian.set_gradient(self.problem);
                if lagrangian.solve(model, self.effort).is_err() {
                    violation = None;
                    break;
                }
                violation = Some(lagrangian.improve_multipliers(model, goal));
                let [change, largest] = lagrangian.vertex_rows.update_one_sided(&lagrangian.dx);
                if change <= *tolerance * largest {
                    break;
                }
            }
            let Some(violation) = violation else {
                // The Hessian turned out not to be positive definite.
                if self.hessian == HessianPart::PositiveSemidefinite {
                    return Err(Reason::LinearAlgebra);
                }
                self.hessian = HessianPart::PositiveSemidefinite;
                lagrangian.restore_multipliers();
                continue;
            };
            if violation <= goal.violation || *rod_stiffness == tuning.last_stiffness {
                // The merit function has the new multipliers.
                lagrangian.set_stiffness(self.penalty, options.stiffness);
                lagrangian.set_gradient(self.problem);
                return Ok(hessian);
            }
            *rod_stiffness = tuning.last_stiffness;
            lagrangian.restore_multipliers();
        }
    }

    /// When the multipliers of a step are good enough: once the linearised lengths are within the tolerance.
    fn multiplier_goal(&self) -> MultiplierGoal {
        MultiplierGoal {
            max_iterations: self.work.tuning.repetitions as usize,
            violation: self.work.strain_tolerance(self.problem),
            change: self.work.tolerance,
            longest: self.work.tuning.longest_iteration,
        }
    }

    /// Moves sheet, pins and bodies on together by a part of the rest of their motions.
    fn drive(&mut self, part: f64) -> Result<(), Reason> {
        if part == 0.0 {
            return Err(Reason::Blocked);
        }
        self.trace(part, Cut::Driven, Definiteness::Definite);
        self.work.lagrangian.drive(self.problem, part);
        self.work.lagrangian.merit(self.problem);
        Ok(())
    }

    /// Applies the second-order correction for contact to a step of which only the part `limit` is safe; the
    /// part that is safe then.
    fn correct(&mut self, limit: f64, direction: &mut Direction) -> f64 {
        if limit == 1.0 || self.phase.multipliers == MultiplierUpdate::Rounds {
            return limit;
        }
        let lagrangian = &mut self.work.lagrangian;
        let limit = lagrangian.correct_gaps(self.problem, limit, self.effort);
        direction.slope = lagrangian.slope();
        limit
    }

    /// Curves the step of an elastic sheet, unless contact cuts it as it is; the largest part to be tried. In
    /// contact, where a curved step has to be checked again, whole steps stay straight.
    fn curve(&mut self, limit: f64) -> f64 {
        let is_curved = match self.work.lagrangian.cut() {
            Cut::StrainLimit => true,
            Cut::Nothing => !self.problem.has_contact(),
            _ => false,
        };
        if is_curved && self.work.lagrangian.correct_strains(self.problem) {
            1.0
        } else {
            limit
        }
    }

    /// Goes on along the step; the part of it that was taken. Where the step would mend the lengths against
    /// the potential, the lengths are restored instead, which counts as a whole step: along exact lengths
    /// steps descend. Nothing if there is no descent, but no more than round-off was promised.
    fn advance(
        &mut self,
        limit: f64,
        direction: &Direction,
        quality: Quality,
    ) -> Result<Option<f64>, Reason> {
        if direction.slope > direction.before.round_off {
            self.trace(0.0, Cut::Lengths, direction.hessian);
            if !self.restore_lengths() {
                return Err(self.effort.failed(Reason::DependentRods));
            }
            self.work.lagrangian.merit(self.problem);
            return Ok(Some(1.0));
        }
        let (mut length, cut) = self.line_search(limit, direction);
        if length == Some(1.0) && cut == Cut::Nothing && self.is_overestimated(direction) {
            length = Some(self.prolong());
        }
        self.trace(length.unwrap_or(0.0), cut, direction.hessian);
        match length {
            None if quality != Quality::RoundOff => Err(self.effort.failed(Reason::NoDescent)),
            length => Ok(length),
        }
    }

    /// Whether whole steps leave nearly all of the residual, as they do along directions in which the part of
    /// the Hessian without negative eigenvalues is many times stiffer than the energy. In contact, and where
    /// lengths are kept, longer steps would have to be checked again.
    fn is_overestimated(&self, direction: &Direction) -> bool {
        direction.hessian == Definiteness::Modified
            && self.residual > self.work.tuning.slow * self.last_residual
            && self.phase.iterate_strain == f64::INFINITY
            && !self.problem.has_contact()
    }

    /// Doubles the step, which has been taken, as long as the merit function decreases; its length.
    fn prolong(&mut self) -> f64 {
        let mut best = self.work.lagrangian.merit(self.problem).value;
        let mut length = 1.0;
        loop {
            self.work.lagrangian.return_to_start(self.problem);
            let longer = 2.0 * length;
            let reached = self.work.lagrangian.go_to(self.problem, longer);
            let value = self.work.lagrangian.merit(self.problem).value;
            let is_lower = reached == Some(longer) && value < best;
            if !is_lower {
                break;
            }
            (best, length) = (value, longer);
        }
        self.work.lagrangian.return_to_start(self.problem);
        let _ = self.work.lagrangian.go_to(self.problem, length);
        self.work.lagrangian.merit(self.problem);
        length
    }

    /// Goes on by up to `limit` of the step, not far from the rest lengths; the part of the step, or nothing
    /// if it does not decrease the merit function, and what cut it.
    fn line_search(&mut self, limit: f64, direction: &Direction) -> (Option<f64>, Cut) {
        let mut length = limit;
        let mut cut = None;
        for _ in 0..=self.phase.halvings {
            match self.work.lagrangian.go_to(self.problem, length) {
                None => cut = Some(Cut::StrainLimit),
                Some(part) => {
                    if self.keeps_lengths() && self.has_decreased(part, direction) {
                        let last = self.work.lagrangian.cut();
                        return (Some(part), cut.unwrap_or(last));
                    }
                    cut = Some(Cut::Merit);
                }
            }
            length *= 0.5;
            self.work.lagrangian.return_to_start(self.problem);
        }
        (None, cut.unwrap_or(Cut::Merit))
    }

    /// Whether the merit function has decreased as far as the part `length` of the step promises (Armijo).
    fn has_decreased(&mut self, length: f64, direction: &Direction) -> bool {
        let Direction { before, slope, .. } = direction;
        let now = self.work.lagrangian.merit(self.problem);
        let promised = before.value + ARMIJO * length * slope;
        now.value <= promised + before.round_off
    }

    /// Brings the iterate to lengths that the phase allows; whether that succeeds.
    fn keeps_lengths(&mut self) -> bool {
        if self.phase.iterate_strain == f64::INFINITY {
            return true;
        }
        let to = LengthGoal {
            strain: self.phase.iterate_strain,
            max_iterations: self.phase.restorations,
            matrix: FirstMatrix::Factorised,
        };
        self.work.restore(self.problem, to, self.effort) <= to.strain
    }

    /// Size of decreases that are noise of the lengths, besides round-off: a part of the energy
    /// `tolerance * sum
    /// |L| l^2` that the tolerance of the lengths leaves open, whose errors have different signs. Where there
    /// are finite multipliers the iteration has converged after some iterations, and small motions of taut
    /// sheets are below that size; where there are none, the last decreases fall as the inverse of the number
    /// of iterations.
    fn noise(&self, merit: &Merit) -> f64 {
        let tuning = &self.work.tuning;
        let is_early = self.iterations <= tuning.repetitions as usize;
        match self.phase.multipliers {
            MultiplierUpdate::Solved if !is_early => {
                tuning.contraction() * self.work.options.strain_tolerance * merit.rod_scale
            }
            _ => 0.0,
        }
    }

    /// Whether the restoration at the end will be a small displacement, or further rounds see to that.
    fn is_near(&self) -> bool {
        self.phase.multipliers == MultiplierUpdate::Rounds
            || self.phase.small_strain == f64::INFINITY
            || self.strain() <= self.phase.small_strain
    }

    fn strain(&self) -> f64 {
        self.problem
            .model
            .constrained_strain(&self.work.lagrangian.x)
    }

    /// Lags friction anew at the iterate, unless it has settled or been renewed too often; whether it was
    /// renewed.
    ///
    /// In SQP friction follows after every full step, not only where the minimisation with lagged
    /// friction has converged: sheets of 289 vertices on a table need three quarters of the factorisations.
    /// In rounds, which begin far from the minimum, a flat sheet between closing plates would use all
    /// iterations.
    fn renew_friction(&mut self, quality: Quality) -> bool {
        let is_early =
            self.phase.multipliers == MultiplierUpdate::Rounds && quality == Quality::Descends;
        if is_early || self.friction_updates == self.phase.friction_updates {
            return false;
        }
        let lagrangian = &mut self.work.lagrangian;
        let is_renewed = lagrangian.renew(self.problem, self.phase.lagging);
        if is_renewed {
            lagrangian.merit(self.problem);
        }
        is_renewed
    }

    /// Begins anew from a point that has converged but is no minimum: a saddle, where the sheet could fold
    /// either way, or one whose friction belonged to other normal forces and was renewed. Returns false if
    /// there is no reason to.
    fn goes_on(&mut self, direction: &Direction, is_renewed: bool) -> bool {
        let may_be_saddle = direction.hessian == Definiteness::Modified && !self.has_sought_saddle;
        self.has_sought_saddle |= may_be_saddle;
        let because = if may_be_saddle && self.leave_saddle(direction) {
            Continuation::Saddle
        } else if is_renewed {
            self.friction_updates += 1;
            Continuation::Friction
        } else {
            return false;
        };
        self.effort.trace(|| TraceEvent::GoesOn { because });
        self.iterations = 0;
        true
    }

    /// Leaves a saddle as the phase says; whether the iterate has moved.
    fn leave_saddle(&mut self, direction: &Direction) -> bool {
        // The whole Hessian has not been looked at since it was indefinite.
        let is_unknown = self.phase.stays_semidefinite;
        if self.phase.saddle == Saddle::Perturbation && is_unknown && self.is_minimum() {
            return false;
        }
        let Workspace {
            lagrangian,
            options,
            tolerance,
            tuning,
            ..
        } = &mut *self.work;
        match self.phase.saddle {
            Saddle::Ignored => false,
            Saddle::Curvature => {
                let least = *tolerance * direction.before.relative_inertia;
                lagrangian.leave_saddle(self.problem, options.seed, least, self.effort)
            }
            Saddle::Perturbation => {
                self.outcome = StepOutcome::BranchSeeded;
                lagrangian.perturb(self.problem, options.seed, tuning.perturbation);
                lagrangian.merit(self.problem);
                true
            }
        }
    }

    /// Whether the whole Hessian is positive definite at the iterate.
    fn is_minimum(&mut self) -> bool {
        let lagrangian = &mut self.work.lagrangian;
        lagrangian.set_gradient(self.problem);
        let part = HessianPart::Full;
        let hessian = lagrangian.factorize(self.problem, RowLoad::Estimates, part, self.effort);
        matches!(hessian, Ok(Definiteness::Definite))
            && lagrangian.solve(self.problem.model, self.effort).is_ok()
    }

    /// Ends at a point that has converged: whether its lengths are exact now. Otherwise the next round
    /// begins, or the iteration goes on.
    fn finish(&mut self) -> Result<bool, Reason> {
        let is_last = self.round + 1 == self.phase.rounds;
        if self.phase.multipliers == MultiplierUpdate::Rounds {
            let lagrangian = &mut self.work.lagrangian;
            for e in 0..lagrangian.c.len() {
                lagrangian.multipliers[e] += lagrangian.penalty(e) * lagrangian.c[e];
            }
            lagrangian.vertex_rows.update();
            if !is_last && self.strain() > self.phase.small_strain {
                self.penalty *= self.work.tuning.penalty_growth;
                self.begin_round();
                return Ok(false);
            }
        }
        let strain = self.strain();
        if self.restore_lengths() {
            return Ok(true);
        }
        self.work.lagrangian.merit(self.problem);
        let is_over = is_last || self.has_stalled(strain);
        match self.phase.multipliers {
            MultiplierUpdate::Solved => {}
            MultiplierUpdate::Rounds if is_over => {
                return Err(self.effort.failed(Reason::DependentRods));
            }
            MultiplierUpdate::Rounds => self.begin_round(),
        }
        Ok(false)
    }

    /// Whether round after round has left most of the strain, and its lengths could not be restored:
    /// multipliers that exist gain a digit in each round, and where rods depend on each other there are none.
    /// (A sheet that jams took fifty thousand factorisations for a step of eighty rounds.)
    fn has_stalled(&mut self, strain: f64) -> bool {
        let tuning = &self.work.tuning;
        self.stalled = match strain > tuning.slow * self.unrestored {
            true => self.stalled + 1,
            false => 0,
        };
        self.unrestored = strain;
        self.stalled >= tuning.patience as usize
    }

    fn begin_round(&mut self) {
        self.round += 1;
        self.iterations = 0;
        self.friction_updates = 0;
        let because = Continuation::Round;
        self.effort.trace(|| TraceEvent::GoesOn { because });
        let lagrangian = &mut self.work.lagrangian;
        lagrangian.set_stiffness(self.penalty, self.work.options.stiffness);
        lagrangian.merit(self.problem);
    }

    /// Restores the lengths exactly; whether that succeeds.
    fn restore_lengths(&mut self) -> bool {
        let to = LengthGoal {
            strain: self.work.strain_tolerance(self.problem),
            max_iterations: self.phase.restorations,
            matrix: match self.phase.multipliers {
                MultiplierUpdate::Solved => FirstMatrix::Factorised,
                MultiplierUpdate::Rounds => FirstMatrix::Assembled,
            },
        };
        self.work.restore(self.problem, to, self.effort) <= to.strain
    }

    /// Tells what an iteration did.
    fn trace(&mut self, length: f64, cut: Cut, hessian: Definiteness) {
        if !self.effort.is_traced() {
            return;
        }
        let contacts = self.problem.objective.contact_count();
        let event = TraceEvent::Iteration {
            iteration: self.iterations,
            round: self.round,
            residual: self.residual,
            strain: self.strain(),
            length,
            cut,
            is_definite: hessian == Definiteness::Definite,
            contacts,
        };
        self.effort.trace(|| event);
    }
}

/// The reason of a failed factorisation; a refusal is kept.
fn failed(effort: &SolverEffort<'_>, refusal: &mut Option<StepError>, error: StepError) -> Reason {
    if matches!(
        error,
        StepError::Potential { .. } | StepError::Refused { .. }
    ) {
        *refusal = Some(error);
    }
    effort.failed(Reason::LinearAlgebra)
}
