//! The contacts at given positions, and the barrier at them.

use super::{
    BarrierPotential, BodyMotions, BodyPlace, Contact, ContactKey, ContactKind, ContactSet,
    CouplingSink, ParallelEdges, StepSpan, SurfacePoints, add_at, add_block, add_weighted, couple,
};
use isosheet_mesh::VertexId;
use nalgebra::Vector3;
use serde::{Deserialize, Serialize};

#[cfg(test)]
mod tests;

/// A pair of primitives whose gap is below the activation distance.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct ActiveContact {
    /// Which two.
    pub key: ContactKey,
    /// Vertices of the sheet; unused places have weight zero.
    pub vertices: [u32; 4],
    /// Their weights in the relative motion.
    pub weights: [f64; 4],
    /// Unit vector, in space, along which the gap grows.
    pub normal: Vector3<f64>,
    /// Distance less thickness and radius, metres.
    pub gap: f64,
    /// Closest point of the body, in space, metres; zero for the sheet with itself.
    pub closest: Vector3<f64>,
    /// For two edges that are nearly parallel: the edge of the sheet, then the other one.
    pub parallel: Option<ParallelEdges>,
    /// For a face or an edge of the sheet that touches a rounded body between its corners.
    pub rolling: Option<Rolling>,
    /// The radii of the first and the second primitive, where they belong to round bodies that respond.
    pub round: [Option<Round>; 2],
}

/// A point or an edge in a round body, whose surface is around it.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct Round {
    /// How far, metres.
    pub radius: f64,
    /// Four points that the body carries and that lie in no plane.
    pub frame: [u32; 4],
}

/// How the distance of a face or an edge of the sheet from the centre or axis of a rounded body changes to
/// second order when it tilts. The closest point rolls along the body then, and the distance `d` shrinks:
/// with the displacements `u_i` and the unit vector `n` along `d`
///
/// ```text
/// d'' = -d |t|^2 + ...,     t = sum_i g_i (n . u_i),
/// ```
///
/// where `g_i` are the gradients, along the face or edge, of the weights of the closest point. (What is left
/// out couples the tilt with sliding, is indefinite, and smaller by the length of an edge over `d`.)
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct Rolling {
    /// `g_i`, in space, per metre; zero in unused places.
    pub gradients: [Vector3<f64>; 4],
    /// `d`: the gap with the radius of the body and the thickness of the sheet, metres.
    pub distance: f64,
}

impl ActiveContact {
    fn factor(&self) -> f64 {
        self.parallel.map_or(1.0, |p| p.factor())
    }

    /// Number of vertices of the sheet that take part; others have weight zero.
    fn vertex_count(&self) -> usize {
        match (self.key.kind, self.key.body) {
            (ContactKind::Vertex, _) | (ContactKind::VertexFace, Some(_)) => 1,
            (ContactKind::EdgeEdge, Some(_)) => 2,
            (ContactKind::FaceVertex, _) => 3,
            (ContactKind::VertexFace | ContactKind::EdgeEdge, None) => 4,
        }
    }

    /// The points that gap, normal and lever depend on.
    pub(super) fn points(&self) -> impl Iterator<Item = u32> + use<> {
        let frames = self
            .round
            .into_iter()
            .flatten()
            .flat_map(|round| round.frame);
        let own = self.vertices.into_iter().take(self.vertex_count());
        let mut points: Vec<u32> = own.chain(frames).collect();
        points.sort_unstable();
        points.dedup();
        points.into_iter()
    }

    /// The vertices of the sheet that take part.
    pub fn corners(&self) -> &[u32] {
        &self.vertices[..self.vertex_count()]
    }

    /// The vertex of the sheet with the largest weight.
    pub(crate) fn heaviest_vertex(&self, points: Option<&SurfacePoints>) -> VertexId {
        let heavier =
            |a: &usize, b: &usize| self.weights[*a].abs().total_cmp(&self.weights[*b].abs());
        let place = (0..self.vertex_count()).max_by(heavier).unwrap_or(0);
        let point = self.vertices[place];
        points.map_or(VertexId(point), |points| points.heaviest_carrier(point))
    }

