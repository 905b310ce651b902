//! What a step repeats of the changes of velocities by contact.

use super::body::mass_matrix;
use crate::step::history::BodyChange;
use crate::{SheetModel, State};
use nalgebra::Vector3;
use std::collections::BTreeMap;

/// `b` of equal steps: the part of a change of velocity that the next one of them repeats.
const REPEATED: f64 = 1.0 / 3.0;

/// What a step repeats of the last change of velocities that the contact of bodies made.
pub(in crate::damped) struct HandedOn {
    /// The state before the start from which the step repeats as much of it as equal steps do; `None` where
    /// nothing touched a body.
    pub(in crate::damped) before: Option<State>,
    /// What the step repeats, metres per second.
    pub(in crate::damped) changes: Vec<BodyChange>,
}

/// What a step with the coefficient `b` repeats of the changes `u` (`last`) that the contact of bodies made
/// in the last change `v0 - v_` of their velocities.
///
/// The restitution of a step takes `u / 2` for what is still to come, which is so if each step repeats a
/// third. A longer step than the one before has `b > 1/3` and would repeat more, so that bodies part too
/// fast; a shorter one would repeat less, and what they have lost in the account is not taken from them. So
/// `v_` becomes `v_ + (1 - 1 / (3 b)) c u`, with the part `c` of `u` that is in `v0 - v_` at all,
///
/// ```text
/// c = <v0 - v_, u>_M / <u, u>_M,     0 <= c <= 1,
/// ```
///
/// for all bodies together that have pushed one another: what one of them loses the others gain. Of bodies
/// that hit one another `c` is 1. Bodies that rest under a load do not change their velocities, `c` is 0, and
/// the formula remains that of second order.
pub(in crate::damped) fn handed_on(
    model: &SheetModel,
    ends: Option<[&State; 2]>,
    last: &[BodyChange],
    b: f64,
) -> HandedOn {
    let Some([before, start]) = ends.filter(|_| !last.is_empty() && b > 0.0) else {
        return HandedOn {
            before: None,
            changes: Vec::new(),
        };
    };
    let excess = 1.0 - REPEATED / b;
    let mut products: BTreeMap<u32, [f64; 2]> = BTreeMap::new();
    for body in last {
        let first = body.first as usize;
        let mass = mass_matrix(model, first);
        let of_group = products.entry(body.group).or_default();
        for k in 0..4 {
            for l in 0..4 {
                let changed = velocity(start, first + k) - velocity(before, first + k);
                let [u, other] = [k, l].map(|i| body.velocities[i]);
                of_group[0] += mass[(k, l)] * changed.dot(&other);
                of_group[1] += mass[(k, l)] * u.dot(&other);
            }
        }
    }
    let taken = |group: u32| {
        let [change, square] = products.get(&group).copied().unwrap_or_default();
        let part = if square > 0.0 { change / square } else { 0.0 };
        excess * part.clamp(0.0, 1.0)
    };
    let mut eased = before.clone();
    let mut changes = last.to_vec();
    for body in &mut changes {
        let taken = taken(body.group);
        for (k, u) in body.velocities.iter().enumerate() {
            let place = 3 * (body.first as usize + k);
            for (v, u) in eased.v[place..place + 3].iter_mut().zip(u) {
                *v += taken * u;
            }
        }
        let part = b * (1.0 - taken);
        body.velocities.iter_mut().for_each(|u| *u *= part);
    }
    HandedOn {
        before: Some(eased),
        changes,
    }
}

/// The velocity of a vertex, metres per second.
fn velocity(state: &State, vertex: usize) -> Vector3<f64> {
    Vector3::from_column_slice(&state.v[3 * vertex..3 * vertex + 3])
}

/// The changes of velocities by contact, one for each body.
pub(super) struct Changes(Vec<BodyChange>);

impl Changes {
    /// Begins with what a step repeats.
    pub(super) fn of(repeated: Vec<BodyChange>) -> Self {
        Self(repeated)
    }

    /// Puts the bodies whose first vertices these are into one group, with all that are in a group with them.
    pub(super) fn join(&mut self, firsts: &[u32]) {
        for first in firsts {
            self.of_body(*first);
        }
        let is_named = |body: &&BodyChange| firsts.contains(&body.first);
        let groups: Vec<u32> = self
            .0
            .iter()
            .filter(is_named)
            .map(|body| body.group)
            .collect();
        if let Some(&lowest) = groups.iter().min() {
            let joined = self
                .0
                .iter_mut()
                .filter(|body| groups.contains(&body.group));
            joined.for_each(|body| body.group = lowest);
        }
    }

    /// Adds to the change of a body that is there.
    pub(super) fn add(&mut self, first: usize, velocities: &[Vector3<f64>; 4]) {
        let change = self.of_body(first as u32);
        for (sum, v) in change.velocities.iter_mut().zip(velocities) {
            *sum += v;
        }
    }

    /// The change of a body, zero if it is new.
    fn of_body(&mut self, first: u32) -> &mut BodyChange {
        let found = self.0.binary_search_by_key(&first, |body| body.first);
        let place = found.unwrap_or_else(|place| {
            let new = BodyChange {
                first,
                group: first,
                velocities: [Vector3::zeros(); 4],
            };
            self.0.insert(place, new);
            place
        });
        &mut self.0[place]
    }

    /// The list, in the order of the bodies.
    pub(super) fn into_list(self) -> Vec<BodyChange> {
        self.0
    }
}
