//! Newton's method on the manifold of positions with the rest lengths.

use super::merit::Merit;
use super::{Minimiser, SETTLED, Step};
use crate::SheetModel;
use crate::constraint::rows::HessianPart;
use crate::primal::{dot, strain_floor};
use crate::project::{Aim, Held};
use crate::report::Effort;

/// How exactly tangent steps are solved for.
#[derive(Clone, Copy, PartialEq, Eq)]
pub(super) enum Pace {
    /// One solve with rods 1e10 times as stiff as the masses, which keeps the momentum to round-off. Enough wherever rods are independent.
    Brisk,
    /// Rods 1e13 times as stiff (beyond, the masses drown in the round-off of the penalty) and up to four passes of the method of
    /// multipliers. The first leaves what the stiffness lets through along rods that are nearly dependent, as in a sheet that lies
    /// flat, the fourth nothing that can be seen in the imbalance of forces.
    Careful,
}

impl Pace {
    fn stiffness(self) -> f64 {
        match self {
            Self::Brisk => 1e10,
            Self::Careful => 1e13,
        }
    }

    fn passes(self) -> usize {
        match self {
            Self::Brisk => 1,
            Self::Careful => 4,
        }
    }
}

/// Edge strain that one solve may let through. A sheet hanging by a corner, of 2000 triangles, stays below, also where it is nearly
/// flat; one pulled with a million times its weight does not, nor do masses in the ratio of 1e8.
const LET_THROUGH: f64 = 1e-7;
/// Altitude of a face, in parts of its longest side, from which tangent steps are the first choice without contact: rods of
/// stiffness 1e10 hold slimmer ones with less than 1e4 times the masses.
const SLIMMEST: f64 = 1e-3;
/// Change of the multipliers, relative to the largest, from which a pass is not worth its solve. With 1e-3 a sheet at rest on a table
/// needs three times as many steps.
const STEADY: f64 = 1e-4;
/// Most tangent steps in contact. A draping sheet needs three to six, one at rest two to six, an impact more where contact cuts them.
const MAX_STEPS: usize = 20;
/// Most without. A hanging sheet of 2000 triangles needs up to 50 at 60 steps a second.
const MAX_FREE_STEPS: usize = 80;
/// Edge strain that iterates may have. Between 1e-13 and 1e-1 the number of steps is the same; that of projections goes from four per step to
/// hardly any.
const NEAR: f64 = 1e-2;
/// Most iterations of a projection back to the manifold: more are a sign that the step is not a small one.
const MAX_RETRACTION: usize = 12;
/// Edge strain from which the last projection is a small one.
const SMALL: f64 = 1e-5;
/// Times that a step is halved in contact which does not descend: there is another way.
const MAX_HALVINGS: usize = 2;
/// Times without contact, where that way is longer. With two, a third of the steps of a hanging sheet of 2000 triangles takes it; with 30,
/// a thousand steps a second need half as many factorisations more.
const MAX_FREE_HALVINGS: usize = 8;
/// Part of the promised decrease that has to come true.
const ARMIJO: f64 = 1e-4;

/// Whether a face of the sheet is too slim for [`Pace::Brisk`].
pub(super) fn has_slivers(model: &SheetModel) -> bool {
    let lengths = model.rods().lengths();
    model.topology().face_ids().any(|f| {
        let mut sides = model.topology().face_edges(f).map(|e| lengths[e.index()]);
        sides.sort_by(f64::total_cmp);
        let [c, b, a] = sides;
        // Four times the area, without cancellation (Kahan, "Miscalculating area and angles of a needle-like triangle", 2014).
        let area = ((a + (b + c)) * (c - (a - b)) * (c + (a - b)) * (a + (b - c))).sqrt();
        // (Rounded lengths of a sliver may make no triangle.)
        area.is_nan() || 0.5 * area < SLIMMEST * a * a
    })
}

