//! Newton's method on the augmented Lagrangian, in rounds of the method of multipliers, and the projection that ends them.

use super::{Minimiser, READY, SETTLED, Step, not_converged};
use crate::constraint::rows::HessianPart;
use crate::primal::{dot, strain_floor};
use crate::project::{Aim, Held};
use crate::report::{Effort, Path, StepError};
use isosheet_coords::linalg::LinalgError;
use rand::{RngExt, SeedableRng};
use rand_chacha::ChaCha8Rng;

/// Size of the branch perturbation in lengths of a vertex's shortest rod: large enough to leave a saddle, too
/// small to be seen.
const BRANCH_PERTURBATION: f64 = 1e-4;
/// Armijo's constant.
const ARMIJO: f64 = 1e-4;
/// A Newton step shortened below this fraction is not a sign of convergence.
const NEARLY_FULL: f64 = 0.2;
/// Iterations in which bodies and pins have to get to the ends of their motions. They arrive in one or two
/// where nothing is in the way; a step that needs more is better halved.
const MAX_DRIVEN: usize = 20;
/// Rounds of the method of multipliers before the projection where there is contact. A sheet that lies flat resists
/// a projection: it would have to fold against the barrier, by the root of the length error. Multipliers take the
/// load instead, and each round shrinks the error by the penalty.
const MAX_ROUNDS: usize = 12;
/// Growth of the penalty from round to round. Ten keeps Newton's method close to its quadratic range: with thirty
/// a sheet draping on a floor needs twice the iterations.
const GROWTH: f64 = 10.0;
/// Tolerance of the rounds after the first: they only shift load from the penalty to the multipliers.
const LOOSE: f64 = 1e-2;

impl Minimiser {
    /// One minimisation from the iterate, followed by the projection onto the lengths.
    pub(super) fn descend(
        &mut self,
        step: &mut Step<'_, '_>,
        effort: &mut Effort,
    ) -> Result<(f64, Path), StepError> {
        let result = self.rounds(step, effort);
        self.penalty.copy_from_slice(&self.first_penalty);
        result
    }

    fn rounds(
        &mut self,
        step: &mut Step<'_, '_>,
        effort: &mut Effort,
    ) -> Result<(f64, Path), StepError> {
        let model = step.scene.model;
        let tolerance = self
            .options
            .strain_tolerance
            .max(strain_floor(model, step.state));
        let mut path = Path::Newton;
        let rounds = if step.has_contact() { MAX_ROUNDS } else { 1 };
        let (mut residual, mut strain) = (f64::INFINITY, f64::INFINITY);
        for round in 0..rounds {
            // The second attempt is careful throughout.
            let loose = if round > 0 && self.ready == READY {
                LOOSE
            } else {
                0.0
            };
            let converged = self.newton(step, loose, &mut residual, &mut path, effort)?;
            for e in 0..self.c.len() {
                self.multipliers[e] += self.penalty[e] * self.c[e];
            }
            self.vertex_rows.update();
            self.set_balance(step);
            if !converged {
                strain = f64::INFINITY;
                break;
            }
            if round == 0 {
                self.first_multipliers.copy_from_slice(&self.multipliers);
            }
            if round + 1 < rounds && model.rods().max_strain(self.iterate.x()) > self.ready {
                self.penalty.iter_mut().for_each(|p| *p *= GROWTH);
                continue;
            }
            let held = step.scene.contact.as_mut().map(|contact| Held {
                contact,
                scale: step.h * step.h,
            });
            strain = self.projector.positions(
                model,
                &mut self.matrix,
                held,
                &mut self.iterate,
                Aim {
                    tolerance,
                    max_iterations: self.options.max_projections,
                    t: step.t,
                    loads: &self.vertex_rows.multipliers,
                },
                effort,
            );
            if strain <= tolerance {
                let per = 1.0 / (step.h * step.h);
                self.balance.trail.append(&self.projector.trail, per);
                self.multipliers.copy_from_slice(&self.first_multipliers);
                return Ok((residual, path));
            }
            model.rods().residual_into(self.iterate.x(), &mut self.c);
            self.vertex_rows
                .evaluate(model.constraints(), step.t, self.iterate.x());
        }
        if strain == f64::INFINITY {
            strain = model.rods().max_strain(self.iterate.x());
        }
        self.forget();
        let (t, h) = (step.state.t, step.t - step.state.t);
        Err(not_converged(t, h, effort, residual, strain))
    }

