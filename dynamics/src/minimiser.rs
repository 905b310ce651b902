//! Minimisation of an implicit step's incremental potential under the length constraints.

use crate::ImplicitOptions;
use crate::primal::{PrimalMatrix, dot, penalties, strain_floor};
use crate::project::Projector;
use crate::report::{Effort, Path, StepError};
use crate::{SheetModel, State};
use isosheet_coords::linalg::LinalgError;
use rand::{RngExt, SeedableRng};
use rand_chacha::ChaCha8Rng;

/// Size of the branch perturbation in lengths of a vertex's shortest rod: large enough to leave a saddle, too
/// small to be seen.
const BRANCH_PERTURBATION: f64 = 1e-4;
/// Armijo's constant.
const ARMIJO: f64 = 1e-4;
/// Ratios of squared steps over which multipliers are carried; beyond, the motion has changed too
/// much for them to be of use.
const MULTIPLIER_RATIOS: std::ops::RangeInclusive<f64> = 0.05..=20.0;
/// A Newton step shortened below this fraction is not a sign of convergence.
const NEARLY_FULL: f64 = 0.2;

/// Minimises `|x - target|_M^2 / 2 + h^2 (V(x) - f . x)` over all positions with the rest lengths:
/// a minimisation that always descends, in place of a root finder that may not converge.
///
/// 1. Augmented Lagrangian with the impulses of the previous step as multipliers, minimised by
///    Newton's method with line search. Its Hessian is tried as it is and, where it is
///    indefinite, with the negative part of the rods' geometric stiffness left out.
/// 2. Projection onto the lengths, which makes them exact.
pub(crate) struct Minimiser {
    options: ImplicitOptions,
    matrix: PrimalMatrix,
    projector: Projector,
    /// Impulse multipliers of the rods (h^2 times force densities), kept from step to step.
    multipliers: Vec<f64>,
    multiplier_step: f64,
    penalty: Vec<f64>,
    along: Vec<f64>,
    across: Vec<f64>,
    density: Vec<f64>,
    c: Vec<f64>,
    /// Where inertia alone would take the sheet.
    pub(crate) target: Vec<f64>,
    force: Vec<f64>,
    /// Non-conservative forces, constant over the step.
    pub(crate) applied: Vec<f64>,
    gradient: Vec<f64>,
    difference: Vec<f64>,
    weighted: Vec<f64>,
    dx: Vec<f64>,
    /// The iterate and, after [`Minimiser::minimise`], the result.
    pub(crate) x: Vec<f64>,
    start: Vec<f64>,
}

/// The augmented Lagrangian at an iterate.
struct Merit {
    /// Its inertia term.
    inertia: f64,
    /// Without the rods: the incremental potential.
    potential: f64,
    /// Size of the multipliers' terms, `sum |L| l^2`.
    rod_scale: f64,
    /// Its value.
    value: f64,
    /// Round-off in the value.
    round_off: f64,
}

impl Minimiser {
    pub(crate) fn new(model: &SheetModel, options: ImplicitOptions) -> Result<Self, LinalgError> {
        let (n, m) = (model.coordinate_count(), model.rods().len());
        Ok(Self {
            matrix: PrimalMatrix::new(model)?,
            projector: Projector::new(model),
            multipliers: vec![0.0; m],
            multiplier_step: 0.0,
            penalty: penalties(model, options.stiffness),
            along: vec![0.0; m],
            across: vec![0.0; m],
            density: vec![0.0; m],
            c: vec![0.0; m],
            target: vec![0.0; n],
            force: vec![0.0; n],
            applied: vec![0.0; n],
            gradient: vec![0.0; n],
            difference: vec![0.0; n],
            weighted: vec![0.0; n],
            dx: vec![0.0; n],
            x: vec![0.0; n],
            start: vec![0.0; n],
            options,
        })
    }

