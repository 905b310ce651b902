//! A sheet that stretches as its material does, up to a limit.

mod arcs;
mod bend;
#[cfg(test)]
mod bend_tests;
mod curved;
#[cfg(test)]
mod derivative_tests;
#[cfg(test)]
mod direction_tests;
mod error;
mod evaluated;
mod face;
mod law;
mod limit;
mod load;
mod membrane;
mod slack;
mod surroundings;
mod swelling;
#[cfg(test)]
mod tests;

use crate::derivative::NoDerivative;
use crate::limit_error::LimitError;
use crate::potential::{At, Difference, Limited, Reached, Remembering, Settled};
use crate::vectors::dot;
use crate::{HessianSink, Potential};
use isosheet_motion::Profile;

use super::patched::Patched;
use super::plate_bending::PlateBending;
use arcs::Arcs;
use bend::{Bend, NUMBERS};
pub use curved::CurvedFace;
pub use error::ElasticSheetError;
use evaluated::{EvaluatedFaces, barrier_of, strained};
use face::Face;
use isosheet_mesh::{FaceId, Part, Sheet};
use load::strain_barrier;
pub use membrane::{MembraneLaw, OrthotropicMembrane};
use nalgebra::Vector3;
use std::any::Any;
use std::ops::Range;
use swelling::Swelling;

