//! Newton's method on the manifold of positions with the rest lengths.

use super::merit::Merit;
use super::{Minimiser, SETTLED, Step};
use crate::constraint::rows::Bending;
use crate::primal::{dot, strain_floor};
use crate::project::{Aim, Held};
use crate::report::Effort;

/// Stiffness of the rods, relative to the masses, that holds tangent steps to the manifold. Beyond, the masses drown in
/// the round-off of the penalty.
const STIFFNESS: f64 = 1e13;
/// Passes of the method of multipliers with one factor. The first leaves what the stiffness lets through along rods that are nearly
/// dependent, the third nothing that can be seen in the imbalance of forces.
const PASSES: usize = 3;
/// Most tangent steps. A draping sheet needs two to four, one at rest one or two, an impact some more where contact cuts them.
const MAX_STEPS: usize = 8;
/// Most iterations of the projection back to the manifold: more are a sign that the step is not a small one.
const MAX_RETRACTION: usize = 12;
/// Times that a step is halved which does not lower the incremental potential after its projection.
const MAX_HALVINGS: usize = 2;
/// Part of all gain below which the gain of a further step is not worth it: the projection of the other path is less exact.
const WORTHWHILE: f64 = 3e-3;
/// Part of the energy that the tolerance of the lengths leaves open below which a decrease is noise.
const NOISE: f64 = 0.1;
/// Part of the promised decrease that has to come true.
const ARMIJO: f64 = 1e-4;

impl Minimiser {
    /// Minimises the incremental potential `Phi` from the positions at the start, all iterates having the rest lengths: the step
    ///
    /// ```text
    /// (M + h^2 B'' + P) dx + G^T L = -grad Phi,   G dx = 0
    /// ```
    ///
    /// (`P`: the rods' geometric stiffness with the multipliers of the step before, its positive part where the matrix is indefinite) followed by the
    /// projection onto the lengths, halved where that does not descend
    /// (Absil, Mahony and Sepulchre, "Optimization algorithms on matrix manifolds", 2008).
    ///
    /// A sheet that lies flat is held up by rods that are nearly dependent, with multipliers that grow as
    /// the inverse of its fold angles; the augmented Lagrangian needs a dozen rounds to find them. Here they are the solution of a linear
    /// system, and motions that are small or blocked by contact converge in a few steps. A step that has far to go through
    /// a flat state is better begun without the lengths.
    ///
    /// Returns the relative Newton decrement of the last step; nothing if no minimum was found.
    pub(super) fn tangent_steps(
        &mut self,
        step: &mut Step<'_, '_>,
        effort: &mut Effort,
    ) -> Option<f64> {
        if !step.scene.model.constraints().is_empty() {
            return None;
        }
        std::mem::swap(&mut self.multipliers, &mut self.tangent_multipliers);
        self.multipliers.fill(0.0);
        self.penalty.fill(0.0);
        self.x.copy_from_slice(&step.state.x);
        let residual = self.walk(step, effort);
        if residual.is_some() {
            self.set_balance(step);
        }
        self.penalty.copy_from_slice(&self.first_penalty);
        std::mem::swap(&mut self.multipliers, &mut self.tangent_multipliers);
        residual
    }

