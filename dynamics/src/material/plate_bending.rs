//! Bending stiffness of a thin plate that does not depend on how the mesh runs.

mod plastic;
#[cfg(test)]
mod plastic_tests;
#[cfg(test)]
mod poisson_tests;
mod second_derivatives;
mod stencil;
mod stiffness;
#[cfg(test)]
mod tests;

use super::plasticity::Yield;
use crate::options::OptionsError;
use crate::potential::At;
use crate::potential::Reached;
use crate::potential::Settled;
use crate::{HessianSink, Potential};
use isosheet_mesh::wording::given;
use isosheet_mesh::{Advice, EdgeId, FaceId, Sheet, VertexId};
use nalgebra::{Matrix2, Matrix3, Vector3};
use plastic::{Blocks, PlasticCurvature};
pub(crate) use second_derivatives::SecondDerivatives;
use std::collections::BTreeMap;
use std::sync::Arc;
use stencil::Stencils;
pub use stiffness::PlateStiffness;

/// Why the bending stiffness of a plate cannot be made.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum PlateBendingError {
    /// The flexural rigidity is negative or not finite.
    #[error("the flexural rigidity is {rigidity} N m", rigidity = given(*rigidity))]
    Rigidity {
        /// The rigidity given, N m.
        rigidity: f64,
    },
    /// Poisson's ratio is out of range.
    #[error("Poisson's ratio is {ratio}", ratio = given(*ratio))]
    Poisson {
        /// The ratio given.
        ratio: f64,
    },
    /// A clamped vertex does not exist.
    #[error("{vertex} is named as clamped, but the sheet has {count} vertices")]
    NoVertex {
        /// The vertex.
        vertex: VertexId,
        /// Number of vertices.
        count: usize,
    },
    /// An edge of a crease does not exist.
    #[error("{edge} is named as a crease, but the sheet has {count} edges")]
    NoEdge {
        /// The edge.
        edge: EdgeId,
        /// Number of edges.
        count: usize,
    },
    /// The plate cannot yield as it is to.
    #[error("the yield of the plate cannot be used: {source}")]
    Yield {
        /// What is wrong with it.
        source: OptionsError,
    },
}

impl Advice for PlateBendingError {
    fn advice(&self) -> Option<&'static str> {
        match self {
            Self::Yield { source } => source.advice(),
            Self::Rigidity { .. } => Some("give a finite one of at least 0"),
            Self::Poisson { .. } => Some("give a value from 0 to 0.5"),
            Self::NoVertex { .. } | Self::NoEdge { .. } => None,
        }
    }
}

/// Bending energy of a thin plate that is flat at rest,
///
/// ```text
/// V(x) = D/2 sum_T A_T [ (1 - nu) |H_T x|^2 + nu |tr H_T x|^2 ],
/// H_T x = 1/A_T sum_{e in T} l_e [ s_e n n^T + (x_b - x_a) / l_e  sym(t n^T) ],
/// ```
///
/// with the flexural rigidity `D` (newton metres), Poisson's ratio `nu` ([`PlateStiffness`]), the areas `A_T` of the faces, and for each edge `e = (a,
/// b)` of a face its length `l_e`, its direction `t`, the outward normal `n` in the plane of the face and the
/// derivative `s_e` of the positions along `n` at its midpoint. `H_T x` is the mean of the second derivatives
/// of the positions by material coordinates over the face (Gauss's theorem), one vector for each of its three
/// components. For an isometric deformation these second derivatives are the second fundamental form times
/// the surface normal, and `V` is the energy of Kirchhoff's plate. A developable surface has one principal
/// curvature, and its energy does not depend on Poisson's ratio; twist and bending in two directions do.
///
/// The two faces of an edge share `s_e`, which makes the energy that of Morley's plate element, with the
/// slopes eliminated: inside, `s_e` is the slope of the quadratic polynomial that fits the vertices of the
/// two faces and their neighbours by weighted least squares; at free edges it is that of the face and its
/// neighbours to one side; at the edges of faces with three clamped corners it is the slope of that face.
/// Second derivatives are exact for quadratic positions, and deflections are of second order in the size of
/// the faces on any mesh. (Where a mesh has too few vertices for a fit, and at creases, a face is not bent
/// across its edge: a strip of one cell across does not curve across, and bends as a wide one does.) (The stiffness of
/// [`CreaseSprings::bending`](crate::CreaseSprings::bending) depends on how mesh and bend run.)
///
/// Of the sheet that the plate is made of, the edge lengths alone count: where its rest positions are folded,
/// the plate is flat at rest all the same, and a cone or another shape that no flat sheet has may be given in
/// any positions with its lengths.
///
/// The Hessian is constant and positive semidefinite. It couples vertices that have no common edge, some 30
/// to each vertex. Implicit steps of all but small and very stiff sheets factorise a matrix without these
/// couplings, and take them into account by conjugate gradients: a step costs about twice as much as with
/// rods alone, and with the factorisation of the whole matrix ten times as much.
///
/// A plate that [yields](Yield) has plastic curvatures `p_T` besides, symmetric 2 x 2 matrices that are
/// constant on each face: of the energy of the curvatures `k_T` along the normal `n` of the face, `n . H_T
/// x`, is left that of `k_T - p_T`,
///
/// ```text
/// V(x) = sum_T A_T min_p [ D/2 |H_T x - n p|^2 + H/2 |p|^2 + M_y |p - p_T| ],
/// ```
///
/// with what hardening stores and what the step dissipates; of a section in layers it is the sum over their
/// parts of `D`, `H` and `M_y`, each with a curvature `p_T` of its own. Of the Hessian, which is not constant
/// any more where faces have yielded, a semidefinite part is given.
///
/// (L. S. D. Morley, "The triangular equilibrium element in the solution of plate bending problems",
/// Aeronautical Quarterly 19, 1968; elimination of the rotations from patches of faces as in E. Onate and F.
/// Zarate, "Rotation-free triangular plate and shell elements", Int. J. Numer. Methods Eng. 47, 2000.)
#[derive(Debug)]
pub struct PlateBending {
    stiffness: PlateStiffness,
    stencils: Arc<Stencils>,
    plastic: Option<PlasticCurvature>,
    /// The Hessian of the elastic plate: one multiple of the identity for each vertex, edge and further pair
    /// of vertices.
    at_vertices: Vec<f64>,
    at_edges: Vec<(EdgeId, f64)>,
    at_pairs: Vec<([VertexId; 2], f64)>,
}

