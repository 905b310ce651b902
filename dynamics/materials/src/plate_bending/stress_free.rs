//! The curvature of a plate without stress: natural and plastic.

use super::law::Roots;
use super::natural::NaturalCurvature;
use super::points::work;
use super::stencil::{POINTS, Stencil, Stencils, face_of};
use crate::evaluation::Evaluation;
use crate::plasticity::{Flow, Yield};
use crate::potential::At;
use crate::vectors::point as position;
use isosheet_mesh::{EdgeId, Sheet, VertexId};
use nalgebra::{Matrix2, Matrix3, Vector3};
use std::f64::consts::SQRT_2;
use std::ops::Range;
use std::sync::{Mutex, MutexGuard, PoisonError};

/// The curvatures that the points of a plate have without moments, natural ones and the plastic ones of a
/// plate that yields. Curvatures come from the stencils, `R k` with the root `R` of the law ([`Roots`]), so
/// that a norm is that of the elastic energy.
#[derive(Debug)]
pub(super) struct StressFreeCurvature {
    roots: Roots,
    natural: Option<NaturalCurvature>,
    /// Of each face, or of all; nothing of a plate that does not yield. All have the same number of layers.
    yields: Vec<Yield>,
    points: Vec<PointOfPlate>,
    /// Where they were evaluated last.
    evaluated: Evaluation<BentPoint>,
    /// Of each pair of vertices of each stencil, the second one being before the first, where its block of
    /// the Hessian is.
    slots: Vec<Slot>,
    /// Room for the blocks, so that no step allocates.
    blocks: Mutex<Blocks>,
}

/// What does not change of a point.
#[derive(Debug)]
struct PointOfPlate {
    /// The corners of its face, counter-clockwise.
    corners: [VertexId; 3],
    /// Its part of the area of the face, m2.
    area: f64,
    /// Where its slots begin.
    slots: usize,
}

/// A block of the Hessian in a list of blocks, and which vertex its rows belong to.
#[derive(Debug, Clone, Copy)]
struct Slot {
    list: List,
    index: u32,
    rows: Rows,
}

#[derive(Debug, Clone, Copy)]
enum List {
    Edges,
    Pairs,
}

/// Whether the rows of a block belong to the first of the two vertices of a stencil.
#[derive(Debug, Clone, Copy)]
enum Rows {
    First,
    Second,
}

/// What these curvatures add to the Hessian of an elastic plate, in the places of its blocks.
#[derive(Debug)]
pub(super) struct Blocks {
    pub(super) at_vertices: Vec<Matrix3<f64>>,
    pub(super) at_edges: Vec<Matrix3<f64>>,
    pub(super) at_pairs: Vec<Matrix3<f64>>,
    /// The vertices of the point whose blocks are computed.
    vertices: Vec<BentVertex>,
}

/// What the Hessian of a point needs of one of the vertices of its stencil.
#[derive(Debug)]
struct BentVertex {
    index: usize,
    /// Its weights `w`, and `slope w`.
    weights: Vector3<f64>,
    yielded: Vector3<f64>,
    /// `w . p`, the curvature without stress as [`BentPoint::stress_free`] has it.
    along: f64,
    /// Gradient of the linear function that is one here, zero where the vertex is no corner.
    hat: Vector3<f64>,
}

impl Blocks {
    fn zero(&mut self) {
        for list in [
            &mut self.at_vertices,
            &mut self.at_edges,
            &mut self.at_pairs,
        ] {
            list.fill(Matrix3::zeros());
        }
    }
}

/// A point at positions, `B` being the second derivatives of the positions, `n` the unit normal and `p` the
/// curvature without stress at the end of the step, both times the root of the law.
#[derive(Debug)]
pub(super) struct BentPoint {
    corners: [VertexId; 3],
    normal: Vector3<f64>,
    /// Gradients on the face of the linear functions that are one at a corner and zero at the other two, 1/m.
    hats: [Vector3<f64>; 3],
    /// `sqrt(D A) (B - n p^T)`.
    pub(super) elastic: Matrix3<f64>,
    /// `sqrt(D A) p`.
    stress_free: Vector3<f64>,
    /// The curvature less the one without stress before the step, 1/m.
    trial: Vector3<f64>,
    flow: Flow<3>,
}

