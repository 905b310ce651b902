//! Barrier and friction together.

use super::{ActiveContacts, BarrierPotential, CouplingSink, LaggedFriction, couple};
use isosheet_model::term::Exchange;
use nalgebra::Vector3;
use serde::{Deserialize, Serialize};

/// What the sheet does to a body.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct BodyLoad {
    /// Force on the body, newtons.
    pub force: Vector3<f64>,
    /// Torque on the body about the origin of its own frame, newton metres, in space.
    pub torque: Vector3<f64>,
}

/// Contacts at the positions of a state, with the barrier and the friction of the step that led there.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct ContactState {
    /// The barrier.
    pub barrier: BarrierPotential,
    /// The contacts.
    pub active: ActiveContacts,
    /// The friction.
    pub friction: LaggedFriction,
}

impl ContactState {
    /// Becomes a copy; reuses memory.
    pub(crate) fn copy_from(&mut self, other: &Self) {
        self.barrier = other.barrier;
        self.active.copy_from(&other.active);
        self.friction.copy_from(&other.friction);
    }
}

/// The contact terms of an incremental potential, `B + D`, at positions and places of the bodies.
#[derive(Debug, Clone, Copy)]
pub struct ContactTerms<'a> {
    /// Positions, `3V`, metres.
    pub x: &'a [f64],
    /// The contacts there.
    pub active: &'a ActiveContacts,
    /// The barrier.
    pub barrier: &'a BarrierPotential,
    /// Friction of the step.
    pub friction: &'a LaggedFriction,
}

impl<'a> ContactTerms<'a> {
    /// Of contacts at positions `x` (`3V`, metres).
    pub fn of(state: &'a ContactState, x: &'a [f64]) -> Self {
        Self {
            x,
            active: &state.active,
            barrier: &state.barrier,
            friction: &state.friction,
        }
    }

    /// `B + D`, joules; infinite if anything touches.
    pub fn energy(&self) -> f64 {
        self.barrier_energy() + self.friction.energy(self.x, self.active.bodies())
    }

    /// `B`, joules; infinite if anything touches.
    pub fn barrier_energy(&self) -> f64 {
        self.active.barrier_energy(self.barrier)
    }

    /// Adds `scale` times the gradient of `B + D` (newtons) to `out` (`3V`).
    pub fn add_gradient(&self, scale: f64, out: &mut [f64]) {
        self.active.add_barrier_gradient(self.barrier, scale, out);
        self.friction
            .add_gradient(self.x, self.active.bodies(), scale, out);
    }

    /// Adds `scale` times the change of the gradient of `B` that the rest of the bodies' motion causes, to
    /// first order: with `u` the displacement of the body at a contact, `-d2B/dx2 u`, with the same
    /// semidefinite part of the Hessian as in [`ContactTerms::add_hessian`].
    pub fn add_drive(&self, scale: f64, out: &mut [f64]) {
        self.active.add_drive(self.barrier, scale, out);
    }

    /// Adds the Hessian of `B + D` (newtons per metre), each contact's own part made positive semidefinite.
    pub fn add_hessian(&self, sink: &mut dyn CouplingSink) {
        self.active.add_barrier_hessian(self.barrier, sink);
        self.friction
            .add_hessian(self.x, self.active.bodies(), sink);
    }

    /// Appends the pairs of vertices, lower number first, that the Hessian couples; may append pairs twice
    /// and pairs that are mesh edges. Contact with bodies couples no vertices that are not neighbours already
    /// and is left out.
    pub fn append_couplings(&self, out: &mut Vec<[u32; 2]>) {
        self.active.append_couplings(out);
        for c in self.friction.contacts() {
            couple(c.key, c.stencil.points(), out);
        }
    }

    /// Forces and torques of the sheet on the bodies, in the order of the bodies: barrier and friction.
    pub fn loads(&self) -> Vec<BodyLoad> {
        let none = BodyLoad {
            force: Vector3::zeros(),
            torque: Vector3::zeros(),
        };
        let bodies = self.active.bodies();
        let mut loads = vec![none; bodies.len()];
        let mut push = |b: u32, force: Vector3<f64>, place: Vector3<f64>| {
            let load = &mut loads[b as usize];
            load.force += force;
            load.torque += (place - bodies[b as usize].origin()).cross(&force);
        };
        for c in self.active.list() {
            if let Some(b) = c.key.body {
                push(b, -c.force(self.barrier) * c.normal, c.closest);
            }
        }
        self.friction.body_forces(self.x, bodies, &mut push);
        for c in self.active.list() {
            if let Some(b) = c.key.body {
                loads[b as usize].torque += c.couple(self.barrier);
            }
        }
        loads
    }

    /// What contact did over the step that ends here, from the barrier's work at the start of the step
    /// ([`ActiveContacts::barrier_work`]) and its energy there.
    pub(crate) fn exchange(&self, start_work: f64, start_energy: f64) -> Exchange {
        let bodies = self.active.bodies();
        let driven = match bodies.iter().any(|b| b.moves()) {
            true => {
                0.5 * (start_work + self.active.barrier_work(self.barrier))
                    + self.friction.body_work(self.x, bodies)
            }
            false => 0.0,
        };
        Exchange {
            friction: self.friction.loss(self.x, bodies),
            stored: self.barrier_energy() - start_energy,
            ..Exchange::driven(driven)
        }
    }
}
