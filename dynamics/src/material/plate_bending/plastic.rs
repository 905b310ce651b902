//! Plastic curvature of a plate.

use super::stencil::{Stencil, Stencils};
use crate::material::plasticity::{Flow, Yield};
use crate::vectors::point;
use isosheet_mesh::{EdgeId, Sheet, VertexId};
use nalgebra::{Matrix2, Matrix3, Vector3};
use std::collections::BTreeMap;
use std::f64::consts::SQRT_2;

/// The plastic curvatures of the faces of a plate.
#[derive(Debug)]
pub(super) struct PlasticCurvature {
    yields: Yield,
    /// Flexural rigidity `D`, newton metres.
    rigidity: f64,
    faces: Vec<PlasticFace>,
    /// Of each pair of vertices of each stencil, the second one being before the first, where its block of the
    /// Hessian is.
    slots: Vec<Slot>,
    /// Plastic curvature of each face, 1/m: the components `(11, sqrt(2) 12, 22)`, the first axis along the first
    /// edge of the face.
    curvatures: Vec<f64>,
}

/// What does not change of a face.
#[derive(Debug)]
struct PlasticFace {
    /// Counter-clockwise.
    corners: [VertexId; 3],
    /// In square metres.
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

/// What the plastic curvatures add to the Hessian of an elastic plate, in the places of its blocks.
pub(super) struct Blocks {
    pub(super) at_vertices: Vec<Matrix3<f64>>,
    pub(super) at_edges: Vec<Matrix3<f64>>,
    pub(super) at_pairs: Vec<Matrix3<f64>>,
}

/// A face at positions, `B` being the second derivatives of the positions, `n` the unit normal and `p` the plastic
/// curvature at the end of the step.
pub(super) struct BentFace {
    corners: [VertexId; 3],
    normal: Vector3<f64>,
    /// Gradients on the face of the linear functions that are one at a corner and zero at the other two, 1/m.
    hats: [Vector3<f64>; 3],
    /// `sqrt(D A) (B - n p^T)`.
    pub(super) elastic: Matrix3<f64>,
    /// `sqrt(D A) p`.
    plastic: Vector3<f64>,
    /// Plastic curvature before the step, 1/m.
    before: Vector3<f64>,
    flow: Flow<3>,
}

impl BentFace {
    /// The derivatives of the energy by the corners, as far as they are those of the normal: with the hats `g_j` it
    /// is `dn = -sum_j g_j (n . dx_j)`.
    pub(super) fn turning_forces(&self) -> [(VertexId, Vector3<f64>); 3] {
        let moved = self.elastic * self.plastic;
        let force = |k: usize| self.normal * self.hats[k].dot(&moved);
        [0, 1, 2].map(|k| (self.corners[k], force(k)))
    }

    /// Whether it bends as a face that has never yielded.
    fn is_elastic(&self) -> bool {
        self.plastic == Vector3::zeros() && self.flow.slope == Matrix3::zeros()
    }
}

impl PlasticCurvature {
    /// A plate that has not yielded, with blocks of the Hessian at vertices, `edges` and `pairs`.
    pub(super) fn new(
        sheet: &Sheet,
        stencils: &Stencils,
        (rigidity, yields): (f64, Yield),
        edges: impl Iterator<Item = EdgeId>,
        pairs: impl Iterator<Item = [VertexId; 2]>,
    ) -> Self {
        let topology = sheet.topology();
        let edges = edges.map(|e| topology.edges()[e.index()]);
        let edges = edges
            .enumerate()
            .map(|(k, ends)| (ends, (List::Edges, k as u32)));
        let pairs = pairs
            .enumerate()
            .map(|(k, pair)| (pair, (List::Pairs, k as u32)));
        let places: BTreeMap<[VertexId; 2], (List, u32)> = edges.chain(pairs).collect();
        let slot = |v: VertexId, w: VertexId| {
            let (place, rows) = match places.get(&[v, w]) {
                Some(place) => (place, Rows::First),
                None => (&places[&[w, v]], Rows::Second),
            };
            let (list, index) = *place;
            Slot { list, index, rows }
        };
        let (mut slots, mut faces) = (Vec::new(), Vec::new());
        let corners = topology.faces().iter().zip(sheet.face_areas());
        for ((corners, area), stencil) in corners.zip(stencils.iter()) {
            faces.push(PlasticFace {
                corners: *corners,
                area: *area,
                slots: slots.len(),
            });
            let vertices: Vec<_> = stencil.map(|(v, _)| VertexId::from_index(v)).collect();
            for (i, v) in vertices.iter().enumerate() {
                slots.extend(vertices[..i].iter().map(|w| slot(*v, *w)));
            }
        }
        Self {
            yields,
            rigidity,
            curvatures: vec![0.0; 3 * faces.len()],
            faces,
            slots,
        }
    }

    pub(super) fn curvatures(&self) -> &[f64] {
        &self.curvatures
    }

    pub(super) fn set_curvatures(&mut self, curvatures: &[f64]) {
        self.curvatures.copy_from_slice(curvatures);
    }