/// The elasticity of a sheet in its plane, with a limit of the strain. In place of rigid rods
/// (`SheetModel::with_elastic_sheet`) it makes an everyday sheet of
/// paper, metal, film or cloth: one that bends in every direction on any mesh, and never stretches beyond the
/// limit.
///
/// The energy is that of St. Venant and Kirchhoff in plane stress, one constant strain for each face, with
/// the strain of the chords of bends, with some slack where the sheet bends, and with a barrier at the limit,
///
/// ```text
/// V(x) = sum_T A_T { W_T(|E_T - S_T|_nu) + kappa b(|E_T| / m) },
/// |E|_nu^2 = (1 - nu) |E|^2 + nu (tr E)^2,
/// W_T(e) = K e^2 / 2  where the sheet is flat,   K = E h / (1 - nu^2),
/// ```
///
/// with the rest areas `A_T`, Green's strain `E_T` of the face and its Frobenius norm `|E_T|`, Young's
/// modulus times thickness `E h` (newtons per metre), Poisson's ratio `nu` and the limit `m`. Green's strain
/// is linear in the length errors of the three edges `c_e = (|x_a - x_b|^2 - l_e^2) / 2`: for the vector `e`
/// of an edge at rest, `e^T E_T e = c_e`.
///
/// *Limit.* With `p = (4 |E|^2 / m^2 - 1) / 3` the barrier is `b = -p^2 ln(1 - p)` for `0 < p < 1`: zero up
/// to half the limit, twice continuously differentiable, convex in the strain and infinite at the limit. The
/// norm bounds both principal strains and the strain of every edge, `|c_e| <= m l_e^2`. Each displacement is
/// cut to a part that ends within the limit, so that no accepted step is beyond it. The stiffness `kappa` of
/// the barrier (joules per square metre) is set where a simulation starts, from the weight and the kinetic
/// energy of the sheet, and raised after steps in which it moves faster.
///
/// *Chords.* A stiff membrane locks on coarse meshes, as a face measures chords where the sheet has arcs. Of
/// a sheet that bends as a plate does ([`ElasticSheet::beside`]) the second derivatives `H_T` of the
/// positions are known, and `S_T` is the strain of the chords: that with
///
/// ```text
/// e^T S_T e = -|H_T(e, e)|^2 / 24
/// ```
///
/// for the three edges, as a chord of an arc of length `l` and curvature `k` has the squared length
/// `l^2 (1 - (k l)^2 / 12)` but for terms of fourth order in `k l`.
///
/// *Slack.* The curvature is not known better than the mesh resolves it, at clamps and at the tips of cones
/// least of all, and it changes within a step. The law of a face that bends is therefore a spring in series
/// with a slack,
///
/// ```text
/// e = s / K + r s / (s_0 + s),   s = W_T',   r = 0.3 (k h)^2,   s_0 = max(20, 500 r) D / h^2,
/// ```
///
/// with the mean square `h^2` of the edge lengths, the largest curvature `k` of a face around and the
/// flexural rigidity `D`. Its strain is never further from Hooke's than `r`, which goes with the square of
/// the mesh size; where the sheet is flat there is none, and a sheet that is pulled has the stiffness of its
/// material. `s_0` is a force at which a wave of the size of a face is pulled flat, or buckles; faces that
/// bend much yield by `h^2 / (500 D)` for each newton per metre at most.
///
/// *Tension.* Under a tension `s_1` the slack `r` is `2 D k^2 / s_1` at most: a ripple of the curvature `k`
/// costs `D k^2 / 2` for each square metre, and a tension gains up to `s_1 r` by the slack of the ripple.
/// Without this bound a taut sheet would ripple by itself, and yield. `s_1` is the largest principal value of
/// the mean stress of the faces around, or of `W_T(E_T)` without chords, if that is less: faces that are not
/// as short as their chords yet are not pulled.
///
/// *Directions.* A sheet whose material has two directions ([`OrthotropicMembrane`]) stores
/// `(E_T - S_T) : C (E_T - S_T) / 2` where it is flat. The slack belongs to the mesh, and has no direction:
/// its range is that of a norm `|z|_nu` with `nu = C12 / (C11 C22)^(1/2)`, and the strain `z` to which it is
/// pulled out minimises the energy of spring and slack, `min_z (e - z) : C (e - z) / 2 + psi(|z|_nu)`.
///
/// `S_T` and `r` are taken at the start of a step. What their change does to the energy is counted as work.
/// Slack that grows lets energy of its face go; where it closes it takes up as much at most, and stays open
/// by as much as that does not pay for. So slack never drives a motion; a face that was bent may keep some
/// slack until it is unloaded. (The curvature of patches in the membrane strain, within the step, is that of
/// F. G. Flores and E. Onate, "Improvements in the membrane behaviour of the three node rotation-free BST
/// shell triangle using an assumed strain approach", Comput. Methods Appl. Mech. Eng. 194, 2005; it couples
/// all vertices of a patch as stiffly as the membrane.)
///
/// A strain limit by barrier: M. Li, D. M. Kaufman and C. Jiang, "Codimensional incremental potential
/// contact", ACM Trans. Graph. 40(4), 2021, Sec. 5.
#[derive(Debug, Clone)]
pub struct ElasticSheet {
    faces: Vec<Face>,
    /// Number of faces of the sheet that these are of.
    face_count: usize,
    /// Young's modulus times thickness of the material, N/m.
    stiffness: f64,
    /// Kilograms; zero before a simulation has started.
    mass: f64,
    /// The vertices from the first to the last one of its faces; none before a simulation has started.
    vertices: Range<usize>,
    /// Largest acceleration by constant forces, m/s2; zero before a simulation has started.
    acceleration: f64,
    /// How the sheets bend; nothing of those without a plate.
    arcs: Vec<Arcs>,
    evaluated: EvaluatedFaces,
}

/// The strain of a face of an [`ElasticSheet`].
#[derive(Debug, Clone, Copy, PartialEq)]
#[non_exhaustive]
pub struct StrainOfFace {
    /// The face.
    pub face: FaceId,
    /// The norm of its strain.
    pub strain: f64,
    /// The limit of that.
    pub limit: f64,
}

impl ElasticSheet {
    /// The limit of the strain unless another is asked for.
    pub const LIMIT: f64 = 0.05;

    /// The least and the largest part by which lengths may [grow](Self::with_swelling).
    pub const SWELLING: [f64; 2] = [-0.2, 0.2];

    /// A sheet that is at rest in the shape of `sheet`, with the `stiffness` `E h` (Young's modulus times
    /// thickness, newtons per metre; office paper 3e5), Poisson's ratio and the limit
    /// [`ElasticSheet::LIMIT`].
    ///
    /// # Errors
    /// [`ElasticSheetError`].
    pub fn new(sheet: &Sheet, stiffness: f64, poisson: f64) -> Result<Self, ElasticSheetError> {
        Self::of_law(sheet, MembraneLaw::Isotropic { stiffness, poisson })
    }