impl Minimiser {
    /// Minimises the incremental potential `Phi` from the positions at the start by sequential quadratic programming: steps
    ///
    /// ```text
    /// (M + h^2 B'' + P) dx + G^T L = -grad Phi,   G dx = -c
    /// ```
    ///
    /// (`P`: the rods' geometric stiffness with the multipliers of the step before, its positive part where the matrix is
    /// indefinite), each cut by contact, projected towards the manifold where it is far from it, and halved where the Lagrangian
    /// `Phi + L . c`, without contact augmented, does not descend; and a projection onto the lengths at the end (Nocedal and Wright,
    /// "Numerical Optimization", 2006, chapter 18; Absil, Mahony and Sepulchre, "Optimization Algorithms on Matrix Manifolds", 2008).
    ///
    /// A sheet that lies flat is held up by rods that are nearly dependent, with multipliers that grow as
    /// the inverse of its fold angles; the augmented Lagrangian needs a dozen rounds to find them. Here they are the solution of a linear
    /// system, and motions that are small or blocked by contact converge in a few steps. At a brisk pace a
    /// step that ends where the curvature is negative is begun again a little beside it: the sheet could fold either way.
    ///
    /// Returns the relative Newton decrement of the last step; nothing if no minimum was found.
    pub(super) fn tangent_steps(
        &mut self,
        step: &mut Step<'_, '_>,
        pace: Pace,
        effort: &mut Effort,
    ) -> Option<f64> {
        if !step.scene.model.constraints().is_empty() {
            return None;
        }
        std::mem::swap(&mut self.multipliers, &mut self.tangent_multipliers);
        if pace == Pace::Careful {
            self.multipliers.fill(0.0);
        }
        self.set_merit_penalty(step);
        let found = self.walk(step, pace, effort);
        match found {
            Some(_) => self.set_balance(step),
            None => self.multipliers.fill(0.0),
        }
        self.penalty.copy_from_slice(&self.first_penalty);
        std::mem::swap(&mut self.multipliers, &mut self.tangent_multipliers);
        found
    }

    fn walk(&mut self, step: &mut Step<'_, '_>, pace: Pace, effort: &mut Effort) -> Option<f64> {
        let model = step.scene.model;
        self.merit(step);
        let most = if step.has_contact() {
            MAX_STEPS
        } else {
            MAX_FREE_STEPS
        };
        let (mut left, mut updates, mut seeded) = (most, 0, false);
        while left > 0 {
            left -= 1;
            let is_driven = self.is_driven(step);
            let modified = self.tangent(step, pace, effort)?;
            // With the new multipliers.
            let before = self.merit(step);
            let slope = -dot(&self.dx, &self.gradient);
            if !slope.is_finite() {
                return None;
            }
            let still = slope.abs() <= before.round_off;
            let residual = if still {
                0.0
            } else {
                (slope.abs() / before.inertia).sqrt()
            };
            self.start.copy_from_slice(self.iterate.x());
            let limit = self.limit(step);
            if is_driven {
                if limit == 0.0 {
                    return None;
                }
                self.drive(step, limit);
                self.merit(step);
                continue;
            }
            let Some(length) = self.retract(step, limit, slope, &before, effort) else {
                return (still && self.arrive(step, effort)).then_some(residual);
            };
            let is_converged = still || slope.abs() <= self.options.tolerance * before.inertia;
            let is_near = step.has_contact() || model.rods().max_strain(self.iterate.x()) <= SMALL;
            if !(length == 1.0 && is_converged && is_near) {
                continue;
            }
            if modified && !seeded && pace == Pace::Brisk {
                (left, seeded) = (most, true);
                self.perturb(step);
                continue;
            }
            if updates < self.options.max_friction_updates && self.renew_friction(step) > SETTLED {
                (left, updates) = (most, updates + 1);
                continue;
            }
            return self.arrive(step, effort).then_some(residual);
        }
        None
    }

