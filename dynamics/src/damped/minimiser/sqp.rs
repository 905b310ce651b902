//! Stabilised sequential quadratic programming from the positions at the start of a step.

use super::lagrangian::{Definiteness, Merit, RodLoad};
use super::problem::StepProblem;
use super::{LengthGoal, Minimiser, Strategy};
use crate::constraint::rows::HessianPart;
use crate::damped::restoration::FirstMatrix;
use crate::linear::multipliers::MultiplierGoal;
use crate::step::effort::SolverEffort;

/// Stiffnesses of the rods in the linear systems, in units of that of the masses. The systems are
/// regularised saddle-point systems `[H G^T; G -1/r]` with penalties `r`, solved by elimination of the
/// multipliers; [`MultiplierSolver`](crate::linear::multipliers::MultiplierSolver) takes the regularisation out
/// again. With the first stiffness steps keep momentum and symmetries to round-off, with 1e11 no longer.
/// Where the multipliers do not converge, the second is used from then on, in later steps, too: beyond it
/// the masses drown in the round-off of the penalty. (Strips of rods on edge, at rest: 10 to 16
/// factorisations a step, and 16 to 280 where every step begins with the first.)
const STIFFNESS: [f64; 2] = [1e10, 1e13];
/// Length of an iteration for the multipliers beyond which rods count as dependent: the inverse of the
/// smallest eigenvalue that is not taken to be zero. Multipliers of nearly dependent rods may grow without
/// bound. Strips of rods that stand on edge take five times the factorisations at rest without this bound.
const LONGEST_ITERATION: f64 = 3.0;
/// Conjugate gradient iterations for the multipliers of a step: nearly dependent rods, as in a sheet that
/// lies flat, have a few eigenvalues each of which takes an iteration. With none, clamped strips of nearly
/// dependent rods need three to ten times the factorisations; 6 and 16 differ by less than a tenth.
const MULTIPLIER_ITERATIONS: usize = 8;
/// Change of the multipliers, relative to the largest, from which an iteration is not worth its solve. With
/// 1e-3 a sheet at rest on a table needs three times as many steps.
const MULTIPLIERS_SETTLED: f64 = 1e-4;
/// Passes in which the multipliers of vertex constraints follow those of the isometry.
const CONSTRAINT_PASSES: usize = 4;
/// Part of [`ImplicitOptions::max_iterations`](crate::ImplicitOptions::max_iterations) that is the largest
/// number of steps in contact, 20 by default: a draping sheet needs three to six steps, a sheet at rest two to
/// six, an impact more where contact cuts them. (Otherwise all iterations may be used: a hanging sheet of 2000
/// triangles needs up to 50 at 60 steps a second.)
const FEW: usize = 4;
/// Edge strain that iterates may have. Hanging sheets of 289 vertices need 9.2, 9.3, 10.0 and 9.7
/// factorisations a step (means of 24 starts) with 0.01, 0.03, 0.1 and 0.3; of sheets of 2048 and 8192
/// triangles some starts need several times as many with 0.03 and more.
const ITERATE_STRAIN: f64 = 1e-2;
/// The same in contact, which cuts the long first iterations that would go far: a disk of 688 vertices on a
/// ball needs 18.3 factorisations a step, 19.5 with 0.03 and 21.4 with 0.01.
const ITERATE_STRAIN_IN_CONTACT: f64 = 1e-1;
/// Number of iterations after which decreases of the size of length errors are noise. Where there are finite
/// multipliers, Newton's method has converged by then, and small motions of taut sheets are below that size.
/// Where there are none, the last decreases only fall as the inverse of the number of iterations.
const NOISE_PATIENCE: usize = 10;
/// Part of the energy that the tolerance of the lengths leaves open, `tolerance * sum |L| l^2`, that counts
/// as noise then: length errors of different rods have different signs. Strips on edge at rest need 15 to
/// 930 factorisations a step without this rule, and 11 to 100 with it.
const LENGTH_NOISE: f64 = 0.1;
/// Largest number of iterations of a restoration of an iterate: more are a sign that the step is not a small
/// one.
const MAX_RESTORATION: usize = 12;
/// Largest number of iterations of the last restoration. Where they do not suffice, programming goes on from
/// there. With 10, 20 and 40 hanging sheets of 2048 triangles need 16 600, 13 100 and 14 300 factorisations.
const MAX_LAST_RESTORATION: usize = 20;
/// Edge strain from which the last restoration is a small displacement.
const SMALL_STRAIN: f64 = 1e-5;
/// Largest number of step halvings in contact; after these the augmented Lagrangian is used. Two, four and
/// six make 13 000, 10 500 and 10 600 factorisations of eight tablecloths.
const MAX_HALVINGS_IN_CONTACT: usize = 4;
/// Largest number of step halvings without contact, where the augmented Lagrangian takes longer. With two, a
/// third of the steps of a hanging sheet of 2000 triangles uses it; with 30, a thousand steps a second need
/// half as many factorisations more.
const MAX_HALVINGS: usize = 8;
/// Part of the promised decrease that has to come true (Armijo's condition).
const ARMIJO: f64 = 1e-4;