impl PlateBending {
    /// The bending stiffness of a plate without clamps. (A number is its rigidity, with a Poisson's ratio of
    /// zero.)
    ///
    /// # Errors
    /// [`PlateBendingError::Rigidity`] and [`PlateBendingError::Poisson`].
    pub fn new(
        sheet: &Sheet,
        stiffness: impl Into<PlateStiffness>,
    ) -> Result<Self, PlateBendingError> {
        Self::clamped(sheet, stiffness, &[])
    }

    /// The bending stiffness of a plate that is clamped by pinned vertices: where all three corners of a face
    /// are among `clamped`, the plate leaves the clamp with the slope of that face. (Without, the clamp acts
    /// as if it began half a face further back.)
    ///
    /// # Errors
    /// [`PlateBendingError`].
    pub fn clamped(
        sheet: &Sheet,
        stiffness: impl Into<PlateStiffness>,
        clamped: &[VertexId],
    ) -> Result<Self, PlateBendingError> {
        Self::creased(sheet, stiffness, clamped, &[])
    }

    /// As [`PlateBending::clamped`], of a sheet with creases: at the edges `creases` the slopes of the two
    /// sides are independent, as at free edges, and no fit of slopes reaches across. What resists folding
    /// there are the springs of the creases
    /// ([`CreaseSpring::put_in_sheet`](crate::CreaseSpring::put_in_sheet)).
    ///
    /// # Errors
    /// [`PlateBendingError`].
    pub fn creased(
        sheet: &Sheet,
        stiffness: impl Into<PlateStiffness>,
        clamped: &[VertexId],
        creases: &[EdgeId],
    ) -> Result<Self, PlateBendingError> {
        let stiffness = stiffness.into();
        let PlateStiffness { rigidity, poisson } = stiffness;
        if !(rigidity.is_finite() && rigidity >= 0.0) {
            return Err(PlateBendingError::Rigidity { rigidity });
        }
        if !(0.0..=0.5).contains(&poisson) {
            return Err(PlateBendingError::Poisson { ratio: poisson });
        }
        let count = sheet.topology().vertex_count();
        if let Some(&vertex) = clamped.iter().find(|v| v.index() >= count) {
            return Err(PlateBendingError::NoVertex { vertex, count });
        }
        let edges = sheet.topology().edge_count();
        if let Some(&edge) = creases.iter().find(|e| e.index() >= edges) {
            return Err(PlateBendingError::NoEdge { edge, count: edges });
        }
        let stencils = Stencils::new(sheet, stiffness, clamped, creases);
        let mut at_vertices = vec![0.0; count];
        let mut others = BTreeMap::<[u32; 2], f64>::new();
        for stencil in stencils.iter() {
            for (i, (v, a)) in stencil.clone().enumerate() {
                for (w, b) in stencil.clone().take(i + 1) {
                    let product = a.dot(&b);
                    if v == w {
                        at_vertices[v] += product;
                    } else {
                        let pair = [v.min(w) as u32, v.max(w) as u32];
                        *others.entry(pair).or_default() += product;
                    }
                }
            }
        }
        let (mut at_edges, mut at_pairs) = (Vec::new(), Vec::new());
        for (pair, value) in others {
            let pair = pair.map(VertexId);
            match sheet.topology().find_edge(pair[0], pair[1]) {
                Some(edge) => at_edges.push((edge, value)),
                None => at_pairs.push((pair, value)),
            }
        }
        Ok(Self {
            stiffness,
            stencils: Arc::new(stencils),
            plastic: None,
            at_vertices,
            at_edges,
            at_pairs,
        })
    }

