//! Newton's method on the augmented Lagrangian, in rounds of the method of multipliers, and the restoration
//! that ends them.

use super::lagrangian::{Definiteness, Merit, RodLoad};
use super::problem::StepProblem;
use super::{LengthGoal, Minimiser, Minimum, not_converged};
use crate::constraint::rows::HessianPart;
use crate::damped::restoration::FirstMatrix;
use crate::step::effort::SolverEffort;
use crate::step::report::{StepError, StepOutcome};

/// Part of the promised decrease that has to come true (Armijo's condition).
const ARMIJO: f64 = 1e-4;
/// A Newton step shortened below this fraction is not a sign of convergence.
const NEARLY_FULL: f64 = 0.2;
/// Part of a Newton step below which the line search accepts whatever it has come to.
const SMALLEST_LENGTH: f64 = 1e-9;
/// Largest number of iterations in which bodies and pins have to get to the ends of their motions. They
/// arrive in one or two where nothing is in the way; a step that needs more is better halved.
const MAX_DRIVEN: usize = 20;
/// Largest number of rounds of the method of multipliers in contact. A sheet that lies flat resists a
/// restoration of its lengths: it would have to fold against the barrier, by the root of the length error.
/// Multipliers take the load instead, and each round shrinks the error by the penalty.
const MAX_ROUNDS_IN_CONTACT: usize = 12;
/// Growth of the penalty from round to round. Ten keeps Newton's method close to its quadratic range: with
/// thirty a sheet draping on a floor needs twice the iterations.
const GROWTH: f64 = 10.0;
/// Tolerance of the rounds after the first: they only shift load from the penalty to the multipliers.
const LOOSE_TOLERANCE: f64 = 1e-2;
/// Relative change of friction's normal forces below which they count as settled in a round, and largest
/// number of renewals in a round. With the tolerance of sequential quadratic programming, 1e-3, and five
/// renewals a disk of 688 vertices on a ball needs 16.7 factorisations a step, and 12.5 with these.
const FRICTION_SETTLED: f64 = 0.05;
const MAX_FRICTION_UPDATES: usize = 2;
/// Edge strain from which the restoration of a sheet in contact is a small displacement.
const SMALL_STRAIN: f64 = 1e-5;

/// How exact the rounds of the method of multipliers are in contact.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Rounds {
    /// Rounds after the first are solved loosely, and end where the restoration is a small displacement.
    Loose,
    /// All rounds are solved exactly, and leave nothing to the restoration: for nearly flat sheets, which
    /// fold by the root of their length error.
    Exact,
}

/// Minimises the augmented Lagrangian by Newton's method with line search; its Hessian is tried as it is and,
/// where it is indefinite, projected. In contact, rounds with growing penalties follow (Nocedal and Wright,
/// "Numerical Optimization", 2006, Sec. 17.3). At the end the lengths are restored exactly.
///
/// Positive definite at any rank of the rods, and with no need of finite multipliers.
pub(super) struct AugmentedLagrangian<'a, 'b, 'w> {
    minimiser: &'a mut Minimiser,
    problem: &'a mut StepProblem<'b>,
    rounds: Rounds,
    effort: &'a mut SolverEffort<'w>,
    stiffness: f64,
    residual: f64,
    outcome: StepOutcome,
}

impl<'a, 'b, 'w> AugmentedLagrangian<'a, 'b, 'w> {
    pub(super) fn new(
        minimiser: &'a mut Minimiser,
        problem: &'a mut StepProblem<'b>,
        rounds: Rounds,
        effort: &'a mut SolverEffort<'w>,
    ) -> Self {
        Self {
            stiffness: minimiser.options.stiffness,
            minimiser,
            problem,
            rounds,
            effort,
            residual: f64::INFINITY,
            outcome: StepOutcome::Newton,
        }
    }

    /// Minimises from the iterate.
    ///
    /// # Errors
    /// [`StepError::NotConverged`], [`StepError::Linalg`].
    pub(super) fn run(mut self) -> Result<Minimum, StepError> {
        let model = self.problem.model;
        let rounds = if self.problem.has_contact() {
            MAX_ROUNDS_IN_CONTACT
        } else {
            1
        };
        let restores_from = match self.rounds {
            Rounds::Loose => SMALL_STRAIN,
            Rounds::Exact => self.minimiser.options.strain_tolerance,
        };
        let tolerance = self.minimiser.strain_tolerance(self.problem);
        let mut strain = f64::INFINITY;
        for round in 0..rounds {
            let lagrangian = &mut self.minimiser.lagrangian;
            lagrangian.set_stiffness(self.stiffness, self.minimiser.options.stiffness);
            let converged = self.newton(round)?;
            let lagrangian = &mut self.minimiser.lagrangian;
            for e in 0..lagrangian.c.len() {
                lagrangian.multipliers[e] += lagrangian.penalty(e) * lagrangian.c[e];
            }
            lagrangian.vertex_rows.update();
            strain = model.constrained_strain(lagrangian.iterate.x());
            if !converged {
                break;
            }
            let is_last = round + 1 == rounds;
            if !is_last && strain > restores_from {
                self.stiffness *= GROWTH;
                continue;
            }
            let to = LengthGoal {
                strain: tolerance,
                max_iterations: self.minimiser.options.max_projections,
                matrix: FirstMatrix::Assembled,
            };
            strain = self.minimiser.restore(self.problem, to, self.effort);
            if strain <= tolerance {
                return Ok(Minimum {
                    residual: self.residual,
                    outcome: self.outcome,
                });
            }
            if is_last {
                break;
            }
            // Constraints at the iterate.
            self.minimiser.lagrangian.merit(self.problem);
        }
        Err(not_converged(
            self.problem,
            self.effort,
            self.residual,
            strain,
        ))
    }