/// Minimises the incremental potential `Phi` by steps
///
/// ```text
/// (M + h^2 (V + B + D)'' + P) dx + G^T L = -grad Phi,   G dx = -c
/// ```
///
/// with `P` the geometric stiffness of the rods under the multipliers of the step before (its positive part
/// where the matrix is indefinite). Every step is cut to its safe part in contact, brought near the manifold
/// of rest lengths where it is far from it, and halved where the Lagrangian `Phi + L . c`, without contact
/// augmented, does not decrease. At the end the lengths are restored exactly. (Nocedal and Wright, "Numerical
/// Optimization", 2006, chapter 18; regularised as in Gill, Kungurtsev and Robinson, Math. Program. 163,
/// 2017; restoration as in Waechter and Biegler, Math. Program. 106, 2006.)
///
/// A sheet that lies flat is held up by rods that are nearly dependent, with multipliers that grow as the
/// inverse of its fold angles; the augmented Lagrangian needs a dozen rounds to find them. Here they are the
/// solution of a linear system, and motions that are small or blocked by contact converge in a few steps.
pub(super) struct Sqp<'a, 'b, 'w> {
    minimiser: &'a mut Minimiser,
    problem: &'a mut StepProblem<'b>,
    effort: &'a mut SolverEffort<'w>,
    limits: Limits,
    /// Steps left before the iteration counts as failed.
    steps_left: usize,
    /// How often the iteration has gone on because friction had not settled where it had converged.
    friction_updates: usize,
    /// Whether a perturbation has decided already which way the sheet folds.
    is_perturbed: bool,
    /// The part of the Hessian that is tried first: all of it until that turns out to be indefinite.
    hessian: HessianPart,
}

/// What depends on whether there is contact.
#[derive(Debug, Clone, Copy)]
struct Limits {
    steps: usize,
    halvings: usize,
    /// Stiffness of the rods in the merit function, relative to the masses.
    merit_stiffness: f64,
    /// Strain of the isometry that iterates may have.
    iterate_strain: f64,
}

/// A search direction and what the merit function says of it.
struct Direction {
    before: Merit,
    slope: f64,
    hessian: Definiteness,
}

impl<'a, 'b, 'w> Sqp<'a, 'b, 'w> {
    pub(super) fn new(
        minimiser: &'a mut Minimiser,
        problem: &'a mut StepProblem<'b>,
        effort: &'a mut SolverEffort<'w>,
    ) -> Self {
        // In contact the Lagrangian alone is the merit function: augmented it may grow along a step that
        // mends lengths against the barrier.
        let steps = minimiser.options.max_iterations;
        let limits = if problem.has_contact() {
            Limits {
                iterate_strain: ITERATE_STRAIN_IN_CONTACT,
                steps: steps.div_ceil(FEW),
                halvings: MAX_HALVINGS_IN_CONTACT,
                merit_stiffness: 0.0,
            }
        } else {
            Limits {
                iterate_strain: ITERATE_STRAIN,
                steps,
                halvings: MAX_HALVINGS,
                merit_stiffness: minimiser.options.stiffness,
            }
        };
        // Contact is not kept to round-off.
        let first = STIFFNESS[usize::from(problem.has_contact())];
        minimiser.rod_stiffness = minimiser.rod_stiffness.max(first);
        Self {
            minimiser,
            problem,
            effort,
            limits,
            steps_left: limits.steps,
            friction_updates: 0,
            is_perturbed: false,
            hessian: HessianPart::Full,
        }
    }