    /// Size of the barrier force along the normal, newtons.
    #[doc(hidden)]
    pub fn force(&self, barrier: &BarrierPotential) -> f64 {
        self.factor() * barrier.force(self.gap)
    }

    /// The barrier's energy, joules; infinite where the gap is closed.
    #[doc(hidden)]
    pub fn energy(&self, barrier: &BarrierPotential) -> f64 {
        let value = barrier.value(self.gap);
        if value.is_finite() {
            self.factor() * value
        } else {
            f64::INFINITY
        }
    }

    /// Change of the gap by a displacement (`3V`, metres), to first order, metres.
    fn gap_change(&self, dx: &[f64]) -> f64 {
        let parts = self.vertices.iter().zip(&self.weights);
        let along = parts.take(self.vertex_count()).map(|(&v, w)| {
            let v = 3 * v as usize;
            w * self.normal.dot(&Vector3::new(dx[v], dx[v + 1], dx[v + 2]))
        });
        along.sum()
    }

    /// Calls `add` with vertices and the barrier's gradients (newtons).
    pub(crate) fn gradient(
        &self,
        barrier: &BarrierPotential,
        mut add: impl FnMut(u32, Vector3<f64>),
    ) {
        let [value, slope, _] = barrier.derivatives(self.gap);
        let along = self.factor() * slope * self.normal;
        let mut parts = self.weights.map(|w| w * along);
        let count = self.vertex_count();
        if let Some(p) = &self.parallel {
            let turned = p.pull_back(&p.u.cross(&p.v));
            for (part, t) in parts.iter_mut().zip(turned).take(count) {
                *part += p.rate() * value * t;
            }
        }
        for (i, part) in parts.into_iter().enumerate().take(count) {
            add(self.vertices[i], part);
        }
    }

    /// Couple on the body besides the force at the closest point, newton metres: that of the factor of
    /// parallel edges, which turns the edges of sheet and body towards each other.
    pub(super) fn couple(&self, barrier: &BarrierPotential) -> Vector3<f64> {
        match &self.parallel {
            Some(p) if self.key.body.is_some() => {
                let [_, _, _, pull] = p.pull_back(&p.u.cross(&p.v));
                -p.rate() * barrier.value(self.gap) * p.v.cross(&pull)
            }
            _ => Vector3::zeros(),
        }
    }

    /// Minus the Hessian times a common displacement `u` of the sheet's vertices: calls `add` with vertices
    /// and forces (newtons).
    fn shift(
        &self,
        barrier: &BarrierPotential,
        u: &Vector3<f64>,
        mut add: impl FnMut(u32, Vector3<f64>),
    ) {
        let along = self.normal.dot(u);
        let curvature = self.curvature(barrier);
        let turn = curvature.turned_along();
        for i in 0..self.vertex_count() {
            let mut change = curvature.normal * self.weights[i] * self.normal;
            if let Some(turn) = &turn {
                change += curvature.mixed * turn[i];
            }
            add(self.vertices[i], -along * change);
        }
    }

    fn curvature(&self, barrier: &BarrierPotential) -> Curvature {
        let [value, slope, curvature] = barrier.derivatives(self.gap);
        let normal = self.factor() * curvature;
        let Some(p) = self.parallel else {
            return Curvature {
                normal,
                mixed: 0.0,
                turning: 0.0,
                rest: 0.0,
                parallel: None,
            };
        };
        let cross = p.u.cross(&p.v);
        let size = cross.norm();
        let axis = if size > 0.0 {
            cross / size
        } else {
            self.normal
        };
        let [second, third] = complement(&axis);
        let stiff = 4.0 * value / p.threshold;
        // The directions p and J^T axis are coupled.
        let [normal, mixed, turning] =
            nearest_semidefinite(normal, slope * p.rate() * size, stiff * (1.0 - 3.0 * p.y));
        Curvature {
            normal,
            mixed,
            turning,
            rest: stiff * (1.0 - p.y),
            parallel: Some((p, [axis, second, third])),
        }
    }