    /// The augmented Lagrangian at `self.x`; sets `self.c`.
    fn merit(&mut self, model: &SheetModel, t: f64, h: f64) -> Merit {
        for i in 0..self.x.len() {
            self.difference[i] = self.x[i] - self.target[i];
        }
        let inertia = model.kinetic_energy(&self.difference);
        let work = dot(&self.applied, &self.difference);
        model.rods().residual_into(&self.x, &mut self.c);
        let rods: f64 = (0..self.c.len())
            .map(|e| (self.multipliers[e] + 0.5 * self.penalty[e] * self.c[e]) * self.c[e])
            .sum();
        // Round-off of c is that of the squared lengths.
        let rod_scale: f64 = self
            .multipliers
            .iter()
            .zip(model.rods().lengths())
            .map(|(m, l)| m.abs() * l * l)
            .sum();
        // And where inertia alone has the right lengths already, nothing but the round-off of the
        // positions is left to minimise.
        let size = self.x.iter().fold(0.0_f64, |m, x| m.max(x.abs()));
        let still: f64 = self
            .penalty
            .iter()
            .zip(model.rods().lengths())
            .map(|(p, l)| p * (f64::EPSILON * l * (size + l)).powi(2))
            .sum();
        let potential = model.potential_energy(t, &self.x);
        Merit {
            inertia,
            value: inertia + h * h * (potential - work) + rods,
            potential: inertia + h * h * (potential - work),
            rod_scale,
            round_off: 8.0
                * f64::EPSILON
                * (inertia + h * h * (potential.abs() + work.abs()) + rods.abs() + rod_scale)
                + 64.0 * still,
        }
    }

    /// Gradient of the augmented Lagrangian at `self.x`, with `self.c` current; sets the
    /// force densities of the rods.
    fn gradient(&mut self, model: &SheetModel, t: f64, h: f64) {
        for i in 0..self.x.len() {
            self.difference[i] = self.x[i] - self.target[i];
        }
        model.apply_mass(&self.difference, &mut self.weighted);
        model.potential_force(t, &self.x, &mut self.force);
        for i in 0..self.x.len() {
            self.gradient[i] = self.weighted[i] - h * h * (self.force[i] + self.applied[i]);
        }
        for e in 0..self.c.len() {
            self.density[e] = self.multipliers[e] + self.penalty[e] * self.c[e];
        }
        model
            .rods()
            .apply_transpose_add(&self.x, &self.density, &mut self.gradient);
        model.clear_pinned(&mut self.gradient);
    }

    /// Factorises the Hessian; true if it was indefinite and had to be modified.
    fn factorize(
        &mut self,
        model: &SheetModel,
        t: f64,
        h: f64,
        effort: &mut Effort,
    ) -> Result<bool, LinalgError> {
        self.along.copy_from_slice(&self.penalty);
        self.across.copy_from_slice(&self.density);
        effort.factorisations += 1;
        self.matrix
            .assemble(model, &self.x, &self.along, &self.across);
        self.matrix.add_potentials(model, t, &self.x, h * h);
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
        self.matrix
            .assemble(model, &self.x, &self.along, &self.across);
        self.matrix.add_potentials(model, t, &self.x, h * h);
        if self.matrix.factorize().is_ok() {
            return Ok(true);
        }
        // The potentials are concave here: leave their curvature out.
        effort.factorisations += 1;
        self.matrix
            .assemble(model, &self.x, &self.along, &self.across);
        self.matrix.factorize()?;
        Ok(true)
    }

    /// Displaces the iterate off a saddle.
    fn perturb(&mut self, model: &SheetModel) {
        let mut rng = ChaCha8Rng::seed_from_u64(self.options.seed);
        for (i, d) in self.dx.iter_mut().enumerate() {
            let size = BRANCH_PERTURBATION * model.shortest_rod(i / 3);
            *d = rng.random_range(-size..=size);
        }
        model.clear_pinned(&mut self.dx);
        for (x, d) in self.x.iter_mut().zip(&self.dx) {
            *x += d;
        }
    }

    /// Minimises the incremental potential over all positions with the rest lengths, with
    /// [`Minimiser::target`] and [`Minimiser::applied`] set. `h` is the effective step, the
    /// factor of the acceleration being `h^2`; forces are those at time `t1`.
    ///
    /// The positions at the start have the rest lengths too, so a result with a higher
    /// incremental potential than theirs is no minimum, and would create energy: then the
    /// minimisation starts anew, from them.
    ///
    /// Returns the relative Newton decrement and the path.
    pub(crate) fn minimise(
        &mut self,
        model: &SheetModel,
        state: &State,
        t1: f64,
        h: f64,
        effort: &mut Effort,
    ) -> Result<(f64, Path), StepError> {
        let ratio = (h / self.multiplier_step).powi(2);
        if MULTIPLIER_RATIOS.contains(&ratio) {
            self.multipliers.iter_mut().for_each(|m| *m *= ratio);
        } else {
            self.multipliers.fill(0.0);
        }
        self.multiplier_step = h;
        self.x.copy_from_slice(&state.x);
        let bound = self.merit(model, t1, h);
        self.x.copy_from_slice(&self.target);
        let first = self.descend(model, state, t1, h, effort);
        if let Ok(done) = first
            && self.is_below(&bound, model, t1, h)
        {
            return Ok(done);
        }
        self.multipliers.fill(0.0);
        self.x.copy_from_slice(&state.x);
        let (residual, path) = self.descend(model, state, t1, h, effort)?;
        if self.is_below(&bound, model, t1, h) {
            return Ok((residual, path.max(Path::Globalised)));
        }
        self.multipliers.fill(0.0);
        let strain = model.rods().max_strain(&self.x);
        Err(not_converged(state.t, h, effort, residual, strain))
    }