    /// As [`ElasticSheet::new`], of a law that may have directions.
    ///
    /// # Errors
    /// [`ElasticSheetError`].
    pub fn of_law(sheet: &Sheet, law: impl Into<MembraneLaw>) -> Result<Self, ElasticSheetError> {
        Self::patched(sheet, &Patched::everywhere(law.into()))
    }

    /// As [`ElasticSheet::of_law`], with patches that have other laws.
    ///
    /// # Errors
    /// [`ElasticSheetError`].
    pub fn patched(sheet: &Sheet, laws: &Patched<MembraneLaw>) -> Result<Self, ElasticSheetError> {
        for law in laws.all() {
            law.check()?;
        }
        let face = |(face, law): (FaceId, &MembraneLaw)| {
            let area = sheet.face_areas()[face.index()];
            let own =
                Face::new(sheet, face, Self::LIMIT).ok_or(ElasticSheetError::Face { face, area });
            let mut own = own?;
            own.set_law(law.of_face(sheet, face)?);
            Ok(own)
        };
        let topology = sheet.topology();
        let own = laws.of_faces(topology.face_count())?;
        let faces = topology.face_ids().zip(own).map(face);
        Ok(Self {
            faces: faces.collect::<Result<_, ElasticSheetError>>()?,
            face_count: sheet.topology().face_count(),
            stiffness: laws.all().map(MembraneLaw::stiffness).fold(0.0, f64::max),
            mass: 0.0,
            vertices: 0..0,
            acceleration: 0.0,
            arcs: Vec::new(),
            evaluated: EvaluatedFaces::default(),
        })
    }

    /// Of a sheet that bends as `plate` does, a plate of the same `sheet`: chords are shorter than their
    /// arcs, and faces have slack where they bend (see [above](Self)), so that a coarse mesh bends, too.
    /// Without, or with a plate that has no rigidity, bends that a mesh cannot follow by folding stretch the
    /// sheet.
    ///
    /// # Panics
    /// If the plate is of a sheet with another number of faces.
    #[must_use]
    pub fn beside(mut self, sheet: &Sheet, plate: &PlateBending) -> Self {
        let counts = [self.faces.len(), sheet.topology().face_count()];
        assert_eq!(counts[0], counts[1], "a plate of the same sheet");
        if plate.is_stiff() {
            for face in &mut self.faces {
                face.rigidity = plate.rigidity_of(face.id);
            }
            self.arcs = vec![Arcs::new(sheet, plate, &self.faces)];
        }
        self.evaluated = EvaluatedFaces::default();
        self
    }

    /// With another limit of the strain, a number above 0 and below 0.5.
    ///
    /// # Errors
    /// [`ElasticSheetError::Limit`].
    pub fn with_limit(mut self, limit: f64) -> Result<Self, ElasticSheetError> {
        if !(limit > 0.0 && limit < 0.5) {
            return Err(ElasticSheetError::Limit { limit });
        }
        for face in &mut self.faces {
            face.set_limit(limit);
        }
        self.evaluated = EvaluatedFaces::default();
        Ok(self)
    }

    /// With lengths that grow by themselves, by a part `s` that is a function of time: negative for paper
    /// that dries, positive for film that is heated. Energies are those [above](Self) with `E_T - g I`,
    /// `1 + 2 g = (1 + s)^2`, in place of `E_T`, by areas and stiffnesses of the sheet before it swells; the
    /// limit is one of the strain against the grown lengths, `(E_T - g I) / (1 + s)^2`. What swelling does to
    /// bending stiffness, slack and curvature without stress, a part of the order of `s`, is left out.
    ///
    /// A strip that is held at both ends and shrinks by a part `s` pulls with `E h s` per width.
    ///
    /// # Errors
    /// [`ElasticSheetError::Profile`].
    pub fn with_swelling(mut self, part: impl Into<Profile>) -> Result<Self, ElasticSheetError> {
        let swelling = Swelling::of(part.into())?;
        for face in &mut self.faces {
            face.set_swelling(swelling.clone());
        }
        self.evaluated = EvaluatedFaces::default();
        Ok(self)
    }

