//! Bending stiffness of a thin plate that does not depend on how the mesh runs.

mod error;
mod face_curvature;
mod fit;
mod law;
mod line_clamp;
#[cfg(test)]
mod line_clamp_tests;
mod natural;
#[cfg(test)]
mod natural_tests;
#[cfg(test)]
mod plastic_tests;
mod points;
#[cfg(test)]
mod poisson_tests;
mod second_derivatives;
mod stencil;
mod stiffness;
mod stress_free;
#[cfg(test)]
mod tests;

use super::patched::Patched;
use super::plasticity::Yield;
use crate::potential::{
    At, Difference, HessianKind, MaterialReport, Reached, Remembering, Settled,
};
use crate::vectors::add;
use crate::{HessianSink, Potential};
pub use error::{CurlError, PlateBendingError};
pub use face_curvature::FaceCurvature;
use isosheet_mesh::{EdgeId, FaceId, Sheet, VertexId};
use isosheet_motion::Profile;
use law::Roots;
pub use law::{OrthotropicPlate, PlateLaw};
pub use line_clamp::{LineClamp, PlateEdges};
use nalgebra::{Matrix2, Matrix3, Vector3};
use natural::NaturalCurvature;
pub use natural::{Curl, Curvature, NaturalTensor};
use points::{FlatPoints, add_forces};
pub(crate) use second_derivatives::SecondDerivatives;
use std::any::Any;
use std::sync::Arc;
use stencil::{Stencil, Stencils, face_of};
pub use stiffness::PlateStiffness;
use stress_free::{Blocks, StressFreeCurvature};