    /// The Hessian of the energy without the curvature of the distance: `m phi'' p p^T` with
    /// `p_i = w_i n`. What is left out, `phi'` times the second derivatives of the distance, is
    /// negative semidefinite for features of points and edges and for round bodies, where the
    /// nearest positive semidefinite matrix leaves it out too; for the insides of faces and edges
    /// it is indefinite and smaller by the gap over the length of an edge. Nearly parallel edges
    /// add the derivatives of their factor, `m = (2 - y) y` with `y = |u x v|^2 / e`, in the four
    /// directions `p` and `J^T z`, `J = d(u x v)/dx`, with the same omission. Of faces and edges on rounded
    /// bodies the curvature is as large as the radius, and not left out: see [`Rolling`].
    fn hessian(&self, barrier: &BarrierPotential, sink: &mut dyn CouplingSink) {
        if let Some(rolling) = &self.rolling {
            let block =
                self.force(barrier) * rolling.distance * self.normal * self.normal.transpose();
            let (g, count) = (&rolling.gradients, self.vertex_count());
            for i in 0..count {
                for j in i..count {
                    let along = g[i].dot(&g[j]);
                    add_block(self.vertices[i], self.vertices[j], along * block, sink);
                }
            }
        }
        let curvature = self.curvature(barrier);
        let Some((p, [axis, second, third])) = &curvature.parallel else {
            let block = curvature.normal * self.normal * self.normal.transpose();
            add_weighted(&self.vertices, &self.weights, &block, sink);
            return;
        };
        let Curvature {
            normal: a,
            mixed: b,
            turning: c,
            rest,
            ..
        } = curvature;
        let along = self.weights.map(|w| w * self.normal);
        let turns = [axis, second, third].map(|z| p.pull_back(z));
        let count = self.vertex_count();
        for i in 0..count {
            for j in i..count {
                let block = a * along[i] * along[j].transpose()
                    + b * (along[i] * turns[0][j].transpose() + turns[0][i] * along[j].transpose())
                    + c * turns[0][i] * turns[0][j].transpose()
                    + rest
                        * (turns[1][i] * turns[1][j].transpose()
                            + turns[2][i] * turns[2][j].transpose());
                add_block(self.vertices[i], self.vertices[j], block, sink);
            }
        }
    }
}

/// The coefficients of a Hessian.
struct Curvature {
    /// Of `p p^T`.
    normal: f64,
    /// Of `p t^T + t p^T` with `t = J^T axis`.
    mixed: f64,
    /// Of `t t^T`.
    turning: f64,
    /// Of the same with the second and third axis.
    rest: f64,
    /// The axes: that of `u x v` and two perpendicular to it.
    parallel: Option<(ParallelEdges, [Vector3<f64>; 3])>,
}

impl Curvature {
    fn turned_along(&self) -> Option<[Vector3<f64>; 4]> {
        self.parallel
            .as_ref()
            .map(|(p, [axis, _, _])| p.pull_back(axis))
    }
}

/// Two unit vectors that make a basis with a unit vector.
fn complement(axis: &Vector3<f64>) -> [Vector3<f64>; 2] {
    let mut other = Vector3::zeros();
    other[axis.iamin()] = 1.0;
    let second = axis.cross(&other).normalize();
    [second, axis.cross(&second)]
}

