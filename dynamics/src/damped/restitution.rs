//! Restitution of rigid bodies: contact gives back at most the energy that it took.
//!
//! In a step of a backward differentiation formula, `v1 = v0 + b (v0 - v_) + k h M^-1 f(x1)`, a force acts on
//! in the steps to come: a third of its impulse is still on its way. With `w1 = v0 + 3/2 (v1 - v0)`, the
//! velocity that equal steps lead to if no other force follows, its whole impulse is `J = 3/2 k h f`, and the
//! contact of two bodies makes the energy
//!
//! ```text
//! E = sum_i J_i . (w0_i + w1_i) / 2 + B1 - B0
//! ```
//!
//! in every frame of reference, with the energy `B` of its barrier. Where two meet within a step, the impulse
//! that keeps them apart at its end is 9/4 of that which stops them, `E` is positive, and they would part
//! faster than they met. Then so much of what is on its way is taken back, from both alike, that the contact
//! makes no energy: with the part `s` of its impulse,
//!
//! ```text
//! s (E - B1 + B0) - s (1 - s) q / 2 + B1 - B0 = 0,     q = sum J . A J,
//! ```
//!
//! where `A` is the change of the velocities of a body by an impulse. What has been given, `s = 2/3`,
//! remains.
//!
//! A step of another length has another `b`, and would give `b / (1/3)` times as much of what is on its way.
//! What more that is than equal steps give is taken back before the step, see [`handed_on`].

mod body;
mod repeated;

pub(super) use repeated::handed_on;

use crate::contact::{ActiveContact, ContactKey, ContactState, SurfacePoints};
use crate::step::history::BodyChange;
use crate::{SheetModel, State};
use body::ImpactBody;
pub(super) use body::mass_matrix;
use isosheet_mesh::VertexId;
use nalgebra::{DVector, Vector3};
use repeated::Changes;
use std::collections::BTreeMap;

/// The part of an impulse that has been given at the end of its step.
const GIVEN: f64 = 2.0 / 3.0;

/// The whole impulse of a force, over that which it gives in its step.
const WHOLE: f64 = 1.5;

/// What follows from the contact of bodies in a step.
#[derive(Default)]
pub(super) struct Outcome {
    /// What the velocities before the end are to be changed by (vertex, metres per second), so that contact
    /// between bodies makes no energy.
    pub(super) corrections: Vec<(usize, Vector3<f64>)>,
    /// The part of the change of velocities in the step that contact made, after the corrections.
    pub(super) changes: Vec<BodyChange>,
}

/// A step of the formula.
pub(super) struct FormulaStep<'a> {
    pub(super) model: &'a SheetModel,
    pub(super) points: &'a SurfacePoints,
    /// `h`, seconds.
    pub(super) span: f64,
    /// `b` and `k`.
    pub(super) formula: [f64; 2],
    /// The state before the start, which is that itself where the formula does not look back.
    pub(super) before: &'a State,
    pub(super) start: &'a State,
    pub(super) end: &'a State,
    pub(super) contacts: [&'a ContactState; 2],
}

/// Who touches.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
enum Partner {
    /// A rigid body that responds, by its number.
    Body(usize),
    /// An obstacle, by its number.
    Obstacle(u32),
    /// The surfaces in prescribed motion.
    Driven,
}

/// The contact of two.
#[derive(Debug, Default)]
struct Meeting {
    /// `J` at the vertices, newton seconds.
    impulses: BTreeMap<usize, Vector3<f64>>,
    /// What friction has given at the vertices in the step, newton seconds.
    friction: BTreeMap<usize, Vector3<f64>>,
    /// Work of an obstacle by its motion, joules.
    driven: f64,
    /// `B0` and `B1`, joules.
    stored: [f64; 2],
}