    /// The first part by which lengths would grow at a time that is not within [`ElasticSheet::SWELLING`].
    pub fn swollen_too_much(&self, t: f64) -> Option<f64> {
        let mut parts = self.faces.iter().map(|face| face.swelling().part(t));
        let [least, most] = Self::SWELLING;
        parts.find(|part| !(least..=most).contains(part))
    }

    /// The largest difference of the lengths of edges at rest from those of another sheet at a time, as a
    /// part; nothing if it has another number of faces.
    pub fn rest_difference(&self, other: &Self, t: f64) -> Option<f64> {
        let pairs = self.faces.iter().zip(&other.faces);
        let differences = pairs.map(|(own, other)| own.rest_difference(other, t));
        (self.faces.len() == other.faces.len()).then(|| differences.fold(0.0, f64::max))
    }

    /// The elasticity of some sheets of a [union](Sheet::union) with so many faces, each with its own
    /// stiffness and limit of the strain. Sheets that are not among them remain rigid.
    ///
    /// # Panics
    /// If there is no sheet.
    #[must_use]
    pub fn union(sheets: Vec<(Self, Part)>, face_count: usize) -> Self {
        let mut sheets = sheets.into_iter();
        let (mut union, part) = sheets.next().expect("at least one sheet");
        union.face_count = face_count;
        union.place(&part, 0);
        for (mut sheet, part) in sheets {
            sheet.place(&part, union.faces.len());
            union.faces.append(&mut sheet.faces);
            union.arcs.append(&mut sheet.arcs);
            union.stiffness = union.stiffness.max(sheet.stiffness);
        }
        union.evaluated = EvaluatedFaces::default();
        union
    }

    /// Makes this the elasticity of a sheet in a union of several. `first` is the number of its first face
    /// among the elastic ones.
    fn place(&mut self, part: &Part, first: usize) {
        let faces = std::mem::take(&mut self.faces).into_iter();
        self.faces = faces.map(|face| face.in_union(part)).collect();
        let arcs = std::mem::take(&mut self.arcs).into_iter();
        self.arcs = arcs.map(|arcs| arcs.in_union(part, first)).collect();
    }

    /// The limit of the strain; of several sheets the largest.
    pub fn limit(&self) -> f64 {
        self.limits().fold(0.0, f64::max)
    }