impl BentPoint {
    /// The derivatives of the energy by the corners, as far as they come from the normal: with the hats `g_j`
    /// it is `dn = -sum_j g_j (n . dx_j)`.
    pub(super) fn turning_forces(&self) -> [(VertexId, Vector3<f64>); 3] {
        let moved = self.elastic * self.stress_free;
        let force = |k: usize| self.normal * self.hats[k].dot(&moved);
        [0, 1, 2].map(|k| (self.corners[k], force(k)))
    }

    /// Whether it bends as one that is flat without stress.
    fn is_flat(&self) -> bool {
        self.stress_free == Vector3::zeros() && self.flow.slope == Matrix3::zeros()
    }
}

impl StressFreeCurvature {
    /// Of a plate that is flat without stress and does not yield, with blocks of the Hessian at vertices,
    /// `edges` and `pairs`.
    pub(super) fn new(
        sheet: &Sheet,
        stencils: &Stencils,
        roots: Roots,
        edges: &[(EdgeId, f64)],
        pairs: &[([VertexId; 2], f64)],
    ) -> Self {
        let topology = sheet.topology();
        let ends = edges.iter().map(|(e, _)| topology.edges()[e.index()]);
        let at_edges = ends.zip(0..).map(|(ends, k)| (ends, (List::Edges, k)));
        let at_pairs = pairs.iter().zip(0..);
        let at_pairs = at_pairs.map(|((pair, _), k)| (*pair, (List::Pairs, k)));
        // Of each vertex the blocks whose rows belong to it.
        let mut places = vec![Vec::new(); topology.vertex_count()];
        for ([v, w], place) in at_edges.chain(at_pairs) {
            places[v.index()].push((w, place));
        }
        let find = |v: VertexId, w: VertexId| {
            let mut own = places[v.index()].iter();
            own.find(|(other, _)| *other == w).map(|(_, place)| *place)
        };
        let slot = |v: VertexId, w: VertexId| {
            let (place, rows) = match find(v, w) {
                Some(place) => (place, Rows::First),
                None => (find(w, v).expect("a block of the pair"), Rows::Second),
            };
            let (list, index) = place;
            Slot { list, index, rows }
        };
        let counts = [topology.vertex_count(), edges.len(), pairs.len()];
        let [at_vertices, at_edges, at_pairs] = counts.map(|n| vec![Matrix3::zeros(); n]);
        let (mut slots, mut points, mut most) = (Vec::new(), Vec::new(), 0);
        for (k, stencil) in stencils.iter().enumerate() {
            points.push(PointOfPlate {
                corners: topology.faces()[face_of(k)],
                area: sheet.face_areas()[face_of(k)] / POINTS as f64,
                slots: slots.len(),
            });
            let vertices: Vec<_> = stencil.map(|(v, _)| VertexId::from_index(v)).collect();
            most = most.max(vertices.len());
            for (i, v) in vertices.iter().enumerate() {
                slots.extend(vertices[..i].iter().map(|w| slot(*v, *w)));
            }
        }
        Self {
            roots,
            natural: None,
            yields: Vec::new(),
            points,
            evaluated: Evaluation::default(),
            slots,
            blocks: Mutex::new(Blocks {
                at_vertices,
                at_edges,
                at_pairs,
                vertices: Vec::with_capacity(most),
            }),
        }
    }

    pub(super) fn set_yields(&mut self, yields: Vec<Yield>) {
        self.evaluated = Evaluation::default();
        self.yields = yields;
    }

    /// When the face of a point yields.
    fn yields_of(&self, point: usize) -> Option<&Yield> {
        self.yields.get(face_of(point)).or(self.yields.last())
    }

    pub(super) fn set_natural(&mut self, natural: NaturalCurvature) {
        self.evaluated = Evaluation::default();
        self.natural = Some(natural);
    }

    pub(super) fn yields(&self) -> bool {
        !self.yields.is_empty()
    }