impl FormulaStep<'_> {
    /// What follows from the contact of bodies, where the step repeats changes of their velocities.
    pub(super) fn outcome(&self, repeated: Vec<BodyChange>) -> Outcome {
        let mut corrections = Vec::new();
        let mut changes = Changes::of(repeated);
        for meeting in self.meetings().values() {
            let [before, after] = meeting.stored;
            let power =
                |(v, impulse): (&usize, &Vector3<f64>)| impulse.dot(&self.mean_velocity(*v));
            let work = meeting.impulses.iter().map(power).sum::<f64>() - meeting.driven;
            let stored = after - before;
            let pushed: Vec<_> = self.pushed(meeting).collect();
            let kept = match work + stored > 0.0 {
                true => {
                    let responses = pushed.iter().map(|(body, [j, _])| body.response(j));
                    kept(work, stored, responses.sum())
                }
                false => 1.0,
            };
            let firsts = pushed.iter().map(|(body, _)| body.first as u32);
            changes.join(&firsts.collect::<Vec<_>>());
            for (body, [normal, tangential]) in pushed {
                let made = body.velocities(&(normal.clone() / WHOLE + tangential));
                // Half of what is taken from the last change of the velocity would have followed.
                let taken = body.velocities(&normal).map(|v| 2.0 * (1.0 - kept) * v);
                changes.add(body.first, &std::array::from_fn(|k| made[k] - taken[k]));
                if kept < 1.0 {
                    corrections.extend(
                        taken
                            .into_iter()
                            .enumerate()
                            .map(|(k, v)| (body.first + k, v)),
                    );
                }
            }
        }
        Outcome {
            corrections,
            changes: changes.into_list(),
        }
    }

    /// The contacts of bodies by who touches.
    fn meetings(&self) -> BTreeMap<[Partner; 2], Meeting> {
        let mut meetings: BTreeMap<[Partner; 2], Meeting> = BTreeMap::new();
        let [start, end] = self.contacts;
        let impulse = WHOLE * self.formula[1] * self.span;
        for contact in end.active.list() {
            let Some(parts) = self.parts(&contact.key, ends(contact)) else {
                continue;
            };
            let meeting = meetings.entry(parts).or_default();
            meeting.stored[1] += contact.energy(&end.barrier);
            let mut sum = Vector3::zeros();
            contact.gradient(&end.barrier, |point, gradient| {
                let j = -impulse * gradient;
                sum += j;
                for (v, weight) in self.points.carriers(point) {
                    let of_vertex = meeting.impulses.entry(v as usize);
                    *of_vertex.or_insert_with(Vector3::zeros) += weight * j;
                }
            });
            if let Some(b) = contact.key.body {
                let body = &end.active.bodies()[b as usize];
                meeting.driven += sum.dot(&body.step_velocity(&contact.closest)) / self.span;
            }
        }
        if !end.friction.contacts().is_empty() {
            self.add_friction(&mut meetings);
        }
        for contact in start.active.list() {
            if let Some(meeting) = self
                .parts(&contact.key, ends(contact))
                .and_then(|parts| meetings.get_mut(&parts))
            {
                meeting.stored[0] += contact.energy(&start.barrier);
            }
        }
        meetings
    }

    /// Adds the impulses of friction, where there is contact at all.
    fn add_friction(&self, meetings: &mut BTreeMap<[Partner; 2], Meeting>) {
        let [_, end] = self.contacts;
        let mut x = Vec::new();
        self.points.place(&self.end.x, &mut x);
        let impulse = self.formula[1] * self.span;
        end.friction
            .forces(&x, end.active.bodies(), |contact, force| {
                let parts = self.parts(&contact.key, contact.ends);
                let Some(meeting) = parts.and_then(|parts| meetings.get_mut(&parts)) else {
                    return;
                };
                for (point, w) in contact.stencil.iter() {
                    for (v, weight) in self.points.carriers(point) {
                        let of_vertex = meeting.friction.entry(v as usize);
                        *of_vertex.or_insert_with(Vector3::zeros) += impulse * w * weight * force;
                    }
                }
            });
    }

    /// The two that touch, if one of them is a body that responds and none is a sheet.
    fn parts(&self, key: &ContactKey, [first, last]: [u32; 2]) -> Option<[Partner; 2]> {
        let of = |point: u32| {
            let vertex = self.points.heaviest_carrier(point);
            self.part_of(vertex)
        };
        let first = of(first)?;
        let second = match key.body {
            Some(number) => Partner::Obstacle(number),
            // Points of the other one come last.
            None => of(last)?,
        };
        let is_body = |part: &Partner| matches!(part, Partner::Body(_));
        let parts = [first.min(second), first.max(second)];
        parts.iter().any(is_body).then_some(parts)
    }

    fn part_of(&self, vertex: VertexId) -> Option<Partner> {
        let [bodies, driven] = self.model.sheets_end();
        let of_bodies = vertex.index().checked_sub(bodies)?;
        Some(match vertex.index() < driven {
            true => Partner::Body(of_bodies / 4),
            false => Partner::Driven,
        })
    }

    /// `(w0 + w1) / 2` of a vertex, metres per second; of one that is led its velocity over the step.
    fn mean_velocity(&self, vertex: usize) -> Vector3<f64> {
        let at = |values: &[f64]| Vector3::from_column_slice(&values[3 * vertex..3 * vertex + 3]);
        if self.model.is_pinned(VertexId::from_index(vertex)) {
            return (at(&self.end.x) - at(&self.start.x)) / self.span;
        }
        let [v_, v0, v1] = [self.before, self.start, self.end].map(|state| at(&state.v));
        let before = WHOLE * self.formula[0] * (v0 - v_);
        let after = WHOLE * (v1 - v0);
        v0 + 0.5 * (before + after)
    }

    /// The bodies that a meeting pushes, with the impulses on them (12 each): the whole impulses of the
    /// barrier, and the impulses of friction so far.
    fn pushed<'a>(
        &'a self,
        meeting: &'a Meeting,
    ) -> impl Iterator<Item = (ImpactBody, [DVector<f64>; 2])> + 'a {
        let [bodies, driven] = self.model.sheets_end();
        let vertices = meeting.impulses.keys().filter(move |v| **v < driven);
        let mut firsts: Vec<usize> = vertices.map(|v| bodies + (v - bodies) / 4 * 4).collect();
        firsts.dedup();
        firsts.into_iter().map(move |first| {
            let gathered = |all: &BTreeMap<usize, Vector3<f64>>| {
                let mut impulses = DVector::zeros(12);
                for (v, j) in all.range(first..first + 4) {
                    impulses.fixed_rows_mut::<3>(3 * (v - first)).copy_from(j);
                }
                impulses
            };
            let impulses = [&meeting.impulses, &meeting.friction].map(gathered);
            (ImpactBody::new(self.model, self.end, first), impulses)
        })
    }
}