    /// Newton's method on the augmented Lagrangian; whether it converged.
    fn newton(
        &mut self,
        step: &mut Step<'_, '_>,
        loose: f64,
        residual: &mut f64,
        path: &mut Path,
        effort: &mut Effort,
    ) -> Result<bool, StepError> {
        let model = step.scene.model;
        let (mut driven, mut updates) = (0, 0);
        let mut merit = self.merit(step);
        for _ in 0..self.options.max_iterations {
            let is_driven = self.is_driven(step);
            self.gradient(step);
            if is_driven {
                self.add_drive(step);
            }
            effort.iterations += 1;
            let modified = self
                .factorize(step, effort)
                .map_err(|source| StepError::Linalg {
                    t: step.state.t,
                    source,
                })?;
            if modified {
                *path = (*path).max(Path::Globalised);
            }
            self.matrix.solve(model, &self.gradient, &mut self.dx);
            let slope = -dot(&self.dx, &self.gradient);
            if !slope.is_finite() {
                self.forget();
                let (t, h) = (step.state.t, step.t - step.state.t);
                return Err(not_converged(t, h, effort, *residual, f64::NAN));
            }
            let tolerance = self.options.tolerance.max(loose);
            let promised = tolerance * merit.inertia;
            *residual = if -slope > merit.round_off {
                (-slope / merit.inertia).sqrt()
            } else {
                0.0
            };
            self.start.copy_from_slice(self.iterate.x());
            let limit = self.limit(step);
            if is_driven {
                driven += 1;
                if driven > MAX_DRIVEN || limit == 0.0 {
                    return Ok(false);
                }
                self.drive(step, limit);
                merit = self.merit(step);
                continue;
            }
            let mut length = limit;
            loop {
                self.move_along(length);
                let now = self.merit(step);
                if now.value <= merit.value + ARMIJO * length * slope + merit.round_off
                    || length < 1e-9
                {
                    merit = now;
                    break;
                }
                length *= 0.5;
            }
            if length < 1.0 {
                *path = (*path).max(Path::Globalised);
            }
            if length >= NEARLY_FULL && -slope <= promised.max(merit.round_off) {
                if modified && *path != Path::BranchSeeded {
                    // No slope left, but the curvature is negative somewhere: a saddle, where
                    // the sheet could fold either way.
                    *path = Path::BranchSeeded;
                    self.perturb(step);
                    merit = self.merit(step);
                    continue;
                }
                if updates < self.options.max_friction_updates
                    && self.renew_friction(step) > SETTLED
                {
                    updates += 1;
                    merit = self.merit(step);
                    continue;
                }
                return Ok(true);
            }
        }
        Ok(false)
    }

    /// Largest safe part of the displacement `-dx`, pinned vertices going to their ends.
    pub(super) fn limit(&mut self, step: &mut Step<'_, '_>) -> f64 {
        if !step.has_contact() {
            return 1.0;
        }
        let x = self.iterate.x();
        for v in step.scene.model.moving_pins() {
            for i in 3 * v..3 * v + 3 {
                self.dx[i] = x[i] - self.end[i];
            }
        }
        for (w, d) in self.weighted.iter_mut().zip(&self.dx) {
            *w = -d;
        }
        self.iterate
            .safe_fraction(step.contact_mut(), &self.weighted)
    }