/// The positive part of the symmetric matrix `[a b; b c]`.
fn nearest_semidefinite(a: f64, b: f64, c: f64) -> [f64; 3] {
    let (mean, half) = (0.5 * (a + c), 0.5 * (a - c));
    let radius = half.hypot(b);
    let (low, high) = (mean - radius, mean + radius);
    if low >= 0.0 {
        [a, b, c]
    } else if high <= 0.0 {
        [0.0; 3]
    } else {
        // high times the projector on its eigenvector, (A - low) / (high - low).
        let scale = high / (2.0 * radius);
        [scale * (a - low), scale * b, scale * (c - low)]
    }
}

/// The contacts at given positions with the bodies in given places.
///
/// Energy, gradient and Hessian of the barrier are functions of this value, and so is friction.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct ActiveContacts {
    list: Vec<ActiveContact>,
    bodies: Vec<BodyPlace>,
    span: StepSpan,
    progress: f64,
    /// Whether all positions are finite.
    is_finite: bool,
}

impl ActiveContacts {
    /// The contacts of a set at positions `x` (`3V`, metres) and progress `s` of the bodies, which have to be
    /// on the motion of the set.
    #[doc(hidden)]
    pub fn at(contact: &dyn Contact, set: &ContactSet, s: f64, x: &[f64]) -> Self {
        let mut active = Self {
            list: Vec::new(),
            bodies: Vec::new(),
            span: set.bodies().span(),
            progress: s,
            is_finite: true,
        };
        active.update(contact, set, s, x);
        active
    }

    /// The contacts at positions `x` (`3V`, metres) and time `t` (seconds), with the pairs searched for
    /// there.
    pub fn at_rest(contact: &mut dyn Contact, t: f64, x: &[f64]) -> Self {
        let bodies = BodyMotions::over(contact, StepSpan { t0: t, h: 0.0 });
        let set = ContactSet::of(
            contact,
            super::JointMotion {
                bodies: &bodies,
                progress: [1.0; 2],
                x,
                dx: &vec![0.0; x.len()],
            },
        );
        Self::at(contact, &set, 1.0, x)
    }

    /// Becomes the contacts of a set at other positions; reuses memory.
    #[doc(hidden)]
    pub fn update(&mut self, contact: &dyn Contact, set: &ContactSet, s: f64, x: &[f64]) {
        self.span = set.bodies().span();
        self.progress = s;
        self.is_finite = x.iter().all(|c| c.is_finite());
        self.bodies.clear();
        let places = set.bodies().list().iter();
        self.bodies.extend(places.map(|m| BodyPlace::at(m, s)));
        self.list.clear();
        contact.evaluate(set.pairs(), x, &self.bodies, &mut self.list);
    }

    pub(super) fn copy_from(&mut self, other: &Self) {
        self.list.clone_from(&other.list);
        self.bodies.clone_from(&other.bodies);
        self.span = other.span;
        self.progress = other.progress;
        self.is_finite = other.is_finite;
    }

    /// The contacts, in the order of their keys.
    pub fn list(&self) -> &[ActiveContact] {
        &self.list
    }

    /// The bodies in their places.
    pub fn bodies(&self) -> &[BodyPlace] {
        &self.bodies
    }

    /// Time of the bodies' places, seconds.
    pub fn time(&self) -> f64 {
        self.span.t0 + self.progress * self.span.h
    }

    /// Smallest gap, metres: distance less thickness. Infinite if there are no contacts; not a number if a
    /// gap or a position is not.
    pub fn gap(&self) -> f64 {
        if !self.is_finite {
            return f64::NAN;
        }
        let gaps = self.list.iter().map(|c| c.gap);
        // A gap that is not a number must not pass for a wide one.
        gaps.fold(f64::INFINITY, |a, b| {
            if a.is_nan() || b.is_nan() {
                f64::NAN
            } else {
                a.min(b)
            }
        })
    }

    /// The barrier potential `B`, joules; infinite if anything touches or a position is not finite.
    #[doc(hidden)]
    pub fn barrier_energy(&self, barrier: &BarrierPotential) -> f64 {
        if !self.is_finite {
            return f64::INFINITY;
        }
        self.list.iter().map(|c| c.energy(barrier)).sum()
    }