    /// The limit of the strain of each face.
    pub fn limits(&self) -> impl ExactSizeIterator<Item = f64> + '_ {
        self.faces.iter().map(Face::limit)
    }

    /// The stiffness of the material, `E h`, newtons per metre; of several sheets, patches or directions the
    /// largest.
    pub fn stiffness(&self) -> f64 {
        self.stiffness
    }

    /// The faces that are elastic, in the order in which the other functions tell of them.
    pub fn faces(&self) -> impl ExactSizeIterator<Item = FaceId> + '_ {
        self.faces.iter().map(|face| face.id)
    }

    /// The norm `|E_T|` of the strain of each face.
    pub fn strains<'a>(&'a self, at: At<'a>) -> impl ExactSizeIterator<Item = f64> + 'a {
        self.faces.iter().map(move |face| face.strain(at).norm())
    }

    /// The elastic energy of each face, joules, with that of the barrier; infinite beyond the limit.
    pub fn face_energies<'a>(&'a self, at: At<'a>) -> impl ExactSizeIterator<Item = f64> + 'a {
        let barrier = barrier_of(at.memory);
        (0..self.faces.len()).map(move |k| {
            let (face, strained) = strained(&self.faces, k, at);
            face.energy(&strained, barrier)
        })
    }

    /// The part of the area whose strain is beyond half of its limit, where the barrier acts.
    pub fn part_at_limit(&self, at: At<'_>) -> f64 {
        let is_held = |face: &&Face| face.strain(at).norm() > 0.5 * face.limit();
        let held = self.faces.iter().filter(is_held).map(Face::area);
        // The sum of nothing would be -0.
        held.fold(0.0, |sum, area| sum + area) / self.area()
    }

    /// The part of the slack in these energies, joules.
    pub fn slack_energies<'a>(&'a self, at: At<'a>) -> impl ExactSizeIterator<Item = f64> + 'a {
        (0..self.faces.len()).map(move |k| {
            let (face, strained) = strained(&self.faces, k, at);
            face.slack_energy(&strained)
        })
    }

    /// The angles by which the faces bend, radians, from the energies of bending of all faces of the sheet,
    /// joules.
    pub fn bend_angles(&self, bending: &[f64]) -> impl Iterator<Item = f64> {
        self.faces.iter().map(|face| {
            if face.rigidity == 0.0 {
                return 0.0;
            }
            let energy = bending[face.id.index()];
            let curvature = (2.0 * energy / (face.rigidity * face.area())).sqrt();
            curvature * face.mean_squared_length().sqrt()
        })
    }

    /// The face that is the largest for its bend at rest, by [`CurvedFace::coarseness`]; nothing where all
    /// are flat.
    pub fn coarsest_curved(&self) -> Option<CurvedFace> {
        let curved = self.arcs.iter().flat_map(|arcs| arcs.curved(&self.faces));
        curved.max_by(|a, b| a.coarseness().total_cmp(&b.coarseness()))
    }

    /// The face that comes nearest to its limit or is farthest beyond it.
    pub fn worst(&self, at: At<'_>) -> Option<StrainOfFace> {
        let faces = self.faces.iter().map(|face| StrainOfFace {
            face: face.id,
            strain: face.strain(at).norm(),
            limit: face.limit(),
        });
        // (Strains that are not numbers are beyond it, too.)
        faces.max_by(|a, b| (a.strain - a.limit).total_cmp(&(b.strain - b.limit)))
    }

    /// The face that is farthest beyond its limit, if one is not within it.
    pub fn beyond_limit(&self, at: At<'_>) -> Option<StrainOfFace> {
        let worst = self.worst(at)?;
        let is_within = worst.strain < worst.limit;
        (!is_within).then_some(worst)
    }

    /// What measures strains beyond the limit in place of elasticity: the energy
    /// `sum_T A_T k max(0, |E_T| - m)^2 / 2` with a stiffness `k` (joules per square metre).
    pub fn excess(&self, stiffness: f64) -> Self {
        let mut excess = self.clone();
        for face in &mut excess.faces {
            face.measure_excess(stiffness);
        }
        excess
    }

    /// The vertices from the first to the last one of its faces.
    pub fn vertices(&self) -> Range<usize> {
        let corners = || self.faces.iter().flat_map(Face::corners);
        let first = corners().min().map_or(0, |v| v.index());
        first..corners().max().map_or(first, |v| v.index() + 1)
    }

    /// Sets what the barrier follows besides the motion: the mass of the sheet, kilograms, and the largest
    /// acceleration by constant forces, m/s2.
    pub fn set_load(&mut self, mass: f64, acceleration: f64) {
        self.mass = mass;
        self.vertices = self.vertices();
        self.acceleration = acceleration;
    }

    /// Area at rest, square metres.
    pub fn area(&self) -> f64 {
        self.faces.iter().map(Face::area).sum()
    }

    /// Number of faces of the sheet that it was built for.
    pub fn face_count(&self) -> usize {
        self.face_count
    }
}

impl ElasticSheet {
    /// The stiffness of the barrier that a state asks for, joules per square metre.
    fn needed_barrier(&self, state: Reached<'_>) -> f64 {
        let own = 3 * self.vertices.start..3 * self.vertices.end;
        let (x, v) = (&state.x[own.clone()], &state.v[own]);
        strain_barrier(
            self.mass / self.area(),
            self.acceleration,
            Reached { x, v, ..state },
        )
    }
}