    fn walk(&mut self, step: &mut Step<'_, '_>, effort: &mut Effort) -> Option<f64> {
        let mut before = self.merit(step);
        let first = before.potential;
        let (mut left, mut updates) = (MAX_STEPS, 0);
        while left > 0 {
            left -= 1;
            if !self.tangent(step, effort) {
                return None;
            }
            let slope = -dot(&self.dx, &self.gradient);
            if !slope.is_finite() {
                return None;
            }
            let play = step.h * step.h * self.play(step);
            let still = -slope <= before.round_off;
            let residual = if still {
                0.0
            } else {
                (-slope / before.inertia).sqrt()
            };
            self.start.copy_from_slice(&self.x);
            let limit = self.limit(step);
            let promised = -0.5 * slope;
            let trifle = promised <= (NOISE * play).max(WORTHWHILE * (first - before.potential).min(before.inertia));
            let halvings = if trifle { 0 } else { MAX_HALVINGS };
            let Some((now, length)) = self.retract(step, limit, slope, halvings, &before, effort)
            else {
                // A trifle is lost in the projection.
                return (trifle || still).then_some(residual);
            };
            let gain = before.potential - now.potential;
            let is_converged = still || -slope <= self.options.tolerance * before.inertia;
            before = now;
            if !(length == 1.0 && is_converged || trifle && gain < 0.5 * promised) {
                continue;
            }
            if let Some(contact) = &mut step.scene.contact
                && updates < self.options.max_friction_updates
                && contact.relag(&self.x) > SETTLED
            {
                (left, updates) = (MAX_STEPS, updates + 1);
                before = self.merit(step);
                continue;
            }
            return Some(residual);
        }
        None
    }

    /// Solves for the tangent step `-dx` at the iterate and updates the multipliers; false if there is none.
    fn tangent(&mut self, step: &Step<'_, '_>, effort: &mut Effort) -> bool {
        let model = step.scene.model;
        if let Some(contact) = step.contact()
            && self.matrix.make_room(model, contact, &self.x).is_err()
        {
            return false;
        }
        let stiffness = STIFFNESS / self.options.stiffness;
        for e in 0..self.along.len() {
            self.along[e] = stiffness * self.first_penalty[e];
        }
        self.across.copy_from_slice(&self.multipliers);
        effort.iterations += 1;
        if !self.factorize_tangent(step, Bending::Full, effort) {
            self.across.iter_mut().for_each(|p| *p = p.max(0.0));
            if !self.factorize_tangent(step, Bending::Positive, effort) {
                // The potentials are concave here: leave their curvature out.
                effort.factorisations += 1;
                self.assemble(step, Bending::Positive);
                if self.matrix.factorize().is_err() {
                    return false;
                }
            }
        }
        for pass in 0..=PASSES {
            self.gradient(step);
            self.matrix.solve(model, &self.gradient, &mut self.dx);
            if pass < PASSES {
                model.rods().apply(&self.x, &self.dx, &mut self.c);
                for e in 0..self.c.len() {
                    self.multipliers[e] -= self.along[e] * self.c[e];
                }
            }
        }
        true
    }

    fn factorize_tangent(
        &mut self,
        step: &Step<'_, '_>,
        bending: Bending,
        effort: &mut Effort,
    ) -> bool {
        effort.factorisations += 1;
        self.assemble(step, bending);
        self.add_potentials(step);
        self.matrix.factorize().is_ok()
    }

    /// Goes on by up to `limit` of the tangent step and projects; the potential there and the part of the step, or
    /// nothing if it is not lower.
    fn retract(
        &mut self,
        step: &mut Step<'_, '_>,
        limit: f64,
        slope: f64,
        halvings: usize,
        before: &Merit,
        effort: &mut Effort,
    ) -> Option<(Merit, f64)> {
        let model = step.scene.model;
        let tolerance = self
            .options
            .strain_tolerance
            .max(strain_floor(model, step.state));
        let mut length = limit;
        for _ in 0..=halvings {
            for i in 0..self.x.len() {
                self.x[i] = self.start[i] - length * self.dx[i];
            }
            let held = step.scene.contact.as_deref_mut().map(|contact| Held {
                contact,
                scale: step.h * step.h,
            });
            let strain = self.projector.positions(
                model,
                &mut self.matrix,
                held,
                &mut self.x,
                Aim {
                    tolerance,
                    max_iterations: MAX_RETRACTION.min(self.options.max_projections),
                    t: step.t,
                    loads: &self.vertex_rows.multipliers,
                },
                effort,
            );
            if strain <= tolerance {
                let now = self.merit(step);
                let promised = before.potential + ARMIJO * length * slope;
                if now.potential <= promised + before.round_off {
                    return Some((now, length));
                }
            }
            length *= 0.5;
        }
        self.x.copy_from_slice(&self.start);
        self.merit(step);
        None
    }
}
