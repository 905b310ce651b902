//! Minimisation of an implicit step's incremental potential under the length constraints.

use crate::ImplicitOptions;
use crate::constraint::rows::{Bending, VertexRows};
use crate::contact::{Contact, ContactWork};
use crate::integrator::Scene;
use crate::model::PINNED;
use crate::primal::{PrimalMatrix, dot, penalties, strain_floor};
use crate::project::{Aim, Held, Projector};
use crate::reaction::{Balance, ForceTime};
use crate::report::{Effort, Path, StepError};
use crate::{SheetModel, State};
use isosheet_coords::linalg::LinalgError;
use nalgebra::Vector3;
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
/// Iterations in which bodies and pins have to get to the ends of their motions. They arrive in one or two
/// where nothing is in the way; a step that needs more is better halved.
const MAX_DRIVEN: usize = 20;
/// Rounds of the method of multipliers before the projection where there is contact. A sheet that lies flat resists
/// a projection: it would have to fold against the barrier, by the root of the length error. Multipliers take the
/// load instead, and each round shrinks the error by the penalty.
const MAX_ROUNDS: usize = 12;
/// Edge strain from which the projection of a sheet in contact is a small step. Where it is not, for a nearly
/// flat sheet folds by the root of its length error, the second attempt leaves nothing to the projection.
const READY: f64 = 1e-5;
/// Growth of the penalty from round to round. Ten keeps Newton's method close to its quadratic range: with thirty
/// a sheet draping on a floor needs twice the iterations.
const GROWTH: f64 = 10.0;
/// Part of the largest fold that the tolerance of the lengths allows by which contact at rest may move.
const PLAY: f64 = 0.1;
/// Tolerance of the rounds after the first: they only shift load from the penalty to the multipliers.
const LOOSE: f64 = 1e-2;
/// Relative change of friction's normal forces below which they count as settled.
const SETTLED: f64 = 0.05;

/// Minimises `|x - target|_M^2 / 2 + h^2 (V(x) + B(x) + D(x - x0) - f . x)` over all positions with the rest lengths,
/// `B` and `D` being contact and its friction where a scene has any: a minimisation that always descends, in place of a
/// root finder that may not converge.
///
/// 1. Augmented Lagrangian with the impulses of the previous step as multipliers, minimised by
///    Newton's method with line search. Its Hessian is tried as it is and, where it is
///    indefinite, with the negative part of the rods' geometric stiffness left out.
/// 2. Projection onto the lengths, which makes them exact.
///
/// With contact every displacement, of either stage, is cut to the part that is proven to bring nothing into contact. Pins and
/// bodies in motion start where they were and advance with the iterates.
pub(crate) struct Minimiser {
    options: ImplicitOptions,
    matrix: PrimalMatrix,
    projector: Projector,
    /// Impulse multipliers of the rods (h^2 times force densities), kept from step to step.
    multipliers: Vec<f64>,
    multiplier_step: f64,
    /// Those of the first round, whose penalty is the one that the next step begins with. (In a nearly flat sheet
    /// the ones of later rounds grow without bound.)
    first_multipliers: Vec<f64>,
    penalty: Vec<f64>,
    /// The penalty that every step begins with.
    first_penalty: Vec<f64>,
    along: Vec<f64>,
    across: Vec<f64>,
    density: Vec<f64>,
    c: Vec<f64>,
    /// Edge strain from which the projection takes over where there is contact.
    ready: f64,
    /// Vertices on curves and surfaces.
    vertex_rows: VertexRows,
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
    /// Where prescribed motions end, at the pinned vertices.
    end: Vec<f64>,
    pub(crate) balance: Balance,
}

/// The problem of one step.
struct Step<'a, 'b> {
    scene: &'a mut Scene<'b>,
    state: &'a State,
    /// Time at the end, seconds.
    t: f64,
    /// Effective step, the root of the factor of the forces, seconds.
    h: f64,
}

impl Step<'_, '_> {
    fn contact(&self) -> Option<&(dyn Contact + 'static)> {
        self.scene.contact.as_deref()
    }

