//! Friction of a step: contacts with constant normals and normal forces.

use super::stencil::Stencil;
use super::{
    ActiveContact, ActiveContacts, BarrierPotential, BodyPlace, ContactKey, ContactLaws,
    CouplingSink, Friction, add_weighted,
};
use nalgebra::{Matrix3, Vector3};
use serde::{Deserialize, Serialize};

/// Friction at one contact with normal, closest points and normal force as they are at the positions
/// at which it was lagged (Li et al. 2020, Incremental potential contact, Sec. 5).
///
/// For displacements `dx_i` since the start of the step, and `d` of the body's material point, the contact
/// slides by `u = (I - n n^T) (sum_i w_i dx_i - d)`, where the surfaces touch; its potential is `N F(|u|)`
/// with the normal force `N` and the integral `F` of the friction law.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct FrictionContact {
    /// Which two primitives.
    pub key: ContactKey,
    /// The first and the last vertex of the two primitives.
    pub ends: [u32; 2],
    /// The points with their weights in the relative motion of the surfaces.
    pub stencil: Stencil,
    /// Unit normal.
    pub normal: Vector3<f64>,
    /// Normal force, newtons.
    pub force: f64,
    /// The material point of the body that is touched, in its frame, metres.
    point: Vector3<f64>,
    /// Its place in space at the start of the step, metres.
    point_start: Vector3<f64>,
    law: Friction,
}

impl FrictionContact {
    fn new(
        contact: &ActiveContact,
        barrier: &BarrierPotential,
        law: Friction,
        x: &[f64],
        bodies: &[BodyPlace],
    ) -> Self {
        let [point, point_start] = match contact.key.body {
            Some(b) => {
                let body = &bodies[b as usize];
                let point = body.material_point(&contact.closest);
                [point, body.material_start(&point)]
            }
            None => [Vector3::zeros(); 2],
        };
        Self {
            key: contact.key,
            ends: [contact.vertices[0], contact.vertices[3]],
            stencil: Stencil::of(contact, x),
            normal: contact.normal,
            force: contact.force(barrier),
            point,
            point_start,
            law,
        }
    }

    /// How far the sheet has slid since the start of the step, relative to the body, metres.
    fn slip(&self, x0: &[f64], x: &[f64], bodies: &[BodyPlace]) -> Vector3<f64> {
        let mut u = Vector3::zeros();
        for (v, w) in self.stencil.iter() {
            let i = 3 * v as usize;
            u += w * Vector3::new(x[i] - x0[i], x[i + 1] - x0[i + 1], x[i + 2] - x0[i + 2]);
        }
        if let Some(b) = self.key.body {
            u -= bodies[b as usize].material_place(&self.point) - self.point_start;
        }
        let n = &self.normal;
        u - n * n.dot(&u)
    }

    /// Dissipation potential, joules.
    fn energy(&self, x0: &[f64], x: &[f64], bodies: &[BodyPlace]) -> f64 {
        let y = self.slip(x0, x, bodies).norm();
        self.force * self.law.potential(y)
    }

    /// Energy lost if the present force acts over the whole displacement, joules.
    fn loss(&self, x0: &[f64], x: &[f64], bodies: &[BodyPlace]) -> f64 {
        let y = self.slip(x0, x, bodies).norm();
        self.force * self.law.force(y) * y
    }

    /// Force on the body (or the second place of the sheet), newtons: along the slip of the sheet.
    fn traction(&self, x0: &[f64], x: &[f64], bodies: &[BodyPlace]) -> Vector3<f64> {
        let u = self.slip(x0, x, bodies);
        self.force * self.law.force_over_distance(u.norm()) * u
    }

    /// The Hessian of the potential; for a law that falls, its slope is replaced by zero where it is
    /// negative.
    fn hessian(&self, x0: &[f64], x: &[f64], bodies: &[BodyPlace], sink: &mut dyn CouplingSink) {
        let u = self.slip(x0, x, bodies);
        let (y, n) = (u.norm(), &self.normal);
        let ratio = self.force * self.law.force_over_distance(y);
        let mut block = ratio * (Matrix3::identity() - n * n.transpose());
        if y > 0.0 {
            let t = u / y;
            let slope = self.force * self.law.force_slope(y).max(0.0);
            block += (slope - ratio) * t * t.transpose();
        }
        let (points, weights) = (self.stencil.points(), self.stencil.weights());
        add_weighted(points, weights, &block, sink);
    }
}

/// Friction of a step with constant normals and normal forces: the potential `D(x - x0)`.
///
/// It belongs to a step, also after its end: the loads on the bodies ([`super::ContactTerms::loads`]) are
/// those of the last step. The step after lags it anew.
#[derive(Debug, Clone, Default, PartialEq, Serialize, Deserialize)]
pub struct LaggedFriction {
    /// Positions at the start of the step, `3V`, metres; empty without contacts.
    x0: Vec<f64>,
    contacts: Vec<FrictionContact>,
}