    /// The relative Newton decrement of the last step; nothing if no minimum was found.
    pub(super) fn run(mut self) -> Option<f64> {
        self.choose_start();
        while self.steps_left > 0 {
            self.steps_left -= 1;
            let is_driven = self.minimiser.lagrangian.is_driven(self.problem);
            let mut direction = self.direction()?;
            let limit = self.minimiser.lagrangian.begin_line_search(self.problem);
            if is_driven {
                if limit == 0.0 {
                    return None;
                }
                self.minimiser.lagrangian.drive(self.problem, limit);
                self.minimiser.lagrangian.merit(self.problem);
                continue;
            }
            let limit = self.correct(limit, &mut direction);
            let Direction { before, slope, .. } = direction;
            let is_round_off = slope.abs() <= before.round_off + self.noise(&before);
            let residual = if is_round_off {
                0.0
            } else {
                (slope.abs() / before.inertia).sqrt()
            };
            let tolerance = self.minimiser.options.tolerance;
            let is_converged = is_round_off || slope.abs() <= tolerance * before.inertia;
            if slope > before.round_off {
                // The step mends the lengths, against the potential. Along exact lengths it descends.
                if !self.restore_lengths() {
                    return None;
                }
                self.minimiser.lagrangian.merit(self.problem);
                let is_renewed = self.renew_friction();
                if is_converged && !self.goes_on(&direction, is_renewed) {
                    return Some(residual);
                }
                continue;
            }
            let Some(length) = self.line_search(limit, &direction) else {
                return (is_round_off && self.restore_lengths()).then_some(residual);
            };
            if length < 1.0 {
                continue;
            }
            let is_renewed = self.renew_friction();
            if is_converged && self.is_near() && !self.goes_on(&direction, is_renewed) {
                if self.restore_lengths() {
                    return Some(residual);
                }
                self.minimiser.lagrangian.merit(self.problem);
            }
        }
        None
    }

    /// Starts at the positions at the start of the step or, where supports have moved on without contact, at
    /// the prediction if its merit is lower.
    fn choose_start(&mut self) {
        let stiffness = self.minimiser.options.stiffness;
        let lagrangian = &mut self.minimiser.lagrangian;
        if self.problem.has_contact() {
            // The prediction may be beyond an obstacle.
        } else if self.problem.model.has_drives() {
            lagrangian.set_stiffness(stiffness, stiffness);
            lagrangian.place_pins(self.problem);
            let start = lagrangian.merit(self.problem).value;
            lagrangian.predict(self.problem);
            if lagrangian.merit(self.problem).value >= start {
                lagrangian.begin(self.problem);
                lagrangian.place_pins(self.problem);
            }
        }
        lagrangian.set_stiffness(self.limits.merit_stiffness, stiffness);
        lagrangian.merit(self.problem);
    }

    /// Solves for the step `-dx` at the iterate and for the multipliers; nothing if there is no step.
    fn direction(&mut self) -> Option<Direction> {
        let hessian = self.solve()?;
        let stiffness = self.minimiser.options.stiffness;
        let lagrangian = &mut self.minimiser.lagrangian;
        // The merit function has the new multipliers.
        lagrangian.set_stiffness(self.limits.merit_stiffness, stiffness);
        lagrangian.set_gradient(self.problem);
        let before = lagrangian.merit(self.problem);
        let slope = lagrangian.slope();
        slope.is_finite().then_some(Direction {
            before,
            slope,
            hessian,
        })
    }

    /// Sets the step `-dx` and the multipliers.
    fn solve(&mut self) -> Option<Definiteness> {
        let model = self.problem.model;
        let constraint_stiffness = self.minimiser.options.stiffness;
        let goal = self.multiplier_goal();
        let Minimiser {
            lagrangian,
            rod_stiffness,
            ..
        } = &mut *self.minimiser;
        self.effort.iterations += 1;
        loop {
            // Vertex constraints stay as soft as in the merit function: their curvature goes by the
            // multiplier estimates, which a large penalty would make those of length errors.
            lagrangian.set_stiffness(*rod_stiffness, constraint_stiffness);
            let (load, part) = (RodLoad::Multipliers, self.hessian);
            let hessian = lagrangian
                .factorize(self.problem, load, part, self.effort)
                .ok()?;
            // What makes the Hessian indefinite rarely ends within a step.
            if hessian == Definiteness::Modified {
                self.hessian = HessianPart::PositiveSemidefinite;
            }
            lagrangian.keep_multipliers();
            let mut violation = None;
            for _ in 0..CONSTRAINT_PASSES {
                lagrangian.set_gradient(self.problem);
                if lagrangian.solve(model, self.effort).is_err() {
                    violation = None;
                    break;
                }
                violation = Some(lagrangian.improve_multipliers(model, goal));
                let [change, largest] = lagrangian.vertex_rows.update_after(&lagrangian.dx);
                if change <= MULTIPLIERS_SETTLED * largest {
                    break;
                }
            }
            let Some(violation) = violation else {
                // The Hessian turned out not to be positive definite.
                if self.hessian == HessianPart::PositiveSemidefinite {
                    return None;
                }
                self.hessian = HessianPart::PositiveSemidefinite;
                lagrangian.restore_multipliers();
                continue;
            };
            if violation <= goal.violation || *rod_stiffness == STIFFNESS[1] {
                return Some(hessian);
            }
            *rod_stiffness = STIFFNESS[1];
            lagrangian.restore_multipliers();
        }
    }