/// The first and the last vertex of a contact.
fn ends(contact: &ActiveContact) -> [u32; 2] {
    let [first, .., last] = contact.vertices;
    [first, last]
}

/// The part of an impulse that is kept, at least what has been given: the largest with which the contact
/// makes no energy, or else that with which it makes least.
fn kept(work: f64, stored: f64, q: f64) -> f64 {
    let linear = 0.5 * q - work;
    let root = (linear * linear - 2.0 * q * stored).max(0.0).sqrt();
    let kept = (linear + root) / q;
    if kept.is_finite() {
        kept.clamp(GIVEN, 1.0)
    } else {
        GIVEN
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Without a barrier that stores energy bodies that met and were kept apart part as fast as they met, or
    /// slower.
    #[test]
    fn so_much_is_kept_that_no_energy_is_made() {
        // A ball of mass 1 at rest is met by a wall at speed 1, and is to have the velocity w.
        for w in [2.0, 2.25, 2.9, 3.0, 5.0] {
            let (work, q) = (w * (0.5 * w - 1.0), w * w);
            let kept = kept(work, 0.0, q);
            let energy = kept * w * (0.5 * kept * w - 1.0);
            if GIVEN * w <= 2.0 {
                assert!(energy.abs() < 1e-14, "{w}: {energy}");
            } else {
                assert_eq!(kept, GIVEN);
            }
        }
    }
}
