//! Impacts in a chart: impulses on the momenta.
//!
//! The paper applies collision forces to momenta and does not say how. What follows is our choice.
//!
//! A contact within reach has a normal `n` and a relative velocity `u = R v - w`, `v` the velocities of the
//! vertices, `w` that of the body; an impulse `l` at it changes momenta and relative velocities by
//!
//! ```text
//! p += J^T R^T l,   u += D l,   D = R P R^T,   P = J C^-1 J^T
//! ```
//!
//! (P keeps the closures too). All contacts are solved together, in three stages:
//!
//! 1. compression: impulses with which nothing approaches any more, `0 <= l_n  _|_  u_n >= 0`, and friction
//!    `|l_t| <= mu l_n` that opposes sliding or stops it (projected Gauss-Seidel over the contacts);
//! 2. restitution: `1 + e` times these impulses, and friction again for these normal impulses;
//! 3. what approaches after that, as a contact that opened before the impact may, is compressed again without
//!    restitution, in the end without friction too.
//!
//! For one contact `u_n' = -e u_n`. The kinetic energy never grows, whatever the friction: after compression
//! `l . u <= 0`, so that on the way from no impulse to twice the compression it is a parabola that ends no
//! higher than it began (Newton's hypothesis contact by contact has no such bound, Kane and Levinson 1985);
//! and at given normal impulses friction minimises it.

use super::ChartDynamicsError;
use super::mobility::Mobility;
use crate::contact::ContactPoint;
use isosheet_coords::RodSystem;
use isosheet_mesh::VertexId;
use nalgebra::{DMatrix, DVector, Matrix2, Vector2, Vector3};
use serde::{Deserialize, Serialize};

/// Changes of velocities relative to the largest at which the iteration has converged.
const TOLERANCE: f64 = 1e-12;

/// Most sweeps over the contacts. Contacts that depend on each other converge linearly; what is left is
/// caught by the collision detection and the next step.
const SWEEPS: usize = 1000;

/// Most compressions after the first, the last one without friction; one is usual where any is needed.
const AGAIN: usize = 4;

/// A contact at which a unit impulse moves the sheet by less than this, times its mean vertex mass, is one of
/// pins with a body: no impulse can help.
const IMMOVABLE: f64 = 1e-12;

/// The impulse of a contact on the sheet.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct ContactImpulse {
    /// The contact.
    pub point: ContactPoint,
    /// The impulse in newton seconds: `stencil` weight times this on each vertex.
    pub impulse: Vector3<f64>,
}

impl ContactImpulse {
    /// Adds the impulse on each vertex to `out` (`3V`, newton seconds).
    pub(super) fn add_to(&self, out: &mut [f64]) {
        for &(v, w) in &self.point.stencil {
            let i = 3 * v as usize;
            for k in 0..3 {
                out[i + k] += w * self.impulse[k];
            }
        }
    }
}

/// What impacts did.
pub(super) struct Impact {
    /// Change of the velocities, on the unknowns.
    pub(super) change: Vec<f64>,
    pub(super) impulses: Vec<ContactImpulse>,
    /// Energy lost, joules.
    pub(super) loss: f64,
    /// Work of the bodies, joules.
    pub(super) driven: f64,
}

/// A contact in the small system.
struct Block {
    point: ContactPoint,
    /// Rows `first..first + count`: the normal and, with friction, two directions perpendicular to it.
    first: usize,
    axes: [Vector3<f64>; 3],
    count: usize,
}

/// The contacts at a state, in the mass metric.
pub(super) struct Impacts {
    blocks: Vec<Block>,
    /// `P R^T`, a column for each row.
    response: Vec<Vec<f64>>,
    d: DMatrix<f64>,
}

impl Impacts {
    /// At the state of the mobility.
    pub(super) fn new(
        system: &RodSystem,
        mobility: &mut Mobility,
        mean_mass: f64,
        points: &[ContactPoint],
    ) -> Result<Self, ChartDynamicsError> {
        let (mut blocks, mut response) = (Vec::new(), Vec::new());
        let mut force = vec![0.0; system.unknowns()];
        for point in points {
            let [a, b] = crate::constraint::orthonormal_complement(&point.normal);
            let axes = [point.normal, a, b];
            let count = if point.friction > 0.0 { 3 } else { 1 };
            let first = response.len();
            for axis in &axes[..count] {
                force.fill(0.0);
                push(system, point, axis, &mut force);
                let mut column = vec![0.0; system.unknowns()];
                mobility.respond(&force, &mut column)?;
                response.push(column);
            }
            if mean_mass * pull(system, point, &axes[0], &response[first]) <= IMMOVABLE {
                response.truncate(first);
                continue;
            }
            blocks.push(Block {
                point: *point,
                first,
                axes,
                count,
            });
        }
        let mut d = DMatrix::zeros(response.len(), response.len());
        for block in &blocks {
            for (k, axis) in block.axes[..block.count].iter().enumerate() {
                for (j, column) in response.iter().enumerate() {
                    d[(block.first + k, j)] = pull(system, &block.point, axis, column);
                }
            }
        }
        // Round-off of the solves must not look like work.
        let d = 0.5 * (&d + d.transpose());
        Ok(Self {
            blocks,
            response,
            d,
        })
    }