    /// Newton's method on the augmented Lagrangian; whether it converged.
    fn newton(&mut self, round: usize) -> Result<bool, StepError> {
        let options = self.minimiser.options.clone();
        let tolerance = if round > 0 && self.rounds == Rounds::Loose {
            options.tolerance.max(LOOSE_TOLERANCE)
        } else {
            options.tolerance
        };
        let settled = options.friction_tolerance.max(FRICTION_SETTLED);
        let (mut driven, mut friction_updates) = (0, 0);
        let mut merit = self.minimiser.lagrangian.merit(self.problem);
        for _ in 0..options.max_iterations {
            let lagrangian = &mut self.minimiser.lagrangian;
            let is_driven = lagrangian.is_driven(self.problem);
            let (slope, hessian) = self.direction()?;
            let is_converged = -slope <= (tolerance * merit.inertia).max(merit.round_off);
            self.residual = if -slope > merit.round_off {
                (-slope / merit.inertia).sqrt()
            } else {
                0.0
            };
            let lagrangian = &mut self.minimiser.lagrangian;
            let limit = lagrangian.begin_line_search(self.problem);
            if is_driven {
                driven += 1;
                if driven > MAX_DRIVEN || limit == 0.0 {
                    return Ok(false);
                }
                lagrangian.drive(self.problem, limit);
                merit = lagrangian.merit(self.problem);
                continue;
            }
            let length;
            (length, merit) = self.line_search(limit, slope, &merit);
            if length < 1.0 {
                self.outcome = self.outcome.max(StepOutcome::Globalised);
            }
            if length < NEARLY_FULL || !is_converged {
                continue;
            }
            let lagrangian = &mut self.minimiser.lagrangian;
            if hessian == Definiteness::Modified && self.outcome != StepOutcome::BranchSeeded {
                // No slope left, but the curvature is negative somewhere: a saddle, where the sheet could
                // fold either way.
                self.outcome = StepOutcome::BranchSeeded;
                lagrangian.perturb(self.problem, options.seed);
            } else if friction_updates < MAX_FRICTION_UPDATES.min(options.max_friction_updates)
                && lagrangian.renew_friction(self.problem, settled)
            {
                friction_updates += 1;
            } else {
                return Ok(true);
            }
            merit = lagrangian.merit(self.problem);
        }
        Ok(false)
    }

    /// Solves for the Newton step `-dx`; the slope along it.
    fn direction(&mut self) -> Result<(f64, Definiteness), StepError> {
        let lagrangian = &mut self.minimiser.lagrangian;
        lagrangian.set_gradient(self.problem);
        self.effort.iterations += 1;
        let (load, model) = (RodLoad::Estimates, self.problem.model);
        let mut part = HessianPart::Full;
        let (hessian, slope) = loop {
            let hessian = lagrangian.factorize(self.problem, load, part, self.effort)?;
            match lagrangian.solve(model, self.effort) {
                Ok(slope) => break (hessian, slope),
                Err(_) if part == HessianPart::Full => part = HessianPart::PositiveSemidefinite,
                Err(source) => {
                    let t = self.problem.state.t;
                    return Err(StepError::Linalg { t, source });
                }
            }
        };
        if hessian == Definiteness::Modified {
            self.outcome = self.outcome.max(StepOutcome::Globalised);
        }
        if slope.is_finite() {
            Ok((slope, hessian))
        } else {
            let strain = f64::NAN;
            Err(not_converged(
                self.problem,
                self.effort,
                self.residual,
                strain,
            ))
        }
    }

    /// Halves the step from `limit` on until the augmented Lagrangian decreases; the part of the step and the
    /// value there.
    fn line_search(&mut self, limit: f64, slope: f64, before: &Merit) -> (f64, Merit) {
        let mut length = limit;
        loop {
            self.minimiser.lagrangian.move_along(length);
            let now = self.minimiser.lagrangian.merit(self.problem);
            let promised = before.value + ARMIJO * length * slope;
            if now.value <= promised + before.round_off || length < SMALLEST_LENGTH {
                return (length, now);
            }
            length *= 0.5;
        }
    }
}
