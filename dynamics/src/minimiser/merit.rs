//! The augmented Lagrangian of a step and its gradient.

use super::{Minimiser, Step};
use crate::model::PINNED;
use crate::primal::dot;
use nalgebra::Vector3;

/// The augmented Lagrangian at an iterate.
pub(super) struct Merit {
    /// Its inertia term.
    pub(super) inertia: f64,
    /// Without the rods: the incremental potential.
    pub(super) potential: f64,
    /// Size of the multipliers' terms, `sum |L| l^2`.
    pub(super) rod_scale: f64,
    /// Its value.
    pub(super) value: f64,
    /// Round-off in the value.
    pub(super) round_off: f64,
}

impl Minimiser {
    /// The augmented Lagrangian at the iterate; sets `self.c`.
    pub(super) fn merit(&mut self, step: &Step<'_, '_>) -> Merit {
        let (model, t, h) = (step.scene.model, step.t, step.h);
        let x = self.iterate.x();
        for i in 0..x.len() {
            self.difference[i] = x[i] - self.target[i];
        }
        let inertia = model.kinetic_energy(&self.difference);
        let work = dot(&self.applied, &self.difference);
        model.rods().residual_into(x, &mut self.c);
        self.vertex_rows.evaluate(model.constraints(), t, x);
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
        let size = x.iter().fold(0.0_f64, |m, x| m.max(x.abs()));
        let still: f64 = self
            .penalty
            .iter()
            .zip(model.rods().lengths())
            .map(|(p, l)| p * (f64::EPSILON * l * (size + l)).powi(2))
            .sum();
        let (load, vertex_still) = self.vertex_rows.scales(size);
        let (rod_scale, still) = (rod_scale + load, still + vertex_still);
        let mut potential = model.potential_energy(t, x);
        if let Some(terms) = self.iterate.terms(step.contact()) {
            potential += terms.energy();
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

    /// Gradient of the augmented Lagrangian at the iterate, with `self.c` current; sets the
    /// force densities of the rods.
    pub(super) fn gradient(&mut self, step: &Step<'_, '_>) {
        let (model, t, h) = (step.scene.model, step.t, step.h);
        let x = self.iterate.x();
        for i in 0..x.len() {
            self.difference[i] = x[i] - self.target[i];
        }
        model.apply_mass(&self.difference, &mut self.weighted);
        model.potential_force(t, x, &mut self.force);
        for i in 0..x.len() {
            self.gradient[i] = self.weighted[i] - h * h * (self.force[i] + self.applied[i]);
        }
        for e in 0..self.c.len() {
            self.density[e] = self.multipliers[e] + self.penalty[e] * self.c[e];
        }
        model
            .rods()
            .apply_transpose_add(x, &self.density, &mut self.gradient);
        self.vertex_rows.add_gradient(&mut self.gradient);
        if let Some(terms) = self.iterate.terms(step.contact()) {
            terms.add_gradient(h * h, &mut self.gradient);
        }
        model.clear_pinned(&mut self.gradient);
    }

    /// Adds to the gradient what the rest of the prescribed motions will change it by, to first order.
    pub(super) fn add_drive(&mut self, step: &Step<'_, '_>) {
        let model = step.scene.model;
        if let Some(terms) = self.iterate.terms(step.contact()) {
            terms.add_drive(step.h * step.h, &mut self.gradient);
        }
        let x = self.iterate.x();
        let free = model.free_index();
        for (e, &[a, b]) in model.rods().edges().iter().enumerate() {
            let (pin, end) = match (free[a] == PINNED, free[b] == PINNED) {
                (true, false) => (a, b),
                (false, true) => (b, a),
                _ => continue,
            };
            let at = |x: &[f64], v: usize| Vector3::new(x[3 * v], x[3 * v + 1], x[3 * v + 2]);
            let (d, u) = (at(x, end) - at(x, pin), at(&self.end, pin) - at(x, pin));
            let change = self.density[e] * u + self.penalty[e] * d.dot(&u) * d;
            for k in 0..3 {
                self.gradient[3 * end + k] -= change[k];
            }
        }
        model.clear_pinned(&mut self.gradient);
    }
}