/// Bending energy of a thin plate that is flat at rest,
///
/// ```text
/// V(x) = D/2 sum_T A_T/3 sum_p [ (1 - nu) |H_p x|^2 + nu |tr H_p x|^2 ],
/// H_p x = H_T x + (5/3)^(1/2) (Q_p x - mean_T Q x),
/// H_T x = 1/A_T sum_{e in T} l_e [ s_e n n^T + (x_b - x_a) / l_e  sym(t n^T) ],
/// ```
///
/// with the flexural rigidity `D` (newton metres), Poisson's ratio `nu` ([`PlateStiffness`]), the areas `A_T`
/// of the faces, and for each edge `e = (a, b)` of a face its length `l_e`, its direction `t`, the outward
/// normal `n` in the plane of the face and the derivative `s_e` of the positions along `n` at its midpoint.
/// `H_T x` is the mean of the second derivatives of the positions by material coordinates over the face
/// (Gauss's theorem), one vector for each of its three components. For an isometric deformation these second
/// derivatives are the second fundamental form times the surface normal, and `V` is the energy of Kirchhoff's
/// plate. A developable surface has one principal curvature, and its energy does not depend on Poisson's
/// ratio; twist and bending in two directions do.
///
/// The two faces of an edge share `s_e`, which makes the energy that of Morley's plate element, with the
/// slopes eliminated: inside, `s_e` is the slope of the quadratic polynomial that fits the vertices of the
/// two faces and their neighbours by weighted least squares; at free edges it is that of the face and its
/// neighbours to one side; at the edges of faces with three clamped corners it is the slope of that face.
/// Near clamps the polynomials fit the slopes that the clamps hold, too, and have the cubic terms that a
/// clamp leaves free. Second derivatives are exact for quadratic positions, and deflections are of second
/// order in the size of the faces on any mesh.
///
/// Means over faces, of slopes that are fitted, miss part of the energy of bends that vary. The energy is
/// therefore taken at three points of a face, one for each edge, which differ by the second derivatives `Q_p`
/// of the polynomials there; the factor is what a wave on a strip needs. (Where a mesh has too few vertices
/// for a fit, and at creases, a face is not bent across its edge: a strip of one cell across does not curve
/// across, and bends as a wide one does.) (The stiffness of
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
    roots: Roots,
    stencils: Arc<Stencils>,
    /// Nothing for a plate that is flat without stress, and stays so.
    stress_free: Option<StressFreeCurvature>,
    flat: FlatPoints,
    /// Whether the rest shape is that of the sheet.
    is_curved: bool,
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
    pub fn new(sheet: &Sheet, law: impl Into<PlateLaw>) -> Result<Self, PlateBendingError> {
        Self::clamped(sheet, law, &[])
    }

    /// The bending stiffness of a plate that is clamped by pinned vertices: where all three corners of a face
    /// are among `clamped`, the plate leaves the clamp with the slope of that face. (Without, the clamp acts
    /// as if it began half a face further back.)
    ///
    /// # Errors
    /// [`PlateBendingError`].
    pub fn clamped(
        sheet: &Sheet,
        law: impl Into<PlateLaw>,
        clamped: &[VertexId],
    ) -> Result<Self, PlateBendingError> {
        Self::creased(sheet, law, clamped, &[])
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
        law: impl Into<PlateLaw>,
        clamped: &[VertexId],
        creases: &[EdgeId],
    ) -> Result<Self, PlateBendingError> {
        let edges = PlateEdges {
            pinned: clamped,
            creases,
            clamps: &[],
        };
        Self::held(sheet, law, &edges)
    }

    /// As [`PlateBending::creased`], with clamps along lines of vertices.
    ///
    /// # Errors
    /// [`PlateBendingError`].
    ///
    /// # Panics
    /// If the positions of a clamp are not of length `3V`.
    pub fn held(
        sheet: &Sheet,
        law: impl Into<PlateLaw>,
        edges: &PlateEdges<'_>,
    ) -> Result<Self, PlateBendingError> {
        Self::patched(sheet, &Patched::everywhere(law.into()), edges)
    }

    /// As [`PlateBending::held`], with patches that have other laws. A plate with patches has rigidity
    /// everywhere.
    ///
    /// # Errors
    /// [`PlateBendingError`].
    ///
    /// # Panics
    /// If the positions of a clamp are not of length `3V`.
    pub fn patched(
        sheet: &Sheet,
        laws: &Patched<PlateLaw>,
        edges: &PlateEdges<'_>,
    ) -> Result<Self, PlateBendingError> {
        let roots = Roots::new(sheet, laws)?;
        let of_clamps = edges.clamps.iter().flat_map(|clamp| &clamp.vertices);
        let count = sheet.topology().vertex_count();
        let mut named = edges.pinned.iter().chain(of_clamps);
        if let Some(&vertex) = named.find(|v| v.index() >= count) {
            return Err(PlateBendingError::NoVertex { vertex, count });
        }
        for clamp in edges.clamps {
            assert_eq!(
                clamp.positions.len(),
                3 * count,
                "a position for each vertex"
            );
            let source = clamp.motion.validate();
            source.map_err(|source| PlateBendingError::Motion { source })?;
        }
        let count = sheet.topology().edge_count();
        if let Some(&edge) = edges.creases.iter().find(|e| e.index() >= count) {
            return Err(PlateBendingError::NoEdge { edge, count });
        }
        let stencils = Stencils::new(sheet, &roots, edges);
        Ok(Self::of_stencils(sheet, roots, Arc::new(stencils)))
    }

    fn of_stencils(sheet: &Sheet, roots: Roots, stencils: Arc<Stencils>) -> Self {
        let mut at_vertices = vec![0.0; sheet.topology().vertex_count()];
        // Of each vertex the others with a higher number that it has a product with.
        let mut others: Vec<Vec<(u32, f64)>> = vec![Vec::new(); at_vertices.len()];
        for stencil in stencils.iter() {
            for (i, (v, a)) in stencil.clone().enumerate() {
                for (w, b) in stencil.clone().take(i + 1) {
                    let product = a.dot(&b);
                    if v == w {
                        at_vertices[v] += product;
                        continue;
                    }
                    let (own, higher) = (&mut others[v.min(w)], v.max(w) as u32);
                    match own.iter_mut().find(|(other, _)| *other == higher) {
                        Some((_, sum)) => *sum += product,
                        None => own.push((higher, product)),
                    }
                }
            }
        }
        let (mut at_edges, mut at_pairs) = (Vec::new(), Vec::new());
        for (v, mut others) in others.into_iter().enumerate() {
            others.sort_unstable_by_key(|(other, _)| *other);
            for (other, value) in others {
                let pair = [VertexId::from_index(v), VertexId(other)];
                match sheet.topology().find_edge(pair[0], pair[1]) {
                    Some(edge) => at_edges.push((edge, value)),
                    None => at_pairs.push((pair, value)),
                }
            }
        }
        Self {
            roots,
            stencils,
            stress_free: None,
            flat: FlatPoints::default(),
            is_curved: false,
            at_vertices,
            at_edges,
            at_pairs,
        }
    }

    /// The plate of `sheet` at rest in the positions of the sheet, curved as they are, in place of flat:
    /// without stress there, and with the energy of what it is bent beyond. (Second derivatives along the
    /// faces, which no bend makes, are left out for the rest positions.)
    #[must_use]
    pub fn curved(mut self, sheet: &Sheet) -> Self {
        let natural = Arc::make_mut(&mut self.stencils).straighten(sheet, &self.roots);
        let Self {
            roots, stencils, ..
        } = self;
        self = Self::of_stencils(sheet, roots, stencils);
        self.is_curved = true;
        self.stress_free(sheet)
            .set_natural(NaturalCurvature::of_points(natural));
        self
    }

    /// The plate of `sheet` with a natural curvature, in place of the one that it had.
    ///
    /// # Errors
    /// [`PlateBendingError::Curl`].
    pub fn with_curl(mut self, sheet: &Sheet, curl: Curl) -> Result<Self, PlateBendingError> {
        let natural = NaturalCurvature::of_curl(sheet, &self.roots, curl);
        let natural = natural.map_err(|source| PlateBendingError::Curl { source })?;
        self.stress_free(sheet).set_natural(natural);
        Ok(self)
    }

    /// The plate of `sheet` with the natural curvature that it has in another shape, with positions `shape`
    /// (`3V`, metres) of its vertices, times a profile of time; in place of the one that it had. Lengths stay
    /// as in the sheet.
    ///
    /// # Errors
    /// [`PlateBendingError::Curl`].
    ///
    /// # Panics
    /// If there are not as many positions.
    pub fn curled_as(
        mut self,
        sheet: &Sheet,
        shape: &[f64],
        profile: Profile,
    ) -> Result<Self, PlateBendingError> {
        assert_eq!(
            shape.len(),
            sheet.positions().len(),
            "a position for each vertex"
        );
        let faces = match self.is_stiff() {
            true => self.stencils.curvatures(sheet, &self.roots, shape),
            false => return Ok(self),
        };
        let natural = NaturalCurvature::of_shape(faces, profile);
        let natural = natural.map_err(|source| PlateBendingError::Curl { source })?;
        self.stress_free(sheet).set_natural(natural);
        Ok(self)
    }

    fn stress_free(&mut self, sheet: &Sheet) -> &mut StressFreeCurvature {
        let Self {
            roots,
            stencils,
            at_edges,
            at_pairs,
            ..
        } = self;
        self.stress_free.get_or_insert_with(|| {
            StressFreeCurvature::new(sheet, stencils, roots.clone(), at_edges, at_pairs)
        })
    }

    /// The second derivatives of positions beyond those without stress, as the stencil of a point has them.
    fn elastic(&self, point: usize, stencil: &Stencil<'_>, at: At<'_>) -> Matrix3<f64> {
        match &self.stress_free {
            None => stencil.apply(at),
            Some(curvature) => curvature.bent(point, stencil, at).elastic,
        }
    }

    /// Whether it rests in the positions of its sheet, curved as they are.
    pub fn is_curved(&self) -> bool {
        self.is_curved
    }

    /// Flexural rigidity of a face, newton metres.
    pub(crate) fn rigidity_of(&self, face: FaceId) -> f64 {
        self.roots.rigidity(face.index())
    }

    /// Whether it resists bending.
    pub(crate) fn is_stiff(&self) -> bool {
        self.roots.are_stiff()
    }

    /// The second derivatives of positions, of the plate of `sheet`, which has rigidity.
    pub(crate) fn second_derivatives(&self, sheet: &Sheet) -> SecondDerivatives {
        SecondDerivatives::new(&self.stencils, &self.roots, sheet.face_areas())
    }

    /// Makes the plate of `sheet` yield, from a state without plastic curvature on. (Without rigidity it has
    /// no moments, and never yields.)
    ///
    /// # Errors
    /// [`PlateBendingError::Yield`].
    pub fn with_yield(self, sheet: &Sheet, yields: Yield) -> Result<Self, PlateBendingError> {
        self.with_yields(sheet, &Patched::everywhere(yields))
    }

    /// As [`PlateBending::with_yield`], with patches that yield otherwise, in as many layers as the sheet
    /// outside of them.
    ///
    /// # Errors
    /// [`PlateBendingError::Yield`] and [`PlateBendingError::Patch`].
    pub fn with_yields(
        mut self,
        sheet: &Sheet,
        yields: &Patched<Yield>,
    ) -> Result<Self, PlateBendingError> {
        for own in yields.all() {
            let checked = own.validate();
            checked.map_err(|source| PlateBendingError::Yield { source })?;
        }
        let layers = yields.ground().layers;
        let count = match yields.is_uniform() {
            true => sheet.topology().face_count().min(1),
            false => sheet.topology().face_count(),
        };
        let own = yields.of_faces(sheet.topology().face_count())?;
        let own = own.into_iter().take(count);
        let own = own.map(|yields| yields.in_layers(layers)).collect();
        if self.is_stiff() {
            self.stress_free(sheet).set_yields(own);
        }
        Ok(self)
    }
}