    /// Whether the incremental potential at the iterate is not above `bound`, but for what the
    /// tolerance of the lengths and round-off allow.
    fn is_below(&mut self, bound: &Merit, model: &SheetModel, t: f64, h: f64) -> bool {
        let now = self.merit(model, t, h);
        let slack = 10.0 * (now.round_off + bound.round_off)
            + 10.0 * self.options.strain_tolerance * now.rod_scale.max(bound.rod_scale);
        now.potential <= bound.potential + slack
    }

    /// One minimisation from the iterate, followed by the projection onto the lengths.
    fn descend(
        &mut self,
        model: &SheetModel,
        state: &State,
        t1: f64,
        h: f64,
        effort: &mut Effort,
    ) -> Result<(f64, Path), StepError> {
        let mut path = Path::Newton;
        let mut residual = f64::INFINITY;
        let mut converged = false;
        let mut merit = self.merit(model, t1, h);
        for _ in 0..self.options.max_iterations {
            self.gradient(model, t1, h);
            effort.iterations += 1;
            let modified = self
                .factorize(model, t1, h, effort)
                .map_err(|source| StepError::Linalg { t: state.t, source })?;
            if modified {
                path = path.max(Path::Globalised);
            }
            self.matrix.solve(model, &self.gradient, &mut self.dx);
            let slope = -dot(&self.dx, &self.gradient);
            if !slope.is_finite() {
                self.multipliers.fill(0.0);
                return Err(not_converged(state.t, h, effort, residual, f64::NAN));
            }
            let promised = self.options.tolerance * merit.inertia;
            residual = if -slope > merit.round_off {
                (-slope / merit.inertia).sqrt()
            } else {
                0.0
            };
            self.start.copy_from_slice(&self.x);
            let mut length = 1.0;
            loop {
                for i in 0..self.x.len() {
                    self.x[i] = self.start[i] - length * self.dx[i];
                }
                let now = self.merit(model, t1, h);
                if now.value <= merit.value + ARMIJO * length * slope + merit.round_off
                    || length < 1e-9
                {
                    merit = now;
                    break;
                }
                length *= 0.5;
            }
            if length < 1.0 {
                path = path.max(Path::Globalised);
            }
            if length >= NEARLY_FULL && -slope <= promised.max(merit.round_off) {
                if modified && path != Path::BranchSeeded {
                    // No slope left, but the curvature is negative somewhere: a saddle, where
                    // the sheet could fold either way.
                    path = Path::BranchSeeded;
                    self.perturb(model);
                    merit = self.merit(model, t1, h);
                    continue;
                }
                converged = true;
                break;
            }
        }
        for e in 0..self.c.len() {
            self.multipliers[e] += self.penalty[e] * self.c[e];
        }
        let tolerance = self
            .options
            .strain_tolerance
            .max(strain_floor(model, state));
        let strain = if converged {
            self.projector.positions(
                model,
                &mut self.matrix,
                &mut self.x,
                tolerance,
                self.options.max_projections,
                effort,
            )
        } else {
            model.rods().max_strain(&self.x)
        };
        if !(converged && strain <= tolerance) {
            self.multipliers.fill(0.0);
            return Err(not_converged(state.t, h, effort, residual, strain));
        }
        Ok((residual, path))
    }
}

pub(crate) fn not_converged(
    t: f64,
    h: f64,
    effort: &Effort,
    residual: f64,
    strain: f64,
) -> StepError {
    StepError::NotConverged {
        t,
        h,
        iterations: effort.iterations,
        residual,
        strain,
    }
}