impl ElasticSheet {
    /// Adds `scale` times derivatives by what is remembered: of each face those by the chords of its bend, by
    /// the squared bend, and by the stiffness of the barrier.
    fn add_of_faces(
        &self,
        at: At<'_>,
        scale: f64,
        of_memory: &mut [f64],
        derivatives: impl Fn(&Face, &Bend) -> (Vector3<f64>, f64, f64),
    ) {
        let [of_barrier, of_bends @ ..] = of_memory else {
            return;
        };
        let bends = at.memory.get(1..).unwrap_or_default().as_chunks().0;
        let rows = of_bends.as_chunks_mut::<NUMBERS>().0.iter_mut();
        for ((face, bend), row) in self.faces.iter().zip(bends).zip(rows) {
            let (chords, squared, stiffness) = derivatives(face, &Bend::remembered(bend));
            *of_barrier += scale * stiffness;
            if !self.arcs.is_empty() {
                row.iter_mut()
                    .zip(&chords)
                    .for_each(|(r, c)| *r += scale * c);
                row[4] += scale * squared;
            }
        }
    }
}

impl Potential for ElasticSheet {
    fn energy(&self, at: At<'_>) -> f64 {
        self.evaluated.evaluate(&self.faces, at, |states| {
            states.iter().map(|(_, energy)| energy).sum()
        })
    }

    fn add_gradient(&self, at: At<'_>, gradient: &mut [f64]) {
        let barrier = barrier_of(at.memory);
        self.evaluated.evaluate(&self.faces, at, |states| {
            for (face, (strained, _)) in self.faces.iter().zip(states) {
                face.add_gradient(strained, barrier, gradient);
            }
        });
    }

    fn add_hessian(&self, at: At<'_>, hessian: &mut dyn HessianSink) {
        self.evaluated
            .add_blocks(&self.faces, at, |density| density, hessian);
    }

    /// With the curvature of edges under tension alone.
    fn add_semidefinite_hessian(&self, at: At<'_>, hessian: &mut dyn HessianSink) {
        self.evaluated
            .add_blocks(&self.faces, at, |density| density.max(0.0), hessian);
    }

    fn is_driven(&self) -> bool {
        self.faces.iter().any(|face| face.swelling().is_driven())
    }

    /// What the round-off of positions makes of a sheet: strains `d` beside those `e` that it has change the
    /// energy `K e^2 / 2` by `K d^2 / 2`, and by at most twice the root of the product of the two.
    fn round_off(&self, size: f64, energy: f64) -> f64 {
        let unstrained: f64 = self.faces.iter().map(|face| face.round_off(size)).sum();
        unstrained + 2.0 * (energy * unstrained).sqrt()
    }

    /// By faces.
    fn difference(&self, other: &dyn Potential) -> Difference {
        let other: Option<&Self> = (other as &dyn Any).downcast_ref();
        match other.filter(|other| self.faces.len() == other.faces.len()) {
            Some(other) => {
                Difference::of_parts(self.faces.len(), |k| self.faces[k] != other.faces[k])
            }
            None => Difference::Everything,
        }
    }

    fn add_gradient_of(&self, parts: &[u32], at: At<'_>, gradient: &mut [f64]) {
        let barrier = barrier_of(at.memory);
        for k in parts {
            let (face, strained) = strained(&self.faces, *k as usize, at);
            face.add_gradient(&strained, barrier, gradient);
        }
    }

    fn limit(&self) -> Option<&dyn Limited> {
        Some(self)
    }

    fn remembering(&self) -> Option<&dyn Remembering> {
        Some(self)
    }
}

impl Limited for ElasticSheet {
    /// Whether it swells or shrinks within bounds, and leaves the strains within the limit.
    fn check(&self, at: At<'_>) -> Result<(), LimitError> {
        if let Some(part) = self.swollen_too_much(at.t) {
            return Err(LimitError::Swelling { part, t: at.t });
        }
        if self.is_driven()
            && let Some(worst) = self.beyond_limit(at)
        {
            return Err(LimitError::SwellingBeyondLimit {
                face: worst.face,
                strain: worst.strain,
                limit: worst.limit,
                t: at.t,
            });
        }
        Ok(())
    }