    /// Flexural rigidity, newton metres.
    pub(crate) fn rigidity(&self) -> f64 {
        self.stiffness.rigidity
    }

    /// The second derivatives of positions, of the plate of `sheet`, which has rigidity.
    pub(crate) fn second_derivatives(&self, sheet: &Sheet) -> SecondDerivatives {
        SecondDerivatives::new(&self.stencils, self.stiffness, sheet.face_areas())
    }

    /// Makes the plate of `sheet` yield, from a state without plastic curvature on. (Without rigidity it has
    /// no moments, and never yields.)
    ///
    /// # Errors
    /// [`PlateBendingError::Yield`].
    pub fn with_yield(mut self, sheet: &Sheet, yields: Yield) -> Result<Self, PlateBendingError> {
        let checked = yields.validate();
        checked.map_err(|source| PlateBendingError::Yield { source })?;
        self.plastic = (self.stiffness.rigidity > 0.0).then(|| {
            let (edges, pairs) = (&self.at_edges, &self.at_pairs);
            PlasticCurvature::new(
                sheet,
                &self.stencils,
                (self.stiffness, yields),
                edges,
                pairs,
            )
        });
        Ok(self)
    }
}

impl Potential for PlateBending {
    fn energy(&self, at: At<'_>) -> f64 {
        let At { x, .. } = at;
        if let Some(plastic) = &self.plastic {
            let faces = self.stencils.iter().enumerate();
            let energy = |(k, s)| plastic.energy(k, &plastic.bent(k, &s, at));
            return faces.map(energy).sum();
        }
        let energy = |h: Matrix3<f64>| 0.5 * h.norm_squared();
        self.stencils.iter().map(|s| energy(s.apply(x))).sum()
    }

    fn add_bending_energies(&self, at: At<'_>, faces: &mut [f64]) {
        let At { x, .. } = at;
        for (k, (face, stencil)) in faces.iter_mut().zip(self.stencils.iter()).enumerate() {
            let elastic = match &self.plastic {
                None => stencil.apply(x),
                Some(plastic) => plastic.bent(k, &stencil, at).elastic,
            };
            *face += 0.5 * elastic.norm_squared();
        }
    }

    fn add_gradient(&self, at: At<'_>, gradient: &mut [f64]) {
        let At { x, .. } = at;
        let mut add = |v: usize, force: Vector3<f64>| {
            for k in 0..3 {
                gradient[3 * v + k] += force[k];
            }
        };
        for (k, stencil) in self.stencils.iter().enumerate() {
            let h = match &self.plastic {
                None => stencil.apply(x),
                Some(plastic) => {
                    let bent = plastic.bent(k, &stencil, at);
                    for (v, force) in bent.turning_forces() {
                        add(v.index(), force);
                    }
                    bent.elastic
                }
            };
            for (v, weights) in stencil {
                add(v, h * weights);
            }
        }
    }

    fn add_hessian(&self, at: At<'_>, hessian: &mut dyn HessianSink) {
        let plastic = self.plastic.as_ref();
        let plastic = plastic.and_then(|plastic| plastic.blocks(&self.stencils, at));
        let block = |value: f64, list: fn(&Blocks) -> &[Matrix3<f64>], k: usize| {
            let elastic = Matrix3::from_diagonal_element(value);
            plastic
                .as_ref()
                .map_or(elastic, |blocks| elastic + list(blocks)[k])
        };
        for (v, value) in self.at_vertices.iter().enumerate() {
            hessian.add_vertex(VertexId(v as u32), &block(*value, |b| &b.at_vertices, v));
        }
        for (k, (edge, value)) in self.at_edges.iter().enumerate() {
            hessian.add_edge(*edge, &block(*value, |b| &b.at_edges, k));
        }
        for (k, ([a, b], value)) in self.at_pairs.iter().enumerate() {
            hessian.add_pair(*a, *b, &block(*value, |b| &b.at_pairs, k));
        }
    }

    fn couplings(&self) -> Vec<[VertexId; 2]> {
        self.at_pairs.iter().map(|(pair, _)| *pair).collect()
    }

    fn plastic_curvatures(&self, memory: &[f64]) -> Vec<(FaceId, Matrix2<f64>)> {
        let plastic = self.plastic.iter();
        let matrices = plastic.flat_map(|plastic| plastic.matrices(memory));
        let faces = (0..).map(FaceId::from_index);
        faces.zip(matrices).collect()
    }

    fn memory(&self) -> Vec<f64> {
        let plastic = self.plastic.as_ref();
        plastic.map_or_else(Vec::new, PlasticCurvature::memory)
    }

    fn can_yield(&self) -> bool {
        self.plastic.is_some()
    }

    fn settle(&self, state: Reached<'_>, memory: &mut [f64]) -> Settled {
        let settle = |plastic: &PlasticCurvature| plastic.settle(&self.stencils, state.x, memory);
        Settled {
            dissipated: self.plastic.as_ref().map_or(0.0, settle),
            work: 0.0,
        }
    }
}