    /// When the multipliers of a step are good enough: once the linearised lengths are within the tolerance.
    fn multiplier_goal(&self) -> MultiplierGoal {
        let violation = self.minimiser.strain_tolerance(self.problem);
        MultiplierGoal {
            max_iterations: MULTIPLIER_ITERATIONS,
            violation,
            change: MULTIPLIERS_SETTLED,
            longest: LONGEST_ITERATION,
        }
    }

    /// Applies the second-order correction for contact to a step of which only the part `limit` is safe; the
    /// part that is safe then.
    fn correct(&mut self, limit: f64, direction: &mut Direction) -> f64 {
        if limit == 1.0 {
            return limit;
        }
        let lagrangian = &mut self.minimiser.lagrangian;
        let limit = lagrangian.correct_gaps(self.problem, limit, self.effort);
        direction.slope = lagrangian.slope();
        limit
    }

    /// Goes on by up to `limit` of the step, not far from the manifold; the part of the step, or nothing if
    /// it does not decrease the merit function.
    fn line_search(&mut self, limit: f64, direction: &Direction) -> Option<f64> {
        let mut length = limit;
        for _ in 0..=self.limits.halvings {
            self.minimiser.lagrangian.move_along(length);
            let to = LengthGoal {
                strain: self.limits.iterate_strain,
                max_iterations: MAX_RESTORATION,
                matrix: FirstMatrix::Factorised,
            };
            let strain = self.minimiser.restore(self.problem, to, self.effort);
            if strain <= to.strain {
                let Direction { before, slope, .. } = direction;
                let now = self.minimiser.lagrangian.merit(self.problem);
                let promised = before.value + ARMIJO * length * slope;
                if now.value <= promised + before.round_off {
                    return Some(length);
                }
            }
            length *= 0.5;
            self.minimiser.lagrangian.return_to_start(self.problem);
        }
        None
    }

    /// Size of decreases that are noise of the lengths, besides round-off.
    fn noise(&self, merit: &Merit) -> f64 {
        if self.limits.steps - self.steps_left <= NOISE_PATIENCE {
            return 0.0;
        }
        LENGTH_NOISE * self.minimiser.options.strain_tolerance * merit.rod_scale
    }

    /// Whether the last restoration will be a small displacement. (In contact the lengths of iterates are
    /// exact enough.)
    fn is_near(&self) -> bool {
        let x = self.minimiser.lagrangian.iterate.x();
        self.problem.has_contact() || self.problem.model.constrained_strain(x) <= SMALL_STRAIN
    }

    /// Lags friction anew at the iterate, unless it has settled or been renewed too often; whether it was
    /// renewed.
    ///
    /// Friction follows after every full step, not only where the minimisation with lagged friction has
    /// converged: sheets of 289 vertices on a table need three quarters of the factorisations.
    fn renew_friction(&mut self) -> bool {
        let Minimiser {
            options,
            lagrangian,
            ..
        } = &mut *self.minimiser;
        if self.friction_updates == options.max_friction_updates {
            return false;
        }
        let is_renewed = lagrangian.renew_friction(self.problem, options.friction_tolerance);
        if is_renewed {
            lagrangian.merit(self.problem);
        }
        is_renewed
    }

    /// Begins anew from a point that has converged but is no minimum: a saddle, where the sheet could fold
    /// either way, or one whose friction belonged to other normal forces and was renewed. Returns false if
    /// there is no reason to.
    fn goes_on(&mut self, direction: &Direction, is_renewed: bool) -> bool {
        // Without contact the strategy that comes first looks for saddles: others start off them.
        let first = Strategy::list(self.problem, self.minimiser.faces).first();
        let may_be_saddle = direction.hessian == Definiteness::Modified
            && !self.problem.has_contact()
            && first == Some(&Strategy::Sqp)
            && !self.is_perturbed;
        let Minimiser {
            options,
            lagrangian,
            ..
        } = &mut *self.minimiser;
        let least = options.tolerance * direction.before.inertia;
        if may_be_saddle && lagrangian.leave_saddle(self.problem, options.seed, least, self.effort)
        {
            self.is_perturbed = true;
        } else if is_renewed {
            self.friction_updates += 1;
        } else {
            return false;
        }
        self.steps_left = self.limits.steps;
        true
    }

    /// Restores the lengths exactly; whether that succeeds.
    fn restore_lengths(&mut self) -> bool {
        let to = LengthGoal {
            strain: self.minimiser.strain_tolerance(self.problem),
            max_iterations: MAX_LAST_RESTORATION,
            matrix: FirstMatrix::Factorised,
        };
        self.minimiser.restore(self.problem, to, self.effort) <= to.strain
    }
}
