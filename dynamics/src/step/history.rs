//! What a method remembers of accepted steps, beyond the state.

use crate::State;
use nalgebra::Vector3;
use serde::{Deserialize, Serialize};

/// Memory of a method: everything besides the state, the model and the options that its next step depends on.
///
/// A history belongs to one accepted state. It is replaced when a proposal is committed and never changed in
/// between.
#[derive(Debug, Clone, Default, PartialEq, Serialize, Deserialize)]
pub(crate) struct History {
    /// The accepted state before the present one, for two-step methods.
    pub(crate) previous: Option<State>,
    /// Multipliers of the last accepted step, from which the next iteration starts.
    pub(crate) multipliers: Multipliers,
    /// Pairs of vertices beyond the edges of the mesh that the matrix has room for. The elimination order of
    /// the sparse factorisation, and with it the round-off of a step, depends on these pairs.
    pub(crate) couplings: Vec<[u32; 2]>,
    /// Stiffness of the rods in the linear systems at the end of the last step, in units of that of the
    /// masses; zero for methods without such systems and before the first step.
    pub(crate) rod_stiffness: f64,
    /// The longest sub-step that the accuracy asked for allows by the last one, seconds; none before, and
    /// where none is asked for.
    pub(crate) longest: Option<f64>,
    /// The part of the last change of velocities that the contact of rigid bodies made, in their order; empty
    /// where nothing touched them.
    pub(crate) body_changes: Vec<BodyChange>,
}

/// A change of the velocities of a rigid body by contact.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub(crate) struct BodyChange {
    /// The first of its four vertices.
    pub(crate) first: u32,
    /// The lowest such number among all bodies that have pushed one another.
    pub(crate) group: u32,
    /// Of its vertices, metres per second.
    pub(crate) velocities: [Vector3<f64>; 4],
}

impl History {
    /// Whether a restart would change anything: whether the method looks back further than the present state.
    pub(crate) fn looks_back(&self) -> bool {
        self.previous.is_some()
    }

    /// Forgets what belongs to the linear systems of damped methods and to the state before.
    pub(crate) fn forget_systems(&mut self) {
        self.previous = None;
        self.couplings.clear();
        self.rod_stiffness = 0.0;
        self.longest = None;
        self.body_changes.clear();
    }

    /// Takes over another history, in place.
    pub(crate) fn copy_from(&mut self, other: &Self) {
        self.set_previous(other.previous.as_ref());
        self.multipliers.copy_from(&other.multipliers);
        self.couplings.clone_from(&other.couplings);
        self.rod_stiffness = other.rod_stiffness;
        self.longest = other.longest;
        self.body_changes.clone_from(&other.body_changes);
    }

    /// Sets the state before the present one, in place.
    pub(crate) fn set_previous(&mut self, previous: Option<&State>) {
        match (&mut self.previous, previous) {
            (Some(mine), Some(other)) => mine.copy_from(other),
            (mine, other) => *mine = other.cloned(),
        }
    }
}

/// Multipliers of the rods and of the vertex constraints in the scaling of the method: impulses times the
/// step (`h^2` times forces) in the damped methods, impulses in the conservative ones.
#[derive(Debug, Clone, Default, PartialEq, Serialize, Deserialize)]
pub(crate) struct Multipliers {
    /// The step that they belong to, seconds; zero where there are none.
    pub(crate) step: f64,
    /// One for each rod; empty where there are none.
    pub(crate) rods: Vec<f64>,
    /// One vector for each vertex constraint, in the space of its equations.
    pub(crate) constraints: Vec<Vector3<f64>>,
}

impl Multipliers {
    /// Takes over other multipliers, in place.
    pub(crate) fn copy_from(&mut self, other: &Self) {
        self.step = other.step;
        self.rods.clone_from(&other.rods);
        self.constraints.clone_from(&other.constraints);
    }

    /// Sets the multipliers of a step, in place.
    pub(crate) fn set(
        &mut self,
        step: f64,
        rods: &[f64],
        constraints: impl Iterator<Item = Vector3<f64>>,
    ) {
        self.step = step;
        self.rods.clear();
        self.rods.extend_from_slice(rods);
        self.constraints.clear();
        self.constraints.extend(constraints);
    }

    /// Drops them.
    pub(crate) fn clear(&mut self) {
        self.step = 0.0;
        self.rods.clear();
        self.constraints.clear();
    }
}