    /// The plastic curvatures as matrices, 1/m.
    pub(super) fn matrices(&self) -> impl Iterator<Item = Matrix2<f64>> {
        let matrix = |p: &[f64; 3]| Matrix2::new(p[0], p[1] / SQRT_2, p[1] / SQRT_2, p[2]);
        self.curvatures.as_chunks::<3>().0.iter().map(matrix)
    }

    /// A face at positions.
    pub(super) fn bent(&self, face: usize, stencil: &Stencil<'_>, x: &[f64]) -> BentFace {
        let PlasticFace { corners, area, .. } = self.faces[face];
        let scale = (self.rigidity * area).sqrt();
        let [a, b, c] = corners.map(|v| point(x, v));
        let normal = (b - a).cross(&(c - a));
        let double_area = normal.norm();
        let normal = normal / double_area;
        let hats = [c - b, a - c, b - a].map(|opposite| normal.cross(&opposite) / double_area);
        let derivatives = stencil.apply(x);
        let before = Vector3::from(self.curvatures.as_chunks::<3>().0[face]);
        let curvature = derivatives.tr_mul(&normal) / scale;
        let flow = self.yields.flow(self.rigidity, curvature - before, before);
        let plastic = scale * (before + flow.step);
        BentFace {
            corners,
            normal,
            hats,
            elastic: derivatives - normal * plastic.transpose(),
            plastic,
            before,
            flow,
        }
    }

    /// The energy of a face, joules: of what is bent elastically, of hardening, and what is dissipated in the step.
    pub(super) fn energy(&self, face: usize, bent: &BentFace) -> f64 {
        let plastic = self.yields.energy(bent.before, bent.flow.step);
        0.5 * bent.elastic.norm_squared() + self.faces[face].area * plastic
    }

    /// Makes the curvatures those at the end of a step; the energy that has been dissipated, joules.
    pub(super) fn settle(&mut self, stencils: &Stencils, x: &[f64]) -> f64 {
        let mut dissipated = 0.0;
        for (face, stencil) in stencils.iter().enumerate() {
            let step = self.bent(face, &stencil, x).flow.step;
            for (p, growth) in self.curvatures[3 * face..].iter_mut().zip(&step) {
                *p += growth;
            }
            dissipated += self.faces[face].area * self.yields.moment * step.norm();
        }
        dissipated
    }

    /// What the plastic curvatures add to the Hessian of the elastic plate; nothing as long as no face has yielded.
    ///
    /// The Hessian is that of `|P (dB - dn p^T)|^2 + n . dB (1 - slope) dB^T n`, with the projection `P` along the
    /// normal, and of `max(0, p . (k - p)) |dn|^2`: it is positive semidefinite, and differs from the second derivatives
    /// by terms that vanish where the sheet is isometric and no face is bent against its plastic curvature.
    pub(super) fn blocks(
        &self,
        stencils: &Stencils,
        x: &[f64],
        count: [usize; 3],
    ) -> Option<Blocks> {
        let bent = stencils.iter().enumerate();
        let bent = bent.map(|(face, stencil)| self.bent(face, &stencil, x));
        let bent: Vec<BentFace> = bent.collect();
        if bent.iter().all(BentFace::is_elastic) {
            return None;
        }
        let [at_vertices, at_edges, at_pairs] = count.map(|n| vec![Matrix3::zeros(); n]);
        let mut blocks = Blocks {
            at_vertices,
            at_edges,
            at_pairs,
        };
        let faces = bent.iter().zip(&self.faces).zip(stencils.iter());
        for ((bent, face), stencil) in faces.filter(|((bent, _), _)| !bent.is_elastic()) {
            self.add_blocks(bent, face, stencil, &mut blocks);
        }
        Some(blocks)
    }

    fn add_blocks(
        &self,
        bent: &BentFace,
        face: &PlasticFace,
        stencil: Stencil<'_>,
        blocks: &mut Blocks,
    ) {
        let (n, p) = (bent.normal, bent.plastic);
        let turning = p.norm_squared() + (bent.elastic * p).dot(&n).max(0.0);
        let vertices: Vec<_> = stencil
            .map(|(v, w)| {
                let corner = face.corners.iter().position(|c| c.index() == v);
                let hat = corner.map_or(Vector3::zeros(), |k| bent.hats[k]);
                (v, w, bent.flow.slope * w, w.dot(&p), hat)
            })
            .collect();
        let block = |i: usize, j: usize| {
            let ((_, _, yielded, p_i, g_i), (_, w, _, p_j, g_j)) = (&vertices[i], &vertices[j]);
            let normal = turning * g_i.dot(g_j) - yielded.dot(w);
            (n * normal + *p_i * g_j) * n.transpose() + *p_j * n * g_i.transpose()
        };
        let mut slots = self.slots[face.slots..].iter();
        for (i, vertex) in vertices.iter().enumerate() {
            blocks.at_vertices[vertex.0] += block(i, i);
            for (j, Slot { list, index, rows }) in (0..i).zip(&mut slots) {
                let list = match list {
                    List::Edges => &mut blocks.at_edges,
                    List::Pairs => &mut blocks.at_pairs,
                };
                list[*index as usize] += match rows {
                    Rows::First => block(i, j),
                    Rows::Second => block(j, i),
                };
            }
        }
    }
}