    /// Whether the natural curvature changes with time.
    pub(super) fn is_driven(&self) -> bool {
        self.natural
            .as_ref()
            .is_some_and(NaturalCurvature::is_driven)
    }

    /// No plastic curvature. A memory has one for each layer of each point, 1/m: `R p` with the components
    /// `(11, sqrt(2) 12, 22)` of `p`, the first axis along the first edge of the face.
    pub(super) fn memory(&self) -> Vec<f64> {
        vec![0.0; self.layers(0).len() * self.points.len()]
    }

    /// The plastic curvatures of the layers of a point, in a memory.
    fn layers(&self, point: usize) -> Range<usize> {
        let count = self.yields.first().map_or(0, |yields| 3 * yields.layers);
        count * point..count * (point + 1)
    }

    /// The plastic curvatures of the faces as matrices, means over their points in a memory, 1/m.
    pub(super) fn matrices(&self, memory: &[f64]) -> impl Iterator<Item = Matrix2<f64>> {
        let matrix = move |face| {
            let yields = self.yields_of(POINTS * face)?;
            let points = POINTS * face..POINTS * (face + 1);
            let plastic = points.map(|point| yields.plastic(&memory[self.layers(point)]));
            let p = self.roots.inverse(face) * plastic.sum::<Vector3<f64>>() / POINTS as f64;
            Some(Matrix2::new(p[0], p[1] / SQRT_2, p[1] / SQRT_2, p[2]))
        };
        (0..self.points.len() / POINTS).filter_map(matrix)
    }

    /// A point at positions, with the natural curvature at a time and the plastic ones of a memory.
    pub(super) fn bent(&self, point: usize, stencil: &Stencil<'_>, at: At<'_>) -> BentPoint {
        let At { t, x, memory } = at;
        let PointOfPlate { corners, area, .. } = self.points[point];
        let rigidity = self.roots.rigidity(face_of(point));
        let scale = (rigidity * area).sqrt();
        let [a, b, c] = corners.map(|v| position(x, v));
        let normal = (b - a).cross(&(c - a));
        let double_area = normal.norm();
        let normal = normal / double_area;
        let hats = [c - b, a - c, b - a].map(|opposite| normal.cross(&opposite) / double_area);
        let derivatives = stencil.apply(at);
        let layers = &memory[self.layers(point)];
        let natural = self.natural.as_ref();
        let mut before = natural.map_or(Vector3::zeros(), |natural| natural.at(point, t));
        if let Some(yields) = self.yields_of(point) {
            before += yields.plastic(layers);
        }
        let trial = derivatives.tr_mul(&normal) / scale - before;
        let flow = match self.yields_of(point) {
            Some(yields) => yields.flow(rigidity, trial, layers),
            None => Flow::none(),
        };
        let stress_free = scale * (before + flow.step);
        BentPoint {
            corners,
            normal,
            hats,
            elastic: derivatives - normal * stress_free.transpose(),
            stress_free,
            trial,
            flow,
        }
    }

    /// Whether neither yields, and the natural curvatures have the same factor of time.
    pub(super) fn are_comparable(&self, other: &Self) -> bool {
        let natural = [self, other].map(|own| own.natural.as_ref());
        let factors = natural.map(|own| own.map(NaturalCurvature::profile));
        self.yields.is_empty() && other.yields.is_empty() && factors[0] == factors[1]
    }

    /// Whether a point is the same as that of another plate that is comparable, with the same stencil.
    pub(super) fn is_same(&self, other: &Self, point: usize) -> bool {
        let natural = [self, other].map(|of| of.natural.as_ref().map(|own| own.own(point)));
        let (a, b) = (&self.points[point], &other.points[point]);
        natural[0] == natural[1]
            && a.corners == b.corners
            && a.area == b.area
            && self.roots.rigidity(face_of(point)) == other.roots.rigidity(face_of(point))
    }