impl Potential for PlateBending {
    fn energy(&self, at: At<'_>) -> f64 {
        let stencils = &self.stencils;
        match &self.stress_free {
            None => self
                .flat
                .at(stencils, at, |points| points.iter().map(|(_, e)| e).sum()),
            Some(curvature) => curvature.evaluate(stencils, at, |points| {
                let energy = |(k, bent)| curvature.energy(k, bent);
                points.iter().enumerate().map(energy).sum()
            }),
        }
    }

    fn add_gradient(&self, at: At<'_>, gradient: &mut [f64]) {
        let stencils = &self.stencils;
        match &self.stress_free {
            None => self.flat.at(stencils, at, |points| {
                add_forces(stencils, |k| &points[k].0, |_| [], gradient);
            }),
            Some(curvature) => curvature.evaluate(stencils, at, |points| {
                let turning = |k: usize| points[k].turning_forces();
                add_forces(stencils, |k| &points[k].elastic, turning, gradient);
            }),
        }
    }

    fn add_hessian(&self, at: At<'_>, hessian: &mut dyn HessianSink) {
        let plastic = self.stress_free.as_ref();
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

    /// By points, of plates that do not yield and that no clamps along lines hold.
    fn difference(&self, other: &dyn Potential) -> Difference {
        let other: Option<&Self> = (other as &dyn Any).downcast_ref();
        let comparable = other.filter(|other| self.stencils.are_comparable(&other.stencils));
        let Some(other) = comparable else {
            return Difference::Everything;
        };
        let is_curved_alike: Box<dyn Fn(usize) -> bool> =
            match (&self.stress_free, &other.stress_free) {
                (None, None) => Box::new(|_| true),
                (Some(own), Some(other)) if own.are_comparable(other) => {
                    Box::new(|point| own.is_same(other, point))
                }
                _ => return Difference::Everything,
            };
        Difference::of_parts(self.stencils.count(), |point| {
            !(self.stencils.is_same(&other.stencils, point) && is_curved_alike(point))
        })
    }

    fn add_gradient_of(&self, parts: &[u32], at: At<'_>, gradient: &mut [f64]) {
        let stencils = &self.stencils;
        let mut add_second = |stencil: Stencil<'_>, second: &Matrix3<f64>| {
            for (v, weights) in stencil {
                add(gradient, VertexId::from_index(v), &(second * weights));
            }
        };
        let mut turning = Vec::new();
        for point in parts.iter().map(|point| *point as usize) {
            let stencil = stencils.of(point);
            match &self.stress_free {
                None => add_second(stencil.clone(), &stencil.apply(at)),
                Some(curvature) => {
                    let bent = curvature.bent(point, &stencil, at);
                    add_second(stencil, &bent.elastic);
                    turning.extend(bent.turning_forces());
                }
            }
        }
        for (v, force) in turning {
            add(gradient, v, &force);
        }
    }