    /// Adds `scale` times the gradient of `B` (newtons) to `out` (`3V`).
    #[doc(hidden)]
    pub fn add_barrier_gradient(&self, barrier: &BarrierPotential, scale: f64, out: &mut [f64]) {
        for contact in &self.list {
            contact.gradient(barrier, |v, g| add_at(out, v, scale * g));
        }
    }

    /// Adds the Hessian of `B` (newtons per metre), each contact's own part made positive semidefinite.
    #[doc(hidden)]
    pub fn add_barrier_hessian(&self, barrier: &BarrierPotential, sink: &mut dyn CouplingSink) {
        for contact in &self.list {
            contact.hessian(barrier, sink);
        }
    }

    /// Adds `scale` times the forces that a displacement `dx` asks for beyond the Hessian, newtons:
    /// `-phi''(g) q dg/dx` for every contact whose gap `g` closes by `q = g(x + dx) - g(x) - dg/dx dx < 0`
    /// more than to first order; whether there are any. `ahead` are the contacts at `x + dx`.
    pub(crate) fn add_gap_correction(
        &self,
        ahead: &Self,
        barrier: &BarrierPotential,
        dx: &[f64],
        scale: f64,
        out: &mut [f64],
    ) -> bool {
        let mut has_any = false;
        for contact in &self.list {
            let Ok(k) = ahead.list.binary_search_by_key(&contact.key, |c| c.key) else {
                continue;
            };
            let there = &ahead.list[k];
            // Distances between parts of the sheet have no sign.
            let is_beyond = there.normal.dot(&contact.normal) < 0.0;
            let gap = if is_beyond { -there.gap } else { there.gap };
            let excess = gap - contact.gap - contact.gap_change(dx);
            if excess < 0.0 {
                has_any = true;
                let force = -scale * contact.curvature(barrier).normal * excess;
                for i in 0..contact.vertex_count() {
                    let along = contact.weights[i] * contact.normal;
                    add_at(out, contact.vertices[i], force * along);
                }
            }
        }
        has_any
    }

    /// Appends the pairs of vertices, lower number first, that the Hessian couples; may append pairs twice
    /// and pairs that are mesh edges. Contact with bodies couples no vertices that are not neighbours already
    /// and is left out.
    #[doc(hidden)]
    pub fn append_couplings(&self, out: &mut Vec<[u32; 2]>) {
        for c in &self.list {
            couple(c.key, &c.vertices, out);
        }
    }

    /// Adds `scale` times the change of the gradient of `B` that the rest of the bodies' motion
    /// causes, to first order: with `u` the displacement of the body at a contact, `-d2B/dx2 u`, with the
    /// same semidefinite part of the Hessian as in [`ActiveContacts::add_barrier_hessian`].
    pub(crate) fn add_drive(&self, barrier: &BarrierPotential, scale: f64, out: &mut [f64]) {
        if self.progress >= 1.0 {
            return;
        }
        for contact in &self.list {
            let Some(b) = contact.key.body else { continue };
            let body = &self.bodies[b as usize];
            let to_come = (1.0 - self.progress) * body.step_velocity(&contact.closest);
            contact.shift(barrier, &to_come, |v, g| add_at(out, v, scale * g));
        }
    }

    /// Power of the barrier forces on the sheet by the motion of the bodies times the duration of the step,
    /// joules.
    pub(crate) fn barrier_work(&self, barrier: &BarrierPotential) -> f64 {
        let with_bodies = self.list.iter().filter_map(|contact| {
            let body = &self.bodies[contact.key.body? as usize];
            let velocity = body.step_velocity(&contact.closest);
            let pushed = contact.force(barrier) * contact.normal.dot(&velocity);
            Some(pushed - contact.couple(barrier).dot(&body.step_turn()))
        });
        with_bodies.sum()
    }
}