    /// Hands all points at positions to `take`.
    pub(super) fn evaluate<R>(
        &self,
        stencils: &Stencils,
        at: At<'_>,
        take: impl FnOnce(&[BentPoint]) -> R,
    ) -> R {
        let bent = |point| self.bent(point, &stencils.of(point), at);
        self.evaluated.at(at, work(stencils), bent, take)
    }

    /// The energy of a point, joules: of what is bent elastically, of hardening, of the stresses between
    /// layers, and what is dissipated in the step.
    pub(super) fn energy(&self, point: usize, bent: &BentPoint) -> f64 {
        0.5 * bent.elastic.norm_squared() + self.points[point].area * bent.flow.energy
    }

    /// Makes the curvatures of a memory those at the end of a step; the energy that has been dissipated,
    /// joules.
    pub(super) fn settle(
        &self,
        stencils: &Stencils,
        (t, x): (f64, &[f64]),
        memory: &mut [f64],
    ) -> f64 {
        let mut dissipated = 0.0;
        for (point, stencil) in stencils.iter().enumerate() {
            let Some(yields) = self.yields_of(point) else {
                return dissipated;
            };
            let at = At::new(t, x).with_memory(memory);
            let trial = self.bent(point, &stencil, at).trial;
            let layers = &mut memory[self.layers(point)];
            let area = self.points[point].area;
            dissipated += area * yields.settle(self.roots.rigidity(face_of(point)), trial, layers);
        }
        dissipated
    }

    /// What the curvatures without stress add to the Hessian of the elastic plate; nothing as long as there
    /// are none.
    ///
    /// The Hessian is that of `|P (dB - dn p^T)|^2 + n . dB (1 - slope) dB^T n`, with the projection `P`
    /// along the normal, and of `max(0, p . (k - p)) |dn|^2`: it is positive semidefinite, and differs from
    /// the second derivatives by terms that vanish where the sheet is isometric and no face is bent against
    /// the one that it has without stress.
    pub(super) fn blocks(&self, stencils: &Stencils, at: At<'_>) -> Option<MutexGuard<'_, Blocks>> {
        self.evaluate(stencils, at, |points| {
            if points.iter().all(BentPoint::is_flat) {
                return None;
            }
            let mut blocks = self.blocks.lock().unwrap_or_else(PoisonError::into_inner);
            blocks.zero();
            for (point, (bent, stencil)) in points.iter().zip(stencils.iter()).enumerate() {
                if !bent.is_flat() {
                    self.add_blocks(bent, point, stencil, &mut blocks);
                }
            }
            Some(blocks)
        })
    }

    fn add_blocks(
        &self,
        bent: &BentPoint,
        point: usize,
        stencil: Stencil<'_>,
        blocks: &mut Blocks,
    ) {
        let (n, p) = (bent.normal, bent.stress_free);
        let turning = p.norm_squared() + (bent.elastic * p).dot(&n).max(0.0);
        let Blocks {
            at_vertices,
            at_edges,
            at_pairs,
            vertices,
        } = blocks;
        vertices.clear();
        vertices.extend(stencil.map(|(index, weights)| {
            let corner = bent.corners.iter().position(|c| c.index() == index);
            BentVertex {
                index,
                weights,
                yielded: bent.flow.slope * weights,
                along: weights.dot(&p),
                hat: corner.map_or(Vector3::zeros(), |k| bent.hats[k]),
            }
        }));
        let block = |i: &BentVertex, j: &BentVertex| {
            let normal = turning * i.hat.dot(&j.hat) - i.yielded.dot(&j.weights);
            (n * normal + i.along * j.hat) * n.transpose() + j.along * n * i.hat.transpose()
        };
        let mut slots = self.slots[self.points[point].slots..].iter();
        for (k, i) in vertices.iter().enumerate() {
            at_vertices[i.index] += block(i, i);
            for (j, Slot { list, index, rows }) in vertices[..k].iter().zip(&mut slots) {
                let list = match list {
                    List::Edges => &mut *at_edges,
                    List::Pairs => &mut *at_pairs,
                };
                list[*index as usize] += match rows {
                    Rows::First => block(i, j),
                    Rows::Second => block(j, i),
                };
            }
        }
    }
}