    fn hessian_kind(&self) -> HessianKind {
        match self.stress_free {
            None => HessianKind::Exact,
            Some(_) => HessianKind::Partial,
        }
    }

    fn couplings(&self) -> Vec<[VertexId; 2]> {
        self.at_pairs.iter().map(|(pair, _)| *pair).collect()
    }

    fn is_driven(&self) -> bool {
        let turns = self.stencils.is_driven();
        turns
            || self
                .stress_free
                .as_ref()
                .is_some_and(StressFreeCurvature::is_driven)
    }

    fn remembering(&self) -> Option<&dyn Remembering> {
        Some(self)
    }

    fn report(&self) -> Option<&dyn MaterialReport> {
        Some(self)
    }
}

impl Remembering for PlateBending {
    fn memory(&self) -> Vec<f64> {
        let plastic = self.stress_free.as_ref();
        plastic.map_or_else(Vec::new, StressFreeCurvature::memory)
    }

    fn can_yield(&self) -> bool {
        self.stress_free
            .as_ref()
            .is_some_and(StressFreeCurvature::yields)
    }

    fn memory_difference(&self, other: &dyn Potential) -> Difference {
        let other: Option<&Self> = (other as &dyn Any).downcast_ref();
        match other.is_some_and(|other| !self.can_yield() && !other.can_yield()) {
            true => Difference::Nothing,
            false => Difference::Everything,
        }
    }