    /// Along the part every face keeps a part of its distance from the limit.
    fn safe_part(&self, at: At<'_>, dx: &[f64]) -> f64 {
        self.evaluated.part_within(&self.faces, at, dx)
    }

    /// Whether every face keeps a part of its distance from the limit.
    fn stays_within(&self, at: At<'_>, end: &[f64]) -> bool {
        self.evaluated.stay_within(&self.faces, at, end)
    }

    /// The tangent law of each face times the strains of second order, `|dx_a - dx_b|^2 / 2` for each edge.
    fn add_second_order(&self, at: At<'_>, dx: &[f64], scale: f64, gradient: &mut [f64]) -> bool {
        let barrier = barrier_of(at.memory);
        self.evaluated.evaluate(&self.faces, at, |states| {
            for (face, (strained, _)) in self.faces.iter().zip(states) {
                face.add_second_order(strained, dx, barrier, scale, gradient);
            }
        });
        true
    }
}

impl Remembering for ElasticSheet {
    /// The stiffness of the barrier, joules per square metre, and the bend of each face.
    fn memory(&self) -> Vec<f64> {
        vec![0.0; 1 + NUMBERS * self.faces.len()]
    }

    fn start(&self, state: Reached<'_>, memory: &mut [f64]) {
        if let [_, bends @ ..] = memory {
            for arcs in &self.arcs {
                arcs.start(&self.faces, At::new(state.t, state.x), bends);
            }
        }
        self.settle(state, memory);
    }

    /// Of each face the part of the way from the slack that is wanted to the slack that there was.
    fn choices(&self, state: Reached<'_>, memory: &[f64]) -> Vec<f64> {
        let mut memory = memory.to_vec();
        let mut choices = Vec::new();
        if let [_, bends @ ..] = &mut memory[..] {
            for arcs in &self.arcs {
                let here = At::new(state.t, state.x);
                let slack = |face: &Face, bend: Bend, wanted: f64| {
                    let given = face.with_slack(here, bend, wanted);
                    let way = bend.squared - wanted;
                    choices.push(match way == 0.0 {
                        true => 1.0,
                        false => (given.squared - wanted) / way,
                    });
                    given
                };
                arcs.remember_by(&self.faces, here, bends, slack);
            }
        }
        choices
    }

    fn settle_by(&self, choices: &[f64], state: Reached<'_>, memory: &mut [f64]) {
        if let [barrier, bends @ ..] = memory {
            *barrier = barrier.max(self.needed_barrier(state));
            let mut choices = choices.iter().copied();
            for arcs in &self.arcs {
                let here = At::new(state.t, state.x);
                let slack = |face: &Face, bend, wanted| {
                    let part = choices.next().unwrap_or(0.0);
                    face.with_part(here, bend, wanted, part)
                };
                arcs.remember_by(&self.faces, here, bends, slack);
            }
        }
    }

    /// By faces: those with a face around them that is another one, or bends otherwise.
    fn memory_difference(&self, other: &dyn Potential) -> Difference {
        let other: Option<&Self> = (other as &dyn Any).downcast_ref();
        let comparable = other.filter(|other| {
            self.mass == other.mass
                && self.acceleration == other.acceleration
                && self.vertices == other.vertices
                && self.area() == other.area()
                && self.faces.len() == other.faces.len()
                && self.arcs.len() == other.arcs.len()
        });
        let Some(other) = comparable else {
            return Difference::Everything;
        };
        let mut differs = vec![false; self.faces.len()];
        for (own, others) in self.arcs.iter().zip(&other.arcs) {
            if !own.add_difference(others, (&self.faces, &other.faces), &mut differs) {
                return Difference::Everything;
            }
        }
        Difference::of_parts(differs.len(), |k| differs[k])
    }