    /// Relative velocities for velocities on the unknowns.
    fn relative(&self, system: &RodSystem, v: &[f64]) -> DVector<f64> {
        let mut u = DVector::zeros(self.response.len());
        for block in &self.blocks {
            for (k, axis) in block.axes[..block.count].iter().enumerate() {
                let own = pull(system, &block.point, axis, v);
                u[block.first + k] = own - axis.dot(&block.point.body_velocity);
            }
        }
        u
    }

    /// The impact of velocities on the unknowns, `None` if nothing approaches.
    pub(super) fn solve(&self, system: &RodSystem, v: &[f64], restitution: f64) -> Option<Impact> {
        let start = self.relative(system, v);
        let small = TOLERANCE * start.amax();
        if !self.approaches(&start, small) {
            return None;
        }
        let mut u = start.clone();
        let mut total = DVector::zeros(u.len());
        for round in 0..=AGAIN {
            total += match round {
                0 => self.round(&u, restitution, small),
                AGAIN => self.normal_impulses(&u, small),
                _ => self.round(&u, 0.0, small),
            };
            u = &start + &self.d * &total;
            if !self.approaches(&u, small) {
                break;
            }
        }
        let loss = -0.5 * total.dot(&(&start + &u));
        let mut change = vec![0.0; v.len()];
        for (l, column) in total.iter().zip(&self.response) {
            for (c, r) in change.iter_mut().zip(column) {
                *c += l * r;
            }
        }
        let mut driven = 0.0;
        let impulses = self.blocks.iter().map(|block| {
            let impulse: Vector3<f64> = (0..block.count)
                .map(|k| total[block.first + k] * block.axes[k])
                .sum();
            driven += impulse.dot(&block.point.body_velocity);
            ContactImpulse {
                point: block.point,
                impulse,
            }
        });
        let impulses = impulses.collect();
        Some(Impact {
            change,
            impulses,
            loss,
            driven,
        })
    }

    /// Impulses of compression and restitution from relative velocities `u`.
    fn round(&self, u: &DVector<f64>, restitution: f64, small: f64) -> DVector<f64> {
        let mut l = DVector::zeros(u.len());
        let mut after = u.clone();
        let mut stage = Stage::Compression;
        if !self.sweep(&mut l, &mut after, small, stage) {
            // Strong friction may turn normal impulses on and off for ever: those without friction are
            // unique.
            stage = Stage::Opening;
            l = self.normal_impulses(u, small);
        }
        // No further than the energy allows: twice or more, up to round-off.
        let curve = l.dot(&(&self.d * &l));
        let most = if curve > 0.0 {
            (-2.0 * l.dot(u) / curve).max(0.0)
        } else {
            0.0
        };
        l *= (1.0 + restitution).min(most);
        if restitution > 0.0 || stage == Stage::Opening {
            after = u + &self.d * &l;
            self.sweep(&mut l, &mut after, small, Stage::Friction);
        }
        l
    }

    /// Impulses without friction and restitution. Convex: they exist wherever the contacts let go, and every
    /// sweep takes energy.
    fn normal_impulses(&self, u: &DVector<f64>, small: f64) -> DVector<f64> {
        let mut l = DVector::zeros(u.len());
        let mut after = u.clone();
        self.sweep(&mut l, &mut after, small, Stage::Opening);
        l
    }

    /// The least displacement in the mass metric, on the unknowns, after which every gap is at least `least`
    /// to first order.
    pub(super) fn open(&self, least: f64) -> Vec<f64> {
        let mut u = DVector::zeros(self.response.len());
        for block in &self.blocks {
            u[block.first] = block.point.gap - least;
        }
        let l = self.normal_impulses(&u, TOLERANCE * least);
        let mut step = vec![0.0; self.response.first().map_or(0, Vec::len)];
        for (l, column) in l.iter().zip(&self.response) {
            for (s, r) in step.iter_mut().zip(column) {
                *s += l * r;
            }
        }
        step
    }