    /// Puts the iterate at the part `length` of the displacement `-dx` from the start of the line search.
    pub(super) fn move_along(&mut self, length: f64) {
        let displaced = self.start.iter().zip(&self.dx);
        for (x, (start, dx)) in self.iterate.x_mut().iter_mut().zip(displaced) {
            *x = start - length * dx;
        }
    }

    /// Lags friction anew at the iterate; the relative change of its normal forces, zero without friction.
    pub(super) fn renew_friction(&mut self, step: &Step<'_, '_>) -> f64 {
        self.iterate.renew_friction(step.contact(), &step.state.x)
    }

    /// Moves sheet, pins and bodies on together.
    pub(super) fn drive(&mut self, step: &Step<'_, '_>, part: f64) {
        self.move_along(part);
        if part == 1.0 {
            let x = self.iterate.x_mut();
            for v in step.scene.model.moving_pins() {
                x[3 * v..3 * v + 3].copy_from_slice(&self.end[3 * v..3 * v + 3]);
            }
        }
        self.iterate.advance_bodies(part);
    }

    /// Factorises the Hessian; true if it was indefinite and had to be modified.
    fn factorize(&mut self, step: &Step<'_, '_>, effort: &mut Effort) -> Result<bool, LinalgError> {
        let model = step.scene.model;
        if let Some(terms) = self.iterate.terms(step.contact()) {
            self.matrix.make_room(model, &terms)?;
        }
        self.along.copy_from_slice(&self.penalty);
        self.across.copy_from_slice(&self.density);
        effort.factorisations += 1;
        self.assemble(step, HessianPart::Full);
        self.add_potentials(step);
        if self.matrix.factorize().is_ok() {
            return Ok(false);
        }
        // Each rod's own Hessian, projected onto the positive semidefinite matrices:
        // eigenvalues p across and p + r |d|^2 along the rod.
        for e in 0..self.c.len() {
            let l = model.rods().lengths()[e];
            let squared = (l * l + 2.0 * self.c[e]).max(f64::MIN_POSITIVE);
            if self.density[e] < 0.0 {
                self.along[e] = (self.penalty[e] + self.density[e] / squared).max(0.0);
                self.across[e] = 0.0;
            }
        }
        effort.factorisations += 1;
        self.assemble(step, HessianPart::PositiveSemidefinite);
        self.add_potentials(step);
        if self.matrix.factorize().is_ok() {
            return Ok(true);
        }
        // The potentials are concave here: leave their curvature out.
        effort.factorisations += 1;
        self.assemble(step, HessianPart::PositiveSemidefinite);
        self.matrix.factorize()?;
        Ok(true)
    }

    /// Masses, rods, vertex constraints and contact.
    pub(super) fn assemble(&mut self, step: &Step<'_, '_>, part: HessianPart) {
        let model = step.scene.model;
        self.matrix
            .assemble(model, self.iterate.x(), &self.along, &self.across);
        self.vertex_rows
            .add_hessian(part, &mut self.matrix.sink(model));
        if let Some(terms) = self.iterate.terms(step.contact()) {
            self.matrix.add_contact(model, &terms, step.h * step.h);
        }
    }

    pub(super) fn add_potentials(&mut self, step: &Step<'_, '_>) {
        let (model, x) = (step.scene.model, self.iterate.x());
        self.matrix
            .add_potentials(model, step.t, x, step.h * step.h);
    }

    /// Displaces the iterate off a saddle.
    pub(super) fn perturb(&mut self, step: &mut Step<'_, '_>) {
        let model = step.scene.model;
        let mut rng = ChaCha8Rng::seed_from_u64(self.options.seed);
        for (i, d) in self.dx.iter_mut().enumerate() {
            let size = BRANCH_PERTURBATION * model.shortest_rod(i / 3);
            *d = rng.random_range(-size..=size);
        }
        model.clear_pinned(&mut self.dx);
        let part = self.iterate.safe_fraction(step.contact_mut(), &self.dx);
        for (x, d) in self.iterate.x_mut().iter_mut().zip(&self.dx) {
            *x += part * d;
        }
    }
}