    /// Largest safe part of a displacement.
    fn safe_fraction(&mut self, x: &[f64], dx: &[f64]) -> f64 {
        match &mut self.scene.contact {
            None => 1.0,
            Some(contact) => contact.safe_fraction(x, dx),
        }
    }
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
            first_multipliers: vec![0.0; m],
            multiplier_step: 0.0,
            penalty: penalties(model, options.stiffness),
            first_penalty: penalties(model, options.stiffness),
            along: vec![0.0; m],
            across: vec![0.0; m],
            density: vec![0.0; m],
            c: vec![0.0; m],
            ready: READY,
            vertex_rows: VertexRows::new(model, options.stiffness),
            target: vec![0.0; n],
            force: vec![0.0; n],
            applied: vec![0.0; n],
            gradient: vec![0.0; n],
            difference: vec![0.0; n],
            weighted: vec![0.0; n],
            dx: vec![0.0; n],
            x: vec![0.0; n],
            start: vec![0.0; n],
            end: vec![0.0; n],
            balance: Balance::with_trail(model, ForceTime::End),
            options,
        })
    }

    /// The augmented Lagrangian at `self.x`; sets `self.c`.
    fn merit(&mut self, step: &Step<'_, '_>) -> Merit {
        let (model, t, h) = (step.scene.model, step.t, step.h);
        for i in 0..self.x.len() {
            self.difference[i] = self.x[i] - self.target[i];
        }
        let inertia = model.kinetic_energy(&self.difference);
        let work = dot(&self.applied, &self.difference);
        model.rods().residual_into(&self.x, &mut self.c);
        self.vertex_rows.evaluate(model, t, &self.x);
        let rods: f64 = (0..self.c.len())
            .map(|e| (self.multipliers[e] + 0.5 * self.penalty[e] * self.c[e]) * self.c[e])
            .sum::<f64>()
            + self.vertex_rows.value();
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
        let (load, vertex_still) = self.vertex_rows.scales(model, size);
        let (rod_scale, still) = (rod_scale + load, still + vertex_still);
        let mut potential = model.potential_energy(t, &self.x);
        if let Some(contact) = step.contact() {
            potential += contact.energy(&self.x);
        }
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
    fn gradient(&mut self, step: &Step<'_, '_>) {
        let (model, t, h) = (step.scene.model, step.t, step.h);
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
        self.vertex_rows.add_gradient(model, &mut self.gradient);
        if let Some(contact) = step.contact() {
            contact.add_gradient(&self.x, h * h, &mut self.gradient);
        }
        model.clear_pinned(&mut self.gradient);
    }

    /// Adds to the gradient what the rest of the prescribed motions will change it by, to first order.
    fn add_drive(&mut self, step: &Step<'_, '_>) {
        let model = step.scene.model;
        if let Some(contact) = step.contact() {
            contact.add_drive(&self.x, step.h * step.h, &mut self.gradient);
        }
        let free = model.free_index();
        for (e, &[a, b]) in model.rods().edges().iter().enumerate() {
            let (pin, end) = match (free[a] == PINNED, free[b] == PINNED) {
                (true, false) => (a, b),
                (false, true) => (b, a),
                _ => continue,
            };
            let at = |x: &[f64], v: usize| Vector3::new(x[3 * v], x[3 * v + 1], x[3 * v + 2]);
            let (d, u) = (
                at(&self.x, end) - at(&self.x, pin),
                at(&self.end, pin) - at(&self.x, pin),
            );
            let change = self.density[e] * u + self.penalty[e] * d.dot(&u) * d;
            for k in 0..3 {
                self.gradient[3 * end + k] -= change[k];
            }
        }
        model.clear_pinned(&mut self.gradient);
    }

    /// Factorises the Hessian; true if it was indefinite and had to be modified.
    fn factorize(&mut self, step: &Step<'_, '_>, effort: &mut Effort) -> Result<bool, LinalgError> {
        let model = step.scene.model;
        if let Some(contact) = step.contact() {
            self.matrix.make_room(model, contact, &self.x)?;
        }
        self.along.copy_from_slice(&self.penalty);
        self.across.copy_from_slice(&self.density);
        effort.factorisations += 1;
        self.assemble(step, Bending::Full);
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
        self.assemble(step, Bending::Positive);
        self.add_potentials(step);
        if self.matrix.factorize().is_ok() {
            return Ok(true);
        }
        // The potentials are concave here: leave their curvature out.
        effort.factorisations += 1;
        self.assemble(step, Bending::Positive);
        self.matrix.factorize()?;
        Ok(true)
    }

    /// Masses, rods, vertex constraints and contact.
    fn assemble(&mut self, step: &Step<'_, '_>, bending: Bending) {
        let model = step.scene.model;
        self.matrix
            .assemble(model, &self.x, &self.along, &self.across);
        self.vertex_rows
            .add_hessian(model, &mut self.matrix, bending);
        if let Some(contact) = step.contact() {
            self.matrix
                .add_contact(model, contact, &self.x, step.h * step.h);
        }
    }

    fn add_potentials(&mut self, step: &Step<'_, '_>) {
        self.matrix
            .add_potentials(step.scene.model, step.t, &self.x, step.h * step.h);
    }

    /// Displaces the iterate off a saddle.
    fn perturb(&mut self, step: &mut Step<'_, '_>) {
        let model = step.scene.model;
        let mut rng = ChaCha8Rng::seed_from_u64(self.options.seed);
        for (i, d) in self.dx.iter_mut().enumerate() {
            let size = BRANCH_PERTURBATION * model.shortest_rod(i / 3);
            *d = rng.random_range(-size..=size);
        }
        model.clear_pinned(&mut self.dx);
        let part = step.safe_fraction(&self.x, &self.dx);
        for (x, d) in self.x.iter_mut().zip(&self.dx) {
            *x += part * d;
        }
    }

    /// Minimises the incremental potential over all positions with the rest lengths, with
    /// [`Minimiser::target`] and [`Minimiser::applied`] set. `span` is the step, `h` the effective step, the
    /// factor of the acceleration being `h^2`; forces are those at the end.
    ///
    /// The positions at the start have the rest lengths too, so a result with a higher
    /// incremental potential than theirs is no minimum, and would create energy: then the
    /// minimisation starts anew, from them. (Where pins or bodies move, the start is not among the
    /// positions to choose from, and there is no such bound.)
    ///
    /// Returns the relative Newton decrement, the path and what contact did.
    pub(crate) fn minimise(
        &mut self,
        mut scene: Scene<'_>,
        state: &State,
        span: f64,
        h: f64,
        effort: &mut Effort,
    ) -> Result<(f64, Path, ContactWork), StepError> {
        let ratio = (h / self.multiplier_step).powi(2);
        if MULTIPLIER_RATIOS.contains(&ratio) {
            self.multipliers.iter_mut().for_each(|m| *m *= ratio);
            self.vertex_rows.scale(ratio);
        } else {
            self.forget();
        }
        self.multiplier_step = h;
        let mut step = Step {
            scene: &mut scene,
            state,
            t: state.t + span,
            h,
        };
        let stored = self.begin(&mut step, span);
        self.x.copy_from_slice(&state.x);
        let driven = self.is_driven(&step) || step.scene.model.has_drives();
        let bound = (!driven).then(|| self.merit(&step));
        self.predict(&mut step);
        self.ready = READY;
        let mut result = self.descend(&mut step, effort);
        if !(result.is_ok() && self.is_below(bound.as_ref(), &step)) {
            self.forget();
            self.ready = self.options.strain_tolerance;
            self.begin(&mut step, span);
            self.x.copy_from_slice(&state.x);
            if step.contact().is_none() {
                step.scene.model.place_pins(step.t, &mut self.x);
            }
            let (residual, path) = self.descend(&mut step, effort)?;
            if !self.is_below(bound.as_ref(), &step) {
                self.forget();
                let strain = step.scene.model.rods().max_strain(&self.x);
                return Err(not_converged(state.t, span, effort, residual, strain));
            }
            result = Ok((residual, path.max(Path::Globalised)));
        }
        let (residual, path) = result?;
        let mut work = ContactWork::default();
        let play = self.play(&step);
        if let Some(contact) = &mut step.scene.contact {
            work = contact.finish(&self.x);
            work.stored = contact.potential(&self.x) - stored;
            work.play = play;
            let gap = contact.gap(&self.x);
            if gap <= 0.0 || gap.is_nan() {
                self.forget();
                return Err(StepError::Contact {
                    t: state.t,
                    h: span,
                    gap,
                });
            }
        }
        Ok((residual, path, work))
    }

    /// Forces of the supports at the minimum of the augmented Lagrangian, with what it left unbalanced.
    fn set_balance(&mut self, step: &Step<'_, '_>) {
        let (model, state, per) = (step.scene.model, step.state, 1.0 / (step.h * step.h));
        let (x, target) = (&self.x, &self.target);
        if !self.balance.begin(model, |i| per * (x[i] - target[i])) {
            return;
        }
        self.balance.add_potentials(model, step.t, &self.x, 1.0);
        self.balance
            .add_applied(model, state.t, &state.x, &state.v, 1.0);
        if let Some(contact) = step.contact() {
            self.balance.add_contact(contact, &self.x);
        }
        self.balance
            .add_rods(model, &self.x, &self.multipliers, per);
        let rows = &self.vertex_rows;
        self.balance.add_constraints(rows, &rows.multipliers, per);
        self.balance.leave(model, &self.x, &rows.active);
    }

    /// Drops the multipliers.
    fn forget(&mut self) {
        self.multipliers.fill(0.0);
        self.vertex_rows.clear();
    }

    /// Puts pins' ends and bodies in place for a step; returns the barrier's energy.
    fn begin(&mut self, step: &mut Step<'_, '_>, span: f64) -> f64 {
        let state = step.state;
        self.end.copy_from_slice(&state.x);
        step.scene.model.place_pins(step.t, &mut self.end);
        match &mut step.scene.contact {
            None => 0.0,
            Some(contact) => {
                contact.begin(state.t, span, &state.x);
                contact.potential(&state.x)
            }
        }
    }

    /// Whether bodies or pins are on their way.
    fn is_driven(&self, step: &Step<'_, '_>) -> bool {
        step.contact().is_some_and(|c| c.progress() < 1.0)
            || step
                .scene
                .model
                .moving_pins()
                .any(|v| (3 * v..3 * v + 3).any(|i| self.x[i] != self.end[i]))
    }

    /// Starts the iteration where inertia alone would go, unless something is in the way.
    fn predict(&mut self, step: &mut Step<'_, '_>) {
        let model = step.scene.model;
        self.x.copy_from_slice(&self.target);
        model.place_pins(step.t, &mut self.x);
        if step.contact().is_none() {
            return;
        }
        let x0 = &step.state.x;
        for ((d, x), x0) in self.dx.iter_mut().zip(&self.x).zip(x0) {
            *d = x - x0;
        }
        if step.safe_fraction(&step.state.x, &self.dx) < 1.0 {
            self.x.copy_from_slice(&step.state.x);
        } else if let Some(contact) = &mut step.scene.contact {
            contact.advance(1.0);
        }
    }

    /// Whether the incremental potential at the iterate is not above `bound`, but for what the
    /// tolerance of the lengths and round-off allow.
    fn is_below(&mut self, bound: Option<&Merit>, step: &Step<'_, '_>) -> bool {
        let Some(bound) = bound else { return true };
        let now = self.merit(step);
        let play = step
            .contact()
            .map_or(0.0, |_| step.h * step.h * self.play(step));
        let slack = play
            + 10.0 * (now.round_off + bound.round_off)
            + 10.0 * self.options.strain_tolerance * now.rod_scale.max(bound.rod_scale);
        now.potential <= bound.potential + slack
    }

    /// Energy that the tolerance of the lengths leaves open to a sheet at rest in contact, joules. A flat
    /// sheet folds by the root of a length error; its weight is lifted by a part of that.
    fn play(&self, step: &Step<'_, '_>) -> f64 {
        let fold = self.options.strain_tolerance.sqrt() * step.scene.model.mean_length();
        PLAY * fold * self.force.iter().map(|f| f.abs()).sum::<f64>()
    }

    /// One minimisation from the iterate, followed by the projection onto the lengths.
    fn descend(
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
        let rounds = if step.contact().is_some() {
            MAX_ROUNDS
        } else {
            1
        };
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
            if round + 1 < rounds && model.rods().max_strain(&self.x) > self.ready {
                self.penalty.iter_mut().for_each(|p| *p *= GROWTH);
                continue;
            }
            let held = step.scene.contact.as_deref_mut().map(|contact| Held {
                contact,
                scale: step.h * step.h,
            });
            strain = self.projector.positions(
                model,
                &mut self.matrix,
                held,
                &mut self.x,
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
            model.rods().residual_into(&self.x, &mut self.c);
            self.vertex_rows.evaluate(model, step.t, &self.x);
        }
        if strain == f64::INFINITY {
            strain = model.rods().max_strain(&self.x);
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
            self.start.copy_from_slice(&self.x);
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
                for i in 0..self.x.len() {
                    self.x[i] = self.start[i] - length * self.dx[i];
                }
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
                if let Some(contact) = &mut step.scene.contact
                    && updates < self.options.max_friction_updates
                    && contact.relag(&self.x) > SETTLED
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
    fn limit(&mut self, step: &mut Step<'_, '_>) -> f64 {
        if step.contact().is_none() {
            return 1.0;
        }
        for v in step.scene.model.moving_pins() {
            for i in 3 * v..3 * v + 3 {
                self.dx[i] = self.x[i] - self.end[i];
            }
        }
        for (w, d) in self.weighted.iter_mut().zip(&self.dx) {
            *w = -d;
        }
        step.safe_fraction(&self.x, &self.weighted)
    }

    /// Moves sheet, pins and bodies on together.
    fn drive(&mut self, step: &mut Step<'_, '_>, part: f64) {
        for i in 0..self.x.len() {
            self.x[i] = self.start[i] - part * self.dx[i];
        }
        if part == 1.0 {
            for v in step.scene.model.moving_pins() {
                self.x[3 * v..3 * v + 3].copy_from_slice(&self.end[3 * v..3 * v + 3]);
            }
        }
        if let Some(contact) = &mut step.scene.contact {
            contact.advance(part);
        }
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
