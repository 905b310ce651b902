//! One contact within reach and its part of the energy.

use super::law::GapPotential;
use crate::ParallelMollifier;
use isosheet_dynamics::contact::CouplingSink;
use nalgebra::{Matrix3, Vector3};

/// Which two primitives of which body; orders the contacts.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub(super) struct Key {
    /// Number of the body; `None` for the sheet with itself.
    pub(super) body: Option<u32>,
    pub(super) kind: Kind,
    /// Primitive of the sheet, then of the body or the sheet.
    pub(super) pair: [u32; 2],
}

#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub(super) enum Kind {
    /// A vertex of the sheet and the signed distance of a body.
    Vertex,
    /// A vertex of the sheet and a face.
    VertexFace,
    /// A face of the sheet and a vertex of a body.
    FaceVertex,
    /// Two edges.
    EdgeEdge,
}

/// A pair of primitives within reach.
#[derive(Debug, Clone, Copy)]
pub(super) struct Touch {
    pub(super) key: Key,
    /// Vertices of the sheet; unused places have weight zero.
    pub(super) vertices: [u32; 4],
    /// Their weights in the relative motion.
    pub(super) weights: [f64; 4],
    /// Unit vector, in space, along which the gap grows.
    pub(super) normal: Vector3<f64>,
    /// Distance less thickness and radius, metres.
    pub(super) gap: f64,
    /// Closest point of the body, in space, metres; zero for the sheet with itself.
    pub(super) foot: Vector3<f64>,
    /// For two edges that are nearly parallel.
    pub(super) parallel: Option<Parallel>,
}

/// The mollifier of two edge vectors, see [`ParallelMollifier`].
#[derive(Debug, Clone, Copy)]
pub(super) struct Parallel {
    u: Vector3<f64>,
    v: Vector3<f64>,
    threshold: f64,
    /// `|u x v|^2` over the threshold, below one.
    y: f64,
}

impl Parallel {
    /// Of two edge vectors in space; `None` where the factor is one.
    pub(super) fn new(
        u: Vector3<f64>,
        v: Vector3<f64>,
        mollifier: &ParallelMollifier,
    ) -> Option<Self> {
        let threshold = mollifier.threshold();
        let y = u.cross(&v).norm_squared() / threshold;
        (y < 1.0).then_some(Self { u, v, threshold, y })
    }

    /// Derivative of the factor by `|u x v|^2`, times two: `dm/dx = rate J^T (u x v)`.
    fn rate(&self) -> f64 {
        4.0 * (1.0 - self.y) / self.threshold
    }

    /// The factor `m`.
    fn factor(&self) -> f64 {
        (2.0 - self.y) * self.y
    }

    /// `J^T z` for the derivative `J` of `u x v` by the four points.
    fn pull_back(&self, z: &Vector3<f64>) -> [Vector3<f64>; 4] {
        let (du, dv) = (self.v.cross(z), z.cross(&self.u));
        [-du, du, -dv, dv]
    }
}

impl Touch {
    fn factor(&self) -> f64 {
        self.parallel.map_or(1.0, |p| p.factor())
    }

    /// Size of the barrier force along the normal, newtons.
    pub(super) fn force(&self, law: &GapPotential) -> f64 {
        self.factor() * law.force(self.gap)
    }

    /// Joules; infinite where the gap is closed.
    pub(super) fn energy(&self, law: &GapPotential) -> f64 {
        let value = law.value(self.gap);
        if value.is_finite() {
            self.factor() * value
        } else {
            f64::INFINITY
        }
    }

    /// Calls `add` with vertices and gradients (newtons).
    pub(super) fn gradient(&self, law: &GapPotential, mut add: impl FnMut(u32, Vector3<f64>)) {
        let [value, slope, _] = law.derivatives(self.gap);
        let along = self.factor() * slope * self.normal;
        let mut parts = self.weights.map(|w| w * along);
        if let Some(p) = &self.parallel {
            let turned = p.pull_back(&p.u.cross(&p.v));
            for (part, t) in parts.iter_mut().zip(turned).take(self.points()) {
                *part += p.rate() * value * t;
            }
        }
        for (i, part) in parts.into_iter().enumerate().take(self.points()) {
            add(self.vertices[i], part);
        }
    }