    fn settled_product(
        &self,
        parts: Option<&[u32]>,
        state: Reached<'_>,
        (found, choices): (&[f64], &[f64]),
        of: &[f64],
    ) -> f64 {
        let Some(parts) = parts else {
            let mut memory = found.to_vec();
            self.settle_by(choices, state, &mut memory);
            return dot(of, &memory);
        };
        let here = At::new(state.t, state.x);
        let bends = found.get(1..).unwrap_or_default();
        let of = of[1..].as_chunks::<NUMBERS>().0;
        let mut sum = 0.0;
        let mut choices = choices;
        for arcs in &self.arcs {
            let (own, others) = choices.split_at(arcs.face_count().min(choices.len()));
            choices = others;
            let slack = |k: usize, face: &Face, bend, wanted| {
                let part = own.get(k).copied().unwrap_or(0.0);
                face.with_part(here, bend, wanted, part)
            };
            arcs.remember_parts_by(&self.faces, here, bends, parts, slack, |k, bend| {
                sum += dot(&of[k], &bend.numbers());
            });
        }
        sum
    }

    fn add_memory_products(
        &self,
        at: At<'_>,
        w: &[f64],
        of_memory: &mut [f64],
    ) -> Result<(), NoDerivative> {
        let barrier = barrier_of(at.memory);
        self.add_of_faces(at, 1.0, of_memory, |face, bend| {
            face.products(at, bend, barrier, w)
        });
        Ok(())
    }

    fn add_memory_slopes(
        &self,
        at: At<'_>,
        scale: f64,
        of_memory: &mut [f64],
    ) -> Result<(), NoDerivative> {
        let barrier = barrier_of(at.memory);
        self.add_of_faces(at, scale, of_memory, |face, bend| {
            face.slopes(at, bend, barrier)
        });
        Ok(())
    }

    fn pull_back_settling(
        &self,
        state: Reached<'_>,
        (found, choices): (&[f64], &[f64]),
        of_memory: &mut [f64],
        of_x: &mut [f64],
    ) -> Result<(), NoDerivative> {
        let [of_barrier, of_bends @ ..] = of_memory else {
            return Ok(());
        };
        let bends = found.get(1..).unwrap_or_default();
        let mut choices = choices;
        for arcs in &self.arcs {
            let here = At::new(state.t, state.x);
            let (own, others) = choices.split_at(arcs.face_count().min(choices.len()));
            choices = others;
            arcs.pull_back(&self.faces, here, (bends, own), of_bends, of_x);
        }
        let stays = barrier_of(found) >= self.needed_barrier(state);
        if *of_barrier == 0.0 || stays {
            return Ok(());
        }
        *of_barrier = 0.0;
        Err(NoDerivative {
            of: "the stiffness of the barrier at the limit of the strain, which a face is near,"
                .into(),
            by: "the motion that raises it",
        })
    }

    fn pull_back_start(
        &self,
        state: Reached<'_>,
        of_memory: &[f64],
        of_x: &mut [f64],
    ) -> Result<(), NoDerivative> {
        let here = At::new(state.t, state.x);
        let mut bends = self.memory();
        if let [_, bends @ ..] = &mut bends[..] {
            for arcs in &self.arcs {
                arcs.start(&self.faces, here, bends);
            }
        }
        let mut of_memory = of_memory.to_vec();
        let choices = self.choices(state, &bends);
        let settled = self.pull_back_settling(state, (&bends, &choices), &mut of_memory, of_x);
        for arcs in &self.arcs {
            arcs.pull_start(&self.faces, here, &of_memory[1..], of_x);
        }
        settled
    }

    /// Raises the stiffness of the barrier to what the state asks for, and remembers how the sheet bends,
    /// which is work.
    fn settle(&self, state: Reached<'_>, memory: &mut [f64]) -> Settled {
        let energy = |memory: &[f64]| self.energy(At::new(state.t, state.x).with_memory(memory));
        let before = energy(memory);
        let [barrier, bends @ ..] = memory else {
            return Settled::default();
        };
        let needed = self.needed_barrier(state);
        *barrier = barrier.max(needed);
        for arcs in &self.arcs {
            arcs.remember(&self.faces, At::new(state.t, state.x), bends);
        }
        Settled {
            dissipated: 0.0,
            work: energy(memory) - before,
        }
    }
}