    /// Solves for the tangent step `-dx` at the iterate and updates the multipliers; whether the matrix was indefinite and had to be
    /// modified, and nothing if there is no step. Sets the gradient of the Lagrangian with them.
    fn tangent(&mut self, step: &Step<'_, '_>, pace: Pace, effort: &mut Effort) -> Option<bool> {
        let model = step.scene.model;
        if let Some(terms) = self.iterate.terms(step.contact())
            && self.matrix.make_room(model, &terms).is_err()
        {
            return None;
        }
        self.set_stiffness(pace.stiffness());
        self.across.copy_from_slice(&self.multipliers);
        effort.iterations += 1;
        let modified = !self.factorize_tangent(step, HessianPart::Full, effort);
        if modified {
            self.across.iter_mut().for_each(|p| *p = p.max(0.0));
            if !self.factorize_tangent(step, HessianPart::PositiveSemidefinite, effort) {
                // The potentials are concave here: leave their curvature out.
                effort.factorisations += 1;
                self.assemble(step, HessianPart::PositiveSemidefinite);
                if self.matrix.factorize().is_err() {
                    return None;
                }
            }
        }
        self.penalty.copy_from_slice(&self.along);
        let is_driven = self.is_driven(step);
        for _ in 0..pace.passes() {
            self.gradient(step);
            if is_driven {
                self.add_drive(step);
            }
            self.matrix.solve(model, &self.gradient, &mut self.dx);
            model
                .rods()
                .apply(self.iterate.x(), &self.dx, &mut self.change);
            let (mut largest, mut most, mut off) = (0.0_f64, 0.0_f64, 0.0_f64);
            for e in 0..self.c.len() {
                let (left, l) = (self.c[e] - self.change[e], model.rods().lengths()[e]);
                let more = self.along[e] * left;
                self.multipliers[e] += more;
                largest = largest.max(self.multipliers[e].abs());
                most = most.max(more.abs());
                off = off.max(left.abs() / (l * l));
            }
            if pace == Pace::Brisk && off > LET_THROUGH {
                return None;
            }
            if most <= STEADY * largest {
                break;
            }
        }
        self.set_merit_penalty(step);
        self.gradient(step);
        Some(modified)
    }

    /// Sets the penalty of the function that steps have to decrease. The Lagrangian alone may grow along a step that mends lengths.
    fn set_merit_penalty(&mut self, step: &Step<'_, '_>) {
        if step.has_contact() {
            self.penalty.fill(0.0);
        } else {
            self.penalty.copy_from_slice(&self.first_penalty);
        }
    }

    /// Sets the penalty of the tangent system.
    fn set_stiffness(&mut self, stiffness: f64) {
        let stiffness = stiffness / self.options.stiffness;
        for (a, p) in self.along.iter_mut().zip(&self.first_penalty) {
            *a = stiffness * p;
        }
    }

    fn factorize_tangent(
        &mut self,
        step: &Step<'_, '_>,
        part: HessianPart,
        effort: &mut Effort,
    ) -> bool {
        effort.factorisations += 1;
        self.assemble(step, part);
        self.add_potentials(step);
        self.matrix.factorize().is_ok()
    }

    /// Goes on by up to `limit` of the tangent step, not far from the manifold; the part of the step, or
    /// nothing if it does not descend.
    fn retract(
        &mut self,
        step: &mut Step<'_, '_>,
        limit: f64,
        slope: f64,
        before: &Merit,
        effort: &mut Effort,
    ) -> Option<f64> {
        let halvings = if step.has_contact() {
            MAX_HALVINGS
        } else {
            MAX_FREE_HALVINGS
        };
        let mut length = limit;
        for _ in 0..=halvings {
            self.move_along(length);
            if self.project(step, NEAR, effort) <= NEAR {
                let now = self.merit(step);
                let promised = before.value + ARMIJO * length * slope;
                if now.value <= promised + before.round_off {
                    return Some(length);
                }
            }
            length *= 0.5;
            // Back to where contact knows the motion that the next trial is part of.
            self.iterate.x_mut().copy_from_slice(&self.start);
            self.limit(step);
        }
        None
    }

    /// Projects onto the manifold; whether that succeeds.
    fn arrive(&mut self, step: &mut Step<'_, '_>, effort: &mut Effort) -> bool {
        let floor = strain_floor(step.scene.model, step.state);
        let tolerance = self.options.strain_tolerance.max(floor);
        self.project(step, tolerance, effort) <= tolerance
    }

    /// Projects until the edge strain is within `tolerance`; the strain reached.
    fn project(&mut self, step: &mut Step<'_, '_>, tolerance: f64, effort: &mut Effort) -> f64 {
        let held = step.scene.contact.as_mut().map(|contact| Held {
            contact,
            scale: step.h * step.h,
        });
        let aim = Aim {
            tolerance,
            max_iterations: MAX_RETRACTION.min(self.options.max_projections),
            t: step.t,
            loads: &self.vertex_rows.multipliers,
        };
        let (model, iterate) = (step.scene.model, &mut self.iterate);
        self.projector
            .positions(model, &mut self.matrix, held, iterate, aim, effort)
    }
}