impl LaggedFriction {
    /// No friction.
    pub fn none() -> Self {
        Self::default()
    }

    /// Lags friction at active contacts at positions `x` of a step that started at positions `x0`; reuses
    /// memory.
    pub fn lag(
        &mut self,
        laws: &ContactLaws,
        barrier: &BarrierPotential,
        active: &ActiveContacts,
        [x0, x]: [&[f64]; 2],
    ) {
        self.contacts.clear();
        self.x0.clear();
        if laws.is_frictionless() {
            return;
        }
        for contact in active.list() {
            if let Some(law) = laws.friction(contact.key.body, contact.vertices, active.span().h) {
                let lagged = FrictionContact::new(contact, barrier, law, x, active.bodies());
                if lagged.force > 0.0 {
                    self.contacts.push(lagged);
                }
            }
        }
        if !self.contacts.is_empty() {
            self.x0.extend_from_slice(x0);
        }
    }

    pub(super) fn copy_from(&mut self, other: &Self) {
        self.x0.clone_from(&other.x0);
        self.contacts.clone_from(&other.contacts);
    }

    /// The contacts, in the order of their keys.
    pub fn contacts(&self) -> &[FrictionContact] {
        &self.contacts
    }

    /// The largest change of a normal force since `before`, relative to the largest normal force; zero
    /// without friction.
    pub(crate) fn change_since(&self, before: &Self) -> f64 {
        let (old, new) = (&before.contacts, &self.contacts);
        let (mut i, mut j) = (0, 0);
        let (mut change, mut largest) = (0.0_f64, 0.0_f64);
        while let Some(key) = [old.get(i), new.get(j)]
            .into_iter()
            .flatten()
            .map(|c| c.key)
            .min()
        {
            let take = |list: &[FrictionContact], k: &mut usize| match list.get(*k) {
                Some(c) if c.key == key => {
                    *k += 1;
                    c.force
                }
                _ => 0.0,
            };
            let (a, b) = (take(old, &mut i), take(new, &mut j));
            change = change.max((a - b).abs());
            largest = largest.max(a).max(b);
        }
        if largest > 0.0 { change / largest } else { 0.0 }
    }

    /// The potential `D`, joules.
    pub fn energy(&self, x: &[f64], bodies: &[BodyPlace]) -> f64 {
        let all = self.contacts.iter();
        all.map(|c| c.energy(&self.x0, x, bodies)).sum()
    }

    /// Energy lost to friction since the start of the step, joules; not negative.
    pub(crate) fn loss(&self, x: &[f64], bodies: &[BodyPlace]) -> f64 {
        let all = self.contacts.iter();
        all.map(|c| c.loss(&self.x0, x, bodies)).sum()
    }

    /// Work of the bodies against friction over the whole step, with its forces at the end, joules.
    pub(crate) fn body_work(&self, x: &[f64], bodies: &[BodyPlace]) -> f64 {
        let mut work = 0.0;
        for c in &self.contacts {
            if let Some(body) = c.key.body.map(|b| &bodies[b as usize]) {
                let displacement = body.material_end(&c.point) - c.point_start;
                // The sheet pulls the body by this force; the body works against it.
                work -= c.traction(&self.x0, x, bodies).dot(&displacement);
            }
        }
        work
    }

    /// Adds `scale` times the gradient of `D` (newtons) to `out` (`3V`).
    pub fn add_gradient(&self, x: &[f64], bodies: &[BodyPlace], scale: f64, out: &mut [f64]) {
        for c in &self.contacts {
            let force = scale * c.traction(&self.x0, x, bodies);
            for (v, w) in c.stencil.iter() {
                super::add_at(out, v, w * force);
            }
        }
    }

    /// Calls `add` with each contact and its force on the first primitive, which the weights spread over the
    /// vertices; newtons.
    pub(crate) fn forces(
        &self,
        x: &[f64],
        bodies: &[BodyPlace],
        mut add: impl FnMut(&FrictionContact, Vector3<f64>),
    ) {
        for c in &self.contacts {
            add(c, -c.traction(&self.x0, x, bodies));
        }
    }

    /// Adds the Hessian of `D` (newtons per metre), each contact's own part made positive semidefinite.
    pub fn add_hessian(&self, x: &[f64], bodies: &[BodyPlace], sink: &mut dyn CouplingSink) {
        for c in &self.contacts {
            c.hessian(&self.x0, x, bodies, sink);
        }
    }

    /// Calls `add` with each body under friction, the force on it (newtons) and where in space it acts
    /// (metres).
    pub(super) fn body_forces(
        &self,
        x: &[f64],
        bodies: &[BodyPlace],
        mut add: impl FnMut(u32, Vector3<f64>, Vector3<f64>),
    ) {
        for c in &self.contacts {
            if let Some(b) = c.key.body {
                let place = bodies[b as usize].material_place(&c.point);
                add(b, c.traction(&self.x0, x, bodies), place);
            }
        }
    }
}

#[cfg(test)]
mod tests;
