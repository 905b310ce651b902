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

use crate::contact::{ActiveContact, ContactState, SurfacePoints};
use crate::{SheetModel, State};
use isosheet_mesh::VertexId;
use nalgebra::{DMatrix, DVector, Matrix4, Vector3};
use std::collections::BTreeMap;

/// The part of an impulse that has been given at the end of its step.
const GIVEN: f64 = 2.0 / 3.0;

/// The whole impulse of a force, over that which it gives in its step.
const WHOLE: f64 = 1.5;

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
enum Part {
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
    /// Work of an obstacle by its motion, joules.
    driven: f64,
    /// `B0` and `B1`, joules.
    stored: [f64; 2],
}

impl FormulaStep<'_> {
    /// What the velocities before the end are to be changed by (vertex, metres per second), so that contact
    /// between bodies makes no energy.
    pub(super) fn corrections(&self) -> Vec<(usize, Vector3<f64>)> {
        let mut changes = Vec::new();
        for meeting in self.meetings().values() {
            let [before, after] = meeting.stored;
            let power =
                |(v, impulse): (&usize, &Vector3<f64>)| impulse.dot(&self.mean_velocity(*v));
            let work = meeting.impulses.iter().map(power).sum::<f64>() - meeting.driven;
            let stored = after - before;
            if work + stored <= 0.0 {
                continue;
            }
            let bodies: Vec<_> = self.bodies_of(meeting).collect();
            let q: f64 = bodies.iter().map(|(body, j)| body.response(j)).sum();
            let kept = kept(work, stored, q);
            for (body, impulses) in bodies {
                // Half of what is taken from the last change of the velocity would have followed.
                let velocities = body.velocities(&impulses);
                let first = body.first;
                let change = |(k, v): (usize, Vector3<f64>)| (first + k, 2.0 * (1.0 - kept) * v);
                changes.extend(velocities.into_iter().enumerate().map(change));
            }
        }
        changes
    }

    /// The contacts of bodies by who touches.
    fn meetings(&self) -> BTreeMap<[Part; 2], Meeting> {
        let mut meetings: BTreeMap<[Part; 2], Meeting> = BTreeMap::new();
        let [start, end] = self.contacts;
        let impulse = WHOLE * self.formula[1] * self.span;
        for contact in end.active.list() {
            let Some(parts) = self.parts(contact) else {
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
        for contact in start.active.list() {
            if let Some(meeting) = self
                .parts(contact)
                .and_then(|parts| meetings.get_mut(&parts))
            {
                meeting.stored[0] += contact.energy(&start.barrier);
            }
        }
        meetings
    }

    /// The two that touch, if one of them is a body that responds and none is a sheet.
    fn parts(&self, contact: &ActiveContact) -> Option<[Part; 2]> {
        let of = |point: &u32| {
            let vertex = self.points.heaviest_carrier(*point);
            self.part_of(vertex)
        };
        let points = contact.corners();
        let first = of(points.first()?)?;
        let second = match contact.key.body {
            Some(number) => Part::Obstacle(number),
            // Those of the other one come last.
            None => of(points.last()?)?,
        };
        let is_body = |part: &Part| matches!(part, Part::Body(_));
        let parts = [first.min(second), first.max(second)];
        parts.iter().any(is_body).then_some(parts)
    }

    fn part_of(&self, vertex: VertexId) -> Option<Part> {
        let [bodies, driven] = self.model.sheets_end();
        let of_bodies = vertex.index().checked_sub(bodies)?;
        Some(match vertex.index() < driven {
            true => Part::Body(of_bodies / 4),
            false => Part::Driven,
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

    /// The bodies that a meeting pushes, with the impulses on them.
    fn bodies_of<'a>(
        &'a self,
        meeting: &'a Meeting,
    ) -> impl Iterator<Item = (Body, DVector<f64>)> + 'a {
        let [bodies, driven] = self.model.sheets_end();
        let vertices = meeting.impulses.keys().filter(move |v| **v < driven);
        let mut firsts: Vec<usize> = vertices.map(|v| bodies + (v - bodies) / 4 * 4).collect();
        firsts.dedup();
        firsts.into_iter().map(|first| {
            let mut impulses = DVector::zeros(12);
            for (v, j) in meeting.impulses.range(first..first + 4) {
                impulses.fixed_rows_mut::<3>(3 * (v - first)).copy_from(j);
            }
            (Body::new(self.model, self.end, first), impulses)
        })
    }
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

/// The four vertices of a rigid body.
struct Body {
    first: usize,
    mass: Matrix4<f64>,
    /// Velocities of the vertices (12) in the motions that guides leave to the body, by columns.
    motions: DMatrix<f64>,
}

impl Body {
    fn new(model: &SheetModel, state: &State, first: usize) -> Self {
        let topology = model.topology();
        let place = |k: usize| {
            let v = 3 * (first + k);
            Vector3::from_column_slice(&state.x[v..v + 3])
        };
        let vertex = |k: usize| VertexId::from_index(first + k);
        let mass = Matrix4::from_fn(|i, j| match (i == j, &model.mass().edge) {
            (true, _) => model.mass().vertex[first + i],
            (false, None) => 0.0,
            (false, Some(edges)) => {
                let edge = topology.find_edge(vertex(i), vertex(j));
                edge.map_or(0.0, |e| edges[e.index()])
            }
        });
        let centre = (0..4).map(place).sum::<Vector3<f64>>() / 4.0;
        let size = (0..4)
            .map(|k| (place(k) - centre).norm())
            .fold(0.0, f64::max);
        let mut fields = DMatrix::zeros(12, 6);
        for k in 0..4 {
            for axis in 0..3 {
                let unit = Vector3::ith(axis, 1.0);
                let turned = unit.cross(&(place(k) - centre)) / size;
                fields.fixed_view_mut::<3, 1>(3 * k, axis).copy_from(&unit);
                fields
                    .fixed_view_mut::<3, 1>(3 * k, 3 + axis)
                    .copy_from(&turned);
            }
        }
        let mut fixed: Vec<[f64; 6]> = Vec::new();
        let mut fix = |k: usize, direction: &Vector3<f64>| {
            let row = fields.rows(3 * k, 3).tr_mul(direction);
            fixed.push(std::array::from_fn(|i| row[i]));
        };
        for k in (0..4).filter(|k| model.is_pinned(vertex(*k))) {
            for axis in 0..3 {
                fix(k, &Vector3::ith(axis, 1.0));
            }
        }
        for constraint in model.constraints() {
            let v = constraint.vertex().index();
            if (first..first + 4).contains(&v) {
                let equations = constraint.at(state.t, &place(v - first));
                let rows = equations.independent() * equations.jacobian;
                for row in rows.row_iter() {
                    fix(v - first, &row.transpose());
                }
            }
        }
        Self {
            first,
            mass,
            motions: &fields * allowed(&fixed),
        }
    }

    /// `A J`: the velocities that impulses (12, newton seconds) give the body as it is guided.
    fn response_velocities(&self, impulses: &DVector<f64>) -> DVector<f64> {
        let weighted = DMatrix::from_fn(12, self.motions.ncols(), |row, column| {
            let (k, axis) = (row / 3, row % 3);
            (0..4)
                .map(|j| self.mass[(k, j)] * self.motions[(3 * j + axis, column)])
                .sum()
        });
        let inertia = self.motions.tr_mul(&weighted);
        let driving = self.motions.tr_mul(impulses);
        match inertia.cholesky() {
            Some(inertia) => &self.motions * inertia.solve(&driving),
            None => DVector::zeros(12),
        }
    }

    /// `J . A J`, joules.
    fn response(&self, impulses: &DVector<f64>) -> f64 {
        impulses.dot(&self.response_velocities(impulses))
    }

    /// `A J` at each vertex.
    fn velocities(&self, impulses: &DVector<f64>) -> [Vector3<f64>; 4] {
        let all = self.response_velocities(impulses);
        std::array::from_fn(|k| all.fixed_rows::<3>(3 * k).into_owned())
    }
}

/// The combinations of six motions, by columns, in which nothing moves along these rows.
fn allowed(rows: &[[f64; 6]]) -> DMatrix<f64> {
    let square = DMatrix::from_fn(6, 6, |i, j| rows.iter().map(|row| row[i] * row[j]).sum());
    let eigen = nalgebra::SymmetricEigen::new(square);
    let largest = eigen.eigenvalues.max();
    let free = (0..6).filter(|i| eigen.eigenvalues[*i] <= f64::EPSILON.sqrt() * largest);
    let columns: Vec<_> = free
        .map(|i| eigen.eigenvectors.column(i).into_owned())
        .collect();
    match columns.is_empty() {
        true => DMatrix::zeros(6, 0),
        false => DMatrix::from_columns(&columns),
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

    #[test]
    fn what_guides_forbid_is_no_motion() {
        assert_eq!(allowed(&[]).ncols(), 6);
        let left = allowed(&[
            [1.0, 0.0, 0.0, 0.0, 0.0, 1.0],
            [0.0, 1.0, 0.0, 0.0, 0.0, 0.0],
        ]);
        assert_eq!(left.ncols(), 4);
        for column in left.column_iter() {
            assert!((column[0] + column[5]).abs() < 1e-14 && column[1].abs() < 1e-14);
        }
    }
}
