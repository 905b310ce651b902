//! Friction of a step: contacts with normals and normal forces held fixed.

use super::body::Body;
use super::law::GapPotential;
use super::touch::{Key, Touch, add_weighted};
use crate::{Friction, LaggedContact};
use isosheet_dynamics::contact::CouplingSink;
use nalgebra::{Matrix3, Vector3};

/// A contact at which the sheet rubs.
#[derive(Debug, Clone, Copy)]
pub(super) struct Rubbing {
    pub(super) key: Key,
    pub(super) vertices: [u32; 4],
    pub(super) contact: LaggedContact<4>,
    /// The material point of the body that is touched, in its frame.
    pub(super) point: Vector3<f64>,
    law: Friction,
}

impl Rubbing {
    pub(super) fn new(
        touch: &Touch,
        barrier: &GapPotential,
        law: Friction,
        bodies: &[Body],
    ) -> Self {
        let point = match touch.key.body {
            Some(b) => bodies[b as usize].material_point(&touch.foot),
            None => Vector3::zeros(),
        };
        Self {
            key: touch.key,
            vertices: touch.vertices,
            contact: LaggedContact {
                weights: touch.weights,
                normal: touch.normal,
                force: touch.force(barrier),
            },
            point,
            law,
        }
    }

    /// How far the sheet has slid since the start of the step, relative to the body, metres.
    fn slip(&self, x0: &[f64], x: &[f64], bodies: &[Body]) -> Vector3<f64> {
        let mut u = Vector3::zeros();
        for (v, w) in self.vertices.iter().zip(self.contact.weights) {
            let i = 3 * *v as usize;
            u += w * Vector3::new(x[i] - x0[i], x[i + 1] - x0[i + 1], x[i + 2] - x0[i + 2]);
        }
        if let Some(b) = self.key.body {
            u -= bodies[b as usize].displacement_so_far(&self.point);
        }
        let n = &self.contact.normal;
        u - n * n.dot(&u)
    }

    /// Dissipation potential, joules.
    pub(super) fn energy(&self, x0: &[f64], x: &[f64], bodies: &[Body]) -> f64 {
        let y = self.slip(x0, x, bodies).norm();
        self.contact.force * self.law.potential(y)
    }

    /// Energy lost if the present force acts all along the way, joules.
    pub(super) fn loss(&self, x0: &[f64], x: &[f64], bodies: &[Body]) -> f64 {
        let y = self.slip(x0, x, bodies).norm();
        self.contact.force * self.law.force(y) * y
    }

    /// Force on the body (or the second place of the sheet), newtons: along the slip of the sheet.
    pub(super) fn force(&self, x0: &[f64], x: &[f64], bodies: &[Body]) -> Vector3<f64> {
        let u = self.slip(x0, x, bodies);
        self.contact.force * self.law.force_over_distance(u.norm()) * u
    }

    /// The Hessian of the potential; for a law that falls, its slope is replaced by zero where it is
    /// negative.
    pub(super) fn hessian(
        &self,
        x0: &[f64],
        x: &[f64],
        bodies: &[Body],
        sink: &mut dyn CouplingSink,
    ) {
        let u = self.slip(x0, x, bodies);
        let (y, n) = (u.norm(), &self.contact.normal);
        let ratio = self.contact.force * self.law.force_over_distance(y);
        let mut block = ratio * (Matrix3::identity() - n * n.transpose());
        if y > 0.0 {
            let t = u / y;
            let slope = self.contact.force * self.law.force_slope(y).max(0.0);
            block += (slope - ratio) * t * t.transpose();
        }
        add_weighted(&self.vertices, &self.contact.weights, &block, sink);
    }
}

/// Largest change of a normal force over the largest normal force; both lists sorted by key.
pub(super) fn change(old: &[Rubbing], new: &[Rubbing]) -> f64 {
    let (mut i, mut j) = (0, 0);
    let (mut change, mut largest) = (0.0_f64, 0.0_f64);
    while let Some(key) = [old.get(i), new.get(j)]
        .into_iter()
        .flatten()
        .map(|r| r.key)
        .min()
    {
        let take = |list: &[Rubbing], k: &mut usize| match list.get(*k) {
            Some(r) if r.key == key => {
                *k += 1;
                r.contact.force
            }
            _ => 0.0,
        };
        let (a, b) = (take(old, &mut i), take(new, &mut j));
        change = change.max((a - b).abs());
        largest = largest.max(a).max(b);
    }
    if largest > 0.0 { change / largest } else { 0.0 }
}