    /// Number of vertices of the sheet that take part; others have weight zero.
    fn points(&self) -> usize {
        match (self.key.kind, self.key.body) {
            (Kind::Vertex, _) | (Kind::VertexFace, Some(_)) => 1,
            (Kind::EdgeEdge, Some(_)) => 2,
            (Kind::FaceVertex, _) => 3,
            (Kind::VertexFace | Kind::EdgeEdge, None) => 4,
        }
    }

    /// Couple on the body besides the force at the foot, newton metres: that of the mollifier, which
    /// turns the edges of sheet and body towards each other.
    pub(super) fn couple(&self, law: &GapPotential) -> Vector3<f64> {
        match &self.parallel {
            Some(p) if self.key.body.is_some() => {
                let [_, _, _, pull] = p.pull_back(&p.u.cross(&p.v));
                -p.rate() * law.value(self.gap) * p.v.cross(&pull)
            }
            _ => Vector3::zeros(),
        }
    }

    /// Minus the Hessian times a common displacement `u` of the sheet's vertices: calls `add` with vertices
    /// and forces (newtons).
    pub(super) fn shift(
        &self,
        law: &GapPotential,
        u: &Vector3<f64>,
        mut add: impl FnMut(u32, Vector3<f64>),
    ) {
        let along = self.normal.dot(u);
        let stiffness = self.stiffness(law);
        let turn = stiffness.turned_along();
        for i in 0..self.points() {
            let mut change = stiffness.normal * self.weights[i] * self.normal;
            if let Some(turn) = &turn {
                change += stiffness.mixed * turn[i];
            }
            add(self.vertices[i], -along * change);
        }
    }

    fn stiffness(&self, law: &GapPotential) -> Stiffness {
        let [value, slope, curvature] = law.derivatives(self.gap);
        let normal = self.factor() * curvature;
        let Some(p) = self.parallel else {
            return Stiffness {
                normal,
                mixed: 0.0,
                turning: 0.0,
                rest: 0.0,
                parallel: None,
            };
        };
        let across = p.u.cross(&p.v);
        let size = across.norm();
        let axis = if size > 0.0 {
            across / size
        } else {
            self.normal
        };
        let [second, third] = complement(&axis);
        let stiff = 4.0 * value / p.threshold;
        // The directions p and J^T axis are coupled.
        let [normal, mixed, turning] =
            nearest_semidefinite(normal, slope * p.rate() * size, stiff * (1.0 - 3.0 * p.y));
        Stiffness {
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
    /// add the derivatives of the mollifier, `m = (2 - y) y` with `y = |u x v|^2 / e`, in the four
    /// directions `p` and `J^T z`, `J = d(u x v)/dx`, with the same omission.
    pub(super) fn hessian(&self, law: &GapPotential, sink: &mut dyn CouplingSink) {
        let stiffness = self.stiffness(law);
        let Some((p, [axis, second, third])) = &stiffness.parallel else {
            let block = stiffness.normal * self.normal * self.normal.transpose();
            add_weighted(&self.vertices, &self.weights, &block, sink);
            return;
        };
        let Stiffness {
            normal: a,
            mixed: b,
            turning: c,
            rest,
            ..
        } = stiffness;
        let along = self.weights.map(|w| w * self.normal);
        let turns = [axis, second, third].map(|z| p.pull_back(z));
        let points = self.points();
        for i in 0..points {
            for j in i..points {
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
struct Stiffness {
    /// Of `p p^T`.
    normal: f64,
    /// Of `p t^T + t p^T` with `t = J^T axis`.
    mixed: f64,
    /// Of `t t^T`.
    turning: f64,
    /// Of the same with the second and third axis.
    rest: f64,
    /// The axes: that of `u x v` and two across.
    parallel: Option<(Parallel, [Vector3<f64>; 3])>,
}

impl Stiffness {
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

/// Adds `w_i w_j block` for all places of a stencil; the block is symmetric.
pub(super) fn add_weighted(
    vertices: &[u32; 4],
    weights: &[f64; 4],
    block: &Matrix3<f64>,
    sink: &mut dyn CouplingSink,
) {
    for i in 0..4 {
        for j in i..4 {
            let w = weights[i] * weights[j];
            if w != 0.0 {
                add_block(vertices[i], vertices[j], w * block, sink);
            }
        }
    }
}

/// Lower vertex first.
fn add_block(a: u32, b: u32, block: Matrix3<f64>, sink: &mut dyn CouplingSink) {
    if a <= b {
        sink.add(a, b, &block);
    } else {
        sink.add(b, a, &block.transpose());
    }
}