    fn approaches(&self, u: &DVector<f64>, small: f64) -> bool {
        self.blocks.iter().any(|b| u[b.first] < -small)
    }

    /// The change of the impulse of a contact that stops it, if friction allows that.
    fn stick(&self, block: &Block, l: &DVector<f64>, u: &DVector<f64>) -> Option<Vector3<f64>> {
        if block.count < 3 {
            return None;
        }
        let i = block.first;
        let own = self.d.fixed_view::<3, 3>(i, i).into_owned();
        let change = -own.cholesky()?.solve(&u.fixed_rows::<3>(i).into_owned());
        let l = l.fixed_rows::<3>(i) + change;
        (l.yz().norm() <= block.point.friction * l.x).then_some(change)
    }

    /// Projected Gauss-Seidel: impulses `l` and the velocities `u` that they lead to; whether it converged.
    fn sweep(&self, l: &mut DVector<f64>, u: &mut DVector<f64>, small: f64, stage: Stage) -> bool {
        for _ in 0..SWEEPS {
            let mut largest = 0.0_f64;
            for block in &self.blocks {
                let i = block.first;
                if stage == Stage::Compression
                    && let Some(change) = self.stick(block, l, u)
                {
                    for k in 0..3 {
                        l[i + k] += change[k];
                        u.axpy(change[k], &self.d.column(i + k), 1.0);
                        largest = largest.max((change[k] * self.d[(i + k, i + k)]).abs());
                    }
                    continue;
                }
                if stage != Stage::Friction {
                    let own = self.d[(i, i)];
                    let new = (l[i] - u[i] / own).max(0.0);
                    let change = new - l[i];
                    l[i] = new;
                    u.axpy(change, &self.d.column(i), 1.0);
                    largest = largest.max((change * own).abs());
                }
                if stage == Stage::Opening || block.count == 1 {
                    continue;
                }
                let own = self.d.fixed_view::<2, 2>(i + 1, i + 1).into_owned();
                let old = Vector2::new(l[i + 1], l[i + 2]);
                let slope = Vector2::new(u[i + 1], u[i + 2]) - own * old;
                let new = least_on_disc(&own, &slope, &old, block.point.friction * l[i]);
                for k in 0..2 {
                    let change = new[k] - old[k];
                    l[i + 1 + k] = new[k];
                    u.axpy(change, &self.d.column(i + 1 + k), 1.0);
                    largest = largest.max((change * own[(k, k)]).abs());
                }
            }
            if largest <= small {
                return true;
            }
        }
        false
    }
}

/// Most gradient steps of [`least_on_disc`]; what is left is taken up by the next sweep.
const STEPS: usize = 30;

/// The point of a disc about zero at which `x^T d x / 2 + slope . x` is least, or one where it is less than
/// at `x`.
fn least_on_disc(
    d: &Matrix2<f64>,
    slope: &Vector2<f64>,
    x: &Vector2<f64>,
    radius: f64,
) -> Vector2<f64> {
    let free = d.try_inverse().map(|inverse| -(inverse * slope));
    if let Some(free) = free.filter(|f| f.norm() <= radius) {
        return free;
    }
    let (a, b, c) = (d[(0, 0)], d[(0, 1)], d[(1, 1)]);
    let bend = 0.5 * (a + c) + (0.5 * (a - c)).hypot(b);
    let mut x = *x;
    for _ in 0..STEPS {
        x = (x - (d * x + slope) / bend).cap_magnitude(radius);
    }
    x
}

/// What a sweep solves for.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Stage {
    /// Normal impulses and friction.
    Compression,
    /// Friction at given normal impulses.
    Friction,
    /// Normal ones only.
    Opening,
}

/// `force += R^T axis` on the unknowns.
fn push(system: &RodSystem, point: &ContactPoint, axis: &Vector3<f64>, force: &mut [f64]) {
    for &(v, w) in &point.stencil {
        if let Some(u) = system.unknown(VertexId(v)).filter(|_| w != 0.0) {
            for k in 0..3 {
                force[u + k] += w * axis[k];
            }
        }
    }
}

/// `axis . R v`.
fn pull(system: &RodSystem, point: &ContactPoint, axis: &Vector3<f64>, v: &[f64]) -> f64 {
    let mut sum = 0.0;
    for &(vertex, w) in &point.stencil {
        if let Some(u) = system.unknown(VertexId(vertex)).filter(|_| w != 0.0) {
            sum += w * axis.dot(&Vector3::from_column_slice(&v[u..u + 3]));
        }
    }
    sum
}