    fn settle(&self, state: Reached<'_>, memory: &mut [f64]) -> Settled {
        let settle = |curvature: &StressFreeCurvature| {
            curvature.settle(&self.stencils, (state.t, state.x), memory)
        };
        Settled {
            dissipated: self.stress_free.as_ref().map_or(0.0, settle),
            work: 0.0,
        }
    }
}

impl MaterialReport for PlateBending {
    fn add_bending_energies(&self, at: At<'_>, faces: &mut [f64]) {
        for (k, stencil) in self.stencils.iter().enumerate() {
            faces[face_of(k)] += 0.5 * self.elastic(k, &stencil, at).norm_squared();
        }
    }

    fn plastic_curvatures(&self, memory: &[f64]) -> Vec<(FaceId, Matrix2<f64>)> {
        let plastic = self.stress_free.iter();
        let matrices = plastic.flat_map(|plastic| plastic.matrices(memory));
        let faces = (0..).map(FaceId::from_index);
        faces.zip(matrices).collect()
    }

    /// With the slopes `d_e` that clamps hold and their forces `f_e = dV/dd_e` it is `sum_e d_e x f_e`.
    fn clamp_moments(&self, at: At<'_>) -> Vec<[f64; 3]> {
        let mut moments = vec![Vector3::zeros(); self.stencils.clamp_count()];
        for (k, stencil) in self.stencils.iter().enumerate() {
            if stencil.clamps().next().is_none() {
                continue;
            }
            let elastic = self.elastic(k, &stencil, at);
            for (clamp, (director, weights)) in stencil.clamps().zip(stencil.directors(at.t)) {
                moments[clamp] += director.cross(&(elastic * weights));
            }
        }
        moments.into_iter().map(Into::into).collect()
    }
}
